//! The one comparison of two signals: y = a x + b₁ n₁ + b₂ n₂ + b₃ n₃.
//!
//! The signals n are other causes of y: the bias of a gyro, the slip of a wheel, the drift on a slope, the turn. The interval of a
//! follows from parts of the log (jackknife): a wrong description is the same in all of them, slip and outliers come and go.

use grouser_real::{Real, Squares};

/// Parts of a log. Where it is longer, two become one, so that a part outlasts bends and patches of soil.
const PARTS: usize = 16;
/// Fewer parts show no interval.
const MIN_PARTS: usize = 6;
/// The shortest part, s. Prior: speeds and turns of robots change within some seconds.
pub(crate) const PART_S: f64 = 3.0;
/// Half of an interval in standard deviations: one in a thousand is beyond on each side. The second number, over the degrees of freedom,
/// is the excess of Student's distribution.
const SIGMAS: f64 = 3.1;
const SIGMAS_BY_FREEDOM: f64 = 4.0;
/// Where n explains all but this share of x, a is not observable. Limit.
const MIN_FREE_SHARE: f64 = 0.05;
/// Turns of a block are known to 0.02 rad, and a gyro's bias is of the order of 0.02 rad/s: s². Prior.
const BIAS_PRIOR_S2: f64 = 1.0;

/// The maximum number of n.
const OTHERS: usize = 3;
/// The places of x and y behind them.
const X: usize = OTHERS;
const Y: usize = OTHERS + 1;
const ALL: usize = OTHERS + 2;

/// Sums of products of n, x, y, and how long they were compared, s.
#[derive(Clone, Copy, Debug, Default)]
struct Part {
    seconds: f64,
    sums: [[f64; ALL]; ALL],
}

/// Two signals over a log.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Comparison {
    /// The squares of n that a prior of their factors is worth.
    prior: f64,
    min_free_share: f64,
    parts: [Part; PARTS],
    used: usize,
    part_s: f64,
    /// Σ |x| Δt and Σ |y| Δt where x and y have these signs: 0 for positive, 1 for negative.
    by_sign: [[[f64; 2]; 2]; 2],
}

/// The line between two signals, with the interval of its slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    /// a.
    pub(crate) slope: f64,
    /// Half of its interval.
    pub(crate) half_width: f64,
    /// Of x and y without n.
    pub(crate) correlation: f64,
    /// Squares of x and y without n.
    pub(crate) squares: Squares,
    /// Σ x² and Σ y² with what n explains.
    pub(crate) whole: [f64; 2],
    /// Independent parts.
    pub(crate) parts: f64,
}

impl Default for Comparison {
    fn default() -> Self {
        Self::with_prior(0.0)
    }
}

impl Comparison {
    pub(crate) const fn with_prior(prior: f64) -> Self {
        Self {
            prior,
            min_free_share: MIN_FREE_SHARE,
            parts: [Part {
                seconds: 0.0,
                sums: [[0.0; ALL]; ALL],
            }; PARTS],
            used: 0,
            part_s: PART_S,
            by_sign: [[[0.0; 2]; 2]; 2],
        }
    }

    /// Beside a bias, which is small: a robot that keeps on turning shows a too.
    pub(crate) const fn with_bias() -> Self {
        Self {
            min_free_share: 0.0,
            ..Self::with_prior(BIAS_PRIOR_S2)
        }
    }

    /// Adds one reading of both, which lasts for `seconds`.
    pub(crate) fn add<const N: usize>(&mut self, seconds: f64, x: f64, n: [f64; N], y: f64) {
        let mut row = [0.0; ALL];
        row[..N].copy_from_slice(&n);
        (row[X], row[Y]) = (x, y);
        if !row.iter().sum::<f64>().is_finite() {
            return;
        }
        let is_full = self.used == 0 || self.parts[self.used - 1].seconds >= self.part_s;
        if is_full && self.used == PARTS {
            for index in 0..PARTS / 2 {
                self.parts[index] = self.parts[2 * index].with(&self.parts[2 * index + 1], 1.0);
            }
            self.used = PARTS / 2;
            self.part_s *= 2.0;
        }
        if is_full {
            self.parts[self.used] = Part::default();
            self.used += 1;
        }
        let part = &mut self.parts[self.used - 1];
        part.seconds += seconds;
        for (line, a) in part.sums.iter_mut().zip(row) {
            for (sum, b) in line.iter_mut().zip(row) {
                *sum += a * b;
            }
        }
        let sums = &mut self.by_sign[usize::from(x < 0.0)][usize::from(y < 0.0)];
        *sums = [sums[0] + x.abs() * seconds, sums[1] + y.abs() * seconds];
    }

    /// Σ |x| Δt and Σ |y| Δt where x and y have these signs: 0 for positive, 1 for negative.
    pub(crate) const fn by_sign(&self) -> &[[[f64; 2]; 2]; 2] {
        &self.by_sign
    }

