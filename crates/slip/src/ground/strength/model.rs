//! The torque of a wheel whose load and sinkage are measured, whatever the pressure-sinkage modulus is.

use grouser_real::{Dual, Real};
use grouser_terra::{
    Bekker, Contact, MohrCoulomb, Motion, Pressure, ShearLaw, Soil, SoilLaws, WheelSize,
    entry_angle,
};

use super::super::reading::WheelReading;

/// Directions of the derivatives.
const COHESION: usize = 0;
const PHI: usize = 1;
const LN_K: usize = 2;
const LOAD: usize = 3;
const SINKAGE: usize = 4;
const SLIP: usize = 5;
type Number = Dual<6>;

/// The predicted torque with its derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prediction {
    /// N m.
    pub(super) torque: f64,
    /// By c (Pa), φ (rad) and ln K.
    pub(super) by_strength: [f64; 3],
    /// By load (N), sinkage (m) and slip.
    pub(super) by_reading: [f64; 3],
    /// The modulus that carries the load, Pa/mⁿ.
    pub(super) modulus: f64,
}

/// Vertical force and torque are linear in the modulus k at a given contact: from the forces at two moduli follows the
/// k that carries the load, and its torque.
///
/// `None` where no positive modulus does (cohesion alone would carry more).
pub(super) fn predict(
    size: &WheelSize<f64>,
    soil: &Soil,
    law: ShearLaw,
    reading: &WheelReading,
    mean: &[f64; 3],
) -> Option<Prediction> {
    let load = Number::variable(reading.load.value, LOAD);
    let radius = Number::constant(size.radius);
    let theta_1 = entry_angle(Number::variable(reading.sinkage.value, SINKAGE), radius);
    let motion = Motion {
        slip: Number::variable(reading.slip.value, SLIP),
        q_y: Number::ZERO,
        slip_angle: Number::ZERO,
    };
    let wheel = constant_size(size);
    let depth = Number::variable(reading.sinkage.value, SINKAGE);
    let given = soil.laws::<Number>();
    // A modulus of the right magnitude: the one whose pressure at this depth carries the load on the contact's
    // length. Any would do but for rounding.
    let area = size.width * size.radius * theta_1.value.max(1e-9);
    let near =
        (reading.load.value / area) / Real::powf(depth.value, given.exponent_at(&motion).value);
    if !(near > 0.0 && near.is_finite()) {
        return None;
    }
    let forces = |modulus: f64| {
        let k_shear = Number::variable(mean[LN_K], LN_K).exp();
        let laws = SoilLaws {
            pressure: Pressure::Bekker(Bekker {
                k_c: Number::ZERO,
                k_phi: Number::constant(modulus),
            }),
            strength: MohrCoulomb {
                cohesion: Number::variable(mean[COHESION], COHESION),
                phi: Number::variable(mean[PHI], PHI),
            },
            k_shear,
            k_shear_side: k_shear,
            ..given
        };
        Contact::new(&wheel, &laws, law, &motion, theta_1).forces()
    };
    let (low, high) = (forces(near), forces(2.0 * near));
    let rise = high.vertical_force - low.vertical_force;
    if !(rise.value > 0.0) {
        return None;
    }
    let steps = (load - low.vertical_force) / rise;
    let modulus = near * (1.0 + steps.value);
    let torque = low.torque + (high.torque - low.torque) * steps;
    let finite = torque.value.is_finite() && torque.gradient.iter().all(|g| g.is_finite());
    if !finite || !(modulus > 0.0) {
        return None;
    }
    let [c, phi, ln_k, load, sinkage, slip] = torque.gradient;
    Some(Prediction {
        torque: torque.value,
        by_strength: [c, phi, ln_k],
        by_reading: [load, sinkage, slip],
        modulus,
    })
}

fn constant_size(size: &WheelSize<f64>) -> WheelSize<Number> {
    let c = Number::constant;
    WheelSize {
        radius: c(size.radius),
        shear_radius: c(size.shear_radius),
        rim_radius: c(size.rim_radius),
        tip_share: c(size.tip_share),
        width: c(size.width),
        lug_layer: c(size.lug_layer),
        lug_gain: c(size.lug_gain),
    }
}
