//! A robot on the ground, moved on step by step.
//!
//! The body moves by [`Leapfrog`] at a fixed step, and so does each wheel's spin. [`fastest_rate`](super::fastest_rate)
//! bounds the step.

use grouser_real::Real;
use grouser_terra::{Accuracy, Settings, Soil, WheelOnSoil};

use super::contact_frame::{CONTACT_REACH_SHARE, ContactFrame};
use super::wheel_force::{SoilUnder, WheelContact, WheelLoad, WheelMotionNow};
use crate::body::{BodyState, Leapfrog, MAX_SPEEDS, MotorNow, Pose};
use crate::error::{Error, Result};
use crate::ground::{Ground, Track};
use crate::robot::{Actuated, RobotModel, WheelMount};
use crate::statics::tip_over_margin;
use crate::vector::{Attitude, Axes, Vector};

/// Bearing friction is proportional to the rate below this one, rad/s, so that it does not jump at standstill: 7.5 mm/s at
/// a rim of 0.15 m.
pub(super) const BEARING_RATE_RAD_PER_S: f64 = 0.05;
/// A rut ends this many cells behind the wheel's axle: heights are linear between nodes, so that it fades over one cell.
const RUT_DISTANCE_CELLS: f64 = 1.05;

/// Steps that are taken, s; chosen: the longest is half of the control period.
pub(crate) const STEP_LIMITS_S: (f64, f64) = (1e-5, 5e-3);

/// The laws of a wheel on a soil as steps in time take them.
pub(super) fn for_steps(mount: &WheelMount, soil: &Soil) -> Result<WheelOnSoil> {
    let settings = Settings {
        accuracy: Accuracy::Simulation,
        ..Settings::default()
    };
    WheelOnSoil::new(mount.wheel, *soil, settings).map_err(|source| Error::Law {
        of: format!("wheel \"{}\"", mount.name),
        source,
    })
}

/// What a wheel's motor and steering receive.
#[derive(Clone, Copy, Debug, Default)]
struct WheelInput {
    /// Torque on the wheel, N m.
    torque: f64,
    /// Setpoint of the steering angle beside the description's heading, rad.
    steering_angle: f64,
}

/// A wheel at this moment: the truth that sensors see through noise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct WheelNow {
    /// Angle turned about its axle since the start, rad.
    pub angle: f64,
    /// rad/s.
    pub spin: f64,
    /// Against the link that carries it, which is what an encoder sees: angle in rad.
    pub encoder_angle: f64,
    /// And rate, rad/s.
    pub encoder_rate: f64,
    /// Steering angle, rad.
    pub steer: f64,
    /// Speed of its centre forwards and to the left in the contact plane, m/s.
    pub velocity: [f64; 2],
    /// Speed of its rim, m/s.
    pub rim: f64,
    /// Place of its centre in the world, m.
    pub place: Vector,
    /// The ground's force.
    pub load: WheelLoad,
    /// Its motor.
    pub motor: MotorNow,
    /// Index of the soil under it.
    pub soil: usize,
}

/// How a wheel meets the ground at a step, in the robot's frame.
#[derive(Clone, Copy, Debug)]
struct Meeting {
    /// Its centre, m, and in the world.
    at: Vector,
    place: Vector,
    /// The contact plane.
    frame: ContactFrame,
    /// Height of the centre in the wheel's plane, m.
    height: f64,
    /// Velocity of the centre, m/s.
    velocity: Vector,
    motion: WheelMotionNow,
    soil: usize,
    under: SoilUnder,
    /// Depth of the rut that is already there, m.
    rut: f64,
}

/// Where the energy went, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Ledger {
    /// Out of the battery.
    pub electric: f64,
    /// Into the heat of copper and gears.
    pub motor_heat: f64,
    /// Into the soil.
    pub soil: f64,
    /// Into bearings.
    pub bearings: f64,
    /// Into dampers.
    pub dampers: f64,
    /// What of `electric` the actuators of the chassis drew; their heat is part of `motor_heat`.
    pub actuators: f64,
}

