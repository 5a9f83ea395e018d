//! One group of eight points: gather, compute, scatter.

use grouser_real::Real;

use crate::contact::ladder::Step;
use crate::contact::lean::{GREATEST_SINKAGE, LEAST_SINKAGE, LeanContact};
use crate::pressure::Pressure;
use crate::quadrature::RuleView;
use crate::sinkage::LoadStatus;

use super::batch::{BatchForces, BatchOutcome, BatchPoints};
use super::plan::{Given, Group, Prepared};
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

/// Residual ln(W/load) at which a lane's search has ended, below what the rule is good for.
const CLOSE: f64 = 2e-10;
/// Residual at which the coarse part of the search has ended: one more step leads to the coarse solution.
const COARSELY: f64 = 1e-4;
/// Most passes of the search by the coarse and by the fine rule; two to four of each are what it takes.
const COARSE_PASSES: usize = 6;
const FINE_PASSES: usize = 8;

/// The part of eight operating points that does not depend on sinkage.
struct Eight<V: Vector> {
    radius: V,
    width: V,
    rebound: V,
    slip: V,
    modulus: V,
    /// clamp(c_1 + c_2 s, 0, 1)
    position: V,
}

/// Vertical force, drawbar pull and torque of eight points.
#[derive(Clone, Copy)]
struct Three<V: Vector> {
    vertical_force: V,
    drawbar_pull: V,
    torque: V,
}

#[inline(always)]
fn gather<V: Vector>(values: &[f64], group: &Group) -> V {
    V::from_array(group.places.map(|place| values[place]))
}

impl<V: Vector> Eight<V> {
    #[inline(always)]
    fn new(prepared: &Prepared, points: &BatchPoints<'_>, group: &Group) -> Self {
        let splat = V::from_f64;
        let width: V = gather(points.width, group);
        let slip: V = gather(points.slip, group);
        let modulus = match prepared.laws.pressure {
            Pressure::Bekker(law) => splat(law.k_c) / width + splat(law.k_phi),
            // powers of the width, one by one: the price of a law that is rare in catalogues
            Pressure::Reece(_) => V::from_array(
                width
                    .to_array()
                    .map(|b| prepared.laws.modulus(b, prepared.n)),
            ),
        };
        let position = slip.mul_add(splat(prepared.laws.c_2), splat(prepared.laws.c_1));
        Self {
            radius: gather(points.radius, group),
            width,
            rebound: gather(points.rebound, group),
            slip,
            modulus,
            position: position.clamp(splat(0.0), splat(1.0)),
        }
    }

    /// The forces at a sinkage over radius.
    #[inline(always)]
    fn forces(
        &self,
        prepared: &Prepared,
        rules: (RuleView<'_>, RuleView<'_>),
        z_over_r: V,
    ) -> Three<V> {
        let splat = V::from_f64;
        let one = splat(1.0);
        let theta_1 = angle(z_over_r);
        let behind = angle(self.rebound * z_over_r);
        let cos_1 = one - z_over_r;
        let sin_1 = (z_over_r * (splat(2.0) - z_over_r)).sqrt();
        let theta_m = self.position * theta_1;
        let front = theta_1 - theta_m;
        let contact = LeanContact {
            sin_1,
            cos_1,
            inverse_sin_1: one / sin_1,
            front,
            rear: theta_m + behind,
            q: one - self.slip,
            minus_r_over_k: self.radius * splat(-prepared.inverse_k_shear),
            tan_phi: splat(prepared.tan_phi),
        };
        let (friction, cohesion) = contact.sums(rules, &prepared.tables.power);
        let area = self.radius * self.width;
        // A (L sin θ_1)ⁿ = k (r L sin θ_1)ⁿ
        let stress = self.modulus * (self.radius * front * sin_1).powf(splat(prepared.n));
        let stress = area * stress;
        let hold = area * splat(prepared.laws.strength.cohesion) * (contact.front + contact.rear);
        Three {
            vertical_force: stress.mul_add(friction.vertical, hold * cohesion.vertical),
            drawbar_pull: stress.mul_add(friction.pull, hold * cohesion.pull),
            torque: self.radius * stress.mul_add(friction.torque, hold * cohesion.torque),
        }
    }

    /// Expected z/r under a load by Bekker's closed form, z = [3 W/((3 − n) k b √(2r))]^(2/(2n + 1)).
    #[inline(always)]
    fn expected(&self, prepared: &Prepared, load: V) -> V {
        let c = V::from_f64;
        let shape = (3.0 - prepared.n).max(0.5);
        let root = (c(2.0) * self.radius).sqrt();
        let base = c(3.0) * load / (c(shape) * self.width * self.modulus * root);
        base.powf(c(2.0 / (2.0 * prepared.n + 1.0))) / self.radius
    }

