//! The probability that slip exceeds a limit, and for how long.

use grouser_real::Real;

/// Probability that a standard normal number exceeds `z`: Abramowitz and Stegun 26.2.17, within 7.5e-8.
///
/// ```
/// use grouser_slip::modes::normal_tail;
/// assert!((normal_tail(0.0) - 0.5).abs() < 1e-7);
/// assert!((normal_tail(1.2816) - 0.1).abs() < 1e-5);
/// assert!((normal_tail(-1.2816) - 0.9).abs() < 1e-5);
/// ```
#[must_use]
pub fn normal_tail(z: f64) -> f64 {
    const COEFFICIENTS: [f64; 5] = [
        0.319_381_530,
        -0.356_563_782,
        1.781_477_937,
        -1.821_255_978,
        1.330_274_429,
    ];
    let t = 1.0 / (1.0 + 0.231_641_9 * z.abs());
    let sum = COEFFICIENTS
        .iter()
        .rev()
        .fold(0.0, |sum, of| (sum + of) * t);
    let density = Real::exp(-0.5 * z * z) / Real::sqrt(2.0 * core::f64::consts::PI);
    let tail = density * sum;
    if z >= 0.0 { tail } else { 1.0 - tail }
}

/// Reports that slip exceeds a limit once that has been probable for a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exceeds {
    /// Probability from which on the slip counts as above the limit.
    probability: f64,
    /// How long it must be, s.
    time: f64,
    lasted: f64,
}

impl Exceeds {
    /// For high slip: of 324 wheel runs of Robotino it reports all 20 whose true slip is above 0.6 for 3 s, 11 of them within these
    /// 3 s, and no other (row `high-slip` of `bench/estimators`). Probabilities of 0.8 to 0.9 and times of 0.5 to 0.8 s differ little.
    pub const HIGH_SLIP: Self = Self::new(0.85, 0.5);

    /// From a probability and a time, s.
    #[must_use]
    pub const fn new(probability: f64, time: f64) -> Self {
        Self {
            probability,
            time,
            lasted: 0.0,
        }
    }

    /// After a step of `dt` (s) with a probability; `None` is a slip that is not known. True where the limit is exceeded.
    pub fn advance(&mut self, probability: Option<f64>, dt: f64) -> bool {
        let is_above = probability.is_some_and(|of| of >= self.probability);
        self.lasted = if is_above { self.lasted + dt } else { 0.0 };
        self.lasted >= self.time
    }
}
