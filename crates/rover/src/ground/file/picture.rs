//! PNG of grey levels.

use std::io::{BufRead, Seek};

use super::{Raster, check_size};
use crate::terrain_fault::{NoCell, TerrainFault};

const WANTED: &str = "grey of 8 or 16 bits, with or without transparency";

/// Grey of 8 or 16 bits, black lowest; the step of height comes from the scenario. Transparent pixels are unknown.
pub(super) fn read(
    reader: impl BufRead + Seek,
    cell: Option<f64>,
    height_step: f64,
) -> Result<Raster, TerrainFault> {
    let limits = png::Limits { bytes: 1 << 28 };
    let decoder = png::Decoder::new_with_limits(reader, limits);
    let mut reader = decoder.read_info().map_err(TerrainFault::damaged)?;
    let info = reader.info();
    let (columns, rows) = (info.width, info.height);
    check_size(u64::from(columns), u64::from(rows))?;
    // one level of grey may stand for transparent
    let clear_level = match info.trns.as_deref() {
        Some([high, low]) => Some(u16::from_be_bytes([*high, *low])),
        _ => None,
    };
    let Some(cell) = cell else {
        return Err(TerrainFault::NoCell {
            why: NoCell::Picture,
        });
    };
    let (color, depth) = reader.output_color_type();
    let (samples, bytes) = match (color, depth) {
        (png::ColorType::Grayscale, png::BitDepth::Eight) => (1, 1),
        (png::ColorType::Grayscale, png::BitDepth::Sixteen) => (1, 2),
        (png::ColorType::GrayscaleAlpha, png::BitDepth::Eight) => (2, 1),
        (png::ColorType::GrayscaleAlpha, png::BitDepth::Sixteen) => (2, 2),
        _ => {
            return Err(TerrainFault::Samples {
                found: format!("{color:?} of {depth:?}").to_lowercase(),
                wanted: WANTED,
            });
        }
    };
    let size = reader
        .output_buffer_size()
        .ok_or_else(|| TerrainFault::damaged("its size overflows"))?;
    let mut buffer = vec![0; size];
    let frame = reader
        .next_frame(&mut buffer)
        .map_err(TerrainFault::damaged)?;
    let value = |sample: &[u8]| match sample {
        [high, low] => u16::from_be_bytes([*high, *low]),
        [only] => u16::from(*only),
        _ => 0,
    };
    let pixels = buffer[..frame.buffer_size()].chunks_exact(samples * bytes);
    let heights: Vec<f32> = pixels
        .map(|pixel| {
            let grey = value(&pixel[..bytes]);
            let clear = Some(grey) == clear_level || (samples == 2 && value(&pixel[bytes..]) == 0);
            #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
            let height = (f64::from(grey) * height_step) as f32;
            if clear { f32::NAN } else { height }
        })
        .collect();
    let expected = u64::from(columns) * u64::from(rows);
    if heights.len() as u64 != expected {
        return Err(TerrainFault::Count {
            field: "pixels",
            found: heights.len() as u64,
            expected,
        });
    }
    Ok(Raster {
        columns: columns as usize,
        heights,
        cell,
        upper_left: None,
        has_system: false,
        undeclared: None,
    })
}
