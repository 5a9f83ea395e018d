//! Working sets of three vectors in three dimensions.

use super::*;

/// Variables.
const N: usize = 3;

fn member(row: usize, vector: [f64; N], offset: f64, objective: bool) -> Member {
    Member {
        row,
        vector: vector.to_vec(),
        offset,
        objective,
        range: (0.0, f64::INFINITY),
    }
}

/// A product with each vector before, twice, and its subtraction, for one vector after the other.
#[test]
fn products_are_counted_before_they_are_made() {
    let members = [
        member(0, [1.0, 2.0, 4.0], 0.5, true),
        member(1, [1.0, 0.0, 1.0], 0.5, false),
        member(2, [0.0, 3.0, 1.0], 0.5, false),
        member(3, [2.0, 0.0, 1.0], 0.5, false),
    ];
    let mut counted = Vec::new();
    let found = Subspace::new(&members, &[], &[1.0; 4], N).solve(|products| {
        counted.push(products);
        false
    });
    assert!(matches!(found, Some(Outcome::Best { .. })));
    assert_eq!(counted, [0, 2 * N, 4 * N]);
}

/// The last vector is (δ, s, 0), of (l, 0, 0) and (0, s, 0): δ/l of the first one, which is rounding where δ is below 1e-11 s.
#[test]
fn shares_that_are_rounding_are_none() {
    for (l, delta, s, is_rounding) in [
        (1e3, 1e-10, 1.0, false),
        (1e-3, 1e-12, 1.0, true),
        (1.0, DEPENDENT_PIVOT, 1.0, false),
        (1.0, 1e-9, 1e3, true),
    ] {
        let members = [
            member(0, [l, 0.0, 0.0], 0.0, false),
            member(1, [0.0, s, 0.0], 0.0, false),
            member(2, [delta, s, 0.0], 1.0, false),
        ];
        let found = Subspace::new(&members, &[], &[0.0; 3], N).solve(|_| false);
        let Some(Outcome::Dependent { direction }) = found else {
            panic!("{l} {delta} {s}");
        };
        let share = if is_rounding { 0.0 } else { delta / l };
        assert_eq!(direction, [-share, -1.0, 1.0], "{l} {delta} {s}");
    }
}
