//! GeoTIFF of one band.
//!
//! Source: the OGC GeoTIFF standard 1.1 for keys and tags; GDAL's documentation for no-data and missing tiles.

use grouser_terra::OutOfRange;
use std::io::{BufRead, Cursor, Seek};

use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

use super::{Raster, check_size};
use crate::terrain_fault::{NoCell, TerrainFault};

/// GeoTIFF's keys: the model type with its values, and the units of coordinates and of heights.
const MODEL_TYPE_KEY: u32 = 1024;
const PROJECTED: u32 = 1;
const GEOGRAPHIC: u32 = 2;
const LINEAR_UNITS_KEY: u32 = 3076;
const VERTICAL_UNITS_KEY: u32 = 4099;
/// EPSG's code of the metre.
const METRE: u32 = 9001;
/// Greatest number of cells of one tile or strip.
const MAX_CHUNK_BYTES: u64 = 1 << 25;

const WANTED: &str = "one band of whole numbers up to 32 bits or of floats of 32 or 64";

type Fault<T> = Result<T, TerrainFault>;

/// One band of whole numbers or floats. The cell comes from the file's own scale where its coordinates are
/// metres; geographic ones (degrees), or none at all, ask for `cell_m`.
pub(super) fn read(bytes: &[u8], cell: Option<f64>) -> Fault<Raster> {
    let mut limits = Limits::default();
    limits.decoding_buffer_size = 1 << 28;
    limits.ifd_value_size = 1 << 24;
    limits.intermediate_buffer_size = 1 << 26;
    let mut decoder = Decoder::new(Cursor::new(bytes))
        .map_err(TerrainFault::damaged)?
        .with_limits(limits);
    let (columns, rows) = decoder.dimensions().map_err(TerrainFault::damaged)?;
    check_size(u64::from(columns), u64::from(rows))?;
    check_samples(&mut decoder)?;
    let keys = keys(&mut decoder);
    if let Some(code) = value_of(&keys, VERTICAL_UNITS_KEY).filter(|code| *code != METRE) {
        return Err(TerrainFault::HeightUnit { code });
    }
    let cell = match cell {
        Some(cell) => cell,
        None => own_cell(&mut decoder, &keys)?,
    };
    let nothing = decoder
        .get_tag_ascii_string(Tag::GdalNodata)
        .ok()
        .and_then(|text| text.trim_matches(['\0', ' ']).parse::<f64>().ok());
    let heights = heights(&mut decoder, (columns, rows), bytes.len() as u64, nothing)?;
    Ok(Raster {
        columns: columns as usize,
        heights,
        cell,
    })
}

/// One band, black lowest.
fn check_samples<R: BufRead + Seek>(decoder: &mut Decoder<R>) -> Fault<()> {
    let color = decoder.colortype().map_err(TerrainFault::damaged)?;
    if !matches!(color, ColorType::Gray(8 | 16 | 32 | 64)) {
        let found = format!("{color:?}");
        return Err(TerrainFault::Samples {
            found,
            wanted: WANTED,
        });
    }
    // white lowest: the decoder would turn the heights upside down
    if tag(decoder, Tag::PhotometricInterpretation)? == Some(0) {
        return Err(TerrainFault::Samples {
            found: "grey levels from white to black".into(),
            wanted: "black to white",
        });
    }
    Ok(())
}

