//! The sensor of the robot's own motion: displacements, poses and speeds as mean speeds over their time.

use grouser_real::Real;

use super::monitor::Monitor;
use super::settings::FilterSettings;
use crate::fault::Fault;
use crate::history::{nanoseconds, seconds_between};
use crate::sample::Measurement;

/// Two readings further apart are no displacement, s: the robot may have done anything in between.
const MAX_PERIOD_S: f64 = 1.0;
/// No pose is farther from its origin, m: UTM coordinates stay below 1e7 m.
const MAX_PLACE_M: f64 = 1e8;
/// No yaw has turned more often, rad.
const MAX_YAW_RAD: f64 = 1e6;
/// No displacement turns by more, rad: a little over a whole turn.
const MAX_TURN_RAD: f64 = 7.0;

/// A mean speed over a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReferenceMotion {
    pub(super) from_ns: i64,
    pub(super) to_ns: i64,
    /// Forwards, and to the left where that is measured, m/s.
    pub(super) speed: [Option<f64>; 2],
    /// rad/s.
    pub(super) turn: Option<f64>,
    pub(super) sigma: f64,
}

/// The state of the sensor of the robot's own motion.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ReferenceSensor {
    last_ns: Option<i64>,
    last_pose: Option<[f64; 3]>,
    pub(super) monitor: Monitor,
    /// Mean of its innovations, in sigma.
    pub(super) mean_innovation: f64,
    pub(super) accepted_ns: Option<i64>,
    /// The last speed forwards that it measured, trusted or not, m/s, and its time.
    pub(super) speed: Option<(f64, i64)>,
    /// The bits of its last reading, and since when they have been the same.
    frozen: Option<([u64; 3], i64)>,
}

/// Poses within this share of the shortest period of samples come from one queue.
const QUEUED_PERIODS: f64 = 0.5;

impl ReferenceSensor {
    /// A measurement as a mean speed; `None` where it is the first of its kind, or the one before is too old.
    pub(super) fn motion(
        &mut self,
        time_ns: i64,
        measurement: &Measurement,
        settings: &FilterSettings,
    ) -> Result<Option<ReferenceMotion>, Fault> {
        let latency = nanoseconds(settings.reference_latency);
        let to_ns = time_ns.saturating_sub(latency);
        let limit = settings.max_speed;
        if let Measurement::Speed { forward, left } = *measurement {
            Fault::check_range("speed forward", forward, -limit, limit, "m/s")?;
            if let Some(left) = left {
                Fault::check_range("speed left", left, -limit, limit, "m/s")?;
            }
            let from_ns = to_ns.saturating_sub(nanoseconds(settings.wheel_window));
            return Ok(Some(ReferenceMotion {
                from_ns,
                to_ns,
                speed: [Some(forward), left],
                turn: None,
                sigma: settings.speed_sigma,
            }));
        }
        if let Measurement::Position { x, y } = *measurement {
            Fault::check_range("position x", x, -MAX_PLACE_M, MAX_PLACE_M, "m")?;
            Fault::check_range("position y", y, -MAX_PLACE_M, MAX_PLACE_M, "m")?;
            return Ok(None);
        }
        let (passed, turns) = match *measurement {
            Measurement::Displacement {
                forward,
                left,
                turn,
            } => {
                // the first has no period that its speed could be judged over, but its way is added up too
                Fault::check_range(
                    "displacement forward",
                    forward,
                    -MAX_PLACE_M,
                    MAX_PLACE_M,
                    "m",
                )?;
                Fault::check_range("displacement left", left, -MAX_PLACE_M, MAX_PLACE_M, "m")?;
                ([forward, left, turn.unwrap_or(0.0)], turn.is_some())
            }
            Measurement::Pose { x, y, yaw } => {
                Fault::check_range("pose x", x, -MAX_PLACE_M, MAX_PLACE_M, "m")?;
                Fault::check_range("pose y", y, -MAX_PLACE_M, MAX_PLACE_M, "m")?;
                Fault::check_range("pose yaw", yaw, -MAX_YAW_RAD, MAX_YAW_RAD, "rad")?;
                let pose = [x, y, yaw];
                let last = self.last_pose.replace(pose).unwrap_or(pose);
                (step_between(last, pose), true)
            }
            _ => return Ok(None),
        };
        Fault::check_range(
            "displacement turn",
            passed[2],
            -MAX_TURN_RAD,
            MAX_TURN_RAD,
            "rad",
        )?;
        let Some(last_ns) = self.last_ns.replace(time_ns) else {
            return Ok(None);
        };
        let elapsed = seconds_between(last_ns, time_ns);
        if !(elapsed > 0.0) || elapsed > MAX_PERIOD_S {
            return Ok(None);
        }
        // poses that a stall had held up come at once: the step between two of them is no speed
        let is_pose = matches!(measurement, Measurement::Pose { .. });
        if is_pose && elapsed * settings.max_rate < QUEUED_PERIODS {
            return Ok(None);
        }
        let size = Real::hypot(passed[0], passed[1]);
        if size > limit * elapsed {
            return Err(Fault::Jump {
                field: "displacement",
                value: size / elapsed,
                limit,
                unit: "m/s",
            });
        }
        Ok(Some(ReferenceMotion {
            from_ns: last_ns.saturating_sub(latency),
            to_ns,
            speed: [Some(passed[0] / elapsed), Some(passed[1] / elapsed)],
            turn: turns.then_some(passed[2] / elapsed),
            sigma: core::f64::consts::SQRT_2 * settings.position_sigma / elapsed,
        }))
    }

    /// Has the sensor repeated its reading to the bit for `patience` seconds?
    pub(super) fn is_frozen(&mut self, motion: &ReferenceMotion, patience: f64) -> bool {
        let bits = [
            motion.speed[0].unwrap_or(0.0).to_bits(),
            motion.speed[1].unwrap_or(0.0).to_bits(),
            motion.turn.unwrap_or(0.0).to_bits(),
        ];
        match self.frozen {
            Some((same, since)) if same == bits => seconds_between(since, motion.to_ns) >= patience,
            _ => {
                self.frozen = Some((bits, motion.to_ns));
                false
            }
        }
    }
}

/// The displacement from one pose to the next, in the robot's frame halfway between.
fn step_between(from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = Real::sin_cos(to[2] - from[2]);
    let turn = Real::atan2(sin, cos);
    let (sin, cos) = Real::sin_cos(from[2] + 0.5 * turn);
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    [cos * dx + sin * dy, cos * dy - sin * dx, turn]
}

#[cfg(test)]
mod tests;
