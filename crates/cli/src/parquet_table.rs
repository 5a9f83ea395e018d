//! Parquet tables as the lines of a CSV table, in and out (feature `parquet`): the rest of the command knows
//! one kind of table.
//!
//! What is read is not trusted: the footer's length and the number of columns are looked at before the reader
//! is let loose on the file, and a panic in it becomes an error.

use std::fs::File;
use std::io::{self, Read, Seek as _, SeekFrom, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, ConvertedType, Repetition, Type as PhysicalType};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::reader::RowIter;
use parquet::record::{Field, Row};
use parquet::schema::types::Type;

use grouser_log::csv::{quoted, split};

/// A longer footer is none of a table of numbers.
const LONGEST_FOOTER: u64 = 16 << 20;
/// More columns are no table of operating points.
const MAX_COLUMNS: usize = 1000;
/// Rows written together.
const GROUP: usize = 1 << 16;

/// Is this the name of a Parquet file?
pub(crate) fn is_parquet(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("parquet"))
}

#[allow(
    clippy::needless_pass_by_value,
    reason = "it stands in `map_err`, which gives the value"
)]
fn invalid(error: impl ToString) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, error.to_string())
}

/// Runs the dependency's code; its panic is an error.
fn contained<T>(job: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    catch_unwind(AssertUnwindSafe(job)).unwrap_or_else(|_| {
        Err(invalid(
            "the Parquet reader gave up on this file (internal)",
        ))
    })
}

/// A Parquet file as the text of a CSV table.
pub(crate) struct ParquetText {
    rows: RowIter<'static>,
    text: Vec<u8>,
    given: usize,
    over: bool,
}

impl ParquetText {
    /// Begins a file.
    pub(crate) fn open(mut file: File) -> io::Result<Self> {
        check_footer(&mut file)?;
        contained(move || {
            let reader = SerializedFileReader::new(file).map_err(invalid)?;
            let schema = reader.metadata().file_metadata().schema();
            let columns = schema.get_fields();
            if columns.len() > MAX_COLUMNS {
                return Err(invalid(format!(
                    "{} columns, but the limit is {MAX_COLUMNS}",
                    columns.len()
                )));
            }
            let mut header = String::new();
            for (index, column) in columns.iter().enumerate() {
                let repeated = column.get_basic_info().has_repetition()
                    && column.get_basic_info().repetition() == Repetition::REPEATED;
                if !column.is_primitive() || repeated {
                    return Err(invalid(format!(
                        "column `{}` is no column of single values",
                        column.name()
                    )));
                }
                if index > 0 {
                    header.push(',');
                }
                header.push_str(&quoted(column.name()));
            }
            header.push('\n');
            Ok(Self {
                rows: RowIter::from_file_into(Box::new(reader)),
                text: header.into_bytes(),
                given: 0,
                over: false,
            })
        })
    }

    /// The next row as a line.
    fn fill(&mut self) -> io::Result<()> {
        self.text.clear();
        self.given = 0;
        let rows = &mut self.rows;
        let row = contained(|| rows.next().transpose().map_err(invalid)).inspect_err(|_| {
            self.over = true; // after a panic the reader is not used again
        })?;
        match row {
            Some(row) => line_of(&row, &mut self.text),
            None => self.over = true,
        }
        Ok(())
    }
}

/// The last eight bytes: the footer's length and the magic word.
fn check_footer(file: &mut File) -> io::Result<()> {
    let length = file.seek(SeekFrom::End(0))?;
    if length < 12 {
        return Err(invalid("it is too short for a Parquet file"));
    }
    file.seek(SeekFrom::End(-8))?;
    let mut end = [0; 8];
    file.read_exact(&mut end)?;
    file.seek(SeekFrom::Start(0))?;
    let [a, b, c, d, magic @ ..] = end;
    if &magic != b"PAR1" {
        return Err(invalid("it does not end as a Parquet file does"));
    }
    let footer = u64::from(u32::from_le_bytes([a, b, c, d]));
    let limit = LONGEST_FOOTER.min(length - 12);
    if footer > limit {
        return Err(invalid(format!(
            "its footer says to be {footer} bytes long, but the limit is {limit}"
        )));
    }
    Ok(())
}

