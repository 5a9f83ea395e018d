//! How many readings in a row count as one.

/// (1 + ρ)/(1 − ρ) with ρ the correlation of neighbouring residuals within each series, at least 1 and at most a quarter
/// of the number of readings.
///
/// Source: Bayley & Hammersley, J. Royal Statistical Society Supplement 8 (1946).
pub(crate) fn redundancy(series: impl Iterator<Item = impl Iterator<Item = f64>>) -> f64 {
    let (mut products, mut squares, mut count) = (0.0, 0.0, 0.0);
    for residuals in series {
        let mut before = None;
        for residual in residuals {
            products += before.map_or(0.0, |before| before * residual);
            squares += residual * residual;
            count += 1.0;
            before = Some(residual);
        }
    }
    if !(squares > 0.0) {
        return 1.0;
    }
    let rho = (products / squares).clamp(0.0, 1.0);
    ((1.0 + rho) / (1.0 - rho).max(1e-12)).clamp(1.0, f64::max(0.25 * count, 1.0))
}
