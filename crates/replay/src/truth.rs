//! Estimated slips beside their truth.

use std::io;
use std::path::Path;

use grouser_log::csv::{Lines, finite, split};
use grouser_log::{Clock, Messages};
use grouser_real::Real;
use grouser_slip::{Health, Robot};

use crate::error::{Error, Result};
use crate::quantiles::SIGMAS_90;
use crate::sink::{Row, Sink, Step};

/// Truth is linear between two samples that are no further apart than this, s.
const MAX_GAP_S: f64 = 0.5;
/// An estimate's lag is looked for in steps of this length, s, up to this number of them to both sides: 1 s, twice the lag of
/// the filter behind a step of the slip.
const LAG_STEP_S: f64 = 0.02;
const MAX_LAG_STEPS: i32 = 50;
/// The truth must vary by this standard deviation for a lag to be found.
const MIN_VARIATION: f64 = 0.02;
/// Points of a line of the truth: more than a figure has columns.
const MAX_LINE_POINTS: usize = 4096;

/// True slips over time, of each wheel.
///
/// ```
/// use grouser_files::{columns, robot};
/// use grouser_log::Log;
/// use grouser_replay::{Options, Truth, run_into};
///
/// let example = std::path::Path::new("../../examples/five-wheel");
/// let robot = robot::read(&example.join("robot.toml"))?;
/// let map = columns::read(&example.join("columns.toml"))?;
/// let log = Log::find(&[example.join("log.csv")], map)?;
/// let truth = Truth::read(&example.join("truth.csv"), &robot.robot)?;
/// let mut compared = truth.compare();
/// run_into(&log, &robot, &Options::default(), &mut compared)?;
/// let errors = compared.errors();
/// assert!(errors[0].rmse.unwrap() < 0.05, "{errors:?}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    names: Vec<String>,
    /// Of each wheel: s from the log's start (of a topic: ns), and slip, in the order of time.
    wheels: Vec<Vec<(f64, f64)>>,
    /// Are times on the log's clock, and not from its start?
    is_on_clock: bool,
}

/// The errors of one wheel's estimates.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct TruthError {
    /// The wheel.
    pub wheel: String,
    /// Estimates with a truth.
    pub count: u64,
    /// Estimates, with a truth or without.
    pub estimates: u64,
    /// The first and the last time of the truth, s from the log's start.
    pub truth_s: Option<[f64; 2]>,
    /// The same of the estimates.
    pub estimates_s: Option<[f64; 2]>,
    /// The same of the estimates with a truth.
    pub compared_s: Option<[f64; 2]>,
    /// Root of the mean squared error.
    pub rmse: Option<f64>,
    /// Mean error, estimate less truth.
    pub bias: Option<f64>,
    /// Mean of the squared error over its variance, of estimates that are Ok: 1 where sigmas are right.
    pub nees: Option<f64>,
    /// The share of these whose 90 % interval holds the truth.
    pub coverage_90: Option<f64>,
    /// How much later the estimate is, s, where the truth varies enough to find it and is known for 1 s on both sides of
    /// estimates; negative of an estimate that is earlier.
    pub lag_s: Option<f64>,
    /// The estimate fits best at the edge of the delays that are compared, ±1 s: `lag_s` is `None`, and truth and log may be on
    /// two clocks.
    pub is_lag_beyond: bool,
}

