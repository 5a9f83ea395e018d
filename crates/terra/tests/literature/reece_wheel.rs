//! A wheel on a soil of Reece's form, pinned by 30-digit quadrature: φ 34.74°, c 139.28 Pa, K 0.515 mm,
//! σ = 254 kPa (z/b)^1.387, θ_2 = 0, r .13, b .16, W 130 N, c_1 .43, c_2 .32.

use grouser_terra::{Angle, Kinematics, RigidWheel, Settings, Slip, Soil, WheelOnSoil};

#[test]
fn case_a() {
    let (gamma, width) = (15e3, 0.16);
    let soil = Soil::reece(0.0, 2.54e5 / (gamma * width), 1.387, gamma)
        .cohesion(139.28)
        .phi(Angle::from_deg(34.74))
        .k_shear(5.15e-4)
        .stress_position(0.43, 0.32)
        .soil()
        .unwrap();
    let wheel = RigidWheel::new(0.13, width).unwrap();
    let contact = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
    for (slip, pull, torque, sinkage_mm) in [
        (0.1, 38.605_268_06, 10.296_703_69, 28.639_194_17),
        (0.5, 30.018_906_23, 10.170_275_41, 33.472_124_82),
    ] {
        let motion = Kinematics::straight(Slip::new(slip).unwrap());
        let point = contact.under_load(130.0, &motion).unwrap().point().unwrap();
        let close = |got: f64, expected: f64| (got / expected - 1.0).abs() < 1e-8;
        assert!(
            close(point.forces.drawbar_pull, pull),
            "{}",
            point.forces.drawbar_pull
        );
        assert!(
            close(point.forces.torque, torque),
            "{}",
            point.forces.torque
        );
        assert!(close(1e3 * point.sinkage, sinkage_mm), "{}", point.sinkage);
    }
}
