//! Eigenvalues and eigenvectors of a small symmetric matrix by Jacobi's rotations.

use grouser_real::Real;

/// Eigenvalues with their unit eigenvectors, in no particular order.
///
/// Jacobi's method is slower than others and more exact for small eigenvalues of a scaled matrix, which is
/// what decides whether a parameter can be identified.
pub(crate) fn symmetric(mut a: Vec<Vec<f64>>) -> Vec<(f64, Vec<f64>)> {
    /// Six to ten are enough for any matrix of this size (Numerical Recipes, 11.1).
    const SWEEPS: usize = 16;
    let n = a.len();
    let mut v: Vec<Vec<f64>> = (0..n)
        .map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect())
        .collect();
    for _ in 0..SWEEPS {
        for p in 0..n {
            for q in p + 1..n {
                if a[p][q] == 0.0 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = theta.signum() / (theta.abs() + Real::hypot(theta, 1.0));
                let c = 1.0 / Real::hypot(t, 1.0);
                let s = t * c;
                for row in &mut a {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                let (row_p, row_q) = (a[p].clone(), a[q].clone());
                for k in 0..n {
                    a[p][k] = c * row_p[k] - s * row_q[k];
                    a[q][k] = s * row_p[k] + c * row_q[k];
                }
                for row in &mut v {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
            }
        }
    }
    (0..n)
        .map(|k| (a[k][k], v.iter().map(|row| row[k]).collect()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_matrix() {
        // [[2, 1], [1, 2]]: 3 along (1, 1), 1 along (1, −1)
        let mut found = symmetric(vec![vec![2.0, 1.0], vec![1.0, 2.0]]);
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert!((found[0].0 - 1.0).abs() < 1e-15 && (found[1].0 - 3.0).abs() < 1e-15);
        assert!((found[1].1[0] - found[1].1[1]).abs() < 1e-15);
    }

    #[test]
    fn vectors_rebuild_a_hilbert_matrix() {
        let hilbert = |i: usize, j: usize| 1.0 / (i + j + 1) as f64;
        let matrix: Vec<Vec<f64>> = (0..5)
            .map(|i| (0..5).map(|j| hilbert(i, j)).collect())
            .collect();
        let found = symmetric(matrix);
        for i in 0..5 {
            for j in 0..5 {
                let sum: f64 = found.iter().map(|(value, v)| value * v[i] * v[j]).sum();
                assert!((sum - hilbert(i, j)).abs() < 1e-14);
            }
        }
    }
}
