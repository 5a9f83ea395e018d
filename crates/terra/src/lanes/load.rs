//! Sinkages of a chunk under given loads.
//!
//! The unknown is x = ln θ_1, in which ln W is nearly a straight line of slope 2n + 1. Every point takes the
//! same way, so that none depends on its neighbours: Bekker's closed form, two steps by the coarsest rule
//! (its forces are good to 1e-3), then, sorted by the rule that each needs, two steps by a coarse rule, one
//! evaluation by the fine one, and from there along slopes that are known by then. Where the last way was
//! too long to go straight, the lane goes on by the fine rule alone.
//!
//! Slopes are those of ln W, DP/W and T/W: all three nearly straight.

mod searched;

use super::columns::Inputs;
use super::plan::{ABREAST, Chunk, LaneSoil, Plan, Prepared, Rules, SINGLE_STEP, step_of, within};
use super::sheet::{Column, eight};
use super::vector::Vector;
use crate::contact::ladder::Closeness;
use crate::contact::lean::{
    LeanContact, MAX_SINKAGE_PER_RADIUS, MIN_SINKAGE_PER_RADIUS, NARROW_FRONT_SHARE, estrin,
    versine,
};
use searched::Searched;

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

/// Points of the groups that are searched side by side.
const POINTS_ABREAST: usize = 8 * ABREAST;

/// What does not depend on sinkage, and the state of the search.
pub(super) struct LoadSheet {
    points: [Column; 6],
    x: Column,
    per_slope: Column,
    /// Exponent and tan φ, where each point has its own.
    soil: [Column; 2],
}

impl LoadSheet {
    pub(super) const EMPTY: Self = Self {
        points: [Column::EMPTY; 6],
        x: Column::EMPTY,
        per_slope: Column::EMPTY,
        soil: [Column::EMPTY; 2],
    };
}

/// Eight points without their sinkage.
#[derive(Clone, Copy)]
struct Loaded<V> {
    q: V,
    r_over_k: V,
    /// 1 − clamp(c_1 + c_2 s, 0, 1): front over θ_1.
    ahead: V,
    /// ln of r b k (r · ahead)ⁿ · ahead/load.
    scale: V,
    /// r b c/load.
    hold: V,
    n: V,
    tan_phi: V,
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
    fn new(
        prepared: &Prepared,
        soil: &LaneSoil<V>,
        [radius, width, rebound, load]: [V; 4],
    ) -> Self {
        let modulus = prepared.modulus(soil, width);
        // With a rebound the force may fall with sinkage: that search is not for lanes.
        let sound = within(radius, 1e-3, 100.0)
            & within(width, 1e-3, 100.0)
            & within(rebound, 0.0, 0.0)
            & within(load, f64::MIN_POSITIVE, 1e12)
            & V::ZERO.lt(modulus)
            & soil.sound;
        let area = radius * width / load;
        let bare = soil.n.mul_add(radius.ln(), (area * modulus).ln());
        // Bekker: W = b k rⁿ⁺¹ θ_1²ⁿ⁺¹ (3 − n)/3 · 2⁻ⁿ
        Self {
            r_over_k: radius * soil.per_k_shear,
            bare,
            hold: area * soil.cohesion,
            sound,
            x: -(bare + soil.shape) * soil.per_slope,
        }
    }

    /// These points at a slip.
    #[inline(always)]
    fn at(&self, prepared: &Prepared, soil: &LaneSoil<V>, slip: V) -> Begun<V> {
        let position = prepared.position(soil, slip);
        let ahead = V::ONE - position.clamp(V::ZERO, V::ONE);
        Begun {
            loaded: Loaded {
                q: V::ONE - slip,
                r_over_k: self.r_over_k,
                ahead,
                scale: (soil.n + V::ONE).mul_add(ahead.ln(), self.bare),
                hold: self.hold,
                n: soil.n,
                tan_phi: soil.tan_phi,
            },
            sound: self.sound
                & within(slip, 0.0, 1.0)
                & position.lt(V::ONE - V::from_f64(NARROW_FRONT_SHARE) * soil.n),
            x: self.x,
        }
    }
}

/// Forces over the load at a place.
#[derive(Clone, Copy)]
struct Found<V> {
    /// ln(W/load)
    off: V,
    /// DP/W
    pull: V,
    /// T/(r W)
    turn: V,
}

impl<V: Vector> Loaded<V> {
    /// Room for a group.
    #[inline(always)]
    fn nothing() -> Self {
        let zero = V::ZERO;
        Self {
            q: zero,
            r_over_k: zero,
            ahead: zero,
            scale: zero,
            hold: zero,
            n: zero,
            tan_phi: zero,
        }
    }

