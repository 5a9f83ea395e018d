//! The paper's run on sand, simulated: slip by the fifth wheel beside the truth (its figure 13).

use std::collections::VecDeque;
use std::fmt::Write as _; // writing to a string cannot fail

use grouser_files::Document;
use grouser_rover::drive::{Frame, Pilot, Scenario, Simulation, parse_scenario};
use grouser_rover::robot::RobotModel;
use grouser_slip::window::{WindowEstimator, WindowSettings};
use grouser_slip::{Measurement, Reference, Slip};

use crate::error::Result;
use grouser_figure::{Axis, Chart, Colour, Curve, Dash, Figure, Rule, Style};
use grouser_report::number::{exact, rounded};
use grouser_report::{Fields, fields};

/// The powered wheel that is shown: the larger of the two on the fifth wheel's arm, which drives like the other four.
const WHEEL: &str = "fifth";
/// Slower than this a slip is the quotient of two rests and is not compared, m/s.
const MIN_SLIP_SPEED_M_PER_S: f64 = 0.05;
/// Slip below which a wheel brakes, for the second panel.
const BRAKING_SLIP: f64 = -0.02;
/// Shown before and after the braking, s.
const SHOWN_AROUND_BRAKING_S: f64 = 2.5;

/// A moment.
#[derive(Clone, Copy, Debug)]
struct Point {
    time: f64,
    requested_speed: f64,
    truth: Option<f64>,
    measured: Option<f64>,
    sigma: Option<f64>,
}

impl Point {
    /// The measured slip as section 4.1 of the paper words it: 1 − v_powered/v_fifth, which has no lower bound.
    fn by_the_paper(&self) -> Option<f64> {
        let slip = self.measured.filter(|slip| *slip < 1.0)?;
        Some(if slip > 0.0 {
            -slip / (1.0 - slip)
        } else {
            -slip
        })
    }
}

/// The run.
pub(super) struct SandRun {
    points: Vec<Point>,
    pub(super) optimum: f64,
    seed: u64,
    pub(super) robot: RobotModel,
}

/// Means of rim and centre over the estimator's window.
#[derive(Default)]
struct Means(VecDeque<[f64; 2]>);

impl Means {
    /// The slip of the means, where the faster one is worth a quotient.
    fn add(&mut self, speeds: [f64; 2], length: usize) -> Option<f64> {
        self.0.push_back(speeds);
        while self.0.len() > length {
            self.0.pop_front();
        }
        let count = self.0.len() as f64;
        let mean = |which: usize| self.0.iter().map(|s| s[which]).sum::<f64>() / count;
        let (rim, centre) = (mean(0), mean(1));
        if self.0.len() < length || rim.abs().max(centre.abs()) < MIN_SLIP_SPEED_M_PER_S {
            return None;
        }
        Slip::from_speeds(centre, rim).ok().map(Slip::value)
    }
}

fn scenario(scenario: &str, robot: &str) -> Result<Scenario> {
    let robot = Document::from_text("five-wheel.toml", robot.to_owned())?;
    let robot = RobotModel::parse(&robot)?;
    let document = Document::from_text("sandbox.toml", scenario.to_owned())?;
    Ok(parse_scenario(&document, "sandbox", robot)?)
}

