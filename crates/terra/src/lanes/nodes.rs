//! The integrals of one contact, eight nodes of a rule at a time: every law and every way of moving, since the lanes
//! run the same code as single numbers.

use crate::contact::quick::{QuickContact, QuickPart, QuickPlan};
use crate::contact::{Contact, Integrals, Nodes, Panel};
use crate::quadrature::{LEGENDRE_8, LEGENDRE_16, RuleView};

use super::machine::Level;
use super::vector::Vector;

/// Eight nodes at a time, on the best instructions of this machine.
pub(crate) struct EightNodes(Level);

impl EightNodes {
    /// On this machine.
    pub(crate) fn best() -> Self {
        Self(Level::best())
    }
}

impl EightNodes {
    /// The integrals of the quick kernel without the lost work.
    pub(crate) fn quick(&self, plan: &QuickPlan) -> Integrals<f64> {
        self.0.quick_nodes(plan)
    }

    /// Those of a part by the rule of sixteen nodes.
    pub(crate) fn quick_part(
        &self,
        contact: &QuickContact<f64>,
        part: QuickPart,
    ) -> Integrals<f64> {
        self.0.quick_part(contact, part)
    }
}

impl EightNodes {
    /// The integrals of eight contacts that differ in their entry angles, to some percent: one rule for each piece, without
    /// a cut. None of them may have a restart.
    pub(crate) fn rough(&self, contacts: &[Contact<f64>; 8]) -> [Integrals<f64>; 8] {
        self.0.rough_contacts(contacts)
    }
}

impl Nodes<f64> for EightNodes {
    fn smooth(
        &self,
        contact: &Contact<f64>,
        friction: RuleView<'_>,
        cohesion: RuleView<'_>,
    ) -> Integrals<f64> {
        self.0.smooth_nodes(contact, friction, cohesion)
    }

    fn panel(&self, contact: &Contact<f64>, panel: Panel, rule: RuleView<'_>) -> Integrals<f64> {
        self.0.panel_nodes(contact, panel, rule)
    }
}

/// [`Nodes::smooth`] on a kind of lanes.
#[inline(always)]
pub(super) fn smooth<V: Vector>(
    contact: &Contact<f64>,
    friction: RuleView<'_>,
    cohesion: RuleView<'_>,
) -> Integrals<f64> {
    let contact = contact.spread::<V>();
    let mut sum = Integrals::<V>::zero();
    for at in (0..friction.nodes.len()).step_by(8) {
        let (t, weight) = group(friction, at);
        sum.add_friction(&contact, t, weight);
    }
    if V::any(V::ZERO.lt(contact.cohesion)) {
        for at in (0..cohesion.nodes.len()).step_by(8) {
            let (x, weight) = group(cohesion, at);
            sum.add_cohesion(&contact, x, weight);
        }
    }
    total(sum)
}

/// [`Nodes::panel`] on a kind of lanes.
#[inline(always)]
pub(super) fn panel<V: Vector>(
    contact: &Contact<f64>,
    panel: Panel,
    rule: RuleView<'_>,
) -> Integrals<f64> {
    let contact = contact.spread::<V>();
    let mut sum = Integrals::<V>::zero();
    for at in (0..rule.nodes.len()).step_by(8) {
        let (x, weight) = group(rule, at);
        let (t, weight) = panel.place(x, weight);
        sum.add_part(&contact, panel.piece, t, weight);
    }
    total(sum)
}

/// [`EightNodes::rough`] on a kind of lanes.
#[inline(always)]
pub(super) fn rough<V: Vector>(contacts: &[Contact<f64>; 8]) -> [Integrals<f64>; 8] {
    let contact = contacts[0].lifted(|of| V::from_array(contacts.each_ref().map(of)));
    let mut sum = Integrals::<V>::zero();
    for (x, weight) in LEGENDRE_8.view().iter() {
        let (t, weight) = Panel::WHOLE.place(V::from_f64(x), V::from_f64(weight));
        sum.add_pieces(&contact, t, weight);
    }
    let lanes = sum.map(V::to_array);
    core::array::from_fn(|k| lanes.map(|of| of[k]))
}

/// [`EightNodes::quick`] on a kind of lanes.
#[inline(always)]
pub(super) fn quick<V: Vector>(plan: &QuickPlan) -> Integrals<f64> {
    if plan.is_whole() {
        return pieces::<V>(&plan.contact, plan.rule());
    }
    parts::<V>(&plan.contact, plan.parts(), plan.rule())
}

/// Both pieces without a cut: their nodes have the same normal stress.
#[inline(always)]
fn pieces<V: Vector>(contact: &QuickContact<f64>, rule: RuleView<'_>) -> Integrals<f64> {
    let contact = contact.spread::<V>();
    let mut sum = Integrals::<V>::zero();
    for at in (0..rule.nodes.len()).step_by(8) {
        contact.add_pieces(group(rule, at), &mut sum);
    }
    total(sum)
}

/// [`EightNodes::quick_part`] on a kind of lanes.
#[inline(always)]
pub(super) fn quick_part<V: Vector>(
    contact: &QuickContact<f64>,
    part: QuickPart,
) -> Integrals<f64> {
    parts::<V>(contact, &[part], LEGENDRE_16.view())
}

#[inline(always)]
fn parts<V: Vector>(
    contact: &QuickContact<f64>,
    parts: &[QuickPart],
    rule: RuleView<'_>,
) -> Integrals<f64> {
    let contact = contact.spread::<V>();
    let mut sum = Integrals::<V>::zero();
    for at in (0..rule.nodes.len()).step_by(8) {
        let node = group(rule, at);
        for part in parts {
            contact.add(*part, node, &mut sum);
        }
    }
    total(sum)
}

/// Eight nodes and weights of a rule from a place on; behind its end nodes at the middle without weight.
#[inline(always)]
fn group<V: Vector>(rule: RuleView<'_>, at: usize) -> (V, V) {
    let eight = |list: &[f64]| list.get(at..).and_then(<[f64]>::first_chunk).copied();
    if let (Some(nodes), Some(weights)) = (eight(rule.nodes), eight(rule.weights)) {
        return (V::from_array(nodes), V::from_array(weights));
    }
    let (mut nodes, mut weights) = ([0.5; 8], [0.0; 8]);
    let count = (rule.nodes.len() - at).min(8);
    nodes[..count].copy_from_slice(&rule.nodes[at..at + count]);
    weights[..count].copy_from_slice(&rule.weights[at..at + count]);
    (V::from_array(nodes), V::from_array(weights))
}

/// The lanes' sums, neighbours first.
#[inline(always)]
fn total<V: Vector>(integrals: Integrals<V>) -> Integrals<f64> {
    integrals.map(|lanes| {
        let [a, b, c, d, e, f, g, h] = lanes.to_array();
        ((a + b) + (c + d)) + ((e + f) + (g + h))
    })
}
