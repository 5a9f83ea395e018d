//! What every kind of eight lanes can do, and the exponential and logarithm made of it.

use crate::contact::ladder::POWER_TERMS;
use crate::contact::lean::{LeanContact, LeanSums, Short, estrin, horner};
use crate::quadrature::RuleView;

/// Eight f64 side by side, on some set of instructions.
pub(super) trait Vector: Short {
    /// From eight numbers.
    fn from_array(array: [f64; 8]) -> Self;
    /// To eight numbers.
    fn to_array(self) -> [f64; 8];
    /// 2ᵏ, where the number is [`TO_WHOLE`] + k with a whole k in [−1022, 1023].
    fn power_of_two(self) -> Self;
    /// x 2ᵏ, where the other number is [`TO_WHOLE`] + k and the result a normal number.
    fn times_power_of_two(self, shifted: Self) -> Self;
    /// k and m of x = 2ᵏ m, m in [1, 2), for a positive normal x.
    fn exponent_and_mantissa(self) -> (Self, Self);
    /// [`LeanContact::sums`], as one function of each set of instructions: compiled once, not wherever it
    /// is called.
    fn sums(
        contact: &LeanContact<Self>,
        rules: (RuleView<'_>, RuleView<'_>),
        power: &[f64; POWER_TERMS],
    ) -> LeanSums<Self>;
    /// Does the mask hold in any lane?
    fn any(mask: Self::Mask) -> bool;

    /// The eight numbers from a place on.
    #[inline(always)]
    fn load(from: &[f64], at: usize) -> Self {
        let mut array = [0.0; 8];
        array.copy_from_slice(&from[at..at + 8]);
        Self::from_array(array)
    }

    /// Puts the eight numbers from a place on.
    #[inline(always)]
    fn store(self, to: &mut [f64], at: usize) {
        to[at..at + 8].copy_from_slice(&self.to_array());
    }
}

/// 1.5 · 2⁵²: adding it rounds to a whole number in the low bits.
pub(super) const TO_WHOLE: f64 = 6_755_399_441_055_744.0;
/// ln 2 in two parts, the first with trailing zeros so that a small multiple of it is exact.
const LN_2_HIGH: f64 = 6.931_471_803_691_238e-1;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// eʳ on |r| ≤ ln 2/2 by interpolation at Chebyshev's points; relative error 5e-18 before rounding.
const EXP: [f64; 12] = [
    1.0,
    1.0,
    0.500_000_000_000_002,
    0.166_666_666_666_666_82,
    0.041_666_666_666_473_29,
    0.008_333_333_333_318_461,
    0.001_388_888_895_621_921_5,
    0.000_198_412_698_930_495_45,
    2.480_148_134_457_032_4e-5,
    2.755_723_773_674_06e-6,
    2.763_415_549_098_948_3e-7,
    2.511_120_325_747_114e-8,
];

/// (2ˣ − 1)/x on |x| ≤ ½ likewise: error of 2ˣ 1.1e-10, and none at 0.
const EXP2_SHORT: [f64; 7] = [
    core::f64::consts::LN_2,
    0.240_226_509_222_887_57,
    0.055_504_108_839_096_185,
    0.009_618_056_678_524_637,
    0.001_333_350_238_616_277,
    0.000_154_614_446_985_691_3,
    1.529_732_376_070_107_5e-5,
];

/// eˣ; 0 below −708 (where eˣ is no normal number), ∞ above 709. NaN in a lane stays in it.
#[inline(always)]
pub(super) fn exp<V: Vector>(x: V) -> V {
    let c = V::from_f64;
    let (low, high) = (c(-708.0), c(709.0));
    let shifted = x
        .clamp(low, high)
        .mul_add(c(core::f64::consts::LOG2_E), c(TO_WHOLE));
    let whole = shifted - c(TO_WHOLE);
    let r = whole.mul_add(c(-LN_2_HIGH), x);
    let r = whole.mul_add(c(-LN_2_LOW), r);
    let y = horner(r, &EXP) * shifted.power_of_two();
    let y = V::select(x.lt(low), V::ZERO, y);
    V::select(high.lt(x), c(f64::INFINITY), y)
}

