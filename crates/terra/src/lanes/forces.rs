//! Forces of a chunk at given sinkages.

use crate::contact::ladder::Closeness;
use crate::contact::lean::estrin;
use crate::contact::lean::{
    LeanContact, MAX_HALF_ARC_RAD, MAX_SINKAGE_PER_RADIUS, MIN_SINKAGE_PER_RADIUS,
    NARROW_FRONT_SHARE,
};

use crate::status::SolveStatus;

use super::columns::Inputs;
use super::plan::{Chunk, LaneSoil, Plan, Prepared, SINGLE_STEP, step_of, within};
use super::sheet::{Column, eight};
use super::vector::Vector;

/// arcsin x/x in x² for 0 ≤ x ≤ ½ by interpolation at Chebyshev's points; relative error 4e-15.
const ARCSINE: [f64; 11] = [
    1.000_000_000_000_003,
    0.166_666_666_663_602_3,
    0.075_000_000_488_015_58,
    0.044_642_826_955_757_35,
    0.030_382_897_420_132_21,
    0.022_354_717_951_662_17,
    0.017_550_046_245_694_55,
    0.012_550_386_671_737_955,
    0.017_924_305_774_952_437,
    -0.007_309_161_310_274_521,
    0.031_500_978_582_855_19,
];

/// What the nodes need of every point.
pub(super) struct ForceSheet {
    theta_1: Column,
    behind: Column,
    front: Column,
    rear: Column,
    q: Column,
    r_over_k: Column,
    stress: Column,
    hold: Column,
    /// Exponent and tan φ, where each point has its own.
    soil: [Column; 2],
}

impl ForceSheet {
    pub(super) const EMPTY: Self = Self {
        theta_1: Column::EMPTY,
        behind: Column::EMPTY,
        front: Column::EMPTY,
        rear: Column::EMPTY,
        q: Column::EMPTY,
        r_over_k: Column::EMPTY,
        stress: Column::EMPTY,
        hold: Column::EMPTY,
        soil: [Column::EMPTY; 2],
    };
}

/// 2 arcsin √(x/2): the angle of a sinkage or a rise over the radius.
#[inline(always)]
fn angle<V: Vector>(x: V) -> V {
    let y = V::from_f64(0.5) * x;
    V::from_f64(2.0) * y.sqrt() * estrin(y, &ARCSINE)
}

/// Computes the forces of every point that the lanes serve and leaves the others to the plan.
#[inline(always)]
pub(super) fn run<V: Vector>(chunk: &mut Chunk<'_>, sheet: &mut ForceSheet) {
    let Chunk {
        prepared,
        inputs,
        plan,
        out,
    } = chunk;
    for at in (0..inputs.len()).step_by(8) {
        sort_in::<V>(prepared, inputs, (sheet, plan), at);
    }
    plan.sort(inputs.len());
    let mut exponents = prepared.exponents::<V, 1>(inputs);
    for group in plan.groups() {
        let places = group.places;
        let [n, tan_phi] = prepared.gather(inputs, &sheet.soil, places);
        exponents.set(0, &n);
        let contact = LeanContact {
            theta_1: sheet.theta_1.gather::<V>(places),
            behind: sheet.behind.gather::<V>(places),
            front: sheet.front.gather::<V>(places),
            rear: sheet.rear.gather::<V>(places),
            q: sheet.q.gather::<V>(places),
            r_over_k: sheet.r_over_k.gather::<V>(places),
        };
        let rules = exponents.rules(0, &n, Closeness::Fine(group.step));
        let f = rules.sums(&contact).forces(
            sheet.stress.gather::<V>(places),
            tan_phi,
            sheet.hold.gather::<V>(places),
        );
        let vertical_force = f.vertical_force.to_array();
        let (drawbar_pull, torque) = (f.drawbar_pull.to_array(), f.torque.to_array());
        for (k, &place) in group.places.iter().enumerate().take(group.count) {
            let place = usize::from(place);
            let numbers = [
                inputs.given[place],
                vertical_force[k],
                drawbar_pull[k],
                inputs.radius[place] * torque[k],
            ];
            out.set(place, SolveStatus::Solved, numbers);
        }
    }
}

