//! Searches in one number: a root between two places of opposite sign, the places at which a peak is sought.

use crate::error::Result;

/// Two places, each with its value, of opposite sign or zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bracket {
    pub(crate) from: (f64, f64),
    pub(crate) to: (f64, f64),
    /// The root is found to this.
    pub(crate) tolerance: f64,
}

/// Most evaluations: a bracket of 2 is halved to 1e-12 of it in 41.
const MAX_EVALUATIONS: u32 = 100;

/// The method of Anderson and Björck: regula falsi whose retained end is scaled, with a bisection where three steps
/// did not halve the bracket.
///
/// Source: Anderson & Björck 1973, "A new high order method of regula falsi type", BIT 13.
pub(crate) fn root(bracket: Bracket, f: impl Fn(f64) -> Result<f64>) -> Result<f64> {
    let ((mut a, mut f_a), (mut b, mut f_b)) = (bracket.from, bracket.to);
    if f_a == 0.0 {
        return Ok(a);
    }
    let mut width = (b - a).abs();
    for evaluation in 0..MAX_EVALUATIONS {
        if f_b == 0.0 || (b - a).abs() <= bracket.tolerance {
            break;
        }
        let bisect = evaluation % 3 == 2 && (b - a).abs() > 0.5 * width;
        if evaluation % 3 == 2 {
            width = (b - a).abs();
        }
        let x = if bisect {
            0.5 * (a + b)
        } else {
            (a * f_b - b * f_a) / (f_b - f_a)
        };
        let f_x = f(x)?;
        if f_x.is_nan() {
            return Ok(f64::NAN);
        }
        if (x - b).abs() <= 0.1 * bracket.tolerance {
            return Ok(x);
        }
        if f_x * f_b < 0.0 {
            (a, f_a) = (b, f_b);
        } else {
            let m = 1.0 - f_x / f_b;
            f_a *= if m > 0.0 { m } else { 0.5 };
        }
        (b, f_b) = (x, f_x);
    }
    Ok(b)
}

/// The two places inside of a bracket at which a golden-section search for a peak evaluates.
pub(crate) fn golden_section(low: f64, high: f64) -> [f64; 2] {
    // (√5 − 1)/2
    const GOLDEN_SHARE: f64 = 0.618_033_988_749_894_8;
    let step = GOLDEN_SHARE * (high - low);
    [high - step, low + step]
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    #[test]
    fn roots_of_smooth_and_of_square_root_like_functions() {
        for (f, low, high, expected) in [
            ((|x| x * x - 2.0) as fn(f64) -> f64, 0.0, 2.0, 2_f64.sqrt()),
            (|x| (x - 0.3).cbrt(), -1.0, 1.0, 0.3),
            (|x| x.exp() - 1.5, 0.0, 1.0, 1.5_f64.ln()),
        ] {
            let bracket = Bracket {
                from: (low, f(low)),
                to: (high, f(high)),
                tolerance: 1e-12,
            };
            let found = root(bracket, |x| Ok(f(x))).unwrap();
            assert!((found - expected).abs() < 1e-10, "{found} for {expected}");
        }
    }
}
