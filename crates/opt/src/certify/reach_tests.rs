//! What a search foresees of its time.

use super::*;

/// A box, and the end of the log with it, ends within the limit.
#[test]
fn no_box_begins_that_would_end_too_late() {
    let mut reach = Reach::new(Instant::now());
    // two at once
    reach.examined(&[0.1, 0.3], 0.2);
    let last_s = |reach: &Reach, open: usize, expected: f64| {
        let found = reach.last_begin_s(Some(1.0), open);
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    };
    last_s(&reach, 10, 0.7);
    // without a log nothing is left to do
    reach.entered(0.002);
    last_s(&reach, 10, 0.7);
    // one delay of the machine does not count for every open box
    for seconds in [0.01, 0.0, 0.01, 0.02] {
        reach.bounded(seconds);
    }
    last_s(&reach, 0, 0.7);
    last_s(&reach, 10, 0.7 - 10.0 * (0.005 + 0.001));
    assert_eq!(reach.last_begin_s(None, 10), f64::INFINITY);
    // a batch of quick boxes is not yet all there is
    reach.examined(&[0.1], 0.05);
    last_s(&reach, 0, 0.73);
    reach.examined(&[], 5.0);
    last_s(&reach, 0, 0.73);
    assert_eq!(reach.boxes, 3);
}
