//! Simulated binary crossover: two children around two parents, within the bounds.
//!
//! Source: Deb & Agrawal 1995, Complex Systems 9; the bounded form of Deb's NSGA-II code. The spread factor
//! β has density ∝ β^η inside and ∝ β^−(η+2) outside the parents, cut at the bounds.

use grouser_real::Real;

use crate::random::Random;

/// How like their parents the children are.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Crossover {
    /// Distribution index η: greater is nearer to the parents.
    pub eta: f64,
    /// The probability that a pair is crossed at all.
    pub probability: f64,
}

impl Crossover {
    /// Crossover of distribution index `eta`, in [0, 1000], applied with this probability.
    ///
    /// ```
    /// let crossover = grouser_opt::Crossover::new(20.0, 0.9);
    /// assert_eq!((crossover.eta, crossover.probability), (20.0, 0.9));
    /// ```
    #[must_use]
    pub const fn new(eta: f64, probability: f64) -> Self {
        Self { eta, probability }
    }
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
        // α = 2 − β^−(η+1): the part of the density that the bound cuts off. Far from it that is nothing, and
        // both children spread alike.
        let cut = |room: f64| {
            let beta = 1.0 + 2.0 * room / (high - low);
            2.0 - Real::powf(beta, -(crossover.eta + 1.0))
        };
        let spread = |alpha: f64| {
            if u <= 1.0 / alpha {
                Real::powf(u * alpha, exponent)
            } else {
                Real::powf(1.0 / (2.0 - u * alpha), exponent)
            }
        };
        let (alpha_one, alpha_two) = (cut(low - lower[i]), cut(upper[i] - high));
        let spread_one = spread(alpha_one);
        let spread_two = if alpha_two == alpha_one {
            spread_one
        } else {
            spread(alpha_two)
        };
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let one = (middle - spread_one * half).clamp(lower[i], upper[i]);
        let two = (middle + spread_two * half).clamp(lower[i], upper[i]);
        (a[i], b[i]) = if swap { (two, one) } else { (one, two) };
    }
}
