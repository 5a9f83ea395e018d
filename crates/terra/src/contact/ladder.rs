//! Which smooth rule serves a contact, and what one sinkage exponent prepares for it.

use grouser_real::Real;

use crate::quadrature::{
    LEGENDRE_2, LEGENDRE_6, LEGENDRE_8, LEGENDRE_10, LEGENDRE_16, LEGENDRE_20, LEGENDRE_32,
    MAX_NODES, Rule, RuleView, gauss_jacobi,
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

/// How closely a contact is integrated.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Closeness {
    /// The coarsest of all, for a start: good to some 1e-3 of the forces.
    First,
    /// For the beginning of a search: good to some 1e-5 of the forces.
    Coarse(Step),
    /// As the ladder has it.
    Fine(Step),
}

impl Closeness {
    /// How many nodes the friction's rule has, and the cohesion's rule.
    fn rules(self) -> (usize, RuleView<'static>) {
        match self {
            Self::First => (2, LEGENDRE_2.view()),
            Self::Coarse(Step(0)) => (4, LEGENDRE_6.view()),
            Self::Coarse(Step(1)) => (5, LEGENDRE_8.view()),
            Self::Coarse(Step(finer)) => Self::Fine(Step(finer - 1)).rules(),
            Self::Fine(Step(0)) => (6, LEGENDRE_8.view()),
            Self::Fine(Step(1)) => (8, LEGENDRE_10.view()),
            Self::Fine(Step(2)) => (12, LEGENDRE_16.view()),
            Self::Fine(Step(3)) => (16, LEGENDRE_20.view()),
            Self::Fine(_) => (MAX_NODES, LEGENDRE_32.view()),
        }
    }
}

/// What one sinkage exponent prepares: Gauss-Jacobi rules and the power of the lean kernel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ExponentTables {
    rules: (
        Rule<2>,
        Rule<4>,
        Rule<5>,
        Rule<6>,
        Rule<8>,
        Rule<12>,
        Rule<16>,
        Rule<MAX_NODES>,
    ),
    /// ((y + 3)/4)ⁿ in powers of y = 4·ratio − 3 for ratio in [½, 1]. In the raw ratio the coefficients
    /// would alternate and lose digits.
    power: [f64; POWER_TERMS],
}

/// The rules of a contact whose exponent all lanes share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SharedRules<'a> {
    pub(crate) friction: RuleView<'a>,
    pub(crate) cohesion: RuleView<'static>,
    pub(crate) power: &'a [f64; POWER_TERMS],
}

/// The rules of contacts of which each lane has its own exponent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneRules<R> {
    pub(crate) count: usize,
    pub(crate) nodes: [R; MAX_NODES],
    pub(crate) weights: [R; MAX_NODES],
    pub(crate) cohesion: RuleView<'static>,
    pub(crate) power: [R; POWER_TERMS],
}

impl<R: Real> LaneRules<R> {
    /// Rules of nothing yet.
    #[inline(always)]
    pub(crate) fn empty() -> Self {
        Self {
            count: 0,
            nodes: [R::ZERO; MAX_NODES],
            weights: [R::ZERO; MAX_NODES],
            cohesion: LEGENDRE_2.view(),
            power: [R::ZERO; POWER_TERMS],
        }
    }

    /// Becomes those of exponents at a closeness, but for the power.
    #[inline(always)]
    pub(crate) fn set_rules(&mut self, n: R, closeness: Closeness) {
        (self.count, self.cohesion) = closeness.rules();
        let (nodes, weights) = (&mut self.nodes, &mut self.weights);
        gauss_jacobi(n, &mut nodes[..self.count], &mut weights[..self.count]);
    }

    /// The power becomes that of exponents.
    #[inline(always)]
    pub(crate) fn set_power(&mut self, n: R) {
        self.power = power_polynomial(n);
    }
}

impl ExponentTables {
    /// Those of an exponent. Each thread keeps the last ones, since draws of a soil and designs on it mostly share the
    /// exponent, and the tables cost as much as two solves.
    pub(crate) fn with_exponent(n: f64) -> Self {
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
            rules: (
                Rule::jacobi(n),
                Rule::jacobi(n),
                Rule::jacobi(n),
                Rule::jacobi(n),
                Rule::jacobi(n),
                Rule::jacobi(n),
                Rule::jacobi(n),
                Rule::jacobi(n),
            ),
            power: power_polynomial(n),
        }
    }

    /// The rules at a closeness.
    pub(crate) fn at(&self, closeness: Closeness) -> SharedRules<'_> {
        let (count, cohesion) = closeness.rules();
        let rules = &self.rules;
        let friction = match count {
            2 => rules.0.view(),
            4 => rules.1.view(),
            5 => rules.2.view(),
            6 => rules.3.view(),
            8 => rules.4.view(),
            12 => rules.5.view(),
            16 => rules.6.view(),
            _ => rules.7.view(),
        };
        SharedRules {
            friction,
            cohesion,
            power: &self.power,
        }
    }

    /// The (friction, cohesion) rules of a step.
    pub(crate) fn rules(&self, step: Step) -> (RuleView<'_>, RuleView<'static>) {
        let rules = self.at(Closeness::Fine(step));
        (rules.friction, rules.cohesion)
    }
}

