//! One operating point with its nodes side by side: a lane is a node.

use grouser_real::Real;

use crate::contact::ladder::{ExponentTables, POWER_TERMS, Step};
use crate::contact::lean::{
    GREATEST_SINKAGE, LEAST_SINKAGE, LeanContact, LeanSums, Three, versine,
};

use super::forces::Placed;
use super::load::{Base, HIGH, LOW, Loaded, STRAIGHT, stiffness};
use super::plan::Prepared;
use super::vector::Vector;

/// Most nodes of a friction rule, and of the upper half of a cohesion rule.
const FRICTION: usize = 24;
const COHESION: usize = 16;

/// Evaluations before a search is left to the general solver; one or two are what it takes from the last
/// solution, five from nothing.
const PASSES: u32 = 12;

/// The rules of one step, filled up to whole vectors with nodes that weigh nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeRule {
    t: [f64; FRICTION],
    four_per_t: [f64; FRICTION],
    t_weight: [f64; FRICTION],
    /// Distance from the middle of the arc, as its share.
    x: [f64; COHESION],
    x_weight: [f64; COHESION],
    /// How many nodes count.
    friction: usize,
    cohesion: usize,
}

impl NodeRule {
    fn new(tables: &ExponentTables, step: Step) -> Self {
        let (friction, cohesion) = tables.rules(step);
        let mut rule = Self {
            t: [0.5; FRICTION],
            four_per_t: [8.0; FRICTION],
            t_weight: [0.0; FRICTION],
            x: [0.25; COHESION],
            x_weight: [0.0; COHESION],
            friction: friction.nodes.len(),
            cohesion: cohesion.nodes.len() / 2,
        };
        for (k, (t, weight)) in friction.iter().enumerate() {
            rule.t[k] = t;
            rule.four_per_t[k] = 4.0 / t;
            rule.t_weight[k] = weight;
        }
        for (k, (x, weight)) in cohesion.iter().skip(rule.cohesion).enumerate() {
            rule.x[k] = x - 0.5;
            rule.x_weight[k] = weight;
        }
        rule
    }

    /// Those of every step.
    pub(super) fn all(tables: &ExponentTables) -> [Self; Step::COUNT] {
        core::array::from_fn(|step| Self::new(tables, Step::at(step)))
    }

    /// Each lane's part of the sums.
    #[inline(always)]
    fn sums<V: Vector>(&self, contact: LeanContact<V>, power: &[f64; POWER_TERMS]) -> LeanSums<V> {
        let frame = contact.frame();
        let mut sums = LeanSums::zero();
        for at in (0..self.friction).step_by(8) {
            frame.friction(
                V::load(&self.t, at),
                V::load(&self.four_per_t, at),
                V::load(&self.t_weight, at),
                power,
                &mut sums,
            );
        }
        for at in (0..self.cohesion).step_by(8) {
            frame.cohesion(V::load(&self.x, at), V::load(&self.x_weight, at), &mut sums);
        }
        frame.finish(&mut sums);
        sums
    }
}

/// Sum of the lanes.
#[inline(always)]
fn total<V: Vector>(x: V) -> f64 {
    let [a, b, c, d, e, f, g, h] = x.to_array();
    ((a + e) + (b + f)) + ((c + g) + (d + h))
}

#[inline(always)]
fn totals<V: Vector>(f: &Three<V>) -> [f64; 3] {
    [
        total(f.vertical_force),
        total(f.drawbar_pull),
        total(f.torque),
    ]
}

/// What a single wheel is computed with.
pub(super) struct Single<'a> {
    pub(super) prepared: &'a Prepared,
    pub(super) rules: &'a [NodeRule; Step::COUNT],
    pub(super) radius: f64,
    pub(super) width: f64,
    pub(super) rebound: f64,
    pub(super) slip: f64,
}

/// Vertical force, drawbar pull and torque/r at a sinkage over radius; `None` where this is not for lanes.
#[inline(always)]
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a step is 0 to 5"
)]
pub(super) fn forces<V: Vector>(single: &Single<'_>, z_over_r: f64) -> Option<[f64; 3]> {
    let inputs = [
        single.radius,
        single.width,
        single.rebound,
        single.slip,
        z_over_r,
    ];
    let placed = Placed::<V>::new(single.prepared, inputs.map(V::from_f64));
    let rule = single.rules.get(placed.step.to_array()[0] as usize)?;
    let sums = rule.sums(placed.contact, &single.prepared.tables.power);
    let tan_phi = V::from_f64(single.prepared.tan_phi);
    Some(totals(&sums.forces(placed.stress, tan_phi, placed.hold)))
}

