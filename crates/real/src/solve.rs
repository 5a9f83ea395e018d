//! Small systems of linear equations.

/// x of A x = b for a symmetric positive definite A, by elimination; `None` where A is not positive definite.
///
/// ```
/// let x = grouser_real::solve([[4.0, 1.0], [1.0, 3.0]], [1.0, 2.0]).unwrap();
/// assert!((x[0] - 1.0 / 11.0).abs() < 1e-15 && (x[1] - 7.0 / 11.0).abs() < 1e-15);
/// assert!(grouser_real::solve([[1.0, 2.0], [2.0, 1.0]], [1.0, 1.0]).is_none());
/// ```
#[must_use]
pub fn solve<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> Option<[f64; N]> {
    for k in 0..N {
        if !(a[k][k] > 0.0) {
            return None;
        }
        for i in k + 1..N {
            let factor = a[i][k] / a[k][k];
            let (above, below) = a.split_at_mut(i);
            for (slot, pivot) in below[0][k..].iter_mut().zip(&above[k][k..]) {
                *slot -= factor * pivot;
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..N).rev() {
        for j in k + 1..N {
            b[k] -= a[k][j] * b[j];
        }
        b[k] /= a[k][k];
    }
    Some(b)
}