impl SandRun {
    /// Drives the shipped sandbox. Beside the loop, a second estimator sees the same readings and does what the paper
    /// does: speed by the free wheel alone, v = r ω (P23), and from it the slip (P24).
    pub(super) fn drive(text: &str, robot: &str) -> Result<Self> {
        let scenario = scenario(text, robot)?;
        let optimum = scenario.slip_setpoint()?;
        let robot = &scenario.robot.robot;
        let settings = WindowSettings {
            reference: Reference::FreeWheel,
            ..scenario.robot.settings
        };
        let mut estimator =
            WindowEstimator::new(robot, settings).map_err(grouser_rover::Error::from)?;
        let wheel = robot.wheel_index(WHEEL).unwrap_or(0);
        let mut means = Means::default();
        let mut points = Vec::new();
        let mut before = 0.0;
        let mut drive = Simulation::new(&scenario, Pilot::Controller, optimum, scenario.seed)?;
        drive.run(|frame: &Frame<'_>| {
            for sample in frame.samples {
                let raw = matches!(
                    sample.measurement,
                    Measurement::JointAngle { .. } | Measurement::MotorCurrent { .. }
                );
                if !raw {
                    // refused samples are counted; the figure shows the estimate from the rest
                    let _ = estimator.update(*sample);
                }
            }
            let period = frame.time - before;
            before = frame.time;
            let window = samples(settings.window, period);
            let seen = estimator
                .latest()
                .and_then(|estimate| estimate.wheels.get(wheel));
            points.push(Point {
                time: frame.time,
                requested_speed: frame.requested_speed,
                truth: means.add(frame.wheels[wheel].speeds, window),
                measured: seen.and_then(|seen| seen.slip).map(Slip::value),
                sigma: seen.and_then(|seen| seen.sigma),
            });
            true
        });
        Ok(Self {
            points,
            optimum,
            seed: scenario.seed,
            robot: scenario.robot,
        })
    }

    /// Root of the mean square of measured less true slip.
    pub(super) fn error(&self) -> Option<f64> {
        let off = self
            .points
            .iter()
            .filter_map(|p| Some(p.measured? - p.truth?));
        let (count, sum) = off.fold((0.0, 0.0), |(count, sum), off: f64| {
            (count + 1.0, sum + off * off)
        });
        (count > 0.0).then(|| (sum / count).sqrt())
    }

    /// What was done, in words.
    pub(super) fn about(&self) -> String {
        format!(
            "The paper's data of its run on sand are not published. In their place the shipped scenario sandbox.toml is \
             driven (seed {}; the controller's slip setpoint is {}): a box of dry sand with waves of 25 cm, forwards, a \
             stop, forwards faster, a stop, and back. The slip of the wheel {WHEEL} is measured as the paper does, from \
             the speed of its own encoder and that of the free fifth wheel, v = r ω, which is taken to roll without any \
             skid. Over the whole run it is within {} (root of the mean square) of the true slip; it is off the most in the \
             hollows, where the arm turns and the free wheel does not move as the other one does. Driving slip is \
             positive, braking slip negative. Section 4.1 of the paper words the roles of the two wheels the other way \
             round, 1 − v_powered/v_fifth: of a wheel that spins at more than twice the robot's speed that is below \
             −100 %, without any noise (panel c; {} of the readings).",
            self.seed,
            rounded(self.optimum, 3),
            self.error()
                .map_or_else(|| "—".to_owned(), |error| rounded(error, 3)),
            rounded(self.beyond_whole(), 2),
        )
    }

    /// Share of the readings as the paper words them that lie below −1.
    fn beyond_whole(&self) -> f64 {
        let worded: Vec<f64> = self.points.iter().filter_map(Point::by_the_paper).collect();
        worded.iter().filter(|slip| **slip < -1.0).count() as f64 / worded.len().max(1) as f64
    }

    /// Three panels: the whole run, where it brakes the hardest, and the whole run as the paper words its slip. Nothing is cut off.
    pub(super) fn draw(&self) -> Figure {
        let end = self.points.last().map_or(1.0, |point| point.time);
        let whole = self.panel([0.0, end]);
        let close = self.panel(self.braking());
        let worded = self
            .points
            .iter()
            .filter_map(|point| Some([point.time, point.by_the_paper()?]));
        let worded = Chart::new(
            Axis::new("Time (s)").range(0.0, end),
            Axis::new("1 − *v*_{powered}/*v*_{fifth}"),
        )
        .rule(Rule::at_y(-1.0).style(Style::thin(Colour::GREY, Dash::Short)))
        .curve(Curve::new(worded).style(Style::numbered(0)));
        Figure::new("Slip against time by the fifth wheel beside the true slip, simulated")
            .panel(whole)
            .panel(close)
            .panel(worded)
    }

    /// A stretch of the run, as far as its slips reach.
    fn panel(&self, times: [f64; 2]) -> Chart {
        let within = |point: &&Point| (times[0]..=times[1]).contains(&point.time);
        let slips = self
            .points
            .iter()
            .filter(within)
            .flat_map(|point| [point.truth, point.measured]);
        let (low, high) = slips
            .flatten()
            .fold((0.0_f64, 0.0_f64), |(low, high), slip| {
                (low.min(slip), high.max(slip))
            });
        let tenths = |slip: f64| slip * 10.0;
        let slips = [
            (tenths(low) - 0.5).floor() / 10.0,
            (tenths(high) + 0.5).ceil() / 10.0,
        ];
        let line = |of: fn(&Point) -> Option<f64>| {
            self.points
                .iter()
                .map(move |point| [point.time, of(point).unwrap_or(f64::NAN)])
        };
        let truth = Style {
            colour: Colour::RED,
            dash: Dash::Solid,
            width: 1.5,
        };
        let measured = Style {
            colour: Colour::BLUE,
            dash: Dash::Dashed,
            width: 1.0,
        };
        let mut chart = Chart::new(
            Axis::new("Time (s)").range(times[0], times[1]),
            Axis::new("Slip ratio *s*").range(slips[0], slips[1]),
        )
        .curve(Curve::new(line(|p| p.truth)).style(truth).label("true"))
        .curve(
            Curve::new(line(|p| p.measured))
                .style(measured)
                .label("fifth wheel"),
        );
        if slips[1] >= self.optimum {
            let optimum = Rule::at_y(self.optimum).style(Style::thin(Colour::GREY, Dash::Short));
            chart = chart.rule(optimum);
        }
        chart
    }

    /// The stretch of the hardest braking, with what is around it, s.
    fn braking(&self) -> [f64; 2] {
        let brakes = |point: &Point| point.truth.is_some_and(|slip| slip < BRAKING_SLIP);
        let groups = self.points.chunk_by(|a, b| brakes(a) == brakes(b));
        let least = |group: &[Point]| {
            let slips = group.iter().filter_map(|point| point.truth);
            slips.fold(f64::INFINITY, f64::min)
        };
        let deepest = groups
            .filter(|group| brakes(&group[0]))
            .min_by(|a, b| least(a).total_cmp(&least(b)));
        let ends = deepest.and_then(|group| Some([group.first()?.time, group.last()?.time]));
        let last = self.points.last().map_or(1.0, |point| point.time);
        ends.map_or([0.0, last], |[from, to]| {
            [
                (from - SHOWN_AROUND_BRAKING_S).max(0.0),
                (to + SHOWN_AROUND_BRAKING_S).min(last),
            ]
        })
    }

    /// A row every hundredth of a second; what was not measured is empty.
    pub(super) fn csv(&self) -> String {
        let mut text = String::from(
            "time_s,requested_speed_m_per_s,slip_true,slip_fifth_wheel,slip_sigma,slip_as_worded\n",
        );
        let or_empty = |value: Option<f64>| value.map(exact).unwrap_or_default();
        for point in &self.points {
            let _ = writeln!(
                text,
                "{},{},{},{},{},{}",
                rounded(point.time, 2),
                exact(point.requested_speed),
                or_empty(point.truth),
                or_empty(point.measured),
                or_empty(point.sigma),
                or_empty(point.by_the_paper())
            );
        }
        text
    }

    pub(super) fn fields<'a>() -> Fields<'a, &'a Self> {
        fields! { |run: &'a Self|
            "scenario" "scenario" = "sandbox";
            "seed" "seed" = run.seed;
            "wheel" "wheel" = WHEEL;
            "slip_rmse" "root mean square error of its slip" = run.error();
        }
    }
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "rounded and within the range just given"
)]
fn samples(length: f64, period: f64) -> usize {
    (length / period.max(1e-6)).round().clamp(1.0, 1e5) as usize
}
