//! Two readings of one quantity: is the one the other times something?

use grouser_real::{Real, SignalLine, SignalPair};

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
    /// The second as x, the first as y.
    sums: SignalPair,
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
        self.sums.add(second, first);
    }

    /// The first as a multiple of the second.
    fn line(&self) -> Option<SignalLine> {
        let squares = if self.unbiased {
            self.sums.about_means()
        } else {
            self.sums.about_zero()
        };
        squares.line()
    }

    pub(super) fn is_settled(&self) -> bool {
        self.seconds >= MIN_OBSERVED_TIME_S
    }

    pub(super) fn is_related(&self) -> bool {
        self.is_settled()
            && self
                .line()
                .is_some_and(|line| line.correlation.abs() >= RELATED_CORRELATION)
    }

    /// What it comes to, where factors between `limits` are plausible.
    pub(super) fn verdict(&self, limits: (f64, f64), units: &Units) -> Verdict {
        if !self.is_settled() {
            return Verdict::Open;
        }
        let Some(SignalLine { slope, correlation }) = self.line() else {
            return Verdict::Unrelated;
        };
        if correlation <= -RELATED_CORRELATION {
            return Verdict::Sign(slope);
        }
        if slope.abs() > limits.1 || correlation >= RELATED_CORRELATION && slope.abs() < limits.0 {
            return Verdict::Scale(slope, guess(slope, units).unwrap_or("another unit"));
        }
        if correlation.abs() < UNRELATED_CORRELATION {
            return Verdict::Unrelated;
        }
        Verdict::Fits
    }

    /// A unit's own factor between both, held through all speeds.
    pub(super) fn unit(&self) -> Option<(f64, &'static str)> {
        let SignalLine { slope, correlation } = self
            .line()
            .filter(|_| self.seconds >= 2.0 * MIN_OBSERVED_TIME_S)?;
        // at one speed any factor is held
        let mean = self.sums.mean_x();
        let spread = self.sums.about_zero().xx / self.sums.count() - mean * mean;
        let varied = spread > 0.04 * mean * mean;
        (varied && correlation >= ALL_BUT_ONE).then(|| Some((slope, guess(slope, &ROTATIONS)?)))?
    }
}