impl Truth {
    /// Reads a CSV table: a column `time_s` or `time_ms` from the log's start, and a column `NAME_slip` of each wheel;
    /// an empty field is no truth. Rows are in the order of time.
    ///
    /// # Errors
    /// What is wrong with the table, such as [`SetBack`](grouser_log::Error::SetBack) of a row that is older than the one before
    /// it; [`Error::NoTruth`] where it has no such columns, or no slip in them.
    ///
    /// ```
    /// use grouser_replay::{Error, Truth};
    /// use grouser_slip::{Robot, Wheel};
    ///
    /// let robot = Robot::new("cart".into(), vec![Wheel::powered("left")])?;
    /// let table = "../../examples/five-wheel/log.csv"; // it has no column of true slips
    /// assert!(matches!(Truth::read(table.as_ref(), &robot), Err(Error::NoTruth { .. })));
    /// # Ok::<(), grouser_slip::Error>(())
    /// ```
    pub fn read(path: &Path, robot: &Robot) -> Result<Self> {
        let mut truth = Self::new(robot, false);
        let absent = || Error::NoTruth {
            source_name: path.display().to_string(),
        };
        let mut lines = Lines::open(path)?;
        let mut fields = Vec::new();
        if !lines.advance()? {
            return Err(absent());
        }
        let text = lines.text()?;
        split(text, b',', &mut fields).map_err(|_| absent())?;
        let names: Vec<String> = fields.iter().map(|f| f.value(text).into_owned()).collect();
        let place = |name: &str| names.iter().position(|own| own == name);
        let time = place("time_s").map(|at| (at, 1.0));
        let (time, scale) = time
            .or(place("time_ms").map(|at| (at, 1e-3)))
            .ok_or_else(absent)?;
        let columns: Vec<Option<usize>> = truth
            .names
            .iter()
            .map(|wheel| place(&format!("{wheel}_slip")))
            .collect();
        if columns.iter().all(Option::is_none) {
            return Err(absent());
        }
        let mut last_s = f64::NEG_INFINITY;
        while lines.advance()? {
            let text = lines.text()?;
            if text.is_empty() {
                continue;
            }
            split(text, b',', &mut fields).map_err(|_| absent())?;
            let number = |at: usize| -> Result<Option<f64>> {
                let field = fields.get(at).map_or("", |field| field.text(text).trim());
                if field.is_empty() {
                    return Ok(None);
                }
                finite(field, b'.').map(Some).map_err(|bad| {
                    grouser_log::Error::NotANumber {
                        at: grouser_log::Cell {
                            column: Some(at + 1),
                            ..lines.cell()
                        },
                        found: field.chars().take(64).collect(),
                        expected: bad.expected,
                        hint: bad.hint,
                    }
                    .into()
                })
            };
            let Some(time_s) = number(time)?.map(|value| value * scale) else {
                continue;
            };
            if time_s < last_s {
                let at = grouser_log::Cell {
                    column: Some(time + 1),
                    name: names.get(time).cloned(),
                    ..lines.cell()
                };
                let by_s = last_s - time_s;
                return Err(grouser_log::Error::SetBack { at, by_s }.into());
            }
            last_s = time_s;
            for (wheel, column) in truth.wheels.iter_mut().zip(&columns) {
                if let Some(slip) = column.map(number).transpose()?.flatten() {
                    wheel.push((time_s, slip));
                }
            }
        }
        truth.some().ok_or_else(absent)
    }

    /// Reads the messages of a topic of type `grouser_msgs/WheelSlip`, as a simulated drive writes it.
    ///
    /// # Errors
    /// What does not let a file be read; [`Error::NoTruth`] where no message names a wheel of the robot.
    pub fn read_topic<'a>(
        files: impl Iterator<Item = &'a Path>,
        topic: &str,
        robot: &Robot,
    ) -> Result<Self> {
        let mut truth = Self::new(robot, true);
        for file in files {
            let named = topic.to_owned();
            let wanted = move |channel: &grouser_log::container::Channel| channel.topic == named;
            for message in Messages::open(file, Clock::Header, wanted)? {
                let names = message.value.at("name").and_then(|names| names.elements());
                let slips = message.value.at("slip").and_then(|slips| slips.elements());
                for (name, slip) in names.into_iter().flatten().zip(slips.into_iter().flatten()) {
                    let wheel = name.text().and_then(|name| robot.wheel_index(name));
                    if let (Some(wheel), Some(slip)) = (wheel, slip.number())
                        && slip.is_finite()
                    {
                        truth.wheels[wheel].push((message.time_ns as f64, slip));
                    }
                }
            }
        }
        // Files and stamps of a topic need not be in the order of time, but are on one clock.
        for wheel in &mut truth.wheels {
            wheel.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        truth.some().ok_or_else(|| Error::NoTruth {
            source_name: topic.to_owned(),
        })
    }

    /// `None` of no slip at all.
    fn some(self) -> Option<Self> {
        (!self.wheels.iter().all(Vec::is_empty)).then_some(self)
    }

    fn new(robot: &Robot, is_on_clock: bool) -> Self {
        let wheels = robot.wheels();
        Self {
            names: wheels.iter().map(|wheel| wheel.name.clone()).collect(),
            wheels: vec![Vec::new(); wheels.len()],
            is_on_clock,
        }
    }

    /// A sink that keeps the estimates for comparison: about 40 bytes each.
    #[must_use]
    pub fn compare(self) -> Compared {
        Compared {
            estimates: vec![Vec::new(); self.wheels.len()],
            start_ns: None,
            truth: self,
        }
    }
}

