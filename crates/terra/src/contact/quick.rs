//! The quick kernel: forces to 1e-6 for steps in time, driving, braking and drifting, eight nodes at a time.
//!
//! It is the stress model of [`Contact`] with the coupled shear law, or with one along the slip velocity where that keeps its sense, cut at the arcs where the shear displacement along
//! the wheel changes its sign, and with the short elementary functions of the lean kernel. Each part is one Gauss-Legendre
//! rule in v, t = v³. Both components of the shear are (c + σ tan φ) (1 − e^(−|j|/K))/|j| times those of j. Where j
//! along the wheel passes 0 beside a small drift, the stress turns within a part of the arc that no rule resolves, but
//! its magnitude is small there too: halving until the rule agrees with itself is worth 1e-9, not 1e-6.

use grouser_real::Real;

use super::crossing::crossing;
use super::lean::{MAX_HALF_ARC_RAD, Short, sine_cosine};
use super::{Contact, Integrals};
use crate::kernel::Kernel;
use crate::quadrature::{LEGENDRE_8, LEGENDRE_16, RuleView};

/// Least and greatest entry angle, rad: below, differences of cosines lose digits; above, the short sines.
const ENTRY_RAD: (f64, f64) = (0.01, 1.048);
/// Greatest stiffness of the shear (`ShearState::stiffness`) for eight nodes a part and for sixteen. Over 100 000 random
/// contacts (`GROUSER_SIMULATION_CASES=100000 cargo test -p grouser-terra --test all simulation_accuracy::`) the first errors of
/// 1e-6 appear at 1.9 and 16.2, and at 0.6 with eight nodes where the stress turns.
const MAX_STIFFNESS: [f64; 2] = [1.5, 16.0];
/// The first of these limits where the displacement along the wheel changes its sign beside a drift.
const MAX_TURNING_STIFFNESS: f64 = 0.3;
/// A cut is found to this share of the arc: its error counts by its third power.
const CUT_PRECISION: f64 = 1e-4;
/// Steps of Newton's method before that: of 26 000 random cuts two steps serve in 87 % and four in 98 %.
const NEWTON_STEPS: u32 = 4;

/// How well a rule agrees with itself where parts are halved, per strength and arc. What both halves lack is far less.
const TURNING_CLOSE: f64 = 1e-10;
/// Least of the greatest force over strength and arc: the short functions are good to 3e-10 of what is summed.
const MIN_FORCE_SHARE: f64 = 0.4;
/// How often a part is halved at most.
const HALVINGS: u32 = 16;

