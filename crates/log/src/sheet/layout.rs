//! How a table is laid out, by its first lines.

use std::sync::Arc;

use grouser_files::columns::TimeUnit;

use crate::csv::{Lines, finite, names, split, time_ns};
use crate::error::{Error, Result};
use crate::source::Source;

/// The layout is read from this many lines.
const LAYOUT_LINES: usize = 64;
/// The maximum number of header lines.
const MAX_HEADER_LINES: usize = 20;
const NO_NAMES: &str = "no header line that names its columns (a column map with `header_lines = 0` calls them by their numbers)";
const TAGGED: &str = "lines that begin with a word for their kind: `grep '^WORD ' FILE > WORD.txt` makes a table of each kind";
const SEPARATORS: [u8; 5] = [b',', b';', b'\t', b'|', b' '];

/// The layout of a table.
pub(super) struct Layout {
    pub(super) separator: u8,
    pub(super) decimal: u8,
    pub(super) header_lines: usize,
    pub(super) names_line: usize,
    pub(super) names: Vec<String>,
    /// A header line of units, where there is one.
    pub(super) units: Vec<String>,
}

impl Layout {
    pub(super) fn read(source: &Source) -> Result<Self> {
        let file = source.name();
        let mut lines = Lines::from_source(source, &Arc::default())?;
        let mut first = Vec::new();
        while first.len() < LAYOUT_LINES && lines.advance()? {
            match lines.text() {
                Err(_) if first.len() > 1 && !lines.is_ended() => break,
                text => first.push(text?.to_owned()),
            }
        }
        let mut ends = (0..first.len()).rev().filter(|at| !first[*at].is_empty());
        let last = ends.next().ok_or_else(|| Error::Empty {
            file: file.clone(),
            what: "nothing",
        })?;
        // The last row may be cut off: the one before it decides, where that is a row.
        if let Some(before) = ends.next()
            && let Ok(layout) = Self::by_row(&first, &first[before], &file)
            && layout.header_lines <= before
        {
            return Ok(layout);
        }
        Self::by_row(&first, &first[last], &file)
    }

    /// The layout of the lines `first`, of which `row` is data.
    fn by_row(first: &[String], row: &str, file: &str) -> Result<Self> {
        let empty = |what| Error::Empty {
            file: file.to_owned(),
            what,
        };
        // The separator that parts it best into numbers.
        let parts = |separator: u8, decimal: u8| {
            let fields = fields(row, separator);
            fields
                .iter()
                .filter(|field| finite(field, decimal).is_ok())
                .count()
        };
        let choices = SEPARATORS.into_iter().flat_map(|separator| {
            let decimals: &[u8] = if separator == b',' { b"." } else { b".," };
            decimals.iter().map(move |decimal| (separator, *decimal))
        });
        let mut best = (0, b',', b'.');
        for (separator, decimal) in choices {
            let numbers = parts(separator, decimal);
            if numbers > best.0 {
                best = (numbers, separator, decimal);
            }
        }
        let (_, separator, decimal) = best;
        let width = fields(row, separator).len();
        // Names have few numbers among them, data many.
        let is_data = |line: &String| {
            let fields = fields(line, separator);
            let numbers = fields
                .iter()
                .filter(|field| finite(field, decimal).is_ok())
                .count();
            numbers > 0 && 3 * numbers >= fields.iter().filter(|field| !field.is_empty()).count()
        };
        let header_lines = first.iter().position(is_data).unwrap_or(first.len());
        if header_lines > MAX_HEADER_LINES {
            return Err(empty(NO_NAMES));
        }
        let is_number = |field: &String| {
            field.is_empty()
                || finite(field, decimal).is_ok()
                || time_ns(field, decimal, TimeUnit::Date).is_ok()
        };
        let is_word = |field: &String| field.starts_with(|letter: char| letter.is_alphabetic());
        let is_tagged = |line: &String| {
            let fields = fields(line, separator);
            fields.first().is_some_and(is_word)
                && fields.len() > 1
                && fields[1..].iter().all(is_number)
        };
        if header_lines == 0 && first.iter().filter(|line| !line.is_empty()).all(is_tagged) {
            return Err(empty(TAGGED));
        }
        if header_lines == 0 && fields(&first[0], separator).iter().all(is_number) {
            return Ok(Self {
                separator,
                decimal,
                header_lines,
                names_line: 0,
                names: (1..=width).map(|number| number.to_string()).collect(),
                units: Vec::new(),
            });
        }
        if header_lines == first.len() {
            return Err(empty("a header and no data"));
        }
        let header: Vec<Vec<String>> = first[..header_lines]
            .iter()
            .map(|line| fields(names(line), separator))
            .collect();
        let is_of_units = |fields: &[String]| {
            let is_unit = |field: &String| matches!(field.as_str(), "ms" | "s" | "m/s" | "rad/s");
            fields.len() == width && fields.iter().any(is_unit)
        };
        let is_of_names = |fields: &[String]| {
            let given: Vec<&String> = fields.iter().filter(|name| !name.is_empty()).collect();
            let mut unique = given.clone();
            unique.sort_unstable();
            unique.dedup();
            fields.len() == width && unique.len() == given.len() && given.len() + 1 >= width
        };
        // The last line that names every column differently, and rather none of units.
        let last = |is: &dyn Fn(&[String]) -> bool| header.iter().rposition(|line| is(line));
        let names = last(&|line| is_of_names(line) && !is_of_units(line));
        let names = names.or_else(|| last(&is_of_names));
        let names = names.ok_or_else(|| empty(NO_NAMES))?;
        let mut lines = header.iter().enumerate();
        let units = lines.find(|(at, line)| *at != names && is_of_units(line));
        Ok(Self {
            separator,
            decimal,
            header_lines,
            names_line: names + 1,
            names: header[names].clone(),
            units: units.map_or_else(Vec::new, |(_, line)| line.clone()),
        })
    }
}

fn fields(line: &str, separator: u8) -> Vec<String> {
    let mut places = Vec::new();
    if split(line, separator, &mut places).is_err() {
        return Vec::new();
    }
    places
        .iter()
        .map(|field| field.text(line).trim().to_owned())
        .collect()
}
