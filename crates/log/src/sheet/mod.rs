//! What a table of text holds, without a column map: its layout, its columns, its times, and what they
//! probably mean by their names.

mod guess;
mod layout;
mod open;
mod pose;
mod time_column;
mod words;

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use grouser_files::columns::{Meaning, TimeUnit};
use grouser_real::{Real, median};

use crate::csv::{Lines, finite, split, time_ns, time_of_two};
use crate::error::Result;
use crate::source::Source;
pub use guess::Guess;
pub(crate) use guess::guess;
use guess::of_fix_numbers;
use layout::Layout;
use open::of_turning;
pub(crate) use open::{is_beyond_radians, open_question, perhaps};
use time_column::{seconds_and_nanoseconds, time_rank, time_unit};
use words::split_unit;

/// A yaw of more than a turn may be one in degrees, rad.
const MAX_YAW_RAD: f64 = 6.4;
/// The maximum number of columns that are listed.
const MAX_COLUMNS: usize = 1024;
/// An interval of more than this many medians is a gap.
const GAP_MEDIANS: f64 = 5.0;
/// This many intervals are kept for their median; beyond it every second one, then every fourth.
const MAX_INTERVALS: usize = 1 << 16;

/// One column of a table.
///
/// ```
/// use grouser_log::Sheet;
///
/// let sheet = Sheet::read("../../examples/five-wheel/log.csv".as_ref(), |_| ())?;
/// assert_eq!((sheet.rows, sheet.ragged), (2001, 0));
/// assert!(sheet.time.is_some());
/// # Ok::<(), grouser_log::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SheetColumn {
    /// Its name.
    pub name: String,
    /// The first field that is not empty.
    pub first: String,
    /// Fields that are finite numbers.
    pub numbers: u64,
    /// Fields that are empty.
    pub empty: u64,
    /// Fields that are something else.
    pub others: u64,
    /// The minimum.
    pub min: f64,
    /// The maximum.
    pub max: f64,
    /// Are all numbers whole?
    pub whole: bool,
    /// How often a number is less than the one before.
    pub falls: u64,
    /// The maximum difference between a number and the one before.
    pub max_step: f64,
    /// What it probably means.
    pub guess: Option<Guess>,
    /// The word for a number that is missing (`nan`), where there is one; such fields count as empty.
    pub missing: Option<String>,
    /// How many numbers are larger than a turn, taken for radians.
    beyond_a_turn: u64,
}

/// The times of a table.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SheetTime {
    /// The index of its column.
    pub column: usize,
    /// The index of the column of the nanoseconds beyond it; of a date, that of the time of day.
    pub nanoseconds: Option<usize>,
    /// Its unit, as column maps name it.
    pub unit: &'static str,
    /// From the first time to the latest, s.
    pub duration_s: f64,
    /// Rows per second, by the median interval.
    pub rate_hz: Option<f64>,
    /// The longest interval, s.
    pub longest_s: f64,
    /// Intervals of more than five times the median.
    pub gaps: u64,
    /// How often it goes back.
    pub jumps: u64,
}

/// An open quotation mark: no row.
const CUT: &str = "\"";

/// What a table holds.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Sheet {
    /// The separator, one byte.
    pub separator: u8,
    /// The decimal mark, one byte.
    pub decimal: u8,
    /// Lines before the data.
    pub header_lines: usize,
    /// Which of them names the columns, counted from 1.
    pub names_line: usize,
    /// Its columns, in order.
    pub columns: Vec<SheetColumn>,
    /// Rows of data.
    pub rows: u64,
    /// Rows with another number of fields than the header.
    pub ragged: u64,
    /// Is the last of them cut off? It has no line end.
    pub is_cut_off: bool,
    /// Its times, where a column of time was found.
    pub time: Option<SheetTime>,
}

impl Sheet {
    /// Reads a whole table; `progress` receives the number of bytes read.
    ///
    /// # Errors
    /// What does not let it be read as text in lines.
    pub fn read(path: &Path, progress: impl FnMut(u64)) -> Result<Self> {
        Self::from_source(&Source::file(path.to_owned()), progress)
    }