/// A robot on the ground.
///
/// ```
/// use grouser_rover::dynamics::Vehicle;
/// use grouser_rover::ground::{Ground, HeightMap};
/// use grouser_rover::robot::RobotModel;
/// use grouser_terra::catalogue;
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/skid-steer.toml");
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil().expect("complete");
/// let mut ground = Ground::new(HeightMap::from_shape((6.0, 4.0), 0.1, |_, _| 0.0)?, vec![soil])?;
/// let mut vehicle = Vehicle::new(RobotModel::read(file.as_ref())?, &ground, (2.0, 0.0, 0.0), 1e-3)?;
/// for wheel in 0..vehicle.wheels().len() {
///     vehicle.set_input(wheel, 2.0, 0.0); // N m on each wheel
/// }
/// for _ in 0..300 {
///     vehicle.advance(&mut ground);
/// }
/// assert!((vehicle.time() - 0.3).abs() < 1e-9);
/// assert!(vehicle.state().position.x > 2.0);
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Vehicle {
    model: RobotModel,
    /// One per wheel and soil.
    pairs: Vec<Vec<WheelOnSoil>>,
    state: BodyState,
    pose: Pose,
    contacts: Vec<WheelContact>,
    /// Where each wheel last pressed the ground.
    pressed_at: Vec<(f64, f64)>,
    /// The way that each wheel has made so far, m.
    ways: Vec<f64>,
    wheels: Vec<WheelNow>,
    body_steps: Leapfrog,
    /// Each wheel's spin half a step ago, rad/s; none before its first step.
    spins_amid: Vec<Option<f64>>,
    /// Direction of each wheel's axle at its steering angle, in the pose of the description.
    axles: Vec<Vector>,
    inputs: Vec<WheelInput>,
    /// Where each actuator of the chassis is to be.
    setpoints: Vec<f64>,
    /// How each wheel meets the ground in the step under way.
    meetings: Vec<Meeting>,
    /// Acceleration of the origin in the robot's frame with gravity's reaction, m/s².
    specific_force: Vector,
    ledger: Ledger,
    time: f64,
    step: f64,
    steps: u64,
}

impl Vehicle {
    /// Puts a robot on the ground at (x, y) with a heading (rad), standing on its wheels.
    ///
    /// # Errors
    /// [`Error::Law`] for a soil under which a wheel has no modulus; [`Error::OutOfRange`] for a step outside
    /// [1e-5, 5e-3] s.
    pub fn new(
        model: RobotModel,
        ground: &Ground,
        (x, y, heading): (f64, f64, f64),
        step: f64,
    ) -> Result<Self> {
        Error::check("simulation", "step", step, STEP_LIMITS_S, "s")?;
        let mut pairs = Vec::new();
        for mount in &model.wheels {
            let row: Result<Vec<_>> = (ground.soils().iter())
                .map(|soil| for_steps(mount, soil))
                .collect();
            pairs.push(row?);
        }
        let spot = ground.at(x, y);
        // the pose that follows the ground's slope under the origin
        let (sin, cos) = Real::sin_cos(heading);
        let along = spot.slope[0] * cos + spot.slope[1] * sin;
        let across = spot.slope[1] * cos - spot.slope[0] * sin;
        let attitude = Attitude::from_angles(Real::atan(across), -Real::atan(along), heading);
        let lowest = model
            .wheels
            .iter()
            .map(|mount| {
                let at = attitude.to_world(mount.centre);
                let below = ground.at(x + at.x, y + at.y).height + mount.wheel.radius();
                below - at.z
            })
            .fold(f64::NEG_INFINITY, f64::max);
        let state = BodyState::at(Vector::new(x, y, lowest), attitude);
        let pose = model.linkage.pose(&state);
        let gravity = model.linkage.gravity();
        let count = model.wheels.len();
        let pressed_at = model
            .wheels
            .iter()
            .map(|mount| {
                let at = state.position + attitude.to_world(mount.centre);
                (at.x, at.y)
            })
            .collect();
        let axles = model.wheels.iter().map(|mount| mount.axle(0.0)).collect();
        let positions = model.actuators.iter().map(|actuator| actuator.position);
        Ok(Self {
            setpoints: positions.collect(),
            model,
            axles,
            pairs,
            state,
            pose,
            contacts: vec![WheelContact::default(); count],
            pressed_at,
            ways: vec![0.0; count],
            wheels: vec![WheelNow::default(); count],
            body_steps: Leapfrog::default(),
            spins_amid: vec![None; count],
            inputs: vec![WheelInput::default(); count],
            meetings: Vec::with_capacity(count),
            specific_force: Vector::AXES[2] * gravity,
            ledger: Ledger::default(),
            time: 0.0,
            step,
            steps: 0,
        })
    }

