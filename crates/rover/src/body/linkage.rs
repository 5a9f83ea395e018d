//! The robot's body: a chassis, links that turn about axes across it, and how all of it accelerates.
//!
//! Generalised speeds u: the chassis' angular velocity, the velocity of its origin (both in its own frame) and
//! the rates of the freedoms. Kane's equations give M u̇ = Q − bias, with Σ over the bodies of
//! M = m Jᵥᵀ Jᵥ + J_ωᵀ I J_ω. Every axis lies across the robot, so that a chain of links only adds up angles.

use grouser_real::Real;
use grouser_slip::onboard::{CarrierLink, MAX_CARRIER_LINKS, MAX_JOINTS, WheelCarrier};
use grouser_terra::EARTH_GRAVITY_M_PER_S2;

use crate::vector::{Attitude, Tensor, Vector};

/// Greatest number of freedoms beside the chassis' six.
pub const MAX_FREEDOMS: usize = MAX_JOINTS;
/// Greatest number of generalised speeds.
pub const MAX_SPEEDS: usize = 6 + MAX_FREEDOMS;
/// A chain from a link to the chassis holds at most this many links.
pub(crate) const MAX_CHAIN: usize = MAX_CARRIER_LINKS;

/// Generalised speeds or forces.
pub type Speeds = [f64; MAX_SPEEDS];

/// A mass that moves with a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Its link; `None`: the chassis.
    pub link: Option<usize>,
    /// kg.
    pub mass: f64,
    /// Centre in the robot's frame, in the pose of the description, m.
    pub centre: Vector,
    /// About its centre, kg m².
    pub inertia: Tensor,
}

/// A link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// The link that carries it, earlier in the list; `None`: the chassis.
    pub on: Option<usize>,
    /// Its pivot in the pose of the description, m.
    pub pivot: Vector,
    /// Which freedom turns it.
    pub freedom: usize,
    /// +1, or −1 for the other side of a differential.
    pub sign: f64,
}

/// What holds a freedom: spring, damper, preload and end stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// N m/rad.
    pub stiffness: f64,
    /// N m s/rad.
    pub damping: f64,
    /// N m in the freedom's direction.
    pub preload: f64,
    /// rad either way.
    pub range: f64,
}

/// The robot's body.
///
/// ```
/// use grouser_rover::robot::RobotModel;
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/rocker-bogie.toml");
/// let linkage = RobotModel::read(file.as_ref())?.linkage;
/// assert!(linkage.freedoms() > 0 && linkage.mass() > 1.0); // rockers and bogies; kg
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Linkage {
    bodies: Vec<Body>,
    links: Vec<Link>,
    holds: Vec<Hold>,
    gravity: f64,
}

/// Where the body is and how it moves.
///
/// ```
/// use grouser_rover::body::BodyState;
/// use grouser_rover::vector::{Attitude, Vector};
///
/// let mut state = BodyState::at(Vector::ZERO, Attitude::LEVEL);
/// state.speeds[3] = 0.2; // m/s ahead
/// assert_eq!(state.velocity(), Vector::new(0.2, 0.0, 0.0));
/// assert_eq!(state.turning(), Vector::ZERO);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BodyState {
    /// Origin of the robot's frame in the world, m.
    pub position: Vector,
    /// Attitude.
    pub attitude: Attitude,
    /// Angle of each freedom, rad.
    pub joints: [f64; MAX_FREEDOMS],
    /// Generalised speeds: angular velocity, velocity (robot's frame), rates of the freedoms.
    pub speeds: Speeds,
}

impl BodyState {
    /// At rest in the pose of the description.
    #[must_use]
    pub const fn at(position: Vector, attitude: Attitude) -> Self {
        Self {
            position,
            attitude,
            joints: [0.0; MAX_FREEDOMS],
            speeds: [0.0; MAX_SPEEDS],
        }
    }

