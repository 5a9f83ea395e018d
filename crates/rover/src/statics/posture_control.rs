//! The posture of a chassis with actuators: where they are to be, so that the robot is furthest from tipping over.

use grouser_real::Real;

use super::equations::Equations;
use super::posture::maximise;
use crate::body::{BodyState, Linkage, MAX_FREEDOMS, Pose};
use crate::robot::{Actuated, RobotModel};
use crate::vector::{Attitude, Vector};

/// A gain of the margin below this, rad (0.5°), moves nothing: the error of an attitude whose gyro drifts by 0.03°/s over the
/// 10 s in which gravity corrects it is 0.3°, and that of a joint's angle adds to it.
const MIN_GAIN_RAD: f64 = 0.009;
/// Positions are searched to this share of an actuator's range.
const FINEST_SHARE: f64 = 0.02;

/// The margin against tipping over of a robot in any posture: the smallest further tilt, in any direction, at which no set of
/// non-negative wheel loads balances it, rad; negative where it does not stand. `joints` are the angles of its freedoms (rad),
/// `down` is the direction of gravity in its frame.
///
/// Assumes: the ground is the plane through the contacts of the wheels that no free link carries, where there are three, else
/// of all wheels.
///
/// ```
/// use grouser_rover::body::MAX_FREEDOMS;
/// use grouser_rover::robot::RobotModel;
/// use grouser_rover::statics::{stability_margins, tip_over_margin};
/// use grouser_rover::vector::Vector;
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/five-wheel.toml");
/// let model = RobotModel::read(file.as_ref())?;
/// let margin = tip_over_margin(&model, &[0.0; MAX_FREEDOMS], -Vector::AXES[2]);
/// assert!((margin - stability_margins(&model, 0.0, 0.0).tip_over).abs() < 1e-9);
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[must_use]
pub fn tip_over_margin(model: &RobotModel, joints: &[f64; MAX_FREEDOMS], down: Vector) -> f64 {
    let equations = in_posture(model, joints);
    equations.tip_over(equations.along_ground(down), f64::NEG_INFINITY)
}

/// Chooses where the actuators of a chassis are to be: the posture of maximum margin against tipping over on the ground under
/// the wheels.
///
/// ```
/// use grouser_rover::robot::RobotModel;
/// use grouser_rover::statics::PostureControl;
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/shoulders.toml");
/// let model = RobotModel::read(file.as_ref())?;
/// let mut control = PostureControl::new(&model);
/// // on ground whose left side is up by 0.3 rad the battery slides to the left
/// let setpoints = control.update((0.3, 0.0), &[0.0; 3]);
/// assert!(setpoints[2] > 0.05); // m
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct PostureControl {
    model: RobotModel,
    joints: [f64; MAX_FREEDOMS],
    setpoints: Vec<f64>,
}

impl PostureControl {
    /// Of a robot whose actuators are to stay where they are at first.
    #[must_use]
    pub fn new(model: &RobotModel) -> Self {
        let positions = model.actuators.iter().map(|actuator| actuator.position);
        Self {
            setpoints: positions.collect(),
            model: model.clone(),
            joints: [0.0; MAX_FREEDOMS],
        }
    }

    /// A joint's measured angle, rad. One that is not finite, or a joint that does not exist, changes nothing.
    pub fn set_joint(&mut self, joint: usize, angle: f64) {
        if let Some(slot) = self.joints.get_mut(joint).filter(|_| angle.is_finite()) {
            *slot = angle;
        }
    }

