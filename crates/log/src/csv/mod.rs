//! Tables of text: CSV and its relatives, read line by line through a column map.

mod fields;
mod lines;
mod number;
mod reader;
mod row;

pub(crate) use fields::split;
pub use lines::LINE_LIMIT;
pub(crate) use lines::Lines;
pub(crate) use number::finite;
pub(crate) use reader::CsvReader;
