//! Sinkages of a chunk under given loads.
//!
//! The unknown is x = ln θ_1, in which ln W is nearly a straight line of slope 2n + 1. Every point takes the
//! same way, so that none depends on its neighbours: Bekker's closed form, two steps by the coarsest rule
//! (its forces are good to 1e-3), then, sorted by the rule that each needs, two steps by a coarse rule, one
//! evaluation by the fine one, and from there along slopes that are known by then. Where the last way was
//! too long to go straight, the lane goes on by the fine rule alone.
//!
//! Slopes are those of ln W, DP/W and T/W: all three nearly straight.

use grouser_real::Real;

use crate::contact::ladder::Step;
use crate::contact::lean::{
    LeanContact, MAX_SINKAGE_PER_RADIUS, MIN_SINKAGE_PER_RADIUS, NARROW_FRONT_SHARE, Three, horner,
    versine,
};
use crate::quadrature::RuleView;

use crate::status::SolveStatus;

use super::columns::{BatchColumns, Inputs};
use super::curve::Smooth;
use super::plan::{Chunk, Group, Plan, Prepared, SINGLE_STEP, step_of, within};
use super::sheet::{Column, eight};
use super::vector::Vector;

/// ln(sin θ/θ)/θ² in θ² up to 60°, by interpolation at Chebyshev's points: error of the logarithm 6e-13.
const LN_SINC: [f64; 7] = [
    -0.166_666_666_667_140_72,
    -0.005_555_555_513_363_298,
    -0.000_352_734_296_579_332_17,
    -2.645_173_079_632_859e-5,
    -2.146_185_420_192_768e-6,
    -1.695_223_514_013_141e-7,
    -2.235_365_509_119_691_6e-8,
];

/// ln θ_1 at the least and the greatest sinkage of the lanes.
const MIN_LN_THETA_1: f64 = -3.507;
const MAX_LN_THETA_1: f64 = 0.0461;

/// Where a lane may end: residual ln(W/load) times the last step in ln θ_1. The slopes were found over that
/// step, on which they change by no more than its own length, so this bounds the error of going straight.
const STRAIGHT_RESIDUAL: f64 = 2e-10;
/// Most further passes of the fine rule.
const MAX_FINE_PASSES: usize = 6;

/// What does not depend on sinkage, and the state of the search.
pub(super) struct LoadSheet {
    points: [Column; 6],
    x: Column,
    per_slope: Column,
    /// ln(W/load), DP/W and T/(r W) at the coarse rule's first place, and that place.
    first: [Column; 4],
    /// The slopes of DP/W and T/(r W), and the last step.
    slopes: [Column; 3],
    /// Where the search of each point ended, if that is kept: x, dx/d ln W and the two slopes.
    pub(super) kept: [Column; 4],
}

impl LoadSheet {
    pub(super) const EMPTY: Self = Self {
        points: [Column::EMPTY; 6],
        x: Column::EMPTY,
        per_slope: Column::EMPTY,
        first: [Column::EMPTY; 4],
        slopes: [Column::EMPTY; 3],
        kept: [Column::EMPTY; 4],
    };
}

/// Eight points without their sinkage.
struct Loaded<V> {
    q: V,
    r_over_k: V,
    /// 1 − clamp(c_1 + c_2 s, 0, 1): front over θ_1.
    ahead: V,
    /// ln of r b k (r · ahead)ⁿ · ahead/load.
    scale: V,
    /// r b c/load.
    hold: V,
}

/// Points before their search and before their slip.
#[derive(Clone, Copy)]
struct Base<V: Vector> {
    r_over_k: V,
    /// ln of r b k rⁿ/load
    bare: V,
    hold: V,
    sound: V::Mask,
    x: V,
}

/// Points before their search.
struct Begun<V: Vector> {
    loaded: Loaded<V>,
    sound: V::Mask,
    /// ln θ_1 by Bekker's closed form.
    x: V,
}

