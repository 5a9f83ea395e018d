//! Two signals compared: the line y = a x + b between them.

use crate::real::Real;

/// Sums of two signals that are read at the same times.
///
/// A wrong sign, unit or gain of y shows as the slope a, a bias as b, and another quantity as a small correlation.
///
/// ```
/// use grouser_real::SignalPair;
///
/// let mut pair = SignalPair::default();
/// for turn in [-0.2, 0.0, 0.1, 0.4] {
///     pair.add(turn, 57.3 * turn + 0.5); // degrees, with a bias
/// }
/// let line = pair.about_means().line().unwrap();
/// assert!((line.slope - 57.3).abs() < 1e-9 && line.correlation > 0.999);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SignalPair {
    count: f64,
    x: f64,
    y: f64,
    squares: Squares,
}

/// Sums of squares and products of two signals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Squares {
    /// Σ x².
    pub xx: f64,
    /// Σ x y.
    pub xy: f64,
    /// Σ y².
    pub yy: f64,
}

/// The line of least squares and how well the signals follow it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalLine {
    /// y as a multiple of x.
    pub slope: f64,
    /// From −1 to 1.
    pub correlation: f64,
}

impl SignalPair {
    /// Adds one reading of both.
    pub fn add(&mut self, x: f64, y: f64) {
        self.count += 1.0;
        self.x += x;
        self.y += y;
        self.squares.xx += x * x;
        self.squares.xy += x * y;
        self.squares.yy += y * y;
    }

    /// Readings so far.
    #[must_use]
    pub const fn count(&self) -> f64 {
        self.count
    }

    /// The mean of x; 0 before the first reading.
    #[must_use]
    pub fn mean_x(&self) -> f64 {
        self.x / self.count.max(1.0)
    }

    /// Squares about zero: b is 0.
    #[must_use]
    pub const fn about_zero(&self) -> Squares {
        self.squares
    }

    /// Squares about the means: b is any number.
    #[must_use]
    pub fn about_means(&self) -> Squares {
        let n = self.count.max(1.0);
        let Squares { xx, xy, yy } = self.squares;
        Squares {
            xx: xx - self.x * self.x / n,
            xy: xy - self.x * self.y / n,
            yy: yy - self.y * self.y / n,
        }
    }

    /// With y as x.
    #[must_use]
    pub const fn exchanged(self) -> Self {
        let Squares { xx, xy, yy } = self.squares;
        Self {
            count: self.count,
            x: self.y,
            y: self.x,
            squares: Squares { xx: yy, xy, yy: xx },
        }
    }
}

impl Squares {
    /// The line y = a x; `None` where one of the signals is constant.
    #[must_use]
    pub fn line(&self) -> Option<SignalLine> {
        let Self { xx, xy, yy } = *self;
        (xx > 0.0 && yy > 0.0).then(|| SignalLine {
            slope: xy / xx,
            correlation: xy / Real::sqrt(xx * yy),
        })
    }
}
