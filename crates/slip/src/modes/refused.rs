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

/// Limits of what a robot moves in one step, in m, rad, m/s and m/s².
const MOTION: (f64, f64) = (-1e3, 1e3);
/// Limits of places (m), headings (rad), times (s).
const PLACE: (f64, f64) = (-1e9, 1e9);
/// Limits of the length of a step and of the age of a reading, s.
const STEP: (f64, f64) = (1e-4, 1e2);
const AGE: (f64, f64) = (-1e2, 1e2);
/// Limits of variances and their scales: below, rounding loses what is known next to a robot that is lost by kilometres.
const VARIANCE: (f64, f64) = (1e-15, 1e12);

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
        check("time", "s", PLACE, &[step.time])?;
        check("length of the step", "s", STEP, &[step.dt])?;
        for wheel in &step.wheels {
            check("wheel distance", "m", MOTION, wheel.distance.as_slice())?;
            check("wheel distance variance", "m²", VARIANCE, &[wheel.variance])?;
            check("wheel row", "1", MOTION, &wheel.row)?;
            check("wheel row", "1", MOTION, &wheel.across)?;
        }
        check("turn", "rad", MOTION, step.turn.as_slice())?;
        let force = step.force.as_slice().as_flattened();
        check("specific force", "m/s²", MOTION, force)?;
        if let Some(frame) = step.frame {
            check("place", "m", PLACE, &frame.place)?;
            check("heading", "rad", PLACE, frame.heading.as_slice())?;
        }
        for reading in &step.readings {
            match reading.value {
                Value::Place(place) => check("place", "m", PLACE, &place)?,
                Value::Heading(heading) => check("heading", "rad", PLACE, &[heading])?,
                Value::Speed(speed) => check("speed", "m/s", MOTION, &[speed])?,
            }
            check("age of a reading", "s", AGE, &[reading.since])?;
            check("scale of a reading", "1", VARIANCE, &[reading.scale])?;
        }
        Ok(())
    }
}
