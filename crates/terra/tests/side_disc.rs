//! The soil beside a wheel that moves sideways: against differences and a finer rule, its energy and its limits.

use grouser_real::{Dual, Real};
use grouser_terra::{
    Accuracy, Angle, Bulldozing, Caution, DualInputs, Error, Kinematics, LawChoice, RigidWheel,
    Settings, ShearLaw, SlipNorm, SlipSinkage, Soil, SoilParams, StressPosition, WheelOnSoil,
};

use crate::loaded::{duals, numbers};

/// The sand of measured trials, with every law of drift.
fn sand(bulldozing: Bulldozing) -> SoilParams {
    SoilParams {
        n_1: 0.33,
        n_2: 0.41,
        rebound: 0.45,
        unit_weight: Some(13e3),
        rear_drift: 1.0,
        sideways_support: 0.2,
        laws: LawChoice {
            slip_norm: SlipNorm::Root,
            slip_sinkage: SlipSinkage::Saturating,
            stress_position: StressPosition::Sliding,
            shear: Some(ShearLaw::SlipVelocity),
            bulldozing: Some(bulldozing),
        },
        ..Soil::bekker(-161_551.2, 9_318_329.0, 1.3217)
            .cohesion(260.0)
            .phi(Angle::from_deg(29.0))
            .k_shear(0.018)
            .stress_position(0.44, 0.28)
            .params()
            .unwrap()
    }
}

fn on(params: SoilParams, (radius, width): (f64, f64)) -> WheelOnSoil {
    let wheel = RigidWheel::new(radius, width).unwrap();
    WheelOnSoil::new(wheel, Soil::new(params).unwrap(), Settings::default()).unwrap()
}

const WHEEL: (f64, f64) = (0.058, 0.05);

fn drifting(degrees: f64, rim: f64) -> Kinematics {
    let beta = Angle::from_deg(degrees);
    let forward = if degrees == 90.0 { 0.0 } else { beta.cos() };
    Kinematics::from_speeds(forward, beta.sin(), rim).unwrap()
}

/// Forces and sinkage with exact derivatives against differences: in the soil's numbers that the law uses and in the slip
/// angle, above and below the hub.
#[test]
fn derivatives_agree_with_differences() {
    type Set = (f64, f64, fn(&mut SoilParams, f64));
    let changes: [Set; 4] = [
        (260.0, 1e-3, |soil, x| soil.cohesion = x),
        (29_f64.to_radians(), 1e-6, |soil, x| {
            soil.phi = Angle::from_rad(x);
        }),
        (13e3, 1e-2, |soil, x| soil.unit_weight = Some(x)),
        (0.2, 1e-6, |soil, x| soil.sideways_support = x),
    ];
    for (degrees, rim, load) in [
        (60.0, 0.6, 20.0),
        (75.0, 1.4, 18.0),
        (89.0, 2.0, 17.0),
        (80.0, 0.0, 19.0),
    ] {
        let beta = f64::to_radians(degrees);
        let at = |params: SoilParams, beta: f64| {
            let motion = Kinematics::from_speeds(beta.cos(), beta.sin(), rim).unwrap();
            numbers(&on(params, WHEEL), load, &motion)
        };
        let base = on(sand(Bulldozing::Disc), WHEEL);
        let motion = Kinematics::from_speeds(beta.cos(), beta.sin(), rim).unwrap();
        let mut inputs = DualInputs::<5>::new(&base, &motion);
        inputs.soil.strength.cohesion = Dual::variable(260.0, 0);
        inputs.soil.strength.phi = Dual::variable(29_f64.to_radians(), 1);
        inputs.soil.unit_weight = Dual::variable(13e3, 2);
        inputs.soil.sideways_support = Dual::variable(0.2, 3);
        let turned = Dual::variable(beta, 4);
        let (forward, sideways) = (turned.cos(), turned.sin());
        inputs.motion.slip_angle = turned;
        if rim == 0.0 {
            inputs.motion.q_y = sideways / forward;
        } else {
            let rim = Dual::constant(rim);
            inputs.motion.q_y = sideways / rim;
            inputs.motion.slip = if forward.value < rim.value {
                Dual::constant(1.0) - forward / rim
            } else {
                rim / forward - Dual::constant(1.0)
            };
        }
        let exact = duals(&inputs, (&base, &motion), Dual::constant(load));
        let exact = exact.map(|number| number.gradient);
        let difference = |k: usize| {
            let apart = |step: f64| {
                let side = |sign: f64| match changes.get(k) {
                    Some((value, unit, set)) => {
                        let mut params = sand(Bulldozing::Disc);
                        set(&mut params, value + sign * step * unit);
                        at(params, beta)
                    }
                    None => at(sand(Bulldozing::Disc), beta + sign * step * 1e-6),
                };
                let (up, down) = (side(1.0), side(-1.0));
                let unit = changes.get(k).map_or(1e-6, |change| change.1);
                [0, 1, 2, 3].map(|i| (up[i] - down[i]) / (2.0 * step * unit))
            };
            apart(1.0)
        };
        for k in 0..5 {
            let differences = difference(k);
            for (i, (exact, difference)) in exact.iter().zip(differences).enumerate() {
                let size = exact[k]
                    .abs()
                    .max(1e-3 * exact.iter().fold(0.0, |a: f64, b| a.max(b.abs())));
                assert!(
                    (exact[k] - difference).abs() < 1e-4 * size.max(1e-7),
                    "{degrees}°, rim {rim}: output {i} in {k}: {} {difference}",
                    exact[k]
                );
            }
        }
    }
}

