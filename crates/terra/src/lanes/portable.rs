//! Eight numbers side by side.

use core::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

use grouser_real::Real;

use super::vector::Vector;
use crate::contact::ladder::{Closeness, LaneRules, SharedRules};
use crate::contact::lean::{LeanContact, LeanSums, Short};

/// Eight numbers, computed lane by lane in plain code that every machine has: no lane sees another.
///
/// Every operation is a loop over an array, which the compiler turns into the target's baseline vectors
/// where it can. A product and a sum are rounded one by one, since a fused multiply-add is a slow call on a
/// machine without the instruction.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes(pub [f64; 8]);

/// One truth a lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneMask(pub [bool; 8]);

impl LaneMask {
    #[inline(always)]
    fn each(self, other: Self, f: impl Fn(bool, bool) -> bool) -> Self {
        let mut out = self;
        for (a, b) in out.0.iter_mut().zip(other.0) {
            *a = f(*a, b);
        }
        out
    }
}

impl BitAnd for LaneMask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        self.each(other, |a, b| a & b)
    }
}
impl BitOr for LaneMask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        self.each(other, |a, b| a | b)
    }
}
impl Not for LaneMask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(self.0.map(|a| !a))
    }
}

impl Lanes {
    #[inline(always)]
    fn each(mut self, f: impl Fn(f64) -> f64) -> Self {
        for x in &mut self.0 {
            *x = f(*x);
        }
        self
    }

    #[inline(always)]
    fn with(mut self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a = f(*a, b);
        }
        self
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(f64, f64) -> bool) -> LaneMask {
        let mut mask = [false; 8];
        for ((m, a), b) in mask.iter_mut().zip(self.0).zip(other.0) {
            *m = f(a, b);
        }
        LaneMask(mask)
    }
}

macro_rules! lane_operator {
    ($trait:ident, $name:ident, $assign:ident, $assign_name:ident, $op:tt) => {
        impl $trait for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.with(other, |a, b| a $op b)
            }
        }
        impl $assign for Lanes {
            #[inline(always)]
            fn $assign_name(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
    };
}
lane_operator!(Add, add, AddAssign, add_assign, +);
lane_operator!(Sub, sub, SubAssign, sub_assign, -);
lane_operator!(Mul, mul, MulAssign, mul_assign, *);

impl Div for Lanes {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.with(other, |a, b| a / b)
    }
}
impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.each(|a| -a)
    }
}

/// Functions that the lanes hardly ever need: one number at a time.
macro_rules! one_by_one {
    ($($name:ident),*) => {$(
        #[inline(always)]
        fn $name(self) -> Self {
            self.each(Real::$name)
        }
    )*};
}

impl Real for Lanes {
    type Mask = LaneMask;
    const ZERO: Self = Self([0.0; 8]);
    const ONE: Self = Self([1.0; 8]);
    const PI: Self = Self([core::f64::consts::PI; 8]);

    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        Self([x; 8])
    }
    #[inline(always)]
    fn lt(self, other: Self) -> LaneMask {
        self.compare(other, |a, b| a < b)
    }
    #[inline(always)]
    fn le(self, other: Self) -> LaneMask {
        self.compare(other, |a, b| a <= b)
    }
    #[inline(always)]
    fn select(mask: LaneMask, a: Self, b: Self) -> Self {
        let mut out = b;
        for ((x, y), choose) in out.0.iter_mut().zip(a.0).zip(mask.0) {
            *x = if choose { y } else { *x };
        }
        out
    }
    #[inline(always)]
    fn mul_add(mut self, a: Self, b: Self) -> Self {
        for ((x, a), b) in self.0.iter_mut().zip(a.0).zip(b.0) {
            *x = *x * a + b;
        }
        self
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.each(f64::abs)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.each(Real::sqrt)
    }
    // not inlined: the machine has no wider code for it, and the compiler has less to do
    #[inline(never)]
    fn exp(self) -> Self {
        super::vector::exp(self)
    }
    // not inlined: the machine has no wider code for it, and the compiler has less to do
    #[inline(never)]
    fn ln(self) -> Self {
        super::vector::ln(self)
    }
    #[inline(never)]
    fn powf(self, n: Self) -> Self {
        (n * self.ln()).exp()
    }
    #[inline(never)]
    fn exp_m1(self) -> Self {
        super::vector::exp_m1(self)
    }
    #[inline(never)]
    fn sin(self) -> Self {
        super::vector::sin(self)
    }
    #[inline(never)]
    fn cos(self) -> Self {
        super::vector::cos(self)
    }
    one_by_one!(ln_1p, tan, asin, acos, atan, sinh, cosh, tanh);
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        self.with(x, Real::atan2)
    }
    #[inline(always)]
    fn powi(self, n: i32) -> Self {
        self.each(|x| Real::powi(x, n))
    }
}

impl Short for Lanes {
    #[inline(always)]
    fn exp2_short(self) -> Self {
        super::vector::exp2_short(self)
    }
    #[inline(always)]
    fn exp2_short_each<const N: usize>(x: [Self; N]) -> [Self; N] {
        super::vector::exp2_short_each(x)
    }
    #[inline(always)]
    fn log2_short(self) -> Self {
        super::vector::log2_short(self)
    }
}

impl Vector for Lanes {
    #[inline(always)]
    fn from_array(array: [f64; 8]) -> Self {
        Self(array)
    }
    #[inline(always)]
    fn to_array(self) -> [f64; 8] {
        self.0
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        self.each(|x| f64::from_bits(x.to_bits().wrapping_add(1023) << 52))
    }
    #[inline(always)]
    fn times_power_of_two(self, shifted: Self) -> Self {
        self.with(shifted, |x, k| {
            f64::from_bits(x.to_bits().wrapping_add(k.to_bits() << 52))
        })
    }
    #[inline(always)]
    fn exponent_and_mantissa(self) -> (Self, Self) {
        const MANTISSA: u64 = 0x000f_ffff_ffff_ffff;
        const ONE: u64 = 0x3ff0_0000_0000_0000;
        let exponent = self.each(|x| f64::from_bits((x.to_bits() >> 52) | TWO_52) - EXPONENT_BIAS);
        (
            exponent,
            self.each(|x| f64::from_bits((x.to_bits() & MANTISSA) | ONE)),
        )
    }
    #[inline(never)]
    fn sums(contact: &LeanContact<Self>, rules: &SharedRules<'_>) -> LeanSums<Self> {
        contact.sums(rules)
    }
    #[inline(never)]
    fn lane_sums(contact: &LeanContact<Self>, rules: &LaneRules<Self>) -> LeanSums<Self> {
        contact.sums(rules)
    }
    #[inline(never)]
    fn set_rules(rules: &mut LaneRules<Self>, n: &Self, closeness: Closeness) {
        rules.set_rules(*n, closeness);
    }
    #[inline(never)]
    fn set_power(rules: &mut LaneRules<Self>, n: &Self) {
        rules.set_power(*n);
    }
    #[inline(always)]
    fn any(mask: LaneMask) -> bool {
        mask.0.contains(&true)
    }
}

/// The bits of 2⁵²: a small whole number in its low bits reads 2⁵² plus that number.
pub(super) const TWO_52: u64 = 0x4330_0000_0000_0000;
/// 2⁵² and the bias of an exponent.
pub(super) const EXPONENT_BIAS: f64 = 4_503_599_627_370_496.0 + 1023.0;
