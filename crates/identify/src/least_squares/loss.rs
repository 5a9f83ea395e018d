//! What a residual costs.

/// The loss of a residual r in units of its standard deviation.
///
/// ```
/// use grouser_identify::least_squares::Loss;
///
/// let huber = Loss::Huber { threshold: 1.345 };
/// assert_eq!(huber.of(1.0), Loss::Squares.of(1.0));
/// assert!(huber.of(10.0) < Loss::Squares.of(10.0)); // an outlier costs less
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Loss {
    /// r²/2. The default.
    #[default]
    Squares,
    /// Huber's: r²/2 up to |r| = `threshold`, straight beyond, so that an outlier pulls with a bounded
    /// force. Source: Huber, Annals of Mathematical Statistics 35 (1964). 1.345 gives 95 % efficiency on
    /// normal errors.
    Huber {
        /// Where it becomes straight, in standard deviations.
        threshold: f64,
    },
}

impl Loss {
    /// The loss.
    ///
    /// ```
    /// use grouser_identify::least_squares::Loss;
    ///
    /// assert_eq!(Loss::Squares.of(2.0), 2.0);
    /// ```
    #[must_use]
    pub fn of(self, r: f64) -> f64 {
        match self {
            Self::Huber { threshold } if r.abs() > threshold => {
                threshold * (r.abs() - 0.5 * threshold)
            }
            _ => 0.5 * r * r,
        }
    }

    /// The weight w with which r enters a least-squares step: the loss's slope is w r.
    ///
    /// ```
    /// use grouser_identify::least_squares::Loss;
    ///
    /// assert_eq!(Loss::Huber { threshold: 2.0 }.weight(8.0), 0.25);
    /// ```
    #[must_use]
    pub fn weight(self, r: f64) -> f64 {
        match self {
            Self::Huber { threshold } if r.abs() > threshold => threshold / r.abs(),
            _ => 1.0,
        }
    }
}