    /// Computes the wheels' forces with another accuracy than [`Accuracy::Simulation`], for comparisons.
    pub fn set_accuracy(&mut self, accuracy: Accuracy) {
        for pair in self.pairs.iter_mut().flatten() {
            *pair = pair.with_accuracy(accuracy);
        }
    }

    /// The robot.
    #[must_use]
    pub const fn model(&self) -> &RobotModel {
        &self.model
    }

    /// Where it is and how it moves.
    #[must_use]
    pub const fn state(&self) -> &BodyState {
        &self.state
    }

    /// Sets a wheel's spin, rad/s.
    pub fn set_spin(&mut self, wheel: usize, spin: f64) {
        self.wheels[wheel].spin = spin;
        self.spins_amid[wheel] = None;
    }

    /// Its wheels.
    #[must_use]
    pub fn wheels(&self) -> &[WheelNow] {
        &self.wheels
    }

    /// What an accelerometer at the origin would feel, m/s² in the robot's frame.
    #[must_use]
    pub const fn specific_force(&self) -> Vector {
        self.specific_force
    }

    /// Where the energy went.
    #[must_use]
    pub const fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// Seconds since the start.
    #[must_use]
    pub const fn time(&self) -> f64 {
        self.time
    }

    /// Kinetic energy of body and wheels, and potential energy, J.
    #[must_use]
    pub fn energy(&self) -> (f64, f64) {
        let (mut kinetic, potential) = self.model.linkage.energy(&self.state, &self.pose);
        for (mount, wheel) in self.model.wheels.iter().zip(&self.wheels) {
            kinetic += 0.5 * mount.spin_inertia * wheel.spin * wheel.spin;
        }
        (kinetic, potential)
    }

    /// The robot's heading, rad.
    #[must_use]
    pub fn heading(&self) -> f64 {
        self.state.attitude.angles().2
    }

    /// From now on a wheel's motor is to give `torque` (N m on the wheel), and its steering to turn it to `steering_angle`
    /// (rad beside the description's heading). A wheel that does not exist changes nothing.
    pub fn set_input(&mut self, wheel: usize, torque: f64, steering_angle: f64) {
        if let Some(input) = self.inputs.get_mut(wheel) {
            *input = WheelInput {
                torque,
                steering_angle,
            };
        }
    }

    /// From now on an actuator of the chassis is to move to `setpoint`, within its range. One that does not exist, or a setpoint
    /// that is NaN, changes nothing.
    pub fn set_actuator(&mut self, actuator: usize, setpoint: f64) {
        let mut slots = self.setpoints.iter_mut().zip(&self.model.actuators);
        if let Some((slot, own)) = slots.nth(actuator).filter(|_| !setpoint.is_nan()) {
            *slot = setpoint.clamp(own.range.0, own.range.1);
        }
    }

    /// Moves the actuators of the chassis towards their setpoints, as fast as speed and power allow. Their gears lock: without
    /// power they hold, and the work of a part that sinks becomes heat.
    fn move_actuators(&mut self) {
        for index in 0..self.setpoints.len() {
            let own = &self.model.actuators[index];
            let left = self.setpoints[index] - own.position;
            if left == 0.0 {
                continue;
            }
            // against the movement: the bent spring of a link, the weight of a mass
            let load = left.signum()
                * match own.moves {
                    Actuated::Link { freedom, sign } => {
                        let hold = &self.model.linkage.holds()[freedom];
                        -sign * hold.stiffness * hold.bent(self.state.joints[freedom])
                    }
                    Actuated::Mass { along, mass } => mass * along.dot(self.specific_force),
                };
            let by_power = own.power * own.efficiency / load.max(f64::MIN_POSITIVE);
            let moved = left.abs().min(own.speed.min(by_power) * self.step);
            let electric = load.max(0.0) * moved / own.efficiency;
            self.ledger.electric += electric;
            self.ledger.actuators += electric;
            self.ledger.motor_heat += electric - load * moved;
            let position = if moved < left.abs() {
                own.position + moved * left.signum()
            } else {
                self.setpoints[index]
            };
            self.model.place_actuator(index, position);
        }
    }

