//! Which points of a chunk run on lanes, and by which rule.

use grouser_real::Real;

use crate::contact::ladder::{Closeness, LaneRules, SharedRules};
use crate::contact::ladder::{ExponentTables, LIMITS, Step};
use crate::contact::lean::{LeanContact, LeanSums};
use crate::kernel::Kernel;
use crate::pressure::{Pressure, Reece};
use crate::soil::{COHESION, EXPONENT, K_SHEAR, MODULUS, PHI, POSITION, Soil, SoilLaws};

use super::columns::{BatchColumns, Inputs};
use super::portable::TWO_52;
use super::sheet::{Column, eight};
use super::vector::Vector;

/// Points worked on together: enough to fill groups of eight of each kind, few enough for the stack.
pub(super) const CHUNK: usize = if cfg!(feature = "std") { 192 } else { 64 };
/// Places of a chunk whose kinds each begin at a whole group. Where it holds every u8, no place is checked; a power of
/// two would lay all columns on the same lines of a cache.
pub(super) const ROOM: usize = if cfg!(feature = "std") {
    264
} else {
    CHUNK + 8 * Step::COUNT
};

/// How many groups are searched side by side: each waits for its logarithm while the others' nodes are computed.
pub(super) const ABREAST: usize = 2;

/// The step of a point that runs by itself.
pub(super) const SINGLE_STEP: f64 = 5.0;
const _: () = assert!(
    LIMITS.len() == 5 && Step::COUNT == 5 && CHUNK + 8 * Step::COUNT <= ROOM && CHUNK <= 1 << 8,
    "counts fit their types"
);

/// A soil as the lanes take it.
#[derive(Clone, Debug)]
pub(super) struct Prepared {
    pub(super) tables: ExponentTables,
    pub(super) laws: SoilLaws<f64>,
    pub(super) n: f64,
    pub(super) tan_phi: f64,
    pub(super) cohesion: f64,
    /// log₂e/K
    pub(super) per_k_shear: f64,
    /// As in [`LaneSoil`].
    per_slope: f64,
    shape: f64,
}

impl Prepared {
    /// `None` for a soil with a law that the lanes do not serve.
    pub(super) fn new(soil: &Soil) -> Option<Self> {
        if soil.params().unserved_by(Kernel::Lanes).is_some() {
            return None;
        }
        let laws = soil.laws::<f64>();
        let n = laws.exponent.n_0;
        let shape = Real::ln((3.0 - n).max(0.5) / 3.0) - n * core::f64::consts::LN_2;
        soil.tables().map(|tables| Self {
            tables: *tables,
            per_slope: 1.0 / (2.0 * n + 1.0),
            shape,
            n,
            tan_phi: Real::tan(laws.strength.phi),
            cohesion: laws.strength.cohesion,
            per_k_shear: core::f64::consts::LOG2_E / laws.k_shear,
            laws,
        })
    }

    /// The soils of eight points from a place on.
    #[inline(always)]
    pub(super) fn soil<V: Vector>(&self, inputs: &Inputs<'_>, at: usize) -> LaneSoil<V> {
        let c = V::from_f64;
        let Some(columns) = &inputs.soil else {
            let [k_c, k_phi] = match self.laws.pressure {
                Pressure::Bekker(law) => [c(law.k_c), c(law.k_phi)],
                Pressure::Reece(law) => [c(law.k_c_prime), c(law.k_phi_prime)],
            };
            return LaneSoil {
                k_c,
                k_phi,
                n: c(self.n),
                cohesion: c(self.cohesion),
                tan_phi: c(self.tan_phi),
                per_k_shear: c(self.per_k_shear),
                c_1: c(self.laws.c_1),
                c_2: c(self.laws.c_2),
                per_slope: c(self.per_slope),
                shape: c(self.shape),
                sound: V::ZERO.lt(V::ONE),
            };
        };
        let [k_c, k_phi, n, cohesion, phi, k_shear, c_1, c_2] = columns.numbers;
        let [k_c, k_phi]: [V; 2] = [eight(k_c, at), eight(k_phi, at)];
        let [n, cohesion, phi]: [V; 3] = [eight(n, at), eight(cohesion, at), eight(phi, at)];
        let [k_shear, c_1, c_2]: [V; 3] = [eight(k_shear, at), eight(c_1, at), eight(c_2, at)];
        let modulus = match self.laws.pressure {
            Pressure::Bekker(_) => MODULUS[0],
            Pressure::Reece(_) => MODULUS[1],
        };
        let sound = inside(k_c, modulus)
            & inside(k_phi, modulus)
            & inside(n, EXPONENT)
            & inside(cohesion, COHESION)
            & inside(phi, PHI)
            & inside(k_shear, K_SHEAR)
            & inside(c_1, POSITION)
            & inside(c_2, POSITION);
        // a sine takes another way in all lanes where one is huge
        let n = n.clamp(c(EXPONENT.0), c(EXPONENT.1));
        let phi = phi.clamp(c(PHI.0), c(PHI.1));
        LaneSoil {
            k_c,
            k_phi,
            n,
            cohesion,
            tan_phi: phi.sin() / phi.cos(),
            per_k_shear: c(core::f64::consts::LOG2_E) / k_shear,
            c_1,
            c_2,
            per_slope: V::ONE / (n + n + V::ONE),
            shape: ((c(3.0) - n).max(c(0.5)) * c(1.0 / 3.0)).ln() - n * c(core::f64::consts::LN_2),
            sound,
        }
    }

