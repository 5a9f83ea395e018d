use super::*;
use crate::slope::{HeldSlip, held_slip};

const MAX_SLIP: f64 = 0.6;

/// A search for a slope of 0.1 of a weight of 50 N, fed with a pull that exceeds what is required by `surplus`: its end, and how
/// many slips it took.
fn end_of(surplus: impl Fn(f64) -> Option<f64>) -> (Option<f64>, &'static str, u32) {
    let (sin, cos) = 0.1_f64.sin_cos();
    let mut search = Search::new(50.0, 0.1, MAX_SLIP).unwrap();
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
        assert!((0.0..=MAX_SLIP).contains(&slip));
        search.feed(surplus(slip).map(|surplus| Traction {
            drawbar_pull: 50.0 * sin + surplus,
            torque: f64::NAN,
        }));
    }
    panic!("it does not end");
}

#[test]
fn which_points_are_searched_on_lanes() {
    let is_searched = |weight: f64, slope: f64| Search::new(weight, slope, MAX_SLIP).is_some();
    assert!(is_searched(1e12, 0.1) && !is_searched(1.01e12, 0.1));
    assert!(is_searched(1e-9, 0.1) && !is_searched(0.0, 0.1) && !is_searched(-1.0, 0.1));
    assert!(is_searched(1.0, 1e-9) && !is_searched(1.0, 0.0) && !is_searched(1.0, -0.1));
    assert!(!is_searched(1.0, 89.9_f64.to_radians()));
    assert!(is_searched(1.0, 89.8_f64.to_radians()) && !is_searched(1.0, 89.95_f64.to_radians()));
    assert!(!is_searched(f64::NAN, 0.1) && !is_searched(1.0, f64::NAN));
}

/// The search on lanes is the general one; what brakes is left to that.
#[test]
fn a_search_ends_as_the_general_one() {
    type Surplus<'a> = &'a dyn Fn(f64) -> Option<f64>;
    let surpluses: [(Surplus, &str); 7] = [
        (&|slip| Some(3.0 * (slip - 0.4)), "found"),
        (
            &|slip| (slip > 0.1).then_some(5.0 * (slip - 0.3) * (0.8 - slip)),
            "found",
        ),
        (&|slip| Some(1e-3 - (slip - 0.41).powi(2)), "found"),
        (&|slip| Some(-0.5 - slip), "none"),
        (&|slip| Some(slip - 0.7), "none"),
        (&|_| None, "none"),
        (&|slip| Some(1.0 - slip), "unsure"),
    ];
    for (surplus, expected) in surpluses {
        let (slip, end, count) = end_of(surplus);
        assert_eq!(end, expected);
        let general = held_slip(MAX_SLIP, |slip| Ok::<_, ()>(surplus(slip))).unwrap();
        match general {
            HeldSlip::Holds(general) => assert!((slip.unwrap() - general).abs() < 1e-12),
            _ => assert!(slip.is_none()),
        }
        // thirteen samples, and a few slips about the root
        assert!(count <= 26, "{expected}: {count}");
    }
}
