//! Elevation models.

use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::{Path, PathBuf};

use grouser_files::regular;
use grouser_rover::ground::{
    Georeference, HeightFile, HeightTiff, TerrainFault, UndeclaredNoData, check_side_files,
    read_raster,
};

use crate::error::{Error, Result};

/// Greatest number of columns: rows are held whole.
const MAX_COLUMNS: u32 = 1 << 16;
/// Greatest number of rows.
const MAX_ROWS: u32 = 1 << 24;
/// Limits of a cell's size, m.
const CELL_LIMITS_M: (f64, f64) = (1e-3, 1e3);
/// Heights beyond these are no heights, m.
const HEIGHT_LIMITS_M: (f32, f32) = (-1e6, 1e6);

/// What is doubtful about an elevation model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum DemCaution {
    /// It names no coordinate system: its numbers are taken for metres.
    NoSystem,
    /// Numbers that mark no data are not declared as such: they count as unknown.
    UndeclaredNoData(UndeclaredNoData),
}

impl DemCaution {
    /// In words.
    #[must_use]
    pub fn text(self) -> String {
        match self {
            Self::NoSystem => {
                "the elevation model names no coordinate system: its coordinates are treated as metres"
                    .to_owned()
            }
            Self::UndeclaredNoData(undeclared) => undeclared.to_string(),
        }
    }
}

/// An elevation model, read a few rows at a time.
pub struct Dem {
    path: PathBuf,
    source: Source,
    columns: u32,
    rows: u32,
    cell: f64,
    georeference: Georeference,
    has_system: bool,
    undeclared: Option<UndeclaredNoData>,
    /// The first row that is held, and the rows from there on.
    held: (u32, Vec<f32>),
}

enum Source {
    Tiff(Box<HeightTiff<BufReader<File>>>),
    /// All of it: `held` has every row.
    Memory,
}

/// Some rows of an elevation model; unknown heights are `None`.
///
/// Rows count from the upper edge.
#[derive(Clone, Copy, Debug)]
pub struct Window<'a> {
    first: u32,
    columns: u32,
    heights: &'a [f32],
}

impl<'a> Window<'a> {
    /// All rows of an elevation model that is in memory, row by row from the upper edge; NaN is unknown.
    ///
    /// ```
    /// use grouser_terrain::raster::Window;
    ///
    /// let window = Window::new(2, &[1.0, 2.0, 3.0, f32::NAN]);
    /// assert_eq!((window.height(1, 0), window.height(1, 1)), (Some(3.0), None));
    /// ```
    #[must_use]
    pub const fn new(columns: u32, heights: &'a [f32]) -> Self {
        Self {
            first: 0,
            columns,
            heights,
        }
    }

    /// The height of a cell, m; `None` where it is unknown or not held.
    #[must_use]
    pub fn height(&self, row: i64, column: i64) -> Option<f32> {
        if !(0..i64::from(self.columns)).contains(&column) {
            return None;
        }
        let row = usize::try_from(row - i64::from(self.first)).ok()?;
        let column = usize::try_from(column).ok()?;
        let height = *self.heights.get(row * self.columns as usize + column)?;
        let (low, high) = HEIGHT_LIMITS_M;
        (low <= height && height <= high).then_some(height)
    }

    /// Cells of a row.
    #[must_use]
    pub const fn columns(&self) -> u32 {
        self.columns
    }
}

