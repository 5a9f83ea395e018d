//! Two readings of one quantity: is the one the other times something?

use grouser_real::Real;

/// So much must have been seen before a word is said, s.
const MIN_OBSERVED_TIME_S: f64 = 1.0;
/// Correlation from which two readings are of one quantity, and below which of two.
const RELATED_CORRELATION: f64 = 0.75;
const UNRELATED_CORRELATION: f64 = 0.3;
/// Slip and skid change a unit's factor by no more than this share; a unit holds through all speeds at this correlation.
const MAX_SLIP_FACTOR: f64 = 0.4;
const ALL_BUT_ONE: f64 = 0.99;

/// Factors of units that are mixed up, and what they are.
pub(super) type Units = [(f64, &'static str); 4];
pub(super) const LENGTHS: Units = [
    (1000.0, "millimetres given as metres"),
    (0.001, "metres given as millimetres"),
    (100.0, "centimetres given as metres"),
    (0.01, "metres given as centimetres"),
];
pub(super) const ROTATIONS: Units = [
    (57.295_78, "degrees given as radians"),
    (0.017_453, "radians given as degrees"),
    (9.549_297, "revolutions a minute given as radians a second"),
    (0.104_72, "radians a second given as revolutions a minute"),
];
pub(super) const FORCES: Units = [
    (9.806_65, "m/s² given as g"),
    (0.101_97, "g given as m/s²"),
    (1000.0, "mm/s² given as m/s²"),
    (0.001, "m/s² given as mm/s²"),
];

/// Sums of products over the time in which the second moves.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pair {
    seconds: f64,
    count: f64,
    first: f64,
    second: f64,
    first_square: f64,
    second_square: f64,
    both: f64,
    unbiased: bool,
}

/// What a pair comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// Not enough seen.
    Open,
    /// They go together, one for one or nearly.
    Fits,
    /// They go together, but one is this many times the other.
    Scale(f64, &'static str),
    /// They go against each other.
    Sign(f64),
    /// They have nothing to do with each other.
    Unrelated,
}

impl Pair {
    /// Both readings over `seconds`, where the second is at least `least`.
    pub(super) fn take(&mut self, first: f64, second: f64, least: f64, seconds: f64) {
        if second.abs() >= least {
            self.add(first, second, seconds);
        }
    }

    /// The same where the first may be off by a bias: means are taken out, so what is near zero counts as well.
    pub(super) fn take_unbiased(&mut self, first: f64, second: f64, least: f64, seconds: f64) {
        self.unbiased = true;
        let moves = second.abs() >= least;
        self.add(first, second, if moves { seconds } else { 0.0 });
    }

    fn add(&mut self, first: f64, second: f64, seconds: f64) {
        self.seconds += seconds;
        self.first += first;
        self.second += second;
        self.first_square += first * first;
        self.second_square += second * second;
        self.both += first * second;
        self.count += 1.0;
    }

    /// Slope of the first over the second, and correlation.
    fn slope(&self) -> Option<(f64, f64)> {
        let n = if self.unbiased { self.count } else { f64::MAX };
        let xx = self.first_square - self.first * self.first / n;
        let yy = self.second_square - self.second * self.second / n;
        let xy = self.both - self.first * self.second / n;
        (xx > 0.0 && yy > 0.0).then(|| (xy / yy, xy / Real::sqrt(xx * yy)))
    }

    pub(super) fn is_settled(&self) -> bool {
        self.seconds >= MIN_OBSERVED_TIME_S
    }

    pub(super) fn is_related(&self) -> bool {
        self.is_settled()
            && self
                .slope()
                .is_some_and(|(_, together)| together.abs() >= RELATED_CORRELATION)
    }

    /// What it comes to, where factors between `limits` are plausible.
    pub(super) fn verdict(&self, limits: (f64, f64), units: &Units) -> Verdict {
        if !self.is_settled() {
            return Verdict::Open;
        }
        let Some((slope, together)) = self.slope() else {
            return Verdict::Unrelated;
        };
        if together <= -RELATED_CORRELATION {
            return Verdict::Sign(slope);
        }
        if slope.abs() > limits.1 || together >= RELATED_CORRELATION && slope.abs() < limits.0 {
            return Verdict::Scale(slope, guess(slope, units).unwrap_or("another unit"));
        }
        if together.abs() < UNRELATED_CORRELATION {
            return Verdict::Unrelated;
        }
        Verdict::Fits
    }

    /// A unit's own factor between both, held through all speeds.
    pub(super) fn unit(&self) -> Option<(f64, &'static str)> {
        let (slope, together) = self
            .slope()
            .filter(|_| self.seconds >= 2.0 * MIN_OBSERVED_TIME_S)?;
        // at one speed any factor is held
        let mean = self.second / self.count;
        let spread = self.second_square / self.count - mean * mean;
        let varied = spread > 0.04 * mean * mean;
        (varied && together >= ALL_BUT_ONE).then(|| Some((slope, guess(slope, &ROTATIONS)?)))?
    }
}

fn guess(factor: f64, units: &Units) -> Option<&'static str> {
    let near = |unit: &&(f64, &str)| (Real::ln(factor.abs() / unit.0)).abs() <= MAX_SLIP_FACTOR;
    units.iter().find(near).map(|unit| unit.1)
}
