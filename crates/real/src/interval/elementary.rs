//! Elementary functions: monotone pieces by their ends, waves by the extremes that they pass.

use super::Interval;
use crate::real::Real;

const POSITIVE: Interval = Interval {
    low: 0.0,
    high: f64::INFINITY,
};
const UNIT: Interval = Interval {
    low: -1.0,
    high: 1.0,
};
/// Beyond this, the library's reduction of an angle is not relied upon.
const MAX_ANGLE: f64 = 1e9;
/// More than the rounding of x/(π/2) at [`MAX_ANGLE`]: a count of quarter turns is doubtful within this.
const QUARTER_DOUBT: f64 = 1e-6;

impl Interval {
    /// A rising function from the library, within `range`.
    fn rising(self, f: fn(f64) -> f64, range: Self) -> Self {
        if self.is_empty() {
            return self;
        }
        Self::widened(f(self.low), f(self.high), range)
    }

    /// Square roots, of what is not negative.
    #[must_use]
    pub fn sqrt(self) -> Self {
        let x = self.intersection(POSITIVE);
        if x.is_empty() {
            return x;
        }
        Self {
            low: Real::sqrt(x.low).next_down().max(0.0),
            high: Real::sqrt(x.high).next_up(),
        }
    }

    /// eˣ.
    #[must_use]
    pub fn exp(self) -> Self {
        self.rising(Real::exp, POSITIVE)
    }

    /// eˣ − 1.
    #[must_use]
    pub fn exp_m1(self) -> Self {
        let range = Self {
            low: -1.0,
            high: f64::INFINITY,
        };
        self.rising(Real::exp_m1, range)
    }

    /// Natural logarithms, of what is positive.
    #[must_use]
    pub fn ln(self) -> Self {
        let x = self.intersection(POSITIVE);
        if x.high == 0.0 {
            return Self::EMPTY;
        }
        x.rising(Real::ln, Self::ENTIRE)
    }

    /// ln(1 + x), where 1 + x is positive.
    #[must_use]
    pub fn ln_1p(self) -> Self {
        let range = Self {
            low: -1.0,
            high: f64::INFINITY,
        };
        let x = self.intersection(range);
        if x.high == -1.0 {
            return Self::EMPTY;
        }
        x.rising(Real::ln_1p, Self::ENTIRE)
    }

    /// Logarithms to the base 10, of what is positive.
    #[must_use]
    pub fn log10(self) -> Self {
        let ten = Self::point(10.0).ln();
        self.ln() / ten
    }

