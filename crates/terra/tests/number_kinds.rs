//! The same laws over f32 and dual numbers, so that the generic code stays honest.

use grouser_real::{Dual, Real, Scalar};
use grouser_terra::{
    Accuracy, Angle, Contact, DualInputs, Forces, Kinematics, Motion, Pressure, Settings, ShearLaw,
    Slip, Soil, SoilLaws, SoilParams, WheelSize, catalogue, entry_angle,
};

use crate::loaded::{duals, numbers};

/// r, b, z, s, c, φ, K, k_phi, n
const POINT: [f64; 9] = [0.125, 0.1, 0.02, 0.3, 1000.0, 0.52, 0.025, 1_528_400.0, 1.1];

fn forces<R: Scalar>(x: [R; 9]) -> Forces<R> {
    let mut soil: SoilLaws<R> = catalogue::find("dry-sand").unwrap().soil().unwrap().laws();
    soil.strength.cohesion = x[4];
    soil.strength.phi = x[5];
    soil.k_shear = x[6];
    if let Pressure::Bekker(law) = &mut soil.pressure {
        law.k_phi = x[7];
    }
    soil.exponent.n_0 = x[8];
    let motion = Motion {
        slip: x[3],
        q_y: R::ZERO,
        slip_angle: R::ZERO,
    };
    let size = WheelSize::smooth(x[0], x[1]);
    Contact::new(
        &size,
        &soil,
        ShearLaw::Coupled,
        &motion,
        entry_angle(x[2], x[0]),
    )
    .forces()
}

fn three<R: Scalar>(f: &Forces<R>) -> [R; 3] {
    [f.vertical_force, f.drawbar_pull, f.torque]
}

#[test]
fn single_precision_agrees_to_single_precision() {
    for slip in [-0.6, -0.2, 0.0, 0.3, 1.0] {
        let mut point = POINT;
        point[3] = slip;
        let double = three(&forces(point));
        let single = three(&forces(point.map(f32::from_f64)));
        for (s, d) in single.into_iter().zip(double) {
            // some hundred roundings of 6e-8
            assert!(
                (f64::from(s) - d).abs() < 2e-5 * double[0],
                "slip {slip}: {s} {d}"
            );
        }
    }
}

#[test]
fn exact_derivatives_agree_with_differences() {
    for slip in [-0.6, -0.15, 0.05, 0.3] {
        let mut point = POINT;
        point[3] = slip;
        let exact = three(&forces(core::array::from_fn(|i| {
            Dual::<9>::variable(point[i], i)
        })));
        for i in 0..9 {
            let h = 1e-5 * point[i].abs();
            let at = |x: f64| {
                let mut moved = point;
                moved[i] = x;
                three(&forces(moved))
            };
            // five points: error O(h⁴) and rounding 1e-16/1e-5
            let (a, b) = (at(point[i] + h), at(point[i] - h));
            let (aa, bb) = (at(point[i] + 2.0 * h), at(point[i] - 2.0 * h));
            for k in 0..3 {
                let difference = (8.0 * (a[k] - b[k]) - (aa[k] - bb[k])) / (12.0 * h);
                let scale = exact[0].value / point[i].abs();
                let off = (exact[k].gradient[i] - difference).abs();
                assert!(
                    off < 1e-8 * scale,
                    "slip {slip} force {k} input {i}: {off:e} {scale:e}"
                );
            }
        }
    }
}

#[test]
fn without_a_prepared_rule_the_forces_are_the_same() {
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let wheel = grouser_terra::RigidWheel::new(POINT[0], POINT[1]).unwrap();
    let wheel_on_soil = grouser_terra::WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
    let motion = Kinematics::straight(Slip::new(0.3).unwrap());
    let prepared = three(&wheel_on_soil.forces_at(0.02, &motion).unwrap());
    let contact: Contact = Contact::new(
        &wheel.size(),
        &soil.laws(),
        ShearLaw::Coupled,
        &motion.motion(),
        entry_angle(0.02, POINT[0]),
    );
    for (a, b) in three(&contact.forces()).into_iter().zip(prepared) {
        assert!((a - b).abs() < 2e-9 * prepared[0]);
    }
}

#[test]
fn a_solved_wheels_derivatives_agree_with_differences() {
    let wheel = grouser_terra::RigidWheel::new(0.125, 0.1).unwrap();
    for (key, slip) in [("dry-sand", 0.2), ("lunar", -0.15), ("snow", 0.6)] {
        let soil = catalogue::find(key).unwrap().soil().unwrap();
        let params = *soil.params();
        let motion = Kinematics::straight(Slip::new(slip).unwrap());
        let wheel_on_soil =
            grouser_terra::WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        let mut inputs = DualInputs::<4>::new(&wheel_on_soil, &motion);
        inputs.size = WheelSize::smooth(Dual::variable(0.125, 0), Dual::constant(0.1));
        inputs.soil.strength.phi = Dual::variable(params.phi.rad(), 1);
        inputs.soil.exponent.n_0 = Dual::variable(params.n, 2);
        let exact = duals(&inputs, (&wheel_on_soil, &motion), Dual::variable(20.0, 3));
        let at = |x: [f64; 4]| {
            let soil = Soil::new(SoilParams {
                phi: Angle::from_rad(x[1]),
                n: x[2],
                ..params
            })
            .unwrap();
            let exact = Settings {
                accuracy: Accuracy::Reference,
                ..Settings::default()
            };
            let wheel = grouser_terra::RigidWheel::new(x[0], 0.1).unwrap();
            let wheel_on_soil = grouser_terra::WheelOnSoil::new(wheel, soil, exact).unwrap();
            numbers(&wheel_on_soil, x[3], &motion)
        };
        let here = [0.125, params.phi.rad(), params.n, 20.0];
        for i in 0..4 {
            let h = 1e-4 * here[i];
            let moved = |by: f64| {
                let mut x = here;
                x[i] += by;
                at(x)
            };
            let (a, b, aa, bb) = (moved(h), moved(-h), moved(2.0 * h), moved(-2.0 * h));
            for k in 0..3 {
                // five points: error O(h⁴) relative
                let difference = (8.0 * (a[k] - b[k]) - (aa[k] - bb[k])) / (12.0 * h);
                let scale = at(here)[k].abs().max(1e-3) / here[i];
                let off = (exact[k].gradient[i] - difference).abs();
                assert!(
                    off < 1e-7 * scale,
                    "{key} output {k} input {i}: {off:e} of {scale:e}"
                );
            }
        }
    }
}
