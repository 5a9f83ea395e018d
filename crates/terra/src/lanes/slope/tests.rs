use super::*;

/// A search for a slope of 0.1 of a weight of 50 N, fed with a pull that exceeds what is required by `surplus`: its end, and how
/// many slips it took.
fn end_of(surplus: impl Fn(f64) -> Option<f64>) -> (Option<f64>, &'static str, u32) {
    let (sin, cos) = 0.1_f64.sin_cos();
    let mut search = Search::new(50.0, 0.1).unwrap();
    for count in 0..400 {
        if let Some(end) = search.end() {
            return match end {
                End::Found(slip) => (Some(slip), "found", count),
                End::NoSolution => (None, "none", count),
                End::Unsure => (None, "unsure", count),
            };
        }
        let (slip, load) = search.next();
        assert!((load - 50.0 * cos).abs() < 1e-12);
        assert!((0.0..=1.0).contains(&slip));
        search.feed(surplus(slip).map(|surplus| Traction {
            drawbar_pull: 50.0 * sin + surplus,
            torque: f64::NAN,
        }));
    }
    panic!("it does not end");
}

#[test]
fn which_points_are_searched_on_lanes() {
    let is_searched = |weight: f64, slope: f64| Search::new(weight, slope).is_some();
    assert!(is_searched(1e12, 0.1) && !is_searched(1.01e12, 0.1));
    assert!(is_searched(1e-9, 0.1) && !is_searched(0.0, 0.1) && !is_searched(-1.0, 0.1));
    assert!(is_searched(1.0, 1e-9) && !is_searched(1.0, 0.0) && !is_searched(1.0, -0.1));
    assert!(!is_searched(1.0, 89.9_f64.to_radians()));
    assert!(is_searched(1.0, 89.8_f64.to_radians()) && !is_searched(1.0, 89.95_f64.to_radians()));
    assert!(!is_searched(f64::NAN, 0.1) && !is_searched(1.0, f64::NAN));
}

#[test]
fn the_first_slip_that_suffices_is_found() {
    // fourteen samples of 1/33, and the secant
    let (slip, _, count) = end_of(|slip| Some(3.0 * (slip - 0.4)));
    assert!(
        (slip.unwrap() - 0.4).abs() < 1e-12 && count <= 18,
        "{slip:?} {count}"
    );
    // of two roots the first, and one beside slips that do not carry the load
    let (slip, _, count) = end_of(|slip| (slip > 0.1).then_some(5.0 * (slip - 0.3) * (0.8 - slip)));
    assert!(
        (slip.unwrap() - 0.3).abs() < 1e-12 && count <= 27,
        "{slip:?} {count}"
    );
    // at a sample, and at the last one
    let (slip, _, count) = end_of(|slip| Some(if slip < 0.4 { slip - 1.0 } else { 0.0 }));
    assert_eq!((slip, count), (Some(14.0 / 33.0), 15));
    let (slip, ..) = end_of(|slip| Some(slip - 1.0));
    assert_eq!(slip, Some(1.0));
}

#[test]
fn what_the_general_search_decides() {
    // a pull at slip 0 that suffices, or at the first slip that carries the load
    assert_eq!(end_of(|_| Some(0.0)), (None, "unsure", 1));
    assert_eq!(end_of(|slip| Some(1.0 - slip)), (None, "unsure", 1));
    let carried = |slip: f64| (slip > 0.5).then_some(1.0);
    assert_eq!(end_of(carried), (None, "unsure", 18));
    // greatest at slip 0
    assert_eq!(end_of(|slip| Some(-0.1 - slip)), (None, "unsure", 34));
    // no slip carries the load
    assert_eq!(end_of(|_| None).1, "unsure");
}

/// A pull with its greatest surplus `top` at slip 0.41, which curves by `bend`.
fn peak(top: f64, bend: f64) -> (Option<f64>, &'static str, u32) {
    end_of(|slip| Some(top - bend * (slip - 0.41).powi(2)))
}

#[test]
fn a_maximum_between_the_samples() {
    // what lacks is more than the pull changes beside the best sample
    assert_eq!(peak(-0.5, 1.0), (None, "none", 34));
    // once finer: by up to 2 (3/66)² of the bend it might reach
    assert_eq!(peak(-1e-3, 1.0), (None, "none", 34 + 33));
    assert_eq!(peak(-1e-5, 1.0), (None, "none", 34 + 2 * 33));
    assert_eq!(peak(-4e-8, 1.0), (None, "none", 34 + 3 * 33));
    // too little to be decided
    assert_eq!(peak(-1e-13, 1.0), (None, "unsure", 34 + 3 * 33));
    // what suffices in a few thousandths of slip only
    for width in [1e-2, 1e-3_f64, 1e-4] {
        let (slip, _, count) = peak(50.0 * width * width, 50.0);
        assert!(
            (slip.unwrap() - (0.41 - width)).abs() < 1e-11,
            "{slip:?} {width}"
        );
        assert!(count < 34 + 3 * 33, "{count}");
    }
    // beside slip 1 and slip 0 samples end there
    let (slip, ..) = end_of(|slip| Some(1e-6 - (slip - 0.9987).powi(2)));
    assert!((slip.unwrap() - 0.9977).abs() < 1e-10);
    let (slip, ..) = end_of(|slip| Some(1e-6 - (slip - 0.02).powi(2)));
    assert!((slip.unwrap() - 0.019).abs() < 1e-10);
}

#[test]
fn by_how_much_the_pull_changes_beside_the_best_sample() {
    let samples = |values: &[Option<f64>]| {
        let mut samples = Samples::new(0.25, 0.125, 9);
        for &value in values {
            let slip = samples.next_slip().unwrap();
            samples.take(slip, value);
        }
        samples
    };
    let five = samples(&[-9.0, -6.0, -2.0, -3.0, -8.0].map(Some));
    assert_eq!((five.best, five.change), ((0.5, -2.0), 4.0));
    // before the best one, behind it, and the change before the last two
    assert_eq!(samples(&[-9.0, -6.0, -2.0, -7.5].map(Some)).change, 5.5);
    assert_eq!(samples(&[-9.0, -6.0].map(Some)).change, 3.0);
    assert_eq!(samples(&[-9.0, -2.0, -1.0].map(Some)).change, 7.0);
    assert_eq!(samples(&[Some(-9.0)]).change, 0.0);
    // a gap on either side
    assert_eq!(
        samples(&[Some(-9.0), None, Some(-2.0), Some(-2.5)]).change,
        0.5
    );
    assert_eq!(
        samples(&[Some(-9.0), Some(-2.0), None, Some(-8.0)]).change,
        7.0
    );
    // equal samples: the first is the best
    assert_eq!(
        samples(&[-3.0, -2.0, -2.0, -4.0].map(Some)).best,
        (0.375, -2.0)
    );
    // the best and twice the change
    assert!(samples(&[-9.0, -6.0].map(Some)).may_reach());
    assert!(!samples(&[-9.0, -6.1].map(Some)).may_reach());
    // held in [0, 1]
    let mut last = samples(&[Some(-1.0); 7]);
    assert_eq!(last.next_slip(), Some(1.0));
    last.take(1.0, Some(-1.0));
    assert_eq!(last.next_slip(), Some(1.0));
    last.take(1.0, Some(-1.0));
    assert_eq!(last.next_slip(), None);
    let finer = five.finer();
    assert_eq!(
        (finer.from, finer.step, finer.count),
        (0.375, 0.125 / 16.0, 33)
    );
}