    /// The whole numbers k for which the angle (k + `shift`/2) π may be in the interval; `None` where there may be
    /// any number of them.
    fn half_turns(self, shift: f64) -> Option<(i64, i64)> {
        if !(self.magnitude() <= MAX_ANGLE) {
            return None;
        }
        let count = |x: f64| x / core::f64::consts::PI - 0.5 * shift;
        #[allow(
            clippy::cast_possible_truncation,
            reason = "the magnitude is limited above"
        )]
        let floor = |x: f64| {
            let whole = x as i64;
            whole - i64::from((whole as f64) > x)
        };
        // k from the first whole number above the lower end to the last below the upper end
        let first = floor(count(self.low) - QUARTER_DOUBT) + 1;
        let last = floor(count(self.high) + QUARTER_DOUBT);
        Some((first, last))
    }

    /// A wave with maxima at even and minima at odd half turns from `shift` quarter turns.
    fn wave(self, f: fn(f64) -> f64, shift: f64) -> Self {
        if self.is_empty() {
            return self;
        }
        let Some((first, last)) = self.half_turns(shift) else {
            return UNIT;
        };
        if last > first {
            return UNIT;
        }
        let (a, b) = (f(self.low), f(self.high));
        let ends = Self::widened(a.min(b), a.max(b), UNIT);
        if first > last {
            return ends;
        }
        if first % 2 == 0 {
            Self { high: 1.0, ..ends }
        } else {
            Self { low: -1.0, ..ends }
        }
    }

    /// Sines.
    ///
    /// ```
    /// use grouser_real::Interval;
    ///
    /// assert_eq!(Interval::new(0.0, 3.0).sin().high(), 1.0);
    /// ```
    #[must_use]
    pub fn sin(self) -> Self {
        self.wave(Real::sin, 1.0)
    }

    /// Cosines.
    #[must_use]
    pub fn cos(self) -> Self {
        self.wave(Real::cos, 0.0)
    }

    /// May the tangent have a pole here?
    #[must_use]
    pub fn has_tangent_pole(self) -> bool {
        self.half_turns(1.0)
            .is_none_or(|(first, last)| first <= last)
    }

    /// Tangents; every number where there may be a pole.
    #[must_use]
    pub fn tan(self) -> Self {
        if self.is_empty() {
            return self;
        }
        if self.has_tangent_pole() {
            return Self::ENTIRE;
        }
        self.rising(Real::tan, Self::ENTIRE)
    }

    /// Inverse sines, of what lies in [−1, 1].
    #[must_use]
    pub fn asin(self) -> Self {
        self.intersection(UNIT).rising(Real::asin, Self::ENTIRE)
    }

    /// Inverse cosines, of what lies in [−1, 1].
    #[must_use]
    pub fn acos(self) -> Self {
        let x = self.intersection(UNIT);
        if x.is_empty() {
            return x;
        }
        Self::widened(Real::acos(x.high), Real::acos(x.low), POSITIVE)
    }

    /// Inverse tangents.
    #[must_use]
    pub fn atan(self) -> Self {
        self.rising(Real::atan, Self::ENTIRE)
    }

    /// May the angle of a point (`x`, `self`) jump by a turn, or have no value?
    #[must_use]
    pub fn crosses_branch_cut(self, x: Self) -> bool {
        x.low <= 0.0 && self.low <= 0.0 && self.high >= 0.0
    }

    /// Angles of the points (`x`, `self`), in [−π, π].
    #[must_use]
    pub fn atan2(self, x: Self) -> Self {
        if self.is_empty() || x.is_empty() {
            return Self::EMPTY;
        }
        if self.crosses_branch_cut(x) {
            return (-Self::PI).hull(Self::PI);
        }
        // away from the cut the angle over a box has its ends at corners
        let (a, b, c, d) = (
            Real::atan2(self.low, x.low),
            Real::atan2(self.low, x.high),
            Real::atan2(self.high, x.low),
            Real::atan2(self.high, x.high),
        );
        Self::widened(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)), Self::ENTIRE)
    }

    /// Hyperbolic sines.
    #[must_use]
    pub fn sinh(self) -> Self {
        self.rising(Real::sinh, Self::ENTIRE)
    }

    /// Hyperbolic cosines.
    #[must_use]
    pub fn cosh(self) -> Self {
        let range = Self {
            low: 1.0,
            high: f64::INFINITY,
        };
        self.abs().rising(Real::cosh, range)
    }

    /// Hyperbolic tangents.
    #[must_use]
    pub fn tanh(self) -> Self {
        self.rising(Real::tanh, UNIT)
    }

    /// sin x/x, 1 at 0.
    ///
    /// ```
    /// use grouser_real::Interval;
    ///
    /// let around = Interval::new(-0.1, 0.1).sinc();
    /// assert!(around.contains(1.0) && around.width() < 2e-3);
    /// ```
    #[must_use]
    pub fn sinc(self) -> Self {
        /// Its minimum is −0.2172…, near 4.49: up to there it falls.
        const RANGE: Interval = Interval {
            low: -0.2173,
            high: 1.0,
        };
        if self.is_empty() {
            return self;
        }
        let size = self.abs();
        if !(size.high <= core::f64::consts::PI) {
            return (self.sin() / self).intersection(RANGE);
        }
        let at = |x: f64| if x == 0.0 { 1.0 } else { Real::sin(x) / x };
        Self::widened(at(size.high), at(size.low), UNIT)
    }

    /// The derivative of sin x/x: −x/3 + x³/30 − x⁵/840 + x⁷/45360 − …, which falls up to 2.08 and whose terms
    /// alternate and shrink there.
    #[must_use]
    pub fn sinc_slope(self) -> Self {
        /// The derivative is within ±0.4362, which it reaches near 2.08.
        const RANGE: Interval = Interval {
            low: -0.4363,
            high: 0.4363,
        };
        if !(self.magnitude() <= 2.0) {
            return ((self.cos() - self.sinc()) / self).intersection(RANGE);
        }
        // the series up to x⁵ lies below for x > 0, up to x⁷ above; the function is odd
        let series = |x: f64, seventh: bool| {
            let x = Self::point(x);
            let square = x.square();
            let last = if seventh {
                square / Self::point(45_360.0)
            } else {
                Self::ZERO
            };
            let fifth = square * (Self::point(-1.0) / Self::point(840.0) + last);
            let third = square * (Self::ONE / Self::point(30.0) + fifth);
            x * (third - Self::ONE / Self::point(3.0))
        };
        Self {
            low: series(self.high, self.high < 0.0).low,
            high: series(self.low, self.low >= 0.0).high,
        }
    }

    /// The second derivative of sin x/x, −∫ t² cos(x t) dt from 0 to 1.
    #[must_use]
    pub fn sinc_curvature(self) -> Self {
        /// The integral without its sign is at most ∫ t² dt = 1/3.
        const RANGE: Interval = Interval {
            low: -0.333_333_333_333_333_4,
            high: 0.333_333_333_333_333_4,
        };
        let ratio = self.sinc_slope() / self;
        let curvature = -self.sinc() - Self::point(2.0) * ratio;
        if ratio.is_empty() {
            RANGE
        } else {
            curvature.intersection(RANGE)
        }
    }
}
