//! A robot at rest on uneven ground: how rockers, arms and chassis lie, and what each wheel carries.

use super::equations::Equations;
use super::margins::{StabilityMargins, margins_where};
use crate::body::{BodyState, MAX_FREEDOMS, MAX_SPEEDS, Pose, Speeds, solve};
use crate::error::{Error, Result};
use crate::robot::RobotModel;
use crate::vector::{Attitude, Vector};

/// Unknowns: heave, roll, pitch, the freedoms of the links.
const MAX_UNKNOWNS: usize = 3 + MAX_FREEDOMS;
/// Greatest number of steps: a wheel that lifts and a link that runs to its stop take some.
const MAX_STEPS: usize = 400;
/// Forces (N) and moments (N m) balance to this share of the weight, far above rounding.
const BALANCE_TOLERANCE: f64 = 1e-9;
/// Longest step in a height (m) or an angle (rad): about a wheel's radius, so that contacts are not jumped over.
const MAX_STEP_M_OR_RAD: f64 = 0.1;
/// Limits of the heights of the ground under the wheels, m.
const HEIGHT_LIMITS_M: (f64, f64) = (-10.0, 10.0);
/// Limits of the stiffness of the ground under a wheel, N/m.
const STIFFNESS_LIMITS_N_PER_M: (f64, f64) = (1e2, 1e8);

/// The ground under a robot that stands.
#[derive(Clone, Copy, Debug)]
pub struct Footing<'a> {
    /// Height of the ground under each wheel in the robot's order, m, from the plane on which the description stands.
    pub heights: &'a [f64],
    /// How hard the ground is under a wheel, N/m: dW/dz of the soil under the wheel's load. Where the wheels are as
    /// many as the equations, the loads hardly depend on it; a rigid robot with four wheels stands on it.
    pub stiffness: f64,
}

/// How a robot stands.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Stance {
    /// What each wheel carries, N, upwards; 0 where it hangs in the air.
    pub loads: Vec<f64>,
    /// How far it has sunk below the ground, m; negative: how far it hangs above it.
    pub sinkages: Vec<f64>,
    /// Roll (left side up) and pitch (nose up) of the chassis, rad.
    pub roll: f64,
    /// rad.
    pub pitch: f64,
    /// Angle of each freedom of the links, rad.
    pub joints: Vec<f64>,
    /// The margins against tipping over.
    pub margins: StabilityMargins,
    /// Do all forces balance? Where not, what was reached is given: the robot falls, or its links have no rest.
    pub settled: bool,
}

/// The rest of a robot whose wheels stand at given heights on ground that is level under each.
///
/// Rest is where Σ of the weights, of the links' springs and stops, and of the ground's forces
/// N = k max(0, depth) vanishes for heave, roll, pitch and every freedom. Newton's method on that, with the
/// stiffnesses as its matrix: k J Jᵀ under wheels that touch, where J says how a wheel's centre rises.
///
/// Source: virtual work; nothing of it is approximate but the ground's spring.
///
/// Assumes: forces of the ground are vertical (wheels free to roll, so that nothing is braced); each wheel stands on
/// ground that is level over its own width.
///
/// # Errors
/// [`Error::OutOfRange`] for heights beyond ±10 m or another number of them, and for a stiffness outside
/// [1e2, 1e8] N/m.
///
/// ```
/// use grouser_rover::robot::RobotModel;
/// use grouser_rover::statics::{Footing, stance};
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/rocker-bogie.toml");
/// let model = RobotModel::read(file.as_ref())?;
/// let mut heights = vec![0.0; model.wheels.len()];
/// heights[0] = 0.05; // the first wheel stands on a stone
/// let rest = stance(&model, &Footing { heights: &heights, stiffness: 1e5 })?;
/// assert!(rest.settled);
/// assert!((rest.loads.iter().sum::<f64>() / model.weight() - 1.0).abs() < 1e-6);
/// # Ok::<(), grouser_rover::Error>(())
/// ```
pub fn stance(model: &RobotModel, footing: &Footing<'_>) -> Result<Stance> {
    let of = "footing";
    let wheels = model.wheels.len() as f64;
    let count = footing.heights.len() as f64;
    Error::check(of, "number of heights", count, (wheels, wheels), "1")?;
    for height in footing.heights {
        Error::check(of, "height", *height, HEIGHT_LIMITS_M, "m")?;
    }
    Error::check(
        of,
        "stiffness",
        footing.stiffness,
        STIFFNESS_LIMITS_N_PER_M,
        "N/m",
    )?;

    let linkage = &model.linkage;
    let size = 3 + linkage.freedoms();
    let mean = footing.heights.iter().sum::<f64>() / count.max(1.0);
    let mut state = BodyState::at(Vector::AXES[2] * mean, Attitude::LEVEL);
    let mut pose = linkage.pose(&state);
    let mut settled = false;
    for _ in 0..MAX_STEPS {
        let mut system = Balance::new(model, footing, &state, &pose);
        let off = system.right[..size]
            .iter()
            .fold(0.0, |most: f64, r| most.max(r.abs()));
        if off <= BALANCE_TOLERANCE * model.weight() {
            settled = true;
            break;
        }
        solve(&mut system.matrix, &mut system.right, size);
        let step = &system.right[..size];
        let longest = step.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
        let share = (MAX_STEP_M_OR_RAD / longest.max(1e-300)).min(1.0);
        state.position.z += share * step[0];
        let turn = Vector::new(step[1], step[2], 0.0) * share;
        state.attitude = state
            .attitude
            .then(Attitude::from_rotation(turn))
            .normalised();
        for (joint, step) in state.joints.iter_mut().zip(&step[3..]) {
            *joint += share * step;
        }
        linkage.update_pose(&state, &mut pose);
    }
    Ok(result(model, footing, &state, &pose, settled))
}