impl<V: Vector> Base<V> {
    /// Points by radius, width, rebound ratio and load.
    #[inline(always)]
    fn new(prepared: &Prepared, [radius, width, rebound, load]: [V; 4]) -> Self {
        let c = V::from_f64;
        let n = prepared.n;
        let modulus = prepared.modulus(width);
        // With a rebound the force may fall with sinkage: that search is not for lanes.
        let sound = within(radius, 1e-3, 100.0)
            & within(width, 1e-3, 100.0)
            & within(rebound, 0.0, 0.0)
            & within(load, f64::MIN_POSITIVE, 1e12)
            & V::ZERO.lt(modulus);
        let area = radius * width / load;
        let bare = c(n).mul_add(radius.ln(), (area * modulus).ln());
        // Bekker: W = b k rⁿ⁺¹ θ_1²ⁿ⁺¹ (3 − n)/3 · 2⁻ⁿ
        let shape = (3.0 - n).max(0.5) / 3.0;
        let shape = Real::ln(shape) - n * core::f64::consts::LN_2;
        Self {
            r_over_k: radius * c(prepared.per_k_shear),
            bare,
            hold: area * c(prepared.cohesion),
            sound,
            x: -(bare + c(shape)) * c(prepared.per_slope()),
        }
    }

    /// These points at a slip.
    #[inline(always)]
    fn at(&self, prepared: &Prepared, slip: V) -> Begun<V> {
        let c = V::from_f64;
        let position = slip.mul_add(c(prepared.laws.c_2), c(prepared.laws.c_1));
        let ahead = V::ONE - position.clamp(V::ZERO, V::ONE);
        Begun {
            loaded: Loaded {
                q: V::ONE - slip,
                r_over_k: self.r_over_k,
                ahead,
                scale: c(prepared.n + 1.0).mul_add(ahead.ln(), self.bare),
                hold: self.hold,
            },
            sound: self.sound
                & within(slip, 0.0, 1.0)
                & position.lt(c(1.0 - NARROW_FRONT_SHARE * prepared.n)),
            x: self.x,
        }
    }
}

/// Forces over the load at a place.
struct Found<V> {
    /// ln(W/load)
    off: V,
    /// DP/W
    pull: V,
    /// T/(r W)
    turn: V,
}

impl<V: Vector> Loaded<V> {
    #[inline(always)]
    fn gather(sheet: &LoadSheet, places: &[u16; 8]) -> Self {
        let [q, r_over_k, ahead, scale, hold, _] = &sheet.points;
        Self {
            q: q.gather(places),
            r_over_k: r_over_k.gather(places),
            ahead: ahead.gather(places),
            scale: scale.gather(places),
            hold: hold.gather(places),
        }
    }

    #[inline(always)]
    fn load(sheet: &LoadSheet, at: usize) -> Self {
        let [q, r_over_k, ahead, scale, hold, _] = &sheet.points;
        Self {
            q: q.load(at),
            r_over_k: r_over_k.load(at),
            ahead: ahead.load(at),
            scale: scale.load(at),
            hold: hold.load(at),
        }
    }

    /// The contact at x, and the scales of friction and cohesion.
    #[inline(always)]
    fn contact(&self, prepared: &Prepared, x: V) -> (LeanContact<V>, V, V) {
        let theta_1 = x.exp();
        let front = self.ahead * theta_1;
        let contact = LeanContact {
            theta_1,
            behind: V::ZERO,
            front,
            rear: theta_1 - front,
            q: self.q,
            r_over_k: self.r_over_k,
        };
        let y = theta_1 * theta_1;
        let ln_sin_theta = y.mul_add(horner(y, &LN_SINC), x + x);
        let stress = V::from_f64(prepared.n).mul_add(ln_sin_theta, self.scale);
        (contact, stress.exp() * theta_1, self.hold * theta_1)
    }

    #[inline(always)]
    fn forces(&self, prepared: &Prepared, rules: (RuleView<'_>, RuleView<'_>), x: V) -> Three<V> {
        let (contact, stress, hold) = self.contact(prepared, x);
        let sums = V::sums(&contact, rules, &prepared.tables.power);
        sums.forces(stress, V::from_f64(prepared.tan_phi), hold)
    }

    #[inline(always)]
    fn found(&self, prepared: &Prepared, rules: (RuleView<'_>, RuleView<'_>), x: V) -> Found<V> {
        let f = self.forces(prepared, rules, x);
        let per_load = V::ONE / f.vertical_force;
        Found {
            off: f.vertical_force.ln(),
            pull: f.drawbar_pull * per_load,
            turn: f.torque * per_load,
        }
    }
}

