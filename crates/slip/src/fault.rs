//! What is wrong with a sample: it is refused, counted, and changes nothing else.

use grouser_real::OutOfRange;

/// Why a sample was refused.
///
/// ```
/// use grouser_slip::filter::{FilterSettings, SlipFilter};
/// use grouser_slip::{Fault, Measurement, Robot, Sample, Wheel};
///
/// let robot = Robot::new("cart".into(), vec![Wheel::powered("left").ticks_per_turn(100)])?;
/// let mut filter = SlipFilter::new(&robot, FilterSettings::default())?;
/// let measurement = Measurement::YawRate { rate: f64::NAN }; // rad/s
/// let fault = filter.update(Sample { time_ns: 0, measurement }).unwrap_err();
/// assert!(matches!(fault, Fault::NotFinite { .. }));
/// # Ok::<(), grouser_slip::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// A number is NaN or infinite.
    #[error("{field} is {value}, but must be a finite number of {unit}")]
    NotFinite {
        /// The field's name.
        field: &'static str,
        /// What was given.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A number lies outside what its sensor can mean.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// A sample is not later than the last one of the same sensor.
    #[error("time {time_ns} ns is not later than {last_ns} ns")]
    NotLater {
        /// The sample's time, ns.
        time_ns: i64,
        /// The time of the sensor's last sample, ns.
        last_ns: i64,
    },
    /// A time far from the last one: counted once, and followed if the next sample agrees with it.
    #[error("time {time_ns} ns is far from {last_ns} ns")]
    ClockStep {
        /// The sample's time, ns.
        time_ns: i64,
        /// The newest time before it, ns.
        last_ns: i64,
    },
    /// A sensor's readings do not go with the others': another unit, another sign, another axis.
    #[error("{field} is {times:.3} times what the others say: {looks_like}?")]
    Implausible {
        /// The field's name.
        field: &'static str,
        /// How many times what it should be it is.
        times: f64,
        /// What that looks like.
        looks_like: &'static str,
    },
    /// The robot has no such wheel.
    #[error("wheel index {index} of a robot with {wheels} wheels")]
    UnknownWheel {
        /// What was given.
        index: usize,
        /// How many there are.
        wheels: usize,
    },
    /// The wheel's description lacks what this kind of sample needs.
    #[error("the description of wheel {wheel} has no ticks per turn, which its counts need")]
    NoTicks {
        /// The wheel's index.
        wheel: usize,
    },
    /// A sensor jumped faster than the robot can move.
    #[error("{field} jumped at {value} {unit}, faster than {limit} {unit}")]
    Jump {
        /// The field's name.
        field: &'static str,
        /// The speed that the jump would mean.
        value: f64,
        /// The greatest speed.
        limit: f64,
        /// The unit of both.
        unit: &'static str,
    },
}

impl Fault {
    pub(crate) fn check_finite(
        field: &'static str,
        value: f64,
        unit: &'static str,
    ) -> Result<(), Self> {
        if value.is_finite() {
            Ok(())
        } else {
            Err(Self::NotFinite { field, value, unit })
        }
    }

    pub(crate) fn check_range(
        field: &'static str,
        value: f64,
        low: f64,
        high: f64,
        unit: &'static str,
    ) -> Result<(), Self> {
        Self::check_finite(field, value, unit)?;
        Ok(OutOfRange::check(field, value, (low, high), unit)?)
    }
}

/// How many samples were refused, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Rejected {
    /// NaN, infinite, or outside what the sensor can mean.
    pub bad_value: u64,
    /// Not later than the last sample of the same sensor.
    pub not_later: u64,
    /// Faster than the robot can move.
    pub jump: u64,
    /// For a wheel or an encoder that the robot does not have.
    pub unknown: u64,
}

impl Rejected {
    pub(crate) fn count(&mut self, fault: &Fault) {
        let counter = match fault {
            Fault::NotFinite { .. } | Fault::OutOfRange(_) | Fault::Implausible { .. } => {
                &mut self.bad_value
            }
            Fault::NotLater { .. } | Fault::ClockStep { .. } => &mut self.not_later,
            Fault::Jump { .. } => &mut self.jump,
            Fault::UnknownWheel { .. } | Fault::NoTicks { .. } => &mut self.unknown,
        };
        *counter = counter.saturating_add(1);
    }

    /// All of them.
    #[must_use]
    pub const fn total(&self) -> u64 {
        self.bad_value
            .saturating_add(self.not_later)
            .saturating_add(self.jump)
            .saturating_add(self.unknown)
    }
}
