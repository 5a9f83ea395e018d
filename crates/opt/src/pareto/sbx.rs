//! Simulated binary crossover: two children around two parents, within the bounds.
//!
//! Source: Deb & Agrawal 1995, Complex Systems 9; the bounded form of Deb's NSGA-II code. The spread factor
//! β has density ∝ β^η inside and ∝ β^−(η+2) outside the parents, cut at the bounds.

use crate::random::Random;

/// How like their parents the children are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossover {
    /// Distribution index η: greater is nearer to the parents.
    pub eta: f64,
    /// The probability that a pair is crossed at all.
    pub probability: f64,
}

/// Crosses `a` with `b`, in place.
pub(super) fn cross(
    crossover: Crossover,
    random: &mut Random,
    (lower, upper): (&[f64], &[f64]),
    a: &mut [f64],
    b: &mut [f64],
) {
    if random.uniform() >= crossover.probability {
        return;
    }
    let exponent = 1.0 / (crossover.eta + 1.0);
    for i in 0..a.len() {
        let swap = random.uniform() < 0.5;
        if random.uniform() >= 0.5 || (a[i] - b[i]).abs() <= 1e-14 {
            continue;
        }
        let (low, high) = (a[i].min(b[i]), a[i].max(b[i]));
        let u = random.uniform();
        let spread = |room: f64| {
            let beta = 1.0 + 2.0 * room / (high - low);
            let alpha = 2.0 - beta.powf(-(crossover.eta + 1.0));
            if u <= 1.0 / alpha {
                (u * alpha).powf(exponent)
            } else {
                (1.0 / (2.0 - u * alpha)).powf(exponent)
            }
        };
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let one = (middle - spread(low - lower[i]) * half).clamp(lower[i], upper[i]);
        let two = (middle + spread(upper[i] - high) * half).clamp(lower[i], upper[i]);
        (a[i], b[i]) = if swap { (two, one) } else { (one, two) };
    }
}