/// Least drop of the cosine: what rounding leaves of less carries no stress.
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
    n: R,
    /// A, Pa.
    amplitude: R,
    cohesion: R,
    tan_phi: R,
    /// Factor of a displacement along the wheel where it drives: 1 + what lugs add.
    lugs: R,
    /// |q_y|.
    drift: R,
    /// Does the stress point along the slip velocity?
    is_by_speed: bool,
    /// ε² of that direction.
    width_squared: R,
    sin_1: R,
    cos_1: R,
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
    /// What `integrate` gives for the contact as the quick kernel takes it; `None` where that does not serve. The plan is
    /// lent, since moving it costs as much as a part of it.
    #[inline(always)]
    pub(crate) fn quick<T>(&self, integrate: impl FnOnce(&QuickPlan) -> T) -> Option<T> {
        let (angles, shear) = (&self.angles, &self.shear);
        let is_served = shear.law.kernels().contains(&Kernel::Quick);
        let serves = is_served && !shear.locked && shear.restart.is_none();
        let (theta_1, theta_2) = (angles.theta_1, angles.theta_2);
        let arc = theta_1 - theta_2;
        let inside = theta_1 >= ENTRY_RAD.0 && theta_1 <= ENTRY_RAD.1;
        if !(serves && inside && arc <= 2.0 * MAX_HALF_ARC_RAD) {
            return None;
        }
        let front = theta_1 - angles.theta_m;
        let (sin_1, cos_1) = sine_cosine(theta_1);
        let q = shear.displacement.q;
        let per_k = shear.radius / shear.k_shear;
        let r_over_k = core::f64::consts::LOG2_E * per_k;
        let across = shear.q_y.abs() * r_over_k;
        let one_minus_q = shear.displacement.one_minus_q;
        let fastest = (1.0 - q * cos_1).abs().max(one_minus_q.abs());
        let stiffness = per_k * arc * ((1.0 + shear.lugs) * fastest + shear.q_y.abs());
        if !(stiffness <= MAX_STIFFNESS[1]) {
            return None;
        }
        let is_by_speed = shear.law.is_by_slip_velocity();
        if is_by_speed && !shear.speeds_are_steady(arc) {
            return None;
        }
        let width = if shear.law.is_regular() {
            shear.width()
        } else {
            0.0
        };
        let none = QuickPart {
            is_front: false,
            from: 0.0,
            to: 0.0,
        };
        let mut plan = QuickPlan {
            contact: QuickContact {
                theta_1,
                theta_2,
                front,
                rear: angles.theta_m - theta_2,
                q,
                r_over_k,
                across,
                n: self.n,
                amplitude: if front > 0.0 { self.amplitude } else { 0.0 },
                cohesion: self.cohesion,
                tan_phi: self.tan_phi,
                lugs: 1.0 + shear.lugs,
                drift: shear.q_y.abs(),
                is_by_speed,
                width_squared: width * width,
                sin_1,
                cos_1,
            },
            parts: [none; 4],
            count: 0,
            stiff: false,
        };
        let (cuts, count) = plan.contact.cuts(one_minus_q);
        let limit = if count > 0 && shear.sideways {
            MAX_TURNING_STIFFNESS
        } else {
            MAX_STIFFNESS[0]
        };
        plan.stiff = stiffness > limit;
        if count == 0 {
            plan.take_whole();
        } else {
            plan.cut(&cuts[..count]);
        }
        Some(integrate(&plan))
    }
}

impl QuickContact<f64> {
    /// The displacement along the wheel per radius at an arc behind the entry.
    fn along(&self, w: f64) -> f64 {
        w - self.q * (self.sin_1 - sine_cosine(self.theta_1 - w).0)
    }

    /// Where the displacement along the wheel changes its sign, and at how many arcs.
    #[inline]
    fn cuts(&self, one_minus_q: f64) -> ([f64; 2], usize) {
        let mut cuts = ([0.0; 2], 0);
        if one_minus_q >= 0.0 {
            return cuts;
        }
        let arc = self.theta_1 - self.theta_2;
        let over = -one_minus_q / self.q;
        let at = |w: f64| (w, self.along(w));
        // it falls between two arcs, and rises before and behind them
        let turn = turning_angle(over);
        let lowest = at(arc.min(self.theta_1 + turn));
        if !(lowest.1 < 0.0) {
            return cuts;
        }
        let near = vanishing_arcs(self.theta_1, over);
        let close = CUT_PRECISION * arc;
        let top = at((self.theta_1 - turn).max(0.0));
        if top.1 > 0.0 {
            cuts.0[cuts.1] = self.cut(near[0], [top, lowest], close);
            cuts.1 += 1;
        }
        let exit = at(arc);
        if exit.1 > 0.0 {
            cuts.0[cuts.1] = self.cut(near[1], [lowest, exit], close);
            cuts.1 += 1;
        }
        cuts
    }

    /// The arc at which the displacement vanishes between two ends (arc, displacement) of opposite sign: Newton's method from
    /// `near`, else the secant in the bracket, to `close`.
    fn cut(&self, near: f64, ends: [(f64, f64); 2], close: f64) -> f64 {
        let within = ends.map(|end| end.0);
        self.newton(near, within, close)
            .unwrap_or_else(|| crossing(|w| self.along(w), ends, (0.0, close)))
    }

