//! The robot's body: a chassis, links that turn about axes across it, and how all of it accelerates.
//!
//! Generalised speeds u: the chassis' angular velocity, the velocity of its origin (both in its own frame) and
//! the rates of the freedoms. Kane's equations give M u̇ = Q − bias, with Σ over the bodies of
//! M = m Jᵥᵀ Jᵥ + J_ωᵀ I J_ω. Every axis lies across the robot, so that a chain of links only adds up angles.

mod accelerate;

use grouser_real::Real;
use grouser_slip::onboard::{CarrierLink, MAX_CARRIER_LINKS, MAX_JOINTS, WheelCarrier};
use grouser_terra::EARTH_GRAVITY_M_PER_S2;

use crate::vector::{Attitude, Tensor, Vector};
pub(crate) use accelerate::solve;

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
    /// Angle at which an actuator holds the spring, rad; `None` for a freedom that nothing drives: its spring rests at 0.
    pub driven: Option<f64>,
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
    /// The bodies of the chassis and of each link as one, links without a body left out.
    joined: Vec<Body>,
    mass: f64,
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
    /// Velocity of the pivot relative to the chassis, m/s.
    velocity: Vector,
    /// The part of its acceleration that comes from the rates alone, m/s².
    acceleration: Vector,
}

impl LinkPose {
    /// Velocity of the link's point that is now at `at`, relative to the chassis.
    fn velocity_at(&self, at: Vector) -> Vector {
        let arm = at - self.pivot;
        self.velocity + Vector::new(arm.z, 0.0, -arm.x) * self.rate
    }

    /// The part of its acceleration that comes from the rates alone.
    fn acceleration_at(&self, at: Vector) -> Vector {
        let arm = at - self.pivot;
        self.acceleration - Vector::new(arm.x, 0.0, arm.z) * (self.rate * self.rate)
    }
}

/// The pose of every link, from which points and their motion follow.
#[derive(Clone, Debug)]
pub struct Pose {
    links: Vec<LinkPose>,
}

impl Linkage {
    /// A body of these parts; links stand after the links that carry them.
    #[must_use]
    pub fn new(bodies: Vec<Body>, links: Vec<Link>, holds: Vec<Hold>) -> Self {
        let mut linkage = Self {
            bodies,
            links,
            holds,
            gravity: EARTH_GRAVITY_M_PER_S2,
            joined: Vec::new(),
            mass: 0.0,
        };
        linkage.join();
        linkage
    }

