//! What every kind of eight lanes can do, and the elementary functions made of it.

use grouser_real::Real;

use crate::contact::ladder::{Closeness, LaneRules, SharedRules};
use crate::contact::lean::{
    LeanContact, LeanSums, Short, each, estrin, horner, horner_each, of_each,
};

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
    fn sums(contact: &LeanContact<Self>, rules: &SharedRules<'_>) -> LeanSums<Self>;
    /// The same where each lane has its own exponent.
    fn lane_sums(contact: &LeanContact<Self>, rules: &LaneRules<Self>) -> LeanSums<Self>;
    /// [`LaneRules::set_rules`] likewise.
    fn set_rules(rules: &mut LaneRules<Self>, n: &Self, closeness: Closeness);
    /// [`LaneRules::set_power`] likewise.
    fn set_power(rules: &mut LaneRules<Self>, n: &Self);
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

/// (eʳ − 1)/r: the same polynomial without its first term.
const EXP_AFTER_ONE: [f64; 11] = {
    let mut tail = [0.0; 11];
    let mut i = 0;
    while i < tail.len() {
        tail[i] = EXP[i + 1];
        i += 1;
    }
    tail
};

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
    let y = estrin(r, &EXP_AFTER_ONE).mul_add(r, V::ONE) * shifted.power_of_two();
    let y = V::select(x.lt(low), V::ZERO, y);
    V::select(high.lt(x), c(f64::INFINITY), y)
}

/// eˣ − 1 without cancellation at small x: 2ᵏ (eʳ − 1) + (2ᵏ − 1). ∞ above 709. NaN in a lane stays in it.
#[inline(always)]
pub(super) fn exp_m1<V: Vector>(x: V) -> V {
    let c = V::from_f64;
    let high = c(709.0);
    // below −40 the result is −1 to rounding
    let shifted = x
        .clamp(c(-40.0), high)
        .mul_add(c(core::f64::consts::LOG2_E), c(TO_WHOLE));
    let whole = shifted - c(TO_WHOLE);
    let r = whole.mul_add(c(-LN_2_HIGH), x.max(c(-40.0)));
    let r = whole.mul_add(c(-LN_2_LOW), r);
    let scale = shifted.power_of_two();
    let y = (horner(r, &EXP_AFTER_ONE) * r).mul_add(scale, scale - V::ONE);
    V::select(high.lt(x), c(f64::INFINITY), y)
}

/// π in three parts, the first two with trailing zeros so that a small multiple of either is exact.
const PI_PARTS: [f64; 3] = [
    3.141_592_653_584_666_6,
    5.126_688_302_532_637e-12,
    6.564_007_085_747_001e-22,
];
/// Greatest |x| whose nearest multiple of π the parts take off to rounding.
const MAX_REDUCED_RAD: f64 = 1e4;

/// sin r/r in r² for |r| ≤ π/2 by interpolation at Chebyshev's points; error 1.5e-17 before rounding.
const SINE: [f64; 9] = [
    1.0,
    -0.166_666_666_666_666_66,
    0.008_333_333_333_333_186,
    -0.000_198_412_698_412_086_76,
    2.755_731_921_122_952_6e-6,
    -2.505_210_689_056_195_3e-8,
    1.605_894_087_809_63e-10,
    -7.643_026_547_544_204e-13,
    2.721_574_829_614_071_6e-15,
];

/// cos r in r² likewise; error 1.5e-17.
const COSINE: [f64; 10] = [
    1.0,
    -0.5,
    0.041_666_666_666_666_66,
    -0.001_388_888_888_888_853,
    2.480_158_730_149_264e-5,
    -2.755_731_920_965_437_7e-7,
    2.087_675_566_657_221_6e-9,
    -1.147_067_016_503_734e-11,
    4.776_872_242_578_648_5e-14,
    -1.511_982_720_811_146e-16,
];

/// x less its nearest multiple of π, and the sign that sine and cosine take with it: −1 for an odd multiple.
#[inline(always)]
fn reduce<V: Vector>(x: V) -> (V, V) {
    let c = V::from_f64;
    let round = |x: V| x + c(TO_WHOLE) - c(TO_WHOLE);
    let whole = round(x * c(core::f64::consts::FRAC_1_PI));
    let mut r = x;
    for part in PI_PARTS {
        r = whole.mul_add(c(-part), r);
    }
    let half = c(0.5) * whole;
    let odd = c(0.25).lt((half - round(half)).abs());
    (r, V::select(odd, -V::ONE, V::ONE))
}

/// A function lane by lane, out of the way of the short path.
#[cold]
#[inline(never)]
fn far(x: [f64; 8], f: fn(f64) -> f64) -> [f64; 8] {
    x.map(f)
}