/// ((y + 3)/4)ⁿ as a sum of Chebyshev polynomials, in powers of y. The function's singularity at y = −3 makes
/// the coefficients fall by 5.8 a term: 13 terms leave less than 2e-11 for n in [0.1, 3].
///
/// Its differential equation (y + 3) f′ = n f gives (k − 1 − n) a_{k−1} + 6k a_k + (k + 1 + n) a_{k+1} = 0. With
/// a_k = n (n − 1) … (n + 1 − k) d_{k+1} the falling solution is d_k = 6k d_{k+1} + (n + 1 + k) (n − k) d_{k+2}, the last ones
/// first and without a division, so that a whole n is nothing special; f(1) = 1 gives its size.
#[inline(always)]
fn power_polynomial<R: Real>(n: R) -> [R; POWER_TERMS] {
    let c = R::from_f64;
    let mut terms = [R::ONE; POWER_TERMS];
    let (mut d, mut behind) = (R::ONE, R::ZERO);
    let mut k = POWER_TERMS;
    while k > 0 {
        let kf = c(k as f64);
        let next = (c(6.0) * kf).mul_add(d, (n + R::ONE + kf) * (n - kf) * behind);
        (behind, d) = (d, next);
        k -= 1;
        // d_{k+1}
        terms[k] = d;
    }
    terms[0] = c(0.5) * terms[0];
    let (mut falling, mut sum) = (R::ONE, terms[0]);
    for (k, term) in terms.iter_mut().enumerate().skip(1) {
        falling *= n + R::ONE - c(k as f64);
        *term *= falling;
        sum += *term;
    }
    let scale = R::ONE / sum;
    let mut out = [R::ZERO; POWER_TERMS];
    for (j, term) in terms.iter().enumerate() {
        let term = scale * *term;
        // those of even degree are even, the others odd
        let mut k = j % 2;
        while k <= j {
            out[k] += c(CHEBYSHEV[j][k]) * term;
            k += 2;
        }
    }
    out
}

/// Chebyshev's polynomials in powers of y, by their recurrence.
const CHEBYSHEV: [[f64; POWER_TERMS]; POWER_TERMS] = {
    let mut rows = [[0.0; POWER_TERMS]; POWER_TERMS];
    rows[0][0] = 1.0;
    rows[1][1] = 1.0;
    let mut j = 2;
    while j < POWER_TERMS {
        let mut k = 0;
        while k < POWER_TERMS {
            let raised = if k > 0 { rows[j - 1][k - 1] } else { 0.0 };
            rows[j][k] = 2.0 * raised - rows[j - 2][k];
            k += 1;
        }
        j += 1;
    }
    rows
};

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

    #[test]
    fn the_least_step_that_serves() {
        let step =
            |stiffness: f64, theta_1: f64| Step::for_stiffness(stiffness, theta_1).map(Step::index);
        for (k, limit) in LIMITS.into_iter().enumerate() {
            assert_eq!(step(limit, 0.5), Some(k));
            let next = Some(k + 1).filter(|next| *next < 5);
            assert_eq!(step(limit.next_up(), 0.5), next);
            assert_eq!(Step::at(k).finer().map(Step::index), next);
            assert_eq!(Step::at(k).index(), k);
        }
        assert_eq!(Step::at(9), Step::at(4));
        assert_eq!(step(f64::NAN, 0.5), None);
        // the sines of a deep contact
        let shallow = SHALLOW_ENTRY_RAD;
        assert_eq!(
            (step(1.0, shallow), step(1.0, shallow.next_up())),
            (Some(0), Some(1))
        );
        assert_eq!(step(10.0, 1.2), Some(2));
    }

    /// Nodes of the friction's and of the cohesion's rule.
    #[test]
    fn coarse_rules_are_a_step_behind() {
        let tables = ExponentTables::with_exponent(0.8);
        let of = |closeness: Closeness| {
            let rules = tables.at(closeness);
            (rules.friction.nodes.len(), rules.cohesion.nodes.len())
        };
        assert_eq!(of(Closeness::First), (2, 2));
        let fine = [(6, 8), (8, 10), (12, 16), (16, 20), (MAX_NODES, 32)];
        let coarse = [(4, 6), (5, 8), fine[1], fine[2], fine[3]];
        for (k, (fine, coarse)) in fine.into_iter().zip(coarse).enumerate() {
            assert_eq!(of(Closeness::Fine(Step(k))), fine);
            assert_eq!(of(Closeness::Coarse(Step(k))), coarse);
        }
    }
}
