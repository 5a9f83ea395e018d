//! The quick kernel: forces to 1e-6 for steps in time, driving, braking and drifting, eight nodes at a time.
//!
//! It is the stress model of [`Contact`] with the coupled shear law, cut at the arcs where the shear displacement along
//! the wheel changes its sign, and with the short elementary functions of the lean kernel. Each part is one Gauss-Legendre
//! rule in v, t = v³. Both components of the shear are (c + σ tan φ) (1 − e^(−|j|/K))/|j| times those of j. Where j
//! along the wheel passes 0 beside a small drift, the stress turns within a part of the arc that no rule resolves, but
//! its magnitude is small there too: halving until the rule agrees with itself is worth 1e-9, not 1e-6.

use grouser_real::Real;

use super::lean::{MAX_HALF_ARC_RAD, Short, sine_cosine};
use super::{Contact, Integrals};
use crate::quadrature::{LEGENDRE_8, LEGENDRE_16, RuleView};
use crate::shear::ShearLaw;

/// Least and greatest entry angle, rad: below, differences of cosines lose digits; above, the short sines.
const ENTRY_RAD: (f64, f64) = (0.01, 1.048);
/// Greatest stiffness of the shear (`ShearState::stiffness`) for eight nodes a part and for sixteen. Over 100 000 random
/// contacts (`GROUSER_SIMULATION_CASES=100000 cargo test -p grouser-terra --test all simulation_accuracy::`) the first errors of
/// 1e-6 appear at 1.9 and 16.2, and at 0.6 with eight nodes where the stress turns.
const MAX_STIFFNESS: [f64; 2] = [1.5, 16.0];
/// The first of these limits where the displacement along the wheel changes its sign beside a drift.
const MAX_TURNING_STIFFNESS: f64 = 0.3;
/// A cut is sought this often, by the secant in a bracket. What is left of its error counts by its third power.
const CUT_STEPS: u32 = 8;
/// And to this share of the arc.
const CUT_PRECISION: f64 = 1e-4;

/// How well a rule agrees with itself where parts are halved, per strength and arc. What both halves lack is far less.
const TURNING_CLOSE: f64 = 1e-10;
/// Least of the greatest force over strength and arc: the short functions are good to 3e-10 of what is summed.
const MIN_FORCE_SHARE: f64 = 0.4;
/// How often a part is halved at most.
const HALVINGS: u32 = 16;

/// Least drop of the cosine over its greatest: what rounding leaves of less carries no stress.
const MIN_DROP: f64 = 1e-30;

/// A contact as the quick kernel takes it, in one kind of number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct QuickContact<R> {
    theta_1: R,
    theta_2: R,
    front: R,
    rear: R,
    /// q = v/(r ω).
    q: R,
    /// r log₂e/K.
    r_over_k: R,
    /// |q_y| r log₂e/K.
    across: R,
    /// n log₂e.
    exponent: R,
    /// A (the greatest drop of the cosine)ⁿ, Pa.
    stress: R,
    cohesion: R,
    tan_phi: R,
    /// Factor of a forward shear stress: 1 + what lugs add.
    lugs: R,
    sin_1: R,
    cos_1: R,
    /// 1/(cos θ_m − cos θ_1).
    per_drop: R,
}

/// A part of a piece, from `from` to `to` in v, t = v³: 0 where the stress vanishes, 1 where it is greatest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct QuickPart {
    is_front: bool,
    from: f64,
    to: f64,
}

/// Where a contact is cut, and by which rule it is integrated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct QuickPlan {
    pub(crate) contact: QuickContact<f64>,
    parts: [QuickPart; 4],
    count: usize,
    stiff: bool,
}

impl Contact<f64> {
    /// The contact for the quick kernel; `None` where that does not serve.
    #[inline]
    pub(crate) fn quick(&self) -> Option<QuickPlan> {
        let (angles, shear) = (&self.angles, &self.shear);
        let serves = shear.law == ShearLaw::Coupled && !shear.locked && shear.restart.is_none();
        let (theta_1, theta_2) = (angles.theta_1, angles.theta_2);
        let arc = theta_1 - theta_2;
        let inside = theta_1 >= ENTRY_RAD.0 && theta_1 <= ENTRY_RAD.1;
        if !(serves && inside && arc <= 2.0 * MAX_HALF_ARC_RAD) {
            return None;
        }
        let front = theta_1 - angles.theta_m;
        let (sin_1, cos_1) = sine_cosine(theta_1);
        let drop = sine_cosine(angles.theta_m).1 - cos_1;
        let q = shear.displacement.q;
        let r_over_k = core::f64::consts::LOG2_E * shear.radius / shear.k_shear;
        let across = shear.q_y.abs() * r_over_k;
        let one_minus_q = shear.displacement.one_minus_q;
        let fastest = (1.0 - q * cos_1).abs().max(one_minus_q.abs());
        let stiffness = shear.radius * arc / shear.k_shear * (fastest + shear.q_y.abs());
        if !(stiffness <= MAX_STIFFNESS[1]) {
            return None;
        }
        let carries = front > 0.0 && drop > 0.0;
        let contact = QuickContact {
            theta_1,
            theta_2,
            front,
            rear: angles.theta_m - theta_2,
            q,
            r_over_k,
            across,
            exponent: core::f64::consts::LOG2_E * self.n,
            stress: if carries {
                self.amplitude * Real::powf(drop, self.n)
            } else {
                0.0
            },
            cohesion: self.cohesion,
            tan_phi: self.tan_phi,
            lugs: 1.0 + self.size.lug_gain,
            sin_1,
            cos_1,
            per_drop: if carries { 1.0 / drop } else { 1.0 },
        };
        let (cuts, count) = contact.cuts(one_minus_q);
        let limit = if count > 0 && shear.sideways {
            MAX_TURNING_STIFFNESS
        } else {
            MAX_STIFFNESS[0]
        };
        let none = QuickPart {
            is_front: false,
            from: 0.0,
            to: 0.0,
        };
        let mut plan = QuickPlan {
            contact,
            parts: [none; 4],
            count: 0,
            stiff: stiffness > limit,
        };
        plan.cut(&cuts[..count]);
        Some(plan)
    }
}