/// What does not depend on the nodes, of points at a sinkage.
struct Placed<V> {
    contact: LeanContact<V>,
    /// r b A (L sin θ_1)ⁿ L
    stress: V,
    /// r b c (θ_1 − θ_2)
    hold: V,
    /// The step of the ladder, or [`SINGLE_STEP`].
    step: V,
}

impl<V: Vector> Placed<V> {
    /// Points by radius, width, rebound ratio, slip and sinkage over radius.
    #[inline(always)]
    fn new(
        prepared: &Prepared,
        soil: &LaneSoil<V>,
        [radius, width, rebound, slip, z_over_r]: [V; 5],
    ) -> Self {
        let c = V::from_f64;
        let modulus = prepared.modulus(soil, width);
        let position = prepared.position(soil, slip);
        let rise = rebound * z_over_r;
        let sound = within(radius, 1e-3, 100.0)
            & within(width, 1e-3, 100.0)
            & within(rebound, 0.0, 100.0)
            & within(slip, 0.0, 1.0)
            & within(z_over_r, MIN_SINKAGE_PER_RADIUS, MAX_SINKAGE_PER_RADIUS)
            & within(rise, 0.0, MAX_SINKAGE_PER_RADIUS)
            & V::ZERO.lt(modulus)
            & position.lt(V::ONE - c(NARROW_FRONT_SHARE) * soil.n)
            & soil.sound;

        let theta_1 = angle(z_over_r);
        let behind = if V::any(V::ZERO.lt(rise)) {
            angle(rise)
        } else {
            V::ZERO
        };
        let arc = theta_1 + behind;
        let q = V::ONE - slip;
        let fastest = V::ONE - q * (V::ONE - z_over_r.max(rise));
        let r_over_k = radius * soil.per_k_shear;
        let stiffness = r_over_k * c(core::f64::consts::LN_2) * arc * fastest;
        let sound = sound & arc.le(c(2.0 * MAX_HALF_ARC_RAD));

        let theta_m = position.clamp(V::ZERO, V::ONE) * theta_1;
        let front = theta_1 - theta_m;
        let sin_1 = (z_over_r * (c(2.0) - z_over_r)).sqrt();
        let area = radius * width;
        // A (L sin θ_1)ⁿ L = k (r L sin θ_1)ⁿ L
        let power = (radius * front * sin_1).powf(soil.n);
        Self {
            contact: LeanContact {
                theta_1,
                behind,
                front,
                rear: theta_m + behind,
                q,
                r_over_k,
            },
            stress: area * modulus * power * front,
            hold: area * soil.cohesion * arc,
            step: V::select(sound, step_of(stiffness), c(SINGLE_STEP)),
        }
    }
}

/// Eight points in their natural order: what does not depend on the nodes, and their step.
#[inline(always)]
fn sort_in<V: Vector>(
    prepared: &Prepared,
    inputs: &Inputs<'_>,
    (sheet, plan): (&mut ForceSheet, &mut Plan),
    at: usize,
) {
    let radius: V = eight(inputs.radius, at);
    let soil = prepared.soil(inputs, at);
    let placed = Placed::new(
        prepared,
        &soil,
        [
            radius,
            eight(inputs.width, at),
            eight(inputs.rebound, at),
            eight(inputs.slip, at),
            eight::<V>(inputs.given, at) / radius,
        ],
    );
    placed.step.store(&mut plan.steps, at);
    let contact = placed.contact;
    sheet.theta_1.store(at, contact.theta_1);
    sheet.behind.store(at, contact.behind);
    sheet.front.store(at, contact.front);
    sheet.rear.store(at, contact.rear);
    sheet.q.store(at, contact.q);
    sheet.r_over_k.store(at, contact.r_over_k);
    sheet.stress.store(at, placed.stress);
    sheet.hold.store(at, placed.hold);
    if inputs.soil.is_some() {
        sheet.soil[0].store(at, soil.n);
        sheet.soil[1].store(at, soil.tan_phi);
    }
}

#[cfg(test)]
mod tests;
