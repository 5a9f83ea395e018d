//! The stretches of a log: one command, one ground, straight.

use grouser_files::robot::RobotFile;
use grouser_log::Log;
use grouser_real::Real;
use grouser_slip::window::{WindowBody, WindowMeans};
use grouser_slip::{Reference, Robot, WheelRole};

use super::ripple::roller_ripple;
use super::stretch::{Roller, Stretch};
use crate::choice::Inputs;
use crate::effort::EffortUnit;
use crate::error::Result;
use crate::ground_change::{BLOCK_TIME_S, RECENT_BLOCKS};
use crate::ground_watch::GroundWatch;
use crate::options::Options;
use crate::samples::{RobotSamples, is_used};

/// Slips and speeds are means over this time, s: the interval of a slip is that of one second.
const WINDOW_S: f64 = 1.0;
/// Shorter stretches do not count, s.
const MIN_STRETCH_S: f64 = 2.0;
/// Longer ones are cut, s: memory is bounded.
const MAX_STRETCH_S: f64 = 30.0;
/// Two readings further apart end a stretch, s.
const MAX_GAP_S: f64 = 1.0;
/// The drive is straight while turning moves no wheel by more than this share of the robot's speed.
const MAX_TURN_SHARE: f64 = 0.25;
/// A wheel's rollers roll if it stands across the way by at least this sine.
const MIN_ACROSS: f64 = 0.5;

/// A stretch of a log, with what its reference measured.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LogStretch {
    pub(crate) stretch: Stretch,
    /// Its slip, and that of each second, where the log has an absolute reference.
    pub(crate) slip: Option<f64>,
    pub(crate) seconds: Vec<f64>,
}

/// The stretches of a log and the unit of their efforts.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LogStretches {
    pub(crate) stretches: Vec<LogStretch>,
    pub(crate) unit: Option<EffortUnit>,
    pub(crate) changes_s: Vec<f64>,
    pub(crate) duration_s: f64,
    pub(crate) has_reference: bool,
}

/// Drives a log, with or without a reference.
pub(crate) fn stretches(log: &Log, file: &RobotFile, options: &Options) -> Result<LogStretches> {
    let mut samples = RobotSamples::new(log, file)?;
    let inputs = Inputs::with_or_without_reference(log, file, options)?;
    let mut settings = file.settings;
    settings.reference = inputs.reference;
    settings.window = WINDOW_S;
    let mut means = WindowMeans::new(&file.robot, settings)?;
    let mut watch = GroundWatch::new(&file.robot, settings.low_speed);
    let mut collector = Collector::new(&file.robot, inputs.reference != Reference::Grip);
    let mut start_ns = None;
    let (from_s, to_s) = (
        options.from_s.unwrap_or(f64::NEG_INFINITY),
        options.to_s.unwrap_or(f64::INFINITY),
    );
    let mut group_ns = None;
    let mut time_s = 0.0;
    for sample in log.samples(&vec![0; log.clocks()])? {
        let sample = samples.convert(sample?);
        let start = *start_ns.get_or_insert(sample.time_ns);
        // All samples of one time have come.
        if let Some(now_ns) = group_ns.filter(|group| *group != sample.time_ns)
            && (from_s..=to_s).contains(&time_s)
        {
            collector.step(now_ns, time_s, &mut watch, &means);
        }
        group_ns = Some(sample.time_ns);
        time_s = sample.time_ns.saturating_sub(start) as f64 * 1e-9;
        if is_used(&sample.measurement, inputs.wheel_sensor) {
            watch.take(&sample);
            // A refused sample is no reading.
            let _refused = means.update(sample);
        }
    }
    collector.close();
    Ok(LogStretches {
        stretches: collector.done,
        unit: watch.unit(),
        changes_s: watch.called_s().to_vec(),
        duration_s: time_s,
        has_reference: inputs.reference != Reference::Grip,
    })
}

/// What one time shows of a stretch.
#[derive(Clone, Copy, Debug)]
struct Moment {
    time_s: f64,
    effort: f64,
    /// Effort of the wheel that stands most across the way.
    crosswise: Option<f64>,
    /// Along the command, by the wheels, m/s.
    speed: f64,
    /// Slip of the last second by the reference.
    slip: Option<f64>,
    /// Ways by reference and wheels, m.
    ways: (f64, f64),
}

struct Collector<'a> {
    robot: &'a Robot,
    has_reference: bool,
    /// Greatest distance of a wheel from the robot's origin, m.
    reach: f64,
    /// The command of the open stretch and when it was given.
    command: Option<([f64; 2], i64)>,
    open: Vec<Moment>,
    done: Vec<LogStretch>,
}

impl<'a> Collector<'a> {
    fn new(robot: &'a Robot, has_reference: bool) -> Self {
        let reach = robot
            .wheels()
            .iter()
            .map(|wheel| Real::hypot(wheel.x, wheel.y));
        Self {
            robot,
            has_reference,
            reach: reach.fold(0.0, f64::max),
            command: None,
            open: Vec::new(),
            done: Vec::new(),
        }
    }

