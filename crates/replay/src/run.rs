//! One log through the estimator.

use grouser_files::robot::{RobotFile, WheelSensor};
use grouser_log::Log;
use grouser_slip::{Drive, Estimate, Estimator, Health, Motion, Reference, Slip, WheelEstimate};

use crate::align::gyro_offset;
use crate::backward::{Backward, joined};
use crate::choice;
use crate::error::{Error, Result};
use crate::fusion::Fusion;
use crate::quantiles::Quantiles;
use crate::samples::{sample, wheel_of};
use crate::summary::{
    AlongSummary, Shares, Spread, Status, Summary, WheelSummary, YawSummary, overall,
};

/// How the slips of wheels are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// By the filter of all sensors ([`grouser_slip::filter`]): a slip at each reading.
    Filter,
    /// By means over a window, wheels against one reference and nothing else.
    Window,
}

impl Method {
    /// Every method.
    pub const ALL: [Self; 2] = [Self::Filter, Self::Window];

    /// Its name in flags and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Filter => "filter",
            Self::Window => "window",
        }
    }
}

/// What may be asked for beyond what the files say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// How the slips of wheels are found; `None`: by the filter, but by means over a window where the reference is
    /// [`Reference::Grip`]: slips against the wheel that grips best are all that is observable then, and a filter would
    /// answer with what it believed before.
    pub method: Option<Method>,
    /// Forwards and backwards over the log, by the filter: each moment by what came before and after it.
    pub smooth: bool,
    /// What tells how fast the robot travels; `None`: the robot file's, else the best in the log.
    pub reference: Option<Reference>,
    /// By which sensor the wheels are measured; `None`: the robot file's, else the first in the log.
    pub wheel_sensor: Option<WheelSensor>,
    /// The window of the estimates, s; `None`: the robot file's.
    pub window_s: Option<f64>,
    /// What lies before this is left out of rows and summary, s from the log's start.
    pub from_s: Option<f64>,
    /// What lies after this is left out, s from the log's start.
    pub to_s: Option<f64>,
}

/// One wheel at one time, as a row of the output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<'a> {
    /// Seconds since the log's start.
    pub time_s: f64,
    /// The wheel's index in the robot's order.
    pub wheel: usize,
    /// The wheel's name.
    pub name: &'a str,
    /// Its slip, where it has one.
    pub slip: Option<f64>,
    /// Standard deviation of its error.
    pub slip_sigma: Option<f64>,
    /// How it moves, where that is known.
    pub motion: Option<Motion>,
    /// How far this can be trusted.
    pub health: Health,
}

/// The whole robot at one time: when some wheel was read.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// When, ns on the log's clock.
    pub time_ns: i64,
    /// Seconds since the log's start.
    pub time_s: f64,
    /// The window of the estimate, s.
    pub window_s: f64,
    /// What is known.
    pub estimate: &'a Estimate<'a>,
}

