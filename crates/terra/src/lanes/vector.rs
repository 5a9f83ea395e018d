//! What every kind of eight lanes can do, and the exponential and logarithm made of it.

use crate::contact::lean::{Short, estrin};

/// Eight f64 side by side, on some set of instructions.
pub(super) trait Vector: Short {
    /// From eight numbers.
    fn from_array(array: [f64; 8]) -> Self;
    /// To eight numbers.
    fn to_array(self) -> [f64; 8];
    /// 2ᵏ, where the number is [`ROUNDER`] + k with a whole k in [−1022, 1023].
    fn power_of_two(self) -> Self;
    /// k and m of x = 2ᵏ m, m in [1, 2), for a positive normal x.
    fn exponent_and_mantissa(self) -> (Self, Self);
    /// Does the mask hold in any lane?
    fn any(mask: Self::Mask) -> bool;

    /// Σ c_k xᵏ by Horner's rule.
    #[inline(always)]
    fn polynomial(self, coefficients: &[f64]) -> Self {
        let mut sum = Self::ZERO;
        for (i, &c) in coefficients.iter().rev().enumerate() {
            let c = Self::from_f64(c);
            sum = if i == 0 { c } else { sum.mul_add(self, c) };
        }
        sum
    }
}

/// 1.5 · 2⁵²: adding it rounds to a whole number that then stands in the low bits.
pub(super) const ROUNDER: f64 = 6_755_399_441_055_744.0;
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

/// The same, shorter: relative error 1.1e-12.
const EXP_SHORT: [f64; 9] = [
    1.0,
    0.999_999_999_979_622_7,
    0.499_999_999_997_963_13,
    0.166_666_668_923_964_95,
    0.041_666_666_892_307_004,
    0.008_333_265_828_313_5,
    0.001_388_882_140_813_945_3,
    0.000_199_160_164_406_045_05,
    2.487_631_345_479_937e-5,
];

/// eˣ; 0 below −708 (where eˣ is no normal number), ∞ above 709. NaN in a lane stays in it.
#[inline(always)]
pub(super) fn exp<V: Vector>(x: V) -> V {
    let c = V::from_f64;
    let (low, high) = (c(-708.0), c(709.0));
    let shifted = x
        .clamp(low, high)
        .mul_add(c(core::f64::consts::LOG2_E), c(ROUNDER));
    let whole = shifted - c(ROUNDER);
    let r = whole.mul_add(c(-LN_2_HIGH), x);
    let r = whole.mul_add(c(-LN_2_LOW), r);
    let y = r.polynomial(&EXP) * shifted.power_of_two();
    let y = V::select(x.lt(low), V::ZERO, y);
    V::select(high.lt(x), c(f64::INFINITY), y)
}

/// eˣ for −700 ≤ x ≤ 0, to 1e-12 of 1.
#[inline(always)]
pub(super) fn exp_short<V: Vector>(x: V) -> V {
    let c = V::from_f64;
    let shifted = x.mul_add(c(core::f64::consts::LOG2_E), c(ROUNDER));
    let whole = shifted - c(ROUNDER);
    // One constant for ln 2: with a whole number below 1000 its rounding weighs 1e-13 of the result.
    estrin(whole.mul_add(c(-core::f64::consts::LN_2), x), &EXP_SHORT) * shifted.power_of_two()
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
    let series = (s * s).polynomial(&ARTANH);
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
                let short = exp_short(Lanes::from_f64(x)).0[1];
                assert!((short - x.exp()).abs() < 2e-12, "{x}");
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
