//! Which smooth rule serves a contact, and what one sinkage exponent prepares for it.

use grouser_real::Real;

use crate::quadrature::{
    LEGENDRE_2, LEGENDRE_6, LEGENDRE_8, LEGENDRE_10, LEGENDRE_16, LEGENDRE_20, LEGENDRE_32, Rule,
    RuleView, gauss_jacobi,
};

/// Greatest stiffness of the shear (`ShearState::stiffness`) at which each step of the ladder is good to
/// 1e-9 of the forces. Over 60 000 random contacts the first errors of 5e-10 appear at 1.4, 4.8, 18, 45
/// and 100.
pub(crate) const LIMITS: [f64; 5] = [1.2, 4.5, 16.0, 40.0, 90.0];

/// Entry angle (rad) up to which the first step is good; beyond it the sines require the second.
const SHALLOW_ENTRY_RAD: f64 = 1.048;

/// A step of the ladder of smooth rules.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Step(usize);

impl Step {
    /// How many there are.
    pub(crate) const COUNT: usize = LIMITS.len();

    /// The least step that serves; `None` where no fixed rule does.
    pub(crate) fn for_stiffness(stiffness: f64, theta_1: f64) -> Option<Self> {
        let least = usize::from(theta_1 > SHALLOW_ENTRY_RAD);
        // counted without a branch: in a batch the answer is as good as random
        let step = LIMITS
            .iter()
            .map(|limit| usize::from(!(stiffness <= *limit)))
            .sum::<usize>();
        (step < Self::COUNT).then_some(Self(step.max(least)))
    }

    /// The next finer one.
    pub(crate) fn finer(self) -> Option<Self> {
        (self.0 + 1 < Self::COUNT).then_some(Self(self.0 + 1))
    }

    /// Its place, from 0.
    pub(crate) const fn index(self) -> usize {
        self.0
    }

    /// The step at a place below [`Step::COUNT`].
    pub(crate) fn at(index: usize) -> Self {
        Self(index.min(Self::COUNT - 1))
    }
}

/// The terms of the polynomial that approximates ratioⁿ.
pub(crate) const POWER_TERMS: usize = 13;

/// What one sinkage exponent prepares: Gauss-Jacobi rules and the power of the lean kernel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ExponentTables {
    first: Rule<2>,
    coarse: (Rule<4>, Rule<5>),
    rules: (Rule<6>, Rule<8>, Rule<12>, Rule<16>, Rule<24>),
    /// ((y + 3)/4)ⁿ in powers of y = 4·ratio − 3 for ratio in [½, 1]. In the raw ratio the coefficients
    /// would alternate and lose digits.
    pub(crate) power: [f64; POWER_TERMS],
}

impl ExponentTables {
    /// Those of an exponent. Each thread keeps the last ones, since draws of a soil and designs on it mostly share the
    /// exponent, and the tables cost as much as ten solves.
    pub(crate) fn of(n: f64) -> Self {
        #[cfg(feature = "std")]
        {
            std::thread_local! {
                static LAST: core::cell::Cell<Option<(u64, ExponentTables)>> =
                    const { core::cell::Cell::new(None) };
            }
            if let Some((bits, tables)) = LAST.get()
                && bits == n.to_bits()
            {
                return tables;
            }
            let tables = Self::new(n);
            LAST.set(Some((n.to_bits(), tables)));
            tables
        }
        #[cfg(not(feature = "std"))]
        Self::new(n)
    }

    fn new(n: f64) -> Self {
        Self {
            first: gauss_jacobi(n),
            coarse: (gauss_jacobi(n), gauss_jacobi(n)),
            rules: (
                gauss_jacobi(n),
                gauss_jacobi(n),
                gauss_jacobi(n),
                gauss_jacobi(n),
                gauss_jacobi(n),
            ),
            power: power_polynomial(n),
        }
    }

    /// The coarsest of all, for a start: good to some 1e-3 of the forces.
    pub(crate) fn first_rules(&self) -> (RuleView<'_>, RuleView<'static>) {
        (self.first.view(), LEGENDRE_2.view())
    }

    /// Coarser rules for the beginning of a search: good to some 1e-5 of the forces.
    pub(crate) fn coarse_rules(&self, step: Step) -> (RuleView<'_>, RuleView<'static>) {
        match step.0 {
            0 => (self.coarse.0.view(), LEGENDRE_6.view()),
            1 => (self.coarse.1.view(), LEGENDRE_8.view()),
            finer => self.rules(Step(finer - 1)),
        }
    }

    /// The (friction, cohesion) rules of a step.
    pub(crate) fn rules(&self, step: Step) -> (RuleView<'_>, RuleView<'static>) {
        match step.0 {
            0 => (self.rules.0.view(), LEGENDRE_8.view()),
            1 => (self.rules.1.view(), LEGENDRE_10.view()),
            2 => (self.rules.2.view(), LEGENDRE_16.view()),
            3 => (self.rules.3.view(), LEGENDRE_20.view()),
            _ => (self.rules.4.view(), LEGENDRE_32.view()),
        }
    }
}

/// Interpolates ((y + 3)/4)ⁿ at Chebyshev's points of [−1, 1]. The function's singularity at y = −3 makes
/// the error fall by 5.8 a term: 13 terms leave less than 2e-11 for n in [0.1, 3].
fn power_polynomial(n: f64) -> [f64; POWER_TERMS] {
    let count = POWER_TERMS as f64;
    let angle = |k: usize| core::f64::consts::PI * (k as f64 + 0.5) / count;
    // Chebyshev coefficients by the discrete orthogonality of the cosines …
    let chebyshev: [f64; POWER_TERMS] = core::array::from_fn(|j| {
        let sum: f64 = (0..POWER_TERMS)
            .map(|k| {
                let y = Real::cos(angle(k));
                Real::powf(0.25 * (y + 3.0), n) * Real::cos(j as f64 * angle(k))
            })
            .sum();
        sum * if j == 0 { 1.0 } else { 2.0 } / count
    });
    // … and T_j in powers of y by its recurrence.
    let mut out = [0.0; POWER_TERMS];
    let (mut before, mut now) = ([0.0; POWER_TERMS], [0.0; POWER_TERMS]);
    now[0] = 1.0;
    for (j, coefficient) in chebyshev.iter().enumerate() {
        for (sum, t) in out.iter_mut().zip(now) {
            *sum += coefficient * t;
        }
        let mut next = [0.0; POWER_TERMS];
        let factor = if j == 0 { 1.0 } else { 2.0 };
        for k in 0..POWER_TERMS {
            let raised = if k > 0 { now[k - 1] } else { 0.0 };
            next[k] = factor * raised - if j == 0 { 0.0 } else { before[k] };
        }
        before = now;
        now = next;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_power_is_good_over_its_whole_range() {
        for n in [0.1, 0.5, 0.7, 1.0, 1.1, 1.6, 2.5, 3.0] {
            let c = power_polynomial(n);
            for i in 0..=200 {
                let ratio = 0.5 + 0.5 * f64::from(i) / 200.0;
                let y = 4.0 * ratio - 3.0;
                let sum = c.iter().rev().fold(0.0, |sum, c| sum * y + c);
                assert!((sum - ratio.powf(n)).abs() < 2e-11, "n {n} ratio {ratio}");
            }
        }
    }
}
