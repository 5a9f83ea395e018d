//! Numbers that carry their derivatives: forward-mode differentiation, exact to rounding.
//!
//! With x = a + b ε and ε² = 0, f(x) = f(a) + f′(a) b ε: running a formula on such numbers gives its
//! value and its gradient in one pass, without a step size to choose.

use core::cmp::Ordering;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::real::{Real, Scalar};

/// A value with its derivatives in `N` directions.
///
/// ```
/// use grouser_real::{Dual, Real};
/// // d/dx (x eˣ) = (1 + x) eˣ
/// let x = Dual::<1>::variable(0.5, 0);
/// let y = x * x.exp();
/// assert!((y.gradient[0] - 1.5 * 0.5_f64.exp()).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// The value.
    pub value: f64,
    /// The derivative in each of the `N` directions.
    pub gradient: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// A number that depends on nothing.
    ///
    /// ```
    /// assert_eq!(grouser_real::Dual::<2>::constant(3.0).gradient, [0.0, 0.0]);
    /// ```
    #[must_use]
    pub const fn constant(value: f64) -> Self {
        Self {
            value,
            gradient: [0.0; N],
        }
    }

    /// The variable of direction `index`; a constant if `index` is not below `N`.
    ///
    /// ```
    /// use grouser_real::{Dual, Real};
    ///
    /// let x = Dual::<2>::variable(3.0, 0);
    /// let y = Dual::<2>::variable(4.0, 1);
    /// let distance = x.hypot(y);
    /// assert_eq!(distance.value, 5.0);
    /// assert!((distance.gradient[0] - 0.6).abs() < 1e-15 && (distance.gradient[1] - 0.8).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn variable(value: f64, index: usize) -> Self {
        let mut dual = Self::constant(value);
        if let Some(slot) = dual.gradient.get_mut(index) {
            *slot = 1.0;
        }
        dual
    }

    /// The chain rule: a function's `value` at this point and its `slope` there.
    ///
    /// ```
    /// // sin at 0.5 by its value and its slope
    /// let x = grouser_real::Dual::<1>::variable(0.5, 0);
    /// assert_eq!(x.chain(0.5_f64.sin(), 0.5_f64.cos()).gradient, [0.5_f64.cos()]);
    /// ```
    #[inline]
    #[must_use]
    pub fn chain(self, value: f64, slope: f64) -> Self {
        Self {
            value,
            gradient: self.gradient.map(|g| slope * g),
        }
    }

    #[inline]
    fn zip(self, other: Self, value: f64, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut gradient = [0.0; N];
        for ((out, &a), &b) in gradient.iter_mut().zip(&self.gradient).zip(&other.gradient) {
            *out = f(a, b);
        }
        Self { value, gradient }
    }
}

impl<const N: usize> PartialOrd for Dual<N> {
    /// By value: the path through a program depends on the point, not on the direction.
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        self.zip(other, self.value + other.value, |a, b| a + b)
    }
}
impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self.zip(other, self.value - other.value, |a, b| a - b)
    }
}
impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline]
    #[allow(
        clippy::suspicious_arithmetic_impl,
        reason = "the product rule is a sum"
    )]
    fn mul(self, other: Self) -> Self {
        self.zip(other, self.value * other.value, |a, b| {
            a * other.value + self.value * b
        })
    }
}
impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let inverse = 1.0 / other.value;
        let ratio = self.value * inverse;
        self.zip(other, self.value / other.value, |a, b| {
            (a - ratio * b) * inverse
        })
    }
}
impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}
impl<const N: usize> AddAssign for Dual<N> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl<const N: usize> SubAssign for Dual<N> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
impl<const N: usize> MulAssign for Dual<N> {
    #[inline]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<const N: usize> Real for Dual<N> {
    type Mask = bool;
    const ZERO: Self = Self::constant(0.0);
    const ONE: Self = Self::constant(1.0);
    const PI: Self = Self::constant(core::f64::consts::PI);

