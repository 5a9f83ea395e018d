//! How rockers and arms carry the wheels, from their angles and the gyro.

use grouser_slip::{Measurement, Sample};

use crate::dynamics::{BodyState, Linkage, MAX_FREEDOMS, Pose};
use crate::robot::RobotModel;
use crate::vector::{Attitude, Vector};

/// Gains of the angle and of its rate over the residual: critically damped, a memory of about six readings.
const ANGLE_GAIN: f64 = 0.51;
const RATE_GAIN: f64 = 0.09;
/// Readings further apart than this begin anew, s.
const GAP: f64 = 0.25;

/// An angle and its rate, followed through noise (an α-β filter).
#[derive(Clone, Copy, Debug, Default)]
struct Joint {
    last_ns: Option<i64>,
    angle: f64,
    rate: f64,
}

impl Joint {
    fn take(&mut self, time_ns: i64, angle: f64) {
        if !angle.is_finite() {
            return;
        }
        let passed = self.last_ns.map_or(f64::INFINITY, |last| {
            time_ns.saturating_sub(last) as f64 * 1e-9
        });
        if passed == 0.0 {
            return;
        }
        self.last_ns = Some(time_ns);
        if !(passed > 0.0 && passed <= GAP) {
            *self = Self {
                angle,
                rate: 0.0,
                ..*self
            };
            return;
        }
        let residual = angle - self.angle - self.rate * passed;
        self.angle = angle - (1.0 - ANGLE_GAIN) * residual;
        self.rate += RATE_GAIN * residual / passed;
    }
}

/// The robot's suspension as its sensors show it.
#[derive(Clone, Debug)]
pub(super) struct Suspension {
    linkage: Linkage,
    /// Link and centre of each wheel.
    wheels: Vec<(Option<usize>, Vector)>,
    joints: [Joint; MAX_FREEDOMS],
    state: BodyState,
    pose: Pose,
}

impl Suspension {
    pub(super) fn new(model: &RobotModel) -> Self {
        let state = BodyState::at(Vector::ZERO, Attitude::from_angles(0.0, 0.0, 0.0));
        Self {
            pose: model.linkage.pose(&state),
            linkage: model.linkage.clone(),
            wheels: model.wheels.iter().map(|m| (m.link, m.centre)).collect(),
            joints: [Joint::default(); MAX_FREEDOMS],
            state,
        }
    }

    pub(super) fn take(&mut self, time_ns: i64, freedom: usize, angle: f64) {
        if let Some(joint) = self.joints.get_mut(freedom) {
            joint.take(time_ns, angle);
        }
    }

    /// How each wheel's carrier moves while the robot pitches at `pitching` (rad/s).
    pub(super) fn carriers(
        &mut self,
        time_ns: i64,
        pitching: f64,
    ) -> impl Iterator<Item = Sample> + '_ {
        self.state.speeds[1] = pitching;
        for (index, joint) in self.joints.iter().enumerate() {
            self.state.joints[index] = joint.angle;
            self.state.speeds[6 + index] = joint.rate;
        }
        self.linkage.update_pose(&self.state, &mut self.pose);
        let (linkage, state, pose) = (&self.linkage, &self.state, &self.pose);
        self.wheels.iter().enumerate().map(move |(wheel, mount)| {
            let at = linkage.point(pose, mount.0, mount.1);
            let velocity = linkage.velocity(state, pose, mount.0, at);
            Sample {
                time_ns,
                measurement: Measurement::Carrier {
                    wheel,
                    turn: pitching + linkage.rate(pose, mount.0),
                    forward: velocity.x,
                    up: velocity.z,
                },
            }
        })
    }
}
