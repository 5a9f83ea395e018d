//! Height maps from files: PNG of 8 or 16 bits, ESRI ASCII grids, GeoTIFF.

mod ascii;
mod geotiff;
mod picture;

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use super::height_map::{HeightMap, MOST_CELLS};
use crate::error::{Error, Result};

/// Greatest size of a terrain file, bytes.
const MOST_BYTES: u64 = 1 << 28;

/// A terrain file.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightFile {
    /// The file; its ending tells its kind: png, asc or txt, tif or tiff.
    pub path: PathBuf,
    /// Distance of its cells, m; needed where the file does not say it in metres.
    pub cell: Option<f64>,
    /// Height of one step of grey of a picture, m.
    pub height_step: f64,
}

/// Reads a height map. Its first column lies at x = 0, its middle row at y = 0, its upper edge to the left.
///
/// # Errors
/// [`Error::Terrain`] for what a file lacks, lies about, or has too much of; [`Error::Unreadable`].
pub fn read_heights(file: &HeightFile) -> Result<HeightMap> {
    let ending = file
        .path
        .extension()
        .map_or_else(String::new, |e| e.to_string_lossy().to_ascii_lowercase());
    let reader = open(&file.path)?;
    let raster = match ending.as_str() {
        "png" => picture::read(reader, file),
        "asc" | "txt" | "grd" => ascii::read(reader, file),
        "tif" | "tiff" => geotiff::read(reader, file),
        _ => Err(bad(
            file,
            "a height map ends in .png, .asc, .txt, .tif or .tiff",
        )),
    }?;
    raster.into_map(file)
}

/// Heights as a file has them: rows from the upper edge down.
struct Raster {
    columns: usize,
    heights: Vec<f32>,
    cell: f64,
}

impl Raster {
    fn into_map(self, file: &HeightFile) -> Result<HeightMap> {
        let columns = self.columns;
        // the upper row is the leftmost one: y grows upwards
        let heights: Vec<f32> = self
            .heights
            .chunks_exact(columns)
            .rev()
            .flatten()
            .copied()
            .collect();
        let rows = heights.len() / columns;
        let origin = (0.0, -0.5 * (rows.saturating_sub(1)) as f64 * self.cell);
        HeightMap::new(origin, self.cell, columns, heights).map_err(|error| match error {
            Error::OutOfRange { .. } => bad(file, &error.to_string()),
            error => error,
        })
    }
}

fn bad(file: &HeightFile, message: &str) -> Error {
    Error::Terrain {
        file: file.path.clone(),
        message: message.to_owned(),
    }
}

fn check_size(file: &HeightFile, columns: u64, rows: u64) -> Result<()> {
    let cells = u128::from(columns) * u128::from(rows);
    if cells > MOST_CELLS as u128 {
        let message = format!("{columns} x {rows} cells, but at most {MOST_CELLS} are read");
        return Err(bad(file, &message));
    }
    if columns < 2 || rows < 2 {
        let message = format!("{columns} x {rows} cells, but at least 2 x 2 are needed");
        return Err(bad(file, &message));
    }
    Ok(())
}

fn open(path: &Path) -> Result<BufReader<std::io::Cursor<Vec<u8>>>> {
    let unreadable = |source| Error::Unreadable {
        file: path.to_owned(),
        source,
    };
    let meta = std::fs::metadata(path).map_err(unreadable)?;
    let refused = |message: String| Error::Terrain {
        file: path.to_owned(),
        message,
    };
    if !meta.is_file() {
        return Err(refused("it is not a regular file".into()));
    }
    if meta.len() > MOST_BYTES {
        let message = format!("{} bytes, but at most {MOST_BYTES} are read", meta.len());
        return Err(refused(message));
    }
    // Read as a whole and never mapped: a file that shrinks meanwhile is short, no more.
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(MOST_BYTES).read_to_end(&mut bytes))
        .map_err(unreadable)?;
    Ok(BufReader::new(std::io::Cursor::new(bytes)))
}
