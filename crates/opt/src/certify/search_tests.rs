//! In which order boxes are examined, and when bounds of second order are tried.

use std::collections::BinaryHeap;

use super::*;

fn open(bound: f64, id: u64) -> Open {
    Open {
        id,
        bound,
        weights: Weights::default(),
        x: Vec::new(),
        backoff: Backoff::default(),
    }
}

#[test]
fn the_lowest_and_oldest_box_comes_first() {
    let infinity = f64::INFINITY;
    let list = [
        (2.0, 1),
        (-1.0, 5),
        (infinity, 0),
        (-1.0, 3),
        (-infinity, 9),
        (2.0, 0),
    ];
    let mut heap: BinaryHeap<Open> = list.map(|(bound, id)| open(bound, id)).into();
    let order: Vec<(f64, u64)> = std::iter::from_fn(|| heap.pop())
        .map(|open| (open.bound, open.id))
        .collect();
    let expected = [
        (-infinity, 9),
        (-1.0, 3),
        (-1.0, 5),
        (2.0, 0),
        (2.0, 1),
        (infinity, 0),
    ];
    assert_eq!(order, expected);
    assert!(open(1.0, 2) == open(1.0, 2));
    assert!(open(1.0, 2) != open(1.0, 3) && open(1.0, 2) != open(2.0, 2));
}

#[test]
fn each_failure_delays_the_next_attempt() {
    let mut backoff = Backoff::default();
    for failed in [1, 2, 3, 4, 5, 6, 6] {
        backoff = backoff.after(true);
        assert_eq!((backoff.failed, backoff.wait), (failed, failed));
        for wait in (0..failed).rev() {
            backoff = backoff.after(false);
            assert_eq!((backoff.failed, backoff.wait), (failed, wait));
        }
        assert_eq!(backoff.after(false).wait, 0);
    }
}

fn examined(tried_second_order: bool, end: End) -> Examined {
    Examined {
        trims: Vec::new(),
        rest: Vec::new(),
        end,
        bound: 0.0,
        weights: Weights::default(),
        middle: Vec::new(),
        middle_level: 0.0,
        tried_second_order,
    }
}

/// Always while 64 were not tried, then as long as one of eight closes its box, and every sixteenth batch anyway.
#[test]
fn bounds_of_second_order_are_tried_where_they_bring_something() {
    let worthwhile = |tried: u64, closed: u64, batches: u64| {
        let mut yields = SecondOrderYield {
            tried,
            closed,
            batches,
        };
        let answer = yields.is_worthwhile();
        assert_eq!(yields.batches, batches + 1);
        let halves = if (batches + 1).is_multiple_of(16) {
            2
        } else {
            1
        };
        assert_eq!(
            (yields.tried, yields.closed),
            (tried / halves, closed / halves)
        );
        answer
    };
    for (tried, closed, expected) in [
        (0, 0, true),
        (63, 0, true),
        (64, 0, false),
        (64, 7, false),
        (64, 8, true),
        (64, 9, true),
        (803, 100, false),
        (800, 100, true),
    ] {
        assert_eq!(worthwhile(tried, closed, 3), expected, "{tried} {closed}");
        assert!(worthwhile(tried, closed, 15));
    }
    let mut yields = SecondOrderYield::default();
    yields.add(&[
        examined(true, End::Closed),
        examined(false, End::Closed),
        examined(true, End::Stuck),
        examined(true, End::Closed),
    ]);
    assert_eq!((yields.tried, yields.closed), (3, 2));
}
