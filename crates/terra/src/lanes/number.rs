//! Eight numbers side by side.

use core::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

use grouser_real::Real;

/// Eight numbers, computed lane by lane: no lane sees another.
///
/// `FUSED` says whether a product and a sum are rounded once (fused multiply-add): only code that is
/// compiled for a machine that has the instruction may set it, anywhere else it would be a slow call.
///
/// Every operation is a plain loop over an array that the compiler turns into vector instructions, as long
/// as all of it is inlined into a function compiled for them. Eight lanes are two AVX registers; sixteen
/// were tried elsewhere and fell apart into memory traffic.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes<const FUSED: bool>(pub [f64; 8]);

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

impl<const FUSED: bool> Lanes<FUSED> {
    /// The same number in every lane.
    #[inline(always)]
    pub const fn splat(x: f64) -> Self {
        Self([x; 8])
    }

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

    /// Σ c_k xᵏ by Horner's rule.
    #[inline(always)]
    pub(crate) fn polynomial(self, coefficients: &[f64]) -> Self {
        let mut sum = Self::splat(0.0);
        for (i, &c) in coefficients.iter().rev().enumerate() {
            sum = if i == 0 {
                Self::splat(c)
            } else {
                sum.mul_add(self, Self::splat(c))
            };
        }
        sum
    }
}

macro_rules! lane_operator {
    ($trait:ident, $name:ident, $assign:ident, $assign_name:ident, $op:tt) => {
        impl<const FUSED: bool> $trait for Lanes<FUSED> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.with(other, |a, b| a $op b)
            }
        }
        impl<const FUSED: bool> $assign for Lanes<FUSED> {
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

impl<const FUSED: bool> Div for Lanes<FUSED> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.with(other, |a, b| a / b)
    }
}
impl<const FUSED: bool> Neg for Lanes<FUSED> {
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

impl<const FUSED: bool> Real for Lanes<FUSED> {
    type Mask = LaneMask;
    const ZERO: Self = Self::splat(0.0);
    const ONE: Self = Self::splat(1.0);
    const PI: Self = Self::splat(core::f64::consts::PI);

    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        Self::splat(x)
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
            *x = fused_or_not::<FUSED>(*x, a, b);
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
    #[inline(always)]
    fn exp(self) -> Self {
        super::functions::exp(self)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        super::functions::ln(self)
    }
    #[inline(always)]
    fn powf(self, n: Self) -> Self {
        (n * self.ln()).exp()
    }
    one_by_one!(
        exp_m1, ln_1p, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh
    );
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        self.with(x, Real::atan2)
    }
    #[inline(always)]
    fn powi(self, n: i32) -> Self {
        self.each(|x| Real::powi(x, n))
    }
}

/// a b + c, rounded once if `FUSED`.
#[inline(always)]
fn fused_or_not<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    #[cfg(feature = "std")]
    if FUSED {
        return f64::mul_add(a, b, c);
    }
    a * b + c
}
