//! The lean kernel: the forces of a wheel that drives straight ahead, and nothing else.
//!
//! It is the same stress model as [`Contact`](super::Contact), cut to the case that nearly every question
//! is about (no slip angle, no change of sign of the shear, sinkage at most half the radius), so that each
//! node costs one sine, one exponential and two dozen products. Written over [`Real`]: on lanes a lane is
//! an operating point, or a node of one operating point.
//!
//! With h = (θ_1 − θ)/2: cos θ − cos θ_1 = 2 sin(θ_1 − h) sin h and sin θ_1 − sin θ = 2 cos(θ_1 − h) sin h, so
//! that sin h and cos h by short polynomials give everything by angle addition. σ is A (L sin θ_1)ⁿ tⁿ ratioⁿ
//! with ratio = (cos(θ_1 − u) − cos θ_1)/(u sin θ_1) in [½, 1]: its power is a polynomial of the soil.

use grouser_real::Real;

use super::ladder::POWER_TERMS;
use crate::quadrature::RuleView;

/// (sin h/h − 1)/h² and (cos h − 1)/h² in h² for |h| ≤ 0.85, by interpolation at Chebyshev's points:
/// relative errors 4e-13 and 2e-12. The leading 1 stays exact, so that nothing is lost at small angles.
const SINE: [f64; 5] = [
    -0.166_666_666_666_605_46,
    0.008_333_333_329_096_262,
    -0.000_198_412_651_480_058_1,
    2.755_549_892_557_353e-6,
    -2.476_365_781_832_745e-8,
];
const COSINE: [f64; 5] = [
    -0.499_999_999_999_205_2,
    0.041_666_666_611_657_05,
    -0.001_388_888_279_531_379,
    2.479_922_359_605_860_4e-5,
    -2.718_267_551_536_134_5e-7,
];

/// Greatest half arc that the polynomials serve, rad.
pub(crate) const HALF_ARC: f64 = 0.85;

/// Least sinkage over radius: below it j loses digits by cancellation when slip is near 0.
pub(crate) const LEAST_SINKAGE: f64 = 4.5e-4;
/// Greatest sinkage over radius: θ_1 = 60°.
pub(crate) const GREATEST_SINKAGE: f64 = 0.5;

/// A number whose exponential of a negative argument may be short: to 1e-12 of 1.
pub(crate) trait Short: Real {
    /// eˣ for −700 ≤ x ≤ 0.
    #[inline(always)]
    fn exp_short(self) -> Self {
        self.exp()
    }
}

impl Short for f64 {}
impl Short for f32 {}
impl<const N: usize> Short for grouser_real::Dual<N> {}

/// An operating point as the lean kernel takes it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeanContact<R> {
    pub(crate) sin_1: R,
    pub(crate) cos_1: R,
    /// 1/sin θ_1.
    pub(crate) inverse_sin_1: R,
    /// θ_1 − θ_m.
    pub(crate) front: R,
    /// θ_m − θ_2.
    pub(crate) rear: R,
    /// q = v/(r ω).
    pub(crate) q: R,
    /// −r/K.
    pub(crate) minus_r_over_k: R,
    pub(crate) tan_phi: R,
}

/// Σ over nodes of weight times what makes vertical force, drawbar pull and torque.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeanSums<R> {
    pub(crate) vertical: R,
    pub(crate) pull: R,
    pub(crate) torque: R,
}

impl<R: Real> LeanSums<R> {
    #[inline(always)]
    pub(crate) fn zero() -> Self {
        Self {
            vertical: R::ZERO,
            pull: R::ZERO,
            torque: R::ZERO,
        }
    }
}

/// What one angle of the contact needs.
struct Node<R> {
    sin: R,
    cos: R,
    /// 1 − e^(−j/K).
    mobilised: R,
    /// sin(θ_1 − h) sin h/h.
    shape: R,
}