fn guess(factor: f64, units: &Units) -> Option<&'static str> {
    let near = |unit: &&(f64, &str)| (Real::ln(factor.abs() / unit.0)).abs() <= MAX_SLIP_FACTOR;
    units.iter().find(near).map(|unit| unit.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: (f64, f64) = (0.2, 5.0);

    /// Readings of first and second, over `seconds` in all.
    fn of(seconds: f64, readings: &[(f64, f64)]) -> Pair {
        let mut pair = Pair::default();
        for (first, second) in readings {
            pair.take(*first, *second, 0.0, seconds / readings.len() as f64);
        }
        pair
    }

    /// The second is `second` at first and 0 from then on.
    fn beside(second: f64, first: &[f64]) -> Pair {
        let seconds = |index| if index == 0 { second } else { 0.0 };
        let readings = first.iter().enumerate();
        let readings: Vec<_> = readings.map(|(i, first)| (*first, seconds(i))).collect();
        of(2.0, &readings)
    }

    fn verdict(pair: &Pair) -> Verdict {
        pair.verdict(LIMITS, &LENGTHS)
    }

    #[test]
    fn a_slope_is_that_of_least_squares_and_without_means_where_there_is_a_bias() {
        let readings = [(2.0, 1.0), (3.0, 2.0), (7.0, 4.0)];
        let near = |pair: &Pair, slope: f64, together: f64| {
            let found = pair.line().unwrap();
            assert!(
                (found.slope - slope).abs() < 1e-12 && (found.correlation - together).abs() < 1e-12
            );
        };
        near(&of(1.0, &readings), 36.0 / 21.0, 36.0 / 1302.0_f64.sqrt());
        let mut pair = Pair::default();
        for (first, second) in readings {
            pair.take_unbiased(first, second, 0.0, 1.0);
        }
        // deviations -2, -1, 3 and -4/3, -1/3, 5/3
        near(&pair, 12.0 / 7.0, 4.0 * 3.0_f64.sqrt() / 7.0);
        // a bias changes nothing
        let mut shifted = Pair::default();
        for (first, second) in readings {
            shifted.take_unbiased(first - 9.0, second, 0.0, 1.0);
        }
        near(&shifted, 12.0 / 7.0, 4.0 * 3.0_f64.sqrt() / 7.0);
        for still in [[(0.0, 1.0), (0.0, 2.0)], [(1.0, 0.0), (2.0, 0.0)]] {
            let still = of(1.0, &still);
            assert!(still.line().is_none() && !still.is_related());
            assert_eq!(verdict(&still), Verdict::Unrelated);
        }
    }

    #[test]
    fn a_second_is_seen_where_the_second_reading_moves() {
        let mut pair = Pair::default();
        pair.take(1.0, 0.499, 0.5, 10.0);
        assert!(pair.line().is_none() && !pair.is_settled());
        pair.take(1.0, -0.5, 0.5, 0.5);
        assert!(pair.line().is_some() && !pair.is_settled() && !pair.is_related());
        assert_eq!(verdict(&pair), Verdict::Open);
        pair.take(1.0, -0.5, 0.5, 0.5);
        assert!(pair.is_settled() && pair.is_related());
        // what is nearly still counts against a bias, though not as time
        let mut pair = Pair::default();
        pair.take_unbiased(1.0, 0.499, 0.5, 10.0);
        assert!(!pair.is_settled());
        pair.take_unbiased(1.0, -0.5, 0.5, 1.0);
        assert!(pair.is_settled());
    }

    /// Correlations of exactly 3/4: (3 2 1 1 1) beside (4 0 0 0 0), and of exactly 0.3: (3 9 3 1) beside (10 0 0 0).
    #[test]
    fn what_a_pair_comes_to_changes_at_its_limits() {
        let related = [3.0, 2.0, 1.0, 1.0, 1.0];
        assert!(beside(4.0, &related).is_related());
        assert!(!beside(4.0, &[3.0, 2.1, 1.0, 1.0, 1.0]).is_related());
        assert_eq!(verdict(&beside(4.0, &related)), Verdict::Fits);
        assert_eq!(verdict(&beside(-4.0, &related)), Verdict::Sign(-0.75));
        assert_eq!(
            verdict(&beside(-4.0, &[3.0, 2.1, 1.0, 1.0, 1.0])),
            Verdict::Fits
        );
        assert_eq!(verdict(&beside(10.0, &[3.0, 9.0, 3.0, 1.0])), Verdict::Fits);
        let less = beside(10.0, &[3.0, 9.0, 3.0, 2.0]);
        assert_eq!(verdict(&less), Verdict::Unrelated);
        // factors: 5 and 1/5 are plausible, more and less are not
        assert_eq!(verdict(&of(2.0, &[(5.0, 1.0)])), Verdict::Fits);
        let many = verdict(&of(2.0, &[(6.0, 1.0)]));
        assert_eq!(many, Verdict::Scale(6.0, "another unit"));
        assert_eq!(verdict(&of(2.0, &[(1.0, 5.0)])), Verdict::Fits);
        let few = verdict(&of(2.0, &[(1.0, 8.0)]));
        assert_eq!(few, Verdict::Scale(0.125, "another unit"));
        // a low one of the two only where they go together: 3/16 and 1/10
        let together = beside(4.0, &related.map(|first| 0.25 * first));
        assert_eq!(verdict(&together), Verdict::Scale(0.1875, "another unit"));
        assert_eq!(verdict(&beside(10.0, &[1.0, 1.0, 1.0, 1.0])), Verdict::Fits);
        // a high one in any case
        let apart = verdict(&beside(1.0, &[6.0, 9.0, 9.0, 9.0]));
        assert_eq!(apart, Verdict::Scale(6.0, "another unit"));
        for (factor, unit) in LENGTHS {
            for slipped in [0.8, 1.25] {
                let Verdict::Scale(times, named) = verdict(&of(2.0, &[(factor * slipped, 1.0)]))
                else {
                    panic!("{unit}");
                };
                assert!((times / factor - slipped).abs() < 1e-12 && named == unit);
            }
        }
    }

    #[test]
    fn a_unit_is_a_factor_that_holds_through_speeds_that_vary() {
        let degrees = 57.3;
        let unit = |seconds, speeds: [f64; 2]| {
            let readings = speeds.map(|speed| (degrees * speed, speed));
            of(seconds, &readings).unit().map(|(_, unit)| unit)
        };
        let named = "degrees given as radians";
        assert_eq!(unit(2.0, [3.9, 6.1]), Some(named));
        assert_eq!(unit(1.9, [3.9, 6.1]), None);
        // a fifth of the mean is not enough
        assert_eq!(unit(2.0, [4.0, 6.0]), None);
        assert_eq!(unit(2.0, [5.0, 5.0]), None);
        // a correlation of exactly 0.99: 99² + 14² + 3 = 100²
        let readings = [99.0, 14.0, 1.0, 1.0, 1.0];
        assert_eq!(beside(1.75, &readings).unit(), Some((99.0 / 1.75, named)));
        assert_eq!(beside(1.75, &[99.0, 14.0, 1.0, 1.0, 1.1]).unit(), None);
        // no unit's factor
        assert_eq!(of(2.0, &[(3.9, 3.9), (6.1, 6.1)]).unit(), None);
    }
}
