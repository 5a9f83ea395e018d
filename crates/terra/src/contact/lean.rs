//! The lean kernel: the forces of a wheel that drives straight ahead, and nothing else.
//!
//! It is the same stress model as [`Contact`](super::Contact), cut to the case that nearly every question
//! is about (no slip angle, no change of sign of the shear, sinkage at most half the radius), so that each
//! node costs one short sine and cosine, one exponential and a dozen products. Written over [`Real`]: on
//! lanes a lane is an operating point, or a node of one operating point.
//!
//! σ is A (L sin θ_1)ⁿ tⁿ ratioⁿ with ratio = (cos(θ_1 − u) − cos θ_1)/(u sin θ_1) in [½, 1]: its power is a
//! polynomial of the soil. The cohesion rule is symmetric about the middle of the arc: two nodes share one
//! sine and cosine. sin θ − θ and cos θ − 1 + θ²/2 are what the polynomials approximate, so that differences
//! of sines and cosines keep their digits at small angles.

use grouser_real::Real;

use super::ladder::{LaneRules, POWER_TERMS, SharedRules};
use crate::quadrature::RuleView;

/// (sin θ/θ − 1)/θ² in θ² for |θ| ≤ 1.048, by interpolation at Chebyshev's points: relative error of the
/// sine 6e-13.
const SINE: [f64; 5] = [
    -0.166_666_666_666_168_08,
    0.008_333_333_310_668_682,
    -0.000_198_412_533_487_939_2,
    2.755_311_601_872_065_5e-6,
    -2.461_422_335_420_465e-8,
];
/// (cos θ − 1 + θ²/2)/θ⁴ likewise: error of the cosine 3e-11 at the end of the range.
const COSINE: [f64; 4] = [
    0.041_666_666_643_074_085,
    -0.001_388_888_202_429_255_2,
    2.479_846_383_885_636_7e-5,
    -2.710_182_686_706_967_5e-7,
];

/// Least share of the front in θ_1, per exponent n: (cos θ − cos θ_1)/front, to the power n, is as exact as the short
/// cosine's error, 3e-11 at 60°, over the front: n · 6e-11/(0.07 n · 1.05 · sin 60°) = 1e-9.
pub(crate) const NARROW_FRONT_SHARE: f64 = 0.07;

/// Greatest half arc that the rules of the ladder were tried on, rad.
pub(crate) const MAX_HALF_ARC_RAD: f64 = 0.85;

/// Least sinkage over radius: below it j loses digits by cancellation when slip is near 0.
pub(crate) const MIN_SINKAGE_PER_RADIUS: f64 = 4.5e-4;
/// Greatest sinkage over radius: θ_1 = 60°.
pub(crate) const MAX_SINKAGE_PER_RADIUS: f64 = 0.5;

/// A number whose power of two and logarithm may be short.
pub(crate) trait Short: Real {
    /// 2ˣ for −1000 ≤ x ≤ ½: to 1.1e-10, and 2ˣ − 1 near 0 to 3e-10 of itself.
    fn exp2_short(self) -> Self;

    /// The same of some numbers.
    fn exp2_short_each<const N: usize>(x: [Self; N]) -> [Self; N];

    /// Base-2 logarithm of a positive normal number, to 1e-12.
    fn log2_short(self) -> Self;
}

/// An operating point as the lean kernel takes it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeanContact<R> {
    pub(crate) theta_1: R,
    /// −θ_2 ≥ 0.
    pub(crate) behind: R,
    /// θ_1 − θ_m.
    pub(crate) front: R,
    /// θ_m − θ_2.
    pub(crate) rear: R,
    /// q = v/(r ω).
    pub(crate) q: R,
    /// r log₂e/K.
    pub(crate) r_over_k: R,
}

