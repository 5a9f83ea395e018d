//! From the fields of a row to typed readings.

use grouser_files::columns::{Meaning, Table};

use super::number::{self, NotANumber};
use crate::record::Reading;

/// Where in a row the parts of each reading stand.
pub(crate) struct Plan {
    pub(crate) time: usize,
    slots: Vec<Slot>,
    missing: Vec<String>,
    decimal: u8,
    nanoseconds: i64,
}

enum Slot {
    Wheel(Meaning, usize, Part),
    YawRate(Part),
    Displacement(Part, Part, Option<Part>),
    Pose(Part, Part, Part),
    Speed(Part, Option<Part>),
    Command(Part, Option<Part>),
}

#[derive(Clone, Copy)]
struct Part {
    field: usize,
    factor: f64,
}

/// What is wrong with one field of a row.
#[derive(Clone, Copy)]
pub(crate) struct BadField {
    pub(crate) field: usize,
    pub(crate) problem: NotANumber,
}

impl Plan {
    /// `fields` holds the place of each of the table's columns in the row, `wheels` the wheels of the
    /// log.
    pub(crate) fn new(table: &Table, time: usize, fields: &[usize], wheels: &[String]) -> Self {
        let part = |meaning: Meaning| {
            let at = table.columns.iter().position(|c| c.meaning == meaning)?;
            Some(Part {
                field: fields[at],
                factor: table.columns[at].factor,
            })
        };
        let mut slots = Vec::new();
        for (column, &field) in table.columns.iter().zip(fields) {
            let own = Part {
                field,
                factor: column.factor,
            };
            let wheel = || {
                let name = column.wheel.as_ref()?;
                wheels.iter().position(|wheel| wheel == name)
            };
            let slot = match column.meaning {
                Meaning::YawRate => Some(Slot::YawRate(own)),
                Meaning::DisplacementForward => part(Meaning::DisplacementLeft)
                    .map(|left| Slot::Displacement(own, left, part(Meaning::DisplacementTurn))),
                Meaning::PoseX => part(Meaning::PoseY)
                    .zip(part(Meaning::PoseYaw))
                    .map(|(y, yaw)| Slot::Pose(own, y, yaw)),
                Meaning::SpeedForward => Some(Slot::Speed(own, part(Meaning::SpeedLeft))),
                Meaning::CommandForward => Some(Slot::Command(own, part(Meaning::CommandLeft))),
                meaning if meaning.is_of_a_wheel() => {
                    wheel().map(|wheel| Slot::Wheel(meaning, wheel, own))
                }
                // Second parts of the above.
                _ => None,
            };
            slots.extend(slot);
        }
        Self {
            time,
            slots,
            missing: table.missing.clone(),
            decimal: table.decimal,
            nanoseconds: table.time.nanoseconds,
        }
    }

    /// The row's time, ns.
    pub(crate) fn time_ns(&self, text: &str) -> Result<i64, BadField> {
        number::nanoseconds(text, self.decimal, self.nanoseconds).map_err(|problem| BadField {
            field: self.time,
            problem,
        })
    }

    /// Gives every reading of the row to `take`; one that lacks a part is left out.
    pub(crate) fn readings<'a>(
        &self,
        field: impl Fn(usize) -> &'a str,
        mut take: impl FnMut(Reading),
    ) -> Result<(), BadField> {
        let is_missing = |text: &str| {
            let text = text.trim();
            text.is_empty() || self.missing.iter().any(|word| word == text)
        };
        let number = |part: Part| -> Result<Option<f64>, BadField> {
            let text = field(part.field);
            if is_missing(text) {
                return Ok(None);
            }
            let bad = |problem| BadField {
                field: part.field,
                problem,
            };
            let value = number::finite(text, self.decimal).map_err(bad)? * part.factor;
            // A factor may still carry a number out of range.
            if value.is_finite() {
                Ok(Some(value))
            } else {
                Err(bad(NotANumber {
                    expected: "a finite number in SI units as well",
                    hint: None,
                }))
            }
        };
        let optional = |part: Option<Part>| part.map_or(Ok(None), number);
        for slot in &self.slots {
            let reading = match *slot {
                Slot::Wheel(Meaning::WheelCount, wheel, part) => {
                    let text = field(part.field);
                    if is_missing(text) {
                        None
                    } else {
                        let raw = number::count(text).map_err(|problem| BadField {
                            field: part.field,
                            problem,
                        })?;
                        Some(Reading::WheelCount { wheel, raw })
                    }
                }
                Slot::Wheel(Meaning::WheelAngle, wheel, part) => {
                    number(part)?.map(|angle| Reading::WheelAngle { wheel, angle })
                }
                Slot::Wheel(_, wheel, part) => {
                    number(part)?.map(|rate| Reading::WheelRate { wheel, rate })
                }
                Slot::YawRate(part) => number(part)?.map(|rate| Reading::YawRate { rate }),
                Slot::Displacement(forward, left, turn) => {
                    let turn = optional(turn)?;
                    number(forward)?.zip(number(left)?).map(|(forward, left)| {
                        Reading::Displacement {
                            forward,
                            left,
                            turn,
                        }
                    })
                }
                Slot::Pose(x, y, yaw) => number(x)?
                    .zip(number(y)?)
                    .zip(number(yaw)?)
                    .map(|((x, y), yaw)| Reading::Pose { x, y, yaw }),
                Slot::Speed(forward, left) => {
                    let left = optional(left)?;
                    number(forward)?.map(|forward| Reading::Speed { forward, left })
                }
                Slot::Command(forward, left) => {
                    let left = optional(left)?.unwrap_or(0.0);
                    number(forward)?.map(|forward| Reading::Command { forward, left })
                }
            };
            reading.into_iter().for_each(&mut take);
        }
        Ok(())
    }
}
