//! What is wrong with a robot's description or with the settings.

use alloc::string::String;

/// The result of everything that checks a description.
pub type Result<T> = core::result::Result<T, Error>;

/// A robot or settings that cannot be used. What is wrong with a *sample* is a [`Fault`](crate::Fault).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number lies outside its limits (NaN always does).
    #[error("{of}: {field} is {value} {unit}, but must lie in [{low}, {high}] {unit}")]
    OutOfRange {
        /// The wheel or the group of settings.
        of: String,
        /// The field's name.
        field: &'static str,
        /// What was given.
        value: f64,
        /// The least value allowed.
        low: f64,
        /// The greatest value allowed.
        high: f64,
        /// The unit of all three; `1` for a pure number.
        unit: &'static str,
    },
    /// The number of wheels is outside its limits.
    #[error("the robot has {count} wheels, but must have 1 to {limit}")]
    WheelCount {
        /// How many were given.
        count: usize,
        /// The greatest number.
        limit: usize,
    },
    /// The robot has no such wheel.
    #[error("wheel index {index} of a robot with {wheels} wheels")]
    UnknownWheel {
        /// The index that was given.
        index: usize,
        /// The number of wheels.
        wheels: usize,
    },
    /// Two wheels have one name, or a wheel has none.
    #[error("wheel name `{name}` is empty or used twice")]
    WheelName {
        /// The name.
        name: String,
    },
    /// The laws of wheel and soil refuse a number.
    #[error("{of}: {source}")]
    Law {
        /// Of which wheel.
        of: String,
        /// What they refuse.
        source: grouser_terra::Error,
    },
    /// A counter width that no counter has.
    #[error("counter width is {bits} bits, but must lie in [8, 64] bits")]
    CounterWidth {
        /// What was given.
        bits: u32,
    },
}

/// Checks that `value` lies in [low, high].
pub(crate) fn check_range(
    of: &str,
    field: &'static str,
    value: f64,
    (low, high): (f64, f64),
    unit: &'static str,
) -> Result<()> {
    if value >= low && value <= high {
        Ok(())
    } else {
        Err(Error::OutOfRange {
            of: of.into(),
            field,
            value,
            low,
            high,
            unit,
        })
    }
}
