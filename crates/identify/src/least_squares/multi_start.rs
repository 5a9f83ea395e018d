//! The same fit from many starts.

use grouser_opt::{Model, Sobol};
use rayon::prelude::*;

use super::Bounded;
use super::fit::Fit;
use super::marquardt::{Settings, fit};
use crate::error::{Error, Result};

/// From where a fit is begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StartSettings {
    /// How many starts, the given one among them.
    pub starts: usize,
    /// What the others are drawn with.
    pub seed: u64,
}

impl Default for StartSettings {
    fn default() -> Self {
        Self {
            starts: 16,
            seed: 1,
        }
    }
}

/// Two fits whose costs differ by less than this share are equally good.
const SAME_COST: f64 = 1e-6;

/// The best of the fits from the given start and from points spread evenly over the bounds, and how many
/// starts ended as well as that. Where a parameter has no bounds its start is kept.
///
/// # Errors
/// As [`fit`].
///
/// ```
/// use grouser_identify::least_squares::{Bounded, Settings, StartSettings, multi_start};
/// use grouser_opt::Differences;
///
/// // sin(3 x) has several valleys; x = 1.9 lies in one of them.
/// let model = Differences::new(|p: &[f64], r: &mut [f64]| {
///     r[0] = (3.0 * p[0]).sin() - (3.0 * 1.9_f64).sin();
///     r[1] = 0.1 * (p[0] - 1.9);
/// });
/// let start = [Bounded { start: 0.1, lower: 0.0, upper: 4.0 }];
/// let (best, _) = multi_start(&model, 2, &start, &Settings::default(), &StartSettings::default())?;
/// assert!((best.x[0] - 1.9).abs() < 1e-6);
/// # Ok::<(), grouser_identify::Error>(())
/// ```
pub fn multi_start(
    model: &impl Model,
    count: usize,
    start: &[Bounded],
    settings: &Settings,
    starts: &StartSettings,
) -> Result<(Fit, usize)> {
    let mut sobol = Sobol::new(start.len(), Some(starts.seed)).map_err(|_| Error::TooMany {
        parameters: start.len(),
    })?;
    let all: Vec<Vec<Bounded>> = (0..starts.starts.max(1))
        .map(|index| {
            let unit = sobol.next_point();
            start
                .iter()
                .zip(unit)
                .map(|(bounded, u)| {
                    let width = bounded.upper - bounded.lower;
                    let inside = bounded.lower + width * (0.02 + 0.96 * u);
                    let drawn = index > 0 && width.is_finite();
                    Bounded {
                        start: if drawn { inside } else { bounded.start },
                        ..*bounded
                    }
                })
                .collect()
        })
        .collect();
    let fits = all
        .par_iter()
        .map(|start| fit(model, count, start, settings))
        .collect::<Result<Vec<Fit>>>()?;
    // ties go to the earlier start, so that the order of threads cannot matter
    let mut best = 0;
    for (index, one) in fits.iter().enumerate() {
        if one.cost < fits[best].cost {
            best = index;
        }
    }
    let least = fits[best].cost;
    let reached = fits
        .iter()
        .filter(|one| one.cost <= least * (1.0 + SAME_COST) + f64::MIN_POSITIVE)
        .count();
    let mut fits = fits;
    Ok((fits.swap_remove(best), reached))
}
