//! Rules of integration on [0, 1], without allocation.

mod jacobi;
mod legendre;

pub(crate) use jacobi::{MAX_NODES, gauss_jacobi};
use legendre::gauss_legendre;

/// Nodes and weights on [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rule<const N: usize> {
    pub(crate) nodes: [f64; N],
    pub(crate) weights: [f64; N],
}

impl<const N: usize> Rule<N> {
    /// The Gauss-Jacobi rule for the weight tⁿ.
    pub(crate) fn jacobi(n: f64) -> Self {
        let (mut nodes, mut weights) = ([0.0; N], [0.0; N]);
        gauss_jacobi(n, &mut nodes, &mut weights);
        Self { nodes, weights }
    }

    /// The rule as a slice of nodes and one of weights, whatever its length.
    pub(crate) fn view(&self) -> RuleView<'_> {
        RuleView {
            nodes: &self.nodes,
            weights: &self.weights,
        }
    }
}

/// A rule of any length, in one kind of number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RuleView<'a, R = f64> {
    pub(crate) nodes: &'a [R],
    pub(crate) weights: &'a [R],
}

impl RuleView<'_> {
    /// Pairs of node and weight.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.nodes.iter().copied().zip(self.weights.iter().copied())
    }
}

/// The Gauss-Legendre rules in use.
pub(crate) static LEGENDRE_2: Rule<2> = gauss_legendre();
pub(crate) static LEGENDRE_6: Rule<6> = gauss_legendre();
pub(crate) static LEGENDRE_8: Rule<8> = gauss_legendre();
pub(crate) static LEGENDRE_10: Rule<10> = gauss_legendre();
pub(crate) static LEGENDRE_16: Rule<16> = gauss_legendre();
pub(crate) static LEGENDRE_20: Rule<20> = gauss_legendre();
pub(crate) static LEGENDRE_32: Rule<32> = gauss_legendre();