    /// θ_m/θ_1 at these slips, before it is held in [0, 1].
    #[inline(always)]
    pub(super) fn position<V: Vector>(&self, soil: &LaneSoil<V>, slip: V) -> V {
        let choice = self.laws.choice;
        let moving = choice.stress_position.driving(choice.slip_norm).of(slip);
        moving.mul_add(soil.c_2, soil.c_1)
    }

    /// The pressure-sinkage modulus under wheels of these widths.
    #[inline(always)]
    pub(super) fn modulus<V: Vector>(&self, soil: &LaneSoil<V>, width: V) -> V {
        match self.laws.pressure {
            Pressure::Bekker(_) => soil.k_c / width + soil.k_phi,
            // powers of the width, one by one: the price of a law that is rare in catalogues
            Pressure::Reece(_) => {
                let numbers = [soil.k_c, soil.k_phi, soil.cohesion, soil.n].map(V::to_array);
                let mut modulus = width.to_array();
                for (k, x) in modulus.iter_mut().enumerate() {
                    let [k_c_prime, k_phi_prime, cohesion, n] = numbers.map(|of| of[k]);
                    let law = Reece {
                        k_c_prime,
                        k_phi_prime,
                    };
                    *x = law.modulus(cohesion, self.laws.unit_weight, *x, n);
                }
                V::from_array(modulus)
            }
        }
    }

    /// Exponent and tan φ at eight places, from their columns where each point has its own.
    #[inline(always)]
    pub(super) fn gather<V: Vector>(
        &self,
        inputs: &Inputs<'_>,
        columns: &[Column; 2],
        places: [u8; 8],
    ) -> [V; 2] {
        if inputs.soil.is_none() {
            return [V::from_f64(self.n), V::from_f64(self.tan_phi)];
        }
        [columns[0].gather(places), columns[1].gather(places)]
    }

    /// The exponents of a chunk of which `N` groups are searched side by side.
    #[inline(always)]
    pub(super) fn exponents<'a, V: Vector, const N: usize>(
        &'a self,
        inputs: &Inputs<'a>,
    ) -> Exponents<'a, V, N> {
        let shared = match &inputs.soil {
            None => Some(&self.tables),
            Some(soil) => soil.tables,
        };
        match shared {
            Some(tables) => Exponents::Shared(tables),
            None => Exponents::Each([LaneRules::empty(); N]),
        }
    }
}

/// The soils of eight points.
#[derive(Clone, Copy)]
pub(super) struct LaneSoil<V: Vector> {
    k_c: V,
    k_phi: V,
    pub(super) n: V,
    pub(super) cohesion: V,
    pub(super) tan_phi: V,
    /// log₂e/K
    pub(super) per_k_shear: V,
    c_1: V,
    c_2: V,
    /// dx/d ln W of a wheel without shear, x = ln θ_1.
    pub(super) per_slope: V,
    /// ln((3 − n)/3 · 2⁻ⁿ), 3 − n at least ½: Bekker's closed form in θ_1.
    pub(super) shape: V,
    /// Are all of them legal?
    pub(super) sound: V::Mask,
}

/// The exponents of a chunk: one with its tables, or a room for the rules of each of `N` groups.
#[allow(
    clippy::large_enum_variant,
    reason = "it stands still, and its room is on the stack"
)]
pub(super) enum Exponents<'a, V, const N: usize> {
    Shared(&'a ExponentTables),
    Each([LaneRules<V>; N]),
}

impl<V: Vector, const N: usize> Exponents<'_, V, N> {
    /// Takes the eight exponents of a group.
    #[inline(always)]
    pub(super) fn set(&mut self, group: usize, n: &V) {
        if let Self::Each(rules) = self {
            V::set_power(&mut rules[group], n);
        }
    }

    /// The rules of a group's eight exponents, which were taken before.
    #[inline(always)]
    pub(super) fn rules(&mut self, group: usize, n: &V, closeness: Closeness) -> Rules<'_, V> {
        match self {
            Self::Shared(tables) => Rules::Shared(tables.at(closeness)),
            Self::Each(rules) => {
                V::set_rules(&mut rules[group], n, closeness);
                Rules::Each(&rules[group])
            }
        }
    }
}