    /// Angular velocity in the robot's frame, rad/s.
    #[must_use]
    pub const fn turning(&self) -> Vector {
        Vector::new(self.speeds[0], self.speeds[1], self.speeds[2])
    }

    /// Velocity of the origin in the robot's frame, m/s.
    #[must_use]
    pub const fn velocity(&self) -> Vector {
        Vector::new(self.speeds[3], self.speeds[4], self.speeds[5])
    }
}

/// Where a link is at this moment, in the robot's frame.
#[derive(Clone, Copy, Debug, Default)]
struct LinkPose {
    angle: f64,
    rate: f64,
    trigonometry: (f64, f64),
    pivot: Vector,
}

/// The pose of every link, from which points and their motion follow.
#[derive(Clone, Debug)]
pub struct Pose {
    links: Vec<LinkPose>,
}

/// A column of the Jacobians of a point: generalised speed, velocity and turning that it gives.
type Column = (usize, Vector, Vector);

/// The columns of one point.
struct Columns {
    list: [Column; 6 + MAX_CHAIN],
    count: usize,
}

impl Columns {
    fn as_slice(&self) -> &[Column] {
        &self.list[..self.count]
    }
}

impl Linkage {
    /// A body of these parts; links stand after the links that carry them.
    #[must_use]
    pub fn new(bodies: Vec<Body>, links: Vec<Link>, holds: Vec<Hold>) -> Self {
        Self {
            bodies,
            links,
            holds,
            gravity: EARTH_GRAVITY_M_PER_S2,
        }
    }

    /// The same body under another gravity than the Earth's, m/s².
    #[must_use]
    pub fn under_gravity(mut self, gravity: f64) -> Self {
        self.gravity = gravity;
        self
    }

    /// The gravity that it is under, m/s².
    #[must_use]
    pub const fn gravity(&self) -> f64 {
        self.gravity
    }

    /// Number of freedoms beside the chassis' six.
    #[must_use]
    pub fn freedoms(&self) -> usize {
        self.holds.len()
    }

    /// The bodies.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// The links.
    #[must_use]
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// What holds each freedom.
    #[must_use]
    pub fn holds(&self) -> &[Hold] {
        &self.holds
    }

    /// What carries a wheel with its centre at `centre` (m) on `link`, as the on-board computer takes it.
    #[must_use]
    pub fn carrier(&self, link: Option<usize>, centre: Vector) -> WheelCarrier {
        let mut chain = [None; MAX_CHAIN];
        let mut next = link;
        for slot in chain.iter_mut().rev() {
            *slot = next.map(|index| self.links[index]);
            next = slot.and_then(|link| link.on);
        }
        let on_chassis = WheelCarrier::on_chassis([centre.x, centre.z]);
        chain.iter().flatten().fold(on_chassis, |carrier, link| {
            carrier.with_link(CarrierLink {
                joint: link.freedom,
                sign: link.sign,
                pivot: [link.pivot.x, link.pivot.z],
            })
        })
    }

    /// Moves the chassis' centre of gravity, and stretches everything along x and y.
    pub(crate) fn adjust(&mut self, by: Vector, (lengthen, widen): (f64, f64)) {
        let stretched = |v: Vector| Vector::new(v.x * lengthen, v.y * widen, v.z);
        for body in &mut self.bodies {
            body.centre = stretched(body.centre);
            if body.link.is_none() {
                body.centre += by;
            }
        }
        for link in &mut self.links {
            link.pivot = stretched(link.pivot);
        }
    }

