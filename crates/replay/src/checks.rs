//! Checks at the end of a run: does the filter's result agree with the log that it was made of?

use std::fmt;

use grouser_doctor::{Mistake, ReferenceDelay};

/// A reference of which the filter used less than this share was locked out, not noisy.
const MIN_USED_SHARE: f64 = 0.5;
/// Fewer readings than this are no series.
const MIN_READINGS: u64 = 10;
/// The whole way's slip by the filter and by the reference may differ by this: sums over windows at starts, stops and
/// turns differ by up to 0.02 in the shipped logs.
const MAX_SLIP_DIFFERENCE: f64 = 0.05;
/// And their ways by this, m: at a start the filter follows some windows late, which is much of a way of half a metre.
const MAX_WAY_DIFFERENCE_M: f64 = 0.05;
/// A longer time between two samples is no gap of a recording, s.
pub(crate) const MAX_GAP_S: f64 = 3600.0;
/// A shorter way by the wheels is not compared, m.
const MIN_WAY_M: f64 = 0.5;

/// How many readings of the reference there were, and how many of them the filter used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReferenceUse {
    /// Readings that the filter was given, repeated ones left out.
    pub readings: u64,
    /// Readings that it did not refuse.
    pub used: u64,
}

/// Ways while the reference was known, m, between the same times, each along the direction in which the wheels drove. Their slips
/// are 1 − way / wheels, and wheels / way − 1 of a robot that goes farther than its wheels.
///
/// ```
/// let mut ways = grouser_replay::WayCheck::default();
/// (ways.wheels, ways.filter, ways.reference) = (10.0, 8.0, 7.5); // m
/// assert!((ways.slip_by_filter().unwrap() - 0.2).abs() < 1e-12);
/// assert!((ways.slip_by_reference().unwrap() - 0.25).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct WayCheck {
    /// By the wheels.
    pub wheels: f64,
    /// By the filter.
    pub filter: f64,
    /// By the reference alone.
    pub reference: f64,
}

impl WayCheck {
    /// Slip of the whole way by the filter; `None` of a way too short to compare.
    #[must_use]
    pub fn slip_by_filter(&self) -> Option<f64> {
        self.slip(self.filter)
    }

    /// Slip of the whole way by the reference; `None` of a way too short to compare.
    #[must_use]
    pub fn slip_by_reference(&self) -> Option<f64> {
        self.slip(self.reference)
    }

    /// 1 − way / wheels, of a robot that goes farther than its wheels wheels / way − 1; above 1 where it goes against them.
    fn slip(&self, way: f64) -> Option<f64> {
        let slip = if way > self.wheels {
            self.wheels / way - 1.0
        } else {
            1.0 - way / self.wheels
        };
        (self.wheels > MIN_WAY_M).then_some(slip)
    }
}

/// Why a result is doubtful.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// The filter used no reading of its only reference.
    ReferenceUnused,
    /// The filter refused most readings of its only reference.
    ReferenceRefused(ReferenceUse),
    /// The filter's way differs from the reference's.
    WaysDiffer {
        /// Slip of the whole way by the filter.
        filter: f64,
        /// Slip of the whole way by the reference.
        reference: f64,
    },
    /// The reference's stamps are apart from those of wheels and gyro by more than is corrected.
    ClocksApart(ReferenceDelay),
    /// Between two samples lies this time, s: the clock was set, or the log consists of two drives.
    ClockJump(f64),
    /// A sensor is described wrongly.
    Description(Mistake),
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ReferenceUnused => write!(
                f,
                "no reading of the reference could be used: how fast the robot travels is not known, and no slip is"
            ),
            Self::ReferenceRefused(ReferenceUse { readings, used }) => write!(
                f,
                "the filter used {used} of {readings} readings of its reference: its slips do not follow from this log"
            ),
            Self::WaysDiffer { filter, reference } => write!(
                f,
                "the slip over the total distance is {filter:.3} by the filter, but {reference:.3} by the reference alone"
            ),
            Self::ClocksApart(delay) => write!(f, "{delay}"),
            Self::ClockJump(gap_s) => write!(
                f,
                "the times of the log jump by {gap_s:.0} s: its clock was set, or it holds more than one drive"
            ),
            Self::Description(mistake) => write!(f, "{mistake}"),
        }
    }
}

/// The doubts about a filter's run; `reference` is `None` where no sensor measures the robot's motion.
pub(crate) fn doubts(reference: Option<ReferenceUse>, ways: &WayCheck) -> Vec<Doubt> {
    let refused = reference.filter(|of| {
        of.readings >= MIN_READINGS && (of.used as f64) < MIN_USED_SHARE * of.readings as f64
    });
    let is_far = !((ways.filter - ways.reference).abs() <= MAX_WAY_DIFFERENCE_M);
    let differ = (ways.slip_by_filter().filter(|_| is_far))
        .zip(ways.slip_by_reference())
        .filter(|(filter, reference)| !((filter - reference).abs() <= MAX_SLIP_DIFFERENCE));
    let refused = refused.map(Doubt::ReferenceRefused);
    let differ = differ.map(|(filter, reference)| Doubt::WaysDiffer { filter, reference });
    refused.into_iter().chain(differ).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reference_that_is_locked_out_and_a_way_that_differs_are_doubts() {
        let of = |used| {
            Some(ReferenceUse {
                readings: 306,
                used,
            })
        };
        let ways = |filter| WayCheck {
            wheels: 20.0,
            filter,
            reference: 12.0,
        };
        assert!(doubts(of(300), &ways(12.4)).is_empty());
        assert!(doubts(None, &WayCheck::default()).is_empty());
        let found = doubts(of(24), &ways(20.2));
        assert_eq!(found.len(), 2);
        assert!(found[0].to_string().contains("24 of 306"), "{}", found[0]);
        assert!(found[1].to_string().contains("0.400"), "{}", found[1]);
    }

    #[test]
    fn a_start_of_a_short_way_is_no_doubt() {
        let ways = |scale: f64| WayCheck {
            wheels: 0.560 * scale,
            filter: 0.419 * scale,
            reference: 0.448 * scale,
        };
        // 0.252 and 0.200, but 29 mm apart
        assert!(doubts(None, &ways(1.0)).is_empty());
        assert_eq!(doubts(None, &ways(10.0)).len(), 1);
    }

    #[test]
    fn slips_of_a_robot_that_goes_farther_than_its_wheels_are_compared_as_braking() {
        let ways = |filter, reference| WayCheck {
            wheels: 7.216,
            filter,
            reference,
        };
        let found = doubts(None, &ways(8.820, 7.000));
        let text = found[0].to_string();
        // 7.216/8.820 − 1 and 1 − 7.000/7.216
        assert!(
            text.contains("-0.182 by the filter") && text.contains("0.030 by the reference"),
            "{text}"
        );
        // −0.167 and −0.213; as 1 − way / wheels they would be −0.20 and −0.27
        assert!(doubts(None, &ways(1.20 * 7.216, 1.27 * 7.216)).is_empty());
    }
}