/// The rim's integrals hold their accuracy where the hub is buried, the balance of energy closes, and nothing is gained.
#[test]
fn a_buried_wheel_is_as_exact_as_any() {
    for degrees in [60.0, 75.0, 90.0] {
        for rim in [0.0, 0.3, 1.0, 2.0, 10.0] {
            if degrees == 90.0 && rim == 0.0 {
                continue; // no slip is defined
            }
            for z in [0.03, 0.055, 0.06, 0.075, 0.086] {
                let motion = drifting(degrees, rim);
                let law = on(sand(Bulldozing::Disc), WHEEL);
                let point = law.at_sinkage(z, &motion).unwrap();
                let exact = law
                    .with_accuracy(Accuracy::Reference)
                    .at_sinkage(z, &motion)
                    .unwrap();
                let scale = exact
                    .forces
                    .vertical_force
                    .abs()
                    .max(exact.forces.drawbar_pull.abs());
                for (a, b) in [
                    (point.forces.vertical_force, exact.forces.vertical_force),
                    (point.forces.drawbar_pull, exact.forces.drawbar_pull),
                    (point.forces.torque / WHEEL.0, exact.forces.torque / WHEEL.0),
                    (point.side_force, exact.side_force),
                ] {
                    assert!((a - b).abs() < 2e-8 * scale, "{degrees} {rim} {z}: {a} {b}");
                }
                assert!(exact.forces.energy_residual.abs() < 1e-11 * scale * WHEEL.0);
                assert!(exact.forces.lost_work > 0.0);
                assert_eq!(point.cautions.contains(Caution::HubInSoil), z > WHEEL.0);
                assert!(!point.cautions.contains(Caution::WorkGained));
            }
        }
    }
}

/// A rim that turns beneath a wheel that moves sideways drags it forwards, is lifted less and meets less side force at
/// the same depth, as measured wheels do; and it is carried deeper than its hub.
#[test]
fn a_turning_rim_pulls_sinks_and_meets_less_soil() {
    let law = on(sand(Bulldozing::Disc), WHEEL);
    let at = |rim| {
        law.under_load(17.0, &drifting(90.0, rim))
            .unwrap()
            .point()
            .unwrap()
    };
    let (locked, turning) = (at(0.1), at(4.0));
    assert!(turning.forces.drawbar_pull > locked.forces.drawbar_pull + 5.0);
    assert!(turning.side_force.abs() < locked.side_force.abs());
    assert!(locked.sinkage > WHEEL.0 && turning.sinkage > WHEEL.0);
    // one law deeper, another refuses
    let chord = on(sand(Bulldozing::Chord), WHEEL);
    assert!(chord.at_sinkage(0.07, &drifting(90.0, 1.0)).is_err());
    // up to 59° no law carries a wheel below its hub, and nowhere below 1.5 r
    assert!(law.at_sinkage(0.07, &drifting(59.0, 1.0)).is_err());
    assert!(law.at_sinkage(0.0871, &drifting(90.0, 1.0)).is_err());
}

/// Straight ahead nothing changes, to the bit; at small slip angles nothing that counts does.
#[test]
fn up_to_thirty_degrees_it_is_the_chord() {
    let (disc, chord) = (
        on(sand(Bulldozing::Disc), WHEEL),
        on(
            SoilParams {
                sideways_support: 1.0,
                ..sand(Bulldozing::Chord)
            },
            WHEEL,
        ),
    );
    for (degrees, tolerance) in [(0.0, 0.0), (15.0, 1e-9), (30.0, 1e-4)] {
        for rim in [0.3, 1.0, 2.0] {
            let motion = drifting(degrees, rim);
            let of = |law: &WheelOnSoil| numbers(law, 22.0, &motion);
            for (a, b) in of(&disc).into_iter().zip(of(&chord)) {
                assert!(
                    (a - b).abs() <= tolerance * b.abs().max(0.1),
                    "{degrees} {rim}: {a} {b}"
                );
            }
        }
    }
}

#[test]
fn what_it_needs_is_required() {
    let without = SoilParams {
        unit_weight: None,
        ..sand(Bulldozing::Disc)
    };
    assert!(matches!(
        Soil::new(without),
        Err(Error::Missing {
            field: "unit_weight",
            ..
        })
    ));
    let steep = SoilParams {
        phi: Angle::from_deg(46.0),
        ..sand(Bulldozing::Disc)
    };
    assert_eq!(Soil::new(steep).unwrap_err().field(), Some("phi"));
    let more = SoilParams {
        sideways_support: 1.1,
        ..sand(Bulldozing::Disc)
    };
    assert_eq!(
        Soil::new(more).unwrap_err().field(),
        Some("sideways_support")
    );
    // by the settings too
    let mut open = sand(Bulldozing::Disc);
    open.laws.bulldozing = None;
    open.unit_weight = None;
    let settings = Settings {
        bulldozing: Bulldozing::Disc,
        ..Settings::default()
    };
    let wheel = RigidWheel::new(0.058, 0.05).unwrap();
    assert!(WheelOnSoil::new(wheel, Soil::new(open).unwrap(), settings).is_err());
}