    /// Mass of the whole, kg.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.bodies.iter().map(|body| body.mass).sum()
    }

    /// Centre of gravity in the robot's frame, m.
    ///
    /// ```
    /// use grouser_rover::body::BodyState;
    /// use grouser_rover::robot::RobotModel;
    /// use grouser_rover::vector::{Attitude, Vector};
    ///
    /// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/rocker-bogie.toml");
    /// let linkage = RobotModel::read(file.as_ref())?.linkage;
    /// let rest = BodyState::at(Vector::ZERO, Attitude::LEVEL);
    /// let centre = linkage.centre(&linkage.pose(&rest));
    /// assert!(centre.y.abs() < 1e-9 && centre.z > 0.0); // on the middle plane, above the ground
    /// # Ok::<(), grouser_rover::Error>(())
    /// ```
    #[must_use]
    pub fn centre(&self, pose: &Pose) -> Vector {
        let mut sum = Vector::ZERO;
        for body in &self.bodies {
            sum += self.point(pose, body.link, body.centre) * body.mass;
        }
        sum * (1.0 / self.mass())
    }

    /// Room for a pose.
    #[must_use]
    pub fn pose(&self, state: &BodyState) -> Pose {
        let mut pose = Pose {
            links: vec![LinkPose::default(); self.links.len()],
        };
        self.update_pose(state, &mut pose);
        pose
    }

    /// Brings the pose up to the state.
    pub fn update_pose(&self, state: &BodyState, pose: &mut Pose) {
        for (index, link) in self.links.iter().enumerate() {
            let (mut angle, mut rate) = (
                link.sign * state.joints[link.freedom],
                link.sign * state.speeds[6 + link.freedom],
            );
            let mut pivot = link.pivot;
            if let Some(on) = link.on {
                let carrier = pose.links[on];
                angle += carrier.angle;
                rate += carrier.rate;
                pivot = carrier.pivot
                    + (link.pivot - self.links[on].pivot).pitched(carrier.trigonometry);
            }
            let (sin, cos) = Real::sin_cos(angle);
            pose.links[index] = LinkPose {
                angle,
                rate,
                trigonometry: (cos, sin),
                pivot,
            };
        }
    }

    /// Where a point of a link is now, in the robot's frame.
    #[must_use]
    pub fn point(&self, pose: &Pose, link: Option<usize>, rest: Vector) -> Vector {
        match link {
            None => rest,
            Some(index) => {
                let now = pose.links[index];
                now.pivot + (rest - self.links[index].pivot).pitched(now.trigonometry)
            }
        }
    }

    /// A direction fixed to a link, in the robot's frame.
    #[must_use]
    pub fn direction(&self, pose: &Pose, link: Option<usize>, rest: Vector) -> Vector {
        match link {
            None => rest,
            Some(index) => rest.pitched(pose.links[index].trigonometry),
        }
    }

    /// How a link turns beside the chassis, rad/s about y.
    #[must_use]
    pub fn rate(&self, pose: &Pose, link: Option<usize>) -> f64 {
        link.map_or(0.0, |index| pose.links[index].rate)
    }

    /// Velocity of a point of a link that is now at `at`, in the robot's frame, m/s.
    #[must_use]
    pub fn velocity(
        &self,
        state: &BodyState,
        pose: &Pose,
        link: Option<usize>,
        at: Vector,
    ) -> Vector {
        state.velocity() + state.turning().cross(at) + self.relative(pose, link, at, false)
    }

    /// Velocity of the point relative to the chassis, or the part of its acceleration that comes from the
    /// rates alone.
    fn relative(
        &self,
        pose: &Pose,
        link: Option<usize>,
        mut at: Vector,
        accelerates: bool,
    ) -> Vector {
        let mut sum = Vector::ZERO;
        let mut next = link;
        while let Some(index) = next {
            let now = pose.links[index];
            let arm = at - now.pivot;
            let rate = now.rate;
            sum += if accelerates {
                Vector::new(arm.x, 0.0, arm.z) * (-rate * rate)
            } else {
                Vector::new(arm.z, 0.0, -arm.x) * rate
            };
            at = now.pivot;
            next = self.links[index].on;
        }
        sum
    }

    fn columns(&self, pose: &Pose, link: Option<usize>, at: Vector) -> Columns {
        let [e_x, e_y, e_z] = Vector::AXES;
        let none = Vector::ZERO;
        let mut out = Columns {
            list: [(0, none, none); 6 + MAX_CHAIN],
            count: 6,
        };
        for (index, axis) in [e_x, e_y, e_z].into_iter().enumerate() {
            out.list[index] = (index, axis.cross(at), axis);
            out.list[3 + index] = (3 + index, axis, none);
        }
        let mut next = link;
        while let Some(index) = next {
            let link = self.links[index];
            let arm = at - pose.links[index].pivot;
            out.list[out.count] = (
                6 + link.freedom,
                Vector::new(arm.z, 0.0, -arm.x) * link.sign,
                e_y * link.sign,
            );
            out.count += 1;
            next = link.on;
        }
        out
    }

    /// Adds a force (N) at the point `at` of a link and a moment (N m), in the robot's frame.
    pub fn push(
        &self,
        pose: &Pose,
        forces: &mut Speeds,
        (link, at): (Option<usize>, Vector),
        force: Vector,
        moment: Vector,
    ) {
        for (index, linear, angular) in self.columns(pose, link, at).as_slice() {
            forces[*index] += linear.dot(force) + angular.dot(moment);
        }
    }

    /// Adds springs, dampers and end stops.
    pub fn hold(&self, state: &BodyState, forces: &mut Speeds) {
        for (index, hold) in self.holds.iter().enumerate() {
            let (angle, rate) = (state.joints[index], state.speeds[6 + index]);
            forces[6 + index] += hold.moment(angle, rate);
        }
    }

    /// Accelerations under `forces` and gravity.
    #[must_use]
    pub fn accelerate(&self, state: &BodyState, pose: &Pose, forces: &Speeds) -> Speeds {
        let size = 6 + self.freedoms();
        let mut right = *forces;
        let mut matrix = [[0.0; MAX_SPEEDS]; MAX_SPEEDS];
        let down = state.attitude.to_robot(Vector::AXES[2] * -self.gravity);
        let (turning, velocity) = (state.turning(), state.velocity());
        for body in &self.bodies {
            let at = self.point(pose, body.link, body.centre);
            let rate = self.rate(pose, body.link);
            let relative = self.relative(pose, body.link, at, false);
            let bias = turning.cross(velocity + turning.cross(at))
                + turning.cross(relative) * 2.0
                + self.relative(pose, body.link, at, true);
            let inertia = match body.link {
                None => body.inertia,
                Some(index) => pitched(&body.inertia, pose.links[index].trigonometry),
            };
            let spin = turning + Vector::AXES[1] * rate;
            let turn_bias = turning.cross(Vector::AXES[1] * rate);
            let force = (down - bias) * body.mass;
            let moment = -(inertia.times(turn_bias) + spin.cross(inertia.times(spin)));
            let columns = self.columns(pose, body.link, at);
            let columns = columns.as_slice();
            for (i, (row, linear, angular)) in columns.iter().enumerate() {
                right[*row] += linear.dot(force) + angular.dot(moment);
                let (heavy, turned) = (*linear * body.mass, inertia.times(*angular));
                for (column, linear, angular) in &columns[..=i] {
                    let value = heavy.dot(*linear) + turned.dot(*angular);
                    let (low, high) = (*row.min(column), *row.max(column));
                    matrix[high][low] += value;
                }
            }
        }
        solve(&mut matrix, &mut right, size);
        right
    }

    /// Kinetic energy, and potential energy above z = 0 with the springs' (J).
    #[must_use]
    pub fn energy(&self, state: &BodyState, pose: &Pose) -> (f64, f64) {
        let (mut kinetic, mut potential) = (0.0, 0.0);
        for body in &self.bodies {
            let at = self.point(pose, body.link, body.centre);
            let velocity = self.velocity(state, pose, body.link, at);
            let inertia = match body.link {
                None => body.inertia,
                Some(index) => pitched(&body.inertia, pose.links[index].trigonometry),
            };
            let spin = state.turning() + Vector::AXES[1] * self.rate(pose, body.link);
            kinetic += 0.5 * (body.mass * velocity.dot(velocity) + spin.dot(inertia.times(spin)));
            let world = state.position + state.attitude.to_world(at);
            potential += body.mass * self.gravity * world.z;
        }
        for (hold, angle) in self.holds.iter().zip(state.joints) {
            potential += hold.energy(angle);
        }
        (kinetic, potential)
    }

    /// Moves the state on by `step` s with its present speeds.
    pub fn advance(&self, state: &mut BodyState, step: f64) {
        let travel = state.attitude.to_world(state.velocity()) * step;
        state.position += travel;
        state.attitude = state
            .attitude
            .then(Attitude::from_rotation(state.turning() * step))
            .normalised();
        for index in 0..self.freedoms() {
            state.joints[index] += step * state.speeds[6 + index];
        }
    }
}

