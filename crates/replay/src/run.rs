//! One log through the estimator.

use std::f64::consts::PI;

use grouser_files::robot::{RobotFile, WheelSensor};
use grouser_log::Log;
use grouser_slip::window::{WindowBody, WindowEstimator};
use grouser_slip::{Health, Motion, Reference, Slip, WheelEstimate, WheelRole};

use crate::align::gyro_offset;
use crate::choice;
use crate::dead_reckoning::{DeadReckoning, Odometry};
use crate::error::{Error, Result};
use crate::fusion::Fusion;
use crate::method::Method;
use crate::moment::{Moment, side_slip_angle};
use crate::quantiles::Quantiles;
use crate::samples::{sample, wheel_of};
use crate::summary::{
    AlongSummary, Shares, Spread, Status, Summary, WheelSummary, YawSummary, overall,
};
use crate::turn_watch::TurnWatch;

/// What may be asked for beyond what the files say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Which engine finds the slips; `None`: the filter where something tells how fast the robot travels.
    pub method: Option<Method>,
    /// Runs the filter forward and backward: every slip is then what the whole log says of it.
    pub smooth: bool,
    /// What tells how fast the robot travels; `None`: the robot file's, else the best in the log.
    pub reference: Option<Reference>,
    /// By which sensor the wheels are measured; `None`: the robot file's, else the first in the log.
    pub wheel_sensor: Option<WheelSensor>,
    /// The window of means, s; `None`: the robot file's.
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
    /// From its heading to the way of its centre, to the left positive, rad, where it moves.
    pub side_slip_angle: Option<f64>,
}

/// The whole robot at one time: when some wheel was read.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// When, ns on the log's clock.
    pub time_ns: i64,
    /// Seconds since the log's start.
    pub time_s: f64,
    /// Each wheel, in the robot's order.
    pub wheels: &'a [WheelEstimate],
    /// The angle of each wheel's way, as in [`Row::side_slip_angle`].
    pub side_slip_angles: &'a [Option<f64>],
    /// Where the robot is and how it moves, corrected for slip; `None` where nothing new is known of it.
    pub odometry: Option<Odometry>,
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
        // A refused sample is counted by the engines; its wheel still gets its row.
        let _refused = replay.estimator.update(sample);
        if let Some(fusion) = &mut replay.fusion {
            fusion.update(sample);
        }
        if let Some(wheel) = wheel_of(&sample.measurement) {
            replay.read |= 1 << wheel;
        }
    }
    replay.close_group(take)?;
    let left = replay.fusion.as_mut().map(Fusion::finish).transpose()?;
    for moment in left.unwrap_or_default() {
        replay.deliver(moment, take)?;
    }
    Ok(replay.summary())
}

struct Replay<'a> {
    file: &'a RobotFile,
    wheels: Vec<usize>,
    sensor: WheelSensor,
    /// Ways, turns and means over windows, whatever finds the slips.
    estimator: WindowEstimator,
    fusion: Option<Fusion>,
    window: f64,
    span: (f64, f64),
    start_ns: Option<i64>,
    group_ns: Option<i64>,
    /// The wheels that were read at the time at hand, bit by bit.
    read: u64,
    tallies: Vec<Tally>,
    along: Quantiles,
    along_until_ns: Option<i64>,
    /// Ways at the beginning of the span that is asked for.
    travel_before: Option<(f64, f64)>,
    travel: (f64, f64),
    yaw: Quantiles,
    clock_offset_s: Option<f64>,
    turns: Option<TurnWatch>,
    reckoning: DeadReckoning,
    odometry: Option<Odometry>,
}

