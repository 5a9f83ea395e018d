//! One group of eight points: gather, compute, scatter.

use grouser_real::Real;

use crate::contact::ladder::Step;
use crate::contact::lean::{GREATEST_SINKAGE, LEAST_SINKAGE, LeanContact};
use crate::pressure::Pressure;
use crate::sinkage::LoadStatus;

use super::Lanes;
use super::batch::{BatchForces, BatchOutcome, BatchPoints};
use super::plan::{Group, Prepared};

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

/// Residual ln(W/load) at which a lane's search has ended: a tenth of what the rule is good for.
const CLOSE: f64 = 1e-10;
/// Passes of the search. Three or four are what it takes.
const PASSES: usize = 8;

/// The part of eight operating points that does not depend on sinkage.
struct Eight<const FUSED: bool> {
    radius: Lanes<FUSED>,
    width: Lanes<FUSED>,
    rebound: Lanes<FUSED>,
    slip: Lanes<FUSED>,
    modulus: Lanes<FUSED>,
    /// clamp(c_1 + c_2 s, 0, 1)
    position: Lanes<FUSED>,
}

/// Vertical force, drawbar pull and torque of eight points.
#[derive(Clone, Copy)]
struct Three<const FUSED: bool> {
    vertical_force: Lanes<FUSED>,
    drawbar_pull: Lanes<FUSED>,
    torque: Lanes<FUSED>,
}

#[inline(always)]
fn gather<const FUSED: bool>(values: &[f64], group: &Group) -> Lanes<FUSED> {
    Lanes(group.places.map(|place| values[place]))
}

impl<const FUSED: bool> Eight<FUSED> {
    #[inline(always)]
    fn new(prepared: &Prepared, points: &BatchPoints<'_>, group: &Group) -> Self {
        let splat = Lanes::<FUSED>::splat;
        let width = gather(points.width, group);
        let slip = gather(points.slip, group);
        let modulus = match prepared.laws.pressure {
            Pressure::Bekker(law) => splat(law.k_c) / width + splat(law.k_phi),
            // powers of the width, one by one: the price of a law that is rare in catalogues
            Pressure::Reece(_) => Lanes(width.0.map(|b| prepared.laws.modulus(b, prepared.n))),
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
    fn forces(&self, prepared: &Prepared, step: Step, z_over_r: Lanes<FUSED>) -> Three<FUSED> {
        let splat = Lanes::<FUSED>::splat;
        let one = splat(1.0);
        // sin²(θ/2) = z/2r on both sides of the wheel
        let angle = |x: Lanes<FUSED>| {
            let y = splat(0.5) * x;
            splat(2.0) * y.sqrt() * y.polynomial(&ARCSINE)
        };
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
            minus_r_over_k: self.radius * splat(-1.0 / prepared.laws.k_shear),
            tan_phi: splat(prepared.tan_phi),
        };
        let (friction, cohesion) =
            contact.sums(prepared.tables.rules(step), &prepared.tables.power);
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

    /// The sinkage over radius under a load, the forces there and the residual ln(W/load): the secant
    /// method in (ln z, ln W), which is nearly a straight line of slope n + ½. A lane that has ended stays
    /// as it is, so that its result does not depend on the others.
    #[inline(always)]
    fn solve(
        &self,
        prepared: &Prepared,
        step: Step,
        load: Lanes<FUSED>,
        start: Lanes<FUSED>,
    ) -> (Lanes<FUSED>, Three<FUSED>, Lanes<FUSED>) {
        let splat = Lanes::<FUSED>::splat;
        let (low, high) = (
            splat(Real::ln(LEAST_SINKAGE)),
            splat(Real::ln(GREATEST_SINKAGE)),
        );
        let inverse_load = splat(1.0) / load;
        let mut x = start.ln();
        let mut per_slope = splat(1.0 / (prepared.n + 0.5));
        let mut z = start;
        let mut f = self.forces(prepared, step, z);
        let mut off = (f.vertical_force * inverse_load).ln();
        for _ in 1..PASSES {
            let open = splat(CLOSE).lt(off.abs());
            if open.0 == [false; 8] {
                break;
            }
            let next = (x - off * per_slope).clamp(low, high);
            let z_next = next.exp();
            let f_next = self.forces(prepared, step, z_next);
            let off_next = (f_next.vertical_force * inverse_load).ln();
            let secant = (next - x) / (off_next - off);
            let usable = splat(0.0).lt(secant);
            per_slope = Lanes::select(usable, secant, per_slope);
            x = Lanes::select(open, next, x);
            z = Lanes::select(open, z_next, z);
            off = Lanes::select(open, off_next, off);
            f = Three {
                vertical_force: Lanes::select(open, f_next.vertical_force, f.vertical_force),
                drawbar_pull: Lanes::select(open, f_next.drawbar_pull, f.drawbar_pull),
                torque: Lanes::select(open, f_next.torque, f.torque),
            };
        }
        (z, f, off)
    }
}

/// Computes a group and puts its outcomes in place. A lane whose search left its range is given back as
/// not converged.
#[inline(always)]
pub(super) fn run<const FUSED: bool>(
    prepared: &Prepared,
    points: &BatchPoints<'_>,
    given: &[f64],
    (step, group): (Step, Group),
    solve: bool,
    out: &mut [BatchOutcome],
) {
    let eight = Eight::<FUSED>::new(prepared, points, &group);
    let given: Lanes<FUSED> = gather(given, &group);
    let (z_over_r, f, off) = if solve {
        let start = Lanes(core::array::from_fn(|k| {
            prepared.expected(eight.radius.0[k], eight.width.0[k], given.0[k])
        }));
        eight.solve(prepared, step, given, start)
    } else {
        let z_over_r = given / eight.radius;
        (
            z_over_r,
            eight.forces(prepared, step, z_over_r),
            Lanes::splat(0.0),
        )
    };
    for (k, &place) in group.places.iter().enumerate().take(group.count) {
        let fits = !solve || {
            let (radius, slip) = (eight.radius.0[k], eight.slip.0[k]);
            let (stiffness, _) = prepared.stiffness(radius, 0.0, slip, z_over_r.0[k]);
            off.0[k].abs() <= CLOSE
                && Step::for_stiffness(stiffness, 1.0).is_some_and(|needed| needed <= step)
        };
        let forces = BatchForces {
            sinkage: if solve {
                z_over_r.0[k] * eight.radius.0[k]
            } else {
                given.0[k]
            },
            vertical_force: f.vertical_force.0[k],
            drawbar_pull: f.drawbar_pull.0[k],
            torque: f.torque.0[k],
        };
        out[place] = if fits {
            BatchOutcome::Done(forces)
        } else {
            BatchOutcome::NoSolution(LoadStatus::NotConverged)
        };
    }
}
