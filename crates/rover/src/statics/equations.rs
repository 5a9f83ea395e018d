//! The equations of a robot at rest, for every direction of gravity.

use grouser_real::Real;

use super::margins::TipOverCone;
use crate::body::{BodyState, MAX_FREEDOMS, MAX_SPEEDS, Pose, Speeds};
use crate::robot::RobotModel;
use crate::vector::{Attitude, Vector};

/// Equations: heave, two moments about axes in the ground, and the freedoms of the links.
const ROWS: usize = 3 + MAX_FREEDOMS;
/// A row of the equations for each of them, N and N m.
type Column = [f64; ROWS];
/// A column whose part across the others is less than this share of it depends on them: far above rounding.
const DEPENDENT: f64 = 1e-9;
/// Loads balance to this share of the weight, far above the regularisation of the least squares.
const BALANCE_TOLERANCE: f64 = 1e-9;
/// Further tilts are followed up to this, rad: what a robot that is tilted by more may balance on is not asked.
const MAX_TILT_RAD: f64 = 1.2;
/// The share of gravity into the ground is taken to be at least this, so that traction per load is finite.
const LEAST_UP: f64 = 0.1;
/// Regularises links that no wheel carries.
const REGULARISATION: f64 = 1e-12;

/// The ground's directions in the robot's frame, with `up` last: what a wheel at the contact can give along each.
struct WheelColumns {
    /// By its place in the robot.
    wheel: usize,
    along: [Column; 3],
}

/// Forces and moments that balance for heave, roll, pitch and every freedom of the links.
///
/// Powered wheels hold the robot on a slope, each in proportion to its load, so that their forces are parallel to gravity;
/// free wheels carry only. What no wheel can balance (a mast on its spring, two wheels on one axle) is left out.
pub(super) struct Equations {
    axes: [Vector; 3],
    wheels: Vec<WheelColumns>,
    count: usize,
    rows: usize,
    is_rigid: bool,
    weights: [Column; 3],
    springs: Column,
    pub(super) weight: f64,
}

/// A motion of the robot in which some wheels stay on the ground and others rise.
#[derive(Clone)]
struct Motion {
    speeds: Column,
    /// The wheels that stay, by their places in the equations.
    staying: u64,
}

/// What becomes of the balance when the robot tips over some wheels.
pub(super) struct Tipping {
    /// The wheels that stay on the ground, in the robot's order.
    pub(super) wheels: Vec<usize>,
    /// Further tilt of the ground until the others carry nothing, rad, and the cone that is met there.
    pub(super) nearest: (f64, TipOverCone),
    /// The work of the weight against the motion, over its turning and that about level axes, m.
    pub(super) arms: [f64; 2],
}

fn dot(a: &Column, b: &Column) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(to: &mut Column, from: &Column, factor: f64) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += factor * from;
    }
}

/// What is left of a column across orthogonal unit ones.
fn across(mut column: Column, units: &[Column]) -> Column {
    // twice is enough for rounding
    for unit in units.iter().chain(units) {
        let share = dot(&column, unit);
        add(&mut column, unit, -share);
    }
    column
}

/// Adds a column's direction to orthogonal unit ones; false where it depends on them.
fn extend(units: &mut Vec<Column>, column: &Column) -> bool {
    let own = across(*column, units);
    let length = dot(&own, &own).sqrt();
    let is_independent = length > DEPENDENT * dot(column, column).sqrt();
    if is_independent {
        units.push(own.map(|value| value / length));
    }
    is_independent
}

impl Equations {
    /// Of a robot in the pose of its description, on a plane.
    pub(super) fn on_plane(model: &RobotModel) -> Self {
        let state = BodyState::at(Vector::ZERO, Attitude::LEVEL);
        Self::new(model, &state, &model.linkage.pose(&state), |_| true)
    }

