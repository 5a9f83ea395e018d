//! The reader of one table.

use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use grouser_files::columns::{Column, Table};
use grouser_files::nearest;

use super::fields::{BadQuote, Field, split};
use super::lines::Lines;
use super::row::Plan;
use crate::error::{BadField, Cell, Error, NotANumber, Result};
use crate::message::NavSatFix;
use crate::messages::LeftOut;
use crate::order::Ordered;
use crate::recording::navigation::{FixColumns, Fixes, MAX_FIXES};
use crate::source::Source;
use grouser_real::Real;
use grouser_slip::{Measurement, Sample};

/// How many rows a row may stand from its place in time.
pub(crate) const TABLE_LOOK_AHEAD: usize = 1024;
/// Rows of several sensors may be written out of order, but not by this much: a clock was set, s.
const SET_BACK_S: f64 = 60.0;
/// A pose of exact zeros behind one that is farther from there is a row without a new pose, m.
const FILLED_FROM_M: f64 = 0.05;
/// A message shows this much of a bad field.
const SHOWN: usize = 64;

/// What the readers of a log's tables count together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Counts {
    /// Bytes that were read.
    pub(crate) read: Arc<AtomicU64>,
    cut_off: Arc<Mutex<Vec<Cell>>>,
    /// Rows, and those with the time of the row before.
    pub(crate) rows: Arc<AtomicU64>,
    pub(crate) same_time: Arc<AtomicU64>,
    /// Poses of zeros in rows without a new one.
    pub(crate) zero_poses: Arc<AtomicU64>,
    excluded: Arc<Mutex<LeftOut>>,
}

impl Counts {
    /// A log is read from its beginning.
    pub(crate) fn begin(&self) {
        self.cut_off().clear();
        *self.excluded() = LeftOut::default();
        for count in [&self.rows, &self.same_time, &self.zero_poses] {
            count.store(0, Relaxed);
        }
    }

    /// Fixes that are not used.
    pub(crate) fn excluded(&self) -> MutexGuard<'_, LeftOut> {
        (self.excluded.lock()).unwrap_or_else(PoisonError::into_inner)
    }

    /// The last lines of tables that are cut off.
    pub(crate) fn cut_off(&self) -> MutexGuard<'_, Vec<Cell>> {
        // Whoever panicked left whole places behind.
        self.cut_off.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Samples of one table in the order of time.
///
/// It reads line by line: memory does not grow with the file. A row whose time is garbled is left out and counted. Any other error
/// ends it, but for one in a last line without a line end, which is cut off.
pub(crate) struct CsvReader {
    lines: Lines,
    names: Vec<String>,
    plan: Plan,
    separator: u8,
    fields: Vec<Field>,
    ordered: Ordered<Sample>,
    look_ahead: usize,
    rows: u64,
    last_ns: Option<i64>,
    /// How far the last place was from the origin, m.
    last_place: Option<f64>,
    counts: Counts,
    /// `None`: fixes are not used.
    fixes: Option<FixColumns>,
    done: bool,
}