    pub(crate) fn from_source(source: &Source, mut progress: impl FnMut(u64)) -> Result<Self> {
        let layout = Layout::read(source)?;
        let count = Arc::default();
        let mut lines = Lines::from_source(source, &count)?;
        let mut sheet = Self::new(&layout);
        for _ in 0..layout.header_lines {
            lines.advance()?;
        }
        let listed = layout.names.len().min(MAX_COLUMNS);
        let pair = seconds_and_nanoseconds(&layout.names[..listed]);
        let candidates = if layout.header_lines == 0 {
            vec![0]
        } else {
            time_candidates(&layout.names, pair)
        };
        let mut clocks: Vec<Clock> = candidates.iter().map(|_| Clock::default()).collect();
        let mut lasts = vec![f64::NEG_INFINITY; sheet.columns.len()];
        let mut fields = Vec::new();
        let mut days = Days::default();
        while lines.advance()? {
            progress(count.load(std::sync::atomic::Ordering::Relaxed));
            let text = match lines.text() {
                Err(_) if !lines.is_ended() => CUT,
                text => text?,
            };
            if text.is_empty() {
                continue;
            }
            if split(text, layout.separator, &mut fields).is_err()
                || fields.len() != layout.names.len()
            {
                sheet.ragged += 1;
                sheet.is_cut_off = !lines.is_ended();
                continue;
            }
            let field = |place: usize| fields.get(place).map_or("", |field| field.text(text));
            days.take(sheet.rows == 0, fields.len(), field);
            sheet.rows += 1;
            for (index, column) in sheet.columns.iter_mut().enumerate() {
                let field = fields[index].text(text).trim();
                let number = finite(field, layout.decimal).ok();
                column.take(field, number, &mut lasts[index]);
                let clock = candidates.iter().position(|candidate| *candidate == index);
                let Some(clock) = clock.map(|clock| &mut clocks[clock]) else {
                    continue;
                };
                let beyond = pair.filter(|(seconds, _)| *seconds == index);
                let beyond = beyond.map_or(Some(0.0), |(_, place)| {
                    finite(fields[place].text(text), layout.decimal).ok()
                });
                match number {
                    Some(number) => clock.take(number + 1e-9 * beyond.unwrap_or(f64::NAN)),
                    None => {
                        if let Ok(ns) = time_ns(field, layout.decimal, TimeUnit::Date) {
                            clock.take(ns as f64 * 1e-9);
                            clock.dates += 1;
                        }
                    }
                }
            }
        }
        let best = candidates
            .iter()
            .zip(clocks)
            .filter(|(column, clock)| {
                let column = &sheet.columns[**column];
                // A clock counts on, nearly always.
                clock.seen > 1
                    && 50 * clock.jumps <= clock.seen
                    && column.others == clock.dates
                    && (clock.dates == 0 || column.numbers == 0)
            })
            .map(|(column, clock)| (*column, clock))
            .next();
        sheet.time = best.map(|(column, clock)| {
            let unit = if clock.dates > 0 {
                "date"
            } else {
                time_unit(&sheet.columns[column], clock.median())
            };
            clock.finish(column, unit)
        });
        if let (Some(time), Some((seconds, nanoseconds))) = (&mut sheet.time, pair)
            && time.column == seconds
        {
            (time.unit, time.nanoseconds) = ("s", Some(nanoseconds));
        }
        sheet.time = sheet.time.or_else(|| days.finish(sheet.rows));
        sheet.guess(&layout.units);
        Ok(sheet)
    }

    /// A table without rows so far.
    fn new(layout: &Layout) -> Self {
        Self {
            separator: layout.separator,
            decimal: layout.decimal,
            header_lines: layout.header_lines,
            names_line: layout.names_line,
            columns: layout
                .names
                .iter()
                .take(MAX_COLUMNS)
                .map(|name| SheetColumn::new(name))
                .collect(),
            rows: 0,
            ragged: 0,
            is_cut_off: false,
            time: None,
        }
    }

    /// What its columns mean, by a header line of units, their names and their numbers.
    fn guess(&mut self, units: &[String]) {
        let time = self.time.as_ref().map(|time| time.column);
        guess_columns(&mut self.columns, time, units);
        pose::choose_places(&mut self.columns);
        if self.header_lines == 0 {
            pose::guess_trajectory(&mut self.columns);
        }
        pose::guess_pose(&mut self.columns);
        pose::guess_orientation(&mut self.columns);
        drop_doubles(&mut self.columns);
    }

    /// The wheels that its columns name, in their order.
    #[must_use]
    pub fn wheels(&self) -> Vec<String> {
        let mut wheels: Vec<String> = Vec::new();
        for guess in self
            .columns
            .iter()
            .filter_map(|column| column.guess.as_ref())
        {
            if let Some(wheel) = &guess.wheel
                && !wheels.contains(wheel)
            {
                wheels.push(wheel.clone());
            }
        }
        wheels
    }

    /// Does a column probably have that meaning?
    #[must_use]
    pub fn has(&self, meaning: Meaning) -> bool {
        let mut guesses = self
            .columns
            .iter()
            .filter_map(|column| column.guess.as_ref());
        guesses.any(|guess| guess.meaning == meaning)
    }
}

/// A date and a time of day in two columns.
#[derive(Default)]
struct Days(Option<([usize; 2], Clock)>);

