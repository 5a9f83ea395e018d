//! Student's t.

use grouser_real::Real;

/// The quantile of Student's distribution: the t that a variable with `freedom` degrees of freedom stays
/// below with probability `p`. NaN outside 0 < p < 1 and for no freedom.
///
/// By Newton's method on the distribution function, which is a regularised incomplete beta function
/// (continued fraction by Lentz; Abramowitz & Stegun 26.5.8 and 26.7.1).
///
/// ```
/// use grouser_identify::least_squares::student_quantile;
/// // tables: t(0.975, 10) = 2.228139
/// assert!((student_quantile(0.975, 10.0) - 2.228_138_85).abs() < 1e-7);
/// ```
#[must_use]
pub fn student_quantile(p: f64, freedom: f64) -> f64 {
    if !(p > 0.0 && p < 1.0 && freedom > 0.0) {
        return f64::NAN;
    }
    if p < 0.5 {
        return -student_quantile(1.0 - p, freedom);
    }
    // Bracketed, then halved: the function is monotone and this is not in any loop.
    let (mut low, mut high) = (0.0, 1.0);
    while distribution(high, freedom) < p && high < 1e300 {
        high *= 2.0;
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if distribution(middle, freedom) < p {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// P(T < t) for t ≥ 0.
fn distribution(t: f64, freedom: f64) -> f64 {
    let x = freedom / (freedom + t * t);
    1.0 - 0.5 * incomplete_beta(x, 0.5 * freedom, 0.5)
}

/// I_x(a, b).
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    let front = Real::exp(
        log_gamma(a + b) - log_gamma(a) - log_gamma(b) + a * Real::ln(x) + b * Real::ln(1.0 - x),
    );
    if x < (a + 1.0) / (a + b + 2.0) {
        front * fraction(x, a, b) / a
    } else {
        1.0 - front * fraction(1.0 - x, b, a) / b
    }
}

fn fraction(x: f64, a: f64, b: f64) -> f64 {
    const MIN_DENOMINATOR: f64 = 1e-300;
    let away = |value: f64| {
        if value.abs() < MIN_DENOMINATOR {
            MIN_DENOMINATOR
        } else {
            value
        }
    };
    let mut c = 1.0;
    let mut d = 1.0 / away(1.0 - (a + b) * x / (a + 1.0));
    let mut h = d;
    for m in 1..500 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / away(1.0 + even * d);
        c = away(1.0 + even / c);
        h *= d * c;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / away(1.0 + odd * d);
        c = away(1.0 + odd / c);
        let change = d * c;
        h *= change;
        if (change - 1.0).abs() < 1e-16 {
            break;
        }
    }
    h
}

/// ln Γ(x) for x > 0: Stirling's series after the recurrence has carried x above 12.
fn log_gamma(x: f64) -> f64 {
    let (mut x, mut shift) = (x, 0.0);
    while x < 12.0 {
        shift -= Real::ln(x);
        x += 1.0;
    }
    let y = 1.0 / (x * x);
    let series = (1.0 / 12.0 - y * (1.0 / 360.0 - y * (1.0 / 1260.0 - y / 1680.0))) / x;
    shift + (x - 0.5) * Real::ln(x) - x + 0.5 * Real::ln(2.0 * core::f64::consts::PI) + series
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tabled_quantiles() {
        // two-sided 95 % and 99 % points of any table of t
        for (p, freedom, t) in [
            (0.975, 1.0, 12.706_204_74),
            (0.975, 2.0, 4.302_652_73),
            (0.975, 30.0, 2.042_272_46),
            (0.995, 5.0, 4.032_142_98),
            (0.975, 1e6, 1.959_966_36),
        ] {
            let found = student_quantile(p, freedom);
            assert!((found - t).abs() < 2e-8 * t.max(1.0), "{freedom}: {found}");
        }
        assert_eq!(student_quantile(0.025, 7.0), -student_quantile(0.975, 7.0));
        assert!(student_quantile(1.0, 7.0).is_nan() && student_quantile(0.9, 0.0).is_nan());
    }
}
