//! Input that cannot be used.

use grouser_real::OutOfRange;

use crate::motion::{Step, Value};

/// Why a step was refused: it changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Refused {
    /// A number lies outside its limits (NaN always does).
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// The step has another number of wheels than the filter.
    #[error("the step has {found} wheels, but the robot has {expected}")]
    Wheels {
        /// Wheels of the step.
        found: usize,
        /// Wheels of the filter.
        expected: usize,
    },
}

/// No robot measures a number beyond these; their squares, divided by any variance, are finite.
const ANY: (f64, f64) = (-1e9, 1e9);
/// Limits of what must be positive: variances, lengths of time, scales.
const POSITIVE: (f64, f64) = (1e-18, 1e18);

impl Refused {
    /// Checks a step.
    pub(super) fn check(step: &Step, wheels: usize) -> Result<(), Self> {
        if step.wheels.len() != wheels {
            return Err(Self::Wheels {
                found: step.wheels.len(),
                expected: wheels,
            });
        }
        let check = |field, unit, limits, values: &[f64]| -> Result<(), OutOfRange> {
            (values.iter()).try_for_each(|&value| OutOfRange::check(field, value, limits, unit))
        };
        check("time", "s", ANY, &[step.time])?;
        check("length of the step", "s", POSITIVE, &[step.dt])?;
        for wheel in &step.wheels {
            check("wheel distance", "m", ANY, wheel.distance.as_slice())?;
            check("wheel distance variance", "m²", POSITIVE, &[wheel.variance])?;
            check("wheel row", "1", ANY, &wheel.row)?;
            check("wheel row", "1", ANY, &wheel.across)?;
        }
        check("turn", "rad", ANY, step.turn.as_slice())?;
        let force = step.force.as_slice().as_flattened();
        check("specific force", "m/s²", ANY, force)?;
        for reading in &step.readings {
            match reading.value {
                Value::Place(place) => check("place", "m", ANY, &place)?,
                Value::Heading(heading) => check("heading", "rad", ANY, &[heading])?,
                Value::Speed(speed) => check("speed", "m/s", ANY, &[speed])?,
            }
            check("age of a reading", "s", ANY, &[reading.since])?;
            check("scale of a reading", "1", POSITIVE, &[reading.scale])?;
        }
        Ok(())
    }
}