impl Dem {
    /// Opens a GeoTIFF (read piece by piece), an ESRI ASCII grid or a PNG (read whole, with their limits). `cell` (m)
    /// is needed where the file does not give the size of its cells in metres; `height_step` (m) is that of a grey level.
    ///
    /// # Errors
    /// [`Error::Terrain`] for what the file lacks, lies about, or has too much of; degrees are refused.
    pub fn open(path: &Path, cell: Option<f64>, height_step: f64) -> Result<Self> {
        let ending = path
            .extension()
            .map_or_else(String::new, |e| e.to_string_lossy().to_ascii_lowercase());
        let of_file = |fault| Error::Terrain {
            file: path.to_owned(),
            fault,
        };
        let dem = if matches!(ending.as_str(), "tif" | "tiff") {
            let file = regular::open(path)?;
            let tiff = HeightTiff::open(BufReader::new(file), cell).map_err(of_file)?;
            let is_placed = tiff.georeference().centre(0, 0).is_some();
            check_side_files(path, is_placed).map_err(of_file)?;
            let (columns, rows) = tiff.size();
            Self {
                path: path.to_owned(),
                columns,
                rows,
                cell: tiff.cell(),
                georeference: tiff.georeference().clone(),
                has_system: true,
                undeclared: None,
                source: Source::Tiff(Box::new(tiff)),
                held: (0, Vec::new()),
            }
        } else {
            let file = HeightFile {
                path: path.to_owned(),
                cell,
                height_step,
            };
            let raster = read_raster(&file)?;
            let columns = u32::try_from(raster.columns).unwrap_or(u32::MAX);
            let rows = raster.heights.len() / raster.columns.max(1);
            let georeference =
                Georeference::of_grid(raster.cell, raster.upper_left.unwrap_or([0.0, 0.0]));
            Self {
                path: path.to_owned(),
                source: Source::Memory,
                columns,
                rows: u32::try_from(rows).unwrap_or(u32::MAX),
                cell: raster.cell,
                georeference,
                has_system: raster.has_system,
                undeclared: raster.undeclared,
                held: (0, raster.heights),
            }
        };
        let size = |value: u32, limit: u32| (2..=limit).contains(&value);
        if !size(dem.columns, MAX_COLUMNS) || !size(dem.rows, MAX_ROWS) {
            return Err(of_file(TerrainFault::Cells {
                columns: u64::from(dem.columns),
                rows: u64::from(dem.rows),
                limit: u64::from(MAX_COLUMNS) * u64::from(MAX_ROWS),
            }));
        }
        Error::check("elevation model", "cell", dem.cell, CELL_LIMITS_M, "m")?;
        Ok(dem)
    }

    /// Columns and rows.
    #[must_use]
    pub const fn size(&self) -> (u32, u32) {
        (self.columns, self.rows)
    }

    /// The size of a cell, m.
    #[must_use]
    pub const fn cell(&self) -> f64 {
        self.cell
    }

    /// Where it lies.
    #[must_use]
    pub const fn georeference(&self) -> &Georeference {
        &self.georeference
    }

    /// What is doubtful about it, as far as its rows were read.
    #[must_use]
    pub fn cautions(&self) -> Vec<DemCaution> {
        let undeclared = match &self.source {
            Source::Tiff(tiff) => tiff.undeclared(),
            Source::Memory => self.undeclared,
        };
        let system = (!self.has_system).then_some(DemCaution::NoSystem);
        let undeclared = undeclared.map(DemCaution::UndeclaredNoData);
        system.into_iter().chain(undeclared).collect()
    }

    /// Rows of the model, as far as it has them. Rows are given in order: those above `rows` are forgotten.
    ///
    /// # Errors
    /// [`Error::Terrain`] for a piece that cannot be decoded.
    pub fn window(&mut self, rows: Range<u32>) -> Result<Window<'_>> {
        let rows = rows.start..rows.end.min(self.rows);
        if let Source::Tiff(tiff) = &mut self.source {
            let (first, heights) = &mut self.held;
            let columns = self.columns as usize;
            if rows.start < *first {
                (*first, *heights) = (
                    rows.start / tiff.piece_height() * tiff.piece_height(),
                    Vec::new(),
                );
            }
            let mut end = *first + u32::try_from(heights.len() / columns).unwrap_or(0);
            if rows.start >= end {
                heights.clear();
                *first = rows.start / tiff.piece_height() * tiff.piece_height();
                end = *first;
            } else {
                heights.drain(..(rows.start - *first) as usize * columns);
                *first = rows.start;
            }
            while end < rows.end {
                end = tiff
                    .read_rows(end, heights)
                    .map_err(|fault| Error::Terrain {
                        file: self.path.clone(),
                        fault,
                    })?;
            }
        }
        Ok(Window {
            first: self.held.0,
            columns: self.columns,
            heights: &self.held.1,
        })
    }
}