/// Integrals over the contact: of friction per A (L sin θ_1)ⁿ L, of cohesion per c times the arc. x is the
/// mobilised share 1 − e^(−j/K).
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeanSums<R> {
    /// ∫ σ cos θ
    pub(crate) bearing: R,
    /// ∫ σ sin θ
    pub(crate) resistance: R,
    /// ∫ σ x sin θ
    pub(crate) grip_up: R,
    /// ∫ σ x cos θ
    pub(crate) grip_along: R,
    /// ∫ σ x
    pub(crate) grip: R,
    /// ∫ x sin θ
    pub(crate) hold_up: R,
    /// ∫ x cos θ
    pub(crate) hold_along: R,
    /// ∫ x
    pub(crate) hold: R,
}

/// Vertical force, drawbar pull and torque/r per whatever the scales are in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Three<R> {
    pub(crate) vertical_force: R,
    pub(crate) drawbar_pull: R,
    pub(crate) torque: R,
}

impl<R: Real> LeanSums<R> {
    #[inline(always)]
    pub(crate) fn zero() -> Self {
        let zero = R::ZERO;
        Self {
            bearing: zero,
            resistance: zero,
            grip_up: zero,
            grip_along: zero,
            grip: zero,
            hold_up: zero,
            hold_along: zero,
            hold: zero,
        }
    }

    /// The forces, for the friction's scale r b A (L sin θ_1)ⁿ L and the cohesion's r b c (θ_1 − θ_2).
    #[inline(always)]
    pub(crate) fn forces(&self, stress: R, tan_phi: R, cohesion: R) -> Three<R> {
        let up = tan_phi.mul_add(self.grip_up, self.bearing);
        let along = tan_phi * self.grip_along - self.resistance;
        Three {
            vertical_force: stress.mul_add(up, cohesion * self.hold_up),
            drawbar_pull: stress.mul_add(along, cohesion * self.hold_along),
            torque: stress.mul_add(tan_phi * self.grip, cohesion * self.hold),
        }
    }
}

/// What is the same for all nodes of a contact.
pub(crate) struct Frame<R> {
    contact: LeanContact<R>,
    /// The exponent of mobilisation is `start` + r/K θ − q r/K sin θ.
    start: R,
    q_r_over_k: R,
    cos_1: R,
    /// 1/(L sin θ_1).
    per_drop: R,
    /// Rear over front.
    rear_per_front: R,
    /// The exponent's part at the middle that is not the sine's.
    start_middle: R,
    sin_middle: R,
    cos_middle: R,
    arc: R,
}

/// The rules of a contact: those of one exponent for all lanes, or of one for each.
pub(crate) trait LeanRules<R> {
    /// Are nodes computed in pairs? Where the rules of each lane are computed first, it gains too little for the code.
    const IN_PAIRS: bool;
    /// How many nodes the friction's rule has.
    fn count(&self) -> usize;
    /// A node of it, four over the node, and its weight.
    fn node(&self, k: usize) -> (R, R, R);
    /// ((y + 3)/4)ⁿ.
    fn power(&self, y: R) -> R;
    /// The cohesion's rule.
    fn cohesion(&self) -> RuleView<'static>;
}

impl<R: Real> LeanRules<R> for SharedRules<'_> {
    const IN_PAIRS: bool = true;

    #[inline(always)]
    fn count(&self) -> usize {
        self.friction.nodes.len()
    }

    #[inline(always)]
    fn node(&self, k: usize) -> (R, R, R) {
        let t = self.friction.nodes[k];
        let weight = self.friction.weights[k];
        (R::from_f64(t), R::from_f64(4.0 / t), R::from_f64(weight))
    }

    #[inline(always)]
    fn power(&self, y: R) -> R {
        estrin(y, self.power)
    }

    #[inline(always)]
    fn cohesion(&self) -> RuleView<'static> {
        self.cohesion
    }
}

impl<R: Real> LeanRules<R> for LaneRules<R> {
    const IN_PAIRS: bool = false;

    #[inline(always)]
    fn count(&self) -> usize {
        self.count
    }

    #[inline(always)]
    fn node(&self, k: usize) -> (R, R, R) {
        let t = self.nodes[k];
        (t, R::from_f64(4.0) / t, self.weights[k])
    }

