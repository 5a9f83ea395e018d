use std::vec::Vec;

use super::*;

fn close(got: &[f64], expected: &[f64]) {
    assert_eq!(got.len(), expected.len(), "{got:?}");
    for (got, expected) in got.iter().zip(expected) {
        assert!((got - expected).abs() < 1e-9, "{got} {expected}");
    }
}

/// By hand: the secant and 0.4 of the precision beyond it, Illinois' halves, and the middle at every sixth step.
#[test]
fn a_root_is_sought_by_illinois_weights() {
    let mut search = RootSearch::new((0.0, -0.8), (1.0, 1.2), 1e-3);
    let mut next = |value: Option<f64>, expected: f64| {
        let slip = search.next_slip().unwrap();
        assert!((slip - expected).abs() < 1e-12, "{slip} {expected}");
        search.feed(value);
    };
    next(Some(0.2), 0.4004);
    // (0, −0.8) and (0.4004, 0.2)
    let second = 0.4004 * 0.8 - 4e-4;
    next(Some(0.1), second);
    // the same end again: (0, −0.4)
    let third = second * 0.8 - 4e-4;
    next(Some(-0.3), third);
    let fourth = third + (second - third) * 0.75 + 4e-4;
    next(Some(-0.2), fourth);
    // the same end again: (second, 0.05)
    let fifth = fourth + (second - fourth) * 0.8 + 4e-4;
    next(None, fifth);
    // no value counts as below, and has none for the secant: the sixth is the middle
    let sixth = 0.5 * (fifth + second);
    next(Some(0.01), sixth);
    assert!((search.root() - sixth).abs() < 1e-12);
    // a value of 0 is the root
    assert!(search.next_slip().is_some());
    search.feed(Some(0.0));
    assert!(search.next_slip().is_none() && search.root() < sixth);
}

#[test]
fn a_straight_line_takes_two_steps_to_its_root() {
    let count = core::cell::Cell::new(0);
    let f = |x: f64| {
        count.set(count.get() + 1);
        Ok::<_, ()>(Some(x - 0.3))
    };
    let found = root((0.0, -0.3), (1.0, 0.7), 1e-6, f).unwrap();
    assert!((found - 0.300_000_4).abs() < 1e-12 && count.get() == 2);
    // nothing to seek
    assert_eq!(root((0.2, -1.0), (0.3, 0.0), 1e-6, f).unwrap(), 0.3);
    assert_eq!(root((0.25, -1.0), (0.5, 1.0), 0.25, f).unwrap(), 0.5);
    assert_eq!(count.get(), 2);
    // no bracket is too narrow for a precision of 0
    root((0.0, -0.3), (1.0, 0.7), 0.0, |x| {
        count.set(count.get() + 1);
        Ok::<_, ()>(Some(if x < 0.3 { -1.0 } else { 1.0 }))
    })
    .unwrap();
    assert_eq!(count.get(), 2 + 199);
}

#[test]
fn a_root_nearby_is_sought_within_the_least_reach_that_encloses_it() {
    let least = core::cell::Cell::new(1.0_f64);
    let f = |x: f64| {
        least.set(least.get().min(x));
        Ok::<_, ()>(Some(x * x * x - 0.027))
    };
    let found = root_near(0.29, &[0.005, 0.02, 0.3], f).unwrap().unwrap();
    assert!((found - 0.3).abs() < 1e-12 && (least.get() - 0.27).abs() < 1e-15);
    assert_eq!(root_near(0.29, &[0.005], f).unwrap(), None);
    // a root at the upper end counts, one at the lower end does not
    assert_eq!(
        root_near(0.0, &[0.5], |x| Ok::<_, ()>(Some(x - 0.5))).unwrap(),
        Some(0.5)
    );
    assert_eq!(
        root_near(0.0, &[0.5], |x| Ok::<_, ()>(Some(x + 0.5))).unwrap(),
        None
    );
    // falling, without a value, and beyond −1 and 1
    assert_eq!(
        root_near(0.3, &[0.1], |x| Ok::<_, ()>(Some(0.3 - x))).unwrap(),
        None
    );
    assert_eq!(root_near(0.3, &[0.1], |_| Ok::<_, ()>(None)).unwrap(), None);
    for (near, at) in [(0.9, 0.99), (-0.9, -0.99)] {
        let inside = |x: f64| Ok::<_, ()>((x.abs() <= 1.0).then_some(x - at));
        let found = root_near(near, &[0.5], inside).unwrap().unwrap();
        assert!((found - at).abs() < 1e-12);
    }
}

/// Where a search for a maximum looks, and what it finds.
fn looked_at(
    f: impl Fn(f64) -> f64,
    near: f64,
    by: (f64, f64),
    flat: f64,
) -> (Vec<f64>, (f64, f64)) {
    let mut search = MaximumSearch::new((near, f(near)), 1.0, by, flat);
    let mut places = Vec::new();
    while let Some(slip) = search.next_slip() {
        places.push(slip);
        search.feed(Some(f(slip)));
    }
    (places, search.best())
}