    /// The arc within two at which the displacement vanishes, by Newton's method; `None` where it leaves them or takes too long.
    fn newton(&self, near: f64, [low, high]: [f64; 2], close: f64) -> Option<f64> {
        let mut w = near.max(low).min(high);
        for _ in 0..NEWTON_STEPS {
            let (sin, cos) = sine_cosine(self.theta_1 - w);
            let slope = 1.0 - self.q * cos;
            let step = (w - self.q * (self.sin_1 - sin)) / slope;
            w -= step;
            if !(w > low && w < high) {
                return None;
            }
            // the error that a step leaves is half the curvature times its square over the slope
            if (self.q * sin).abs() * step * step <= close * slope.abs() {
                return Some(w);
            }
        }
        None
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
            n: c(self.n),
            amplitude: c(self.amplitude),
            cohesion: c(self.cohesion),
            tan_phi: c(self.tan_phi),
            lugs: c(self.lugs),
            drift: c(self.drift),
            is_by_speed: self.is_by_speed,
            width_squared: c(self.width_squared),
            sin_1: c(self.sin_1),
            cos_1: c(self.cos_1),
        }
    }
}

impl QuickPlan {
    /// The parts of both pieces.
    pub(crate) fn parts(&self) -> &[QuickPart] {
        &self.parts[..self.count]
    }