    /// The line; `None` where too few parts, or too little of x that n does not explain, show none.
    pub(crate) fn line(&self) -> Option<Line> {
        let parts = &self.parts[..self.used];
        let all = (parts.iter()).fold(Part::default(), |sum, part| sum.with(part, 1.0));
        let squares = all.squares(self.prior);
        let Squares { xx, yy, .. } = squares;
        let is_hidden = xx < self.min_free_share * all.sums[X][X];
        if parts.len() < MIN_PARTS || is_hidden || !(xx + yy).is_finite() {
            return None;
        }
        // a constant has no slope
        let slope_of = |of: &Squares| if of.xx > 0.0 { of.xy / of.xx } else { 0.0 };
        let slope = slope_of(&squares);
        let without = parts.iter().map(|part| {
            let rest = all.with(part, -1.0).squares(self.prior);
            slope_of(&rest) - slope
        });
        let freedom = parts.len() as f64 - 1.0;
        let variance = without.map(|off| off * off).sum::<f64>() * freedom / (freedom + 1.0);
        Some(Line {
            slope,
            half_width: SIGMAS * (1.0 + SIGMAS_BY_FREEDOM / freedom) * variance.sqrt(),
            correlation: squares.line().map_or(0.0, |line| line.correlation),
            squares,
            whole: [all.sums[X][X], all.sums[Y][Y]],
            parts: parts.len() as f64,
        })
    }
}

impl Part {
    fn with(&self, other: &Self, factor: f64) -> Self {
        let mut sum = *self;
        sum.seconds += factor * other.seconds;
        for (line, others) in sum.sums.iter_mut().zip(&other.sums) {
            for (sum, other) in line.iter_mut().zip(others) {
                *sum += factor * other;
            }
        }
        sum
    }

    /// Of x and y, less what n explains of them.
    fn squares(&self, prior: f64) -> Squares {
        let mut sums = self.sums;
        for n in 0..OTHERS {
            let line = sums[n];
            let pivot = line[n] + prior;
            // what is left of n by rounding explains nothing
            if pivot > f64::EPSILON * (self.sums[n][n] + prior) && pivot > 0.0 {
                for (row, factor) in sums.iter_mut().zip(line).skip(n + 1) {
                    for (sum, other) in row.iter_mut().zip(line) {
                        *sum -= factor * other / pivot;
                    }
                }
            }
        }
        Squares {
            xx: sums[X][X],
            xy: sums[X][Y],
            yy: sums[Y][Y].max(0.0),
        }
    }
}

impl Line {
    /// Is a above a limit with certainty?
    pub(crate) fn is_above(&self, limit: f64) -> bool {
        self.slope - self.half_width > limit
    }

    /// Is a below a limit with certainty?
    pub(crate) fn is_below(&self, limit: f64) -> bool {
        self.slope + self.half_width < limit
    }
}

/// A vector that follows a signal: y = a x, and its direction.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Direction([Comparison; 2]);

/// A direction, rad, with half of its interval, and how long a is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Angle {
    pub(crate) value: f64,
    pub(crate) half_width: f64,
    pub(crate) length: f64,
}

impl Direction {
    pub(crate) const fn with_prior(prior: f64) -> Self {
        Self([Comparison::with_prior(prior); 2])
    }

    pub(crate) fn add<const N: usize>(&mut self, seconds: f64, x: f64, n: [f64; N], y: [f64; 2]) {
        for (comparison, y) in self.0.iter_mut().zip(y) {
            comparison.add(seconds, x, n, y);
        }
    }

    /// Both lines, where the parts suffice.
    pub(crate) fn lines(&self) -> Option<[Line; 2]> {
        let [x, y] = self.0.each_ref().map(Comparison::line);
        Some([x?, y?])
    }

    /// The direction against a unit vector; `None` where none is certain.
    pub(crate) fn angle(&self, [cos, sin]: [f64; 2]) -> Option<Angle> {
        let [x, y] = self.lines()?;
        let length = Real::hypot(x.slope, y.slope);
        let half_width = Real::hypot(x.half_width, y.half_width) / length;
        let (along, aside) = (cos * x.slope + sin * y.slope, cos * y.slope - sin * x.slope);
        (half_width < 1.0).then(|| Angle {
            value: Real::atan2(aside, along),
            half_width,
            length,
        })
    }
}

impl Angle {
    /// Is it larger than a limit with certainty?
    pub(crate) fn is_beyond(&self, limit: f64) -> bool {
        self.value.abs() - self.half_width > limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = 2 x + 3 n with an error that is another in each bend of 8 s.
    fn compared(seconds: u32, error: f64) -> Line {
        let mut comparison = Comparison::default();
        for step in 0..seconds {
            let time = f64::from(step);
            let own = error * (f64::from(step / 8) * 2.4).sin();
            let (x, n) = (time.sin(), (0.3 * time).cos());
            comparison.add(1.0, x, [n], (2.0 + own) * x + 3.0 * n);
        }
        comparison.line().unwrap()
    }

    #[test]
    fn the_interval_holds_where_errors_last_for_seconds_and_parts_become_one() {
        for seconds in [40, 100, 1000] {
            let exact = compared(seconds, 0.0);
            assert!(
                (exact.slope - 2.0).abs() < 1e-9 && exact.half_width < 1e-6,
                "{exact:?}"
            );
            let rough = compared(seconds, 0.5);
            let off = (rough.slope - 2.0).abs();
            assert!(
                off < rough.half_width && rough.half_width < 2.0,
                "{rough:?}"
            );
            assert!((8.0..=16.0).contains(&rough.parts), "{rough:?}");
        }
    }

    #[test]
    fn what_the_other_signals_explain_shows_no_slope() {
        let mut comparison = Comparison::default();
        for step in 0..100 {
            let x = f64::from(step).sin();
            comparison.add(1.0, x, [x + 0.01], x);
        }
        assert!(comparison.line().is_none());
    }
}
