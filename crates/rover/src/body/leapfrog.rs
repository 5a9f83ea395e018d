//! The body's motion over time.
//!
//! Leapfrog, of second order: speeds are carried on amid the steps by the forces at their ends, places and angles by the
//! speeds amid. Forces depend on speeds too; those at the ends are the ones amid, led on by half a step with the
//! accelerations of the step before. Springs, dampers and end stops are implicit.

use super::{BodyState, Linkage, Pose, Speeds};

/// Steps of a body.
///
/// ```
/// use grouser_rover::body::{BodyState, Leapfrog, MAX_SPEEDS};
/// use grouser_rover::robot::RobotModel;
/// use grouser_rover::vector::{Attitude, Vector};
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/skid-steer.toml");
/// let linkage = RobotModel::read(file.as_ref())?.linkage;
/// let mut state = BodyState::at(Vector::ZERO, Attitude::LEVEL);
/// let mut pose = linkage.pose(&state);
/// let mut leapfrog = Leapfrog::default();
/// for _ in 0..100 {
///     leapfrog.step(&linkage, &mut state, &mut pose, [0.0; MAX_SPEEDS], 0.01); // s
/// }
/// let fallen = 0.5 * linkage.gravity(); // m, in a second
/// assert!((state.position.z + fallen).abs() < 1e-9);
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Leapfrog {
    /// Speeds half a step ago; none before the first step.
    amid: Option<Speeds>,
}

impl Leapfrog {
    /// Moves `state` and `pose` on by `step` (s) under `forces`; returns the accelerations.
    pub fn step(
        &mut self,
        linkage: &Linkage,
        state: &mut BodyState,
        pose: &mut Pose,
        mut forces: Speeds,
        step: f64,
    ) -> Speeds {
        let speeds = self.amid.unwrap_or(state.speeds);
        let share = if self.amid.is_some() { 1.0 } else { 0.5 };
        linkage.hold(&BodyState { speeds, ..*state }, &mut forces);
        let held = linkage.held_inertia(state, step);
        let rates = linkage.accelerate(state, pose, &forces, &held);
        state.speeds = speeds;
        for (speed, rate) in state.speeds.iter_mut().zip(rates) {
            *speed += share * step * rate;
        }
        self.amid = Some(state.speeds);
        linkage.advance(state, step);
        for (speed, rate) in state.speeds.iter_mut().zip(rates) {
            *speed += 0.5 * step * rate;
        }
        linkage.update_pose(state, pose);
        rates
    }
}
