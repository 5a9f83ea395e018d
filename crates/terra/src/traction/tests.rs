use super::*;
use crate::{RigidWheel, Settings, catalogue};

/// Skids that the rising torque of ordinary soils decides, and those that it leaves to the samples: a snapshot.
#[test]
fn where_the_torque_rises_with_slip() {
    /// Decided, and left.
    const COUNTS: [u32; 2] = [47, 33];
    let mut counts = [0; 2];
    for key in ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"] {
        let soil = catalogue::find(key).unwrap().soil().unwrap();
        let wheel = RigidWheel::new(0.1, 0.06).unwrap();
        let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        for load in [3.0, 20.0, 100.0, 1e7] {
            for share in [0.0, 0.02, 0.1, 0.4] {
                let bearing_torque = share * load * 0.1;
                let found = on_soil
                    .free_slip_where_torque_rises(load, bearing_torque)
                    .unwrap();
                counts[usize::from(found.is_none())] += 1;
                let Some(slip) = found else { continue };
                let torque = on_soil.forces_under(load, slip, |forces| forces.torque);
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

/// The slopes at which a surplus is looked at from 0.1 rad on, by hand: its share of the weight further, then twice as far.
#[test]
fn how_a_slope_is_sought() {
    let seen = core::cell::RefCell::new(std::vec::Vec::new());
    let held = |left: f64, precision: f64, surplus: &dyn Fn(f64) -> Option<f64>| {
        seen.take();
        WheelOnSoil::slope_held(0.3, (0.1, left), (10.0, precision), |alpha, slip| {
            assert_eq!(slip, 0.3);
            seen.borrow_mut().push(alpha);
            Ok(surplus(alpha))
        })
        .unwrap()
    };
    let starts = |expected: &[f64]| {
        let seen = seen.borrow();
        assert!(seen.len() >= expected.len(), "{seen:?}");
        for (found, expected) in seen.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{seen:?}");
        }
        seen.len()
    };
    // straight: one step of the secant, and one that sees that it is there
    let slope = held(2.0, 1e-6, &|alpha| Some(4.0 * (0.6 - alpha)));
    assert!((slope - 0.6).abs() < 1e-6);
    assert!(starts(&[0.3, 0.7]) <= 5);
    // what lacks nothing is held
    for left in [0.0, 1.0] {
        assert_eq!(held(2.0, 1e-6, &|_| Some(left)), MAX_GRADE_RAD);
        assert_eq!(starts(&[0.3, 0.7, MAX_GRADE_RAD]), 3);
    }
    // not carried any more
    assert_eq!(
        held(2.0, 1e-6, &|alpha| (alpha < 0.5).then_some(1.0)),
        0.1 + 0.2
    );
    assert_eq!(starts(&[0.3, 0.7]), 2);
    // the least steps
    held(0.0, 1e-3, &|alpha| Some(0.1005 - alpha));
    starts(&[0.101]);
    held(0.0, 0.0, &|alpha| (alpha < 0.11).then_some(1.0));
    starts(&[0.1 + 1e-9, 0.1 + 3e-9]);
}

#[test]
fn of_equal_samples_the_first_is_the_best() {
    let best =
        |of: &dyn Fn(f64) -> Option<f64>| WheelOnSoil::best_of_scan(|slip| Ok(of(slip))).unwrap();
    assert_eq!(best(&|_| Some(2.0)), Some((0.0, 2.0)));
    assert_eq!(best(&|_| None), None);
    assert_eq!(best(&|slip| (slip > 0.3).then_some(slip.min(0.6))), {
        let step = (0.6 / SCAN_STEP).ceil() * SCAN_STEP;
        Some((step, 0.6))
    });
}