    /// Are the parts both pieces without a cut?
    pub(crate) fn is_whole(&self) -> bool {
        matches!(self.parts(), [one, other] if one.is_front != other.is_front)
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
        let drop = sine_cosine(contact.theta_1 - contact.front).1 - contact.cos_1;
        let stress = contact.amplitude * Real::powf(drop.max(MIN_DROP), contact.n);
        let strength = stress * contact.tan_phi + contact.cohesion;
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

    /// Both pieces without a cut.
    #[inline(always)]
    fn take_whole(&mut self) {
        for (is_front, arc) in [(true, self.contact.front), (false, self.contact.rear)] {
            if arc > 0.0 {
                self.push(is_front, 0.0, 1.0);
            }
        }
    }

    #[inline(always)]
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

/// acos(1/q) = 2 arcsin √(over/2), with `over` = (q − 1)/q, by its series: to 2e-6 at 30°, 2e-4 at 60°.
fn turning_angle(over: f64) -> f64 {
    let x = 0.5 * over;
    2.0 * x.sqrt() * (1.0 + x * (1.0 / 6.0 + x * (3.0 / 40.0 + x * (5.0 / 112.0))))
}

/// Two arcs beside the entry at which the displacement nearly vanishes: with sin θ = θ − θ³/6, at the angles of
/// θ² + θ_1 θ + θ_1² = 6 `over`.
fn vanishing_arcs(theta_1: f64, over: f64) -> [f64; 2] {
    let square = 24.0 * over - 3.0 * theta_1 * theta_1;
    let root = square.max(0.0).sqrt();
    [-root, root].map(|root| 1.5 * theta_1 + 0.5 * root)
}

/// ∛t to 1e-9, which is far more than a cut needs: a third of the exponent to 4 %, then Halley's method twice.
fn third_root(t: f64) -> f64 {
    /// Two thirds of the bits of 1.0, less what balances the error: Kahan's constant.
    const BITS: u64 = 0x2a9f_7893_0000_0000;
    let mut y = f64::from_bits(t.to_bits() / 3 + BITS);
    for _ in 0..2 {
        let cube = y * y * y;
        y *= (cube + 2.0 * t) / (2.0 * cube + t);
    }
    y
}

impl<R: Short> QuickContact<R> {
    /// A node x of a part with its weight.
    #[inline(always)]
    pub(crate) fn add(&self, part: QuickPart, (x, weight): (R, R), sums: &mut Integrals<R>) {
        let length = R::from_f64(part.to - part.from);
        let v = length.mul_add(x, R::from_f64(part.from));
        let place = Place::at(v, weight * length);
        let shape = self.shape(place.t);
        if part.is_front {
            self.add_front(&place, &shape, sums);
        } else {
            self.add_rear(&place, &shape, sums);
        }
    }

    /// A node x of both pieces as wholes, with its weight.
    #[inline(always)]
    pub(crate) fn add_pieces(&self, (x, weight): (R, R), sums: &mut Integrals<R>) {
        let place = Place::at(x, weight);
        let shape = self.shape(place.t);
        self.add_front(&place, &shape, sums);
        self.add_rear(&place, &shape, sums);
    }

    #[inline(always)]
    fn add_front(&self, place: &Place<R>, shape: &Shape<R>, sums: &mut Integrals<R>) {
        self.add_stress(
            place.weight * self.front,
            shape,
            (shape.arc, shape.sine_cosine),
            sums,
        );
    }

    #[inline(always)]
    fn add_rear(&self, place: &Place<R>, shape: &Shape<R>, sums: &mut Integrals<R>) {
        let theta = place.t.mul_add(self.rear, self.theta_2);
        let there = (self.theta_1 - theta, sine_cosine(theta));
        self.add_stress(place.weight * self.rear, shape, there, sums);
    }

    /// The normal stress at t of a piece: it is the same in both.
    #[inline(always)]
    fn shape(&self, t: R) -> Shape<R> {
        let arc = t * self.front;
        let (sin, cos) = sine_cosine(self.theta_1 - arc);
        let drop = cos - self.cos_1;
        let drop = R::select(R::ZERO.lt(drop), drop, R::from_f64(MIN_DROP));
        Shape {
            arc,
            sine_cosine: (sin, cos),
            power: (self.n * drop.log2_short()).exp2_short(),
        }
    }

    /// The stresses at an arc `w` behind the entry, where sine and cosine are known.
    #[inline(always)]
    fn add_stress(
        &self,
        weight: R,
        shape: &Shape<R>,
        (w, (sin, cos)): (R, (R, R)),
        sums: &mut Integrals<R>,
    ) {
        let sigma = weight * self.amplitude * shape.power;
        let strength = self.tan_phi.mul_add(sigma, weight * self.cohesion);
        let along = self.r_over_k * (w - self.q * (self.sin_1 - sin));
        let along = R::select(R::ZERO.lt(along), along * self.lugs, along);
        let across = self.across * w;
        let least = R::from_f64(1e-150);
        let length = |x: R, y: R| {
            let length = x.mul_add(x, y).sqrt();
            R::select(least.lt(length), length, least)
        };
        let both = length(along, across * across);
        let share = strength * (R::ONE - (-both).exp2_short());
        let (along, across, both) = if self.is_by_speed {
            let speed = R::ONE - self.q * cos;
            let speed = R::select(R::ZERO.lt(speed), speed * self.lugs, speed);
            let rest = self.drift.mul_add(self.drift, self.width_squared);
            (speed, self.drift, length(speed, rest))
        } else {
            (along, across, both)
        };
        let scale = share / both;
        let tau = scale * along;
        sums.sigma_cos = sigma.mul_add(cos, sums.sigma_cos);
        sums.sigma_sin = sigma.mul_add(sin, sums.sigma_sin);
        sums.tau_cos = tau.mul_add(cos, sums.tau_cos);
        sums.tau_sin = tau.mul_add(sin, sums.tau_sin);
        sums.tau += tau;
        sums.tau_side = scale.mul_add(across, sums.tau_side);
    }
}

/// A node on a piece: t = v³ and dt.
struct Place<R> {
    t: R,
    weight: R,
}

impl<R: Real> Place<R> {
    #[inline(always)]
    fn at(v: R, weight: R) -> Self {
        let square = v * v;
        Self {
            t: square * v,
            weight: weight * R::from_f64(3.0) * square,
        }
    }
}

/// The normal stress at a node.
struct Shape<R> {
    /// The arc from the entry in the measure of the front piece, rad.
    arc: R,
    sine_cosine: (R, R),
    /// The drop of the cosine to the power n.
    power: R,
}

impl Contact<f64> {
    /// The lost work of integrals that lack it: the energy balance.
    pub(crate) fn with_lost_work(&self, integrals: Integrals<f64>) -> Integrals<f64> {
        let i = &integrals;
        let lost = i.tau * self.p - (i.tau_cos - i.sigma_sin) * self.pq + i.tau_side * self.drift();
        Integrals { lost, ..integrals }
    }
}

#[cfg(test)]
mod tests;
