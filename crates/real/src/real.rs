//! The trait every law is written over.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

/// A real number, or several side by side.
///
/// A comparison gives a mask and a choice is [`Real::select`], because with several numbers side by
/// side (lanes) each one answers for itself. Both arms of a select are computed: an arm that is not
/// chosen may be NaN.
///
/// The functions that are made of others are always inlined: lanes must be compiled into functions that may use the
/// machine's instructions.
///
/// The functions take radians and follow IEEE 754 in what they do outside their domain: NaN, no panic.
///
/// ```
/// use grouser_real::{Dual, Real};
///
/// /// The greater of the roots of x² + p x + q.
/// fn root<R: Real>(p: R, q: R) -> R {
///     let half = p * R::from_f64(0.5);
///     (half.square() - q).sqrt() - half
/// }
/// assert_eq!(root(-5.0, 6.0), 3.0);
/// assert_eq!(root(-5.0_f32, 6.0), 3.0);
/// // ∂x/∂q = −1/(2x + p)
/// assert_eq!(root(Dual::<1>::constant(-5.0), Dual::variable(6.0, 0)).gradient, [-1.0]);
/// ```
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
    ///
    /// ```
    /// use grouser_real::Real;
    ///
    /// assert_eq!(f64::select(Real::lt(1.0, 2.0), 3.0, 4.0), 3.0);
    /// ```
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;

    /// `self * a + b`, in one rounding where the machine does that fast; in two with the feature `deterministic`.
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
    /// Logarithm to base 10; a single number's is exact at powers of ten.
    #[must_use]
    #[inline(always)]
    fn log10(self) -> Self {
        self.ln() * Self::from_f64(core::f64::consts::LOG10_E)
    }
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
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.lt(other), other, self)
    }
    /// The smaller of the two; at equality the derivative is that of `self`.
    #[must_use]
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(other.lt(self), other, self)
    }
    /// `self` held between `low` and `high`.
    ///
    /// ```
    /// use grouser_real::Real;
    ///
    /// assert_eq!(Real::clamp(7.0, 0.0, 1.0), 1.0);
    /// ```
    #[must_use]
    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
    /// `self` squared.
    ///
    /// ```
    /// use grouser_real::Real;
    ///
    /// assert_eq!(3.0_f64.square(), 9.0);
    /// ```
    #[must_use]
    #[inline(always)]
    fn square(self) -> Self {
        self * self
    }
    /// Sine and cosine together.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }
    /// √(self² + other²); 0 with derivative 0 at the origin.
    #[must_use]
    #[inline(always)]
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
///
/// ```
/// use grouser_real::{Dual, Scalar};
///
/// /// A branch that no select expresses: it needs the value.
/// fn steps<R: Scalar>(mut x: R) -> u32 {
///     let mut count = 0;
///     while x.value() > 1.0 {
///         (x, count) = (x.sqrt(), count + 1);
///         if x.value() < 1.0 + 1e-3 {
///             break;
///         }
///     }
///     count
/// }
/// assert_eq!(steps(16.0), steps(Dual::<2>::constant(16.0)));
/// ```
pub trait Scalar: Real<Mask = bool> + PartialOrd {
    /// Whether it is a value alone: no derivative or record depends on how it was computed.
    const IS_PLAIN: bool = false;

    /// The value in double precision.
    fn value(self) -> f64;
}