/// The places by Brent's flow chart (chapter 5), written down in Python with a tolerance of 0.3 of the precision.
#[test]
fn a_maximum_is_sought_where_brents_method_looks() {
    let (places, best) = looked_at(|x| x * (1.0 - x) * (1.0 - x), 0.25, (0.2, 1e-4), 0.0);
    let expected = [
        0.173_606_797_7,
        0.326_393_202_3,
        0.327_334_368_5,
        0.332_822_560_8,
        0.377_580_359_9,
        0.333_309_532_2,
        0.333_339_532_2,
        0.333_309_532_2,
        0.350_238_024_7,
        0.333_309_532_2,
        0.339_794_182,
        0.333_309_532_2,
        0.335_804_989,
        0.333_309_532_2,
        0.334_281_252_9,
        0.333_309_532_2,
        0.333_699_237_5,
        0.333_309_532_2,
        0.333_476_927_4,
        0.333_309_532_2,
        0.333_392_012_5,
    ];
    close(&places, &expected);
    assert!((best.0 - 1.0 / 3.0).abs() < 1e-5 && (best.1 - 4.0 / 27.0).abs() < 1e-9);

    let kink = |x: f64| -(x - 0.37).abs() - 3.0 * (x - 0.37).max(0.0);
    let expected = [
        0.404_508_497_2,
        0.345_491_502_8,
        0.303_430_319_7,
        0.341_747_465_9,
        0.368_033_988_7,
        0.381_966_011_3,
        0.359_423_525_3,
        0.373_355_547_8,
        0.365_033_988_7,
    ];
    close(&looked_at(kink, 0.5, (0.25, 1e-2), 0.0).0, &expected);

    let kink = |x: f64| -(x - 0.37).abs() - 5.0 * (0.37 - x).max(0.0);
    let expected = [
        0.411_803_398_9,
        0.388_196_601_1,
        0.373_606_797_7,
        0.364_589_803_4,
        0.378_091_366_4,
        0.370_162_612_4,
    ];
    close(&looked_at(kink, 0.45, (0.1, 1e-2), 0.0).0, &expected);

    let expected = [
        0.423_606_797_7,
        0.576_393_202_3,
        0.552_654_335_2,
        0.574_152_216_5,
        0.586_084_311_4,
        0.629_596_232_6,
        0.611_734_830_6,
        0.620_575_538_1,
        0.619_366_588_5,
        0.619_971_370_1,
        0.620_271_370_1,
        0.620_271_370_1,
        0.619_671_370_1,
    ];
    let quartic = |x: f64| 1.0 - (x - 0.62).powi(4);
    close(&looked_at(quartic, 0.5, (0.2, 1e-3), 0.0).0, &expected);

    let expected = [
        0.347_213_595_5,
        0.252_786_404_5,
        0.312_084_705_5,
        0.304_638_393_9,
        0.297_902_354_2,
        0.300_902_354_2,
    ];
    let two = |x: f64| (x - 0.2) * (x - 0.5) * (0.6 - x) * (x - 0.9);
    close(&looked_at(two, 0.5, (0.4, 1e-2), 0.0).0, &expected);

    // a parabola points beyond the bracket
    let expected = [
        0.417_426_457_9,
        0.372_573_542_1,
        0.397_996_634,
        0.445_147_084_3,
        0.428_014_795,
        0.410_004_925_6,
        0.421_470_842_8,
        0.414_426_457_9,
    ];
    let bent = |x: f64| x * (2.2 - x * (0.6 + 2.8 * x)) - 7.9 * (x - 0.42).max(0.0);
    close(&looked_at(bent, 0.49, (0.19, 1e-2), 0.0).0, &expected);
}

/// It ends where three values differ by less than a millionth.
#[test]
fn a_flat_maximum_is_found_early() {
    let expected = [
        0.323_606_797_7,
        0.276_393_202_3,
        0.335_278_640_5,
        0.333_134_153,
        0.333_341_950_2,
        0.333_333_519_9,
    ];
    let flat = |x: f64| 3.0 + x * (1.0 - x) * (1.0 - x);
    close(&looked_at(flat, 0.4, (0.2, 1e-9), 1e-6).0, &expected);
    // whatever their unit
    for unit in [1e-3, 1e3] {
        let flat = |x: f64| unit * flat(x);
        close(&looked_at(flat, 0.4, (0.2, 1e-9), 1e-6).0, &expected);
    }
    // the first step, golden section's, finds the same value again: that is no third one
    let top = 0.4 - 0.5 * 0.2 * 0.5 * (3.0 - 5_f64.sqrt());
    let even = |x: f64| 3.0 - (x - top) * (x - top);
    let (places, best) = looked_at(even, 0.4, (0.2, 1e-9), 1e-6);
    assert!((even(places[0]) - even(0.4)).abs() < 1e-15);
    assert!((best.0 - top).abs() < 1e-3, "{best:?} {top}");
}

