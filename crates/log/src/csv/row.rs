//! From the fields of a row to typed readings.

use grouser_files::columns::{Table, TimeUnit};

use super::number;
use crate::error::{BadField, NotANumber};
use crate::message::NavSatFix;
use crate::slots::{Part, Slots};
use grouser_slip::Measurement;

/// Where in a row the parts of each reading stand.
pub(crate) struct Plan {
    pub(crate) time: usize,
    /// The field of the nanoseconds that are added to it; of a date, that of the time of day.
    pub(crate) nanoseconds: Option<usize>,
    slots: Slots,
    /// The field of each column.
    fields: Vec<usize>,
    missing: Vec<String>,
    decimal: u8,
    time_unit: TimeUnit,
}

impl Plan {
    /// `fields` holds the place of each of the table's columns in the row, `wheels` the wheels of the
    /// log.
    pub(crate) fn new(
        table: &Table,
        (time, nanoseconds): (usize, Option<usize>),
        fields: Vec<usize>,
        wheels: &[String],
    ) -> Self {
        Self {
            time,
            nanoseconds,
            slots: Slots::new(&table.columns, wheels),
            fields,
            missing: table.missing.clone(),
            decimal: table.decimal,
            time_unit: table.time.unit,
        }
    }

    /// The row's time, ns.
    pub(crate) fn time_ns<'a>(&self, field: impl Fn(usize) -> &'a str) -> Result<i64, BadField> {
        let time = |place, unit| {
            number::time_ns(field(place), self.decimal, unit).map_err(|problem| BadField {
                field: place,
                problem,
            })
        };
        if let (TimeUnit::Date, Some(of_day)) = (self.time_unit, self.nanoseconds) {
            let both = number::time_of_two(field(self.time), field(of_day));
            return both.map_err(|problem| BadField {
                field: self.time,
                problem,
            });
        }
        let whole = time(self.time, self.time_unit)?;
        let beyond = self
            .nanoseconds
            .map(|place| time(place, TimeUnit::Nanoseconds(1)));
        Ok(whole.saturating_add(beyond.transpose()?.unwrap_or(0)))
    }

    /// Gives every reading of the row to `take`; one that lacks a part is left out. `fix` makes places of fixes.
    pub(crate) fn readings<'a>(
        &self,
        field: impl Fn(usize) -> &'a str,
        fix: &mut dyn FnMut(NavSatFix) -> Option<Measurement>,
        take: &mut dyn FnMut(Measurement),
    ) -> Result<(), BadField> {
        // The text of a part with its field; `None` where there is no value.
        let given = |part: Part| {
            let place = self.fields[part.column];
            let text = field(place);
            let bare = text.trim();
            let missing = bare.is_empty() || self.missing.iter().any(|word| word == bare);
            (!missing).then_some((text, place))
        };
        let bad = |field| move |problem| BadField { field, problem };
        let number = |part: Part| -> Result<Option<f64>, BadField> {
            let Some((text, place)) = given(part) else {
                return Ok(None);
            };
            let value = number::finite(text, self.decimal).map_err(bad(place))?;
            let value = part.si(value);
            // A factor may still carry a number out of range.
            if value.is_finite() {
                Ok(Some(value))
            } else {
                Err(bad(place)(NotANumber {
                    expected: "a finite number in SI units as well",
                    hint: None,
                }))
            }
        };
        let count = |part: Part| -> Result<Option<u64>, BadField> {
            given(part)
                .map(|(text, place)| number::count(text).map_err(bad(place)))
                .transpose()
        };
        self.slots.readings(&number, &count, fix, take)
    }
}