impl Days {
    /// Takes a row; the first one shows which columns they are.
    fn take<'a>(&mut self, is_first: bool, width: usize, field: impl Fn(usize) -> &'a str) {
        let of = |[day, time]: [usize; 2]| time_of_two(field(day), field(time)).ok();
        if is_first {
            let mut pairs = (0..width).flat_map(|day| [[day, day + 1], [day + 1, day]]);
            let found = pairs.find(|pair| of(*pair).is_some());
            self.0 = found.map(|pair| (pair, Clock::default()));
        }
        if let Some((pair, clock)) = &mut self.0
            && let Some(ns) = of(*pair)
        {
            clock.take(ns as f64 * 1e-9);
        }
    }

    /// The time, where every row has one.
    fn finish(self, rows: u64) -> Option<SheetTime> {
        let ([day, time], clock) = self.0.filter(|(_, clock)| clock.seen == rows)?;
        let nanoseconds = Some(time);
        Some(SheetTime {
            nanoseconds,
            ..clock.finish(day, "date")
        })
    }
}

/// May a column that is not the time of a table be another one?
pub(crate) fn is_second_clock(column: &SheetColumn) -> bool {
    time_rank(&column.name).is_some() && column.is_numeric() && column.falls == 0
}

/// The columns that may be times, the best first: before others that of seconds beside nanoseconds.
fn time_candidates(names: &[String], pair: Option<(usize, usize)>) -> Vec<usize> {
    let mut ranked: Vec<(u8, usize)> = names
        .iter()
        .enumerate()
        .take(MAX_COLUMNS)
        .filter_map(|(index, name)| Some((time_rank(name)?, index)))
        .collect();
    ranked.sort_unstable();
    let seconds = pair.map(|(seconds, _)| seconds);
    let others = ranked.into_iter().map(|(_, index)| index);
    let others = others.filter(|index| Some(*index) != seconds);
    seconds.into_iter().chain(others).collect()
}

/// What each column but that of time means by its name and unit.
fn guess_columns(columns: &mut [SheetColumn], time: Option<usize>, units: &[String]) {
    for (index, column) in columns.iter_mut().enumerate() {
        if Some(index) == time || !column.is_numeric() {
            continue;
        }
        let unit = units.get(index).map(String::as_str);
        column.guess = guess(&column.name, unit, column.whole);
        let is_stated = unit.is_some_and(|unit| !unit.is_empty());
        if !is_stated && open_question(column).is_some() || perhaps(column).is_some() {
            column.guess = None;
        }
        column.guess = (column.guess.take()).and_then(|guess| of_fix_numbers(column, guess));
        if !is_stated {
            column.guess = column.guess.take().map(|guess| of_turning(column, guess));
        }
        // a speed that is negative at times has a sign
        if let Some(guess) = &mut column.guess
            && guess.meaning == Meaning::SpeedSize
            && column.min < 0.0
        {
            guess.meaning = Meaning::SpeedForward;
        }
    }
}

/// A meaning that two columns claim goes to the first; one that needs another is nothing without it.
fn drop_doubles(columns: &mut [SheetColumn]) {
    let mut taken: Vec<Guess> = Vec::new();
    // that one of which its name states the unit, the first of several
    let states_unit = |column: &SheetColumn| split_unit(&column.name).1.is_some();
    let (stated, others): (Vec<_>, Vec<_>) = columns.iter_mut().partition(|c| states_unit(c));
    for column in stated.into_iter().chain(others) {
        let Some(guess) = &column.guess else { continue };
        let double = |other: &Guess| other.meaning == guess.meaning && other.wheel == guess.wheel;
        if taken.iter().any(double) {
            column.guess = None;
        } else {
            taken.push(guess.clone());
        }
    }
    loop {
        let held: Vec<Meaning> = columns
            .iter()
            .filter_map(|c| Some(c.guess.as_ref()?.meaning))
            .collect();
        let lone = columns.iter_mut().find(|column| {
            let guess = column.guess.as_ref();
            let mut needs = guess.into_iter().flat_map(|guess| guess.meaning.needs());
            needs.any(|needed| !held.contains(needed))
        });
        match lone {
            Some(column) => column.guess = None,
            None => return,
        }
    }
}

impl SheetColumn {
    /// The width of a counter that wraps in this table, bits; `None` where none does.
    #[must_use]
    pub fn wraps_at_bits(&self) -> Option<u32> {
        let wraps = |bits: &u32| {
            let range = Real::powi(2_f64, i32::try_from(*bits).unwrap_or(0));
            let fits = self.min >= -0.5 * range && self.max < range;
            self.whole && fits && self.max_step > 0.5 * range
        };
        [8, 16, 32].into_iter().find(wraps)
    }

    /// Is all that it holds numbers?
    const fn is_numeric(&self) -> bool {
        self.others == 0 && self.numbers > 0
    }

    /// Is it numeric, and without a meaning so far?
    const fn is_free(&self) -> bool {
        self.is_numeric() && self.guess.is_none()
    }

