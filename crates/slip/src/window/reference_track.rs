//! From the sensors of the robot's own motion to that motion over a window.

use grouser_real::{Real, wrap_angle};

use super::settings::WindowSettings;
use crate::body::Observations;
use crate::clock::{Clock, Step};
use crate::fault::Fault;
use crate::history::{History, nanoseconds, seconds_between};
use crate::reference::Reference;
use crate::sample::Measurement;
use crate::speed::Measured;

/// A gyro that saturates or reads nonsense is out of this range, rad/s.
const MAX_YAW_RATE: f64 = 100.0;

/// A yaw that turns by more than this and back, but for this share of it, within two readings is an outlier, rad: the way does not
/// depend on a smaller one.
const MIN_OUTLIER_RAD: f64 = 0.1;
const MAX_BACK_SHARE: f64 = 0.3;

/// The way between two poses in the robot's frame halfway, m, and the turn, rad.
fn displacement(from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    let turn = wrap_angle(to[2] - from[2]);
    let (sin, cos) = Real::sin_cos(from[2] + 0.5 * turn);
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    [cos * dx + sin * dy, cos * dy - sin * dx, turn]
}

/// The running displacement of the robot in its own frame, by whatever measures it, and its yaw by a
/// gyro.
#[derive(Clone, Debug)]
pub(crate) struct ReferenceTrack {
    settings: WindowSettings,
    gap: f64,
    displacement: Track<3>,
    /// Does the displacement carry a turn of its own?
    turns: bool,
    last_pose: Option<[f64; 3]>,
    /// The pose before it, and what was added from there to it.
    before: Option<([f64; 3], [f64; 3])>,
    /// A displacement was refused, so that a part of the way is unknown: the next one starts anew.
    has_hole: bool,
    yaw: Track<1>,
    last_rate: f64,
    /// Unit vector of the last command of motion.
    pub(crate) command: Option<[f64; 2]>,
    command_clock: Clock,
}

#[derive(Clone, Debug)]
struct Track<const K: usize> {
    clock: Clock,
    history: History<K>,
    totals: [f64; K],
}

impl<const K: usize> Track<K> {
    fn new(settings: &WindowSettings, gap: f64) -> Self {
        Self {
            clock: Clock::default(),
            history: History::new(settings.history, nanoseconds(gap)),
            totals: [0.0; K],
        }
    }

    /// Adds what passed since the last sample, or starts anew.
    fn add(&mut self, time_ns: i64, step: Step, passed: [f64; K]) {
        if step == Step::Start {
            self.history.clear();
        } else {
            for (total, part) in self.totals.iter_mut().zip(passed) {
                *total += part;
            }
        }
        self.history.push(time_ns, self.totals);
    }

    fn newest(&self) -> Option<i64> {
        self.history.newest().map(|(time, _)| time)
    }
}

impl ReferenceTrack {
    pub(crate) fn new(settings: &WindowSettings) -> Self {
        let gap = 2.0 * settings.window.max(settings.dropout);
        Self {
            settings: *settings,
            gap,
            displacement: Track::new(settings, gap),
            turns: false,
            last_pose: None,
            before: None,
            has_hole: false,
            yaw: Track::new(settings, gap),
            last_rate: 0.0,
            command: None,
            command_clock: Clock::default(),
        }
    }

    /// Is this reference one that measures the robot's displacement directly?
    pub(crate) fn measures_displacement(&self) -> bool {
        matches!(
            self.settings.reference,
            Reference::Displacement | Reference::Pose | Reference::Speed
        )
    }

    pub(crate) fn take(&mut self, time_ns: i64, measurement: &Measurement) -> Result<(), Fault> {
        let reference = self.settings.reference;
        match *measurement {
            Measurement::YawRate { rate } => self.take_yaw_rate(time_ns, rate),
            Measurement::Inertial { rate, .. } => self.take_yaw_rate(time_ns, rate[2]),
            Measurement::Command { forward, left } => {
                let limit = self.settings.max_speed;
                Fault::check_range("command forward", forward, -limit, limit, "m/s")?;
                Fault::check_range("command left", left, -limit, limit, "m/s")?;
                self.command_clock.accept(time_ns, self.gap)?;
                let size = Real::hypot(forward, left);
                self.command = (size > 0.0).then(|| [forward / size, left / size]);
                Ok(())
            }
            Measurement::Displacement {
                forward,
                left,
                turn,
            } if reference == Reference::Displacement => {
                let passed = [forward, left, turn.unwrap_or(0.0)];
                let taken = self.take_displacement(time_ns, passed, turn.is_some());
                // A displacement that arrives twice leaves no gap.
                self.has_hole |= taken.is_err() && !matches!(taken, Err(Fault::NotLater { .. }));
                taken
            }
            Measurement::Pose { x, y, yaw } if reference == Reference::Pose => {
                self.take_pose(time_ns, [x, y, yaw])
            }
            Measurement::Speed { forward, left } if reference == Reference::Speed => {
                self.take_speed(time_ns, forward, left.unwrap_or(0.0))
            }
            _ => Ok(()),
        }
    }

    fn take_yaw_rate(&mut self, time_ns: i64, rate: f64) -> Result<(), Fault> {
        Fault::check_range("yaw rate", rate, -MAX_YAW_RATE, MAX_YAW_RATE, "rad/s")?;
        let step = self.yaw.clock.accept(time_ns, self.gap)?;
        let turn = match step {
            Step::After(elapsed) => 0.5 * (rate + self.last_rate) * elapsed,
            Step::Start => 0.0,
        };
        self.yaw.add(time_ns, step, [turn]);
        self.last_rate = rate;
        Ok(())
    }

