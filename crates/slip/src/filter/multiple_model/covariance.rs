//! Does a matrix hold variances that can be?

use grouser_real::Real;

/// Less than this share of a variance is rounding, by which a difference of products is off by some 1e-16 of it; with less
/// left, the state does not hold the noise.
const ROUNDING_SHARE: f64 = 1e-9;

/// Cholesky's decomposition: is it positive beyond rounding, where it is not 0?
pub(super) fn is_covariance<const N: usize>(matrix: &[[f64; N]; N]) -> bool {
    let mut root = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| root[i][k] * root[j][k]).sum();
            let left = matrix[i][j] - known;
            if i != j {
                root[i][j] = if root[j][j] > 0.0 {
                    left / root[j][j]
                } else {
                    0.0
                };
            } else if left > ROUNDING_SHARE * matrix[i][i] {
                root[i][i] = Real::sqrt(left);
            } else if matrix[i][i] != 0.0 {
                return false;
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::is_covariance;

    #[test]
    fn variances_that_can_be() {
        // the product of a triangle of roots and its transpose: 2; −1 3; 4 5 6
        let square = [[4.0, -2.0, 8.0], [-2.0, 10.0, 11.0], [8.0, 11.0, 77.0]];
        assert!(is_covariance(&square));
        // without the last root, with less than nothing of it, and with hardly any
        for (left, can_be) in [(0.0, false), (-1.0, false), (1e-8, false), (1e-6, true)] {
            let mut less = square;
            less[2][2] = 41.0 + left;
            assert_eq!(is_covariance(&less), can_be, "{left}");
        }
        assert!(!is_covariance(&[[-1.0, 0.0], [0.0, 1.0]]));
        assert!(!is_covariance(&[[1.0, 2.0], [2.0, 1.0]]));
        assert!(!is_covariance(&[[f64::NAN]]));
        // what is known for certain
        assert!(is_covariance(&[[0.0, 0.0], [0.0, 3.0]]));
        assert!(is_covariance(&[[3.0, 0.0], [0.0, 0.0]]));
    }
}