    #[inline]
    fn from_f64(x: f64) -> Self {
        Self::constant(x)
    }
    #[inline]
    fn lt(self, other: Self) -> bool {
        self.value < other.value
    }
    #[inline]
    fn le(self, other: Self) -> bool {
        self.value <= other.value
    }
    #[inline]
    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }
    #[inline]
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }
    #[inline]
    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }
    #[inline]
    fn sqrt(self) -> Self {
        let root = Real::sqrt(self.value);
        self.chain(root, 0.5 / root)
    }
    #[inline]
    fn exp(self) -> Self {
        let e = Real::exp(self.value);
        self.chain(e, e)
    }
    #[inline]
    fn exp_m1(self) -> Self {
        let e = Real::exp_m1(self.value);
        self.chain(e, e + 1.0)
    }
    #[inline]
    fn ln(self) -> Self {
        self.chain(Real::ln(self.value), 1.0 / self.value)
    }
    #[inline]
    fn ln_1p(self) -> Self {
        self.chain(Real::ln_1p(self.value), 1.0 / (1.0 + self.value))
    }
    #[inline]
    fn sin(self) -> Self {
        self.chain(Real::sin(self.value), Real::cos(self.value))
    }
    #[inline]
    fn cos(self) -> Self {
        self.chain(Real::cos(self.value), -Real::sin(self.value))
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = (Real::sin(self.value), Real::cos(self.value));
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
    #[inline]
    fn tan(self) -> Self {
        let t = Real::tan(self.value);
        self.chain(t, 1.0 + t * t)
    }
    #[inline]
    fn asin(self) -> Self {
        self.chain(
            Real::asin(self.value),
            1.0 / Real::sqrt(1.0 - self.value * self.value),
        )
    }
    #[inline]
    fn acos(self) -> Self {
        self.chain(
            Real::acos(self.value),
            -1.0 / Real::sqrt(1.0 - self.value * self.value),
        )
    }
    #[inline]
    fn atan(self) -> Self {
        self.chain(
            Real::atan(self.value),
            1.0 / (1.0 + self.value * self.value),
        )
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        let square = self.value * self.value + x.value * x.value;
        self.zip(x, Real::atan2(self.value, x.value), |dy, dx| {
            (x.value * dy - self.value * dx) / square
        })
    }
    #[inline]
    fn sinh(self) -> Self {
        self.chain(Real::sinh(self.value), Real::cosh(self.value))
    }
    #[inline]
    fn cosh(self) -> Self {
        self.chain(Real::cosh(self.value), Real::sinh(self.value))
    }
    #[inline]
    fn tanh(self) -> Self {
        let t = Real::tanh(self.value);
        self.chain(t, 1.0 - t * t)
    }
    #[inline]
    fn powf(self, n: Self) -> Self {
        let power = Real::powf(self.value, n.value);
        let by_base = if n.value == 0.0 {
            0.0
        } else if power.is_normal() {
            // the power is there already; a second one would cost as much again (a normal power has a base other than 0)
            n.value * power / self.value
        } else {
            n.value * Real::powf(self.value, n.value - 1.0)
        };
        // aⁿ ln a → 0 as a → 0 for n > 0; a constant exponent must not turn a negative base's ln into NaN.
        let by_exponent = if self.value > 0.0 {
            power * Real::ln(self.value)
        } else {
            0.0
        };
        self.zip(n, power, |a, b| by_base * a + by_exponent * b)
    }
    #[inline]
    fn powi(self, n: i32) -> Self {
        let slope = if n == 0 {
            0.0
        } else {
            f64::from(n) * Real::powi(self.value, n - 1)
        };
        self.chain(Real::powi(self.value, n), slope)
    }
}