    fn take_displacement(
        &mut self,
        time_ns: i64,
        passed: [f64; 3],
        turns: bool,
    ) -> Result<(), Fault> {
        Fault::check_finite("displacement forward", passed[0], "m")?;
        Fault::check_finite("displacement left", passed[1], "m")?;
        Fault::check_range("displacement turn", passed[2], -7.0, 7.0, "rad")?;
        let mut step = self.displacement.clock.accept(time_ns, self.gap)?;
        if let Step::After(elapsed) = step {
            self.check_jump(passed, elapsed)?;
        }
        if core::mem::take(&mut self.has_hole) {
            step = Step::Start;
        }
        self.turns = turns;
        self.displacement.add(time_ns, step, passed);
        Ok(())
    }

    fn check_jump(&self, passed: [f64; 3], elapsed: f64) -> Result<(), Fault> {
        let (size, limit) = (Real::hypot(passed[0], passed[1]), self.settings.max_speed);
        // A camera slower than its rows shows several rows' way in one: a whole window's is let pass.
        if size <= limit * elapsed.max(self.settings.window) {
            Ok(())
        } else {
            Err(Fault::Jump {
                field: "displacement",
                value: size / elapsed,
                limit,
                unit: "m/s",
            })
        }
    }

    fn take_pose(&mut self, time_ns: i64, pose: [f64; 3]) -> Result<(), Fault> {
        Fault::check_range("pose x", pose[0], -1e8, 1e8, "m")?;
        Fault::check_range("pose y", pose[1], -1e8, 1e8, "m")?;
        Fault::check_range("pose yaw", pose[2], -1e6, 1e6, "rad")?;
        let last = self.last_pose.unwrap_or(pose);
        let mut passed = displacement(last, pose);
        // a yaw that goes aside and comes back is an outlier: without it the way is that from the pose before
        if let Some((before, added)) = self.before.filter(|(_, added)| {
            let back = passed[2] + added[2];
            passed[2].abs() > MIN_OUTLIER_RAD && back.abs() < MAX_BACK_SHARE * passed[2].abs()
        }) {
            let whole = displacement(before, pose);
            passed = [0, 1, 2].map(|i| whole[i] - added[i]);
        }
        let taken = self.take_displacement(time_ns, passed, true);
        if !matches!(taken, Err(Fault::NotLater { .. })) {
            // After a jump the robot is where it says it is; how it got there is unknown.
            self.before = self
                .last_pose
                .filter(|_| taken.is_ok())
                .map(|from| (from, passed));
            self.last_pose = Some(pose);
            self.has_hole |= taken.is_err();
        }
        taken
    }

    fn take_speed(&mut self, time_ns: i64, forward: f64, left: f64) -> Result<(), Fault> {
        let limit = self.settings.max_speed;
        Fault::check_range("speed forward", forward, -limit, limit, "m/s")?;
        Fault::check_range("speed left", left, -limit, limit, "m/s")?;
        let step = self.displacement.clock.accept(time_ns, self.gap)?;
        let elapsed = match step {
            Step::After(elapsed) => elapsed,
            Step::Start => 0.0,
        };
        let passed = [forward * elapsed, left * elapsed, 0.0];
        self.displacement.add(time_ns, step, passed);
        Ok(())
    }

    /// Has a gyro spoken?
    pub(crate) fn has_gyro(&self) -> bool {
        self.yaw.newest().is_some()
    }

    /// The time of the displacement's last sample.
    pub(crate) fn displacement_time(&self) -> Option<i64> {
        self.displacement.newest()
    }

    /// The latest time up to which the directly measured parts are known; `None` while a needed part
    /// has not spoken.
    pub(crate) fn known_until(&self) -> Option<i64> {
        let gyro = self.yaw.newest().unwrap_or(i64::MAX);
        if self.measures_displacement() {
            Some(self.displacement.newest()?.min(gyro))
        } else {
            Some(gyro)
        }
    }

    /// The mean yaw rate over a window by the gyro, else by the displacement's own turn.
    pub(crate) fn yaw_rate(&self, from_ns: i64, to_ns: i64) -> Option<Measured> {
        let window = seconds_between(from_ns, to_ns);
        if self.has_gyro() {
            let [turn] = self.yaw.history.between(from_ns, to_ns)?;
            let sigma = self.settings.yaw_rate_sigma;
            return Some(Measured {
                value: turn / window,
                variance: sigma * sigma,
            });
        }
        if self.measures_displacement() && self.turns {
            let [_, _, turn] = self.displacement.history.between(from_ns, to_ns)?;
            let sigma = self.settings.yaw_sigma / window;
            return Some(Measured {
                value: turn / window,
                variance: 2.0 * sigma * sigma,
            });
        }
        None
    }

    /// Adds what the reference itself measures of the robot's motion over the window to `seen`;
    /// `None` when the window is not covered.
    pub(crate) fn observe(&self, from_ns: i64, to_ns: i64, seen: &mut Observations) -> Option<()> {
        if !self.measures_displacement() {
            return Some(());
        }
        let window = seconds_between(from_ns, to_ns);
        let [forward, left, _] = self.displacement.history.between(from_ns, to_ns)?;
        let variance = if self.settings.reference == Reference::Speed {
            self.settings.speed_sigma * self.settings.speed_sigma
        } else {
            let sigma = self.settings.position_sigma / window;
            2.0 * sigma * sigma
        };
        for (row, passed) in [([1.0, 0.0, 0.0], forward), ([0.0, 1.0, 0.0], left)] {
            let value = passed / window;
            seen.add(row, Measured { value, variance });
        }
        Some(())
    }
}

#[cfg(test)]
mod tests;