fn line_of(row: &Row, text: &mut Vec<u8>) {
    for (index, (_, value)) in row.get_column_iter().enumerate() {
        if index > 0 {
            text.push(b',');
        }
        let value = match value {
            Field::Null => String::new(),
            // a row is a line here
            Field::Str(text) => quoted(text).into_owned(),
            Field::Double(x) => format!("{x:?}"),
            Field::Float(x) => format!("{x:?}"),
            other => quoted(&other.to_string()).into_owned(),
        };
        text.extend_from_slice(value.as_bytes());
    }
    text.push(b'\n');
}

impl Read for ParquetText {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.given == self.text.len() && !self.over {
            self.fill()?;
        }
        let rest = &self.text[self.given..];
        let count = rest.len().min(buffer.len());
        buffer[..count].copy_from_slice(&rest[..count]);
        self.given += count;
        Ok(count)
    }
}

/// Takes the lines of a CSV table and writes a Parquet file: columns whose names tell a quantity as numbers,
/// all others as text, an empty field as null.
pub(crate) struct ParquetSink<W: Write + Send> {
    target: Option<W>,
    writer: Option<SerializedFileWriter<W>>,
    numeric: Vec<bool>,
    rows: Vec<Vec<String>>,
}

/// Columns that `batch` reads or writes as numbers.
const NUMERIC: [&str; 9] = [
    "radius_m",
    "width_m",
    "rebound",
    "slip",
    "sinkage_m",
    "load_n",
    "vertical_force_n",
    "drawbar_pull_n",
    "torque_nm",
];

impl<W: Write + Send> ParquetSink<W> {
    pub(crate) const fn new(target: W) -> Self {
        Self {
            target: Some(target),
            writer: None,
            numeric: Vec::new(),
            rows: Vec::new(),
        }
    }

    /// One line of the table, the header first.
    pub(crate) fn line(&mut self, line: &str) -> io::Result<()> {
        let line = line.trim_end_matches('\n');
        let mut fields = Vec::new();
        split(line, b',', &mut fields).map_err(|_| invalid("a line that is no CSV"))?;
        let fields: Vec<String> = fields
            .iter()
            .map(|field| field.value(line).into_owned())
            .collect();
        if let Some(target) = self.target.take() {
            return self.begin(target, &fields);
        }
        self.rows.push(fields);
        if self.rows.len() >= GROUP {
            self.group()?;
        }
        Ok(())
    }

    fn begin(&mut self, target: W, names: &[String]) -> io::Result<()> {
        let mut columns = Vec::with_capacity(names.len());
        for name in names {
            let numeric = NUMERIC.contains(&name.as_str());
            self.numeric.push(numeric);
            let column = if numeric {
                Type::primitive_type_builder(name, PhysicalType::DOUBLE)
            } else {
                Type::primitive_type_builder(name, PhysicalType::BYTE_ARRAY)
                    .with_converted_type(ConvertedType::UTF8)
            };
            let column = column.with_repetition(Repetition::OPTIONAL).build();
            columns.push(Arc::new(column.map_err(invalid)?));
        }
        let schema = Type::group_type_builder("operating_points")
            .with_fields(columns)
            .build()
            .map_err(invalid)?;
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .build();
        self.writer = Some(
            SerializedFileWriter::new(target, Arc::new(schema), Arc::new(properties))
                .map_err(invalid)?,
        );
        Ok(())
    }

