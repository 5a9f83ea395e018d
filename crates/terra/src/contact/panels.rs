//! Integration where one smooth rule will not do: panel by panel.

use grouser_real::{Real, Scalar};

use super::breakpoints::{Breakpoints, Detail};
use super::integrals::{Integrals, Nodes, Order};
use super::{Contact, ContactAngles};
use crate::quadrature::{LEGENDRE_16, LEGENDRE_32, RuleView};

/// How often a panel may be halved: 2⁻¹⁶ of a piece is below every scale on which the direction of a
/// stress that matters still turns.
const HALVINGS: u32 = 16;

/// The two pieces of the normal stress.
#[derive(Clone, Copy)]
pub(crate) enum Piece {
    /// From the greatest stress to the entry.
    Front,
    /// From the exit to the greatest stress.
    Rear,
}

/// A part of a piece, t = v⁴ from `from` to `to` in v; t = 0 where the stress vanishes, 1 where it is greatest. The
/// fourth power tames tⁿ wherever the part lies.
#[derive(Clone, Copy)]
pub(crate) struct Panel {
    pub(crate) piece: Piece,
    from: f64,
    to: f64,
}

impl Panel {
    /// A piece without a cut.
    pub(crate) const WHOLE: Self = Self {
        piece: Piece::Front,
        from: 0.0,
        to: 1.0,
    };

    /// t and its weight at a node of a rule.
    #[inline(always)]
    pub(crate) fn place<R: Real>(&self, x: R, weight: R) -> (R, R) {
        let length = R::from_f64(self.to - self.from);
        let v = R::from_f64(self.from) + length * x;
        let cube = v * v * v;
        (cube * v, weight * length * R::from_f64(4.0) * cube)
    }

    /// Both halves.
    fn halves(self) -> [Self; 2] {
        let middle = 0.5 * (self.from + self.to);
        [
            Self { to: middle, ..self },
            Self {
                from: middle,
                ..self
            },
        ]
    }
}

/// The rule of a panel, and how well it must agree with itself where panels are halved.
#[derive(Clone, Copy)]
struct Method<'a> {
    rule: RuleView<'a>,
    tolerance: Option<f64>,
}

impl<R: Scalar> Contact<R> {
    /// Both pieces cut wherever the shear changes sign or its growth, each part by a Gauss-Legendre rule.
    pub(super) fn split(&self, order: Order, nodes: &impl Nodes<R>) -> Integrals<R> {
        let (rule, detail) = match order {
            Order::Simulation | Order::Standard => (LEGENDRE_16.view(), Detail::Standard),
            Order::Check => (LEGENDRE_32.view(), Detail::Standard),
            Order::Reference => (LEGENDRE_32.view(), Detail::Fine),
            Order::Beyond => (LEGENDRE_32.view(), Detail::Finer),
        };
        let breaks = Breakpoints::new(self, detail);
        let swings = self.shear.swings(self.arc());
        let tolerance = swings.then(|| {
            let relative = match detail {
                Detail::Standard => 1e-11,
                Detail::Fine | Detail::Finer => 1e-15,
            };
            // a stress that is hardly mobilised has no digits of the whole strength
            let mobilised = self.shear.stiffness(self.arc()).min(1.0);
            let strength = R::from_f64(mobilised) * self.strength_at(self.angles.theta_m);
            // a strength below the smallest normal number has no such digits to agree on
            (relative * (strength * self.arc()).value()).max(f64::MIN_POSITIVE)
        });
        let method = Method { rule, tolerance };
        let front = (self.angles.theta_1 - self.angles.theta_m).value();
        let rear = (self.angles.theta_m - self.angles.theta_2).value();
        let mut sum = Integrals::zero();
        if front > 0.0 {
            let cuts = breaks.as_slice().iter().map(|w| w / front);
            self.add_piece(&mut sum, Piece::Front, cuts, (method, nodes));
        }
        if rear > 0.0 {
            let cuts = breaks
                .as_slice()
                .iter()
                .rev()
                .map(|w| 1.0 - (w - front) / rear);
            self.add_piece(&mut sum, Piece::Rear, cuts, (method, nodes));
        }
        sum.add_jumps(self);
        sum
    }

    /// One piece, cut at those of the ascending `cuts` that lie inside it.
    fn add_piece(
        &self,
        sum: &mut Integrals<R>,
        piece: Piece,
        cuts: impl Iterator<Item = f64>,
        (method, nodes): (Method<'_>, &impl Nodes<R>),
    ) {
        let fourth_root = |t: f64| Real::sqrt(Real::sqrt(t));
        let mut from = 0.0;
        for cut in cuts.filter(|t| *t < 1.0).chain([1.0]) {
            // of a cut before the piece it is NaN
            let to = fourth_root(cut);
            if to > from {
                let panel = Panel { piece, from, to };
                let whole = nodes.panel(self, panel, method.rule);
                match method.tolerance {
                    None => sum.merge(&whole),
                    Some(tolerance) => {
                        let found = (panel, whole);
                        self.add_halving(sum, found, (method.rule, tolerance, nodes), HALVINGS);
                    }
                }
                from = to;
            }
        }
    }

    /// A panel halved until the rule agrees with itself on both halves.
    fn add_halving<N: Nodes<R>>(
        &self,
        sum: &mut Integrals<R>,
        (panel, whole): (Panel, Integrals<R>),
        by: (RuleView<'_>, f64, &N),
        halvings: u32,
    ) {
        let (rule, tolerance, nodes) = by;
        let parts = panel
            .halves()
            .map(|part| (part, nodes.panel(self, part, rule)));
        let both = |of: fn(&Integrals<R>) -> R| of(&parts[0].1) + of(&parts[1].1);
        let off = (whole.tau - both(|i| i.tau)).value().abs()
            + (whole.tau_side - both(|i| i.tau_side)).value().abs();
        for part in parts {
            if halvings == 0 || off <= tolerance {
                sum.merge(&part.1);
            } else {
                self.add_halving(sum, part, by, halvings - 1);
            }
        }
    }
}

impl<R: Real> Integrals<R> {
    /// A node of a part of a piece.
    #[inline(always)]
    pub(crate) fn add_part(&mut self, contact: &Contact<R>, piece: Piece, t: R, weight: R) {
        let ContactAngles {
            theta_1,
            theta_2,
            theta_m,
        } = contact.angles;
        let front = theta_1 - theta_m;
        let rear = theta_m - theta_2;
        let (w, weight) = match piece {
            Piece::Front => (t * front, weight * front),
            Piece::Rear => (theta_1 - (theta_2 + t * rear), weight * rear),
        };
        let sigma = contact.sigma(t * front);
        let strength = contact.cohesion + sigma * contact.tan_phi;
        self.add(contact, w, weight * sigma, weight * strength);
    }
}