/// Estimates kept beside their truth.
#[derive(Clone, Debug)]
pub struct Compared {
    truth: Truth,
    estimates: Vec<Vec<Estimate>>,
    start_ns: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
struct Estimate {
    time_s: f64,
    slip: f64,
    sigma: Option<f64>,
    is_ok: bool,
}

/// An estimated slip with its 90 % interval, next to the true one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ComparedSlip {
    /// Seconds since the log's start.
    pub time_s: f64,
    /// The estimate.
    pub slip: f64,
    /// Its 90 % interval, within the slips that exist (−1 to 1).
    pub interval_90: Option<[f64; 2]>,
    /// The true slip, where it is known.
    pub truth: Option<f64>,
}

impl Sink for Compared {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        if let Some(slip) = row.slip {
            self.estimates[row.wheel].push(Estimate {
                time_s: row.time_s,
                slip,
                sigma: row.slip_sigma,
                is_ok: row.health == Health::Ok,
            });
        }
        Ok(())
    }

    fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        let start = step.time_ns as f64 - step.time_s * 1e9;
        self.start_ns.get_or_insert(start);
        Ok(())
    }
}

impl Compared {
    /// The true slip over time of each wheel that has one, with its name: s from the log's start, and slip. At most 4096 points
    /// a wheel, evenly chosen.
    #[must_use]
    pub fn lines(&self) -> Vec<(String, Vec<[f64; 2]>)> {
        let all = self.truth.names.iter().zip(&self.truth.wheels);
        all.filter(|(_, truth)| !truth.is_empty())
            .map(|(name, truth)| {
                let every = truth.len().div_ceil(MAX_LINE_POINTS);
                let points = self.since_start(truth).into_iter().step_by(every);
                (
                    name.clone(),
                    points.map(|(time, slip)| [time, slip]).collect(),
                )
            })
            .collect()
    }

    /// Every estimated slip of each wheel that has a truth, with its name.
    #[must_use]
    pub fn slips(&self) -> Vec<(String, Vec<ComparedSlip>)> {
        let all = self.truth.names.iter().zip(&self.truth.wheels);
        all.zip(&self.estimates)
            .filter(|((_, truth), _)| !truth.is_empty())
            .map(|((name, truth), estimates)| {
                let truth = self.since_start(truth);
                let of = |estimate: &Estimate| ComparedSlip {
                    time_s: estimate.time_s,
                    slip: estimate.slip,
                    interval_90: estimate.sigma.map(|sigma| {
                        [-1.0, 1.0]
                            .map(|sign| (estimate.slip + sign * SIGMAS_90 * sigma).clamp(-1.0, 1.0))
                    }),
                    truth: at(&truth, estimate.time_s),
                };
                (name.clone(), estimates.iter().map(of).collect())
            })
            .collect()
    }