/// Forces that do not balance, and how they change.
struct Balance {
    matrix: [[f64; MAX_UNKNOWNS]; MAX_UNKNOWNS],
    right: [f64; MAX_UNKNOWNS],
}

impl Balance {
    fn new(model: &RobotModel, footing: &Footing<'_>, state: &BodyState, pose: &Pose) -> Self {
        let linkage = &model.linkage;
        let up = state.attitude.to_robot(Vector::AXES[2]);
        let rows = |speeds: &Speeds, heave: f64| {
            let mut out = [0.0; MAX_UNKNOWNS];
            (out[0], out[1], out[2]) = (heave, speeds[0], speeds[1]);
            out[3..].copy_from_slice(&speeds[6..6 + MAX_FREEDOMS]);
            out
        };
        let mut forces = [0.0; MAX_SPEEDS];
        let mut heave = 0.0;
        for body in linkage.bodies() {
            let at = linkage.point(pose, body.link, body.centre);
            let weight = body.mass * linkage.gravity();
            linkage.push(
                pose,
                &mut forces,
                (body.link, at),
                -up * weight,
                Vector::ZERO,
            );
            heave -= weight;
        }
        linkage.hold(state, &mut forces);
        let mut right = rows(&forces, heave);
        let mut matrix = [[0.0; MAX_UNKNOWNS]; MAX_UNKNOWNS];
        for (index, hold) in linkage.holds().iter().enumerate() {
            // a slope of the moment, stops included, and a trace for links that nothing holds
            let (angle, h) = (state.joints[index], 1e-6);
            let slope = hold.moment(angle - h, 0.0) - hold.moment(angle + h, 0.0);
            matrix[3 + index][3 + index] = (slope / (2.0 * h)).max(0.0) + 1e-3;
        }
        for (index, row) in matrix.iter_mut().enumerate().take(3) {
            row[index] = 1e-3;
        }
        for (mount, height) in model.wheels.iter().zip(footing.heights) {
            let at = linkage.point(pose, mount.link, mount.centre);
            let depth = depth(state, at, mount.wheel.radius(), *height);
            if depth <= 0.0 {
                continue;
            }
            let mut lift = [0.0; MAX_SPEEDS];
            linkage.push(pose, &mut lift, (mount.link, at), up, Vector::ZERO);
            let lift = rows(&lift, 1.0);
            for i in 0..MAX_UNKNOWNS {
                right[i] += footing.stiffness * depth * lift[i];
                for j in 0..=i {
                    matrix[i][j] += footing.stiffness * lift[i] * lift[j];
                }
            }
        }
        Self { matrix, right }
    }
}

/// How far a wheel's lowest point lies below the ground, m.
fn depth(state: &BodyState, at: Vector, radius: f64, height: f64) -> f64 {
    let centre = state.position.z + state.attitude.to_world(at).z;
    height - (centre - radius)
}

fn result(
    model: &RobotModel,
    footing: &Footing<'_>,
    state: &BodyState,
    pose: &Pose,
    settled: bool,
) -> Stance {
    let linkage = &model.linkage;
    let (mut loads, mut sinkages) = (Vec::new(), Vec::new());
    for (mount, height) in model.wheels.iter().zip(footing.heights) {
        let at = linkage.point(pose, mount.link, mount.centre);
        let depth = depth(state, at, mount.wheel.radius(), *height);
        loads.push(footing.stiffness * depth.max(0.0));
        sinkages.push(depth);
    }
    let (roll, pitch, _) = state.attitude.angles();
    let equations = Equations::new(model, state, pose, |wheel| loads[wheel] > 0.0);
    Stance {
        margins: margins_where(&equations, -Vector::AXES[2]),
        loads,
        sinkages,
        roll,
        // nose down is positive about y
        pitch: -pitch,
        joints: state.joints[..linkage.freedoms()].to_vec(),
        settled,
    }
}