    /// Joins the bodies of the chassis and of each link.
    fn join(&mut self) {
        self.mass = self.bodies.iter().map(|body| body.mass).sum();
        let links = (0..self.links.len()).map(Some);
        self.joined = std::iter::once(None)
            .chain(links)
            .filter_map(|link| {
                let on_it = || self.bodies.iter().filter(move |body| body.link == link);
                let mass: f64 = on_it().map(|body| body.mass).sum();
                let mut centre = Vector::ZERO;
                for body in on_it() {
                    centre += body.centre * (body.mass / mass);
                }
                let inertia = on_it().fold(Tensor::default(), |sum, body| {
                    sum.plus(body.inertia, 1.0)
                        .plus(Tensor::of_point(body.mass, body.centre - centre), 1.0)
                });
                (mass > 0.0).then_some(Body {
                    link,
                    mass,
                    centre,
                    inertia,
                })
            })
            .collect();
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

    /// Turns the rest of a driven freedom by an angle, rad.
    pub(crate) fn drive(&mut self, freedom: usize, by: f64) {
        let hold = &mut self.holds[freedom];
        hold.driven = Some(hold.driven.unwrap_or(0.0) + by);
    }

    /// Moves the chassis' centre of gravity. Its inertia remains that of the pose of the description.
    pub(crate) fn shift(&mut self, by: Vector) {
        for body in self.bodies.iter_mut().chain(&mut self.joined) {
            if body.link.is_none() {
                body.centre += by;
            }
        }
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
        self.join();
    }

    /// Mass of the whole, kg.
    #[must_use]
    pub const fn mass(&self) -> f64 {
        self.mass
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
            let (mut velocity, mut acceleration) = (Vector::ZERO, Vector::ZERO);
            if let Some(on) = link.on {
                let carrier = pose.links[on];
                angle += carrier.angle;
                rate += carrier.rate;
                pivot = carrier.pivot
                    + (link.pivot - self.links[on].pivot).pitched(carrier.trigonometry);
                velocity = carrier.velocity_at(pivot);
                acceleration = carrier.acceleration_at(pivot);
            }
            let (sin, cos) = Real::sin_cos(angle);
            pose.links[index] = LinkPose {
                angle,
                rate,
                trigonometry: (cos, sin),
                pivot,
                velocity,
                acceleration,
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

    /// Velocity at `speeds` of a point of a link that is now at `at`, in the robot's frame, m/s.
    #[must_use]
    #[inline]
    pub fn velocity(
        &self,
        speeds: &Speeds,
        pose: &Pose,
        link: Option<usize>,
        at: Vector,
    ) -> Vector {
        let turning = Vector::new(speeds[0], speeds[1], speeds[2]);
        let own = Vector::new(speeds[3], speeds[4], speeds[5]) + turning.cross(at);
        self.chain(pose, link, at)
            .fold(own, |sum, (freedom, linear, _)| {
                sum + linear * speeds[6 + freedom]
            })
    }

    /// The links from one to the chassis: freedom, and the velocity of the point `at` that its rate gives, with its turning
    /// about y.
    fn chain(
        &self,
        pose: &Pose,
        link: Option<usize>,
        at: Vector,
    ) -> impl Iterator<Item = (usize, Vector, f64)> {
        std::iter::successors(link, |index| self.links[*index].on).map(move |index| {
            let link = &self.links[index];
            let arm = at - pose.links[index].pivot;
            let linear = Vector::new(arm.z, 0.0, -arm.x) * link.sign;
            (link.freedom, linear, link.sign)
        })
    }

    /// Adds a force (N) at the point `at` of a link and a moment (N m), in the robot's frame.
    #[inline]
    pub fn push(
        &self,
        pose: &Pose,
        forces: &mut Speeds,
        (link, at): (Option<usize>, Vector),
        force: Vector,
        moment: Vector,
    ) {
        let about_origin = at.cross(force) + moment;
        for axis in 0..3 {
            forces[axis] += about_origin[axis];
            forces[3 + axis] += force[axis];
        }
        for (freedom, linear, turning) in self.chain(pose, link, at) {
            forces[6 + freedom] += linear.dot(force) + turning * moment.y;
        }
    }

    /// The inertia (kg m²) that a `step` (s) adds to each freedom, so that springs, dampers and end stops of any strength
    /// are stable: the damper acts at the mean of the rates before and after the step, the spring at the mean of three
    /// angles (the trapezoidal rule).
    pub(crate) fn held_inertia(&self, state: &BodyState, step: f64) -> [f64; MAX_FREEDOMS] {
        let mut added = [0.0; MAX_FREEDOMS];
        for (index, hold) in self.holds.iter().enumerate() {
            let (stiffness, damping) = hold.strength(state.joints[index]);
            added[index] = 0.5 * step * damping + 0.25 * step * step * stiffness;
        }
        added
    }

    /// Adds springs, dampers and end stops.
    pub fn hold(&self, state: &BodyState, forces: &mut Speeds) {
        for (index, hold) in self.holds.iter().enumerate() {
            let (angle, rate) = (state.joints[index], state.speeds[6 + index]);
            forces[6 + index] += hold.moment(angle, rate);
        }
    }

    /// Kinetic energy, and potential energy above z = 0 with the springs' (J).
    #[must_use]
    pub fn energy(&self, state: &BodyState, pose: &Pose) -> (f64, f64) {
        let (mut kinetic, mut potential) = (0.0, 0.0);
        for body in &self.bodies {
            let at = self.point(pose, body.link, body.centre);
            let relative = body
                .link
                .map_or(Vector::ZERO, |index| pose.links[index].velocity_at(at));
            let velocity = state.velocity() + state.turning().cross(at) + relative;
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
        // the velocity is that along the axes amid the step
        let half = Attitude::from_rotation(state.turning() * (0.5 * step));
        let amid = state.attitude.then(half);
        state.position += amid.to_world(state.velocity()) * step;
        state.attitude = amid.then(half).normalised();
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
        self.preload - self.stiffness * self.bent(angle) - self.damping * rate - stop
    }

    /// How far the spring is bent, rad.
    pub(crate) fn bent(&self, angle: f64) -> f64 {
        angle - self.driven.unwrap_or(0.0)
    }

    /// Stiffness (N m/rad) and damping (N m s/rad) at an angle, with those of an end stop beyond the range.
    fn strength(&self, angle: f64) -> (f64, f64) {
        if angle.abs() > self.range {
            (
                self.stiffness + STOP_STIFFNESS_N_M_PER_RAD,
                self.damping + STOP_DAMPING_N_M_S_PER_RAD,
            )
        } else {
            (self.stiffness, self.damping)
        }
    }

    fn energy(&self, angle: f64) -> f64 {
        let beyond = angle - angle.clamp(-self.range, self.range);
        let bent = self.bent(angle);
        0.5 * (self.stiffness * bent * bent + STOP_STIFFNESS_N_M_PER_RAD * beyond * beyond)
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