/// sin x to 6e-16 absolutely for |x| ≤ 1e4 (lane by lane beyond), and to 5e-16 relatively at small x.
#[inline(always)]
pub(super) fn sin<V: Vector>(x: V) -> V {
    if V::any(V::from_f64(MAX_REDUCED_RAD).lt(x.abs())) {
        return V::from_array(far(x.to_array(), Real::sin));
    }
    let (r, sign) = reduce(x);
    sign * r * estrin(r * r, &SINE)
}

/// cos x to 6e-16 absolutely for |x| ≤ 1e4 (lane by lane beyond).
#[inline(always)]
pub(super) fn cos<V: Vector>(x: V) -> V {
    if V::any(V::from_f64(MAX_REDUCED_RAD).lt(x.abs())) {
        return V::from_array(far(x.to_array(), Real::cos));
    }
    let (r, sign) = reduce(x);
    sign * estrin(r * r, &COSINE)
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

/// [`exp2_short`] of some numbers, step by step side by side.
#[inline(always)]
pub(super) fn exp2_short_each<V: Vector, const N: usize>(x: [V; N]) -> [V; N] {
    let c = V::from_f64;
    let shifted = of_each(x, |x| x + c(TO_WHOLE));
    let whole = of_each(shifted, |x| x - c(TO_WHOLE));
    let part = each(x, whole, |x, whole| x - whole);
    let sum = horner_each(part, &EXP2_SHORT);
    let sum = each(sum, part, |sum, part| sum.mul_add(part, V::ONE));
    each(sum, shifted, V::times_power_of_two)
}

/// Base-2 logarithm of a positive normal number as in [`ln`], by its series to s¹²: what is left out is below 7e-13.
#[inline(always)]
pub(super) fn log2_short<V: Vector>(x: V) -> V {
    const TWICE_LOG2_E: f64 = 2.0 * core::f64::consts::LOG2_E;
    const ARTANH: [f64; 7] = [
        TWICE_LOG2_E,
        TWICE_LOG2_E / 3.0,
        TWICE_LOG2_E / 5.0,
        TWICE_LOG2_E / 7.0,
        TWICE_LOG2_E / 9.0,
        TWICE_LOG2_E / 11.0,
        TWICE_LOG2_E / 13.0,
    ];
    let c = V::from_f64;
    let (k, m) = x.exponent_and_mantissa();
    let high = c(core::f64::consts::SQRT_2).lt(m);
    let m = V::select(high, c(0.5) * m, m);
    let k = V::select(high, k + V::ONE, k);
    let s = (m - V::ONE) / (m + V::ONE);
    estrin(s * s, &ARTANH).mul_add(s, k)
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
            if y >= f64::MIN_POSITIVE && y.is_finite() {
                let log = log2_short(Lanes::from_f64(y)).0[2];
                assert!((log - y.log2()).abs() <= 1e-12 + 2e-16 * log.abs(), "{y:e}");
            }
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
    fn sine_and_cosine_to_the_last_digits() {
        for i in -20_000..20_000 {
            let x = f64::from(i) * 3.7e-4;
            let (sine, cosine) = (sin(Lanes::from_f64(x)).0[2], cos(Lanes::from_f64(x)).0[6]);
            assert!((sine - x.sin()).abs() <= 6e-16, "{x}: {sine:e}");
            assert!((cosine - x.cos()).abs() <= 6e-16, "{x}: {cosine:e}");
            let small = 1e-6 * x;
            let sine = sin(Lanes::from_f64(small)).0[2];
            assert!(
                (sine - small.sin()).abs() <= 5e-16 * small.abs(),
                "{small:e}"
            );
            let far = 1400.0 * x;
            let (sine, cosine) = (
                sin(Lanes::from_f64(far)).0[2],
                cos(Lanes::from_f64(far)).0[6],
            );
            assert!((sine - far.sin()).abs() <= 6e-16, "{far}: {sine:e}");
            assert!((cosine - far.cos()).abs() <= 6e-16, "{far}: {cosine:e}");
        }
        assert!(sin(Lanes::from_f64(f64::NAN)).0[0].is_nan());
    }

    #[test]
    fn the_exponential_less_one_to_the_last_digits() {
        for i in -400_000..4_000 {
            let x = f64::from(i) * 1.3e-4;
            for x in [x, 1e-5 * x] {
                let ours = exp_m1(Lanes::from_f64(x)).0[7];
                assert!(
                    (ours - x.exp_m1()).abs() <= 5e-16 * x.exp_m1().abs(),
                    "{x}: {ours:e}"
                );
            }
        }
        assert_eq!(exp_m1(Lanes::from_f64(-1e9)).0[0], -1.0);
        assert_eq!(exp_m1(Lanes::from_f64(f64::NEG_INFINITY)).0[0], -1.0);
        assert_eq!(exp_m1(Lanes::from_f64(1e4)).0[0], f64::INFINITY);
        assert!(exp_m1(Lanes::from_f64(f64::NAN)).0[0].is_nan());
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