    /// Of a robot in any pose, on those wheels that touch ground that is level under each; a link at its end stop is fixed, and
    /// so is one that an actuator holds.
    pub(super) fn new(
        model: &RobotModel,
        state: &BodyState,
        pose: &Pose,
        touches: impl Fn(usize) -> bool,
    ) -> Self {
        let linkage = &model.linkage;
        let up = state.attitude.to_robot(Vector::AXES[2]);
        let ahead = (Vector::AXES[0] - up * up.x).unit();
        let axes = [ahead, up.cross(ahead), up];
        let holds = linkage.holds();
        let is_free = |index: usize| {
            holds[index].driven.is_none() && state.joints[index].abs() <= holds[index].range
        };
        let column = |speeds: &Speeds| {
            let moment = Vector::new(speeds[0], speeds[1], speeds[2]);
            let force = Vector::new(speeds[3], speeds[4], speeds[5]);
            let mut out = [0.0; ROWS];
            (out[0], out[1], out[2]) = (force.dot(up), moment.dot(axes[0]), moment.dot(axes[1]));
            for index in (0..linkage.freedoms()).filter(|index| is_free(*index)) {
                out[3 + index] = speeds[6 + index];
            }
            out
        };
        let weights = axes.map(|axis| {
            let mut speeds = [0.0; MAX_SPEEDS];
            for body in linkage.bodies() {
                let at = linkage.point(pose, body.link, body.centre);
                let force = axis * (body.mass * linkage.gravity());
                linkage.push(pose, &mut speeds, (body.link, at), force, Vector::ZERO);
            }
            column(&speeds)
        });
        let mut springs = [0.0; MAX_SPEEDS];
        linkage.hold(state, &mut springs);
        let touching = model.wheels.iter().enumerate();
        let wheels = touching
            .filter(|(wheel, _)| touches(*wheel))
            .map(|(wheel, mount)| {
                let centre = linkage.point(pose, mount.link, mount.centre);
                let contact = centre - up * mount.wheel.radius();
                let holds = if mount.motor.is_some() { 1.0 } else { 0.0 };
                let shares = [holds, holds, 1.0];
                let along = std::array::from_fn(|axis| {
                    let mut speeds = [0.0; MAX_SPEEDS];
                    let force = axes[axis] * shares[axis];
                    linkage.push(
                        pose,
                        &mut speeds,
                        (mount.link, contact),
                        force,
                        Vector::ZERO,
                    );
                    column(&speeds)
                });
                WheelColumns { wheel, along }
            })
            .collect();
        Self {
            axes,
            wheels,
            count: model.wheels.len(),
            rows: 3 + linkage.freedoms(),
            is_rigid: !(0..linkage.freedoms()).any(is_free),
            weights,
            springs: column(&springs),
            weight: model.weight(),
        }
    }

    /// The direction of gravity along the ground's axes where the ground is tilted under the robot.
    pub(super) fn down(&self, pitch: f64, roll: f64) -> Vector {
        self.along_ground(Attitude::from_angles(roll, -pitch, 0.0).to_robot(-Vector::AXES[2]))
    }

    /// A direction in the robot's frame along the ground's axes.
    pub(super) fn along_ground(&self, direction: Vector) -> Vector {
        let [x, y, z] = self.axes.map(|axis| axis.dot(direction));
        Vector::new(x, y, z)
    }

    /// What a load of 1 N on each wheel does, with the traction by which it holds the robot.
    fn columns(&self, down: Vector) -> Vec<Column> {
        let per_load = -1.0 / (-down.z).max(LEAST_UP);
        let column = |wheel: &WheelColumns| {
            let [ahead, left, up] = &wheel.along;
            let mut out = *up;
            add(&mut out, ahead, down.x * per_load);
            add(&mut out, left, down.y * per_load);
            out
        };
        self.wheels.iter().map(column).collect()
    }

    /// What the wheels have to balance.
    fn required(&self, down: Vector) -> Column {
        let mut out = self.springs.map(|moment| -moment);
        for (weights, share) in self.weights.iter().zip([down.x, down.y, down.z]) {
            add(&mut out, weights, -share);
        }
        out
    }