/// dx/dy of a secant where it rises, else what was known before.
#[inline(always)]
fn secant<V: Vector>(dx: V, dy: V, before: V) -> V {
    let slope = dx / dy;
    V::select(V::ZERO.lt(slope), slope, before)
}

#[inline(always)]
fn held<V: Vector>(x: V) -> V {
    x.clamp(V::from_f64(MIN_LN_THETA_1), V::from_f64(MAX_LN_THETA_1))
}

/// Where the searches of a chunk begin, and by which rules they end.
#[derive(Clone, Copy)]
pub(super) struct Start<'a> {
    /// Where their neighbours on a curve say: points that differ in nothing but slip. Else Bekker's closed form.
    pub(super) expected: Option<&'a Smooth>,
    /// Points through which a curve is interpolated: all take one rule, and [`LoadSheet::kept`] is filled.
    pub(super) nodes: bool,
}

impl Start<'_> {
    /// Each point by itself.
    pub(super) const ALONE: Self = Self {
        expected: None,
        nodes: false,
    };
}

/// Solves every point that the lanes serve; the plan holds the others, and a search that left its range is
/// given back as not converged.
#[inline(always)]
pub(super) fn run<V: Vector>(chunk: &mut Chunk<'_>, sheet: &mut LoadSheet, start: Start<'_>) {
    let Chunk {
        prepared,
        inputs,
        plan,
        out,
    } = chunk;
    let Start { expected, nodes } = start;
    match expected {
        Some(smooth) => interpolate::<V>(prepared, inputs, (sheet, plan), (smooth, nodes)),
        None => search::<V>(prepared, inputs, (sheet, plan), nodes),
    }
    for group in plan.groups() {
        finish::<V>(prepared, inputs, (sheet, group), out, nodes);
    }
}

/// From Bekker's closed form to where the fine rule begins.
#[inline(always)]
fn search<V: Vector>(
    prepared: &Prepared,
    inputs: &Inputs<'_>,
    (sheet, plan): (&mut LoadSheet, &mut Plan),
    one_rule: bool,
) {
    let n = inputs.len();
    for at in (0..n).step_by(8) {
        set_up::<V>(prepared, inputs, (sheet, plan), at);
    }
    let first = prepared.tables.first_rules();
    // Two steps; the first leaves its place and residual for the second's secant.
    for at in (0..n).step_by(8) {
        let x: V = sheet.x.load(at);
        let force = Loaded::load(sheet, at).forces(prepared, first, x);
        let off = force.vertical_force.ln();
        let next = held(x - off * sheet.per_slope.load(at));
        sheet.first[0].store(at, off);
        sheet.first[3].store(at, x);
        sheet.x.store(at, next);
    }
    for at in (0..n).step_by(8) {
        let x: V = sheet.x.load(at);
        let force = Loaded::load(sheet, at).forces(prepared, first, x);
        let off = force.vertical_force.ln();
        let (dx, dy) = (x - sheet.first[3].load(at), off - sheet.first[0].load(at));
        let per_slope = secant(dx, dy, sheet.per_slope.load(at));
        sheet.x.store(at, held(x - off * per_slope));
        sheet.per_slope.store(at, per_slope);
    }
    for at in (0..n).step_by(8) {
        choose::<V>(sheet, plan, at);
    }
    if one_rule {
        plan.level(n);
    }
    plan.sort(n);
    for group in plan.groups() {
        let rules = prepared.tables.coarse_rules(group.step);
        let x: V = sheet.x.gather(group.places);
        let found = Loaded::gather(sheet, group.places).found(prepared, rules, x);
        let next = held(x - found.off * sheet.per_slope.gather(group.places));
        let [off, pull, turn, place] = &mut sheet.first;
        off.store(group.at, found.off);
        pull.store(group.at, found.pull);
        turn.store(group.at, found.turn);
        place.store(group.at, x);
        sheet.slopes[2].store(group.at, next);
    }
    for group in plan.groups() {
        let rules = prepared.tables.coarse_rules(group.step);
        let x: V = sheet.slopes[2].load(group.at);
        let found = Loaded::gather(sheet, group.places).found(prepared, rules, x);
        let [off, pull, turn, place] = &mut sheet.first;
        let step = x - place.load(group.at);
        let known = V::from_f64(1e-10).lt(step.abs());
        let per_step = V::select(known, V::ONE / step, V::ZERO);
        let before = sheet.per_slope.gather(group.places);
        let per_slope = V::select(
            known,
            secant(step, found.off - off.load(group.at), before),
            before,
        );
        sheet.slopes[0].store(group.at, (found.pull - pull.load(group.at)) * per_step);
        sheet.slopes[1].store(group.at, (found.turn - turn.load(group.at)) * per_step);
        // a step too short for a slope counts as a long one
        sheet.slopes[2].store(group.at, V::select(known, step, V::ONE));
        off.store(group.at, per_slope);
        place.store(group.at, held(x - found.off * per_slope));
    }
}

