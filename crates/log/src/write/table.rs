//! One topic of a bag or an MCAP file as a table.

use std::io::{self, Write};
use std::path::Path;

use crate::csv::quoted;
use crate::error::{Error, Result};
use crate::message::Value;
use crate::messages::{Clock, LeftOut, Messages};

/// A message with more numbers and texts than this is no row of a table.
const COLUMN_LIMIT: usize = 4096;

/// What was written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// Rows.
    pub rows: u64,
    /// Columns.
    pub columns: usize,
    /// Values that have no column, because the first message did not have them.
    pub without_column: u64,
    /// What was left out of the file that was read.
    pub left_out: LeftOut,
}

/// Writes the messages of `topic` as CSV: `time_ns` (the stamp of the header, else the time of recording),
/// then every number and text by its path, such as `twist.linear.x` or `position[0]`, in the order of
/// time. The first message says which columns there are; of arrays of bytes the length is written; what is
/// no finite number is empty.
///
/// # Errors
/// [`Error::NoTopic`] where there are no messages; [`Error::Output`] for what cannot be written.
pub fn write_table(
    path: &Path,
    topic: &str,
    out: &mut impl Write,
    mut progress: impl FnMut(u64),
) -> Result<Table> {
    let named = topic.to_owned();
    let mut messages = Messages::open(path, Clock::Header, move |c| c.topic == named)?;
    let mut table = Table::default();
    let mut columns: Vec<String> = Vec::new();
    let mut cells = Vec::new();
    while let Some(message) = messages.next() {
        progress(messages.offset());
        cells.clear();
        flatten(&message.value, String::new(), &mut cells);
        if columns.is_empty() {
            columns = cells.iter().map(|(path, _)| path.clone()).collect();
            let names = columns.iter().map(|name| format!(",{}", quoted(name)));
            writeln!(out, "time_ns{}", names.collect::<String>()).map_err(Error::Output)?;
            table.columns = columns.len() + 1;
        }
        table.without_column +=
            row(message.time_ns, &columns, &cells, out).map_err(Error::Output)?;
        table.rows += 1;
    }
    table.left_out = messages.left_out().clone();
    if table.rows == 0 {
        return Err(crate::series::no_topic(path, topic)?);
    }
    Ok(table)
}

/// Writes one row; gives the number of values that have no column.
fn row(
    time_ns: i64,
    columns: &[String],
    cells: &[(String, String)],
    out: &mut impl Write,
) -> io::Result<u64> {
    write!(out, "{time_ns}")?;
    let mut used = 0;
    for (place, column) in columns.iter().enumerate() {
        // Nearly always the message has the fields of the first, in its order.
        let same = cells.get(place).filter(|(path, _)| path == column);
        let cell = same.or_else(|| cells.iter().find(|(path, _)| path == column));
        used += u64::from(cell.is_some());
        write!(out, ",{}", cell.map_or("", |(_, text)| text))?;
    }
    writeln!(out)?;
    Ok((cells.len() as u64).saturating_sub(used))
}

/// Every number and text of a value, by its path.
fn flatten(value: &Value, path: String, cells: &mut Vec<(String, String)>) {
    if cells.len() >= COLUMN_LIMIT {
        return;
    }
    let text = match value {
        Value::Struct(fields) => {
            for (name, value) in fields {
                let dot = if path.is_empty() { "" } else { "." };
                flatten(value, format!("{path}{dot}{name}"), cells);
            }
            return;
        }
        Value::Array(values) => {
            for (place, value) in values.iter().enumerate() {
                flatten(value, format!("{path}[{place}]"), cells);
            }
            return;
        }
        Value::Bytes(bytes) => {
            cells.push((format!("{path}.length"), bytes.len().to_string()));
            return;
        }
        Value::Floats(numbers) => {
            cells.push((format!("{path}.length"), numbers.len().to_string()));
            return;
        }
        Value::Float(number) if number.is_finite() => number.to_string(),
        Value::Float(_) | Value::Null => String::new(),
        Value::Int(number) => number.to_string(),
        Value::UInt(number) => number.to_string(),
        Value::Bool(value) => u8::from(*value).to_string(),
        Value::Text(text) => quoted(text).into_owned(),
    };
    cells.push((path, text));
}