/// Whoever takes what a run gives.
pub trait Take {
    /// One wheel, whenever it was read.
    ///
    /// # Errors
    /// What ends the run.
    fn row(&mut self, row: &Row<'_>) -> std::io::Result<()>;

    /// The whole robot, after the rows of one time.
    ///
    /// # Errors
    /// What ends the run.
    fn step(&mut self, step: &Step<'_>) -> std::io::Result<()> {
        let _ = step;
        Ok(())
    }
}

/// Takes rows alone.
struct Rows<F>(F);

impl<F: FnMut(&Row<'_>) -> std::io::Result<()>> Take for Rows<F> {
    fn row(&mut self, row: &Row<'_>) -> std::io::Result<()> {
        (self.0)(row)
    }
}

/// Runs a log through the estimator; `take` gets a row for every wheel whenever that wheel was read.
///
/// # Errors
/// Whatever makes the log useless; an [`Error::Sink`](crate::Error::Sink) of `take`'s own.
pub fn run(
    log: &Log,
    file: &RobotFile,
    options: &Options,
    take: impl FnMut(&Row<'_>) -> std::io::Result<()>,
) -> Result<Summary> {
    run_with(log, file, options, &mut Rows(take))
}

/// As [`run`], for one who takes more than rows.
///
/// # Errors
/// As [`run`].
pub fn run_with(
    log: &Log,
    file: &RobotFile,
    options: &Options,
    take: &mut impl Take,
) -> Result<Summary> {
    let mut replay = Replay::new(log, file, options)?;
    let shifts = replay.align(log, file)?;
    if options.smooth {
        let chosen = (
            &replay.wheels[..],
            replay.sensor,
            replay.estimator.settings().reference,
        );
        replay.backward = Some(Backward::new(log, file, chosen, &shifts)?);
    }
    for record in log.records(&shifts)? {
        let record = record?;
        if replay.group_ns.is_some_and(|group| group != record.time_ns) {
            replay.close_group(take)?;
        }
        replay.group_ns = Some(record.time_ns);
        replay.start_ns.get_or_insert(record.time_ns);
        let Some(sample) = sample(&record, &replay.wheels, replay.sensor) else {
            continue;
        };
        // A refused sample is counted by the estimator; its wheel still gets its row.
        let _refused = replay.estimator.update(sample);
        if let Some(fusion) = &mut replay.fusion {
            fusion.update(sample);
        }
        if let Some(wheel) = wheel_of(&sample.measurement) {
            replay.tallies[wheel].was_read = true;
        }
    }
    replay.close_group(take)?;
    Ok(replay.summary())
}

struct Replay<'a> {
    file: &'a RobotFile,
    wheels: Vec<usize>,
    sensor: WheelSensor,
    estimator: Estimator,
    /// By the filter's method.
    fusion: Option<Fusion>,
    backward: Option<Backward>,
    /// The wheels by both directions.
    smoothed: Vec<WheelEstimate>,
    window: f64,
    span: (f64, f64),
    start_ns: Option<i64>,
    group_ns: Option<i64>,
    tallies: Vec<Tally>,
    along: Quantiles,
    along_until_ns: Option<i64>,
    /// Ways at the beginning of the span that is asked for.
    travel_before: Option<(f64, f64)>,
    travel: (f64, f64),
    yaw: Quantiles,
    clock_offset_s: Option<f64>,
}

/// What is counted of one wheel.
struct Tally {
    was_read: bool,
    slips: Quantiles,
    shares: Shares,
    last_ns: Option<i64>,
}

impl<'a> Replay<'a> {
    fn new(log: &Log, file: &'a RobotFile, options: &Options) -> Result<Self> {
        let wheels = choice::wheel_indices(log, file)?;
        let sensor = choice::wheel_sensor(log, file, options.wheel_sensor)?;
        let mut settings = file.settings;
        settings.reference = choice::reference(log, file, sensor, options.reference)?;
        settings.window = options.window_s.unwrap_or(settings.window);
        let method = options.method.unwrap_or(match settings.reference {
            Reference::Grip => Method::Window,
            _ => Method::Filter,
        });
        if options.smooth && method == Method::Window {
            return Err(Error::NothingToSmooth);
        }
        let tally = |_| Tally {
            was_read: false,
            slips: Quantiles::new(-1.0, 1.0),
            shares: Shares::new(),
            last_ns: None,
        };
        Ok(Self {
            wheels,
            sensor,
            estimator: Estimator::new(&file.robot, settings)?,
            backward: None,
            smoothed: Vec::new(),
            fusion: match method {
                Method::Filter => Some(Fusion::new(file, settings.reference)?),
                Method::Window => None,
            },
            window: settings.window,
            span: (
                options.from_s.unwrap_or(f64::NEG_INFINITY),
                options.to_s.unwrap_or(f64::INFINITY),
            ),
            start_ns: None,
            group_ns: None,
            tallies: file.robot.wheels().iter().map(tally).collect(),
            along: Quantiles::new(-1.0, 1.0),
            along_until_ns: None,
            travel_before: None,
            travel: (0.0, 0.0),
            yaw: Quantiles::new(0.0, 1.0),
            clock_offset_s: None,
            file,
        })
    }

