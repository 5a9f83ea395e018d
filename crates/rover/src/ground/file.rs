//! Height maps from files: PNG of 8 or 16 bits, ESRI ASCII grids, GeoTIFF.
//!
//! What a file does not know stays unknown: no-data values, NaN, transparent pixels and missing tiles never become a
//! height of their own.

mod ascii;
mod epsg;
mod georeference;
mod geotiff;
mod height_tiff;
mod picture;
mod projection;
mod side_files;

use grouser_terra::OutOfRange;
use std::io::{Cursor, Read as _};
use std::path::{Path, PathBuf};

use grouser_files::regular;

pub use georeference::Georeference;
pub use geotiff::{GeoTiff, PiecePlace};
pub use height_tiff::HeightTiff;

use super::height_map::{CELL_LIMITS_M, HeightMap, MAX_CELLS};
use crate::error::{Error, Result};
use crate::terrain_fault::TerrainFault;

/// Greatest size of a terrain file, bytes.
const MAX_BYTES: u64 = 1 << 28;

/// Heights beyond these are not heights, m.
const HEIGHT_LIMITS_M: (f32, f32) = (-1e6, 1e6);

/// Numbers that mark unknown heights in a file that does not declare them as its no-data value.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct UndeclaredNoData {
    /// The first of them.
    pub value: f64,
    /// Number of cells.
    pub cells: u64,
}

impl std::fmt::Display for UndeclaredNoData {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { value, cells } = self;
        write!(
            f,
            "{cells} cells of the elevation model count as unknown: their height is {value}, which it does not \
             declare as its no-data value (GDAL_NODATA, 42113)"
        )
    }
}

impl UndeclaredNoData {
    /// Is it a number that is written for no data? No ground has any of them.
    ///
    /// Source: the customs of ESRI's and GDAL's formats (-9999 and its like, the smallest float) and of 16-bit models
    /// such as SRTM and MOLA (-32768, -32767).
    fn is_one(value: f64) -> bool {
        const MIN_FILL_VALUE: f64 = 1e36;
        [-9999.0, -32_768.0, -32_767.0, -99_999.0, -999_999.0].contains(&value)
            || (value.is_finite() && value.abs() >= MIN_FILL_VALUE)
    }

    fn count(found: &mut Option<Self>, value: f64) {
        found.get_or_insert(Self { value, cells: 0 }).cells += 1;
    }
}

/// A terrain file.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightFile {
    /// The file; its ending names its kind: png, asc, txt or grd, tif or tiff.
    pub path: PathBuf,
    /// Distance of its cells, m; needed where the file does not say it in metres.
    pub cell: Option<f64>,
    /// Height of one step of grey of a picture, m.
    pub height_step: f64,
}

impl HeightFile {
    /// A terrain file whose cells are `cell` apart, m, where it does not say that itself.
    #[must_use]
    pub const fn new(path: PathBuf, cell: Option<f64>) -> Self {
        Self {
            path,
            cell,
            height_step: 0.001,
        }
    }
}

/// Reads a height map. Its first column lies at x = 0, its middle row at y = 0, its upper edge to the left.
///
/// The file is read as a whole and never mapped: one that shrinks meanwhile is short, no more.
///
/// # Errors
/// [`Error::Terrain`] for what the file lacks, lies about, or has too much of; [`Error::File`] for a path that is
/// no regular file or cannot be read.
pub fn read_heights(file: &HeightFile) -> Result<HeightMap> {
    let of_file = |fault| Error::Terrain {
        file: file.path.clone(),
        fault,
    };
    read_raster(file)?.into_map().map_err(of_file)
}

fn read_bytes(file: &HeightFile) -> Result<Vec<u8>> {
    let opened = regular::open(&file.path)?;
    let mut bytes = Vec::new();
    opened
        .take(MAX_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|source| Error::Unreadable {
            file: file.path.clone(),
            source,
        })?;
    Ok(bytes)
}

/// The height map in the bytes of a file.
///
/// # Errors
/// [`Error::Terrain`].
///
/// ```
/// use grouser_rover::ground::{HeightFile, parse_heights};
///
/// let grid = b"ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n0.1 0.2\n0.3 0.4\n";
/// let file = HeightFile { path: "grid.asc".into(), cell: Some(1.0), height_step: 0.001 };
/// let map = parse_heights(grid, &file)?;
/// assert_eq!(map.cells(), 4);
/// # Ok::<(), grouser_rover::Error>(())
/// ```
pub fn parse_heights(bytes: &[u8], file: &HeightFile) -> Result<HeightMap> {
    raster(bytes, file)
        .and_then(Raster::into_map)
        .map_err(|fault| Error::Terrain {
            file: file.path.clone(),
            fault,
        })
}

