//! Turns by two sensors, compared over a log.

use grouser_real::{SignalLine, SignalPair, Squares};

/// Nothing is known of a turn between two readings of a gyro that are further apart, s.
const MAX_GYRO_GAP_S: f64 = 0.5;
/// Turns that must have been compared, and the sum of their squares about their mean, rad²: the bias of a gyro is in the mean.
const MIN_TURNS: f64 = 6.0;
const MIN_TURNS_SQUARE: f64 = 0.5;
/// Two sensors turn alike, or against each other, with this correlation at least, and with a scale from half to twice.
pub(crate) const MIN_CORRELATION: f64 = 0.7;
const MAX_SCALE: f64 = 2.0;
/// Turns with this standard deviation are no noise of a yaw or of a course, rad; a correlation has one of 1/√n, times this.
const MIN_UNLIKE_RAD: f64 = 0.25;
const UNLIKE_SIGMAS: f64 = 1.5;
/// Turns that follow one another are alike by this share at least, as the mean of their product over that of their square.
const MIN_FOLLOWING_SHARE: f64 = 0.3;
/// What turns by less than this share of the other sensor's turns is constant.
const CONSTANT_SHARE: f64 = 0.1;

/// Sums of two sensors' turns.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TurnPair {
    sums: SignalPair,
    /// Product of turns of the first that follow one another, summed, and the last.
    following: f64,
    last: f64,
}

impl TurnPair {
    pub(crate) fn add(&mut self, a: f64, b: f64) {
        if (a + b).is_finite() {
            self.sums.add(a, b);
            self.following += a * self.last;
            self.last = a;
        }
    }

    /// With the second sensor as the first.
    pub(crate) const fn exchanged(self) -> Self {
        Self {
            sums: self.sums.exchanged(),
            ..self
        }
    }

    /// Does the first go on turning to one side in bends, as outliers of places do not?
    pub(crate) fn has_bends(&self) -> bool {
        self.following > MIN_FOLLOWING_SHARE * self.sums.about_zero().xx
    }

    /// Did the first turn enough?
    pub(crate) fn is_known(&self) -> bool {
        self.sums.count() >= MIN_TURNS && self.sums.about_means().xx > MIN_TURNS_SQUARE
    }

    /// Does the second hardly turn where the first does?
    pub(crate) fn second_is_constant(&self) -> bool {
        let squares = self.sums.about_means();
        squares.yy < CONSTANT_SHARE * CONSTANT_SHARE * squares.xx
    }

    /// The second's turn as a multiple of the first's.
    pub(crate) fn scale(&self) -> f64 {
        self.line().map_or(0.0, |line| line.slope)
    }

    fn line(&self) -> Option<SignalLine> {
        self.sums.about_means().line()
    }

    /// The first's turn as a multiple of the second's.
    pub(crate) fn inverse_scale(&self) -> f64 {
        self.exchanged().scale()
    }

    /// Do the turns of the first, which are well above its noise, have nothing to do with the second's? Their means count.
    pub(crate) fn is_unlike(&self) -> bool {
        let count = self.sums.count();
        let noise = UNLIKE_SIGMAS / count.sqrt();
        let Squares { xx, xy, yy } = self.sums.about_zero();
        self.sums.about_means().xx > MIN_UNLIKE_RAD * MIN_UNLIKE_RAD * count
            && !(xy.abs() > (MIN_CORRELATION - noise) * (xx * yy).sqrt())
    }

    pub(crate) fn correlation(&self) -> f64 {
        self.line().map_or(0.0, |line| line.correlation)
    }

    /// Do both turn alike or against each other, at any scale?
    pub(crate) fn agrees_but_for_scale(&self) -> bool {
        self.correlation().abs() > MIN_CORRELATION
    }

    /// Do both turn alike, times `sign`?
    pub(crate) fn agrees(&self, sign: f64) -> bool {
        let is_correlated = sign * self.correlation() > MIN_CORRELATION;
        is_correlated && (1.0 / MAX_SCALE..=MAX_SCALE).contains(&(sign * self.scale()))
    }
}

/// The turn by a gyro.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct GyroTurn {
    last: Option<(i64, f64)>,
    turn: f64,
}

impl GyroTurn {
    pub(crate) fn take(&mut self, now_ns: i64, rate: f64) {
        if let Some((last_ns, last)) = self.last.replace((now_ns, rate)) {
            let passed = now_ns.saturating_sub(last_ns) as f64 * 1e-9;
            // NaN: what is compared across a gap is left out
            self.turn += if passed < MAX_GYRO_GAP_S {
                0.5 * (last + rate) * passed
            } else {
                f64::NAN
            };
        }
    }

    /// The turn since it was taken last.
    pub(crate) fn pass(&mut self) -> f64 {
        std::mem::take(&mut self.turn)
    }
}
