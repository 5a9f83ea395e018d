//! The trait every law is written over.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

/// A real number, or several side by side.
///
/// A comparison gives a mask and a choice is [`Real::select`], because with several numbers side by
/// side (lanes) each one answers for itself. Both arms of a select are computed: an arm that is not
/// chosen may be NaN.
///
/// The functions take radians and follow IEEE 754 in what they do outside their domain: NaN, no panic.
pub trait Real:
    Copy
    + Debug
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// The answer of a comparison: `bool` for one number, one `bool` each for lanes.
    type Mask: Copy
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;

    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// π.
    const PI: Self;

    /// The constant `x` (rounded to this type's precision; no derivative).
    fn from_f64(x: f64) -> Self;

    /// Is `self < other`?
    fn lt(self, other: Self) -> Self::Mask;
    /// Is `self <= other`?
    fn le(self, other: Self) -> Self::Mask;
    /// `a` where the mask holds, else `b`.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;

    /// `self * a + b`, in one rounding where the machine does that fast.
    #[must_use]
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// |x|; its derivative at 0 is taken as +1.
    #[must_use]
    fn abs(self) -> Self;
    /// √x.
    #[must_use]
    fn sqrt(self) -> Self;
    /// eˣ.
    #[must_use]
    fn exp(self) -> Self;
    /// eˣ − 1 without cancellation at small x.
    #[must_use]
    fn exp_m1(self) -> Self;
    /// Natural logarithm.
    #[must_use]
    fn ln(self) -> Self;
    /// ln(1 + x) without cancellation at small x.
    #[must_use]
    fn ln_1p(self) -> Self;
    /// Sine.
    #[must_use]
    fn sin(self) -> Self;
    /// Cosine.
    #[must_use]
    fn cos(self) -> Self;
    /// Tangent.
    #[must_use]
    fn tan(self) -> Self;
    /// Inverse sine.
    #[must_use]
    fn asin(self) -> Self;
    /// Inverse cosine.
    #[must_use]
    fn acos(self) -> Self;
    /// Inverse tangent.
    #[must_use]
    fn atan(self) -> Self;
    /// The angle of the point (`x`, `self`), in (−π, π].
    #[must_use]
    fn atan2(self, x: Self) -> Self;
    /// Hyperbolic sine.
    #[must_use]
    fn sinh(self) -> Self;
    /// Hyperbolic cosine.
    #[must_use]
    fn cosh(self) -> Self;
    /// Hyperbolic tangent.
    #[must_use]
    fn tanh(self) -> Self;
    /// selfⁿ for any real n; the base must not be negative unless n is whole.
    #[must_use]
    fn powf(self, n: Self) -> Self;
    /// selfⁿ for a whole n.
    #[must_use]
    fn powi(self, n: i32) -> Self;

    /// The greater of the two; at equality the derivative is that of `self`.
    #[must_use]
    fn max(self, other: Self) -> Self {
        Self::select(self.lt(other), other, self)
    }
    /// The smaller of the two; at equality the derivative is that of `self`.
    #[must_use]
    fn min(self, other: Self) -> Self {
        Self::select(other.lt(self), other, self)
    }
    /// `self` held between `low` and `high`.
    #[must_use]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
    /// `self` squared.
    #[must_use]
    fn square(self) -> Self {
        self * self
    }
    /// Sine and cosine together.
    fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }
    /// √(self² + other²); 0 with derivative 0 at the origin.
    #[must_use]
    fn hypot(self, other: Self) -> Self {
        let sum = self * self + other * other;
        let positive = Self::ZERO.lt(sum);
        Self::select(
            positive,
            Self::select(positive, sum, Self::ONE).sqrt(),
            Self::ZERO,
        )
    }
}

/// A single number: its value can steer an `if`, a loop count or a bracket.
///
/// For a [`Dual`](crate::Dual) the value is the function's value without its derivative, so that the
/// path through a program depends on the point alone.
pub trait Scalar: Real<Mask = bool> + PartialOrd {
    /// The value in double precision.
    fn value(self) -> f64;
    /// The distance from 1 to the next number of this type.
    const EPSILON: f64;
}