    #[inline(always)]
    fn power(&self, y: R) -> R {
        // even and odd powers side by side
        let square = y * y;
        let (mut even, mut odd) = (self.power[POWER_TERMS - 1], R::ZERO);
        let mut k = POWER_TERMS - 1;
        while k > 0 {
            odd = odd.mul_add(square, self.power[k - 1]);
            even = even.mul_add(square, self.power[k - 2]);
            k -= 2;
        }
        odd.mul_add(y, even)
    }

    #[inline(always)]
    fn cohesion(&self) -> RuleView<'static> {
        self.cohesion
    }
}

impl<R: Short> LeanContact<R> {
    #[inline(always)]
    pub(crate) fn frame(self) -> Frame<R> {
        let half = R::from_f64(0.5);
        let (sin_1, cos_1) = sine_cosine(self.theta_1);
        let q_r_over_k = self.q * self.r_over_k;
        let start = q_r_over_k * sin_1 - self.r_over_k * self.theta_1;
        let middle = half * (self.theta_1 - self.behind);
        let (sin_middle, cos_middle) = sine_cosine(middle);
        let per_front = R::ONE / (self.front * sin_1);
        Frame {
            start,
            q_r_over_k,
            cos_1,
            per_drop: per_front,
            rear_per_front: self.rear * sin_1 * per_front,
            start_middle: self.r_over_k.mul_add(middle, start),
            sin_middle,
            cos_middle,
            arc: self.theta_1 + self.behind,
            contact: self,
        }
    }

    /// All nodes.
    #[inline(always)]
    pub(crate) fn sums<Rules: LeanRules<R>>(self, rules: &Rules) -> LeanSums<R> {
        let in_pairs = |count: usize| {
            if Rules::IN_PAIRS {
                count - count % 2
            } else {
                0
            }
        };
        let frame = self.frame();
        let mut sums = LeanSums::zero();
        let count = rules.count();
        for k in (0..in_pairs(count)).step_by(2) {
            frame.friction::<2>(k, rules, &mut sums);
        }
        for k in in_pairs(count)..count {
            frame.friction::<1>(k, rules, &mut sums);
        }
        let rule = rules.cohesion();
        // every rule of Legendre's in use has an even number of nodes: its upper half determines them all
        let half = rule.nodes.len() / 2;
        let before = |x: f64| R::from_f64(x - 0.5);
        let (nodes, weights) = (&rule.nodes[half..], &rule.weights[half..]);
        let (nodes, singles) = nodes.split_at(in_pairs(nodes.len()));
        let (weights, single_weights) = weights.split_at(in_pairs(weights.len()));
        let pairs = nodes.as_chunks::<2>().0.iter();
        for (x, weight) in pairs.zip(weights.as_chunks::<2>().0) {
            frame.cohesion(x.map(before), weight.map(R::from_f64), &mut sums);
        }
        for (&x, &weight) in singles.iter().zip(single_weights) {
            frame.cohesion([before(x)], [R::from_f64(weight)], &mut sums);
        }
        frame.finish(&mut sums);
        sums
    }
}

impl<R: Short> Frame<R> {
    /// The mobilised shares, where `along` is the part of the exponent that is not the sine's.
    #[inline(always)]
    fn shares<const N: usize>(&self, sin: [R; N], along: [R; N]) -> [R; N] {
        let exponent = each(sin, along, |sin, along| {
            (-self.q_r_over_k).mul_add(sin, along)
        });
        of_each(R::exp2_short_each(exponent), |x| R::ONE - x)
    }

