//! Which points of a chunk run on lanes, and by which rule.

use grouser_real::Real;

use crate::contact::ladder::{ExponentTables, LIMITS, Step};
use crate::pressure::Pressure;
use crate::shear::ShearLaw;
use crate::soil::{Soil, SoilLaws};

use super::columns::{BatchColumns, Inputs};
use super::vector::Vector;

/// Points worked on together: enough to fill groups of eight of each kind, few enough for the stack.
pub(super) const CHUNK: usize = if cfg!(feature = "std") { 192 } else { 64 };
/// Places of a chunk whose kinds each begin at a whole group.
pub(super) const ROOM: usize = CHUNK + 8 * Step::COUNT;

/// The step of a point that runs by itself.
pub(super) const SINGLE_STEP: f64 = 5.0;
const _: () = assert!(
    LIMITS.len() == 5 && Step::COUNT == 5 && ROOM <= 1 << 16,
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
}

impl Prepared {
    /// `None` for a soil whose exponent depends on slip: no one Gauss-Jacobi rule serves it; and for one
    /// whose contact or shear changes with slip by a law that the lanes do not have.
    pub(super) fn new(soil: &Soil) -> Option<Self> {
        let laws = soil.laws::<f64>();
        let choice = laws.choice;
        if laws.rear_driving != 0.0
            || laws.transport_layer != 0.0
            || !choice.stress_position.takes_driving_slip(choice.slip_norm)
            || choice.shear == Some(ShearLaw::SlipVelocityRegular)
        {
            return None;
        }
        soil.tables().map(|tables| Self {
            tables: *tables,
            n: laws.exponent.n_0,
            tan_phi: Real::tan(laws.strength.phi),
            cohesion: laws.strength.cohesion,
            per_k_shear: core::f64::consts::LOG2_E / laws.k_shear,
            laws,
        })
    }

    /// dx/d ln W of a wheel without shear, x = ln θ_1.
    pub(super) fn per_slope(&self) -> f64 {
        1.0 / (2.0 * self.n + 1.0)
    }

    /// The pressure-sinkage modulus under wheels of these widths.
    #[inline(always)]
    pub(super) fn modulus<V: Vector>(&self, width: V) -> V {
        match self.laws.pressure {
            Pressure::Bekker(law) => V::from_f64(law.k_c) / width + V::from_f64(law.k_phi),
            // powers of the width, one by one: the price of a law that is rare in catalogues
            Pressure::Reece(_) => {
                V::from_array(width.to_array().map(|b| self.laws.modulus(b, self.n)))
            }
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
    order: [u16; ROOM],
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
pub(super) struct Group<'a> {
    pub(super) step: Step,
    /// Their place in the order of the plan.
    pub(super) at: usize,
    pub(super) places: &'a [u16; 8],
    pub(super) count: usize,
}

impl Plan {
    pub(super) const EMPTY: Self = Self {
        steps: [0.0; ROOM],
        order: [0; ROOM],
        ranges: [(0, 0); Step::COUNT],
    };

    /// Gives the first `n` points the greatest step that any of them needs.
    pub(super) fn level(&mut self, n: usize) {
        let greatest = self.steps[..n].iter().copied().fold(0.0, f64::max);
        self.steps[..n].fill(greatest);
    }

    /// Sorts the first `n` points by their steps. Stable, so that neighbours stay neighbours.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "steps are 0 to 5 and places below 2^16, both asserted"
    )]
    pub(super) fn sort(&mut self, n: usize) {
        let mut counts = [0_usize; Step::COUNT + 1];
        for &step in &self.steps[..n] {
            counts[(step as usize).min(Step::COUNT)] += 1;
        }
        let mut next = [0; Step::COUNT + 1];
        let mut from = 0;
        for step in 0..Step::COUNT {
            self.ranges[step] = (from, from + counts[step]);
            next[step] = from;
            from += counts[step].next_multiple_of(8);
        }
        for (i, &step) in self.steps[..n].iter().enumerate() {
            let step = (step as usize).min(Step::COUNT);
            if step < Step::COUNT {
                self.order[next[step]] = i as u16;
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
    pub(super) fn groups(&self) -> impl Iterator<Item = Group<'_>> {
        self.ranges
            .iter()
            .enumerate()
            .flat_map(move |(step, &(from, to))| {
                let places = self.order[from..to.next_multiple_of(8)].as_chunks::<8>().0;
                places.iter().enumerate().map(move |(k, places)| Group {
                    step: Step::at(step),
                    at: from + 8 * k,
                    places,
                    count: 8.min(to - from - 8 * k),
                })
            })
    }
}