/// Stiffness of an end stop, N m/rad: 2° under 70 N m, 230 N at an arm of 0.3 m.
const STOP_STIFFNESS_N_M_PER_RAD: f64 = 2000.0;
/// Damping of an end stop, N m s/rad: chosen, not measured.
const STOP_DAMPING_N_M_S_PER_RAD: f64 = 5.0;

impl Hold {
    /// Moment on the freedom, N m.
    #[must_use]
    pub fn moment(&self, angle: f64, rate: f64) -> f64 {
        let beyond = angle - angle.clamp(-self.range, self.range);
        let stop = if beyond == 0.0 {
            0.0
        } else {
            STOP_STIFFNESS_N_M_PER_RAD * beyond + STOP_DAMPING_N_M_S_PER_RAD * rate
        };
        self.preload - self.stiffness * angle - self.damping * rate - stop
    }

    fn energy(&self, angle: f64) -> f64 {
        let beyond = angle - angle.clamp(-self.range, self.range);
        0.5 * (self.stiffness * angle * angle + STOP_STIFFNESS_N_M_PER_RAD * beyond * beyond)
            - self.preload * angle
    }
}

/// A link's tensor in the robot's frame.
fn pitched(inertia: &Tensor, (cos, sin): (f64, f64)) -> Tensor {
    let (d, p) = (inertia.diagonal, inertia.products);
    let (xx, zz, xz) = (d.x, d.z, p.y);
    Tensor {
        diagonal: Vector::new(
            cos * cos * xx + 2.0 * cos * sin * xz + sin * sin * zz,
            d.y,
            sin * sin * xx - 2.0 * cos * sin * xz + cos * cos * zz,
        ),
        products: Vector::new(
            cos * p.x - sin * p.z,
            (cos * cos - sin * sin) * xz + cos * sin * (zz - xx),
            cos * p.z + sin * p.x,
        ),
    }
}

/// Solves a symmetric positive definite system in place by Cholesky's method; the lower triangle is given.
pub(crate) fn solve(matrix: &mut [[f64; MAX_SPEEDS]; MAX_SPEEDS], right: &mut Speeds, size: usize) {
    for i in 0..size {
        for j in 0..=i {
            let (left, upper) = (&matrix[i][..j], &matrix[j][..j]);
            let known: f64 = left.iter().zip(upper).map(|(a, b)| a * b).sum();
            let sum = matrix[i][j] - known;
            matrix[i][j] = if i == j {
                // masses are positive, so that only rounding could bring it to 0
                sum.max(f64::MIN_POSITIVE).sqrt()
            } else {
                sum / matrix[j][j]
            };
        }
    }
    for i in 0..size {
        let mut sum = right[i];
        for k in 0..i {
            sum -= matrix[i][k] * right[k];
        }
        right[i] = sum / matrix[i][i];
    }
    for i in (0..size).rev() {
        let mut sum = right[i];
        for k in i + 1..size {
            sum -= matrix[k][i] * right[k];
        }
        right[i] = sum / matrix[i][i];
    }
}
