//! Roots and maxima over slip of what a wheel's laws give, which may have no value.

use grouser_real::Real;

use crate::error::Result;

/// How closely a root is found: far below what forces at standard accuracy can tell.
pub(crate) const ROOT_PRECISION: f64 = 1e-13;

/// The search for the root of a function between two points of opposite sign, one slip after the other: the secant with
/// Illinois' weight, which moves both ends, and a bisection now and then. A slip at which the function has no value counts as
/// below the root.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RootSearch {
    low: (f64, f64),
    high: (f64, f64),
    precision: f64,
    moved_high: Option<bool>,
    steps: u32,
    slip: f64,
}

impl RootSearch {
    pub(crate) const fn new(low: (f64, f64), high: (f64, f64), precision: f64) -> Self {
        Self {
            low,
            high,
            precision,
            moved_high: None,
            steps: 0,
            slip: high.0,
        }
    }

    /// The slip at which the function is wanted next; `None` where the root is known.
    pub(crate) fn next_slip(&mut self) -> Option<f64> {
        let ((a, f_a), (b, f_b)) = (self.low, self.high);
        self.steps += 1;
        if self.steps >= 200 || b - a <= self.precision || f_b == 0.0 {
            return None;
        }
        let secant = b - f_b * (b - a) / (f_b - f_a);
        // past the root by less than the precision, so that the last step moves the other end
        let past = if self.moved_high == Some(true) {
            -1.0
        } else {
            1.0
        };
        let secant = secant + past * 0.4 * self.precision;
        self.slip = if !self.steps.is_multiple_of(6) && secant > a && secant < b {
            secant
        } else {
            0.5 * (a + b)
        };
        Some(self.slip)
    }

    /// Takes the function's value at that slip.
    pub(crate) fn feed(&mut self, value: Option<f64>) {
        match value {
            Some(value) if value >= 0.0 => {
                if self.moved_high == Some(true) {
                    self.low.1 *= 0.5;
                }
                self.moved_high = Some(true);
                self.high = (self.slip, value);
            }
            Some(value) => {
                if self.moved_high == Some(false) {
                    self.high.1 *= 0.5;
                }
                self.moved_high = Some(false);
                self.low = (self.slip, value);
            }
            None => {
                self.moved_high = None;
                self.low.0 = self.slip;
            }
        }
    }

    /// The end of the bracket at which the function is not negative.
    pub(crate) const fn root(&self) -> f64 {
        self.high.0
    }
}

/// The root of `f` between two points of opposite sign, to `precision`, where it is not negative ([`RootSearch`]).
pub(crate) fn root(
    low: (f64, f64),
    high: (f64, f64),
    precision: f64,
    f: impl Fn(f64) -> Result<Option<f64>>,
) -> Result<f64> {
    let mut search = RootSearch::new(low, high, precision);
    while let Some(slip) = search.next_slip() {
        search.feed(f(slip)?);
    }
    Ok(search.root())
}

/// The greatest value of `f` over slips within `reach` of `near` and in [0, 1], and where: Brent's method, parabolas through
/// the best three points and golden section where they do not serve. Where the best lies at an end of the reach that is no
/// end of [0, 1], the reach moves on.
///
/// Source: Brent, *Algorithms for Minimization without Derivatives* (1973), chapter 5.
pub(crate) fn maximum(
    near: f64,
    (reach, precision): (f64, f64),
    f: impl Fn(f64) -> Result<Option<f64>>,
) -> Result<(f64, f64)> {
    let value = |slip: f64| -> Result<f64> { Ok(f(slip)?.unwrap_or(f64::NEG_INFINITY)) };
    let golden = 0.5 * (3.0 - Real::sqrt(5.0_f64));
    let (mut a, mut b) = ((near - reach).max(0.0), (near + reach).min(1.0));
    // best, second and third point
    let mut x = (near, value(near)?);
    let (mut w, mut v) = (x, x);
    let (mut step, mut before) = (0.0_f64, 0.0_f64);
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        let least = 0.3 * precision;
        if (x.0 - middle).abs() <= 2.0 * least - 0.5 * (b - a) {
            let end = if x.0 > middle { b } else { a };
            let is_at_end = (x.0 - end).abs() <= 3.0 * least;
            let was_reach = end > 0.0 && end < 1.0 && ((end - near).abs() - reach).abs() < 1e-12;
            if is_at_end && was_reach {
                // the maximum lies further on
                return maximum(x.0, (2.0 * reach, precision), f);
            }
            break;
        }
        let mut parabola = None;
        if before.abs() > least {
            let r = (x.0 - w.0) * (x.1 - v.1);
            let q = (x.0 - v.0) * (x.1 - w.1);
            let p = (x.0 - v.0) * q - (x.0 - w.0) * r;
            let q = 2.0 * (q - r);
            let wish = if q == 0.0 { f64::NAN } else { -p / q };
            let inside = x.0 + wish > a && x.0 + wish < b;
            if inside && wish.abs() < 0.5 * before.abs() {
                parabola = Some(wish);
            }
        }
        (before, step) = if let Some(wish) = parabola {
            (step, wish)
        } else {
            let side = if x.0 < middle { b - x.0 } else { a - x.0 };
            (side, golden * side)
        };
        let moved = if step.abs() >= least {
            step
        } else if step < 0.0 {
            -least
        } else {
            least
        };
        let u = x.0 + moved;
        let u = (u, value(u.clamp(0.0, 1.0))?);
        if u.1 >= x.1 {
            if u.0 >= x.0 {
                a = x.0;
            } else {
                b = x.0;
            }
            (v, w, x) = (w, x, u);
        } else {
            if u.0 < x.0 {
                a = u.0;
            } else {
                b = u.0;
            }
            if u.1 >= w.1 || w.0 == x.0 {
                (v, w) = (w, u);
            } else if u.1 >= v.1 || v.0 == x.0 || v.0 == w.0 {
                v = u;
            }
        }
    }
    // a maximum at the end of all slips is approached by golden section only
    for end in [0.0, 1.0] {
        if (x.0 - end).abs() <= precision {
            let there = value(end)?;
            if there >= x.1 {
                x = (end, there);
            }
        }
    }
    Ok((x.0.clamp(0.0, 1.0), x.1))
}

/// The root of a growing `f` beside a slip that is nearly right; `None` where there is none within a few tenths.
pub(crate) fn root_near(near: f64, f: impl Fn(f64) -> Result<Option<f64>>) -> Result<Option<f64>> {
    for reach in [0.02, 0.06, 0.2] {
        let (low, high) = ((near - reach).max(-1.0), (near + reach).min(1.0));
        if let (Some(at_low), Some(at_high)) = (f(low)?, f(high)?)
            && at_low < 0.0
            && at_high >= 0.0
        {
            return root((low, at_low), (high, at_high), ROOT_PRECISION, f).map(Some);
        }
    }
    Ok(None)
}
