//! GeoTIFF, read piece by piece.
//!
//! Source: the OGC GeoTIFF standard 1.1 for keys and tags; GDAL's documentation for no-data and missing tiles.

use grouser_terra::OutOfRange;
use std::io::{BufRead, Cursor, Seek, SeekFrom};

use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

use super::georeference::Georeference;
use super::height_tiff::HeightTiff;
use super::{Raster, check_size};
use crate::terrain_fault::TerrainFault;

/// Images of a file that are looked at: the heights, their overviews, and a mask of each.
const MAX_IMAGES: usize = 64;
/// The bit of `NewSubfileType` that a mask has (TIFF 6.0, page 36).
const MASK: u32 = 4;
/// Greatest number of cells of one tile or strip.
const MAX_CHUNK_BYTES: u64 = 1 << 25;

const WANTED: &str = "one band of whole numbers up to 32 bits or of floats of 32 or 64";

type Fault<T> = Result<T, TerrainFault>;

/// Heights, as a whole.
pub(super) fn read(bytes: &[u8], cell: Option<f64>) -> Fault<Raster> {
    let mut file = HeightTiff::open(Cursor::new(bytes), cell)?;
    let (columns, rows) = file.size();
    check_size(u64::from(columns), u64::from(rows))?;
    let mut heights = Vec::with_capacity(columns as usize * rows as usize);
    let mut top = 0;
    while top < rows {
        top = file.read_rows(top, &mut heights)?;
    }
    Ok(Raster {
        columns: columns as usize,
        heights,
        cell: file.cell(),
        upper_left: None,
        has_system: file.georeference().centre(0, 0).is_some(),
        undeclared: file.undeclared(),
    })
}

/// A GeoTIFF whose cells are read one piece (tile or strip) at a time, so that memory does not grow with the file.
///
/// ```
/// use std::io::Cursor;
/// use grouser_rover::ground::GeoTiff;
///
/// // no TIFF: refused before anything is allocated
/// assert!(GeoTiff::open(Cursor::new(b"no TIFF".to_vec())).is_err());
/// ```
pub struct GeoTiff<R: BufRead + Seek> {
    decoder: Decoder<R>,
    size: (u32, u32),
    bands: u16,
    nothing: Option<f64>,
    georeference: Georeference,
    cut: Cut,
}

/// Where a piece lies in the image: cells, the part within the image only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PiecePlace {
    /// First column.
    pub left: u32,
    /// First row from the upper edge.
    pub top: u32,
    /// Columns.
    pub wide: u32,
    /// Rows.
    pub high: u32,
}

impl PiecePlace {
    /// Number of its cells.
    #[must_use]
    pub const fn cells(&self) -> usize {
        self.wide as usize * self.high as usize
    }
}

impl<R: BufRead + Seek> GeoTiff<R> {
    /// Opens a file: every tag that reading depends on is checked, no cell is decoded.
    ///
    /// # Errors
    /// What the file lacks or lies about. Its size alone is no error: nothing of that size is allocated.
    pub fn open(mut reader: R) -> Fault<Self> {
        let length = reader
            .seek(SeekFrom::End(0))
            .and_then(|length| reader.rewind().map(|()| length))
            .map_err(TerrainFault::damaged)?;
        let mut limits = Limits::default();
        limits.decoding_buffer_size = 1 << 28;
        limits.ifd_value_size = 1 << 24;
        limits.intermediate_buffer_size = 1 << 26;
        let mut decoder = Decoder::new(reader)
            .map_err(TerrainFault::damaged)?
            .with_limits(limits);
        let size = decoder.dimensions().map_err(TerrainFault::damaged)?;
        let bands = check_samples(&mut decoder)?;
        let georeference = Georeference::from_decoder(&mut decoder);
        let nothing = no_data(&mut decoder)?;
        let cut = cut(&mut decoder, size)?;
        check_places(&mut decoder, &cut, (size.1, bands), length)?;
        Ok(Self {
            decoder,
            size,
            bands,
            nothing,
            georeference,
            cut,
        })
    }

    /// Columns and rows.
    #[must_use]
    pub const fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Numbers a cell.
    #[must_use]
    pub const fn bands(&self) -> u16 {
        self.bands
    }

    /// Where the image lies on the ground.
    #[must_use]
    pub const fn georeference(&self) -> &Georeference {
        &self.georeference
    }

    /// A text tag, such as GDAL's metadata (42112).
    #[must_use]
    pub fn text(&mut self, tag: u16) -> Option<String> {
        self.decoder
            .get_tag_ascii_string(Tag::from_u16_exhaustive(tag))
            .ok()
            .map(|text| text.trim_end_matches('\0').to_owned())
    }

