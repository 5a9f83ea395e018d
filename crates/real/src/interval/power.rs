//! Powers.

use super::Interval;
use crate::real::Real;

/// xⁿ for x ≥ 0 by repeated multiplication, each product rounded to one side.
fn whole_power(x: f64, n: u32, step: fn(f64) -> f64) -> f64 {
    if n == 0 {
        return 1.0;
    }
    let mut result = x;
    for _ in 1..n {
        if result == 0.0 || result.is_infinite() {
            return result;
        }
        result = step(result * x);
    }
    result
}

impl Interval {
    /// Squares.
    ///
    /// ```
    /// use grouser_real::Interval;
    ///
    /// // tighter than the product of the interval with itself
    /// assert_eq!(Interval::new(-1.0, 2.0).square().low(), 0.0);
    /// ```
    #[must_use]
    pub fn square(self) -> Self {
        self.powi(2)
    }

    /// Whole powers.
    #[must_use]
    pub fn powi(self, n: i32) -> Self {
        if self.is_empty() {
            return self;
        }
        if n < 0 {
            return Self::ONE / self.powi(n.saturating_neg());
        }
        let n = n.unsigned_abs();
        if n == 0 {
            return Self::ONE;
        }
        if n == 1 {
            return self;
        }
        let up = |x: f64| whole_power(x, n, f64::next_up);
        let down = |x: f64| whole_power(x, n, |p| p.next_down().max(0.0));
        if n.is_multiple_of(2) {
            let size = self.abs();
            return Self {
                low: down(size.low),
                high: up(size.high),
            };
        }
        let low = if self.low >= 0.0 {
            down(self.low)
        } else {
            -up(-self.low)
        };
        let high = if self.high >= 0.0 {
            up(self.high)
        } else {
            -down(-self.high)
        };
        Self { low, high }
    }

    /// Powers xʸ of numbers x ≥ 0: a negative number has none where the exponent is no whole number, and any number where it may
    /// be one.
    ///
    /// ```
    /// use grouser_real::Interval;
    ///
    /// let power = Interval::new(1.0, 4.0).powf(Interval::point(0.5));
    /// assert!(power.contains(1.0) && power.contains(2.0) && power.width() < 1.0 + 1e-14);
    /// ```
    #[must_use]
    pub fn powf(self, exponent: Self) -> Self {
        if self.is_empty() || exponent.is_empty() {
            return Self::EMPTY;
        }
        if self.low < 0.0 {
            // floor is exact, by any library
            if libm::floor(exponent.high) >= exponent.low {
                return Self::ENTIRE;
            }
            let low = 0.0;
            return if self.high < 0.0 {
                Self::EMPTY
            } else {
                Self { low, ..self }.powf(exponent)
            };
        }
        // y ln x is monotone in each of x and y: the ends of the power are at the corners
        let corner = |x: f64, y: f64| Real::powf(x, y);
        let (a, b, c, d) = (
            corner(self.low, exponent.low),
            corner(self.low, exponent.high),
            corner(self.high, exponent.low),
            corner(self.high, exponent.high),
        );
        let positive = Self {
            low: 0.0,
            high: f64::INFINITY,
        };
        Self::widened(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)), positive)
    }
}