    /// The loads of least squares, N; none is negative where that can be, as on ground that yields alike everywhere. Whether
    /// it can, comes second.
    pub(super) fn loads(&self, down: Vector) -> (Vec<f64>, bool) {
        let (columns, required) = (self.columns(down), self.required(down));
        let mut carries = vec![true; columns.len()];
        let mut signed: Option<Vec<f64>> = None;
        // a wheel that would be held down leaves the ground, one that the others would push into it carries again
        for _ in 0..=2 * columns.len() {
            let multipliers = multipliers(&columns, &required, &carries, self.rows);
            let wanted: Vec<f64> = columns.iter().map(|c| dot(c, &multipliers)).collect();
            signed.get_or_insert_with(|| wanted.clone());
            let next: Vec<bool> = wanted.iter().map(|load| *load >= 0.0).collect();
            if next != carries {
                carries = next;
                continue;
            }
            let mut left = required;
            for (column, load) in columns.iter().zip(&wanted) {
                add(&mut left, column, -load.max(0.0));
            }
            let off = |column: &Column| dot(column, &left).abs() / dot(column, column).sqrt();
            let stands = columns
                .iter()
                .all(|c| off(c) <= BALANCE_TOLERANCE * self.weight);
            if stands {
                let loads: Vec<f64> = wanted.iter().map(|load| load.max(0.0)).collect();
                return (self.by_wheel(&loads), true);
            }
            break;
        }
        (self.by_wheel(&signed.unwrap_or_default()), false)
    }