/// Where the last search ended, for the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Track {
    load: f64,
    slip: f64,
    /// ln θ_1
    x: f64,
    /// dx/d ln W
    per_slope: f64,
    /// Slopes of DP/W and T/(r W) in x.
    slopes: [f64; 2],
    /// How far in x and slip the slopes were found from here.
    apart: f64,
    /// dx/ds under the same load.
    per_slip: f64,
}

/// What a search gives: z/r, DP/W and T/(r W).
pub(super) struct Carried {
    pub(super) z_over_r: f64,
    pub(super) pull: f64,
    pub(super) turn: f64,
    pub(super) evaluations: u32,
}

/// ln(W/load), DP/W and T/(r W).
struct Ratios {
    off: f64,
    pull: f64,
    turn: f64,
}

/// The search under a load, from where the last one ended; `None` where this is not for lanes or the
/// search did not end, and the general solver is to be asked.
#[inline(always)]
pub(super) fn under_load<V: Vector>(
    single: &Single<'_>,
    load: f64,
    track: &mut Option<Track>,
) -> Option<Carried> {
    let inputs = [single.radius, single.width, single.rebound, load];
    let begun = Base::new(single.prepared, inputs.map(V::from_f64))
        .at(single.prepared, V::from_f64(single.slip));
    if V::any(!begun.sound) {
        return None;
    }
    let mut now = match track {
        Some(last) => last.moved(load, single.slip),
        None => Track {
            load,
            slip: single.slip,
            x: begun.x.to_array()[0],
            per_slope: single.prepared.per_slope(),
            slopes: [0.0; 2],
            apart: 1.0,
            per_slip: 0.0,
        },
    };
    now.x = now.x.clamp(LOW, HIGH);
    let guess = now.x;
    let mut found = ratios(single, &begun.loaded, now.x)?;
    let mut evaluations = 1;
    while !((found.off * now.apart).abs() <= STRAIGHT) {
        if evaluations >= PASSES {
            return None;
        }
        let next = (now.x - found.off * now.per_slope).clamp(LOW, HIGH);
        let again = ratios(single, &begun.loaded, next)?;
        evaluations += 1;
        let dx = next - now.x;
        let slope = (again.off - found.off) / dx;
        if slope > 0.0 {
            now.per_slope = 1.0 / slope;
        }
        now.slopes = [
            (again.pull - found.pull) / dx,
            (again.turn - found.turn) / dx,
        ];
        now.apart = dx.abs();
        now.x = next;
        found = again;
    }
    let dx = -found.off * now.per_slope;
    now.x += dx;
    let z_over_r = versine(Real::exp(now.x));
    let inside = (LEAST_SINKAGE..=GREATEST_SINKAGE).contains(&z_over_r);
    if !(inside && found.off.abs() <= 1e-4) {
        return None;
    }
    if let Some(last) = track {
        let ds = single.slip - last.slip;
        if ds.abs() > 1e-9 {
            // what the guess missed is put down to the slip
            now.per_slip = last.per_slip + (now.x - guess) / ds;
        }
    }
    *track = Some(now);
    Some(Carried {
        z_over_r,
        pull: found.pull + now.slopes[0] * dx,
        turn: found.turn + now.slopes[1] * dx,
        evaluations,
    })
}

impl Track {
    /// Expected at another load and slip.
    fn moved(&self, load: f64, slip: f64) -> Self {
        let ratio = load / self.load;
        let grown = if (0.9..1.1).contains(&ratio) {
            // ln to 4e-5, which the search makes good
            let x = (ratio - 1.0) / (ratio + 1.0);
            2.0 * x * (1.0 + x * x / 3.0)
        } else {
            Real::ln(ratio)
        };
        let by = self.per_slope * grown + self.per_slip * (slip - self.slip);
        Self {
            load,
            slip,
            x: self.x + by,
            apart: self.apart + by.abs() + (slip - self.slip).abs(),
            ..*self
        }
    }
}

/// One evaluation by the rule that the place asks for.
#[inline(always)]
fn ratios<V: Vector>(single: &Single<'_>, loaded: &Loaded<V>, x: f64) -> Option<Ratios> {
    let prepared = single.prepared;
    let (contact, stress, hold) = loaded.contact(prepared, V::from_f64(x));
    // a shade deeper, so that the rule still serves where the search ends
    let theta_1 = contact.theta_1 * V::from_f64(1.005);
    let asked = stiffness(theta_1, versine(theta_1), loaded.q, loaded.r_over_k);
    let step = Step::for_stiffness(asked.to_array()[0], 1.0)?;
    let sums = single.rules[step.index()].sums(contact, &prepared.tables.power);
    let [force, pull, turn] = totals(&sums.forces(stress, V::from_f64(prepared.tan_phi), hold));
    (force > 0.0).then(|| Ratios {
        off: Real::ln(force),
        pull: pull / force,
        turn: turn / force,
    })
}
