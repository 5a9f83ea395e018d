//! A map as one message `grid_map_msgs/GridMap` of ROS 2 in an MCAP file.
//!
//! Sources: `grid_map_msgs/msg` and `GridMapMsgHelpers.hpp` of grid_map (ANYbotics/grid_map, branch ros2):
//! matrices of Eigen, column by column, whose rows run against x and whose columns run against y.

use std::io;

use grouser_log::message::{Value, build};
use grouser_log::write::McapWriter;
use grouser_terrain::raster::Dem;
use grouser_terrain::{Band, MapLayout, Quantity};

use super::outputs::CellFile;
use crate::error::{Error, Result};
use crate::output::OutputFile;

const TOPIC: &str = "/grouser/map";
const TYPE: &str = "grid_map_msgs/GridMap";
/// The frame of the message, as the map servers of ROS name it.
const FRAME: &str = "map";
/// The layer of heights: the one that RViz draws, without which a cell counts as invalid.
const HEIGHT_LAYER: &str = "elevation";
/// Numbers of a message: four copies of 256 MiB are in memory while it is written.
const MAX_NUMBERS: u64 = 1 << 26;

/// The message in the making.
pub(super) struct GridMap<'a> {
    file: OutputFile,
    layout: &'a MapLayout,
    dem: &'a mut Dem,
    /// Each band, then the heights.
    layers: Vec<Vec<f32>>,
}

/// Refuses a map that is too large for one message.
pub(super) fn check(layout: &MapLayout) -> Result<()> {
    let numbers = u64::from(layout.columns) * u64::from(layout.rows) * (layout.bands() as u64 + 1);
    if numbers <= MAX_NUMBERS {
        return Ok(());
    }
    Err(Error::usage(
        format!("one message has room for {MAX_NUMBERS} numbers, and this map has {numbers}"),
        "make the message of fewer headings (`--headings 4`) or of a part of the elevation model",
    ))
}

/// The name of a band where names hold letters, digits and `_` only: `slip_45_deg`.
pub(super) fn name(band: Band, layout: &MapLayout) -> String {
    let angle = layout.headings.angle(band.heading).to_degrees();
    format!("{}_heading_{angle:.0}", band.quantity.key())
}

impl<'a> GridMap<'a> {
    pub(super) fn new(file: OutputFile, layout: &'a MapLayout, dem: &'a mut Dem) -> Self {
        let cells = layout.columns as usize * layout.rows as usize;
        Self {
            file,
            dem,
            layers: vec![vec![f32::NAN; cells]; layout.bands() + 1],
            layout,
        }
    }

    /// The place in a matrix: its rows are the map's columns from the right, its columns the map's rows from
    /// the top.
    fn place(&self, row: usize, column: usize) -> usize {
        let columns = self.layout.columns as usize;
        row * columns + (columns - 1 - column)
    }

    fn message(layout: &MapLayout, layers: Vec<Vec<f32>>) -> Value {
        let mut names = vec![String::new(); layout.bands()];
        for quantity in Quantity::ALL {
            for heading in 0..layout.headings.count() {
                let band = Band { quantity, heading };
                names[band.index(layout.headings)] = name(band, layout);
            }
        }
        names.push(HEIGHT_LAYER.to_owned());
        let [rows, columns] = [layout.columns, layout.rows];
        let dimension = |label: &str, size: u32, stride: u32| {
            build::message([
                ("label", Value::Text(label.to_owned())),
                ("size", Value::UInt(size.into())),
                ("stride", Value::UInt(stride.into())),
            ])
        };
        let array = |numbers: Vec<f32>| {
            let dimensions = vec![
                dimension("column_index", columns, rows * columns),
                dimension("row_index", rows, rows),
            ];
            let shape = build::message([
                ("dim", Value::Array(dimensions)),
                ("data_offset", Value::UInt(0)),
            ]);
            build::message([("layout", shape), ("data", Value::Floats(numbers))])
        };
        let [first, last] = [(0, 0), (layout.columns - 1, layout.rows - 1)]
            .map(|(column, row)| layout.place_of(column, row));
        let length = |cells: u32| Value::Float(f64::from(cells) * layout.cell);
        let info = build::message([
            ("resolution", Value::Float(layout.cell)),
            ("length_x", length(layout.columns)),
            ("length_y", length(layout.rows)),
            (
                "pose",
                build::pose(
                    f64::midpoint(first[0], last[0]),
                    f64::midpoint(first[1], last[1]),
                    0.0,
                ),
            ),
        ]);
        build::message([
            ("header", build::header(0, FRAME)),
            ("info", info),
            ("layers", build::texts(&names)),
            ("basic_layers", build::texts(&[HEIGHT_LAYER])),
            (
                "data",
                Value::Array(layers.into_iter().map(array).collect()),
            ),
            ("outer_start_index", Value::UInt(0)),
            ("inner_start_index", Value::UInt(0)),
        ])
    }
}

impl CellFile for GridMap<'_> {
    fn see(&mut self, strip: u32, cells: &[f32]) -> Result<()> {
        let rows = self.layout.rows_of(strip);
        let (columns, bands) = (self.layout.columns as usize, self.layout.bands());
        let mut heights = Vec::with_capacity(rows.len() * columns);
        let window = self.dem.window(rows.clone())?;
        for row in rows.clone() {
            let height = |column| window.height(row.into(), column).unwrap_or(f32::NAN);
            heights.extend((0..i64::from(self.layout.columns)).map(height));
        }
        let first = rows.start as usize;
        for (index, (cell, height)) in cells.chunks_exact(bands).zip(heights).enumerate() {
            let place = self.place(first + index / columns, index % columns);
            for (layer, value) in self.layers.iter_mut().zip(cell.iter().chain([&height])) {
                layer[place] = *value;
            }
        }
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<String> {
        let path = self.file.path().to_owned();
        let message = Self::message(self.layout, self.layers);
        let write = |file: OutputFile| -> io::Result<OutputFile> {
            let mut writer = McapWriter::new(file, "ros2")?;
            let mut topic = writer.topic(TOPIC, TYPE)?;
            writer.send(&mut topic, 0, &message)?;
            writer.finish()
        };
        let file = write(self.file).map_err(|error| Error::file("write", &path, &error))?;
        file.finish()?;
        Ok(format!("wrote {}\n", crate::error::shown(&path)))
    }
}
