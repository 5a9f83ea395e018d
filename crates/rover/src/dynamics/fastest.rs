//! How fast the fastest part of a robot on its ground settles: what bounds the step.

use grouser_terra::{Kinematics, Slip, Soil, entry_angle};

use super::vehicle::{BEARING_RATE_RAD_PER_S, for_steps};
use super::wheel_force::{
    MAX_SINKAGE_SHARE, SHEAR_LEAD_S, SINKAGE_LEAD_S, UNLOADING_SLOPE, contact_length,
};
use crate::body::{BodyState, MAX_FREEDOMS, MAX_SPEEDS, Speeds};
use crate::error::{Error, Result};
use crate::robot::{RobotModel, WheelMount};
use crate::statics::wheel_loads;
use crate::vector::{Attitude, Vector};

/// Slip over which the stiffness of the shear is taken, 1: about where it is greatest.
const SHEAR_SLIP: f64 = 0.02;
/// Rounds of the power method: its value is within a few per cent then, and grows with each.
const ROUNDS: usize = 40;

/// The greatest rate (1/s) at which soils and speed loops make a motion of the robot die away while it stands level on the
/// stiffest of `soils`, whose stresses are `strength` times their own; `loop_gain` (s/rad) is the speed loops' torque over
/// the motor's greatest one, per rad/s.
///
/// # Errors
/// [`Error::Law`] for a soil under which a wheel has no modulus.
pub fn fastest_rate(
    model: &RobotModel,
    soils: &[Soil],
    strength: f64,
    loop_gain: f64,
) -> Result<f64> {
    let loads = wheel_loads(model, 0.0, 0.0).loads;
    let mut fastest: f64 = 0.0;
    for soil in soils {
        let mut dampings = Vec::with_capacity(loads.len());
        for (mount, load) in model.wheels.iter().zip(&loads) {
            let contact = Contact::new(mount, (soil, strength), *load)?;
            dampings.push(contact.damping);
            let motor = mount
                .motor
                .map_or(0.0, |motor| loop_gain * motor.max_torque());
            let bearing = mount.bearing / BEARING_RATE_RAD_PER_S;
            let damping = motor + bearing + contact.turning_damping;
            fastest = fastest.max(damping / mount.spin_inertia);
        }
        fastest = fastest.max(fastest_of_body(model, &dampings));
    }
    Ok(fastest)
}

/// What a wheel that stands on a soil damps.
struct Contact {
    /// Its sinking, N s/m.
    damping: f64,
    /// Its spin, N m s/rad. Travel is damped by the same shear, and slower: no wheel's share of the robot has less inertia
    /// than its rim.
    turning_damping: f64,
}

impl Contact {
    fn new(mount: &WheelMount, (soil, strength): (&Soil, f64), load: f64) -> Result<Self> {
        let pair = for_steps(mount, soil)?;
        let law = |source| Error::Law {
            of: format!("wheel \"{}\"", mount.name),
            source,
        };
        let motion = |slip| Slip::new(slip).map(Kinematics::straight);
        let still = motion(0.0).map_err(law)?;
        let sunk = pair
            .sinkage_under(load / strength, &still)
            .map_err(law)?
            .sinkage();
        let Some(sinkage) = sunk.filter(|sinkage| *sinkage > 0.0) else {
            // a wheel that carries nothing, or that the soil does not carry
            return Ok(Self {
                damping: 0.0,
                turning_damping: 0.0,
            });
        };
        let torque = |slip| {
            let forces = pair.forces_at(sinkage, &motion(slip)?)?;
            Ok(strength * forces.torque)
        };
        let gain = (torque(SHEAR_SLIP).map_err(law)? - torque(0.0).map_err(law)?) / SHEAR_SLIP;
        let radius = mount.wheel.running_radius();
        let held = sinkage.min(MAX_SINKAGE_SHARE * radius);
        let length = contact_length(radius, entry_angle(held, radius));
        Ok(Self {
            damping: UNLOADING_SLOPE * load / sinkage * SINKAGE_LEAD_S,
            turning_damping: gain * radius / length * SHEAR_LEAD_S,
        })
    }
}

/// The greatest rate (1/s) at which the body settles while each wheel damps its sinking by `dampings` (N s/m), that of
/// M⁻¹ Jᵀ D J, by the power method. Dampers of freedoms do not count, for they are implicit.
fn fastest_of_body(model: &RobotModel, dampings: &[f64]) -> f64 {
    let linkage = &model.linkage;
    let rest = BodyState::at(Vector::ZERO, Attitude::LEVEL);
    let pose = linkage.pose(&rest);
    let accelerate =
        |forces: &Speeds| linkage.accelerate(&rest, &pose, forces, &[0.0; MAX_FREEDOMS]);
    let by_gravity = accelerate(&[0.0; MAX_SPEEDS]);
    // no motion that wheels damp is without a part of it
    let mut speeds: Speeds = std::array::from_fn(|index| 1.0 + 0.1 * index as f64);
    let mut rate = 0.0;
    for _ in 0..ROUNDS {
        let moving = &speeds[..6 + linkage.freedoms()];
        let size = moving.iter().map(|speed| speed * speed).sum::<f64>().sqrt();
        if !(size > 0.0) {
            break;
        }
        rate = size;
        let mut forces = [0.0; MAX_SPEEDS];
        for (mount, damping) in model.wheels.iter().zip(dampings) {
            let at = linkage.point(&pose, mount.link, mount.centre);
            let rising = linkage.velocity(&speeds, &pose, mount.link, at).z / size;
            let force = Vector::AXES[2] * (damping * rising);
            linkage.push(&pose, &mut forces, (mount.link, at), force, Vector::ZERO);
        }
        let rates = accelerate(&forces);
        speeds = std::array::from_fn(|index| rates[index] - by_gravity[index]);
    }
    rate
}
