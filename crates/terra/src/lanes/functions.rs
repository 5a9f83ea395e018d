//! Exponential and logarithm of eight numbers: polynomials, no table, no branch.

use grouser_real::Real;

use super::Lanes;
use crate::contact::lean::Short;

/// 1.5 · 2⁵²: adding it rounds to a whole number that then stands in the low bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0;
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

/// eˣ; 0 below −708 (where e^x is no normal number), ∞ above 709, NaN for NaN.
#[inline(always)]
pub(super) fn exp<const FUSED: bool>(x: Lanes<FUSED>) -> Lanes<FUSED> {
    let splat = Lanes::<FUSED>::splat;
    let shifted = x.mul_add(splat(core::f64::consts::LOG2_E), splat(ROUNDER));
    let whole = shifted - splat(ROUNDER);
    let r = whole.mul_add(splat(-LN_2_HIGH), x);
    let r = whole.mul_add(splat(-LN_2_LOW), r);
    let mut out = r.polynomial(&EXP);
    for (y, s) in out.0.iter_mut().zip(shifted.0) {
        // the whole number's low bits, moved into the exponent of 1
        *y *= f64::from_bits(s.to_bits().wrapping_add(1023) << 52);
    }
    for (y, x) in out.0.iter_mut().zip(x.0) {
        *y = if x < -708.0 { 0.0 } else { *y };
        *y = if x > 709.0 { f64::INFINITY } else { *y };
        *y = if x.is_nan() { x } else { *y };
    }
    out
}

/// eʳ on |r| ≤ ln 2/2, shorter: relative error 1.1e-12.
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

impl<const FUSED: bool> Short for Lanes<FUSED> {
    #[inline(always)]
    fn exp_short(self) -> Self {
        let splat = Self::splat;
        let shifted = self.mul_add(splat(core::f64::consts::LOG2_E), splat(ROUNDER));
        let whole = shifted - splat(ROUNDER);
        // One constant for ln 2: with a whole number below 1000 its rounding weighs 1e-13 of the result.
        let mut out = whole
            .mul_add(splat(-core::f64::consts::LN_2), self)
            .polynomial(&EXP_SHORT);
        for (y, s) in out.0.iter_mut().zip(shifted.0) {
            *y *= f64::from_bits(s.to_bits().wrapping_add(1023) << 52);
        }
        out
    }
}

/// Natural logarithm of a positive normal number: ln(2ᵏ m) = k ln 2 + 2 artanh((m − 1)/(m + 1)) with m in
/// [√½, √2]. −∞ for 0 and subnormals, NaN below.
#[inline(always)]
pub(super) fn ln<const FUSED: bool>(x: Lanes<FUSED>) -> Lanes<FUSED> {
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
    const MANTISSA: u64 = 0x000f_ffff_ffff_ffff;
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    /// The bits of 2⁵²: a small whole number in its low bits reads 2⁵² plus that number.
    const TWO_52: u64 = 0x4330_0000_0000_0000;
    let (mut mantissa, mut exponent) = (x, x);
    for (m, k) in mantissa.0.iter_mut().zip(&mut exponent.0) {
        let bits = m.to_bits();
        *k = f64::from_bits((bits >> 52) | TWO_52) - (4_503_599_627_370_496.0 + 1023.0);
        *m = f64::from_bits((bits & MANTISSA) | ONE);
        let high = *m > core::f64::consts::SQRT_2;
        *m = if high { 0.5 * *m } else { *m };
        *k = if high { *k + 1.0 } else { *k };
    }
    let splat = Lanes::<FUSED>::splat;
    let s = (mantissa - splat(1.0)) / (mantissa + splat(1.0));
    let series = (s * s).polynomial(&ARTANH);
    let low = exponent.mul_add(splat(LN_2_LOW), (s + s) * series);
    let mut out = exponent.mul_add(splat(LN_2_HIGH), low);
    for (y, x) in out.0.iter_mut().zip(x.0) {
        *y = if x < f64::MIN_POSITIVE {
            f64::NEG_INFINITY
        } else {
            *y
        };
        *y = if x == f64::INFINITY { x } else { *y };
        *y = if x < 0.0 || x.is_nan() { f64::NAN } else { *y };
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponential_and_logarithm_to_the_last_digits() {
        for i in -70_000..70_000 {
            let x = f64::from(i) * 0.01;
            let ours = exp(Lanes::<false>::splat(x)).0[3];
            // the argument's own rounding weighs x eps
            assert!(
                (ours / x.exp() - 1.0).abs() < 4e-16 * (1.0 + 0.01 * x.abs()),
                "{x}: {ours:e}"
            );
            let y = (f64::from(i) * 0.01).exp();
            let back = ln(Lanes::<false>::splat(y)).0[5];
            assert!(
                (back - y.ln()).abs() <= 4e-16 * y.ln().abs().max(0.4),
                "{y:e}"
            );
        }
    }

    #[test]
    fn the_edges() {
        let at = |f: fn(Lanes<false>) -> Lanes<false>, x: f64| f(Lanes::splat(x)).0[0];
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
