//! What is known of the robot at one time of the log.

use grouser_real::Real;
use grouser_slip::filter::BodyEstimate;
use grouser_slip::{BodyMotion, Wheel, WheelEstimate};

use crate::odometry::Odometry;

/// From one time to another, s.
pub(crate) fn seconds(from_ns: i64, to_ns: i64) -> f64 {
    to_ns.saturating_sub(from_ns) as f64 * 1e-9
}

/// What is known at one time, on its way to whoever takes it. Each time is entered into the moment of the time before, whose
/// memory is used again.
#[derive(Clone, Debug, Default)]
pub(crate) struct Moment {
    pub(crate) time_ns: i64,
    /// Which wheels were read, bit by bit.
    pub(crate) read: u64,
    pub(crate) wheels: Vec<WheelEstimate>,
    pub(crate) motion: Option<BodyMotion>,
    /// The path since the log's start.
    pub(crate) odometry: Option<Odometry>,
}

impl Moment {
    /// Enters what the filter knows, and the distances so far by wheels and filter.
    pub(crate) fn enter(
        &mut self,
        (time_ns, read): (i64, u64),
        wheels: &[WheelEstimate],
        fused: &BodyEstimate,
        travel: [f64; 2],
    ) {
        let speeds = [fused.forward, fused.left, fused.yaw_rate];
        *self = Self {
            time_ns,
            read,
            wheels: self.with_wheels(wheels),
            motion: Some(BodyMotion {
                velocity: speeds.map(|speed| speed.value),
                covariance: fused.velocity_covariance,
            }),
            odometry: Some(Odometry::of_filter(fused, travel)),
        };
    }

    /// The wheels in the memory of those before.
    fn with_wheels(&mut self, wheels: &[WheelEstimate]) -> Vec<WheelEstimate> {
        let mut own = std::mem::take(&mut self.wheels);
        own.clear();
        own.extend_from_slice(wheels);
        own
    }
}

/// The angle from a wheel's heading to the way of its centre, to the left positive, in (−π, π], rad; `None` where the
/// centre is slower than `min_speed` (m/s); `cos` and `sin` are of the wheel's heading. As the filter's own angle, but of
/// smoothed motions too.
pub(crate) fn side_slip_angle(
    wheel: &Wheel,
    (cos, sin): (f64, f64),
    motion: Option<&BodyMotion>,
    min_speed: f64,
) -> Option<f64> {
    let [v_x, v_y, turn] = motion?.velocity;
    let (along_x, along_y) = (v_x - turn * wheel.y, v_y + turn * wheel.x);
    let along = cos * along_x + sin * along_y;
    let aside = cos * along_y - sin * along_x;
    (Real::hypot(along, aside) > min_speed).then(|| Real::atan2(aside, along))
}