    #[inline(always)]
    fn gather(chunk: (&Prepared, &Inputs<'_>), sheet: &LoadSheet, places: [u8; 8]) -> Self {
        let [q, r_over_k, ahead, scale, hold, _] = &sheet.points;
        let [n, tan_phi] = chunk.0.gather(chunk.1, &sheet.soil, places);
        Self {
            q: q.gather(places),
            r_over_k: r_over_k.gather(places),
            ahead: ahead.gather(places),
            scale: scale.gather(places),
            hold: hold.gather(places),
            n,
            tan_phi,
        }
    }

    /// The contact at x, and the scales of friction and cohesion.
    #[inline(always)]
    fn contact<const SHORT: bool>(&self, x: V) -> (LeanContact<V>, V, V) {
        let theta_1 = exp::<V, SHORT>(x);
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
        let ln_sin_theta = y.mul_add(estrin(y, &LN_SINC), x + x);
        let stress = self.n.mul_add(ln_sin_theta, self.scale);
        (
            contact,
            exp::<V, SHORT>(stress) * theta_1,
            self.hold * theta_1,
        )
    }

    #[inline(always)]
    fn off(&self, rules: &Rules<'_, V>, x: V) -> V {
        let (contact, stress, hold) = self.contact::<true>(x);
        let f = rules.sums(&contact).forces(stress, self.tan_phi, hold);
        ln::<V, true>(f.vertical_force)
    }

    #[inline(always)]
    fn found<const SHORT: bool>(&self, rules: &Rules<'_, V>, x: V) -> Found<V> {
        let (contact, stress, hold) = self.contact::<SHORT>(x);
        let f = rules.sums(&contact).forces(stress, self.tan_phi, hold);
        let per_load = V::ONE / f.vertical_force;
        Found {
            off: ln::<V, SHORT>(f.vertical_force),
            pull: f.drawbar_pull * per_load,
            turn: f.torque * per_load,
        }
    }
}

/// eˣ; a short one, to 1e-10, serves until the fine rule decides.
#[inline(always)]
fn exp<V: Vector, const SHORT: bool>(x: V) -> V {
    if SHORT {
        (x * V::from_f64(core::f64::consts::LOG2_E)).exp2_short()
    } else {
        x.exp()
    }
}

/// Natural logarithm; a short one, to 1e-12, likewise.
#[inline(always)]
fn ln<V: Vector, const SHORT: bool>(x: V) -> V {
    if SHORT {
        x.log2_short() * V::from_f64(core::f64::consts::LN_2)
    } else {
        x.ln()
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

/// Solves every point that the lanes serve; the plan holds the others, and a search that left its range is
/// given back as not converged.
#[inline(always)]
pub(super) fn run<V: Vector>(chunk: &mut Chunk<'_>, sheet: &mut LoadSheet) {
    let Chunk {
        prepared,
        inputs,
        plan,
        out,
    } = chunk;
    search::<V>(prepared, inputs, (sheet, plan));
    let mut exponents = prepared.exponents::<V, ABREAST>(inputs);
    let mut groups = plan.groups();
    let mut abreast = [Searched::<V>::nothing(); ABREAST];
    loop {
        let mut count = 0;
        for (searched, group) in abreast.iter_mut().zip(&mut groups) {
            searched.place = count;
            searched.begin((prepared, inputs), sheet, group);
            exponents.set(count, &searched.loaded.n);
            count += 1;
        }
        let abreast = &mut abreast[..count];
        for group in abreast.iter_mut() {
            group.first(&mut exponents);
        }
        for group in abreast.iter_mut() {
            group.second(&mut exponents);
        }
        for group in abreast.iter_mut() {
            group.fine(&mut exponents);
        }
        for group in abreast.iter_mut() {
            group.finish((inputs, &mut exponents), out);
        }
        if count < ABREAST {
            break;
        }
    }
}

/// From Bekker's closed form to where the fine rule begins.
#[inline(always)]
fn search<V: Vector>(
    prepared: &Prepared,
    inputs: &Inputs<'_>,
    (sheet, plan): (&mut LoadSheet, &mut Plan),
) {
    let n = inputs.len();
    let mut exponents = prepared.exponents::<V, ABREAST>(inputs);
    let mut loaded = [Loaded::<V>::nothing(); ABREAST];
    let (mut offs, mut slopes) = ([V::ZERO; ABREAST], [V::ZERO; ABREAST]);
    for from in (0..n).step_by(POINTS_ABREAST) {
        let abreast = || (from..n).step_by(8).take(ABREAST).enumerate();
        for (k, at) in abreast() {
            loaded[k] = set_up::<V>(prepared, inputs, (sheet, plan), at);
        }
        // two steps; the second along the secant
        for (k, at) in abreast() {
            let loaded = &loaded[k];
            exponents.set(k, &loaded.n);
            let rules = exponents.rules(k, &loaded.n, Closeness::First);
            let first: V = sheet.x.load(at);
            offs[k] = loaded.off(&rules, first);
        }
        for (k, at) in abreast() {
            let loaded = &loaded[k];
            let rules = exponents.rules(k, &loaded.n, Closeness::First);
            let first: V = sheet.x.load(at);
            let per_slope: V = sheet.per_slope.load(at);
            let x = held(first - offs[k] * per_slope);
            let off = loaded.off(&rules, x);
            slopes[k] = secant(x - first, off - offs[k], per_slope);
            sheet.x.store(at, held(x - off * slopes[k]));
            sheet.per_slope.store(at, slopes[k]);
        }
        for (_, at) in abreast() {
            choose::<V>(sheet, plan, at);
        }
    }
    plan.sort(n);
}

/// Eight points in their natural order: what does not depend on sinkage, and where to begin.
#[inline(always)]
fn set_up<V: Vector>(
    prepared: &Prepared,
    inputs: &Inputs<'_>,
    (sheet, plan): (&mut LoadSheet, &mut Plan),
    at: usize,
) -> Loaded<V> {
    let soil = prepared.soil(inputs, at);
    let base = Base::<V>::new(
        prepared,
        &soil,
        [
            eight(inputs.radius, at),
            eight(inputs.width, at),
            eight(inputs.rebound, at),
            eight(inputs.given, at),
        ],
    );
    let begun = base.at(prepared, &soil, eight(inputs.slip, at));
    keep((sheet, plan), &begun, at);
    if inputs.soil.is_some() {
        sheet.soil[0].store(at, soil.n);
        sheet.soil[1].store(at, soil.tan_phi);
    }
    sheet.x.store(at, held(begun.x));
    sheet.per_slope.store(at, soil.per_slope);
    begun.loaded
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
