//! Integration where one smooth rule will not do: panel by panel.

use grouser_real::{Real, Scalar};

use super::breakpoints::{Breakpoints, Detail};
use super::integrals::{Integrals, Order};
use super::{Contact, ContactAngles};
use crate::quadrature::{LEGENDRE_16, LEGENDRE_32, RuleView};

/// How often a panel may be halved: 2⁻¹⁶ of a piece is below every scale on which the direction of a
/// stress that matters still turns.
const HALVINGS: u32 = 16;

/// The two pieces of the normal stress.
#[derive(Clone, Copy)]
enum Piece {
    /// From the greatest stress to the entry.
    Front,
    /// From the exit to the greatest stress.
    Rear,
}

/// A part of a piece, t from `from` to `to`; t = 0 where the stress vanishes, 1 where it is greatest.
#[derive(Clone, Copy)]
struct Panel {
    piece: Piece,
    from: f64,
    to: f64,
}

/// The rule of a panel, and how well it must agree with itself where panels are halved.
#[derive(Clone, Copy)]
struct Method<'a> {
    rule: RuleView<'a>,
    tolerance: Option<f64>,
}

impl<R: Scalar> Integrals<R> {
    /// Both pieces cut wherever the shear changes sign or its growth, each part by a Gauss-Legendre rule
    /// in v with t = v⁴, which tames tⁿ wherever the part lies. Returns the number of nodes.
    pub(super) fn add_split(&mut self, contact: &Contact<R>, order: Order) -> usize {
        let (rule, detail) = match order {
            Order::Standard => (LEGENDRE_16.view(), Detail::Standard),
            Order::Check => (LEGENDRE_32.view(), Detail::Standard),
            Order::Reference => (LEGENDRE_32.view(), Detail::Fine),
            Order::Beyond => (LEGENDRE_32.view(), Detail::Finer),
        };
        let breaks = Breakpoints::of(contact, detail);
        let tolerance = contact.shear.swings(contact.arc()).then(|| {
            let relative = if detail == Detail::Standard {
                1e-11
            } else {
                1e-15
            };
            let strength = contact.strength_at(contact.angles.theta_m);
            relative * (strength * contact.arc()).value()
        });
        let method = Method { rule, tolerance };
        let front = (contact.angles.theta_1 - contact.angles.theta_m).value();
        let rear = (contact.angles.theta_m - contact.angles.theta_2).value();
        let mut nodes = 0;
        if front > 0.0 {
            let cuts = breaks.as_slice().iter().map(|w| w / front);
            nodes += self.add_piece(contact, Piece::Front, cuts, method);
        }
        if rear > 0.0 {
            let cuts = breaks
                .as_slice()
                .iter()
                .rev()
                .map(|w| 1.0 - (w - front) / rear);
            nodes += self.add_piece(contact, Piece::Rear, cuts, method);
        }
        self.add_jumps(contact);
        nodes
    }

    /// One piece, cut at those of the ascending `cuts` that lie inside it.
    fn add_piece(
        &mut self,
        contact: &Contact<R>,
        piece: Piece,
        cuts: impl Iterator<Item = f64>,
        method: Method<'_>,
    ) -> usize {
        let (mut from, mut nodes) = (0.0, 0);
        for to in cuts.filter(|t| *t < 1.0).chain([1.0]) {
            if to > from {
                let panel = Panel { piece, from, to };
                nodes += match method.tolerance {
                    None => self.add_panel(contact, panel, method.rule),
                    Some(_) => self.add_halving(contact, panel, method, HALVINGS),
                };
                from = to;
            }
        }
        nodes
    }

    /// A panel halved until the rule agrees with itself on both halves. Returns the number of nodes.
    fn add_halving(
        &mut self,
        contact: &Contact<R>,
        panel: Panel,
        method: Method<'_>,
        halvings: u32,
    ) -> usize {
        let (mut whole, mut halves) = (Self::zero(), Self::zero());
        let middle = 0.5 * (panel.from + panel.to);
        let parts = [
            Panel {
                to: middle,
                ..panel
            },
            Panel {
                from: middle,
                ..panel
            },
        ];
        let mut nodes = whole.add_panel(contact, panel, method.rule);
        for part in parts {
            nodes += halves.add_panel(contact, part, method.rule);
        }
        let off = (whole.tau - halves.tau).value().abs()
            + (whole.tau_side - halves.tau_side).value().abs();
        if halvings == 0 || method.tolerance.is_none_or(|tolerance| off <= tolerance) {
            self.merge(&halves);
            return nodes;
        }
        for part in parts {
            nodes += self.add_halving(contact, part, method, halvings - 1);
        }
        nodes
    }

    /// One panel by one rule. Returns the number of nodes.
    fn add_panel(&mut self, contact: &Contact<R>, panel: Panel, rule: RuleView<'_>) -> usize {
        let ContactAngles {
            theta_1,
            theta_2,
            theta_m,
        } = contact.angles;
        let front = theta_1 - theta_m;
        let rear = theta_m - theta_2;
        let fourth_root = |t: f64| Real::sqrt(Real::sqrt(t));
        let (v_a, v_b) = (fourth_root(panel.from), fourth_root(panel.to));
        for (x, weight) in rule.iter() {
            let v = v_a + (v_b - v_a) * x;
            let t = R::from_f64(v * v * v * v);
            let weight = R::from_f64(weight * (v_b - v_a) * 4.0 * v * v * v);
            let (w, weight) = match panel.piece {
                Piece::Front => (t * front, weight * front),
                Piece::Rear => (theta_1 - (theta_2 + t * rear), weight * rear),
            };
            let sigma = contact.sigma(t * front);
            let strength = contact.cohesion + sigma * contact.tan_phi;
            self.add(contact, w, weight * sigma, weight * strength);
        }
        rule.nodes.len()
    }
}