/// How the image is cut.
struct Cut {
    width: u32,
    height: u32,
    across: u32,
    /// Where each piece begins, and its bytes: what has none is a piece that the file leaves out.
    offsets: Vec<u64>,
    bytes: Vec<u64>,
    names: [&'static str; 2],
}

fn cut<R: BufRead + Seek>(decoder: &mut Decoder<R>, (columns, rows): (u32, u32)) -> Fault<Cut> {
    let least = |field, value: u32| {
        if value == 0 {
            return Err(TerrainFault::OutOfRange(OutOfRange {
                field,
                value: 0.0,
                low: 1.0,
                high: f64::from(u32::MAX),
                unit: "1",
            }));
        }
        Ok(value)
    };
    let tiled = tag(decoder, Tag::TileWidth)?;
    let (width, height, tags, names) = if let Some(width) = tiled {
        let height = tag(decoder, Tag::TileLength)?;
        let height = height.ok_or(TerrainFault::Missing {
            field: "TileLength",
        })?;
        let height = least("TileLength", height)?;
        let width = least("TileWidth", width)?;
        let tags = [Tag::TileOffsets, Tag::TileByteCounts];
        (width, height, tags, ["tiles", "TileOffsets"])
    } else {
        let height = tag(decoder, Tag::RowsPerStrip)?.unwrap_or(rows);
        let height = least("RowsPerStrip", height)?.min(rows);
        let tags = [Tag::StripOffsets, Tag::StripByteCounts];
        (columns, height, tags, ["strips", "StripOffsets"])
    };
    if u64::from(width) * u64::from(height) > MAX_CHUNK_BYTES {
        return Err(TerrainFault::Cells {
            columns: u64::from(width),
            rows: u64::from(height),
            limit: MAX_CHUNK_BYTES,
        });
    }
    let across = columns.div_ceil(width);
    let count = u64::from(across) * u64::from(rows.div_ceil(height));
    let mut numbers = |tag| decoder.get_tag_u64_vec(tag).map_err(TerrainFault::damaged);
    let (offsets, bytes) = (numbers(tags[0])?, numbers(tags[1])?);
    for found in [offsets.len() as u64, bytes.len() as u64] {
        if found != count {
            return Err(TerrainFault::Count {
                field: names[0],
                found,
                expected: count,
            });
        }
    }
    Ok(Cut {
        width,
        height,
        across,
        offsets,
        bytes,
        names,
    })
}

/// Every piece lies within the file, and one that is not packed has the bytes of its cells: the decoder would read
/// what follows it.
fn check_places<R: BufRead + Seek>(
    decoder: &mut Decoder<R>,
    cut: &Cut,
    rows: u32,
    length: u64,
) -> Fault<()> {
    let plain = tag(decoder, Tag::Compression)?.unwrap_or(1) == 1;
    let bits = tag(decoder, Tag::BitsPerSample)?.unwrap_or(1);
    let row = (u64::from(cut.width) * u64::from(bits)).div_ceil(8);
    for (index, (offset, bytes)) in (0_u32..).zip(cut.offsets.iter().zip(&cut.bytes)) {
        if *bytes == 0 {
            continue;
        }
        if offset.saturating_add(*bytes) > length {
            return Err(TerrainFault::OutOfRange(OutOfRange {
                field: cut.names[1],
                value: *offset as f64,
                low: 8.0,
                high: length.saturating_sub(*bytes) as f64,
                unit: "byte",
            }));
        }
        // the last strip ends with the image, tiles are always whole
        let top = index / cut.across * cut.height;
        let high = if cut.names[0] == "strips" {
            cut.height.min(rows.saturating_sub(top))
        } else {
            cut.height
        };
        if plain && *bytes < row * u64::from(high) {
            return Err(TerrainFault::Count {
                field: "bytes in a piece",
                found: *bytes,
                expected: row * u64::from(high),
            });
        }
    }
    Ok(())
}

/// All cells, piece by piece: besides the heights no more than one piece is held.
fn heights<R: BufRead + Seek>(
    decoder: &mut Decoder<R>,
    (columns, rows): (u32, u32),
    length: u64,
    nothing: Option<f64>,
) -> Fault<Vec<f32>> {
    let cut = cut(decoder, (columns, rows))?;
    check_places(decoder, &cut, rows, length)?;
    let mut heights = vec![f32::NAN; columns as usize * rows as usize];
    for (index, bytes) in (0_u32..).zip(&cut.bytes) {
        if *bytes == 0 {
            continue;
        }
        let piece = decoder.read_chunk(index).map_err(TerrainFault::damaged)?;
        let (left, top) = (
            index % cut.across * cut.width,
            index / cut.across * cut.height,
        );
        let wide = cut.width.min(columns - left) as usize;
        let high = cut.height.min(rows - top) as usize;
        let mut into = (0..wide * high).map(|i| {
            let (row, column) = (i / wide, i % wide);
            (top as usize + row) * columns as usize + left as usize + column
        });
        let expected = (wide * high) as u64;
        let mut found = 0_u64;
        each(piece, nothing, |height| {
            if let Some(slot) = into.next().and_then(|place| heights.get_mut(place)) {
                *slot = height;
            }
            found += 1;
        })?;
        if found != expected {
            return Err(TerrainFault::Count {
                field: "cells in a piece",
                found,
                expected,
            });
        }
    }
    Ok(heights)
}

/// Gives every cell as a height, NaN for no data.
fn each(piece: DecodingResult, nothing: Option<f64>, mut take: impl FnMut(f32)) -> Fault<()> {
    #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
    let mut wide = |value: f64| {
        take(if Some(value) == nothing {
            f32::NAN
        } else {
            value as f32
        });
    };
    match piece {
        DecodingResult::U8(v) => v.into_iter().for_each(|value| wide(value.into())),
        DecodingResult::I8(v) => v.into_iter().for_each(|value| wide(value.into())),
        DecodingResult::U16(v) => v.into_iter().for_each(|value| wide(value.into())),
        DecodingResult::I16(v) => v.into_iter().for_each(|value| wide(value.into())),
        DecodingResult::U32(v) => v.into_iter().for_each(|value| wide(value.into())),
        DecodingResult::I32(v) => v.into_iter().for_each(|value| wide(value.into())),
        DecodingResult::F64(v) => v.into_iter().for_each(wide),
        DecodingResult::F32(v) => {
            // the text of the no-data value has more or fewer digits than the cell
            #[allow(
                clippy::cast_possible_truncation,
                reason = "to the cells' own precision"
            )]
            let nothing = nothing.map(|value| value as f32);
            for value in v {
                take(if Some(value) == nothing {
                    f32::NAN
                } else {
                    value
                });
            }
        }
        _ => {
            return Err(TerrainFault::Samples {
                found: "of another kind of number".into(),
                wanted: WANTED,
            });
        }
    }
    Ok(())
}

