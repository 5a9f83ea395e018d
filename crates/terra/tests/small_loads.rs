//! Loads far below any wheel's, where stresses that nearly cancel leave few digits.

use grouser_terra::{Caution, Kinematics, RigidWheel, Settings, Slip, WheelOnSoil, catalogue};

#[test]
fn a_solved_load_is_carried_or_carries_a_caution() {
    let (mut solved, mut coarse, mut greatest) = (0, 0, 0.0_f64);
    for entry in catalogue::entries() {
        let Ok(soil) = entry.soil() else { continue };
        for radius in [0.02, 0.11, 0.5] {
            for slip in [-0.76, -0.3, 0.0, 0.17, 0.53, 1.0] {
                for exponent in -13..3 {
                    let load = 1.5 * 10_f64.powi(exponent);
                    let wheel = RigidWheel::new(radius, 0.1).unwrap();
                    let pair = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
                    let motion = Kinematics::straight(Slip::new(slip).unwrap());
                    let Some(point) = pair.under_load(load, &motion).unwrap().point() else {
                        continue;
                    };
                    let cautioned = point.cautions.contains(Caution::LoadBelowResolution);
                    let missed = (point.forces.vertical_force / load - 1.0).abs();
                    assert_eq!(
                        cautioned,
                        missed > 1e-6,
                        "{} {radius} m {slip} {load} N",
                        entry.key
                    );
                    solved += 1;
                    coarse += u32::from(cautioned);
                    if cautioned {
                        greatest = greatest.max(load);
                    }
                }
            }
        }
    }
    println!("{solved} solved, {coarse} with the caution, the greatest at {greatest} N");
    assert!(coarse > 0 && greatest < 1e-5, "{greatest} N");
}
