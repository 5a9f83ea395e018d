//! Interval arithmetic with outward rounding: a result encloses every value that the operation takes on the
//! intervals it is given.
//!
//! The basic operations and the square root are correctly rounded by IEEE 754, so that one step outwards encloses
//! them. The other functions are those of the platform's library, widened by [`LIBRARY_ULPS`].

mod arithmetic;
mod elementary;
mod power;

/// How far the library's elementary functions may be off, in units in the last place. The manual of the GNU C
/// library ("Known Maximum Errors in Math Functions") lists at most 2 for the functions used here on x86-64 and
/// AArch64, musl and fdlibm document less than 2; twice that is taken.
pub(crate) const LIBRARY_ULPS: f64 = 4.0;

/// All numbers from `low` to `high`, or none.
///
/// Infinite ends are open: [−∞, ∞] holds every real number. A function encloses its values where it has any: the
/// logarithm of [−1, 1] is [−∞, 0], and that of [−2, −1] is empty.
///
/// ```
/// use grouser_real::Interval;
///
/// let tenth = Interval::point(1.0) / Interval::point(10.0);
/// assert!(tenth.low() < 0.1 && 0.1 < tenth.high() && tenth.width() < 1e-16);
/// // a number minus itself is 0, but two numbers of one interval differ
/// let x = Interval::new(1.0, 2.0);
/// assert!((x - x).contains(1.0) && (x - x).contains(-1.0));
/// assert!(Interval::new(0.0, 4.0).sqrt().contains(2.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    low: f64,
    high: f64,
}

impl Interval {
    /// Every real number.
    pub const ENTIRE: Self = Self {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
    };
    /// No number.
    pub const EMPTY: Self = Self {
        low: f64::NAN,
        high: f64::NAN,
    };
    /// 0.
    pub const ZERO: Self = Self::point(0.0);
    /// 1.
    pub const ONE: Self = Self::point(1.0);
    /// π lies between these two neighbours.
    pub const PI: Self = Self {
        low: core::f64::consts::PI,
        high: 3.141_592_653_589_793_6,
    };

    /// The numbers from `low` to `high`; none if `low` is greater or an end is NaN.
    ///
    /// ```
    /// assert!(grouser_real::Interval::new(2.0, 1.0).is_empty());
    /// ```
    #[must_use]
    pub const fn new(low: f64, high: f64) -> Self {
        if low <= high {
            Self { low, high }
        } else {
            Self::EMPTY
        }
    }

    /// One number; none if it is NaN.
    #[must_use]
    pub const fn point(x: f64) -> Self {
        Self { low: x, high: x }
    }

    /// The lower end; NaN for the empty interval.
    #[must_use]
    pub const fn low(self) -> f64 {
        self.low
    }

    /// The upper end; NaN for the empty interval.
    #[must_use]
    pub const fn high(self) -> f64 {
        self.high
    }

    /// Does it hold no number?
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.low.is_nan()
    }

    /// Is `x` in it?
    #[must_use]
    pub fn contains(self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// Are all numbers of this one in `other`?
    #[must_use]
    pub fn is_inside(self, other: Self) -> bool {
        self.is_empty() || (other.low <= self.low && self.high <= other.high)
    }

    /// Are both ends finite?
    #[must_use]
    pub const fn is_bounded(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// `high − low`, rounded up.
    #[must_use]
    pub fn width(self) -> f64 {
        if self.low == self.high {
            0.0
        } else {
            (self.high - self.low).next_up()
        }
    }

    /// A number of the interval near its middle; 0 for an unbounded one that holds 0.
    ///
    /// ```
    /// assert_eq!(grouser_real::Interval::new(1.0, 3.0).middle(), 2.0);
    /// ```
    #[must_use]
    pub fn middle(self) -> f64 {
        let middle = 0.5 * self.low + 0.5 * self.high;
        if middle.is_finite() {
            middle.clamp(self.low, self.high)
        } else {
            0.0_f64.clamp(self.low.max(f64::MIN), self.high.min(f64::MAX))
        }
    }

    /// The greatest magnitude in it.
    #[must_use]
    pub fn magnitude(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// The numbers that are in both.
    ///
    /// ```
    /// use grouser_real::Interval;
    ///
    /// let both = Interval::new(0.0, 2.0).intersection(Interval::new(1.0, 3.0));
    /// assert_eq!(both, Interval::new(1.0, 2.0));
    /// ```
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        Self::new(self.low.max(other.low), self.high.min(other.high))
    }

    /// The smallest interval that holds both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        if self.is_empty() {
            return other;
        }
        if other.is_empty() {
            return self;
        }
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// One step outwards: encloses what two correctly rounded ends stand for. Corners of products and quotients are
    /// numbers (0 · ∞ is 0 there).
    fn rounded(low: f64, high: f64) -> Self {
        Self {
            low: low.next_down(),
            high: high.next_up(),
        }
    }

    /// Encloses what two ends from the library stand for, within `range`, whose end replaces one that is NaN.
    fn widened(low: f64, high: f64, range: Self) -> Self {
        let slack = LIBRARY_ULPS * f64::EPSILON;
        let low = (low - low.abs() * slack).next_down().max(range.low);
        let high = (high + high.abs() * slack).next_up().min(range.high);
        Self { low, high }
    }
}

#[cfg(test)]
mod tests;