fn tag<R: BufRead + Seek>(decoder: &mut Decoder<R>, tag: Tag) -> Fault<Option<u32>> {
    decoder
        .find_tag_unsigned(tag)
        .map_err(TerrainFault::damaged)
}

/// Keys and values of the coordinate system that are whole numbers.
fn keys<R: BufRead + Seek>(decoder: &mut Decoder<R>) -> Vec<[u32; 2]> {
    let directory = decoder
        .get_tag_u32_vec(Tag::GeoKeyDirectoryTag)
        .unwrap_or_default();
    let entries = directory.chunks_exact(4).skip(1);
    entries
        .filter(|entry| entry[1] == 0)
        .map(|entry| [entry[0], entry[3]])
        .collect()
}

fn value_of(keys: &[[u32; 2]], wanted: u32) -> Option<u32> {
    let found = keys.iter().find(|[key, _]| *key == wanted);
    found.map(|[_, value]| *value)
}

fn own_cell<R: BufRead + Seek>(decoder: &mut Decoder<R>, keys: &[[u32; 2]]) -> Fault<f64> {
    let none = |why| Err(TerrainFault::NoCell { why });
    match value_of(keys, MODEL_TYPE_KEY) {
        Some(PROJECTED) => {}
        Some(GEOGRAPHIC) => return none(NoCell::Degrees),
        _ => return none(NoCell::NoSystem),
    }
    if let Some(code) = value_of(keys, LINEAR_UNITS_KEY).filter(|code| *code != METRE) {
        return none(NoCell::Unit { code });
    }
    let scale = decoder.get_tag_f64_vec(Tag::ModelPixelScaleTag);
    let [width, height] = match scale.as_deref() {
        Ok([width, height, ..]) => [*width, *height],
        _ => match decoder
            .get_tag_f64_vec(Tag::ModelTransformationTag)
            .as_deref()
        {
            // rows of a 4 x 4 matrix from column and row to x and y
            Ok([a, b, _, _, d, e, ..]) if *b == 0.0 && *d == 0.0 => [a.abs(), e.abs()],
            Ok([_, _, _, _, _, _, ..]) => return none(NoCell::Turned),
            _ => return none(NoCell::NoScale),
        },
    };
    if !((width - height).abs() <= 1e-9 * width.abs()) {
        return none(NoCell::NotSquare { width, height });
    }
    Ok(width)
}