/// From the interpolated curve to where the fine rule begins.
#[inline(always)]
fn interpolate<V: Vector>(
    prepared: &Prepared,
    inputs: &Inputs<'_>,
    (sheet, plan): (&mut LoadSheet, &mut Plan),
    (smooth, one_rule): (&Smooth, bool),
) {
    let shared = [inputs.radius, inputs.width, inputs.rebound, inputs.given];
    let base = Base::<V>::new(prepared, shared.map(|column| V::from_f64(column[0])));
    for at in (0..inputs.len()).step_by(8) {
        let slip = eight::<V>(inputs.slip, at);
        keep((sheet, plan), &base.at(prepared, slip), at);
        let [x, rest @ ..] = smooth.at(slip);
        sheet.x.store(at, held(x));
        for (column, x) in sheet.kept.iter_mut().zip(rest) {
            column.store(at, x);
        }
        choose::<V>(sheet, plan, at);
    }
    if one_rule {
        plan.level(inputs.len());
    }
    plan.sort(inputs.len());
    for group in plan.groups() {
        let (at, places) = (group.at, group.places);
        sheet.first[0].store(at, sheet.kept[0].gather::<V>(places));
        sheet.first[3].store(at, sheet.x.gather::<V>(places));
        sheet.slopes[0].store(at, sheet.kept[1].gather::<V>(places));
        sheet.slopes[1].store(at, sheet.kept[2].gather::<V>(places));
        sheet.slopes[2].store(at, V::from_f64(smooth.slope_error));
    }
}

/// Eight points in their natural order: what does not depend on sinkage, and where to begin.
#[inline(always)]
fn set_up<V: Vector>(
    prepared: &Prepared,
    inputs: &Inputs<'_>,
    (sheet, plan): (&mut LoadSheet, &mut Plan),
    at: usize,
) {
    let base = Base::<V>::new(
        prepared,
        [
            eight(inputs.radius, at),
            eight(inputs.width, at),
            eight(inputs.rebound, at),
            eight(inputs.given, at),
        ],
    );
    let begun = base.at(prepared, eight(inputs.slip, at));
    keep((sheet, plan), &begun, at);
    sheet.x.store(at, held(begun.x));
    sheet.per_slope.store(at, V::from_f64(prepared.per_slope()));
}

/// Writes what does not depend on sinkage into the sheet.
#[inline(always)]
fn keep<V: Vector>((sheet, plan): (&mut LoadSheet, &mut Plan), begun: &Begun<V>, at: usize) {
    let Begun { loaded, sound, .. } = begun;
    let kept = [
        loaded.q,
        loaded.r_over_k,
        loaded.ahead,
        loaded.scale,
        loaded.hold,
        V::select(*sound, V::ONE, V::ZERO),
    ];
    for (column, x) in sheet.points.iter_mut().zip(kept) {
        column.store(at, x);
    }
    V::from_f64(SINGLE_STEP).store(&mut plan.steps, at);
}

/// The step of eight points, from a sinkage that is known to 1e-3.
#[inline(always)]
fn choose<V: Vector>(sheet: &LoadSheet, plan: &mut Plan, at: usize) {
    let c = V::from_f64;
    let x: V = sheet.x.load(at);
    let [q, r_over_k, _, _, _, sound] = &sheet.points;
    // a shade deeper, so that the rule still serves where the search ends
    let theta_1 = x.exp() * c(1.005);
    let deepest = versine(theta_1);
    let stiffness = stiffness(theta_1, deepest, q.load(at), r_over_k.load(at));
    let good = V::ZERO.lt(sound.load::<V>(at))
        & within(
            deepest,
            1.05 * MIN_SINKAGE_PER_RADIUS,
            0.99 * MAX_SINKAGE_PER_RADIUS,
        );
    let step = V::select(good, step_of(stiffness), c(SINGLE_STEP));
    step.store(&mut plan.steps, at);
}