impl QuickContact<f64> {
    /// The displacement along the wheel per radius at an arc behind the entry.
    fn along(&self, w: f64) -> f64 {
        w - self.q * (self.sin_1 - sine_cosine(self.theta_1 - w).0)
    }

    /// Where the displacement along the wheel changes its sign, and at how many arcs.
    fn cuts(&self, one_minus_q: f64) -> ([f64; 2], usize) {
        let mut cuts = ([0.0; 2], 0);
        if one_minus_q >= 0.0 {
            return cuts;
        }
        let arc = self.theta_1 - self.theta_2;
        let turn = Real::acos(1.0 / self.q);
        // it falls between these two arcs, and rises before and behind them
        let (top, bottom) = ((self.theta_1 - turn).max(0.0), self.theta_1 + turn);
        let lowest = bottom.min(arc);
        let at_lowest = self.along(lowest);
        if !(at_lowest < 0.0) {
            return cuts;
        }
        if top > 0.0 {
            cuts.0[cuts.1] = self.crossing((top, self.along(top)), (lowest, at_lowest));
            cuts.1 += 1;
        }
        let at_exit = self.along(arc);
        if arc > bottom && at_exit > 0.0 {
            cuts.0[cuts.1] = self.crossing((lowest, at_lowest), (arc, at_exit));
            cuts.1 += 1;
        }
        cuts
    }

    /// The arc between two of opposite displacement (arc, displacement) at which it vanishes: the secant in a bracket.
    fn crossing(&self, mut a: (f64, f64), mut b: (f64, f64)) -> f64 {
        let close = CUT_PRECISION * (self.theta_1 - self.theta_2);
        for _ in 0..CUT_STEPS {
            let middle = b.0 - b.1 * (b.0 - a.0) / (b.1 - a.1);
            let at = self.along(middle);
            let step = (middle - b.0).abs().min((middle - a.0).abs());
            if (at < 0.0) == (b.1 < 0.0) {
                // the same end again: Illinois halves the other end's value so that it moves too
                a.1 *= 0.5;
            } else {
                a = b;
            }
            b = (middle, at);
            if step <= close {
                break;
            }
        }
        b.0
    }

    /// The same numbers in every lane.
    #[inline(always)]
    pub(crate) fn spread<V: Real>(&self) -> QuickContact<V> {
        let c = V::from_f64;
        QuickContact {
            theta_1: c(self.theta_1),
            theta_2: c(self.theta_2),
            front: c(self.front),
            rear: c(self.rear),
            q: c(self.q),
            r_over_k: c(self.r_over_k),
            across: c(self.across),
            exponent: c(self.exponent),
            stress: c(self.stress),
            cohesion: c(self.cohesion),
            tan_phi: c(self.tan_phi),
            lugs: c(self.lugs),
            sin_1: c(self.sin_1),
            cos_1: c(self.cos_1),
            per_drop: c(self.per_drop),
        }
    }
}

impl QuickPlan {
    /// The parts of both pieces.
    pub(crate) fn parts(&self) -> &[QuickPart] {
        &self.parts[..self.count]
    }

