//! Quadratic models with known optima, and the curvatures that bounds of second order claim.

use super::*;
use crate::certify::process::tests::rows_over;
use crate::sqp::LinearKind;
use crate::tape::{Binary, Node, Tape};

/// x² + x y/2 + 3/2 y², times a scale.
fn bowl(tape: &mut Tape, x: Node, y: Node, scale: f64) -> Node {
    let [half, more] = [0.5, 1.5].map(|c| tape.constant(c));
    let (xx, yy) = (tape.whole_power(x, 2), tape.whole_power(y, 2));
    let xy = tape.binary(Binary::Mul, x, y);
    let xy = tape.binary(Binary::Mul, half, xy);
    let yy = tape.binary(Binary::Mul, more, yy);
    let sum = tape.binary(Binary::Add, xx, yy);
    let sum = tape.binary(Binary::Add, sum, xy);
    let scale = tape.constant(scale);
    tape.binary(Binary::Mul, scale, sum)
}

/// Bowls that are tilted by x, by y/2 − x, and one that is lower everywhere: by hand the greatest is least at (−1/54, −4/54), where
/// it is −1/108, with the multipliers 29/54 and 25/54.
fn tilted_bowls(scale: f64) -> Rows {
    let x = [Interval::new(-1.0, 3.0), Interval::new(-0.5, 0.5)];
    let make = |tape: &mut Tape, x: Node, y: Node| {
        let bowl = bowl(tape, x, y, scale);
        let [one, half, less] = [scale, 0.5 * scale, 9.0 * scale].map(|c| tape.constant(c));
        let (to_x, to_y) = (
            tape.binary(Binary::Mul, one, x),
            tape.binary(Binary::Mul, half, y),
        );
        let other = tape.binary(Binary::Sub, to_y, to_x);
        vec![
            tape.binary(Binary::Add, bowl, to_x),
            tape.binary(Binary::Add, bowl, other),
            tape.binary(Binary::Sub, bowl, less),
        ]
    };
    rows_over(x, &[], make)
}

fn sides(rows: &Rows) -> Vec<Interval> {
    let sides = rows.lower.iter().zip(&rows.upper);
    sides
        .map(|(low, high)| Interval::new(*low, *high))
        .collect()
}

#[test]
fn a_model_of_bowls_finds_their_optimum() {
    for scale in [1e-6, 1.0, 1e6] {
        let rows = tilted_bowls(scale);
        let x = sides(&rows);
        let mut examiner = Examiner::default();
        examiner.over.forward(&rows.tape, &x, &rows.needed);
        let mut expansion = examiner.expand(&rows, &x);
        if expansion.rows.len() == 2 {
            // the lower one counts for the model too
            expansion.rows.push(vec![(2, 1.0)]);
            expansion.kinds.push(LinearKind::Objective);
        }
        let radii = [2.0, 0.5];
        let hessian = [2.0, 0.5, 3.0].map(|h| Interval::point(scale * h));
        let scaled = scaled_middle(&hessian, &radii);
        assert_eq!(scaled, [8.0, 0.5, 0.5, 0.75].map(|h| scale * h));
        let (weights, step, promised) = examiner
            .quadratic_step(&rows, &expansion, &[0.5, 0.25], &x, &radii, &scaled)
            .unwrap();
        let near = |found: f64, expected: f64| {
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        };
        near(step[0], (-1.0 / 54.0 - 0.5) / 2.0);
        near(step[1], (-4.0 / 54.0 - 0.25) / 0.5);
        near(promised / scale, -1.0 / 108.0);
        let [(0, first), (1, second)] = weights[..] else {
            panic!("{weights:?}");
        };
        near(first, 29.0 / 54.0);
        near(second, 25.0 / 54.0);
    }
}

#[test]
fn the_middle_of_a_hessian_is_in_half_sides() {
    let hessian = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|h| Interval::new(h - 0.5, h + 0.5));
    let found = scaled_middle(&hessian, &[1.0, 0.5, 4.0]);
    assert_eq!(found, [1.0, 1.0, 16.0, 1.0, 0.75, 10.0, 16.0, 10.0, 96.0]);
}

/// A bound of second order closes the box of the bowls, with the curvature that costs no more than rounding.
#[test]
fn bowls_are_proved_in_one_box() {
    for scale in [0.01, 1000.0] {
        let rows = tilted_bowls(scale);
        let x = sides(&rows);
        let target = -scale / 108.0 - 1e-4 * scale;
        for best in [None, Some(&[-1.0 / 54.0, -4.0 / 54.0][..])] {
            let aim = Aim {
                target,
                tolerance: 0.0,
                best,
            };
            let found = Examiner::default().examine(&rows, None, &x, &aim, true);
            assert!(matches!(found.end, crate::certify::process::End::Closed));
            assert!(found.tried_second_order && found.bound >= target);
            assert!(found.bound <= -scale / 108.0 + 1e-12 * scale);
            let tangent = found.weights.tangent.unwrap();
            assert_eq!(tangent.curvature, -1e-9 * target.abs().max(1.0));
            assert!((tangent.at[0] + 1.0 / 54.0).abs() < 1e-6);
            assert!((tangent.at[1] + 4.0 / 54.0).abs() < 1e-6);
        }
        // no point is sought where none is known to be beaten
        let aim = Aim {
            target: f64::INFINITY,
            tolerance: 0.0,
            best: None,
        };
        let found = Examiner::default().examine(&rows, None, &x, &aim, true);
        assert!(found.weights.tangent.is_none());
    }
}

/// The curvature is sought by factors of 8, then by halves, and claimed a millionth lower; beyond a thousand times the size of
/// the Hessian there is no search.
#[test]
fn how_far_a_curvature_is_sought() {
    let x = [Interval::new(-1.0, 1.0), Interval::new(-1.0, 1.0)];
    let hessian = [-3.0, 0.0, 1.0].map(Interval::point);
    for slack in [1.0, 1e-3, 0.7e-9] {
        let found = max_curvature(&hessian, &x, slack);
        let place = 32.0 * (-found / (1.0 + 1e-6) / slack).log(8.0);
        assert!(
            (place - place.round()).abs() < 1e-7 && (-3.3..=-3.0).contains(&found),
            "{found} {place}"
        );
    }
    // sides of 8 and 2: the middle is 16 in half sides, its spread more than can be proved
    let x = [Interval::new(-4.0, 4.0), Interval::new(-1.0, 1.0)];
    let wide = |h: f64| Interval::new(h - 1e9, h + 1e9);
    let hessian = [wide(1.0), Interval::ZERO, wide(0.0)];
    assert_eq!(max_curvature(&hessian, &x, 5.0), -5.0 * 8.0_f64.powi(5));
    assert_eq!(max_curvature(&hessian, &x, 10.0), -10.0 * 8.0_f64.powi(4));
    assert_eq!(max_curvature(&[Interval::ENTIRE; 3], &x, 5.0), -5.0);
}
