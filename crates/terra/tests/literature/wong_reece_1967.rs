//! Bekker's compaction resistance as the limit of Wong and Reece's: b k z^(n+1)/(n+1) exactly when
//! θ_m = θ_2 = 0, and less otherwise.

use grouser_terra::{Angle, Kinematics, RigidWheel, Settings, Slip, Soil, SoilParams, WheelOnSoil};

fn resistance(c_1: f64, n: f64, sinkage: f64) -> f64 {
    let soil = Soil::bekker(900.0, 1_528_400.0, n)
        .cohesion(1000.0)
        .phi(Angle::from_deg(30.0))
        .k_shear(0.025)
        .stress_position(c_1, 0.0)
        .soil()
        .unwrap();
    let wheel = RigidWheel::new(0.2, 0.1).unwrap();
    let motion = Kinematics::straight(Slip::new(0.2).unwrap());
    let contact = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
    contact
        .forces_at(sinkage, &motion)
        .unwrap()
        .compaction_resistance
}

#[test]
fn bekkers_compaction_resistance_is_the_limit() {
    for n in [0.5_f64, 1.0, 1.1, 1.6] {
        for z in [0.001_f64, 0.01, 0.05, 0.09] {
            let bekker = 0.1 * (9000.0 + 1_528_400.0) * z.powf(n + 1.0) / (n + 1.0);
            assert!(
                (resistance(0.0, n, z) / bekker - 1.0).abs() < 1e-9,
                "n {n} z {z}"
            );
            assert!(resistance(0.3, n, z) < bekker);
        }
    }
}

#[test]
fn a_braked_wheel_on_springy_soil_may_gain_work_and_says_so() {
    // The sign(j) law below zero slip with λ = 0.93: found by search. The soil behind the wheel pushes
    // forwards with nearly all that the soil in front took, and shear gives work back besides.
    let soil = Soil::new(SoilParams {
        rebound: 0.930_564,
        ..Soil::bekker(0.0, 50_000.0, 1.617_213)
            .cohesion(0.0)
            .phi(Angle::from_rad(0.754_662))
            .k_shear(0.1)
            .stress_position(0.0, 0.0)
            .params()
            .unwrap()
    })
    .unwrap();
    let wheel = RigidWheel::new(0.281_316, 0.02).unwrap();
    let contact = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
    let motion = Kinematics::straight(Slip::new(-0.233_552).unwrap());
    let point = contact.at_sinkage(0.891_25 * 0.281_316, &motion).unwrap();
    assert!(point.forces.lost_work < 0.0);
    assert!(point.cautions.contains(grouser_terra::Caution::WorkGained));
}