/// What is counted of one wheel.
struct Tally {
    slips: Quantiles,
    angles: Quantiles,
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
        let method = options
            .method
            .unwrap_or_else(|| Method::of(&file.robot, settings.reference));
        let fusion = match method {
            Method::Filter => Some(Fusion::new(file, &settings, options.smooth)?),
            Method::Window if options.smooth => return Err(Error::NothingToSmooth),
            Method::Window => None,
        };
        let tally = |_| Tally {
            slips: Quantiles::new(-1.0, 1.0),
            angles: Quantiles::new(-PI, PI),
            shares: Shares::new(),
            last_ns: None,
        };
        Ok(Self {
            wheels,
            sensor,
            estimator: WindowEstimator::new(&file.robot, settings)?,
            fusion,
            turns: TurnWatch::new(&file.robot, settings.low_speed, settings.window),
            reckoning: DeadReckoning::new(settings.window),
            odometry: None,
            window: settings.window,
            span: (
                options.from_s.unwrap_or(f64::NEG_INFINITY),
                options.to_s.unwrap_or(f64::INFINITY),
            ),
            start_ns: None,
            group_ns: None,
            read: 0,
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

    /// Seconds from the log's start, and whether they lie in the span that is asked for.
    fn when(&self, time_ns: i64) -> (f64, bool) {
        let start_ns = self.start_ns.unwrap_or(time_ns);
        let time_s = time_ns.saturating_sub(start_ns) as f64 * 1e-9;
        (time_s, time_s >= self.span.0 && time_s <= self.span.1)
    }

    /// All records of one time have been taken.
    fn close_group(&mut self, take: &mut impl Take) -> Result<()> {
        let Some(now) = self.group_ns else {
            return Ok(());
        };
        let read = std::mem::take(&mut self.read);
        let Some(estimate) = self.estimator.latest() else {
            return Ok(());
        };
        let body = estimate.body;
        let rims = rim_speed(estimate.wheels, self.file);
        let (time_s, wanted) = self.when(now);
        if let Some(turns) = self.turns.as_mut().filter(|_| wanted) {
            turns.take(time_s, estimate.wheels, &body);
        }
        let moments = match &mut self.fusion {
            None => vec![Moment::by_window(now, read, estimate.wheels, &body)],
            Some(fusion) => fusion.close(now, read, &body)?,
        };
        self.count_ways(now, &body, rims);
        for moment in moments {
            self.deliver(moment, take)?;
        }
        Ok(())
    }

    /// What a moment says goes to tallies and to whoever takes it.
    fn deliver(&mut self, mut moment: Moment, take: &mut impl Take) -> Result<()> {
        let now = moment.time_ns;
        let (time_s, wanted) = self.when(now);
        let robot = self.file.robot.wheels();
        let reference = self.estimator.settings().reference;
        let least = self.estimator.settings().low_speed;
        for (wheel, described) in moment.wheels.iter_mut().zip(robot) {
            // against itself a reference does not slip
            if described.role == WheelRole::Free && reference == Reference::FreeWheel {
                (wheel.slip, wheel.sigma) = (None, None);
                if wheel.motion == Some(Motion::Braking) {
                    wheel.motion = Some(Motion::Driving);
                }
            }
        }
        let angles: Vec<_> = robot
            .iter()
            .map(|wheel| side_slip_angle(wheel, moment.motion.as_ref(), least))
            .collect();
        for (index, tally) in self.tallies.iter_mut().enumerate() {
            if moment.read >> index & 1 == 0 {
                continue;
            }
            let last = tally.last_ns.replace(now);
            if !wanted {
                continue;
            }
            let wheel = &moment.wheels[index];
            let row = Row {
                time_s,
                wheel: index,
                name: &robot[index].name,
                slip: wheel.slip.map(Slip::value),
                slip_sigma: wheel.sigma,
                motion: wheel.motion,
                health: wheel.health,
                side_slip_angle: angles[index],
            };
            if let Some(slip) = row.slip {
                tally.slips.add(slip);
            }
            if let Some(angle) = row.side_slip_angle {
                tally.angles.add(angle);
            }
            // A gap in the log is no time in a state.
            let since = last.map_or(0.0, |last| now.saturating_sub(last) as f64 * 1e-9);
            tally
                .shares
                .add(row.motion, row.health, since.min(self.window));
            take.row(&row)?;
        }
        if moment.read != 0 && wanted {
            let odometry = self.reckoning.step(&moment);
            self.odometry = odometry.or(self.odometry);
            take.step(&Step {
                time_ns: now,
                time_s,
                wheels: &moment.wheels,
                side_slip_angles: &angles,
                odometry,
            })?;
        }
        Ok(())
    }

    /// Ways, slip along the track and turns, as means over windows.
    fn count_ways(&mut self, now: i64, body: &WindowBody, (sum, count): (f64, f64)) {
        let (time_s, wanted) = self.when(now);
        if !wanted {
            if time_s < self.span.0 {
                self.travel_before = Some((body.travel_wheels, body.travel_reference));
            }
            return;
        }
        self.travel = (body.travel_wheels, body.travel_reference);
        if body.until_ns == self.along_until_ns || body.until_ns.is_none() {
            return;
        }
        self.along_until_ns = body.until_ns;
        if let Some(slip) = body.along {
            self.along.add(slip.value());
        }
        let moving = sum > count * self.estimator.settings().low_speed;
        if let (true, Some(wheels), Some(gyro)) = (moving, body.wheels_yaw_rate, body.yaw_rate) {
            self.yaw
                .add((wheels.value - gyro.value).abs() * self.window);
        }
    }

    fn summary(self) -> Summary {
        let robot = &self.file.robot;
        let reference = self.estimator.settings().reference;
        let duration_s = match (self.start_ns, self.group_ns) {
            (Some(start), Some(end)) => end.saturating_sub(start) as f64 * 1e-9,
            _ => 0.0,
        };
        let fused = self.fusion.as_ref().map(Fusion::summary);
        let rejected = fused
            .as_ref()
            .map_or_else(|| self.estimator.rejected(), |fused| fused.rejected);
        let none = self.tallies.iter().all(|tally| tally.slips.count() == 0);
        let wheels = robot.wheels().iter().zip(&self.tallies);
        let before = self.travel_before.unwrap_or_default();
        let (travel_wheels, travel_reference) =
            (self.travel.0 - before.0, self.travel.1 - before.1);
        Summary {
            status: if none { Status::NoSlip } else { Status::Done },
            method: if fused.is_some() {
                Method::Filter
            } else {
                Method::Window
            },
            window_s: self.window,
            reference,
            wheel_sensor: self.sensor.name(),
            duration_s,
            wheels: wheels
                .map(|(wheel, tally)| WheelSummary {
                    name: wheel.name.clone(),
                    is_reference: wheel.role == WheelRole::Free
                        && reference == Reference::FreeWheel,
                    slip: Spread::from(&tally.slips),
                    side_slip_angle: Spread::from(&tally.angles),
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
            turns: self.turns.as_ref().map(TurnWatch::summary),
            clock_offset_s: self.clock_offset_s,
            odometry: self.odometry,
            fused,
            rejected,
        }
    }
}

/// Sum and number of the powered wheels' rim speeds, m/s.
fn rim_speed(wheels: &[WheelEstimate], file: &RobotFile) -> (f64, f64) {
    let powered = wheels.iter().zip(file.robot.wheels());
    powered
        .filter(|(_, wheel)| wheel.role == WheelRole::Powered)
        .filter_map(|(estimate, _)| Some(estimate.rim_speed?.value.abs()))
        .fold((0.0, 0.0), |(sum, count), rim| (sum + rim, count + 1.0))
}