    fn step(&mut self, now_ns: i64, time_s: f64, watch: &mut GroundWatch, means: &WindowMeans) {
        let wheels = self.robot.wheels().iter().enumerate();
        let powered = wheels.filter(|(_, wheel)| wheel.role == WheelRole::Powered);
        let rims: Vec<f64> = powered
            .filter_map(|(index, _)| Some(means.rim_speed(index)?.value.abs()))
            .collect();
        if rims.is_empty() {
            return self.close();
        }
        let rim = rims.iter().sum::<f64>() / rims.len() as f64;
        let Some(settled) = watch.step(now_ns, time_s, rim) else {
            return self.close();
        };
        let (Some(command), Some(body)) = (watch.command(), means.latest()) else {
            return self.close();
        };
        let key = Some((command, settled.since_ns));
        let is_gap = self
            .open
            .last()
            .is_some_and(|last| time_s - last.time_s > MAX_GAP_S);
        let is_long = self
            .open
            .first()
            .is_some_and(|first| time_s - first.time_s > MAX_STRETCH_S);
        if key != self.command || is_gap || is_long {
            self.close();
            self.command = key;
        }
        let Some(direction) = direction(command) else {
            return self.close();
        };
        let Some(speed) = self.straight_speed(body, direction) else {
            return self.close();
        };
        let crosswise = self.crosswise(direction);
        self.open.push(Moment {
            time_s,
            effort: settled.effort,
            crosswise: crosswise.and_then(|(wheel, _)| watch.effort(wheel)),
            speed,
            slip: body.along.map(grouser_slip::Slip::value),
            ways: (body.travel_reference, body.travel_wheels),
        });
        if settled.has_changed {
            // What came last is already the new ground.
            let new_s = time_s - RECENT_BLOCKS as f64 * BLOCK_TIME_S;
            let place = self.open.partition_point(|moment| moment.time_s < new_s);
            let new = self.open.split_off(place);
            self.close();
            self.open = new;
        }
    }

    /// The speed by the wheels along the command, if the robot drives straight.
    fn straight_speed(&self, body: &WindowBody, [x, y]: [f64; 2]) -> Option<f64> {
        let wheels = body.wheels_motion?;
        let speed = wheels.along([x, y, 0.0]).value;
        let turn = body.yaw_rate.or(body.wheels_yaw_rate)?.value;
        (speed > 0.0 && turn.abs() * self.reach <= MAX_TURN_SHARE * speed).then_some(speed)
    }

    /// The powered wheel that stands most across the way, with the sine of its angle; `None` where all roll along it.
    fn crosswise(&self, [x, y]: [f64; 2]) -> Option<(usize, f64)> {
        let wheels = self.robot.wheels().iter().enumerate();
        let across = wheels
            .filter(|(_, wheel)| wheel.role == WheelRole::Powered)
            .map(|(index, wheel)| {
                let (sin, cos) = (wheel.heading.sin(), wheel.heading.cos());
                (index, (sin * x - cos * y).abs())
            });
        across
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, across)| *across >= MIN_ACROSS)
    }

    /// Ends the open stretch.
    fn close(&mut self) {
        let moments = std::mem::take(&mut self.open);
        let (Some(first), Some(last)) = (moments.first(), moments.last()) else {
            return;
        };
        if last.time_s - first.time_s < MIN_STRETCH_S {
            return;
        }
        let mean =
            |of: fn(&Moment) -> f64| moments.iter().map(of).sum::<f64>() / moments.len() as f64;
        let series = moments.iter().map(|m| Some((m.time_s, m.crosswise?)));
        let series: Option<Vec<_>> = series.collect();
        let across = self
            .command
            .and_then(|(command, _)| self.crosswise(direction(command)?));
        let ripple = series.as_deref().and_then(roller_ripple);
        let roller = across
            .zip(ripple)
            .map(|((_, across), ripple)| Roller { across, ripple });
        let (reference, wheels) = (last.ways.0 - first.ways.0, last.ways.1 - first.ways.1);
        let slip = (self.has_reference && wheels > 0.0).then(|| 1.0 - reference / wheels);
        self.done.push(LogStretch {
            stretch: Stretch {
                from_s: first.time_s,
                to_s: last.time_s,
                effort: mean(|m| m.effort),
                speed: mean(|m| m.speed),
                roller,
            },
            slip,
            seconds: if self.has_reference {
                seconds(&moments)
            } else {
                Vec::new()
            },
        });
    }
}

/// The direction of a command of motion.
fn direction([forward, left]: [f64; 2]) -> Option<[f64; 2]> {
    let size = Real::hypot(forward, left);
    (size > 0.0 && size.is_finite()).then(|| [forward / size, left / size])
}

/// The slips of the seconds of a stretch: the last second is that of each mean.
fn seconds(moments: &[Moment]) -> Vec<f64> {
    let Some(first) = moments.first() else {
        return Vec::new();
    };
    let mut next_s = first.time_s + WINDOW_S;
    let mut out = Vec::new();
    for moment in moments {
        if moment.time_s >= next_s
            && let Some(slip) = moment.slip
        {
            out.push(slip);
            next_s = moment.time_s + WINDOW_S;
        }
    }
    out
}