impl<R: Short> LeanContact<R> {
    /// The angle half an arc `h` twice behind the entry.
    #[inline(always)]
    fn node(&self, h: R) -> Node<R> {
        let y = h * h;
        let sinc = horner(y, &SINE).mul_add(y, R::ONE);
        let cos_h = horner(y, &COSINE).mul_add(y, R::ONE);
        let sin_h = sinc * h;
        let low = self.sin_1 * cos_h - self.cos_1 * sin_h; // sin(θ_1 − h)
        let high = self.sin_1.mul_add(sin_h, self.cos_1 * cos_h); // cos(θ_1 − h)
        let twice = sin_h + sin_h;
        let chord = high * twice; // sin θ_1 − sin θ
        let arc = h + h;
        let stretch = arc - self.q * chord; // j/r
        Node {
            sin: self.sin_1 - chord,
            cos: low.mul_add(twice, self.cos_1),
            mobilised: R::ONE - (stretch * self.minus_r_over_k).exp_short(),
            shape: low * sinc,
        }
    }

    /// A node of the friction rule: both pieces at once, since σ is the same in both.
    #[inline(always)]
    pub(crate) fn friction(
        &self,
        t: R,
        weight: R,
        power: &[f64; POWER_TERMS],
        sums: &mut LeanSums<R>,
    ) {
        let half = R::from_f64(0.5);
        let front = self.node(t * self.front * half);
        let ratio = front.shape * self.inverse_sin_1;
        let sigma = weight * estrin(ratio.mul_add(R::from_f64(4.0), R::from_f64(-3.0)), power);
        sums.stress(&front, sigma * self.front, self.tan_phi);
        let rear = self.node((self.front + self.rear - t * self.rear) * half);
        sums.stress(&rear, sigma * self.rear, self.tan_phi);
    }

    /// A node of the cohesion rule, at the share `x` of the arc.
    #[inline(always)]
    pub(crate) fn cohesion(&self, x: R, weight: R, sums: &mut LeanSums<R>) {
        let node = self.node(x * (self.front + self.rear) * R::from_f64(0.5));
        let tau = weight * node.mobilised;
        sums.vertical = tau.mul_add(node.sin, sums.vertical);
        sums.pull = tau.mul_add(node.cos, sums.pull);
        sums.torque += tau;
    }

    /// All nodes, one after the other. Friction per A (L sin θ_1)ⁿ, cohesion per c times the arc.
    #[inline(always)]
    pub(crate) fn sums(
        &self,
        rules: (RuleView<'_>, RuleView<'_>),
        power: &[f64; POWER_TERMS],
    ) -> (LeanSums<R>, LeanSums<R>) {
        let (mut friction, mut cohesion) = (LeanSums::zero(), LeanSums::zero());
        for (&t, &weight) in rules.0.nodes.iter().zip(rules.0.weights) {
            self.friction(R::from_f64(t), R::from_f64(weight), power, &mut friction);
        }
        for (&x, &weight) in rules.1.nodes.iter().zip(rules.1.weights) {
            self.cohesion(R::from_f64(x), R::from_f64(weight), &mut cohesion);
        }
        (friction, cohesion)
    }
}

impl<R: Real> LeanSums<R> {
    /// σ (cos θ + tan φ x sin θ), σ (tan φ x cos θ − sin θ) and σ tan φ x.
    #[inline(always)]
    fn stress(&mut self, node: &Node<R>, sigma: R, tan_phi: R) {
        let grip = tan_phi * node.mobilised;
        self.vertical = sigma.mul_add(grip.mul_add(node.sin, node.cos), self.vertical);
        self.pull = sigma.mul_add(grip * node.cos - node.sin, self.pull);
        self.torque = sigma.mul_add(grip, self.torque);
    }
}

/// Σ c_k xᵏ by Horner's rule: the fewest operations.
#[inline(always)]
fn horner<R: Real>(x: R, coefficients: &[f64]) -> R {
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
