//! What each wheel carries.

use crate::body::{BodyState, MAX_SPEEDS};
use crate::robot::RobotModel;
use crate::vector::{Attitude, Vector};

/// What each wheel carries.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct WheelLoads {
    /// N, at right angles to the ground, in the robot's order.
    pub loads: Vec<f64>,
    /// Are they all positive? A negative one would have to be pulled down: the robot stands otherwise.
    pub stands: bool,
    /// Are there more wheels than equations, so that the loads depend on how the ground yields? Then these are
    /// the ones on ground that yields alike everywhere.
    pub redundant: bool,
}

/// Greatest number of equations: heave, roll, pitch, and the freedoms.
const MAX_EQUATIONS: usize = MAX_SPEEDS - 3;

/// The loads of a robot that stands, in the pose of its description, on a plane tilted by `pitch` (rad, nose up
/// positive: it looks uphill) and `roll` (rad, left side up).
///
/// Forces and moments balance for heave, roll, pitch and every freedom of the links; powered wheels hold the
/// robot on the slope, each in proportion to its load; free wheels carry only.
///
/// Assumes: small sinkage, and links in the pose of the description.
///
/// ```
/// use grouser_rover::robot::RobotModel;
/// use grouser_rover::statics::wheel_loads;
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/rocker-bogie.toml");
/// let model = RobotModel::read(file.as_ref())?;
/// let level = wheel_loads(&model, 0.0, 0.0);
/// assert!(level.stands);
/// assert!((level.loads.iter().sum::<f64>() / model.weight() - 1.0).abs() < 1e-9);
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[must_use]
pub fn wheel_loads(model: &RobotModel, pitch: f64, roll: f64) -> WheelLoads {
    let linkage = &model.linkage;
    let state = BodyState::at(Vector::ZERO, Attitude::LEVEL);
    let pose = linkage.pose(&state);
    let attitude = Attitude::from_angles(roll, -pitch, 0.0);
    let down = attitude.to_robot(-Vector::AXES[2]);
    // traction that holds the robot, per load of the wheels that can give it
    let level = Vector::new(down.x, down.y, 0.0);
    let powered: Vec<bool> = model.wheels.iter().map(|w| w.motor.is_some()).collect();
    let hold = level * (-1.0 / (-down.z).max(0.1));
    let rows = 3 + linkage.freedoms();
    let mut required = [0.0; MAX_SPEEDS];
    for body in linkage.bodies() {
        let force = down * (body.mass * linkage.gravity());
        linkage.push(
            &pose,
            &mut required,
            (body.link, body.centre),
            force,
            Vector::ZERO,
        );
    }
    linkage.hold(&state, &mut required);
    let row_of = |speeds: &[f64; MAX_SPEEDS]| {
        let mut out = [0.0; MAX_EQUATIONS];
        out[0] = speeds[5];
        out[1] = speeds[0];
        out[2] = speeds[1];
        let freedoms = linkage.freedoms();
        out[3..3 + freedoms].copy_from_slice(&speeds[6..6 + freedoms]);
        out
    };
    let required = row_of(&required);
    let columns: Vec<[f64; MAX_EQUATIONS]> = model
        .wheels
        .iter()
        .zip(&powered)
        .map(|(mount, powered)| {
            let mut speeds = [0.0; MAX_SPEEDS];
            let contact = mount.centre - Vector::AXES[2] * mount.wheel.radius();
            let force = if *powered {
                Vector::AXES[2] + hold
            } else {
                Vector::AXES[2]
            };
            linkage.push(
                &pose,
                &mut speeds,
                (mount.link, contact),
                force,
                Vector::ZERO,
            );
            row_of(&speeds)
        })
        .collect();
    let loads = least_loads(&columns, &required, rows);
    WheelLoads {
        stands: loads.iter().all(|load| *load >= 0.0),
        redundant: model.wheels.len() > rows,
        loads,
    }
}

/// The loads N of least squares with Σ N_i column_i = −required: N = Aᵀ (A Aᵀ)⁻¹ (−required), with a trace of regularisation for
/// links that carry nothing.
fn least_loads(
    columns: &[[f64; MAX_EQUATIONS]],
    required: &[f64; MAX_EQUATIONS],
    rows: usize,
) -> Vec<f64> {
    let mut matrix = [[0.0; MAX_EQUATIONS + 1]; MAX_EQUATIONS];
    for i in 0..rows {
        for j in 0..rows {
            matrix[i][j] = columns.iter().map(|c| c[i] * c[j]).sum();
        }
        matrix[i][i] += 1e-12;
        matrix[i][MAX_EQUATIONS] = -required[i];
    }
    // Gauss-Jordan with pivoting
    for i in 0..rows {
        let pivot = (i..rows)
            .max_by(|a, b| matrix[*a][i].abs().total_cmp(&matrix[*b][i].abs()))
            .unwrap_or(i);
        matrix.swap(i, pivot);
        let lead = matrix[i][i];
        if lead == 0.0 {
            continue;
        }
        for value in &mut matrix[i] {
            *value /= lead;
        }
        let row = matrix[i];
        for (j, other) in matrix.iter_mut().enumerate().take(rows) {
            if j != i {
                let factor = other[i];
                for (value, from) in other.iter_mut().zip(row) {
                    *value -= factor * from;
                }
            }
        }
    }
    columns
        .iter()
        .map(|column| {
            (0..rows)
                .map(|i| column[i] * matrix[i][MAX_EQUATIONS])
                .sum()
        })
        .collect()
}
