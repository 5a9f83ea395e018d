use super::*;

/// Follows a function from equally spaced samples on; returns them and how many were added.
fn follow(count: i32, resolution: f64, f: impl Fn(f64) -> f64) -> (Followed, usize) {
    let mut followed = Followed::new(resolution);
    for i in 0..=count {
        let place = f64::from(i) / f64::from(count);
        followed.add(place, f(place));
    }
    let before = followed.len;
    while let Some(place) = followed.next_place() {
        followed.add(place, f(place));
    }
    let added = followed.len - before;
    (followed, added)
}

#[test]
fn what_rises_steadily_needs_no_more_samples() {
    for root in [0.1, 0.5, 0.93_f64] {
        let (followed, added) = follow(8, 1e-3, |x| (2.0 * x).exp() - (2.0 * root).exp());
        let [low, high] = followed.first_rise().unwrap();
        assert!(added == 0 && low.0 < root && root <= high.0);
        assert!(followed.only_rises() && followed.passes() == 1);
    }
    // nor does what turns far from zero
    assert_eq!(follow(8, 1e-3, |x| 5.0 + (6.0 * x).sin()).1, 0);
}

/// Two roots 0.04 apart between two of nine samples, and none where the top stays below zero.
#[test]
fn a_turn_between_samples_is_found() {
    let arch = |top: f64| move |x: f64| top - 4.0 * (x - 0.45) * (x - 0.45);
    let (followed, added) = follow(8, 1e-3, arch(0.0016));
    assert_eq!(followed.passes(), 2);
    assert!(added > 0 && added < 12, "{added}");
    let [low, high] = followed.first_rise().unwrap();
    assert!(low.0 < 0.43 && 0.43 <= high.0 && high.0 < 0.47);
    let (followed, _) = follow(8, 1e-3, arch(-0.0016));
    assert!(followed.first_rise().is_none());
}

/// A function that begins within its samples is followed to its beginning.
#[test]
fn what_begins_between_samples_is_followed_to_there() {
    let from = |start: f64| {
        move |x: f64| {
            if x < start {
                f64::NEG_INFINITY
            } else {
                x - 0.4
            }
        }
    };
    let (followed, _) = follow(8, 1e-3, from(0.38));
    let [low, high] = followed.first_rise().unwrap();
    assert!(low.0 < 0.4 && 0.4 <= high.0 && low.1.is_finite());
    // where its first value is not below zero it does not rise
    assert!(follow(8, 1e-3, from(0.41)).0.first_rise().is_none());
    assert!(!followed.only_rises());
}

#[test]
fn a_cubic_with_steep_ends_may_turn() {
    assert!(is_monotone(1.0, [0.0, 3.0]) && is_monotone(-1.0, [-3.0, -0.1]));
    assert!(!is_monotone(1.0, [3.1, 1.0]) && !is_monotone(1.0, [1.0, -0.1]));
    assert!(!is_monotone(0.0, [1.0, 1.0]) && !is_monotone(1.0, [f64::NAN, 1.0]));
}
