//! What is wrong with a robot's description or with the settings.

use alloc::string::String;

use grouser_real::OutOfRange;

/// The result of everything that checks a description.
pub type Result<T> = core::result::Result<T, Error>;

/// A robot or settings that cannot be used. What is wrong with a *sample* is a [`Fault`](crate::Fault).
///
/// ```
/// use grouser_slip::{Robot, Wheel};
///
/// let wheels = vec![Wheel::powered("left").radius(-0.1)];
/// let error = Robot::new("cart".into(), wheels).unwrap_err();
/// assert_eq!(error.to_string(), "left: radius is -0.1 m, but must lie in [0.001, 10] m");
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number lies outside its limits (NaN always does).
    #[error("{of}: {range}")]
    OutOfRange {
        /// The wheel or the group of settings.
        of: String,
        /// The number and its limits.
        range: OutOfRange,
    },
    /// Soil is to be learnt, but there are no soils to choose between.
    #[error("soil is to be learnt, but the soil tables have no family: give `SoilTables::family`")]
    MissingFamily,
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
    limits: (f64, f64),
    unit: &'static str,
) -> Result<()> {
    OutOfRange::check(field, value, limits, unit).map_err(|range| Error::OutOfRange {
        of: of.into(),
        range,
    })
}