    /// Refuses a file with a mask, which would leave heights out that are read as known.
    pub(super) fn check_mask(&mut self) -> Fault<()> {
        let decoder = &mut self.decoder;
        let mut has_mask = false;
        for _ in 0..MAX_IMAGES {
            if !decoder.more_images() {
                break;
            }
            decoder.next_image().map_err(TerrainFault::damaged)?;
            let kind = tag(decoder, Tag::NewSubfileType)?.unwrap_or(0);
            has_mask |= kind & MASK != 0;
        }
        decoder.seek_to_image(0).map_err(TerrainFault::damaged)?;
        if !has_mask {
            return Ok(());
        }
        Err(TerrainFault::Tag {
            tag: "NewSubfileType (254)",
            value: "4 for one of its images".into(),
            why: "its mask of unknown heights is not read",
            convert: "`gdalwarp -dstnodata -9999 in.tif out.tif` writes the mask into the heights",
        })
    }

    /// Number of pieces, in rows from the upper left one.
    #[must_use]
    pub fn pieces(&self) -> u32 {
        u32::try_from(self.cut.offsets.len()).unwrap_or(u32::MAX)
    }

    /// Pieces side by side.
    #[must_use]
    pub const fn pieces_across(&self) -> u32 {
        self.cut.across
    }

    /// Rows of a piece, but for the lowest ones.
    #[must_use]
    pub const fn piece_height(&self) -> u32 {
        self.cut.height
    }

    /// Where a piece lies.
    #[must_use]
    pub fn place(&self, index: u32) -> PiecePlace {
        let cut = &self.cut;
        let left = (index % cut.across).saturating_mul(cut.width);
        let top = (index / cut.across).saturating_mul(cut.height);
        PiecePlace {
            left,
            top,
            wide: cut.width.min(self.size.0.saturating_sub(left)),
            high: cut.height.min(self.size.1.saturating_sub(top)),
        }
    }

    /// Gives all numbers of a piece to `take`, row by row and for each cell band by band: NaN for no data, and for a
    /// piece that the file leaves out.
    ///
    /// # Errors
    /// A piece that is damaged or has another size than the file says.
    pub fn read_piece(&mut self, index: u32, mut take: impl FnMut(f32)) -> Fault<()> {
        let place = self.place(index);
        let expected = (place.cells() * usize::from(self.bands)) as u64;
        let bytes = self.cut.bytes.get(index as usize).copied();
        if bytes.unwrap_or(0) == 0 {
            (0..expected).for_each(|_| take(f32::NAN));
            return Ok(());
        }
        let piece = self
            .decoder
            .read_chunk(index)
            .map_err(TerrainFault::damaged)?;
        let mut found = 0_u64;
        each(piece, self.nothing, |height| {
            found += 1;
            if found <= expected {
                take(height);
            }
        })?;
        if found != expected {
            return Err(TerrainFault::Count {
                field: "cells in a piece",
                found,
                expected,
            });
        }
        Ok(())
    }
}

/// The number that stands for no data, where the file declares one.
fn no_data<R: BufRead + Seek>(decoder: &mut Decoder<R>) -> Fault<Option<f64>> {
    let Ok(text) = decoder.get_tag_ascii_string(Tag::GdalNodata) else {
        return Ok(None);
    };
    let text = text.trim_matches(['\0', ' ', '\n']);
    if text.is_empty() {
        return Ok(None);
    }
    let number = text.parse().map_err(|_| TerrainFault::Tag {
        tag: "GDAL_NODATA (42113)",
        value: TerrainFault::shown(text),
        why: "that is not a number",
        convert: "`gdal_edit.py -a_nodata -9999 in.tif` declares another one",
    })?;
    Ok(Some(number))
}

/// Bands of one kind, black lowest; gives their number.
fn check_samples<R: BufRead + Seek>(decoder: &mut Decoder<R>) -> Fault<u16> {
    let color = decoder.colortype().map_err(TerrainFault::damaged)?;
    let bands = match color {
        ColorType::Gray(8 | 16 | 32 | 64) => 1,
        ColorType::Multiband {
            bit_depth: 32,
            num_samples,
        } if tag(decoder, Tag::PlanarConfiguration)?.unwrap_or(1) == 1 => num_samples,
        _ => {
            let found = format!("{color:?}");
            return Err(TerrainFault::Samples {
                found,
                wanted: WANTED,
            });
        }
    };
    // white lowest: the decoder would turn the heights upside down
    if tag(decoder, Tag::PhotometricInterpretation)? == Some(0) {
        return Err(TerrainFault::Samples {
            found: "grey levels from white to black".into(),
            wanted: "black to white",
        });
    }
    Ok(bands)
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
    (rows, bands): (u32, u16),
    length: u64,
) -> Fault<()> {
    let plain = tag(decoder, Tag::Compression)?.unwrap_or(1) == 1;
    let bits = decoder
        .colortype()
        .map_err(TerrainFault::damaged)?
        .bit_depth();
    let row = (u64::from(cut.width) * u64::from(bits) * u64::from(bands)).div_ceil(8);
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