/// The rules of eight contacts.
pub(super) enum Rules<'a, V> {
    /// Of one exponent.
    Shared(SharedRules<'a>),
    /// Of an exponent each.
    Each(&'a LaneRules<V>),
}

impl<V: Vector> Rules<'_, V> {
    /// The integrals of eight contacts.
    #[inline(always)]
    pub(super) fn sums(&self, contact: &LeanContact<V>) -> LeanSums<V> {
        match self {
            Self::Shared(rules) => V::sums(contact, rules),
            Self::Each(rules) => V::lane_sums(contact, rules),
        }
    }
}

/// The step (as a number) that the shear r·arc·max|1 − q cos θ|/K requires; the same limits as
/// [`Step::for_stiffness`].
#[inline(always)]
pub(super) fn step_of<V: Vector>(stiffness: V) -> V {
    let mut step = V::ZERO;
    for limit in LIMITS {
        let within = stiffness.le(V::from_f64(limit));
        step += V::select(within, V::ZERO, V::ONE);
    }
    step
}

/// A whole number from 0 to 7 as an index: the low bits of its sum with 2⁵².
#[inline(always)]
fn index_of(step: f64) -> usize {
    usize::from((step + f64::from_bits(TWO_52)).to_bits().to_le_bytes()[0] & 7).min(Step::COUNT)
}

#[inline(always)]
fn inside<V: Vector>(x: V, (low, high): (f64, f64)) -> V::Mask {
    within(x, low, high)
}

/// Are the numbers in a range? NaN is in none.
#[inline(always)]
pub(super) fn within<V: Vector>(x: V, low: f64, high: f64) -> V::Mask {
    V::from_f64(low).le(x) & x.le(V::from_f64(high))
}

/// The points of a chunk sorted by the step of the ladder that they need.
pub(super) struct Plan {
    /// The step of each point; [`SINGLE_STEP`] for one that runs by itself.
    pub(super) steps: [f64; ROOM],
    /// Places by step, each step's from a whole group on, its last group filled up with its last place.
    order: [u8; ROOM],
    ranges: [(usize, usize); Step::COUNT],
}

/// Points that are worked on together.
pub(super) struct Chunk<'a> {
    pub(super) prepared: &'a Prepared,
    pub(super) inputs: Inputs<'a>,
    pub(super) plan: &'a mut Plan,
    pub(super) out: BatchColumns<'a>,
}

/// Up to eight points of one step: their places, and how many count.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    pub(super) step: Step,
    pub(super) places: [u8; 8],
    pub(super) count: usize,
}

impl Plan {
    pub(super) const EMPTY: Self = Self {
        steps: [0.0; ROOM],
        order: [0; ROOM],
        ranges: [(0, 0); Step::COUNT],
    };

    /// Sorts the first `n` points by their steps. Stable, so that neighbours stay neighbours.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "steps are 0 to 5 and places below 2^8, both asserted"
    )]
    pub(super) fn sort(&mut self, n: usize) {
        let mut counts = [0_usize; Step::COUNT + 1];
        for &step in &self.steps[..n] {
            counts[index_of(step)] += 1;
        }
        let mut next = [0; Step::COUNT + 1];
        let mut from = 0;
        for step in 0..Step::COUNT {
            self.ranges[step] = (from, from + counts[step]);
            next[step] = from;
            from += counts[step].next_multiple_of(8);
        }
        for (i, &step) in self.steps[..n].iter().enumerate() {
            let step = index_of(step);
            if step < Step::COUNT {
                self.order[next[step]] = i as u8;
                next[step] += 1;
            }
        }
        for (_, end) in self.ranges {
            if !end.is_multiple_of(8) {
                let last = self.order[end - 1];
                self.order[end..end.next_multiple_of(8)].fill(last);
            }
        }
    }

    pub(super) fn is_single(&self, i: usize) -> bool {
        self.steps[i] >= SINGLE_STEP
    }

    /// All groups.
    pub(super) fn groups(&self) -> impl Iterator<Item = Group> {
        self.ranges
            .iter()
            .enumerate()
            .flat_map(move |(step, &(from, to))| {
                let places = self.order[from..to.next_multiple_of(8)].as_chunks::<8>().0;
                places.iter().enumerate().map(move |(k, &places)| Group {
                    step: Step::at(step),
                    places,
                    count: 8.min(to - from - 8 * k),
                })
            })
    }
}

#[cfg(test)]
pub(super) mod tests;
