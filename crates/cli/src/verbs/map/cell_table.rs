//! A map as a Parquet table: one row a cell, one column a band; null is no data.

use std::io;
use std::sync::Arc;

use grouser_terrain::{Band, MapLayout, Quantity};
use parquet::basic::{Compression, Repetition, Type as PhysicalType};
use parquet::data_type::{DoubleType, FloatType, Int32Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

use super::grid_map;
use super::outputs::CellFile;
use crate::error::{Error, Result};
use crate::output::OutputFile;

/// The table in the making; each strip becomes a row group.
pub(super) struct CellTable<'a> {
    writer: SerializedFileWriter<OutputFile>,
    layout: &'a MapLayout,
    path: std::path::PathBuf,
}

type Group<'a> = SerializedRowGroupWriter<'a, OutputFile>;

/// The next column of a row group.
macro_rules! column {
    ($group:expr, $kind:ty, $values:expr, $levels:expr) => {
        if let Some(mut column) = $group.next_column()? {
            column
                .typed::<$kind>()
                .write_batch($values, $levels, None)?;
            column.close()?;
        }
    };
}

impl<'a> CellTable<'a> {
    pub(super) fn new(file: OutputFile, layout: &'a MapLayout) -> Result<Self> {
        let path = file.path().to_owned();
        let writer = Self::begin(file, layout).map_err(|error| refused(&path, error))?;
        Ok(Self {
            writer,
            layout,
            path,
        })
    }

    fn begin(
        file: OutputFile,
        layout: &MapLayout,
    ) -> parquet::errors::Result<SerializedFileWriter<OutputFile>> {
        let column = |name: &str, kind, repetition| {
            Type::primitive_type_builder(name, kind)
                .with_repetition(repetition)
                .build()
                .map(Arc::new)
        };
        let mut columns = vec![
            column("row", PhysicalType::INT32, Repetition::REQUIRED)?,
            column("column", PhysicalType::INT32, Repetition::REQUIRED)?,
            column("x_m", PhysicalType::DOUBLE, Repetition::REQUIRED)?,
            column("y_m", PhysicalType::DOUBLE, Repetition::REQUIRED)?,
        ];
        for quantity in Quantity::ALL {
            for heading in 0..layout.headings.count() {
                let name = grid_map::name(Band { quantity, heading }, layout);
                columns.push(column(&name, PhysicalType::FLOAT, Repetition::OPTIONAL)?);
            }
        }
        let schema = Type::group_type_builder("cells")
            .with_fields(columns)
            .build()?;
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .build();
        SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties))
    }

    fn group(&mut self, strip: u32, cells: &[f32]) -> parquet::errors::Result<()> {
        let layout = self.layout;
        let places: Vec<(u32, u32)> = layout
            .rows_of(strip)
            .flat_map(|row| (0..layout.columns).map(move |column| (row, column)))
            .collect();
        let whole = |value: u32| i32::try_from(value).unwrap_or(i32::MAX);
        let rows: Vec<i32> = places.iter().map(|(row, _)| whole(*row)).collect();
        let columns: Vec<i32> = places.iter().map(|(_, column)| whole(*column)).collect();
        let at = |(row, column): &(u32, u32)| layout.place_of(*column, *row);
        let (x, y): (Vec<f64>, Vec<f64>) = places.iter().map(at).map(|[x, y]| (x, y)).unzip();
        let mut group: Group<'_> = self.writer.next_row_group()?;
        column!(group, Int32Type, &rows, None);
        column!(group, Int32Type, &columns, None);
        column!(group, DoubleType, &x, None);
        column!(group, DoubleType, &y, None);
        let bands = layout.bands();
        for band in 0..bands {
            let values = cells.iter().skip(band).step_by(bands);
            let levels: Vec<i16> = values.clone().map(|x| i16::from(!x.is_nan())).collect();
            let known: Vec<f32> = values.copied().filter(|value| !value.is_nan()).collect();
            column!(group, FloatType, &known, Some(&levels));
        }
        group.close()?;
        Ok(())
    }
}

fn refused(path: &std::path::Path, error: parquet::errors::ParquetError) -> Error {
    Error::file("write", path, &io::Error::other(error))
}

impl CellFile for CellTable<'_> {
    fn see(&mut self, strip: u32, cells: &[f32]) -> Result<()> {
        let written = self.group(strip, cells);
        written.map_err(|error| refused(&self.path, error))
    }

    fn finish(self: Box<Self>) -> Result<String> {
        let file = self.writer.into_inner();
        file.map_err(|error| refused(&self.path, error))?.finish()?;
        Ok(format!("wrote {}\n", crate::error::shown(&self.path)))
    }
}