    fn group(&mut self) -> io::Result<()> {
        let Some(writer) = &mut self.writer else {
            return Ok(());
        };
        let mut group = writer.next_row_group().map_err(invalid)?;
        let mut index = 0;
        while let Some(mut column) = group.next_column().map_err(invalid)? {
            let cells = self
                .rows
                .iter()
                .map(|row| row.get(index).map_or("", String::as_str));
            if self.numeric.get(index) == Some(&true) {
                // the row's status has the reason of a cell that is no number
                let values: Vec<Option<f64>> = cells.map(|cell| cell.parse().ok()).collect();
                let levels: Vec<i16> = values.iter().map(|x| i16::from(x.is_some())).collect();
                let values: Vec<f64> = values.into_iter().flatten().collect();
                column
                    .typed::<DoubleType>()
                    .write_batch(&values, Some(&levels), None)
                    .map_err(invalid)?;
            } else {
                let levels: Vec<i16> = cells.clone().map(|x| i16::from(!x.is_empty())).collect();
                let values: Vec<ByteArray> = cells
                    .filter(|x| !x.is_empty())
                    .map(ByteArray::from)
                    .collect();
                column
                    .typed::<ByteArrayType>()
                    .write_batch(&values, Some(&levels), None)
                    .map_err(invalid)?;
            }
            column.close().map_err(invalid)?;
            index += 1;
        }
        group.close().map_err(invalid)?;
        self.rows.clear();
        Ok(())
    }

    /// Writes what is left and the footer; gives the target back.
    pub(crate) fn finish(mut self) -> io::Result<Option<W>> {
        if !self.rows.is_empty() {
            self.group()?;
        }
        match (self.writer, self.target) {
            (Some(writer), _) => writer.into_inner().map(Some).map_err(invalid),
            (None, target) => Ok(target),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    const TABLE: &str =
        "soil,radius_m,slip,note\nlunar,0.1,0.2,\n\"a, b\",0.125,-0.30000000000000004,x\n,,1,\n";

    fn written() -> Vec<u8> {
        let mut sink = ParquetSink::new(Vec::new());
        for line in TABLE.split_inclusive('\n') {
            sink.line(line).unwrap();
        }
        sink.finish().unwrap().unwrap()
    }

    fn read(bytes: &[u8], name: &str) -> io::Result<String> {
        let path =
            std::env::temp_dir().join(format!("grouser-{}-{name}.parquet", std::process::id()));
        File::create(&path)?.write_all(bytes)?;
        let mut text = String::new();
        let read =
            ParquetText::open(File::open(&path)?).and_then(|mut t| t.read_to_string(&mut text));
        std::fs::remove_file(&path)?;
        read.map(|_| text)
    }

    #[test]
    fn a_table_comes_back() {
        let text = read(&written(), "whole").unwrap();
        // a number is a number: 1 comes back as 1.0
        assert_eq!(text, TABLE.replace(",1,", ",1.0,"));
    }

    #[test]
    fn e9_cut_at_every_place() {
        let bytes = written();
        for cut in (0..bytes.len())
            .step_by(97)
            .chain(bytes.len() - 20..bytes.len())
        {
            assert!(read(&bytes[..cut], "cut").is_err(), "{cut}");
        }
    }

    #[test]
    fn e9_a_footer_that_lies_about_its_length() {
        let bytes = written();
        let at = bytes.len() - 8;
        let true_length = u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        for length in [
            0,
            1,
            true_length - 1,
            true_length + 1,
            u32::try_from(bytes.len()).unwrap(),
            1 << 24,
            u32::MAX >> 1,
            u32::MAX,
        ] {
            let mut lying = bytes.clone();
            lying[at..at + 4].copy_from_slice(&length.to_le_bytes());
            assert!(read(&lying, "footer").is_err(), "{length}");
        }
    }

    #[test]
    fn e9_any_byte_turned_is_an_error_or_a_table() {
        let bytes = written();
        for at in 0..bytes.len() {
            let mut turned = bytes.clone();
            turned[at] ^= 0xff;
            // it ends, without a panic that leaves the reader
            let _ = read(&turned, "turned");
        }
    }

    #[test]
    fn e9_a_panic_inside_is_an_error() {
        let found: io::Result<()> = contained(|| panic!("inside the dependency"));
        assert_eq!(found.unwrap_err().kind(), io::ErrorKind::InvalidData);
    }
}
