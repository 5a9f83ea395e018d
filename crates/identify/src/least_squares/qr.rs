//! The damped linear least-squares problem of one step, by Householder reflections.

use grouser_real::Real;

/// min ‖A x + b‖² + ‖D x‖², A given by rows, D diagonal. `None` where a column is empty to rounding.
///
/// The rows of D come below those of A, so that AᵀA is never formed: its condition is the square of A's.
pub(crate) fn solve_damped(rows: &[Vec<f64>], right: &[f64], damping: &[f64]) -> Option<Vec<f64>> {
    let columns = damping.len();
    let mut a: Vec<Vec<f64>> = rows.to_vec();
    let mut b: Vec<f64> = right.iter().map(|value| -value).collect();
    for (column, &d) in damping.iter().enumerate() {
        let mut row = vec![0.0; columns];
        row[column] = d;
        a.push(row);
        b.push(0.0);
    }
    for k in 0..columns {
        let norm = a[k..]
            .iter()
            .fold(0.0_f64, |sum, row| Real::hypot(sum, row[k]));
        // of the sign that cancels no digits
        let alpha = norm.copysign(-a[k][k]);
        let mut v: Vec<f64> = a[k..].iter().map(|row| row[k]).collect();
        v[0] -= alpha;
        let squared: f64 = v.iter().map(|x| x * x).sum();
        for column in k..columns {
            let dot: f64 = v.iter().zip(&a[k..]).map(|(x, row)| x * row[column]).sum();
            let scale = 2.0 * dot / squared;
            for (x, row) in v.iter().zip(&mut a[k..]) {
                row[column] -= scale * x;
            }
        }
        let dot: f64 = v.iter().zip(&b[k..]).map(|(x, y)| x * y).sum();
        let scale = 2.0 * dot / squared;
        for (x, y) in v.iter().zip(&mut b[k..]) {
            *y -= scale * x;
        }
    }
    // an empty column leaves a quotient by 0
    let mut x = vec![0.0; columns];
    for k in (0..columns).rev() {
        let known: f64 = a[k].iter().zip(&x).map(|(a, x)| a * x).sum();
        x[k] = (b[k] - known) / a[k][k];
        if !x[k].is_finite() {
            return None;
        }
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_through_three_points() {
        // y = 1 + 2 x at x = 0, 1, 2 is met exactly: A x + b = 0 with b = −y
        let rows = vec![vec![1.0, 0.0], vec![1.0, 1.0], vec![1.0, 2.0]];
        let x = solve_damped(&rows, &[-1.0, -3.0, -5.0], &[1e-12, 1e-12]).unwrap();
        assert!((x[0] - 1.0).abs() < 1e-12 && (x[1] - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_short_column_keeps_its_digits() {
        // 1 less the norm of (1, 1e-8) has no digits: only the other sign of the reflection does
        for sign in [1.0, -1.0] {
            let rows = vec![vec![sign, 1.0], vec![1e-8, 1.0]];
            let right = [-sign - 2.0, -1e-8 - 2.0];
            let x = solve_damped(&rows, &right, &[0.0, 0.0]).unwrap();
            assert!(
                (x[0] - 1.0).abs() < 1e-14 && (x[1] - 2.0).abs() < 1e-14,
                "{x:?}"
            );
        }
    }

    #[test]
    fn an_empty_column_has_no_solution() {
        assert_eq!(solve_damped(&[vec![1.0, 0.0]], &[1.0], &[0.0, 0.0]), None);
    }
}