impl CsvReader {
    /// Opens a table and reads its header. `wheels` are the log's wheels, to which the samples' indices refer;
    /// `look_ahead` rows are held back; `counts` receives what is read and what is cut off.
    pub(crate) fn open(
        source: &Source,
        table: &Table,
        (wheels, look_ahead, counts): (&[String], usize, &Counts),
    ) -> Result<Self> {
        let mut lines = Lines::from_source(source, &counts.read)?;
        let mut names: Vec<String> = Vec::new();
        let mut header = lines.cell();
        let mut fields = Vec::new();
        for number in 1..=table.header_lines {
            if !lines.advance()? {
                return Err(Error::Empty {
                    file: source.name(),
                    what: if number == 1 {
                        "nothing"
                    } else {
                        "less than its header"
                    },
                });
            }
            let text = lines.text()?;
            if number == table.names_line {
                let text = super::lines::names(text);
                header = lines.cell();
                split(text, table.separator, &mut fields)
                    .map_err(|bad| bad_quote(&header, &[], bad))?;
                names = fields
                    .iter()
                    .map(|field| field.text(text).trim().to_owned())
                    .collect();
            }
        }
        if table.header_lines == 0 {
            names = numbers(source, table.separator)?;
            header.line = 1;
        }
        let time = find(&names, &table.time.column, &header)?;
        let nanoseconds = (table.time.nanoseconds.as_ref())
            .map(|column| find(&names, column, &header))
            .transpose()?;
        let mut present = table.clone();
        let is_there = |column: &Column| !column.is_optional || names.contains(&column.column);
        present.columns.retain(is_there);
        let places = present
            .columns
            .iter()
            .map(|column| find(&names, &column.column, &header))
            .collect::<Result<Vec<usize>>>()?;
        Ok(Self {
            plan: Plan::new(&present, (time, nanoseconds), places, wheels),
            lines,
            names,
            separator: table.separator,
            fields,
            ordered: Ordered::new(look_ahead),
            look_ahead,
            rows: 0,
            last_ns: None,
            last_place: None,
            counts: counts.clone(),
            fixes: None,
            done: false,
        })
    }

    /// The same, with its fixes as places.
    pub(crate) fn with_fixes(self, fixes: Option<FixColumns>) -> Self {
        Self { fixes, ..self }
    }

    /// The fixes of its first rows.
    pub(crate) fn first_fixes(self, fixes: FixColumns) -> Fixes {
        let mut reader = self.with_fixes(Some(fixes));
        for _ in 0..MAX_FIXES {
            if !matches!(reader.read_row(), Ok(true)) {
                break;
            }
            reader.ordered.clear();
        }
        reader.fixes.map(|fixes| fixes.seen).unwrap_or_default()
    }

    /// Reads one row into the ordering; false at the end of the file.
    fn read_row(&mut self) -> Result<bool> {
        if !self.lines.advance()? {
            return if self.rows == 0 {
                Err(Error::Empty {
                    file: self.lines.cell().file,
                    what: "a header and no data",
                })
            } else {
                Ok(false)
            };
        }
        let taken = self.take_row();
        // Of a single row it is not known whether the file is a table at all.
        if taken.is_err() && self.rows > 0 && !self.lines.is_ended() {
            self.counts.cut_off().push(self.lines.cell());
            return Ok(false);
        }
        taken.map(|()| true)
    }

    fn take_row(&mut self) -> Result<()> {
        let text = self.lines.text()?;
        if text.is_empty() {
            return Ok(());
        }
        let here = self.lines.cell();
        split(text, self.separator, &mut self.fields)
            .map_err(|bad| bad_quote(&here, &self.names, bad))?;
        if self.fields.len() != self.names.len() {
            return Err(Error::Ragged {
                at: here,
                found: self.fields.len(),
                expected: self.names.len(),
            });
        }
        let field = |index: usize| self.fields[index].text(text);
        let bad = |bad: BadField| bad_field(&here, &self.names, field(bad.field), bad);
        let time_ns = match self.plan.time_ns(field) {
            Ok(time_ns) => time_ns,
            // one garbled time is no end of a table, but a header that is repeated begins another log
            Err(fault) if self.rows > 0 && self.lines.is_ended() => {
                let is_header = self.names[fault.field] == field(fault.field).trim();
                let error = bad(fault);
                if is_header {
                    return Err(error);
                }
                self.counts.excluded().leave_out_row(&error);
                return Ok(());
            }
            Err(fault) => return Err(bad(fault)),
        };
        let by_s = self.last_ns.unwrap_or(time_ns).saturating_sub(time_ns) as f64 * 1e-9;
        if by_s > SET_BACK_S {
            return Err(Error::SetBack {
                at: cell(&here, &self.names, self.plan.time),
                by_s,
            });
        }
        let is_same = self.last_ns.replace(time_ns) == Some(time_ns);
        self.counts.rows.fetch_add(1, Relaxed);
        (self.counts.same_time).fetch_add(u64::from(is_same), Relaxed);
        self.ordered
            .begin_row(time_ns)
            .map_err(|by_s| Error::OutOfOrder {
                at: here.clone(),
                by_s,
                look_ahead: self.look_ahead,
            })?;
        let (ordered, last_place) = (&mut self.ordered, &mut self.last_place);
        let mut filled = 0;
        let (fixes, counts) = (&mut self.fixes, &self.counts);
        let mut fix = |fix: NavSatFix| match fixes.as_mut()?.place(fix) {
            Ok(place) => Some(place),
            Err(fault) => {
                counts.excluded().exclude(fault);
                None
            }
        };
        self.plan
            .readings(field, &mut fix, &mut |measurement| {
                if let Measurement::Pose { x, y, yaw } = measurement {
                    let is_zero = [x, y, yaw].iter().all(|part| *part == 0.0);
                    if is_zero && last_place.is_some_and(|far| far > FILLED_FROM_M) {
                        filled += 1;
                        return;
                    }
                    *last_place = Some(Real::hypot(x, y));
                }
                ordered.push(Sample {
                    time_ns,
                    measurement,
                });
            })
            .map_err(bad)?;
        self.counts.zero_poses.fetch_add(filled, Relaxed);
        self.rows += 1;
        Ok(())
    }
}

