//! The four basic operations, comparison, and the choice between two numbers.

use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use super::Interval;

/// The sum and the sign of what its rounding left out (Knuth's two-sum; exact without overflow).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    let left_out = (a - (sum - of_b)) + (b - of_b);
    (sum, left_out)
}

/// The sum rounded down: itself where it is exact or was rounded down already.
fn sum_down(a: f64, b: f64) -> f64 {
    let (sum, left_out) = two_sum(a, b);
    if left_out >= 0.0 {
        sum
    } else {
        sum.next_down()
    }
}

/// The sum rounded up.
fn sum_up(a: f64, b: f64) -> f64 {
    let (sum, left_out) = two_sum(a, b);
    if left_out <= 0.0 { sum } else { sum.next_up() }
}

/// An interval between two rounded ends; every number where ∞ − ∞ left an end open.
fn between(low: f64, high: f64) -> Interval {
    Interval {
        low: if low.is_nan() { f64::NEG_INFINITY } else { low },
        high: if high.is_nan() { f64::INFINITY } else { high },
    }
}

impl Add for Interval {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        between(sum_down(self.low, other.low), sum_up(self.high, other.high))
    }
}

impl Sub for Interval {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        between(
            sum_down(self.low, -other.high),
            sum_up(self.high, -other.low),
        )
    }
}

impl Neg for Interval {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            low: -self.high,
            high: -self.low,
        }
    }
}

/// A product of ends, where 0 · ∞ is 0: an infinite end stands for numbers without limit, not for ∞.
fn product(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

impl Mul for Interval {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        if self == Self::ZERO || other == Self::ZERO {
            return Self::ZERO;
        }
        let (a, b, c, d) = (
            product(self.low, other.low),
            product(self.low, other.high),
            product(self.high, other.low),
            product(self.high, other.high),
        );
        Self::rounded(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)))
    }
}

impl Div for Interval {
    type Output = Self;
    /// Where the divisor holds 0 inside, the quotient is every number; where 0 is one of its ends, the quotient is
    /// unbounded on one side.
    #[inline]
    #[allow(
        clippy::suspicious_arithmetic_impl,
        reason = "a quotient by a divisor with an end at 0 is the product with its reciprocal"
    )]
    fn div(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() || other == Self::ZERO {
            return Self::EMPTY;
        }
        if other.low > 0.0 || other.high < 0.0 {
            if self == Self::ZERO {
                return Self::ZERO;
            }
            let quotient = |a: f64, b: f64| if b.is_infinite() { 0.0 } else { a / b };
            let (a, b, c, d) = (
                quotient(self.low, other.low),
                quotient(self.low, other.high),
                quotient(self.high, other.low),
                quotient(self.high, other.high),
            );
            return Self::rounded(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
        }
        let reciprocal = if other.low == 0.0 {
            Self {
                low: (1.0 / other.high).next_down().max(0.0),
                high: f64::INFINITY,
            }
        } else if other.high == 0.0 {
            Self {
                low: f64::NEG_INFINITY,
                high: (1.0 / other.low).next_up().min(0.0),
            }
        } else {
            Self::ENTIRE
        };
        self * reciprocal
    }
}

impl AddAssign for Interval {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl SubAssign for Interval {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
impl MulAssign for Interval {
    #[inline]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Interval {
    /// All magnitudes.
    ///
    /// ```
    /// use grouser_real::Interval;
    ///
    /// assert_eq!(Interval::new(-2.0, 1.0).abs(), Interval::new(0.0, 2.0));
    /// ```
    #[must_use]
    pub fn abs(self) -> Self {
        if self.low >= 0.0 || self.is_empty() {
            self
        } else if self.high <= 0.0 {
            -self
        } else {
            Self {
                low: 0.0,
                high: self.magnitude(),
            }
        }
    }

    /// The greater of a number of this and a number of `other`.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        Self {
            low: self.low.max(other.low),
            high: self.high.max(other.high),
        }
    }

    /// The smaller of a number of this and a number of `other`.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        Self {
            low: self.low.min(other.low),
            high: self.high.min(other.high),
        }
    }
}