#[test]
fn a_maximum_at_an_end() {
    // the ends themselves
    assert_eq!(looked_at(|x| x, 0.9, (0.2, 1e-3), 0.0).1, (1.0, 1.0));
    assert_eq!(looked_at(|x| 2.0 - x, 0.1, (0.2, 1e-3), 0.0).1, (0.0, 2.0));
    let (places, _) = looked_at(|x| x, 0.9, (0.2, 1e-3), 0.0);
    assert_eq!(places.iter().filter(|x| **x == 1.0).count(), 1);
    // where the value there is less it is not the best, where it is the same it is
    let jump = |x: f64| if x < 1.0 { x } else { 0.0 };
    let best = looked_at(jump, 0.9, (0.2, 1e-3), 0.0).1;
    assert!(best.0 < 1.0 && best.0 > 0.999 && best.1 == best.0);
    // a precision of 0 is never reached
    let kink = |x: f64| -(x - 0.37).abs();
    let (places, best) = looked_at(kink, 0.5, (0.25, 0.0), 0.0);
    assert!(
        places.len() == 60 && (best.0 - 0.37).abs() < 1e-9,
        "{best:?}"
    );
    // without any value it stays where it began
    let nothing = maximum(0.5, 1.0, (0.1, 1e-2), |_| Ok::<_, ()>(None)).unwrap();
    assert_eq!(nothing.1, f64::NEG_INFINITY);
    let found = maximum(0.5, 1.0, (0.2, 1e-6), |x| {
        Ok::<_, ()>((x < 0.6).then_some(x - x * x * x))
    })
    .unwrap();
    assert!((found.0 - 1.0 / 3_f64.sqrt()).abs() < 1e-6);
}

/// The best over all slips, and how many were looked at.
fn best_of(f: impl Fn(f64) -> Option<f64>) -> (Option<(f64, f64)>, usize) {
    let (mut search, mut count) = (BestSearch::new(), 0);
    while let Some(slip) = search.next_slip() {
        count += 1;
        search.feed(f(slip));
    }
    (search.best(), count)
}

#[test]
fn the_best_of_all_slips() {
    for at in [0.1, 0.3, 0.52, 0.97] {
        let (best, count) = best_of(|x| Some(2.0 - (x - at) * (x - at)));
        let (slip, value) = best.unwrap();
        // the value is known to 1e-13 of itself, the place to the root of that
        assert!((slip - at).abs() < 1e-6 && (value - 2.0).abs() < 1e-12);
        assert!(count <= 33 + 10, "{count}");
    }
    assert_eq!(best_of(|x| Some(1.0 + x)).0, Some((1.0, 2.0)));
    assert_eq!(best_of(|x| Some(1.0 - x)).0, Some((0.0, 1.0)));
    assert_eq!(best_of(|_| None), (None, 33));
    // of equal ones the first
    assert_eq!(best_of(|_| Some(1.0)).0, Some((0.0, 1.0)));
    // a narrow peak between two samples of 0.91, and another sample of 1
    let peaks = |x: f64| {
        let wide = 1.0 - 4.0 * (x - 0.25).abs();
        wide.max(1.1 - 12.0 * (x - 20.5 / 32.0).abs())
    };
    let (slip, value) = best_of(|x| Some(peaks(x))).0.unwrap();
    assert!((slip - 20.5 / 32.0).abs() < 1e-6 && (value - 1.1).abs() < 1e-5);
    // where there is a value on one side only
    let (slip, _) = best_of(|x| (x <= 0.5).then_some(x)).0.unwrap();
    assert!((slip - 0.5).abs() < 1e-8);
}

#[test]
fn which_samples_may_have_the_best_beside_them() {
    let may = |values: [f64; 3], best: f64, k: usize| {
        let mut search = BestSearch::new();
        search.best.1 = best;
        search.values[k - 1..k + 2].copy_from_slice(&values);
        search.may_be_best(k)
    };
    // by no more than it changes to a neighbour: 0.75 + 0.5
    assert!(may([0.25, 0.75, 0.5], 1.25, 5) && may([0.5, 0.75, 0.25], 1.25, 5));
    assert!(!may([0.25, 0.75, 0.5], 1.26, 5) && !may([0.5, 0.75, 0.25], 1.26, 5));
    // of two equal samples the first is a peak
    assert!(may([0.25, 0.75, 0.75], 0.75, 5) && !may([0.75, 0.75, 0.25], 0.75, 5));
    assert!(!may([0.8, 0.75, 0.5], 0.8, 5) && !may([0.5, 0.75, 0.8], 0.8, 5));
    let none = f64::NEG_INFINITY;
    assert!(!may([none, none, none], none, 5));
    // the ends have one neighbour
    let mut search = BestSearch::new();
    search.values = [0.5; SAMPLES as usize];
    (search.values[0], search.values[32]) = (1.0, 0.75);
    search.best.1 = 1.0;
    assert!(search.may_be_best(0) && search.may_be_best(32));
    search.best.1 = 1.01;
    assert!(search.may_be_best(0) && !search.may_be_best(32));
}
