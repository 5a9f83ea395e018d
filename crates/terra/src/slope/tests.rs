use core::cell::Cell;

use super::*;

const MAX_GRADE_RAD: f64 = 1.4;

fn search(weight: f64, near: Option<f64>) -> SlopeSearch {
    SlopeSearch {
        weight,
        slopes: (0.0, MAX_GRADE_RAD),
        max_slip: 1.0,
        near,
    }
}

/// The slips that hold a slope, of surpluses whose roots are known.
#[test]
fn the_held_slip_by_hand() {
    // between two samples of 0.05
    const PEAK_SLIP: f64 = 0.53;
    let held = |surplus: &dyn Fn(f64) -> Option<f64>| {
        let looks = Cell::new(0);
        let found = held_slip(0.6, |slip| {
            assert!(slip.abs() <= 0.6);
            looks.set(looks.get() + 1);
            Ok::<_, ()>(surplus(slip))
        });
        (found.unwrap(), looks.get())
    };
    let holds = |expected: f64, surplus: &dyn Fn(f64) -> Option<f64>| {
        let (found, looks) = held(surplus);
        let HeldSlip::Holds(slip) = found else {
            panic!("{found:?}");
        };
        assert!((slip - expected).abs() < 1e-12, "{slip} {expected}");
        looks
    };
    // a straight line: the samples up to the root, driving or braking, one secant and one look that ends the search
    for expected in [-0.6, -0.33, 0.0, 0.04, 0.305, 0.6] {
        let looks = holds(expected, &|slip| Some(10.0 * (slip - expected)));
        assert!(looks <= 16, "{expected}: {looks}");
    }
    // of several the one of smallest magnitude
    holds(0.2, &|slip| Some((slip - 0.2) * (0.45 - slip)));
    holds(-0.2, &|slip| Some((slip + 0.2) * (slip + 0.45)));
    // where the wheel begins to be carried
    holds(0.234, &|slip| (slip >= 0.234).then_some(5.0));
    // a peak between two samples
    let peak = |slip: f64| 0.01 - 4000.0 * (slip - PEAK_SLIP) * (slip - PEAK_SLIP);
    let expected = PEAK_SLIP - f64::sqrt(0.01 / 4000.0);
    assert!(holds(expected, &|slip| Some(peak(slip))) < 60);
    // too little anywhere, and too much
    for (top, at) in [(-1.0, PEAK_SLIP), (-1e-6, 0.6), (-2.0, 0.0)] {
        let (found, _) = held(&|slip| Some(top - 4.0 * (slip - at) * (slip - at)));
        let HeldSlip::Immobilised(Some(most)) = found else {
            panic!("{found:?}");
        };
        assert!((most - top).abs() < 1e-9, "{most} {top}");
    }
    assert_eq!(held(&|slip| Some(0.7 + slip)).0, HeldSlip::Slides);
    assert_eq!(held(&|_| None).0, HeldSlip::Immobilised(None));
    // the root lies beyond the greatest slip
    let (found, looks) = held(&|slip| Some(slip - 0.65));
    assert_eq!(found, HeldSlip::Immobilised(Some(0.6 - 0.65)));
    assert!(looks <= 14, "{looks}");
}

/// The slopes at which a surplus is looked at from 0.1 rad on, by hand: its share of the weight further, then twice as far.
#[test]
fn how_a_slope_is_sought() {
    let seen = core::cell::RefCell::new(std::vec::Vec::new());
    let held = |left: f64, precision: f64, surplus: &dyn Fn(f64) -> Option<f64>| {
        seen.take();
        search(10.0, None)
            .slope_held(0.3, (0.1, left), precision, |alpha, slip| {
                assert_eq!(slip, 0.3);
                seen.borrow_mut().push(alpha);
                Ok::<_, ()>(surplus(alpha))
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
    let best = |of: &dyn Fn(f64) -> Option<f64>| {
        search(1.0, None)
            .start(|slip| Ok::<_, ()>(of(slip)))
            .unwrap()
    };
    assert_eq!(best(&|_| Some(2.0)), Some((0.0, 2.0)));
    assert_eq!(best(&|_| None), None);
    // eight steps up to 1
    assert_eq!(
        best(&|slip| (slip > 0.3).then_some(slip.min(0.6))),
        Some((0.625, 0.6))
    );
    // a slip of a neighbour, where it holds
    let near = |near: f64| {
        let found = search(1.0, Some(near)).start(|slip| Ok::<_, ()>(Some(slip - 0.5)));
        found.unwrap().unwrap().0
    };
    assert_eq!((near(0.7), near(0.4)), (0.7, 1.0));
}

/// The steepest slope of a friction μ(s), tan α = max μ, beside a rough friction; and how often each is looked at, at most: a
/// snapshot.
#[test]
fn the_steepest_slope_by_hand() {
    const WEIGHT_N: f64 = 30.0;
    let found = |friction: &dyn Fn(f64) -> f64, off: f64| {
        let (rough, exact) = (Cell::new(0), Cell::new(0));
        let surplus = |alpha: f64, slip: f64, count: &Cell<u32>, off: f64| {
            count.set(count.get() + 1);
            let pull = friction(slip) * alpha.cos() - alpha.sin() + off;
            Ok::<_, ()>(Some(WEIGHT_N * pull))
        };
        let found = search(WEIGHT_N, None).steepest(
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
        (3.0, 0.33, 1e-6, [24, 8]),
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
        // and one beside an end
        assert!(
            looked[0] <= looks[0] + 1 && looked[1] <= looks[1] + 1,
            "{case}"
        );
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
        assert!(looked[1] <= looks + 1, "{most} {at}: {looked:?}");
    }
    // what the rough one alone holds
    assert!(found(&bend(-1e-6, 0.5), 2e-6).0.is_none());
}