    fn by_wheel(&self, loads: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.count];
        for (own, load) in self.wheels.iter().zip(loads) {
            out[own.wheel] = *load;
        }
        out
    }

    /// All motions in which no wheel sinks and as many stay on the ground as can: the edges of the cone of all motions that
    /// the ground allows. The robot stands where gravity does no work on any of them.
    ///
    /// Source: the double description method (Motzkin et al. 1953), with Farkas' lemma.
    fn motions(columns: &[Column]) -> Vec<Motion> {
        let (mut spanned, mut basis) = (Vec::new(), Vec::new());
        for (wheel, column) in columns.iter().enumerate() {
            if extend(&mut spanned, column) {
                basis.push(wheel);
            }
        }
        let all = basis.iter().fold(0, |all, wheel| all | 1 << wheel);
        let simple = |wheel: &usize| {
            let staying = all & !(1 << wheel);
            let speeds = across(columns[*wheel], &units(columns, staying));
            Motion { speeds, staying }
        };
        let mut motions: Vec<Motion> = basis.iter().map(simple).collect();
        for (wheel, column) in columns.iter().enumerate() {
            if basis.contains(&wheel) {
                continue;
            }
            let bit = 1_u64 << wheel;
            let rises = |motion: &Motion| {
                let size = dot(&motion.speeds, &motion.speeds) * dot(column, column);
                let speed = dot(&motion.speeds, column);
                if speed.abs() <= DEPENDENT * size.sqrt() {
                    0.0
                } else {
                    speed
                }
            };
            let mut next: Vec<Motion> = Vec::new();
            for (i, rising) in motions.iter().enumerate() {
                let up = rises(rising);
                if up >= 0.0 {
                    let staying = rising.staying | if up == 0.0 { bit } else { 0 };
                    next.push(Motion {
                        staying,
                        ..rising.clone()
                    });
                }
                for (j, sinking) in motions.iter().enumerate() {
                    let down = rises(sinking);
                    if !(up > 0.0 && down < 0.0) {
                        continue;
                    }
                    // neighbours: no third motion keeps the wheels that both keep
                    let both = rising.staying & sinking.staying;
                    let mut others = motions
                        .iter()
                        .enumerate()
                        .filter(|(k, _)| *k != i && *k != j);
                    if others.any(|(_, other)| other.staying & both == both) {
                        continue;
                    }
                    let mut speeds = rising.speeds.map(|speed| -down * speed);
                    add(&mut speeds, &sinking.speeds, up);
                    let size = dot(&speeds, &speeds).sqrt();
                    next.push(Motion {
                        speeds: speeds.map(|speed| speed / size),
                        staying: both | bit,
                    });
                }
            }
            motions = next;
        }
        motions
    }

    /// The smallest angle from `down` to where the robot tips over, rad; any up to `enough` where it is less.
    pub(super) fn tip_over(&self, down: Vector, enough: f64) -> f64 {
        let (required, mut motions) = (self.required(down), Self::motions(&self.columns(down)));
        let work =
            |own: &Motion| dot(&own.speeds, &required) / dot(&own.speeds, &own.speeds).sqrt();
        motions.sort_by(|a, b| work(a).total_cmp(&work(b)));
        let mut least = MAX_TILT_RAD;
        for found in &motions {
            if least > enough {
                least = least.min(self.nearest(found, down, [enough, least.max(0.0)]).0);
            }
        }
        least
    }

    /// The ways to tip over from where gravity points `down`.
    pub(super) fn tippings(&self, down: Vector) -> Vec<Tipping> {
        let motions = Self::motions(&self.columns(down));
        motions
            .iter()
            .map(|found| {
                let turning = Vector::new(found.speeds[1], found.speeds[2], 0.0);
                let level = turning - down * turning.dot(down);
                let work = dot(&found.speeds, &self.required(down)) / self.weight;
                let size = dot(&found.speeds, &found.speeds).sqrt();
                let staying = self.wheels.iter().enumerate();
                Tipping {
                    wheels: staying
                        .filter(|(place, _)| found.staying >> place & 1 == 1)
                        .map(|(_, own)| own.wheel)
                        .collect(),
                    nearest: self.nearest(found, down, [f64::NEG_INFINITY, MAX_TILT_RAD]),
                    arms: [turning, level].map(|turning| {
                        let is_still = turning.length() <= DEPENDENT * size;
                        if is_still {
                            f64::INFINITY
                        } else {
                            work / turning.length()
                        }
                    }),
                }
            })
            .collect()
    }

    /// The angle from `down` to the nearest direction in which the wheels that do not stay carry nothing, rad; negative beyond
    /// it. What is not `within` an angle is not followed; any angle up to `enough` will do.
    ///
    /// The motion of a robot with links changes with the traction: what is nearest is looked for from `down` and from the
    /// direction ahead, behind or aside where the least is left on those wheels.
    fn nearest(
        &self,
        found: &Motion,
        down: Vector,
        [enough, within]: [f64; 2],
    ) -> (f64, TipOverCone) {
        const ASIDE_RAD: f64 = 0.8;
        let left = |down: Vector| self.left(found, down);
        let own = nearest(left, down, (down, 0.0), within);
        if self.is_rigid || own.0 < 0.0 || own.0 <= enough {
            return own;
        }
        let ahead = down.cross(Vector::AXES[1]).unit();
        let aside = down.cross(ahead);
        let (sin, cos) = Real::sin_cos(ASIDE_RAD);
        let starts = [ahead, -ahead, aside, -aside].map(|to| {
            let start = down * cos + to * sin;
            (left(start).0, start)
        });
        let least = starts.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        let other = least.map(|(_, start)| nearest(left, down, (start, ASIDE_RAD), own.0));
        other.filter(|other| other.0 < own.0).unwrap_or(own)
    }

    /// The work of gravity and springs against a motion of unit size, and its slope with the direction of gravity: the work
    /// of the weight and of the forces of the wheels that stay, along each axis.
    fn left(&self, found: &Motion, down: Vector) -> (f64, Vector) {
        let columns = self.columns(down);
        let (mut units, mut basis) = (Vec::with_capacity(ROWS), Vec::with_capacity(ROWS));
        for (place, column) in columns.iter().enumerate() {
            if found.staying >> place & 1 == 1 && extend(&mut units, column) {
                basis.push(place);
            }
        }
        let speeds = across(found.speeds, &units);
        let size = dot(&speeds, &speeds).sqrt();
        let mut required = self.required(down);
        let work = dot(&speeds, &required) / size;
        let mut slopes = self.weights.map(|weights| -dot(&speeds, &weights) / size);
        for (unit, place) in units.iter().zip(basis).rev() {
            let column = &columns[place];
            let load = dot(unit, &required) / dot(unit, column);
            add(&mut required, column, -load);
            let per_up = load / ((-down.z).max(LEAST_UP) * size);
            for (slope, along) in slopes.iter_mut().zip(&self.wheels[place].along) {
                *slope += per_up * dot(&speeds, along);
            }
        }
        (work, Vector::new(slopes[0], slopes[1], slopes[2]))
    }
}