    /// Where the actuators are to be, in their order, of a chassis at an estimated roll (right side down) and pitch (nose down),
    /// rad, whose actuators are at `positions`. They stay where another posture gains too little, or where the attitude is not
    /// finite; a position that is missing or not finite is the last one.
    pub fn update(&mut self, (roll, pitch): (f64, f64), positions: &[f64]) -> &[f64] {
        let Self {
            model,
            joints,
            setpoints,
        } = self;
        if !(roll.is_finite() && pitch.is_finite()) {
            return setpoints;
        }
        let known = positions.iter().enumerate();
        for (index, position) in known.filter(|(_, position)| position.is_finite()) {
            model.place_actuator(index, *position);
        }
        let measured = *joints;
        let gravity = Attitude::from_angles(roll, pitch, 0.0).to_robot(-Vector::AXES[2]);
        let down = in_posture(model, &measured).along_ground(gravity);
        let ranges: Vec<(f64, f64)> = model.actuators.iter().map(|own| own.range).collect();
        let mut margin = |x: &[f64], enough: f64| {
            let mut joints = measured;
            for (index, position) in x.iter().enumerate() {
                let own = &model.actuators[index];
                if let Actuated::Link { freedom, sign } = own.moves {
                    joints[freedom] += sign * (position - own.position);
                } else {
                    model.place_actuator(index, *position);
                }
            }
            in_posture(model, &joints).tip_over(down, enough)
        };
        let now = margin(setpoints, f64::NEG_INFINITY);
        let mut best = setpoints.clone();
        let reached = maximise(&mut best, &ranges, FINEST_SHARE, margin);
        if reached > now + MIN_GAIN_RAD {
            *setpoints = best;
        }
        setpoints
    }
}

/// The equations of a robot on the plane through its wheels' contacts.
fn in_posture(model: &RobotModel, joints: &[f64; MAX_FREEDOMS]) -> Equations {
    let mut state = BodyState::at(Vector::ZERO, Attitude::LEVEL);
    state.joints = *joints;
    let pose = model.linkage.pose(&state);
    let up = ground_normal(model, &pose);
    state.attitude = Attitude::from_angles(Real::atan2(up.y, up.z), -Real::asin(up.x), 0.0);
    Equations::new(model, &state, &pose, |_| true)
}

/// The normal of the plane through the lowest points of the wheels, by least squares, in the robot's frame.
fn ground_normal(model: &RobotModel, pose: &Pose) -> Vector {
    let linkage = &model.linkage;
    let is_held = |wheel: &&crate::robot::WheelMount| is_held(linkage, wheel.link);
    let mut wheels: Vec<_> = model.wheels.iter().filter(is_held).collect();
    if wheels.len() < 3 {
        wheels = model.wheels.iter().collect();
    }
    let per_wheel = 1.0 / wheels.len().max(1) as f64;
    let lowest = |up: Vector| {
        wheels.iter().map(move |wheel| {
            linkage.point(pose, wheel.link, wheel.centre) - up * wheel.wheel.radius()
        })
    };
    let mut up = Vector::AXES[2];
    // where radii differ, the lowest points depend on the normal: by the second fit to 1e-3 of it
    for _ in 0..3 {
        let mean = lowest(up).fold(Vector::ZERO, |sum, at| sum + at * per_wheel);
        let (mut xx, mut xy, mut yy, mut xz, mut yz) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for at in lowest(up) {
            let off = at - mean;
            xx += off.x * off.x;
            xy += off.x * off.y;
            yy += off.y * off.y;
            xz += off.x * off.z;
            yz += off.y * off.z;
        }
        let size = xx * yy - xy * xy;
        if !(size > 1e-9 * (xx + yy) * (xx + yy)) {
            // wheels in one line define no plane
            return Vector::AXES[2];
        }
        up = Vector::new((xy * yz - yy * xz) / size, (xy * xz - xx * yz) / size, 1.0).unit();
    }
    up
}

/// Does no free link carry it?
fn is_held(linkage: &Linkage, link: Option<usize>) -> bool {
    let mut carriers = std::iter::successors(link, |index| linkage.links()[*index].on);
    carriers.all(|index| {
        let freedom = linkage.links()[index].freedom;
        linkage.holds()[freedom].driven.is_some()
    })
}