    /// The sinkage over radius under a load, the forces there and the residual ln(W/load): the secant
    /// method in (ln z, ln W), which is nearly a straight line of slope n + ½.
    ///
    /// A coarse rule leads it to the place where the coarse force carries the load; from there the fine
    /// rule has only the small difference of the two rules to go, along a slope that is known by then. A
    /// lane that has ended stays as it is, so that its result does not depend on the others.
    #[inline(always)]
    fn solve(&self, prepared: &Prepared, step: Step, load: V, start: V) -> (V, Three<V>, V) {
        let c = V::from_f64;
        let (low, high) = (c(Real::ln(LEAST_SINKAGE)), c(Real::ln(GREATEST_SINKAGE)));
        let inverse_load = V::ONE / load;
        let coarse = prepared.tables.coarse_rules(step);
        let mut x = start.ln();
        let mut z = start;
        let mut per_slope = c(1.0 / (prepared.n + 0.5));
        let mut off = (self.forces(prepared, coarse, z).vertical_force * inverse_load).ln();
        for _ in 1..COARSE_PASSES {
            let open = c(COARSELY).lt(off.abs());
            if !V::any(open) {
                break;
            }
            let next = (x - off * per_slope).clamp(low, high);
            let z_next = next.exp();
            let force = self.forces(prepared, coarse, z_next).vertical_force;
            let off_next = (force * inverse_load).ln();
            per_slope = V::select(open, secant(next - x, off_next - off, per_slope), per_slope);
            x = V::select(open, next, x);
            z = V::select(open, z_next, z);
            off = V::select(open, off_next, off);
        }
        // The last coarse residual is still to be gone; the fine rule starts from there.
        x = (x - off * per_slope).clamp(low, high);
        z = x.exp();
        let rules = prepared.tables.rules(step);
        let mut f = self.forces(prepared, rules, z);
        off = (f.vertical_force * inverse_load).ln();
        for pass in 1..FINE_PASSES {
            let open = c(CLOSE).lt(off.abs());
            if !V::any(open) {
                break;
            }
            let next = (x - off * per_slope).clamp(low, high);
            let z_next = next.exp();
            let f_next = self.forces(prepared, rules, z_next);
            let off_next = (f_next.vertical_force * inverse_load).ln();
            if pass > 1 {
                per_slope = V::select(open, secant(next - x, off_next - off, per_slope), per_slope);
            }
            x = V::select(open, next, x);
            z = V::select(open, z_next, z);
            off = V::select(open, off_next, off);
            f = Three {
                vertical_force: V::select(open, f_next.vertical_force, f.vertical_force),
                drawbar_pull: V::select(open, f_next.drawbar_pull, f.drawbar_pull),
                torque: V::select(open, f_next.torque, f.torque),
            };
        }
        (z, f, off)
    }
}

/// 2 arcsin √(x/2): the angle of a sinkage or a rise over the radius.
#[inline(always)]
fn angle<V: Vector>(x: V) -> V {
    let y = V::from_f64(0.5) * x;
    V::from_f64(2.0) * y.sqrt() * y.polynomial(&ARCSINE)
}

/// dx/dy of a secant where it rises, else what was known before.
#[inline(always)]
fn secant<V: Vector>(dx: V, dy: V, before: V) -> V {
    let slope = dx / dy;
    V::select(V::ZERO.lt(slope), slope, before)
}

/// The expected z/r of a whole chunk under its loads.
#[inline(always)]
pub(super) fn expected<V: Vector>(
    prepared: &Prepared,
    points: &BatchPoints<'_>,
    load: &[f64],
    out: &mut [f64],
) {
    for first in (0..load.len()).step_by(8) {
        let last = load.len() - 1;
        let places = core::array::from_fn(|k| (first + k).min(last));
        let group = Group {
            places,
            count: 8.min(load.len() - first),
        };
        let eight = Eight::<V>::new(prepared, points, &group);
        let found = eight.expected(prepared, gather(load, &group)).to_array();
        out[first..first + group.count].copy_from_slice(&found[..group.count]);
    }
}

/// Computes a group and puts its outcomes in place. `given` holds sinkages, or loads with the expected
/// z/r beside them. A lane whose search left its range is given back as not converged.
#[inline(always)]
pub(super) fn run<V: Vector>(
    prepared: &Prepared,
    points: &BatchPoints<'_>,
    given: Given<'_>,
    (step, group): (Step, Group),
    out: &mut [BatchOutcome],
) {
    let eight = Eight::<V>::new(prepared, points, &group);
    let radius = eight.radius.to_array();
    let (z_over_r, f, off) = match given {
        Given::Sinkage(sinkage) => {
            let z_over_r = gather::<V>(sinkage, &group) / eight.radius;
            (
                z_over_r,
                eight.forces(prepared, prepared.tables.rules(step), z_over_r),
                V::ZERO,
            )
        }
        Given::Load { load, expected } => eight.solve(
            prepared,
            step,
            gather(load, &group),
            gather(expected, &group),
        ),
    };
    let (z_over_r, off) = (z_over_r.to_array(), off.to_array());
    let vertical_force = f.vertical_force.to_array();
    let (drawbar_pull, torque) = (f.drawbar_pull.to_array(), f.torque.to_array());
    for (k, &place) in group.places.iter().enumerate().take(group.count) {
        let (fits, sinkage) = match given {
            Given::Sinkage(sinkage) => (true, sinkage[place]),
            Given::Load { .. } => {
                let (stiffness, _) =
                    prepared.stiffness(radius[k], 0.0, points.slip[place], z_over_r[k]);
                let served = Step::for_stiffness(stiffness, 1.0).is_some_and(|least| least <= step);
                (off[k].abs() <= CLOSE && served, z_over_r[k] * radius[k])
            }
        };
        out[place] = if fits {
            BatchOutcome::Done(BatchForces {
                sinkage,
                vertical_force: vertical_force[k],
                drawbar_pull: drawbar_pull[k],
                torque: torque[k],
            })
        } else {
            BatchOutcome::NoSolution(LoadStatus::NotConverged)
        };
    }
}