/// The angle from `down` to the nearest direction in which nothing is `left`, rad, from a direction and its angle on.
///
/// On a motion the work of gravity is linear in its direction and that of the springs constant: these directions are a circle
/// about an axis. The circle is found again where the last one was met. A search that does not converge has met none.
fn nearest(
    left: impl Fn(Vector) -> (f64, Vector),
    down: Vector,
    start: (Vector, f64),
    within: f64,
) -> (f64, TipOverCone) {
    const ROUNDS: u32 = 30;
    const TOLERANCE_RAD: f64 = 1e-6;
    const STRIDE_RAD: f64 = 0.2;
    let (least, most) = if left(down).0 >= 0.0 {
        (0.0, within)
    } else {
        (-MAX_TILT_RAD, 0.0)
    };
    let (mut foot, mut tilt, mut rounds) = (start.0, start.1, 0);
    loop {
        let (here, slope) = left(foot);
        let springs = here - slope.dot(foot);
        let cone = TipOverCone {
            axis: slope.unit(),
            opening: Real::acos((-springs / slope.length()).clamp(-1.0, 1.0)),
        };
        let angle = cone.margin(down);
        rounds += 1;
        if (angle - tilt).abs() < TOLERANCE_RAD {
            return (angle, cone);
        }
        if tilt == most && angle > most {
            return (most, cone);
        }
        tilt = angle
            .clamp(tilt - STRIDE_RAD, tilt + STRIDE_RAD)
            .clamp(least, most);
        if rounds == ROUNDS {
            return (if most > 0.0 { most } else { tilt }, cone);
        }
        let aside = cone.axis.cross(down).cross(cone.axis).unit();
        let towards = (aside - down * aside.dot(down)).unit();
        let (sin, cos) = Real::sin_cos(tilt);
        foot = down * cos + towards * sin;
    }
}

/// Orthogonal unit columns that span those of some wheels.
fn units(columns: &[Column], of: u64) -> Vec<Column> {
    let mut units = Vec::with_capacity(ROWS);
    let staying = columns.iter().enumerate();
    for (_, column) in staying.filter(|(place, _)| of >> place & 1 == 1) {
        extend(&mut units, column);
    }
    units
}

/// The multipliers λ of loads N = Aᵀ λ of least squares with A N = required, over the wheels that carry:
/// (A Aᵀ) λ = required, with a trace of regularisation.
fn multipliers(columns: &[Column], required: &Column, carries: &[bool], rows: usize) -> Column {
    let mut matrix = [[0.0; ROWS + 1]; ROWS];
    for i in 0..rows {
        for j in 0..rows {
            let carrying = columns.iter().zip(carries).filter(|(_, carries)| **carries);
            matrix[i][j] = carrying.map(|(c, _)| c[i] * c[j]).sum();
        }
        matrix[i][i] += REGULARISATION;
        matrix[i][ROWS] = required[i];
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
    std::array::from_fn(|i| matrix[i][ROWS])
}