impl<const N: usize> Scalar for Dual<N> {
    #[inline]
    fn value(self) -> f64 {
        self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Central difference of `f` at `x`, error O(h²) with h = 1e-5: good to about 1e-9.
    fn difference(f: impl Fn(f64) -> f64, x: f64) -> f64 {
        let h = 1e-5;
        (f(x + h) - f(x - h)) / (2.0 * h)
    }

    macro_rules! derivative_tests {
        ($($name:ident at $x:expr),* $(,)?) => {$(
            #[test]
            fn $name() {
                let exact = Real::$name(Dual::<2>::variable($x, 1));
                assert_eq!(exact.value, Real::$name($x));
                assert_eq!(exact.gradient[0], 0.0);
                let expected = difference(|x| Real::$name(x), $x);
                assert!((exact.gradient[1] - expected).abs() < 1e-8 * (1.0 + expected.abs()));
            }
        )*};
    }
    derivative_tests!(
        abs at -0.7_f64, sqrt at 0.3_f64, exp at 0.3_f64, exp_m1 at -0.2_f64, ln at 0.3_f64,
        ln_1p at 0.3_f64, sin at 0.3_f64, cos at 0.3_f64, tan at 0.3_f64, asin at 0.3_f64,
        acos at 0.3_f64, atan at 0.3_f64, sinh at 0.3_f64, cosh at 0.3_f64, tanh at 0.3_f64,
        log10 at 0.3_f64,
    );

    /// Two variables at points of all signs, with gradients other than 0 and 1.
    fn pairs() -> impl Iterator<Item = (Dual<2>, Dual<2>)> {
        let values = [-3.5, -1.0, -0.25, 0.0, 0.5, 1.0, 7.0];
        let dual = |value: f64, gradient| Dual { value, gradient };
        let pair = move |x, y| (dual(x, [2.0, -3.0]), dual(y, [0.5, 5.0]));
        values
            .into_iter()
            .flat_map(move |x| values.map(|y| pair(x, y)))
    }

    #[test]
    fn operations_with_assignment_are_the_operations() {
        for (x, y) in pairs() {
            let (mut sum, mut difference, mut product) = (x, x, x);
            sum += y;
            difference -= y;
            product *= y;
            assert_eq!((sum, difference, product), (x + y, x - y, x * y));
            assert_eq!(x.mul_add(y, sum), x * y + sum);
            assert_eq!((x * y).gradient[0], 2.0 * y.value + 0.5 * x.value);
        }
    }

    #[test]
    fn comparisons_are_those_of_the_values() {
        for (x, y) in pairs() {
            let (a, b) = (x.value(), y.value());
            assert_eq!((a, b), (x.value, y.value));
            assert_eq!(x.partial_cmp(&y), a.partial_cmp(&b));
            assert_eq!((x.lt(y), Real::le(x, y)), (a < b, a <= b), "{a} {b}");
        }
        let nan = Dual::<2>::constant(f64::NAN);
        assert!(nan.partial_cmp(&nan).is_none() && !Real::le(nan, nan));
    }

    #[test]
    fn sine_and_cosine_together_are_both_alone() {
        for (x, _) in pairs() {
            assert_eq!(x.sin_cos(), (x.sin(), x.cos()));
        }
    }

    /// d(xⁿ)/dx = n xⁿ⁻¹ where xⁿ is no normal number: at 0 and below the range.
    #[test]
    fn slopes_of_powers_outlast_the_powers() {
        let slope = |x: f64, n: f64| Dual::<1>::variable(x, 0).powf(Dual::constant(n)).gradient[0];
        assert_eq!((slope(0.0, 1.0), slope(0.0, 3.0)), (1.0, 0.0));
        for (x, n, expected) in [(1e-200, 2.0, 2e-200), (-1e-110, 3.0, 3e-220)] {
            assert!((slope(x, n) / expected - 1.0).abs() < 1e-14, "{x:e}");
        }
    }

    #[test]
    fn two_argument_functions() {
        fn f<R: Real>(x: R, y: R) -> R {
            x.powf(y) + x.atan2(y) / y + x.hypot(y) - y.powi(3)
        }
        let (x, y) = (0.8, 1.7);
        let exact = f(Dual::<2>::variable(x, 0), Dual::variable(y, 1));
        assert!((exact.value - f(x, y)).abs() < 1e-15);
        assert!((exact.gradient[0] - difference(|x| f(x, y), x)).abs() < 1e-8);
        assert!((exact.gradient[1] - difference(|y| f(x, y), y)).abs() < 1e-8);
    }

    #[test]
    fn kinks_and_origins_stay_finite() {
        let zero = Dual::<1>::variable(0.0, 0);
        assert_eq!(zero.abs().gradient, [1.0]);
        assert_eq!(zero.hypot(Dual::ZERO).gradient, [0.0]);
        assert_eq!(zero.powf(Dual::constant(2.0)).gradient, [0.0]);
        assert_eq!(
            Dual::<1>::variable(-2.0, 0)
                .powf(Dual::constant(2.0))
                .gradient,
            [-4.0]
        );
        assert_eq!(zero.max(Dual::ZERO).gradient, [1.0]);
    }
}