    /// Truth by the time from the log's start, s.
    fn since_start(&self, truth: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let start = self.start_ns.unwrap_or(0.0);
        let seconds = |&(time, slip): &(f64, f64)| ((time - start) * 1e-9, slip);
        if self.truth.is_on_clock {
            truth.iter().map(seconds).collect()
        } else {
            truth.to_vec()
        }
    }

    /// The errors of each wheel that has a truth.
    #[must_use]
    pub fn errors(&self) -> Vec<TruthError> {
        let all = self
            .truth
            .names
            .iter()
            .zip(&self.truth.wheels)
            .zip(&self.estimates);
        all.filter(|((_, truth), _)| !truth.is_empty())
            .map(|((name, truth), estimates)| errors_of(name, &self.since_start(truth), estimates))
            .collect()
    }
}

/// The truth at a time, where it is known.
fn at(truth: &[(f64, f64)], time: f64) -> Option<f64> {
    let next = truth.partition_point(|sample| sample.0 < time);
    let after = *truth.get(next)?;
    if after.0 == time {
        return Some(after.1);
    }
    let before = truth[next.checked_sub(1)?];
    let gap = after.0 - before.0;
    (gap <= MAX_GAP_S).then(|| before.1 + (after.1 - before.1) * (time - before.0) / gap)
}

fn errors_of(name: &str, truth: &[(f64, f64)], estimates: &[Estimate]) -> TruthError {
    let (mut count, mut sum, mut squares) = (0_u32, 0.0, 0.0);
    let (mut sure, mut nees, mut covered) = (0_u32, 0.0, 0_u32);
    let mut compared_s: Option<[f64; 2]> = None;
    for estimate in estimates {
        let Some(truth) = at(truth, estimate.time_s) else {
            continue;
        };
        let error = estimate.slip - truth;
        let first_s = compared_s.map_or(estimate.time_s, |[first, _]| first);
        compared_s = Some([first_s, estimate.time_s]);
        count += 1;
        sum += error;
        squares += error * error;
        let sigma = estimate.sigma.filter(|_| estimate.is_ok);
        if let Some(sigma) = sigma.filter(|sigma| *sigma > 0.0) {
            sure += 1;
            nees += Real::powi(error / sigma, 2);
            covered += u32::from(error.abs() <= SIGMAS_90 * sigma);
        }
    }
    let (lag_s, is_lag_beyond) = match lag(truth, estimates) {
        Some(Lag::Within(lag_s)) => (Some(lag_s), false),
        Some(Lag::Beyond) => (None, true),
        None => (None, false),
    };
    let mean = |sum: f64, count: u32| (count > 0).then(|| sum / f64::from(count));
    TruthError {
        wheel: name.to_owned(),
        count: count.into(),
        estimates: estimates.len() as u64,
        truth_s: ends(truth, |sample| sample.0),
        estimates_s: ends(estimates, |estimate| estimate.time_s),
        compared_s,
        rmse: mean(squares, count).map(f64::sqrt),
        bias: mean(sum, count),
        nees: mean(nees, sure),
        coverage_90: mean(covered.into(), sure),
        lag_s,
        is_lag_beyond,
    }
}

/// The times of the first and the last.
fn ends<T>(all: &[T], time_s: fn(&T) -> f64) -> Option<[f64; 2]> {
    Some([time_s(all.first()?), time_s(all.last()?)])
}

/// By how much estimates are late.
enum Lag {
    /// By this time, s.
    Within(f64),
    /// By a time at the edge of those that are compared.
    Beyond,
}