    /// Nodes of the friction rule from one on: both pieces at once, since σ is the same in both.
    #[inline(always)]
    fn friction<const N: usize>(
        &self,
        from: usize,
        rules: &impl LeanRules<R>,
        sums: &mut LeanSums<R>,
    ) {
        let contact = &self.contact;
        let zero = [R::ZERO; N];
        let (mut front, mut rear, mut four_per_t, mut weight) = (zero, zero, zero, zero);
        for k in 0..N {
            let (t, four, share) = rules.node(from + k);
            front[k] = (-t).mul_add(contact.front, contact.theta_1);
            rear[k] = t.mul_add(contact.rear, -contact.behind);
            (four_per_t[k], weight[k]) = (four, share);
        }
        let (sin, cos) = sine_cosine_each(front);
        let (sin_rear, cos_rear) = sine_cosine_each(rear);
        let along = |theta| contact.r_over_k.mul_add(theta, self.start);
        let share = self.shares(sin, of_each(front, along));
        let share_rear = self.shares(sin_rear, of_each(rear, along));
        for k in 0..N {
            let ratio = (cos[k] - self.cos_1) * self.per_drop;
            let sigma = weight[k] * rules.power(ratio.mul_add(four_per_t[k], R::from_f64(-3.0)));
            sums.stress(sigma, (sin[k], cos[k], share[k]));
            let sigma = sigma * self.rear_per_front;
            sums.stress(sigma, (sin_rear[k], cos_rear[k], share_rear[k]));
        }
    }

    /// Pairs of nodes of the cohesion rule, the share `x` of the arc before and behind its middle. What they
    /// sum is still to be turned by the middle's angle: see [`Frame::finish`].
    #[inline(always)]
    pub(crate) fn cohesion<const N: usize>(
        &self,
        x: [R; N],
        weight: [R; N],
        sums: &mut LeanSums<R>,
    ) {
        let d = of_each(x, |x| x * self.arc);
        let (sin_d, cos_d) = sine_cosine_each(d);
        let beside = of_each(cos_d, |cos| self.sin_middle * cos);
        let across = of_each(sin_d, |sin| self.cos_middle * sin);
        let shift = of_each(d, |d| self.contact.r_over_k * d);
        let ahead = self.shares(
            each(beside, across, |beside, across| beside + across),
            of_each(shift, |shift| self.start_middle + shift),
        );
        let astern = self.shares(
            each(beside, across, |beside, across| beside - across),
            of_each(shift, |shift| self.start_middle - shift),
        );
        for k in 0..N {
            let both = weight[k] * (ahead[k] + astern[k]);
            sums.hold += both;
            sums.hold_along = both.mul_add(cos_d[k], sums.hold_along);
            let difference = weight[k] * (ahead[k] - astern[k]);
            sums.hold_up = difference.mul_add(sin_d[k], sums.hold_up);
        }
    }

    /// Σ x sin θ and Σ x cos θ from the sums of [`Frame::cohesion`], by angle addition.
    #[inline(always)]
    pub(crate) fn finish(&self, sums: &mut LeanSums<R>) {
        let (even, odd) = (sums.hold_along, sums.hold_up);
        sums.hold_up = self.sin_middle * even + self.cos_middle * odd;
        sums.hold_along = self.cos_middle * even - self.sin_middle * odd;
    }
}

impl<R: Real> LeanSums<R> {
    #[inline(always)]
    fn stress(&mut self, sigma: R, (sin, cos, share): (R, R, R)) {
        let grip = sigma * share;
        self.bearing = sigma.mul_add(cos, self.bearing);
        self.resistance = sigma.mul_add(sin, self.resistance);
        self.grip_up = grip.mul_add(sin, self.grip_up);
        self.grip_along = grip.mul_add(cos, self.grip_along);
        self.grip += grip;
    }
}

/// Sine and cosine up to 60°.
#[inline(always)]
pub(crate) fn sine_cosine<R: Real>(theta: R) -> (R, R) {
    let y = theta * theta;
    let sin = (theta * y).mul_add(horner(y, &SINE), theta);
    let cos = horner(y, &COSINE).mul_add(y, R::from_f64(-0.5));
    (sin, cos.mul_add(y, R::ONE))
}

