//! What a search foresees of its time.

use super::*;

/// A box, and the end of the log with it, ends within the limit.
#[test]
fn no_box_begins_that_would_end_too_late() {
    let mut reach = Reach::new(Instant::now());
    reach.examined(vec![0.1, 0.3]);
    // one delay of the machine does not count for every open box
    for seconds in [0.01, 0.0, 0.01, 0.02] {
        reach.bounded(seconds);
    }
    let end_s = 0.1 / rayon::current_num_threads() as f64;
    assert!((reach.last_begin_s(Some(1.0), 0) - 0.7).abs() < 1e-12);
    assert!((reach.last_begin_s(Some(1.0), 10) - (0.7 - end_s)).abs() < 1e-12);
    assert_eq!(reach.last_begin_s(None, 10), f64::INFINITY);
    // a batch of quick boxes is not yet all there is
    reach.examined(vec![0.1]);
    assert!((reach.last_begin_s(Some(1.0), 0) - 0.73).abs() < 1e-12);
    reach.examined(Vec::new());
    assert!((reach.last_begin_s(Some(1.0), 0) - 0.73).abs() < 1e-12);
}
