use super::*;
use crate::{RigidWheel, Settings, catalogue};

/// Found, and locked.
#[test]
fn a_skid_is_where_the_soil_turns_the_wheel() {
    const COUNTS: [u32; 2] = [55, 25];
    let mut counts = [0; 2];
    for key in ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"] {
        let soil = catalogue::find(key).unwrap().soil().unwrap();
        let wheel = RigidWheel::new(0.1, 0.06).unwrap();
        let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        for load in [3.0, 20.0, 100.0, 1e7] {
            for share in [0.0, 0.02, 0.1, 0.4] {
                let bearing_torque = share * load * 0.1;
                let found = on_soil.free_slip(load, bearing_torque).unwrap();
                counts[usize::from(found.is_none())] += 1;
                let Some(slip) = found else { continue };
                let torque = on_soil.forces_under(load, slip.value(), |forces| forces.torque);
                let off = torque.unwrap().unwrap() + bearing_torque;
                assert!(
                    off.abs() < 1e-8 * load * 0.1,
                    "{key} {load} {share} {off:e}"
                );
            }
        }
    }
    assert_eq!(counts, COUNTS);
}

/// A pull that suffices only between two of the samples.
#[test]
fn a_slope_that_is_held_between_two_samples() {
    let mut count = 0;
    for key in ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"] {
        let soil = catalogue::find(key).unwrap().soil().unwrap();
        let wheel = RigidWheel::new(0.1, 0.06).unwrap();
        let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        for load in [5.0, 20.0, 50.0_f64] {
            let pull = |slip: f64| {
                on_soil
                    .forces_under(load, slip, |forces| forces.drawbar_pull)
                    .unwrap()
            };
            let Some(best) = on_soil.slip_of_maximum_pull(load).unwrap() else {
                continue;
            };
            let samples = (0..=SAMPLES).filter_map(|i| pull(f64::from(i) / f64::from(SAMPLES)));
            let sampled = samples.fold(f64::NEG_INFINITY, f64::max);
            if best.value - sampled < 1e-8 * load {
                continue;
            }
            count += 1;
            let required = 0.5 * (best.value + sampled);
            let slope = Angle::from_rad((required / load).atan());
            let SlopeOutcome::Holds { slip } =
                on_soil.slip_demand(load / slope.cos(), slope).unwrap()
            else {
                panic!("{key} {load} is held");
            };
            let off = pull(slip.value()).unwrap() - required;
            assert!(off.abs() < 1e-9 * load, "{key} {load}: {off:e}");
            assert!(slip.value() < best.slip.value());
        }
    }
    assert!(count > 0);
}