    /// The maximum of its numbers in size.
    fn size(&self) -> f64 {
        self.max.max(-self.min)
    }

    fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            first: String::new(),
            numbers: 0,
            empty: 0,
            others: 0,
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            whole: true,
            falls: 0,
            max_step: 0.0,
            guess: None,
            missing: None,
            beyond_a_turn: 0,
        }
    }

    fn take(&mut self, field: &str, number: Option<f64>, last: &mut f64) {
        if field.is_empty() || field.eq_ignore_ascii_case("nan") {
            self.empty += 1;
            if self.missing.is_none() && !field.is_empty() {
                self.missing = Some(field.to_owned());
            }
            return;
        }
        if self.first.is_empty() {
            self.first = field.chars().take(64).collect();
        }
        let Some(number) = number else {
            self.others += 1;
            return;
        };
        self.numbers += 1;
        self.min = self.min.min(number);
        self.max = self.max.max(number);
        self.whole &= number.fract() == 0.0;
        self.beyond_a_turn += u64::from(number.abs() > TAU);
        self.falls += u64::from(number < *last);
        if last.is_finite() {
            self.max_step = self.max_step.max((number - *last).abs());
        }
        *last = number;
    }
}

/// The intervals of a column that may be time.
#[derive(Default)]
struct Clock {
    last: Option<f64>,
    first: f64,
    latest: f64,
    longest: f64,
    jumps: u64,
    /// Every `stride`th interval.
    intervals: Vec<f64>,
    stride: u64,
    seen: u64,
    /// How many were dates.
    dates: u64,
}

impl Clock {
    fn take(&mut self, time: f64) {
        if self.seen == 0 {
            (self.first, self.latest, self.stride) = (time, time, 1);
        }
        self.latest = self.latest.max(time);
        if let Some(last) = self.last.replace(time) {
            let interval = time - last;
            self.longest = self.longest.max(interval);
            self.jumps += u64::from(interval < 0.0);
            if self.seen.is_multiple_of(self.stride) && interval >= 0.0 {
                self.intervals.push(interval);
            }
            if self.intervals.len() >= MAX_INTERVALS {
                self.stride *= 2;
                let mut keep = false;
                self.intervals.retain(|_| {
                    keep = !keep;
                    keep
                });
            }
        }
        self.seen += 1;
    }

    fn median(&self) -> Option<f64> {
        let mut sorted = self.intervals.clone();
        median(&mut sorted).filter(|median| *median > 0.0)
    }

    fn finish(self, column: usize, unit: &'static str) -> SheetTime {
        let seconds = grouser_files::unit::Quantity::Time
            .units()
            .into_iter()
            .find(|(name, _)| *name == unit)
            .map_or(1.0, |(_, seconds)| seconds);
        let median = self.median();
        let long = |interval: &&f64| median.is_some_and(|median| **interval > GAP_MEDIANS * median);
        SheetTime {
            column,
            nanoseconds: None,
            unit,
            duration_s: (self.latest - self.first) * seconds,
            rate_hz: median.map(|median| 1.0 / (median * seconds)),
            longest_s: self.longest * seconds,
            gaps: self.intervals.iter().filter(long).count() as u64 * self.stride.max(1),
            jumps: self.jumps,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_intervals_a_share_counts_for_all() {
        let mut clock = Clock::default();
        let (mut time, mut rows) = (0.0, 0_u64);
        // every seventh interval is a gap, beside the strides of 2 and 4
        while rows < 200_000 {
            clock.take(time);
            rows += 1;
            time += if rows.is_multiple_of(7) { 6.0 } else { 1.0 };
        }
        assert_eq!(clock.stride, 4);
        assert!(clock.intervals.len() < MAX_INTERVALS);
        let found = clock.finish(3, "s");
        assert_eq!(
            (found.column, found.rate_hz, found.longest_s),
            (3, Some(1.0), 6.0)
        );
        assert!(found.gaps.abs_diff(rows / 7) < 20, "{}", found.gaps);
    }

    #[test]
    fn intervals_that_are_kept_are_fewer_than_the_limit() {
        let mut clock = Clock::default();
        for row in 0..MAX_INTERVALS {
            clock.take(row as f64);
        }
        assert_eq!(
            (clock.stride, clock.intervals.len()),
            (1, MAX_INTERVALS - 1)
        );
        clock.take(MAX_INTERVALS as f64);
        assert_eq!(
            (clock.stride, clock.intervals.len()),
            (2, MAX_INTERVALS / 2)
        );
        // the next is passed over, that after it is kept
        clock.take(1e6);
        assert_eq!(clock.intervals.len(), MAX_INTERVALS / 2);
        clock.take(2e6);
        assert_eq!(clock.intervals.len(), MAX_INTERVALS / 2 + 1);
    }
}
