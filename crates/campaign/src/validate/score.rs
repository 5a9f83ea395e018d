//! How far predictions lie from measurements.

/// Errors of one quantity over several tests, model − measured.
///
/// ```
/// use grouser_campaign::validate::Score;
///
/// let score = Score::from_errors(&[0.1, -0.1, 0.3]).expect("three errors");
/// assert!((score.bias - 0.1).abs() < 1e-12 && score.max == 0.3);
/// assert_eq!(Score::from_errors(&[]), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Score {
    /// How many.
    pub n: usize,
    /// Their mean.
    pub bias: f64,
    /// The root of their mean square.
    pub rmse: f64,
    /// What three quarters of their magnitudes stay below.
    pub q75: f64,
    /// What 99 % of them stay below.
    pub q99: f64,
    /// The greatest magnitude.
    pub max: f64,
}

impl Score {
    /// Of `errors`; `None` where there are none.
    ///
    /// ```
    /// use grouser_campaign::validate::Score;
    ///
    /// assert_eq!(Score::from_errors(&[2.0]).map(|score| score.rmse), Some(2.0));
    /// ```
    #[must_use]
    pub fn from_errors(errors: &[f64]) -> Option<Self> {
        if errors.is_empty() {
            return None;
        }
        let count = errors.len() as f64;
        let mut sizes: Vec<f64> = errors.iter().map(|e| e.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        Some(Self {
            n: errors.len(),
            bias: errors.iter().sum::<f64>() / count,
            rmse: (errors.iter().map(|e| e * e).sum::<f64>() / count).sqrt(),
            q75: quantile(&sizes, 0.75),
            q99: quantile(&sizes, 0.99),
            max: sizes.last().copied().unwrap_or(f64::NAN),
        })
    }

    /// The same in another unit, `scale` of the present one to one of it.
    ///
    /// ```
    /// use grouser_campaign::validate::Score;
    ///
    /// let metres = Score::from_errors(&[0.001, -0.002]).expect("two errors");
    /// assert!((metres.in_unit(1e-3).max - 2.0).abs() < 1e-12); // mm
    /// ```
    #[must_use]
    pub fn in_unit(&self, scale: f64) -> Self {
        Self {
            n: self.n,
            bias: self.bias / scale,
            rmse: self.rmse / scale,
            q75: self.q75 / scale,
            q99: self.q99 / scale,
            max: self.max / scale,
        }
    }
}

/// By straight lines between the ordered values (Hyndman & Fan's type 7).
fn quantile(ordered: &[f64], share: f64) -> f64 {
    let place = share * (ordered.len() - 1) as f64;
    let below = place.floor();
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a place in the slice"
    )]
    let index = below as usize;
    let next = ordered[(index + 1).min(ordered.len() - 1)];
    ordered[index] + (place - below) * (next - ordered[index])
}

/// The standard deviation of `values` about the mean of their group, pooled over the groups that `key` makes;
/// `None` where no group has two.
pub(crate) fn pooled<K: PartialEq>(values: &[(K, f64)]) -> Option<f64> {
    let (mut squares, mut freedom) = (0.0, 0_usize);
    let mut done: Vec<&K> = Vec::new();
    for (key, _) in values {
        if done.contains(&key) {
            continue;
        }
        done.push(key);
        let group: Vec<f64> = values
            .iter()
            .filter(|(other, _)| other == key)
            .map(|(_, value)| *value)
            .collect();
        let mean = group.iter().sum::<f64>() / group.len() as f64;
        squares += group.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        freedom += group.len() - 1;
    }
    (freedom > 0).then(|| (squares / freedom as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_score_by_hand() {
        let score = Score::from_errors(&[1.0, -3.0, 2.0, 0.0, -5.0]).unwrap();
        assert_eq!((score.n, score.bias, score.max), (5, -1.0, 5.0));
        assert!((score.rmse - (39.0_f64 / 5.0).sqrt()).abs() < 1e-15);
        // magnitudes 0 1 2 3 5: q75 at place 3
        assert_eq!(score.q75, 3.0);
        assert!((score.q99 - (3.0 + 0.96 * 2.0)).abs() < 1e-12);
        assert_eq!(Score::from_errors(&[]), None);
    }

    #[test]
    fn repeats_are_pooled() {
        let values = [("a", 1.0), ("b", 5.0), ("a", 3.0), ("b", 5.0), ("c", 9.0)];
        // a: deviations ±1 (one degree of freedom), b: 0 (one), c: none
        assert_eq!(pooled(&values), Some(1.0));
    }
}
