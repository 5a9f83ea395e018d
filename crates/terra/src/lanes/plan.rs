//! Which points of a chunk run on lanes, and by which rule.

use grouser_real::Real;

use crate::contact::ladder::{ExponentTables, Step};
use crate::contact::lean::{GREATEST_SINKAGE, HALF_ARC, LEAST_SINKAGE};
use crate::pressure::Pressure;
use crate::soil::{Soil, SoilLaws};

use super::batch::{BatchPoints, CHUNK};

/// The step of a point that runs by itself.
const SINGLE: u8 = 5;
const _: () = assert!(
    SINGLE as usize == Step::COUNT && CHUNK <= 1 << 16,
    "counts fit their types"
);

/// What is known of the points of a chunk.
#[derive(Clone, Copy, Debug)]
pub(super) enum Given<'a> {
    /// Their sinkages, m.
    Sinkage(&'a [f64]),
    /// Their loads, N.
    Load {
        load: &'a [f64],
        /// z/r that these loads are expected to sink to.
        expected: &'a [f64],
    },
}

/// A soil as the lanes take it.
#[derive(Clone, Debug)]
pub(super) struct Prepared {
    pub(super) tables: ExponentTables,
    pub(super) laws: SoilLaws<f64>,
    pub(super) n: f64,
    pub(super) tan_phi: f64,
    pub(super) inverse_k_shear: f64,
}

impl Prepared {
    /// `None` for a soil whose exponent depends on slip: no one Gauss-Jacobi rule serves it; and for one
    /// whose contact changes with slip by a law that the lanes do not have.
    pub(super) fn new(soil: &Soil) -> Option<Self> {
        let laws = soil.laws::<f64>();
        if laws.rear_driving != 0.0 || laws.transport_layer != 0.0 {
            return None;
        }
        soil.tables().map(|tables| Self {
            tables: *tables,
            n: laws.exponent.n_0,
            tan_phi: Real::tan(laws.strength.phi),
            inverse_k_shear: 1.0 / laws.k_shear,
            laws,
        })
    }

    /// Is the pressure-sinkage modulus positive under this width? (Without a division where it can be.)
    fn carries(&self, width: f64) -> bool {
        match self.laws.pressure {
            Pressure::Bekker(law) => law.k_phi * width + law.k_c > 0.0,
            Pressure::Reece(_) => self.laws.modulus(width, self.n) > 0.0,
        }
    }

    /// c_1 + c_2 s.
    pub(super) fn position(&self, slip: f64) -> f64 {
        self.laws.c_1 + self.laws.c_2 * slip
    }

    /// r·arc·max|1 − q cos θ|/K and the arc at a sinkage over radius; as `ShearState::stiffness`.
    pub(super) fn stiffness(
        &self,
        radius: f64,
        rebound: f64,
        slip: f64,
        z_over_r: f64,
    ) -> (f64, f64) {
        let q = 1.0 - slip;
        // An upper bound of 2 asin √(z/2r) is enough: chord ≤ arc ≤ chord·π/3 up to 60°.
        let arc = |x: f64| 1.048 * Real::sqrt(2.0 * x);
        let behind = rebound * z_over_r;
        let total = arc(z_over_r) + if rebound > 0.0 { arc(behind) } else { 0.0 };
        let fastest = 1.0 - q * (1.0 - z_over_r.max(behind));
        (radius * total * fastest * self.inverse_k_shear, total)
    }
}

/// The points of a chunk sorted by the step of the ladder that they need.
pub(super) struct Plan {
    /// The step of each point; `Step::COUNT` for one that runs by itself.
    steps: [u8; CHUNK],
    order: [u16; CHUNK],
    /// Where each step's points begin in `order`.
    starts: [usize; Step::COUNT + 2],
}

/// Up to eight points of one step: their places, the last one repeated to fill up, and how many count.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    pub(super) places: [usize; 8],
    pub(super) count: usize,
}

impl Plan {
    #[allow(
        clippy::cast_possible_truncation,
        reason = "both counts are asserted to fit"
    )]
    pub(super) fn new(
        prepared: Option<&Prepared>,
        points: &BatchPoints<'_>,
        given: Given<'_>,
    ) -> Self {
        let n = points.slip.len();
        let mut plan = Self {
            steps: [SINGLE; CHUNK],
            order: [0; CHUNK],
            starts: [0; Step::COUNT + 2],
        };
        if let Some(prepared) = prepared {
            for (i, step) in plan.steps.iter_mut().enumerate().take(n) {
                if let Some(found) = step_of(prepared, points, given, i) {
                    *step = found.index() as u8;
                }
            }
        }
        // Counting sort: stable, so that neighbours in the input stay neighbours in a group.
        for &step in &plan.steps[..n] {
            plan.starts[usize::from(step) + 1] += 1;
        }
        for k in 0..=Step::COUNT {
            plan.starts[k + 1] += plan.starts[k];
        }
        let mut next = plan.starts;
        for (i, &step) in plan.steps[..n].iter().enumerate() {
            let place = &mut next[usize::from(step)];
            plan.order[*place] = i as u16;
            *place += 1;
        }
        plan
    }

    pub(super) fn is_single(&self, i: usize) -> bool {
        usize::from(self.steps[i]) == Step::COUNT
    }

    /// The groups of a step.
    pub(super) fn groups(&self, step: Step) -> impl Iterator<Item = Group> + '_ {
        let range = self.starts[step.index()]..self.starts[step.index() + 1];
        self.order[range].chunks(8).map(|places| {
            let last = places.len() - 1;
            Group {
                places: core::array::from_fn(|k| usize::from(places[k.min(last)])),
                count: places.len(),
            }
        })
    }
}

/// The step on which a point runs on lanes; `None` for one that is bad or not of their kind.
fn step_of(
    prepared: &Prepared,
    points: &BatchPoints<'_>,
    given: Given<'_>,
    i: usize,
) -> Option<Step> {
    let (radius, width) = (points.radius[i], points.width[i]);
    let (rebound, slip) = (points.rebound[i], points.slip[i]);
    let sound = (1e-3..=100.0).contains(&radius)
        && (1e-3..=100.0).contains(&width)
        && (0.0..=1.0).contains(&slip)
        && prepared.carries(width)
        && prepared.position(slip) < 1.0;
    if !sound {
        return None;
    }
    let z_over_r = match given {
        // With a rebound the force may fall with sinkage: that search is not for lanes. The guess is taken
        // a third deeper, so that the rule still serves where the search ends.
        Given::Load { load, expected } => {
            let inside = (1.3 * LEAST_SINKAGE..=0.7 * GREATEST_SINKAGE).contains(&expected[i]);
            (inside && rebound == 0.0 && load[i] > 0.0).then_some(1.35 * expected[i])?
        }
        Given::Sinkage(sinkage) => {
            let z_over_r = sinkage[i] / radius;
            let inside = (LEAST_SINKAGE..=GREATEST_SINKAGE).contains(&z_over_r);
            (inside && (0.0..=100.0).contains(&rebound)).then_some(z_over_r)?
        }
    };
    let (stiffness, arc) = prepared.stiffness(radius, rebound, slip, z_over_r);
    (arc <= 2.0 * HALF_ARC && rebound * z_over_r <= GREATEST_SINKAGE)
        .then(|| Step::for_stiffness(stiffness, 1.0))
        .flatten()
}
