//! What is wrong with an input: the field, its value, the limit and the unit.

use grouser_real::OutOfRange;

/// The result of everything that checks an input.
pub type Result<T> = core::result::Result<T, Error>;

/// A bad input. A solve that finds no answer is not one of these: see
/// the `status` of a solution.
///
/// ```
/// use grouser_terra::{Error, RigidWheel};
///
/// let error = RigidWheel::new(0.125, f64::NAN).unwrap_err();
/// assert!(matches!(error, Error::OutOfRange(_)));
/// assert_eq!(error.to_string(), "width is NaN m, but must lie in [0.001, 100] m");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number lies outside what the law allows (NaN always does).
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// A number must be greater than its limit and is not.
    #[error("{field} is {value} {unit}, but must be greater than {limit} {unit}")]
    NotAbove {
        /// The field's name.
        field: &'static str,
        /// What was given.
        value: f64,
        /// What it must exceed.
        limit: f64,
        /// The unit of both.
        unit: &'static str,
    },
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
    /// A parameter that this computation needs was not given.
    #[error("{field} is missing, but {needed_by} needs it")]
    Missing {
        /// The field's name.
        field: &'static str,
        /// What needs it.
        needed_by: &'static str,
    },
    /// The wheel has sunk to its hub: outside the model.
    #[error(
        "sinkage is {sinkage} m, but must stay below the wheel's radius {radius} m (hub buried)"
    )]
    HubBuried {
        /// Sinkage, m.
        sinkage: f64,
        /// The wheel's running radius, m.
        radius: f64,
    },
    /// The soil behind the wheel would rise to the hub.
    #[error(
        "rebound {rebound} times sinkage {sinkage} m must stay below the wheel's radius {radius} m"
    )]
    ReboundAboveHub {
        /// Rebound ratio λ.
        rebound: f64,
        /// Sinkage, m.
        sinkage: f64,
        /// The wheel's running radius, m.
        radius: f64,
    },
    /// Columns that belong together differ in length.
    #[error("a column holds {found} points, but the batch has {expected}")]
    Lengths {
        /// The length of the status column.
        expected: usize,
        /// The length found.
        found: usize,
    },
    /// The two speeds define no slip: standstill, or a wheel rolling against its rotation.
    #[error("forward speed {forward_speed} m/s and wheel speed {rim_speed} m/s define no slip")]
    NoSlip {
        /// Speed of the wheel's centre in its own plane, m/s.
        forward_speed: f64,
        /// Circumferential speed r ω, m/s.
        rim_speed: f64,
    },
}

impl Error {
    /// The name of the field that is bad, where it is one.
    #[must_use]
    pub const fn field(&self) -> Option<&'static str> {
        match self {
            Self::OutOfRange(OutOfRange { field, .. })
            | Self::NotAbove { field, .. }
            | Self::NotFinite { field, .. }
            | Self::Missing { field, .. } => Some(*field),
            Self::HubBuried { .. } => Some("sinkage"),
            Self::ReboundAboveHub { .. } => Some("rebound"),
            Self::NoSlip { .. } | Self::Lengths { .. } => None,
        }
    }

    pub(crate) fn check_finite(field: &'static str, value: f64, unit: &'static str) -> Result<()> {
        if value.is_finite() {
            Ok(())
        } else {
            Err(Self::NotFinite { field, value, unit })
        }
    }

    pub(crate) const fn check_length(found: usize, expected: usize) -> Result<()> {
        if found == expected {
            Ok(())
        } else {
            Err(Self::Lengths { expected, found })
        }
    }

    pub(crate) fn check_above(
        field: &'static str,
        value: f64,
        limit: f64,
        unit: &'static str,
    ) -> Result<()> {
        if value > limit {
            Ok(())
        } else {
            Err(Self::NotAbove {
                field,
                value,
                limit,
                unit,
            })
        }
    }

    pub(crate) fn check_range(
        field: &'static str,
        value: f64,
        low: f64,
        high: f64,
        unit: &'static str,
    ) -> Result<()> {
        Ok(OutOfRange::check(field, value, (low, high), unit)?)
    }
}