    /// The shift of each source's clock.
    fn align(&mut self, log: &Log, file: &RobotFile) -> Result<Vec<i64>> {
        let unaligned = log.unaligned_sources();
        let mut shifts = vec![0; log.sources()];
        if !unaligned.is_empty() {
            self.clock_offset_s = gyro_offset(log, file, &self.wheels, self.sensor)?;
            #[allow(
                clippy::cast_possible_truncation,
                reason = "the offset is at most half a second"
            )]
            let shift_ns = (self.clock_offset_s.unwrap_or(0.0) * -1e9).round() as i64;
            for source in unaligned {
                shifts[source] = shift_ns;
            }
        }
        Ok(shifts)
    }

    /// All records of one time have been taken: rows for the wheels that were read.
    fn close_group(&mut self, take: &mut impl Take) -> Result<()> {
        let (Some(start), Some(now)) = (self.start_ns, self.group_ns) else {
            return Ok(());
        };
        let time_s = now.saturating_sub(start) as f64 * 1e-9;
        let wanted = time_s >= self.span.0 && time_s <= self.span.1;
        let Some(mut estimate) = self.estimator.latest() else {
            return Ok(());
        };
        if let Some(fusion) = &self.fusion {
            estimate.wheels = match self.backward.as_mut().and_then(|all| all.at(now)) {
                Some(after) => {
                    self.smoothed.clear();
                    let wheels = fusion.wheels().iter().zip(&after);
                    self.smoothed
                        .extend(wheels.map(|(wheel, after)| smoothed(wheel, *after)));
                    &self.smoothed
                }
                None => fusion.wheels(),
            };
            estimate.body.motion = Some(fusion.motion());
        }
        let mut any = false;
        for (index, tally) in self.tallies.iter_mut().enumerate() {
            if !std::mem::take(&mut tally.was_read) {
                continue;
            }
            any = true;
            let last = tally.last_ns.replace(now);
            if !wanted {
                continue;
            }
            let wheel = &estimate.wheels[index];
            let described = &self.file.robot.wheels()[index];
            // What a reference skids itself is not measured.
            let is_reference = described.drive == Drive::Free
                && self.estimator.settings().reference == Reference::FreeWheel;
            let slip = wheel.slip.filter(|_| !is_reference);
            let row = Row {
                time_s,
                wheel: index,
                name: &described.name,
                slip: slip.map(grouser_slip::Slip::value),
                slip_sigma: wheel.sigma.filter(|_| slip.is_some()),
                motion: wheel.motion,
                health: wheel.health,
            };
            if let Some(slip) = row.slip {
                tally.slips.add(slip);
            }
            // A gap in the log is no time in a state.
            let since = last.map_or(0.0, |last| now.saturating_sub(last) as f64 * 1e-9);
            tally
                .shares
                .add(row.motion, row.health, since.min(self.window));
            take.row(&row)?;
        }
        if any && wanted {
            take.step(&Step {
                time_ns: now,
                time_s,
                window_s: self.window,
                estimate: &estimate,
            })?;
        }
        let body = estimate.body;
        if !wanted {
            if time_s < self.span.0 {
                self.travel_before = Some((body.travel_wheels, body.travel_reference));
            }
            return Ok(());
        }
        self.travel = (body.travel_wheels, body.travel_reference);
        if body.until_ns == self.along_until_ns || body.until_ns.is_none() {
            return Ok(());
        }
        self.along_until_ns = body.until_ns;
        if let Some(slip) = body.along {
            self.along.add(slip.value());
        }
        let powered = estimate.wheels.iter().zip(self.file.robot.wheels());
        let rims = powered
            .filter(|(_, wheel)| wheel.drive == Drive::Powered)
            .filter_map(|(estimate, _)| Some(estimate.rim_speed?.value.abs()));
        let (sum, count) = rims.fold((0.0, 0.0), |(sum, count), rim| (sum + rim, count + 1.0));
        let moving = sum > count * self.estimator.settings().low_speed;
        if let (true, Some(wheels), Some(gyro)) = (moving, body.wheels_yaw_rate, body.yaw_rate) {
            self.yaw
                .add((wheels.value - gyro.value).abs() * self.window);
        }
        Ok(())
    }

    fn summary(self) -> Summary {
        let robot = &self.file.robot;
        let reference = self.estimator.settings().reference;
        let duration_s = match (self.start_ns, self.group_ns) {
            (Some(start), Some(end)) => end.saturating_sub(start) as f64 * 1e-9,
            _ => 0.0,
        };
        let fused = self.fusion.as_ref().map(Fusion::summary);
        let rejected = match &self.fusion {
            Some(fusion) => fusion.rejected(),
            None => self.estimator.rejected(),
        };
        let none = self.tallies.iter().all(|tally| tally.slips.count() == 0);
        let wheels = robot.wheels().iter().zip(&self.tallies);
        let before = self.travel_before.unwrap_or_default();
        let (travel_wheels, travel_reference) =
            (self.travel.0 - before.0, self.travel.1 - before.1);
        Summary {
            status: if none { Status::NoSlip } else { Status::Done },
            window_s: self.window,
            reference,
            wheel_sensor: self.sensor.name(),
            duration_s,
            wheels: wheels
                .map(|(wheel, tally)| WheelSummary {
                    name: wheel.name.clone(),
                    is_reference: wheel.drive == Drive::Free && reference == Reference::FreeWheel,
                    slip: Spread::from(&tally.slips),
                    states: tally.shares.motions(),
                    healths: tally.shares.healths(),
                })
                .collect(),
            along: AlongSummary {
                slip: Spread::from(&self.along),
                overall: overall(travel_reference, travel_wheels),
                travel_wheels,
                travel_reference,
            },
            yaw: (self.yaw.count() > 0).then(|| YawSummary {
                residual: Spread::from(&self.yaw),
                window: self.window,
            }),
            clock_offset_s: self.clock_offset_s,
            fused,
            rejected,
        }
    }
}

/// A wheel by what was known before and after.
fn smoothed(wheel: &WheelEstimate, after: Option<(f64, f64)>) -> WheelEstimate {
    let (Some(slip), Some(sigma), Some(after)) = (wheel.slip, wheel.sigma, after) else {
        return *wheel;
    };
    let (slip, sigma) = joined((slip.value(), sigma), after);
    WheelEstimate {
        slip: Slip::new(slip).ok(),
        sigma: Some(sigma),
        ..*wheel
    }
}
