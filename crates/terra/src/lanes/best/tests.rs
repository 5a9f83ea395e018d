use super::*;

/// A search under 40 N of a wheel of 0.1 m, fed with a pull and a torque.
fn end_of(of: BestOf, traction: impl Fn(f64) -> Option<(f64, f64)>) -> Option<(f64, f64)> {
    let mut search = Search::new(of, 0.1, 40.0).unwrap();
    for _ in 0..400 {
        if let Some(end) = search.end() {
            return match end {
                End::Found(best) => Some(best),
                End::NoSolution => None,
                End::Unsure => Some((f64::NAN, f64::NAN)),
            };
        }
        let (slip, load) = search.next();
        assert!(load == 40.0 && (0.0..=1.0).contains(&slip));
        search.feed(traction(slip).map(|(drawbar_pull, torque)| Traction {
            drawbar_pull,
            torque,
        }));
    }
    panic!("it does not end");
}

#[test]
fn which_loads_are_searched_on_lanes() {
    let is_searched = |load: f64| Search::new(BestOf::Pull, 0.1, load).is_some();
    assert!(is_searched(1e12) && is_searched(1e-9));
    assert!(![1.01e12, 0.0, -1.0, f64::NAN].into_iter().any(is_searched));
}

/// Closed forms: a parabola, and η = DP (1 − s) r/T with DP = s and T = 0.2, greatest at s = ½.
#[test]
fn the_best_slip_is_found() {
    let pull = |slip: f64| Some((3.0 - (slip - 0.37).powi(2), 1.0));
    let (slip, value) = end_of(BestOf::Pull, pull).unwrap();
    assert!((slip - 0.37).abs() < 1e-6 && (value - 3.0).abs() < 1e-12);
    let (slip, value) = end_of(BestOf::Efficiency, |slip| Some((slip, 0.2))).unwrap();
    assert!((slip - 0.5).abs() < 1e-6 && (value - 0.125).abs() < 1e-12);
    // a negative pull may be the greatest
    let (slip, value) = end_of(BestOf::Pull, |slip| Some((slip - 2.0, -1.0))).unwrap();
    assert_eq!((slip, value), (1.0, -1.0));
}

/// Without a pull the greatest share of max(W, T/r) says whether there may be one.
#[test]
fn without_a_pull_there_is_no_efficiency() {
    let end = |pull: f64, torque: f64| end_of(BestOf::Efficiency, |_| Some((pull, torque)));
    let is_unsure = |end: Option<(f64, f64)>| end.is_some_and(|best| best.0.is_nan());
    // of 40 N, 1e-8
    assert_eq!(end(-4.1e-7, 1.0), None);
    assert!(is_unsure(end(-3.9e-7, 1.0)));
    // of 50 N
    assert_eq!(end(-5.1e-7, 5.0), None);
    assert!(is_unsure(end(-4.9e-7, 5.0)));
    assert!(is_unsure(end(-4.9e-7, -5.0)));
    // at one slip only
    assert!(is_unsure(end_of(BestOf::Efficiency, |slip| Some((
        if slip == 0.25 { -1e-9 } else { -1.0 },
        1.0
    )))));
    // no slip carries the load
    assert_eq!(end_of(BestOf::Pull, |_| None), None);
}
