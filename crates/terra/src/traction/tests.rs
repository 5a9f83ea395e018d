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
        slope_held(0.3, (0.1, left), (10.0, precision), |alpha, slip| {
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
    let best = |of: &dyn Fn(f64) -> Option<f64>| best_of_scan(|slip| Ok(of(slip))).unwrap();
    assert_eq!(best(&|_| Some(2.0)), Some((0.0, 2.0)));
    assert_eq!(best(&|_| None), None);
    assert_eq!(best(&|slip| (slip > 0.3).then_some(slip.min(0.6))), {
        let step = (0.6 / SCAN_STEP).ceil() * SCAN_STEP;
        Some((step, 0.6))
    });
}

/// What a search finds of a function, and how often it looked.
fn counted<T>(
    of: &dyn Fn(f64) -> Option<f64>,
    search: impl Fn(&dyn Fn(f64) -> Result<Option<f64>>) -> Result<T>,
) -> (T, u32) {
    let looks = core::cell::Cell::new(0);
    let found = search(&|slip| {
        looks.set(looks.get() + 1);
        Ok(of(slip))
    });
    (found.unwrap(), looks.get())
}

/// The least slip of pulls whose roots are known, and how often each was looked at.
#[test]
fn the_least_slip_by_hand() {
    // Between two samples of 1/33.
    const PEAK_SLIP: f64 = 0.53;
    const PEAK_N: f64 = 10.0;
    let holds = |required: f64, pull: &dyn Fn(f64) -> Option<f64>| {
        let (found, looks) = counted(pull, |pull| least_slip(required, pull));
        let SlopeOutcome::Holds { slip } = found else {
            panic!("{found:?}");
        };
        (slip.value(), looks)
    };
    let immobilised = |required: f64, pull: &dyn Fn(f64) -> Option<f64>| {
        let (found, _) = counted(pull, |pull| least_slip(required, pull));
        let SlopeOutcome::Immobilised {
            max_pull,
            required_pull,
        } = found
        else {
            panic!("{found:?}");
        };
        assert_eq!(required_pull, required);
        max_pull
    };
    let near = |slip: f64, expected: f64| {
        assert!((slip - expected).abs() < 1e-12, "{slip} {expected}");
    };
    // a straight line: the samples up to the root, one secant and one look that ends the search
    for required in [-3.05, 0.4, 3.05, 9.99] {
        let (slip, looks) = holds(required, &|slip| Some(10.0 * slip));
        near(slip, 0.1 * required);
        let samples = 1.0 + ((1.0 + slip) * f64::from(SAMPLES)).ceil();
        assert!(f64::from(looks) <= samples + 3.0, "{looks} of {samples}");
    }
    // where the first that carries the wheel suffices
    let first = (1.2 * f64::from(SAMPLES)).ceil() / f64::from(SAMPLES) - 1.0;
    assert_eq!(holds(3.0, &|slip| (slip >= 0.2).then_some(5.0)).0, first);
    let gap = |slip: f64| (!(0.1..0.3).contains(&slip)).then_some(10.0 * slip);
    near(holds(4.0, &gap).0, 0.4);
    // a peak between two samples
    let peak = |slip: f64| PEAK_N - 4000.0 * (slip - PEAK_SLIP) * (slip - PEAK_SLIP);
    let required = PEAK_N - 0.01;
    let expected = PEAK_SLIP - f64::sqrt(0.01 / 4000.0);
    let (slip, looks) = holds(required, &|slip| Some(peak(slip)));
    near(slip, expected);
    assert!(looks <= 123, "{looks}");
    let carried = |slip: f64| (slip >= PEAK_SLIP - 0.02).then(|| peak(slip));
    near(holds(required, &carried).0, expected);
    // too little anywhere
    for most in [
        immobilised(PEAK_N + 1e-3, &|slip| Some(peak(slip))),
        immobilised(PEAK_N + 5.0, &carried),
        immobilised(PEAK_N + 5.0, &|slip| Some(-PEAK_N * slip)),
    ] {
        assert!((most.unwrap() - PEAK_N).abs() < 1e-6, "{most:?}");
    }
    assert_eq!(immobilised(1.0, &|_| None), None);
}

/// The steepest slope of a friction μ(s), tan α = max μ, beside a rough friction; and how often each is looked at, at most: a
/// snapshot.
#[test]
fn the_steepest_slope_by_hand() {
    const WEIGHT_N: f64 = 30.0;
    let found = |friction: &dyn Fn(f64) -> f64, off: f64| {
        let (rough, exact) = (core::cell::Cell::new(0), core::cell::Cell::new(0));
        let surplus = |alpha: f64, slip: f64, count: &core::cell::Cell<u32>, off: f64| {
            count.set(count.get() + 1);
            let pull = friction(slip) * alpha.cos() - alpha.sin() + off;
            Ok(Some(WEIGHT_N * pull))
        };
        let found = steepest(
            WEIGHT_N,
            |alpha, slip| surplus(alpha, slip, &rough, off),
            |alpha, slip| surplus(alpha, slip, &exact, 0.0),
        );
        (found.unwrap(), [rough.get(), exact.get()])
    };
    let bend = |most: f64, at: f64| move |slip: f64| most - (slip - at) * (slip - at);
    // most, where, how far the rough one is off, looks at the rough and at the exact one
    for (most, at, off, looks) in [
        (0.5, 0.6, -1e-6, [22, 8]),
        (0.5, 0.6, 0.0, [27, 8]),
        (0.5, 0.0, -1e-6, [21, 11]),
        (0.5, 0.0, 0.0, [19, 10]),
        (0.2, 1.0, 1e-6, [19, 8]),
        (3.0, 0.33, 0.0, [30, 23]),
        (3.0, 0.33, 1e-6, [23, 8]),
        (0.001, 0.06, 0.0, [24, 46]),
        (0.001, 0.06, -1e-6, [22, 46]),
        (1e-5, 0.0, -1e-6, [18, 16]),
        (1e-5, 0.0, 0.0, [18, 9]),
        (1e-5, 0.06, 1e-6, [21, 13]),
        (1e-5, 0.5, 0.0, [16, 7]),
        (1e-5, 1.0, -1e-6, [18, 26]),
        (1e-5, 1.0, 1e-6, [18, 13]),
    ] {
        let (slope, looked) = found(&bend(most, at), off);
        let (slope, slip) = slope.unwrap();
        let case = format!("{most} {at} {off}: {looked:?}");
        assert!((slope - f64::atan(most)).abs() < 1e-12, "{case}");
        assert!((slip - at).abs() < 1e-6, "{case}");
        assert!(looked[0] <= looks[0] && looked[1] <= looks[1], "{case}");
    }
    for (most, at, looks) in [
        (-1e-7, 0.0, 7),
        (-1e-7, 0.06, 6),
        (-1e-7, 0.5, 24),
        (-1e-7, 1.0, 13),
        (-1e-3, 0.06, 6),
        (-1e-3, 0.5, 5),
        (-1e-3, 1.0, 11),
    ] {
        let (slope, looked) = found(&bend(most, at), 0.0);
        assert!(slope.is_none(), "{most} {at}");
        assert!(looked[1] <= looks, "{most} {at}: {looked:?}");
    }
    // what the rough one alone holds
    assert!(found(&bend(-1e-6, 0.5), 2e-6).0.is_none());
}
