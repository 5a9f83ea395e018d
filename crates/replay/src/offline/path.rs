//! The path of the smoothed motion.

use grouser_doctor::KnownStep;
use grouser_real::Real;
use grouser_slip::modes::body_motion;
use grouser_slip::motion::{HEADING, Step, Value, X, Y};

use crate::odometry::{Odometry, sandwich};

/// Follows the robot from step to step. Places in the frame of the reference are used as they are; where a new frame begins the path
/// continues from its last place. Without places it is the motion itself, step by step: the place in the belief is linear in errors of
/// the heading, which are large then.
#[derive(Debug, Default)]
pub(super) struct Path {
    /// The rotation (rad) and shift (m) from the present frame to that of the start.
    rotation: f64,
    shift: [f64; 2],
    /// Covariance at the beginning of the present frame.
    covariance: [[f64; 3]; 3],
    last: Option<Odometry>,
    has_places: bool,
    begins_anew: bool,
}

impl Path {
    /// A block begins.
    pub(super) fn begin(&mut self, steps: &[Step]) {
        let mut readings = steps.iter().flat_map(|step| &step.readings);
        self.has_places = readings.any(|of| matches!(of.value, Value::Place(_)));
        self.begins_anew |= !self.has_places;
    }

    /// The path at the end of a step, without velocities, with the distances so far by wheels and estimate.
    pub(super) fn step(&mut self, known: &KnownStep<'_>, travel: [f64; 2]) -> Odometry {
        let belief = known.belief;
        let place = [X, Y, HEADING];
        let [x, y, yaw] = place.map(|i| belief.mean[i]);
        let is_new = std::mem::take(&mut self.begins_anew) || known.step.frame.is_some();
        if let Some(last) = self.last.filter(|_| is_new || !self.has_places) {
            let dt = known.step.dt;
            let motion = body_motion(belief, known.common, dt);
            let [forward, left, turn] = motion.velocity.map(|part| part * dt);
            let (sin, cos) = Real::sin_cos(last.pose[2] + 0.5 * turn);
            let here = [
                last.pose[0] + cos * forward - sin * left,
                last.pose[1] + sin * forward + cos * left,
            ];
            self.rotation = last.pose[2] + turn - yaw;
            let (sin, cos) = Real::sin_cos(self.rotation);
            self.shift = [here[0] - cos * x + sin * y, here[1] - sin * x - cos * y];
            if is_new {
                self.covariance = last.pose_covariance;
            }
        }
        let (sin, cos) = Real::sin_cos(self.rotation);
        let turn = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]];
        let own = place.map(|i| place.map(|j| belief.covariance[i][j]));
        let own = sandwich(&turn, &own);
        let odometry = Odometry {
            pose: [
                self.shift[0] + cos * x - sin * y,
                self.shift[1] + sin * x + cos * y,
                yaw + self.rotation,
            ],
            pose_covariance: [0, 1, 2]
                .map(|i| [0, 1, 2].map(|j| self.covariance[i][j] + own[i][j])),
            velocity: [0.0; 3],
            velocity_covariance: [[0.0; 3]; 3],
            distance: travel[1],
            distance_of_wheels: travel[0],
        };
        self.last = Some(odometry);
        odometry
    }
}