/// r θ_1 max|1 − q cos θ|/K.
#[inline(always)]
fn stiffness<V: Vector>(theta_1: V, z_over_r: V, q: V, r_over_k: V) -> V {
    let fastest = V::ONE - q * (V::ONE - z_over_r);
    r_over_k * V::from_f64(core::f64::consts::LN_2) * theta_1 * fastest
}

/// The fine rule's evaluation, further ones where they are needed, and the outcomes.
#[inline(always)]
fn finish<V: Vector>(
    prepared: &Prepared,
    inputs: &Inputs<'_>,
    (sheet, group): (&mut LoadSheet, Group<'_>),
    out: &mut BatchColumns<'_>,
    keep: bool,
) {
    let c = V::from_f64;
    let at = group.at;
    let rules = prepared.tables.rules(group.step);
    let loaded = Loaded::<V>::gather(sheet, group.places);
    let mut per_slope: V = sheet.first[0].load(at);
    let mut x: V = sheet.first[3].load(at);
    let mut slopes: [V; 2] = [sheet.slopes[0].load(at), sheet.slopes[1].load(at)];
    let mut step: V = sheet.slopes[2].load(at);
    let mut found = loaded.found(prepared, rules, x);
    for _ in 0..MAX_FINE_PASSES {
        let open = !((found.off * step).abs().le(c(STRAIGHT_RESIDUAL)));
        if !V::any(open) {
            break;
        }
        let next = held(x - found.off * per_slope);
        let again = loaded.found(prepared, rules, next);
        let dx = next - x;
        let per_step = V::ONE / dx;
        per_slope = V::select(
            open,
            secant(dx, again.off - found.off, per_slope),
            per_slope,
        );
        slopes = [
            V::select(open, (again.pull - found.pull) * per_step, slopes[0]),
            V::select(open, (again.turn - found.turn) * per_step, slopes[1]),
        ];
        step = V::select(open, dx, step);
        x = V::select(open, next, x);
        found = Found {
            off: V::select(open, again.off, found.off),
            pull: V::select(open, again.pull, found.pull),
            turn: V::select(open, again.turn, found.turn),
        };
    }
    let dx = -found.off * per_slope;
    if keep {
        let ended = [x + dx, per_slope, slopes[0], slopes[1]].map(V::to_array);
        for (column, ended) in sheet.kept.iter_mut().zip(ended) {
            for (&place, x) in group.places.iter().zip(ended) {
                column.0[usize::from(place)] = x;
            }
        }
    }
    let theta_1 = (x + dx).exp();
    let z_over_r = versine(theta_1);
    let stiffness = stiffness(theta_1, z_over_r, loaded.q, loaded.r_over_k);
    let served = step_of(stiffness).le(step_number(group.step));
    let fits = (found.off * step).abs().le(c(STRAIGHT_RESIDUAL))
        & found.off.abs().le(c(1e-4))
        & within(z_over_r, MIN_SINKAGE_PER_RADIUS, MAX_SINKAGE_PER_RADIUS)
        & served;
    let fits = V::select(fits, V::ONE, V::ZERO).to_array();
    let pull = slopes[0].mul_add(dx, found.pull).to_array();
    let turn = slopes[1].mul_add(dx, found.turn).to_array();
    let z_over_r = z_over_r.to_array();
    for (k, &place) in group.places.iter().enumerate().take(group.count) {
        let place = usize::from(place);
        let (radius, load) = (inputs.radius[place], inputs.given[place]);
        if fits[k] > 0.0 {
            let numbers = [
                z_over_r[k] * radius,
                load,
                pull[k] * load,
                turn[k] * load * radius,
            ];
            out.set(place, SolveStatus::Solved, numbers);
        } else {
            out.set(place, SolveStatus::NotConverged, [f64::NAN; 4]);
        }
    }
}

#[inline(always)]
fn step_number<V: Vector>(step: Step) -> V {
    V::from_f64(f64::from(u32::try_from(step.index()).unwrap_or(u32::MAX)))
}