    /// The rule of every part.
    pub(crate) fn rule(&self) -> RuleView<'static> {
        if self.stiff {
            LEGENDRE_16.view()
        } else {
            LEGENDRE_8.view()
        }
    }

    /// The integrals to 1e-9 where the stress turns sharply: every part is halved until the rule of sixteen nodes agrees
    /// with itself; `integrate` takes a part. `None` where forward and backward shear cancel so far that the errors of the
    /// short functions count.
    pub(crate) fn halved(
        &self,
        integrate: impl Fn(QuickPart) -> Integrals<f64>,
    ) -> Option<Integrals<f64>> {
        let contact = &self.contact;
        let strength = contact.stress * contact.tan_phi + contact.cohesion;
        let close = TURNING_CLOSE * strength * (contact.theta_1 - contact.theta_2);
        let mut sum = Integrals::zero();
        for part in self.parts() {
            let whole = integrate(*part);
            add_halving(&mut sum, (*part, whole), (close, &integrate), HALVINGS);
        }
        let up = (sum.sigma_cos + sum.tau_sin).abs();
        let along = (sum.tau_cos - sum.sigma_sin).abs();
        let greatest = up.max(along).max(sum.tau.abs());
        (greatest * TURNING_CLOSE >= MIN_FORCE_SHARE * close).then_some(sum)
    }

    fn push(&mut self, is_front: bool, from: f64, to: f64) {
        if to > from {
            self.parts[self.count] = QuickPart { is_front, from, to };
            self.count += 1;
        }
    }

    /// Cuts both pieces at ascending arcs behind the entry, rad.
    fn cut(&mut self, cuts: &[f64]) {
        let (front, rear) = (self.contact.front, self.contact.rear);
        if front > 0.0 {
            let mut from = 0.0;
            for cut in cuts.iter().filter(|cut| **cut < front) {
                let to = third_root(cut / front);
                self.push(true, from, to);
                from = to;
            }
            self.push(true, from, 1.0);
        }
        if rear > 0.0 {
            let mut from = 0.0;
            for cut in cuts.iter().rev().filter(|cut| **cut > front) {
                let to = third_root((1.0 - (cut - front) / rear).max(0.0));
                self.push(false, from, to);
                from = to;
            }
            self.push(false, from, 1.0);
        }
    }
}

/// A part halved until both halves together agree with the whole.
fn add_halving(
    sum: &mut Integrals<f64>,
    (part, whole): (QuickPart, Integrals<f64>),
    by: (f64, &impl Fn(QuickPart) -> Integrals<f64>),
    halvings: u32,
) {
    let middle = 0.5 * (part.from + part.to);
    let halves = [
        QuickPart { to: middle, ..part },
        QuickPart {
            from: middle,
            ..part
        },
    ]
    .map(|half| (half, by.1(half)));
    let [low, high] = [&halves[0].1, &halves[1].1];
    let off = (whole.tau - low.tau - high.tau).abs()
        + (whole.tau_side - low.tau_side - high.tau_side).abs();
    for half in halves {
        if halvings == 0 || off <= by.0 {
            sum.merge(&half.1);
        } else {
            add_halving(sum, half, by, halvings - 1);
        }
    }
}

fn third_root(t: f64) -> f64 {
    Real::powf(t, 1.0 / 3.0)
}

impl<R: Short> QuickContact<R> {
    /// A node x of a part with its weight.
    #[inline(always)]
    pub(crate) fn add(&self, part: QuickPart, (x, weight): (R, R), sums: &mut Integrals<R>) {
        let length = R::from_f64(part.to - part.from);
        let v = length.mul_add(x, R::from_f64(part.from));
        let square = v * v;
        let (t, weight) = (square * v, weight * length * R::from_f64(3.0) * square);
        let is_front = part.is_front;
        let u = t * self.front;
        let (sin_front, cos_front) = sine_cosine(self.theta_1 - u);
        let (w, weight, (sin, cos)) = if is_front {
            (u, weight * self.front, (sin_front, cos_front))
        } else {
            let theta = t.mul_add(self.rear, self.theta_2);
            (self.theta_1 - theta, weight * self.rear, sine_cosine(theta))
        };
        let drop = (cos_front - self.cos_1) * self.per_drop;
        let drop = R::select(R::ZERO.lt(drop), drop, R::from_f64(MIN_DROP));
        let sigma = weight * self.stress * (self.exponent * drop.ln()).exp2_short();
        let strength = self.tan_phi.mul_add(sigma, weight * self.cohesion);
        let along = self.r_over_k * (w - self.q * (self.sin_1 - sin));
        let across = self.across * w;
        let both = along.mul_add(along, across * across).sqrt();
        let both = R::select(R::from_f64(1e-150).lt(both), both, R::from_f64(1e-150));
        let scale = strength * (R::ONE - (-both).exp2_short()) / both;
        let tau = scale * along;
        let tau = R::select(R::ZERO.lt(tau), tau * self.lugs, tau);
        sums.sigma_cos = sigma.mul_add(cos, sums.sigma_cos);
        sums.sigma_sin = sigma.mul_add(sin, sums.sigma_sin);
        sums.tau_cos = tau.mul_add(cos, sums.tau_cos);
        sums.tau_sin = tau.mul_add(sin, sums.tau_sin);
        sums.tau += tau;
        sums.tau_side = scale.mul_add(across, sums.tau_side);
    }
}

impl Contact<f64> {
    /// The lost work of integrals that lack it: the energy balance.
    pub(crate) fn with_lost_work(&self, integrals: Integrals<f64>) -> Integrals<f64> {
        let i = &integrals;
        let lost = i.tau * self.p - (i.tau_cos - i.sigma_sin) * self.pq + i.tau_side * self.drift();
        Integrals { lost, ..integrals }
    }
}