/// A function of each number. Not `map`, which is no part of its caller where that has its own instructions, and then
/// passes every number through memory.
#[inline(always)]
pub(crate) fn of_each<R: Copy, const N: usize>(a: [R; N], f: impl Fn(R) -> R) -> [R; N] {
    let mut out = a;
    for x in &mut out {
        *x = f(*x);
    }
    out
}

/// A function of each pair.
#[inline(always)]
pub(crate) fn each<R: Copy, const N: usize>(a: [R; N], b: [R; N], f: impl Fn(R, R) -> R) -> [R; N] {
    let mut out = a;
    for (x, &b) in out.iter_mut().zip(&b) {
        *x = f(*x, b);
    }
    out
}

/// [`horner`] at some numbers, step by step side by side.
#[inline(always)]
pub(crate) fn horner_each<R: Real, const N: usize>(x: [R; N], coefficients: &[f64]) -> [R; N] {
    let mut sum = [R::ZERO; N];
    for (i, &c) in coefficients.iter().rev().enumerate() {
        sum = if i == 0 {
            [R::from_f64(c); N]
        } else {
            each(sum, x, |sum, x| sum.mul_add(x, R::from_f64(c)))
        };
    }
    sum
}

/// [`sine_cosine`] of some angles, step by step side by side.
#[inline(always)]
pub(crate) fn sine_cosine_each<R: Real, const N: usize>(theta: [R; N]) -> ([R; N], [R; N]) {
    let y = of_each(theta, |theta| theta * theta);
    let (mut sin, mut cos) = (horner_each(y, &SINE), horner_each(y, &COSINE));
    for k in 0..N {
        sin[k] = (theta[k] * y[k]).mul_add(sin[k], theta[k]);
        let cosine = cos[k].mul_add(y[k], R::from_f64(-0.5));
        cos[k] = cosine.mul_add(y[k], R::ONE);
    }
    (sin, cos)
}

/// 1 − cos θ up to 60°, with all its digits.
#[inline(always)]
pub(crate) fn versine<R: Real>(theta: R) -> R {
    let y = theta * theta;
    y * (R::from_f64(0.5) - y * horner(y, &COSINE))
}

/// Σ c_k xᵏ by Horner's rule: the fewest operations.
#[inline(always)]
pub(crate) fn horner<R: Real>(x: R, coefficients: &[f64]) -> R {
    let mut sum = R::ZERO;
    for (i, &c) in coefficients.iter().rev().enumerate() {
        sum = if i == 0 {
            R::from_f64(c)
        } else {
            sum.mul_add(x, R::from_f64(c))
        };
    }
    sum
}

/// Σ c_k xᵏ by Estrin's scheme: neighbours first, then pairs, so that a long polynomial waits for four
/// results and not for twelve.
#[inline(always)]
pub(crate) fn estrin<R: Real, const N: usize>(x: R, coefficients: &[f64; N]) -> R {
    let mut terms = [R::ZERO; 8];
    let mut count = N.div_ceil(2);
    for (k, term) in terms.iter_mut().enumerate().take(count) {
        let low = R::from_f64(coefficients[2 * k]);
        *term = match coefficients.get(2 * k + 1) {
            Some(&high) => R::from_f64(high).mul_add(x, low),
            None => low,
        };
    }
    let mut power = x;
    while count > 1 {
        power = power * power;
        let half = count.div_ceil(2);
        for k in 0..half {
            terms[k] = if 2 * k + 1 < count {
                terms[2 * k + 1].mul_add(power, terms[2 * k])
            } else {
                terms[2 * k]
            };
        }
        count = half;
    }
    terms[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_sine_and_cosine_up_to_60_degrees() {
        for i in 1..=1048 {
            let theta = f64::from(i) * 1e-3;
            let (sin, cos) = sine_cosine(theta);
            assert!((sin / theta.sin() - 1.0).abs() < 1e-12, "{theta}");
            assert!((cos - theta.cos()).abs() < 4e-11, "{theta}");
            let sine = (0.5 * theta).sin();
            assert!((versine(theta) / (2.0 * sine * sine) - 1.0).abs() < 1e-10);
        }
    }
}