impl Iterator for CsvReader {
    type Item = Result<Sample>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.done && !self.ordered.is_ripe() {
            match self.read_row() {
                Ok(true) => {}
                Ok(false) => self.done = true,
                Err(error) => {
                    self.done = true;
                    self.ordered.clear();
                    return Some(Err(error));
                }
            }
        }
        self.ordered.pop().map(Ok)
    }
}

/// The names of columns without a header: their numbers from 1, as far as the first row goes.
fn numbers(source: &Source, separator: u8) -> Result<Vec<String>> {
    let mut lines = Lines::from_source(&source.as_it_is(), &Arc::default())?;
    let mut fields = Vec::new();
    if !lines.advance()? {
        return Err(Error::Empty {
            file: source.name(),
            what: "nothing",
        });
    }
    let here = lines.cell();
    split(lines.text()?, separator, &mut fields).map_err(|bad| bad_quote(&here, &[], bad))?;
    Ok((1..=fields.len())
        .map(|number| number.to_string())
        .collect())
}

fn find(names: &[String], column: &str, header: &Cell) -> Result<usize> {
    let mut found = names
        .iter()
        .enumerate()
        .filter(|(_, name)| *name == column)
        .map(|(index, _)| index);
    match (found.next(), found.next()) {
        (Some(index), None) => Ok(index),
        (Some(_), Some(second)) => Err(Error::TwoColumns {
            at: Cell {
                column: Some(second + 1),
                name: Some(column.into()),
                ..header.clone()
            },
        }),
        (None, _) => Err(Error::NoColumn {
            at: header.clone(),
            column: column.into(),
            meant: nearest(column, names.iter().map(String::as_str)).map(Into::into),
        }),
    }
}

fn cell(here: &Cell, names: &[String], field: usize) -> Cell {
    Cell {
        column: Some(field + 1),
        name: names.get(field).filter(|name| !name.is_empty()).cloned(),
        ..here.clone()
    }
}

fn bad_quote(here: &Cell, names: &[String], bad: BadQuote) -> Error {
    Error::Malformed {
        at: cell(here, names, bad.field),
        what: bad.what,
    }
}

fn bad_field(here: &Cell, names: &[String], found: &str, bad: BadField) -> Error {
    let NotANumber { expected, mut hint } = bad.problem;
    if names
        .get(bad.field)
        .is_some_and(|name| name == found.trim())
    {
        hint = Some(
            "the header is repeated here: the file contains two logs; split it, or remove the line",
        );
    }
    Error::NotANumber {
        at: cell(here, names, bad.field),
        found: found.chars().take(SHOWN).collect(),
        expected,
        hint,
    }
}
