//! Student's t.

use grouser_real::Real;

/// The median size of a standard normal number.
pub(crate) const NORMAL_MEDIAN_SIZE: f64 = 0.674_489_750_196_081_7;

/// The quantile of Student's distribution: the t that a variable with `freedom` degrees of freedom stays
/// below with probability `p`. NaN outside 0 < p < 1 and for no freedom.
///
/// ```
/// use grouser_identify::least_squares::student_quantile;
/// // tables: t(0.975, 10) = 2.228139
/// assert!((student_quantile(0.975, 10) - 2.228_138_85).abs() < 1e-7);
/// ```
#[must_use]
pub fn student_quantile(p: f64, freedom: usize) -> f64 {
    if !(p < 1.0) || freedom == 0 {
        return f64::NAN;
    }
    if p < 0.5 {
        return -student_quantile(1.0 - p, freedom);
    }
    // the probability rises with the angle, which is bracketed and halved down to rounding
    let (mut low, mut high) = (0.0, core::f64::consts::FRAC_PI_2);
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if within(middle, freedom) < 2.0 * p - 1.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    (freedom as f64).sqrt() * Real::tan(low)
}

/// P(|T| < t) with t = √ν tan θ, a finite sum. Source: Abramowitz & Stegun 26.7.3 and 26.7.4.
fn within(theta: f64, freedom: usize) -> f64 {
    let (sin, cos) = Real::sin_cos(theta);
    let is_odd = freedom % 2 == 1;
    let mut term = if is_odd { cos } else { 1.0 };
    let mut sum = 0.0;
    for power in (2 + freedom % 2..=freedom).step_by(2) {
        sum += term;
        term *= cos * cos * (power - 1) as f64 / power as f64;
    }
    if is_odd {
        (theta + sin * sum) * core::f64::consts::FRAC_2_PI
    } else {
        sin * sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tabled_quantiles() {
        // two-sided 95 % and 99 % points of any table of t
        for (p, freedom, t) in [
            (0.975, 1, 12.706_204_74),
            (0.975, 2, 4.302_652_73),
            (0.975, 30, 2.042_272_46),
            (0.995, 5, 4.032_142_98),
            (0.975, 1_000_000, 1.959_966_36),
        ] {
            let found = student_quantile(p, freedom);
            assert!((found - t).abs() < 2e-8 * t.max(1.0), "{freedom}: {found}");
        }
        assert_eq!(student_quantile(0.025, 7), -student_quantile(0.975, 7));
        assert!(student_quantile(1.0, 7).is_nan() && student_quantile(0.9, 0).is_nan());
    }
}
