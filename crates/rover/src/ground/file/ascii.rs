//! ESRI ASCII grids.

use std::io::BufRead;

use super::{HeightFile, Raster, bad, check_size};
use crate::error::Result;

/// Header lines, then rows of numbers from the upper edge down; NODATA is unknown.
pub(super) fn read(mut reader: impl BufRead, file: &HeightFile) -> Result<Raster> {
    let mut text = String::new();
    reader
        .read_to_string(&mut text)
        .map_err(|error| bad(file, &format!("no text: {error}")))?;
    let (mut columns, mut rows, mut cell, mut nothing) = (None, None, None, -9999.0);
    let mut words = text.split_ascii_whitespace().peekable();
    while let Some(word) = words.peek() {
        if word.parse::<f64>().is_ok() {
            break;
        }
        let key = word.to_ascii_lowercase();
        words.next();
        let value = words.next().and_then(|word| word.parse::<f64>().ok());
        let Some(value) = value else {
            let message = format!("`{key}` of the header has no number");
            return Err(bad(file, &message));
        };
        match key.as_str() {
            "ncols" => columns = Some(value),
            "nrows" => rows = Some(value),
            "cellsize" => cell = Some(value),
            "nodata_value" => nothing = value,
            "xllcorner" | "yllcorner" | "xllcenter" | "yllcenter" => {}
            _ => {
                let message = format!("`{key}` is no header of an ASCII grid");
                return Err(bad(file, &message));
            }
        }
    }
    let whole = |name: &str, value: Option<f64>| match value {
        Some(value) if (0.0..=1e9).contains(&value) && value.fract() == 0.0 => {
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a whole number up to 1e9, as just checked"
            )]
            let whole = value as u64;
            Ok(whole)
        }
        Some(value) => Err(bad(file, &format!("`{name}` is {value}"))),
        None => Err(bad(file, &format!("`{name}` is missing"))),
    };
    let (columns, rows) = (whole("ncols", columns)?, whole("nrows", rows)?);
    check_size(file, columns, rows)?;
    let Some(cell) = file.cell.or(cell) else {
        return Err(bad(file, "`cellsize` is missing"));
    };
    let count = usize::try_from(columns * rows).unwrap_or(usize::MAX);
    let mut heights = Vec::with_capacity(count);
    for word in words {
        let Ok(value) = word.parse::<f64>() else {
            let shown: String = word.chars().take(40).collect();
            return Err(bad(file, &format!("`{shown}` is no number")));
        };
        if heights.len() == count {
            return Err(bad(file, &format!("more than {count} heights")));
        }
        #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
        heights.push(if value == nothing {
            f32::NAN
        } else {
            value as f32
        });
    }
    if heights.len() != count {
        let message = format!(
            "{} heights, but {columns} x {rows} announced",
            heights.len()
        );
        return Err(bad(file, &message));
    }
    Ok(Raster {
        columns: usize::try_from(columns).unwrap_or(usize::MAX),
        heights,
        cell,
    })
}