/// The delay of the truth at which the estimates are nearest to it.
fn lag(truth: &[(f64, f64)], estimates: &[Estimate]) -> Option<Lag> {
    let delays: Vec<f64> = (-MAX_LAG_STEPS..=MAX_LAG_STEPS)
        .map(|step| f64::from(step) * LAG_STEP_S)
        .collect();
    let mut costs = vec![0.0; delays.len()];
    let mut known = Vec::new();
    for estimate in estimates {
        // The same estimates for every delay, or those without a truth would choose it.
        let truths = delays
            .iter()
            .map(|delay| at(truth, estimate.time_s - delay));
        let Some(truths) = truths.collect::<Option<Vec<f64>>>() else {
            continue;
        };
        for (cost, truth) in costs.iter_mut().zip(&truths) {
            *cost += Real::powi(estimate.slip - truth, 2);
        }
        known.extend(at(truth, estimate.time_s));
    }
    let mean = known.iter().sum::<f64>() / known.len() as f64;
    let variance = known.iter().map(|s| Real::powi(s - mean, 2)).sum::<f64>() / known.len() as f64;
    if !(variance > MIN_VARIATION * MIN_VARIATION) {
        return None;
    }
    let best = (0..costs.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b]))?;
    if best == 0 || best + 1 == costs.len() {
        return Some(Lag::Beyond);
    }
    Some(Lag::Within(delays[best]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_estimate_of_a_step_has_its_lag_and_right_sigmas_have_nees_one() {
        let truth: Vec<(f64, f64)> = (0..1000)
            .map(|i| (f64::from(i) * 0.01, if i < 500 { 0.1 } else { 0.4 }))
            .collect();
        let estimates: Vec<Estimate> = (0..1000)
            .map(|i| Estimate {
                time_s: f64::from(i) * 0.01,
                slip: if i < 530 { 0.1 } else { 0.4 } + if i % 2 == 0 { 0.01 } else { -0.01 },
                sigma: Some(0.01),
                is_ok: true,
            })
            .collect();
        let found = errors_of("left", &truth, &estimates);
        assert_eq!(found.count, 1000);
        assert!((found.lag_s.unwrap() - 0.3).abs() < 0.021, "{found:?}");
        assert!((found.coverage_90.unwrap() - 0.97).abs() < 1e-9);
        // thirty samples of thirty sigma
        assert!((found.nees.unwrap() - (0.97 + 0.03 * 900.0)).abs() < 2.0);
        let on_time = errors_of("left", &truth, &estimates[530..]);
        assert!((on_time.nees.unwrap() - 1.0).abs() < 1e-9 && on_time.lag_s.is_none());
        assert!(at(&[(0.0, 0.1), (2.0, 0.2)], 1.0).is_none());
    }

    #[test]
    fn a_lag_is_found_on_both_sides_and_not_at_the_edge_nor_between_rare_truths() {
        let slip = |time_s: f64| 0.2 + 0.1 * Real::sin(0.7 * time_s);
        let truth = |every: usize, late_s: f64| -> Vec<(f64, f64)> {
            let times = (0..2000).step_by(every).map(|i| f64::from(i) * 0.01);
            times.map(|time| (time + late_s, slip(time))).collect()
        };
        let estimates: Vec<Estimate> = (0..2000)
            .map(|i| f64::from(i) * 0.01)
            .map(|time_s| Estimate {
                time_s,
                slip: slip(time_s - 0.3),
                sigma: Some(0.01),
                is_ok: true,
            })
            .collect();
        for (late_s, lag_s) in [(0.0, 0.3), (0.8, -0.5), (-0.6, 0.9)] {
            let found = errors_of("left", &truth(1, late_s), &estimates);
            assert!(
                (found.lag_s.unwrap() - lag_s).abs() < 0.011,
                "{late_s}: {found:?}"
            );
            assert!(!found.is_lag_beyond);
        }
        for late_s in [2.0, -1.0] {
            let found = errors_of("left", &truth(1, late_s), &estimates);
            assert!(
                found.is_lag_beyond && found.lag_s.is_none(),
                "{late_s}: {found:?}"
            );
        }
        // once a second: between them no truth is known
        let found = errors_of("left", &truth(100, 0.0), &estimates);
        assert_eq!((found.count, found.estimates), (20, 2000));
        assert_eq!(found.compared_s, Some([0.0, 19.0]));
        assert!(
            found.lag_s.is_none() && !found.is_lag_beyond && found.rmse.is_some(),
            "{found:?}"
        );
    }
}
