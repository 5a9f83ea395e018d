//! PNG of grey levels.

use std::io::{BufRead, Seek};

use super::{HeightFile, Raster, bad, check_size};
use crate::error::Result;

/// Grey of 8 or 16 bits; the step of height comes from the scenario. Transparent pixels are unknown.
pub(super) fn read(reader: impl BufRead + Seek, file: &HeightFile) -> Result<Raster> {
    let refused = |error: png::DecodingError| bad(file, &error.to_string());
    let limits = png::Limits { bytes: 1 << 28 };
    let decoder = png::Decoder::new_with_limits(reader, limits);
    let mut reader = decoder.read_info().map_err(refused)?;
    let info = reader.info();
    let (columns, rows) = (info.width, info.height);
    check_size(file, u64::from(columns), u64::from(rows))?;
    let Some(cell) = file.cell else {
        return Err(bad(
            file,
            "a picture does not say how large it is: `cell_m` is needed",
        ));
    };
    let (color, depth) = reader.output_color_type();
    let samples = match color {
        png::ColorType::Grayscale => 1,
        png::ColorType::GrayscaleAlpha => 2,
        _ => return Err(bad(file, "a height map is grey, not coloured")),
    };
    let bytes = match depth {
        png::BitDepth::Eight => 1,
        png::BitDepth::Sixteen => 2,
        _ => return Err(bad(file, "8 or 16 bits of grey are needed")),
    };
    let size = reader
        .output_buffer_size()
        .ok_or_else(|| bad(file, "its size overflows"))?;
    let mut buffer = vec![0; size];
    let frame = reader.next_frame(&mut buffer).map_err(refused)?;
    let value = |sample: &[u8]| match sample {
        [high, low] => f64::from(u16::from_be_bytes([*high, *low])),
        [only] => f64::from(*only),
        _ => 0.0,
    };
    let mut heights = Vec::new();
    for pixel in buffer[..frame.buffer_size()].chunks_exact(samples * bytes) {
        let clear = samples == 2 && value(&pixel[bytes..]) == 0.0;
        #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
        heights.push(if clear {
            f32::NAN
        } else {
            (value(&pixel[..bytes]) * file.height_step) as f32
        });
    }
    Ok(Raster {
        columns: columns as usize,
        heights,
        cell,
    })
}
