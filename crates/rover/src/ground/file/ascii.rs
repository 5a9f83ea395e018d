//! ESRI ASCII grids.

use super::{Raster, UndeclaredNoData, check_size};
use crate::terrain_fault::{NoCell, TerrainFault};
use grouser_terra::OutOfRange;

/// What the header says, as numbers.
struct Header {
    columns: Option<f64>,
    rows: Option<f64>,
    cell: Option<f64>,
    corner: [f64; 2],
    /// Is the corner the centre of the lowest left cell, not its outer corner?
    is_centre: [bool; 2],
    /// What stands for no height.
    nothing: f64,
}

/// Header lines, then rows of numbers from the upper edge down; NODATA and NaN are unknown.
pub(super) fn read(bytes: &[u8], cell: Option<f64>) -> Result<Raster, TerrainFault> {
    let text = std::str::from_utf8(bytes)
        .map_err(|error| TerrainFault::damaged(format!("it is no text: {error}")))?;
    let mut words = text.split_ascii_whitespace();
    let header = header(&mut words)?;
    let columns = whole("ncols", header.columns)?;
    let rows = whole("nrows", header.rows)?;
    check_size(columns, rows)?;
    let cell = match cell {
        Some(cell) => cell,
        None => own_cell(&header)?,
    };
    let expected = columns * rows;
    // a height takes two bytes at least: a short file that announces much gets no room for it
    let room = expected.min(text.len() as u64 / 2 + 1);
    let mut heights = Vec::with_capacity(usize::try_from(room).unwrap_or(0));
    let mut undeclared = None;
    for word in words {
        let found = heights.len() as u64;
        let Ok(value) = word.parse::<f64>() else {
            return Err(TerrainFault::NotANumber {
                word: TerrainFault::shown(word),
                row: found / columns + 1,
                column: found % columns + 1,
            });
        };
        if found == expected {
            return Err(TerrainFault::Count {
                field: "heights",
                found: found + 1,
                expected,
            });
        }
        let is_declared = value == header.nothing;
        let is_known = !is_declared && !UndeclaredNoData::is_one(value);
        if !is_declared && !is_known {
            UndeclaredNoData::count(&mut undeclared, value);
        }
        #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
        heights.push(if is_known { value as f32 } else { f32::NAN });
    }
    if heights.len() as u64 != expected {
        return Err(TerrainFault::Count {
            field: "heights",
            found: heights.len() as u64,
            expected,
        });
    }
    Ok(Raster {
        columns: usize::try_from(columns).unwrap_or(usize::MAX),
        heights,
        cell,
        upper_left: Some(header.upper_left(rows, cell)),
        has_system: false,
        undeclared,
    })
}

impl Header {
    /// The outer corner of the upper left cell.
    fn upper_left(&self, rows: u64, cell: f64) -> [f64; 2] {
        let [x, y] = [0, 1].map(|axis: usize| {
            self.corner[axis]
                - if self.is_centre[axis] {
                    0.5 * cell
                } else {
                    0.0
                }
        });
        [x, y + rows as f64 * cell]
    }
}

/// Takes pairs of name and number, up to the first number that has no name.
fn header<'a>(words: &mut (impl Iterator<Item = &'a str> + Clone)) -> Result<Header, TerrainFault> {
    let mut header = Header {
        columns: None,
        rows: None,
        cell: None,
        corner: [0.0; 2],
        is_centre: [false; 2],
        nothing: -9999.0,
    };
    loop {
        let mut ahead = words.clone();
        let Some(key) = ahead.next().filter(|word| word.parse::<f64>().is_err()) else {
            return Ok(header);
        };
        let place = match key.to_ascii_lowercase().as_str() {
            "ncols" => header.columns.insert(0.0),
            "nrows" => header.rows.insert(0.0),
            "cellsize" => header.cell.insert(0.0),
            "nodata_value" => &mut header.nothing,
            "xllcorner" | "xllcenter" => &mut header.corner[0],
            "yllcorner" | "yllcenter" => &mut header.corner[1],
            _ => {
                return Err(TerrainFault::Header {
                    word: TerrainFault::shown(key),
                });
            }
        };
        let word = ahead.next().unwrap_or_default();
        *place = word.parse().map_err(|_| TerrainFault::NotANumber {
            word: TerrainFault::shown(word),
            row: 0,
            column: 0,
        })?;
        match key.to_ascii_lowercase().as_str() {
            "xllcenter" => header.is_centre[0] = true,
            "yllcenter" => header.is_centre[1] = true,
            _ => {}
        }
        *words = ahead;
    }
}

fn whole(field: &'static str, value: Option<f64>) -> Result<u64, TerrainFault> {
    const MAX_CELLS: f64 = 1e9;
    match value {
        Some(value) if (0.0..=MAX_CELLS).contains(&value) && value.fract() == 0.0 => {
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a whole number up to 1e9, as just checked"
            )]
            let whole = value as u64;
            Ok(whole)
        }
        Some(value) => Err(TerrainFault::OutOfRange(OutOfRange {
            field,
            value,
            low: 2.0,
            high: MAX_CELLS,
            unit: "1",
        })),
        None => Err(TerrainFault::Missing { field }),
    }
}

/// The size of cells in metres, which a grid does not say: whole seconds of arc beside a corner within 180 by 90 are
/// taken for degrees.
fn own_cell(header: &Header) -> Result<f64, TerrainFault> {
    let cell = header
        .cell
        .ok_or(TerrainFault::Missing { field: "cellsize" })?;
    let [x, y] = header.corner;
    let seconds = 3600.0 * cell;
    // 1/3 second to 60 seconds, as elevation models have them
    let is_arc = [1.0, 3.0].into_iter().any(|part| {
        let count = part * seconds;
        count > 0.5 && seconds < 60.5 && (count - count.round()).abs() < 1e-3 * count
    });
    if is_arc && x.abs() <= 180.0 && y.abs() <= 90.0 && (x != 0.0 || y != 0.0) {
        return Err(TerrainFault::NoCell {
            why: NoCell::LooksLikeDegrees { cell },
        });
    }
    Ok(cell)
}
