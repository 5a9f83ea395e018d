//! Input that is no number.

use crate::motion::{Step, Value};

/// Why a step was refused: it changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Refused {
    /// A number is not finite, or one that must be positive is not.
    #[error("{field} is {value} {unit}, but must be {must}")]
    Number {
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: &'static str,
        /// What it must be.
        must: &'static str,
    },
    /// The step has another number of wheels than the filter.
    #[error("the step has {found} wheels, but the robot has {expected}")]
    Wheels {
        /// Wheels of the step.
        found: usize,
        /// Wheels of the filter.
        expected: usize,
    },
}

fn finite(field: &'static str, unit: &'static str, values: &[f64]) -> Result<(), Refused> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(&value) => Err(Refused::Number {
            field,
            value,
            unit,
            must: "finite",
        }),
        None => Ok(()),
    }
}

fn positive(field: &'static str, unit: &'static str, value: f64) -> Result<(), Refused> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Refused::Number {
        field,
        value,
        unit,
        must: "finite and greater than 0",
    })
}

impl Refused {
    /// Checks a step.
    pub(super) fn check(step: &Step, wheels: usize) -> Result<(), Self> {
        if step.wheels.len() != wheels {
            return Err(Self::Wheels {
                found: step.wheels.len(),
                expected: wheels,
            });
        }
        finite("time", "s", &[step.time])?;
        positive("length of the step", "s", step.dt)?;
        for wheel in &step.wheels {
            finite("distance of a wheel", "m", wheel.distance.as_slice())?;
            positive("variance of a wheel's distance", "m²", wheel.variance)?;
            finite("row of a wheel", "1", &wheel.row)?;
            finite("row of a wheel", "1", &wheel.across)?;
        }
        finite("turn", "rad", step.turn.as_slice())?;
        finite(
            "specific force",
            "m/s²",
            step.force.as_slice().as_flattened(),
        )?;
        for reading in &step.readings {
            match reading.value {
                Value::Place(place) => finite("place", "m", &place)?,
                Value::Heading(heading) => finite("heading", "rad", &[heading])?,
                Value::Speed(speed) => finite("speed", "m/s", &[speed])?,
            }
            finite("age of a reading", "s", &[reading.since])?;
            positive("scale of a reading's variance", "1", reading.scale)?;
        }
        Ok(())
    }
}
