//! Measured motion of the robot itself: displacements, poses and speeds, each over the time it tells of.

use grouser_real::Real;

use super::settings::FilterSettings;
use super::monitor::Watch;
use crate::fault::Fault;
use crate::history::{nanoseconds, seconds_between};
use crate::sample::Measurement;

/// A mean speed over a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) from_ns: i64,
    pub(super) to_ns: i64,
    /// Forwards, and to the left where that is measured, m/s.
    pub(super) speed: [Option<f64>; 2],
    /// rad/s.
    pub(super) turn: Option<f64>,
    pub(super) sigma: f64,
}

/// The sensor of the robot's own motion.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Reference {
    last_ns: Option<i64>,
    last_pose: Option<[f64; 3]>,
    pub(super) watch: Watch,
    /// Mean of its residuals, in sigma.
    pub(super) pull: f64,
    pub(super) accepted_ns: Option<i64>,
    /// The speed forwards that it told last, believed or not, m/s, and when.
    pub(super) speed: Option<(f64, i64)>,
    /// The same to the bit since.
    frozen: Option<([u64; 3], i64)>,
}

impl Reference {
    /// What a measurement says of the robot's speed; `None` where it is the first of its kind.
    pub(super) fn take(
        &mut self,
        time_ns: i64,
        measurement: &Measurement,
        settings: &FilterSettings,
    ) -> Result<Option<Seen>, Fault> {
        let latency = nanoseconds(settings.reference_latency);
        let to_ns = time_ns.saturating_sub(latency);
        let limit = settings.max_speed;
        if let Measurement::Speed { forward, left } = *measurement {
            Fault::check_range("speed forward", forward, -limit, limit, "m/s")?;
            if let Some(left) = left {
                Fault::check_range("speed left", left, -limit, limit, "m/s")?;
            }
            let from_ns = to_ns.saturating_sub(nanoseconds(settings.wheel_window));
            return Ok(Some(Seen {
                from_ns,
                to_ns,
                speed: [Some(forward), left],
                turn: None,
                sigma: settings.speed_sigma,
            }));
        }
        let (passed, turns) = match *measurement {
            Measurement::Displacement {
                forward,
                left,
                turn,
            } => ([forward, left, turn.unwrap_or(0.0)], turn.is_some()),
            Measurement::Pose { x, y, yaw } => {
                Fault::check_range("pose x", x, -1e8, 1e8, "m")?;
                Fault::check_range("pose y", y, -1e8, 1e8, "m")?;
                Fault::check_range("pose yaw", yaw, -1e6, 1e6, "rad")?;
                let pose = [x, y, yaw];
                let last = self.last_pose.replace(pose).unwrap_or(pose);
                (step_between(last, pose), true)
            }
            _ => return Ok(None),
        };
        Fault::check_finite("displacement forward", passed[0], "m")?;
        Fault::check_finite("displacement left", passed[1], "m")?;
        Fault::check_range("displacement turn", passed[2], -7.0, 7.0, "rad")?;
        let Some(last_ns) = self.last_ns.replace(time_ns) else {
            return Ok(None);
        };
        let elapsed = seconds_between(last_ns, time_ns);
        if !(elapsed > 0.0) || elapsed > 1.0 {
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
        Ok(Some(Seen {
            from_ns: last_ns.saturating_sub(latency),
            to_ns,
            speed: [Some(passed[0] / elapsed), Some(passed[1] / elapsed)],
            turn: turns.then_some(passed[2] / elapsed),
            sigma: core::f64::consts::SQRT_2 * settings.position_sigma / elapsed,
        }))
    }

    /// Has the sensor said the same to the bit for `patience` seconds, other than zero?
    pub(super) fn is_frozen(&mut self, seen: &Seen, patience: f64) -> bool {
        let bits = [
            seen.speed[0].unwrap_or(0.0).to_bits(),
            seen.speed[1].unwrap_or(0.0).to_bits(),
            seen.turn.unwrap_or(0.0).to_bits(),
        ];
        match self.frozen {
            Some((same, since)) if same == bits => seconds_between(since, seen.to_ns) >= patience,
            _ => {
                self.frozen = Some((bits, seen.to_ns));
                false
            }
        }
    }
}

/// From one pose to the next, in the robot's frame halfway between.
fn step_between(from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = Real::sin_cos(to[2] - from[2]);
    let turn = Real::atan2(sin, cos);
    let (sin, cos) = Real::sin_cos(from[2] + 0.5 * turn);
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    [cos * dx + sin * dy, cos * dy - sin * dx, turn]
}
