//! Samples of what is uncertain, evenly spread by a Sobol sequence.

use grouser_real::Real;

use super::normal::quantile;
use crate::error::{Error, Result};
use crate::sobol::Sobol;

/// What is known about uncertain parameters.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Uncertainty {
    /// Each anywhere between two ends, independently and uniformly.
    Ranges {
        /// The least values.
        low: Vec<f64>,
        /// The greatest values.
        high: Vec<f64>,
    },
    /// Jointly normal.
    Normal {
        /// The means.
        mean: Vec<f64>,
        /// The covariance matrix, row by row; symmetric, positive definite.
        covariance: Vec<Vec<f64>>,
    },
}

/// `count` samples, the same for the same seed.
///
/// # Errors
/// Lists of different lengths, ends in the wrong order, a number that is not finite, a covariance that
/// is not symmetric (to 1e-9 of its diagonal) or not positive definite, more than 64 parameters.
///
/// ```
/// use grouser_opt::{Uncertainty, sample};
///
/// let (low, high) = (vec![0.0, 10.0], vec![1.0, 20.0]);
/// let points = sample(&Uncertainty::Ranges { low, high }, 16, 7)?;
/// assert_eq!(points.len(), 16);
/// assert!(points.iter().all(|p| p[0] <= 1.0 && (10.0..=20.0).contains(&p[1])));
/// # Ok::<(), grouser_opt::Error>(())
/// ```
pub fn sample(uncertainty: &Uncertainty, count: usize, seed: u64) -> Result<Vec<Vec<f64>>> {
    match uncertainty {
        Uncertainty::Ranges { low, high } => {
            Error::check_length("the list of maximum values", high.len(), low.len())?;
            for (i, (&low, &high)) in low.iter().zip(high).enumerate() {
                let name = format!("parameter {}", i + 1);
                Error::check_finite("the minimum", &name, low)?;
                Error::check_finite("the maximum", &name, high)?;
                if low > high {
                    return Err(Error::InconsistentBounds {
                        name,
                        lower: low,
                        upper: high,
                    });
                }
            }
            let mut sobol = Sobol::new(low.len(), Some(seed))?;
            Ok((0..count).map(|_| sobol.next_in(low, high)).collect())
        }
        Uncertainty::Normal { mean, covariance } => {
            let factor = cholesky(mean, covariance)?;
            let mut sobol = Sobol::new(mean.len(), Some(seed))?;
            Ok((0..count)
                .map(|_| {
                    // The middle of a cell of the sequence's grid is never 0 or 1.
                    let half = 0.5 / Real::powi(2.0_f64, 32);
                    let z: Vec<f64> = sobol
                        .next_point()
                        .iter()
                        .map(|u| quantile(u + half))
                        .collect();
                    mean.iter()
                        .zip(&factor)
                        .map(|(mean, row)| {
                            mean + row.iter().zip(&z).map(|(l, z)| l * z).sum::<f64>()
                        })
                        .collect()
                })
                .collect())
        }
    }
}

/// L with covariance = L Lᵀ.
fn cholesky(mean: &[f64], covariance: &[Vec<f64>]) -> Result<Vec<Vec<f64>>> {
    const WHAT: &str = "the covariance matrix";
    let n = mean.len();
    Error::check_length(WHAT, covariance.len(), n)?;
    for (i, row) in covariance.iter().enumerate() {
        Error::check_length("a row of the covariance matrix", row.len(), n)?;
        let name = format!("parameter {}", i + 1);
        Error::check_finite("the mean", &name, mean[i])?;
        for &entry in row {
            Error::check_finite("the covariance", &name, entry)?;
        }
    }
    let mut l = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let size = (covariance[i][i] * covariance[j][j]).abs().sqrt();
            let skew = (covariance[i][j] - covariance[j][i]).abs();
            Error::check_range("the asymmetry of the covariance", skew, 0.0, 1e-9 * size)?;
            let sum = covariance[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            if i == j {
                if !(sum > 0.0) {
                    return Err(Error::NotPositiveDefinite {
                        what: WHAT,
                        pivot: i + 1,
                        value: sum,
                    });
                }
                l[i][i] = sum.sqrt();
            } else {
                l[i][j] = sum / l[j][j];
            }
        }
    }
    Ok(l)
}
