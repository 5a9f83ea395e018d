//! Polynomial mutation: a small random change of single variables, within the bounds.
//!
//! Source: Deb & Goyal 1996; the bounded form of Deb's NSGA-II code.

use grouser_real::Real;

use crate::random::Random;

/// How often and how far variables change.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Mutation {
    /// Distribution index η: greater is a smaller change.
    pub eta: f64,
    /// The probability for each variable; `None` for 1/n.
    pub probability: Option<f64>,
}

impl Mutation {
    /// Mutation of distribution index `eta`, in [0, 1000], of one variable in each point on average.
    ///
    /// ```
    /// let mut mutation = grouser_opt::Mutation::new(15.0);
    /// mutation.probability = Some(0.1); // each variable once in ten points
    /// assert_eq!(mutation.eta, 15.0);
    /// ```
    #[must_use]
    pub const fn new(eta: f64) -> Self {
        let probability = None;
        Self { eta, probability }
    }
}

/// Mutates `x` in place; returns whether anything changed.
pub(super) fn mutate(
    mutation: Mutation,
    random: &mut Random,
    (lower, upper): (&[f64], &[f64]),
    x: &mut [f64],
) -> bool {
    let probability = mutation.probability.unwrap_or(1.0 / x.len().max(1) as f64);
    let mut changed = false;
    for i in 0..x.len() {
        if random.uniform() < probability {
            changed |= change(mutation.eta, random, (lower[i], upper[i]), &mut x[i]);
        }
    }
    changed
}

/// Mutates one variable.
pub(super) fn change(
    eta: f64,
    random: &mut Random,
    (lower, upper): (f64, f64),
    x: &mut f64,
) -> bool {
    let width = upper - lower;
    if !(width > 0.0) {
        return false;
    }
    let u = random.uniform();
    let power = eta + 1.0;
    let delta = if u < 0.5 {
        let room = 1.0 - (*x - lower) / width;
        Real::powf(
            2.0 * u + (1.0 - 2.0 * u) * Real::powf(room, power),
            1.0 / power,
        ) - 1.0
    } else {
        let room = 1.0 - (upper - *x) / width;
        1.0 - Real::powf(
            2.0 * (1.0 - u) + 2.0 * (u - 0.5) * Real::powf(room, power),
            1.0 / power,
        )
    };
    let before = *x;
    *x = (*x + delta * width).clamp(lower, upper);
    *x != before
}