/// 2ˣ for −1000 ≤ x ≤ ½, to 1.1e-10.
#[inline(always)]
pub(super) fn exp2_short<V: Vector>(x: V) -> V {
    let c = V::from_f64;
    let shifted = x + c(TO_WHOLE);
    let part = x - (shifted - c(TO_WHOLE));
    horner(part, &EXP2_SHORT)
        .mul_add(part, V::ONE)
        .times_power_of_two(shifted)
}

/// Natural logarithm of a positive normal number: ln(2ᵏ m) = k ln 2 + 2 artanh((m − 1)/(m + 1)) with m in
/// [√½, √2]. −∞ for 0 and subnormals, NaN below.
#[inline(always)]
pub(super) fn ln<V: Vector>(x: V) -> V {
    // artanh(s)/s in s², by its series to s²⁰: what is left out is below s²²/23 < 1e-18
    const ARTANH: [f64; 11] = [
        1.0,
        1.0 / 3.0,
        1.0 / 5.0,
        1.0 / 7.0,
        1.0 / 9.0,
        1.0 / 11.0,
        1.0 / 13.0,
        1.0 / 15.0,
        1.0 / 17.0,
        1.0 / 19.0,
        1.0 / 21.0,
    ];
    let c = V::from_f64;
    let (k, m) = x.exponent_and_mantissa();
    let high = c(core::f64::consts::SQRT_2).lt(m);
    let m = V::select(high, c(0.5) * m, m);
    let k = V::select(high, k + V::ONE, k);
    let s = (m - V::ONE) / (m + V::ONE);
    let series = estrin(s * s, &ARTANH);
    let low = k.mul_add(c(LN_2_LOW), (s + s) * series);
    let y = k.mul_add(c(LN_2_HIGH), low);
    let y = V::select(x.lt(c(f64::MIN_POSITIVE)), c(f64::NEG_INFINITY), y);
    let y = V::select(c(f64::MAX).lt(x), x, y);
    V::select(V::ZERO.le(x), y, c(f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::super::Lanes;
    use grouser_real::Real;

    use super::*;

    #[test]
    fn exponential_and_logarithm_to_the_last_digits() {
        for i in -70_000..70_000 {
            let x = f64::from(i) * 0.01;
            let ours = exp(Lanes::from_f64(x)).0[3];
            // the argument's own rounding weighs x eps
            assert!(
                (ours / x.exp() - 1.0).abs() < 4e-16 * (1.0 + 0.01 * x.abs()),
                "{x}: {ours:e}"
            );
            let y = (f64::from(i) * 0.01).exp();
            let back = ln(Lanes::from_f64(y)).0[5];
            assert!(
                (back - y.ln()).abs() <= 4e-16 * y.ln().abs().max(0.4),
                "{y:e}"
            );
            if x <= 0.0 {
                let short = exp2_short(Lanes::from_f64(x)).0[1];
                assert!((short / x.exp2() - 1.0).abs() < 1.6e-10, "{x}");
                let small = 1e-3 * x;
                let change = exp2_short(Lanes::from_f64(small)).0[1] - 1.0;
                let exact = (small * core::f64::consts::LN_2).exp_m1();
                assert!((change - exact).abs() <= 3e-10 * exact.abs() + 2e-16, "{x}");
            }
        }
    }

    #[test]
    fn the_edges() {
        let at = |f: fn(Lanes) -> Lanes, x: f64| f(Lanes::from_f64(x)).0[0];
        assert_eq!(at(exp, -800.0), 0.0);
        assert_eq!(at(exp, f64::NEG_INFINITY), 0.0);
        assert_eq!(at(exp, 800.0), f64::INFINITY);
        assert!(at(exp, f64::NAN).is_nan());
        assert_eq!(at(ln, 0.0), f64::NEG_INFINITY);
        assert_eq!(at(ln, f64::INFINITY), f64::INFINITY);
        assert!(at(ln, -1.0).is_nan() && at(ln, f64::NAN).is_nan());
        assert_eq!(at(exp, 0.0), 1.0);
        assert_eq!(at(ln, 1.0), 0.0);
    }
}