    /// The margin against tipping over in the present posture, rad ([`tip_over_margin`]).
    #[must_use]
    pub fn tip_over_margin(&self) -> f64 {
        let down = self.state.attitude.to_robot(-Vector::AXES[2]);
        tip_over_margin(&self.model, &self.state.joints, down)
    }

    /// Moves on by one step.
    pub fn advance(&mut self, ground: &mut Ground) {
        self.move_actuators();
        let mut forces = [0.0; MAX_SPEEDS];
        let axes = self.state.attitude.axes();
        // wheel by wheel in three loops, since the contacts of several wheels are computed side by side where nothing of the
        // rest lies between them
        self.meetings.clear();
        for index in 0..self.wheels.len() {
            self.steer(index);
            let meeting = self.meet(index, ground, axes);
            self.meetings.push(meeting);
        }
        let contacts = self
            .contacts
            .iter_mut()
            .zip(&self.pairs)
            .zip(&mut self.wheels);
        for (meeting, ((contact, pairs), wheel)) in self.meetings.iter().zip(contacts) {
            let pair = &pairs[meeting.soil.min(pairs.len() - 1)];
            wheel.load = contact.step(pair, &meeting.under, &meeting.motion, self.step);
        }
        for index in 0..self.wheels.len() {
            self.push(index, ground, &mut forces);
        }
        for (hold, rate) in self
            .model
            .linkage
            .holds()
            .iter()
            .zip(&self.state.speeds[6..])
        {
            self.ledger.dampers += hold.damping * rate * rate * self.step;
        }
        let (turning, velocity) = (self.state.turning(), self.state.velocity());
        let rates = self.body_steps.step(
            &self.model.linkage,
            &mut self.state,
            &mut self.pose,
            forces,
            self.step,
        );
        let gravity = axes.to_robot(Vector::AXES[2] * self.model.linkage.gravity());
        self.specific_force =
            Vector::new(rates[3], rates[4], rates[5]) + turning.cross(velocity) + gravity;
        self.steps += 1;
        self.time = self.steps as f64 * self.step;
    }

    /// Turns a wheel's steering towards its setpoint.
    fn steer(&mut self, index: usize) {
        let (mount, wheel) = (&self.model.wheels[index], &mut self.wheels[index]);
        let most = mount.steer_rate * self.step;
        let turn = (self.inputs[index].steering_angle - wheel.steer).clamp(-most, most);
        let steer = (wheel.steer + turn).clamp(-mount.steer_range, mount.steer_range);
        if steer != wheel.steer {
            wheel.steer = steer;
            self.axles[index] = mount.axle(steer);
        }
    }

    /// Where and how a wheel meets the ground.
    fn meet(&self, index: usize, ground: &Ground, axes: Axes) -> Meeting {
        let mount = &self.model.wheels[index];
        let linkage = &self.model.linkage;
        // the contact plane
        let at = linkage.point(&self.pose, mount.link, mount.centre);
        let place = self.state.position + axes.to_world(at);
        let axle = linkage.direction(&self.pose, mount.link, self.axles[index]);
        let across = axes.to_world(axle);
        let per_level = 1.0 / Real::hypot(across.x, across.y).max(1e-9);
        let radius = mount.wheel.radius();
        let spot = ground.under(
            (place.x, place.y),
            (across.y * per_level, -across.x * per_level),
            CONTACT_REACH_SHARE * radius,
            mount.wheel.width(),
        );
        let [slope_x, slope_y] = spot.slope;
        let steepness = 1.0 / (1.0 + slope_x * slope_x + slope_y * slope_y).sqrt();
        let up = axes.to_robot(Vector::new(-slope_x, -slope_y, 1.0) * steepness);
        let frame = ContactFrame::new(axle, up);
        // height of the centre in the wheel's own plane
        let height = (place.z - spot.height) * steepness * frame.per_lean;
        let velocity = linkage.velocity(&self.state.speeds, &self.pose, mount.link, at);
        let motion = WheelMotionNow {
            sinkage: radius - height,
            sinking: -velocity.dot(up) * frame.per_lean,
            velocity: [velocity.dot(frame.forward), velocity.dot(frame.left)],
            rim: radius * self.wheels[index].spin,
        };
        Meeting {
            at,
            place,
            frame,
            height,
            velocity,
            motion,
            soil: spot.soil,
            under: SoilUnder {
                strength: spot.strength,
                k_shear: spot.k_shear,
                settling_way: ground.settling_way(),
            },
            rut: spot.rut,
        }
    }