fn raster(bytes: &[u8], file: &HeightFile) -> Result<Raster, TerrainFault> {
    if bytes.len() as u64 > MAX_BYTES {
        return Err(TerrainFault::TooManyBytes { limit: MAX_BYTES });
    }
    let ending = file
        .path
        .extension()
        .map_or_else(String::new, |e| e.to_string_lossy().to_ascii_lowercase());
    match ending.as_str() {
        "png" => picture::read(Cursor::new(bytes), file.cell, file.height_step),
        "asc" | "txt" | "grd" => ascii::read(bytes, file.cell),
        "tif" | "tiff" => geotiff::read(bytes, file.cell),
        _ => Err(TerrainFault::Kind),
    }
}

/// Reads a height map as the file has it.
///
/// # Errors
/// As [`read_heights`].
pub fn read_raster(file: &HeightFile) -> Result<Raster> {
    let bytes = read_bytes(file)?;
    let checked = raster(&bytes, file).and_then(|mut raster| {
        raster.check_side_files(file)?;
        Ok(raster)
    });
    checked.map_err(|fault| Error::Terrain {
        file: file.path.clone(),
        fault,
    })
}

/// Refuses a GeoTIFF that a file next to it changes; `is_placed`: it places its cells itself.
///
/// # Errors
/// [`TerrainFault::Beside`].
pub fn check_side_files(path: &Path, is_placed: bool) -> Result<(), TerrainFault> {
    side_files::check(path, is_placed)
}

/// Heights as a file has them: rows from the upper edge down, NaN where it knows none.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Raster {
    /// Cells of a row.
    pub columns: usize,
    /// Row by row, m.
    pub heights: Vec<f32>,
    /// Size of a cell, m.
    pub cell: f64,
    /// The outer corner of the upper left cell, m; `None` where the file does not say it here.
    pub upper_left: Option<[f64; 2]>,
    /// Are its coordinates known to be metres: by its own tags or by the `.prj` of a grid?
    pub has_system: bool,
    /// What was read as unknown, although the file does not declare it.
    pub undeclared: Option<UndeclaredNoData>,
}

impl Raster {
    fn check_side_files(&mut self, file: &HeightFile) -> Result<(), TerrainFault> {
        side_files::check(&file.path, self.has_system || self.upper_left.is_some())?;
        // the coordinates of a grid; a cell that is given stands in place of them
        let Some(corner) = self.upper_left.filter(|_| file.cell.is_none()) else {
            return Ok(());
        };
        let grid = Georeference::of_grid(self.cell, corner);
        if let Some(system) = side_files::system(&file.path, grid)? {
            let rows = self.heights.len() / self.columns;
            let [columns, rows] =
                [self.columns, rows].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
            system.cell((columns, rows))?;
            self.has_system = true;
        }
        Ok(())
    }

    fn into_map(mut self) -> Result<HeightMap, TerrainFault> {
        OutOfRange::check("cell", self.cell, CELL_LIMITS_M, "m")?;
        let columns = self.columns;
        let rows = self.heights.len() / columns;
        // the upper row is the leftmost one: y grows upwards
        for row in 0..rows / 2 {
            let (upper, lower) = self.heights.split_at_mut((rows - 1 - row) * columns);
            upper[row * columns..(row + 1) * columns].swap_with_slice(&mut lower[..columns]);
        }
        let origin = (0.0, -0.5 * (rows.saturating_sub(1)) as f64 * self.cell);
        let map = HeightMap::new(origin, self.cell, columns, self.heights);
        let mut map = map.map_err(|error| match error {
            Error::OutOfRange { range, .. } => TerrainFault::OutOfRange(range),
            other => TerrainFault::damaged(other),
        })?;
        map.undeclared = self.undeclared;
        Ok(map)
    }
}

/// Refuses sizes before anything of that size is made.
fn check_size(columns: u64, rows: u64) -> Result<(), TerrainFault> {
    let cells = u128::from(columns) * u128::from(rows);
    if cells > MAX_CELLS as u128 || columns < 2 || rows < 2 {
        return Err(TerrainFault::Cells {
            columns,
            rows,
            limit: MAX_CELLS as u64,
        });
    }
    Ok(())
}
