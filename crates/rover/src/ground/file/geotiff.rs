//! GeoTIFF of one band.

use std::io::{BufRead, Seek};

use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

use super::{HeightFile, Raster, bad, check_size};
use crate::error::Result;

/// GeoTIFF's keys: the model type, and its values.
const MODEL_TYPE_KEY: u32 = 1024;
const PROJECTED: u32 = 1;
const GEOGRAPHIC: u32 = 2;

/// One band of whole numbers or floats. The cell comes from the file's own scale where its coordinates are
/// metres; geographic ones (degrees), or none at all, ask for `cell_m`.
pub(super) fn read(reader: impl BufRead + Seek, file: &HeightFile) -> Result<Raster> {
    let refused = |error: tiff::TiffError| bad(file, &error.to_string());
    let mut limits = Limits::default();
    limits.decoding_buffer_size = 1 << 28;
    limits.ifd_value_size = 1 << 24;
    limits.intermediate_buffer_size = 1 << 26;
    let mut decoder = Decoder::new(reader).map_err(refused)?.with_limits(limits);
    let (columns, rows) = decoder.dimensions().map_err(refused)?;
    check_size(file, u64::from(columns), u64::from(rows))?;
    let cell = match file.cell {
        Some(cell) => cell,
        None => own_cell(&mut decoder, file)?,
    };
    let nothing = decoder
        .get_tag_ascii_string(Tag::GdalNodata)
        .ok()
        .and_then(|text| text.trim_matches(['\0', ' ']).parse::<f64>().ok());
    let image = decoder.read_image().map_err(refused)?;
    let values: Vec<f64> = match image {
        DecodingResult::U8(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::I8(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::U16(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::I16(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::U32(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::I32(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::F32(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::F64(v) => v,
        _ => return Err(bad(file, "its kind of number is not read")),
    };
    let count = columns as usize * rows as usize;
    if values.len() != count {
        let message = format!(
            "{} values for {columns} x {rows} cells: one band is needed",
            values.len()
        );
        return Err(bad(file, &message));
    }
    #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
    let heights = values
        .into_iter()
        .map(|value| {
            if Some(value) == nothing {
                f32::NAN
            } else {
                value as f32
            }
        })
        .collect();
    Ok(Raster {
        columns: columns as usize,
        heights,
        cell,
    })
}

fn own_cell<R: BufRead + Seek>(decoder: &mut Decoder<R>, file: &HeightFile) -> Result<f64> {
    let keys = decoder
        .get_tag_u32_vec(Tag::GeoKeyDirectoryTag)
        .unwrap_or_default();
    let model = keys
        .chunks_exact(4)
        .skip(1)
        .find(|entry| entry[0] == MODEL_TYPE_KEY)
        .map(|entry| entry[3]);
    match model {
        Some(PROJECTED) => {}
        Some(GEOGRAPHIC) => {
            let message = "its coordinates are degrees: `cell_m` must give the cells in metres";
            return Err(bad(file, message));
        }
        _ => {
            let message = "it does not say what its coordinates are: `cell_m` is needed";
            return Err(bad(file, message));
        }
    }
    let scale = decoder
        .get_tag_f64_vec(Tag::ModelPixelScaleTag)
        .map_err(|_| bad(file, "it has no pixel scale: `cell_m` is needed"))?;
    match scale.as_slice() {
        [x, y, ..] if (x - y).abs() <= 1e-9 * x.abs() => Ok(*x),
        [x, y, ..] => Err(bad(
            file,
            &format!("its cells are {x} m by {y} m, not square"),
        )),
        _ => Err(bad(
            file,
            "its pixel scale is cut short: `cell_m` is needed",
        )),
    }
}