    /// One wheel under its load: motor and spin; adds what it does to the body.
    fn push(&mut self, index: usize, ground: &mut Ground, forces: &mut [f64; MAX_SPEEDS]) {
        let step = self.step;
        let input = self.inputs[index];
        let mount = &self.model.wheels[index];
        let linkage = &self.model.linkage;
        let radius = mount.wheel.radius();
        let wheel = &mut self.wheels[index];
        let load = wheel.load;
        let Meeting {
            at,
            place,
            frame,
            height,
            velocity,
            motion,
            ..
        } = self.meetings[index];
        let axle = frame.axle;
        // the motor and the bearing work between wheel and link, the soil on the wheel
        let carrier = Vector::AXES[1] * linkage.rate(&self.pose, mount.link);
        let link_rate = (self.state.turning() + carrier).dot(axle);
        let rate = wheel.spin - link_rate;
        let motor = mount
            .motor
            .map_or_else(MotorNow::default, |motor| motor.drive(input.torque, rate));
        let bearing = mount.bearing * (rate / BEARING_RATE_RAD_PER_S).clamp(-1.0, 1.0);
        let onto_wheel = motor.torque - bearing;
        let spin_now = wheel.spin;
        let gain = step * (onto_wheel - load.torque) / mount.spin_inertia;
        let before = self.spins_amid[index].unwrap_or(spin_now - 0.5 * gain);
        let spin_amid = before + gain;
        self.spins_amid[index] = Some(spin_amid);
        wheel.spin = spin_amid + 0.5 * gain;
        // moments about the axle are handled by the wheel's spin equation
        let (force, moment) = frame.force_and_moment(&load, height, radius);
        let at_link = (mount.link, at);
        linkage.push(
            &self.pose,
            forces,
            at_link,
            force,
            moment - axle * onto_wheel,
        );

        wheel.angle += step * spin_amid;
        wheel.encoder_rate = wheel.spin - link_rate;
        wheel.encoder_angle += step * (spin_amid - link_rate);
        wheel.velocity = motion.velocity;
        wheel.rim = radius * wheel.spin;
        wheel.place = place;
        wheel.motor = motor;
        wheel.soil = self.meetings[index].soil;
        let lost = load.torque * spin_now - force.dot(velocity) - moment.dot(self.state.turning());
        self.ledger.soil += step * lost;
        self.ledger.electric += step * motor.power;
        self.ledger.motor_heat += step * (motor.power - motor.torque * rate);
        self.ledger.bearings += step * bearing * rate;

        // the rut, so far behind that the wheel does not stand in it
        let (x, y) = self.pressed_at[index];
        let moved = Real::hypot(place.x - x, place.y - y);
        let behind = RUT_DISTANCE_CELLS * ground.map().cell();
        if moved > behind + 0.5 * ground.map().cell() {
            let share = 1.0 - behind / moved;
            let to = (x + share * (place.x - x), y + share * (place.y - y));
            if load.normal > 0.0 {
                let depth = load.pressed + self.meetings[index].rut;
                let greater = motion.rim.abs().max(motion.velocity[0].abs());
                let track = Track::new(
                    u8::try_from(index).unwrap_or(u8::MAX),
                    self.ways[index],
                    (motion.rim - motion.velocity[0]) / greater.max(f64::MIN_POSITIVE),
                );
                ground.pass((x, y), to, (mount.wheel.width(), depth), &track);
            }
            self.ways[index] += share * moved;
            self.pressed_at[index] = to;
        }
    }
}
