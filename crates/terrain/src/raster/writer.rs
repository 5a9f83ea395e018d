//! GeoTIFF of many bands, strip by strip.

use std::io::{Seek, Write};

use grouser_rover::ground::Georeference;
use tiff::TiffResult;
use tiff::encoder::{DirectoryEncoder, TiffEncoder, TiffKind};
use tiff::tags::Tag;

/// Data beyond this need BigTIFF's offsets, bytes.
const MAX_CLASSIC_BYTES: u64 = 3 << 30;
/// Numbers of the TIFF specification.
const DEFLATE: u16 = 8;
const FLOATING_POINT_PREDICTOR: u16 = 3;
const IEEE_FLOAT: u16 = 3;
const BLACK_IS_ZERO: u16 = 1;
const CHUNKY: u16 = 1;

/// How a raster is laid out.
#[derive(Clone, Debug, PartialEq)]
pub struct RasterLayout {
    /// Cells of a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Numbers of a cell.
    pub bands: u16,
    /// Rows of a strip.
    pub strip_rows: u32,
    /// Where it lies.
    pub georeference: Georeference,
    /// GDAL's metadata: XML.
    pub metadata: String,
}

/// Writes a GeoTIFF of floats, deflated with the floating-point predictor: `strips` gives the bytes of each strip in
/// order, from the upper edge.
///
/// # Errors
/// What the target refuses, or what `strips` reports.
pub fn write_raster<W: Write + Seek, E: From<tiff::TiffError>>(
    target: W,
    layout: &RasterLayout,
    packed_bytes: u64,
    strips: impl Iterator<Item = Result<Vec<u8>, E>>,
) -> Result<(), E> {
    if packed_bytes > MAX_CLASSIC_BYTES {
        let mut encoder = TiffEncoder::new_big(target)?;
        write(
            encoder.image_directory()?,
            layout,
            strips,
            |offsets, directory| directory.write_tag(Tag::StripOffsets, offsets),
        )
    } else {
        let mut encoder = TiffEncoder::new(target)?;
        write(
            encoder.image_directory()?,
            layout,
            strips,
            |offsets, directory| {
                let narrow: Vec<u32> = offsets
                    .iter()
                    .map(|offset| u32::try_from(*offset).unwrap_or(u32::MAX))
                    .collect();
                directory.write_tag(Tag::StripOffsets, &narrow[..])
            },
        )
    }
}

fn write<W: Write + Seek, K: TiffKind, E: From<tiff::TiffError>>(
    mut directory: DirectoryEncoder<'_, W, K>,
    layout: &RasterLayout,
    strips: impl Iterator<Item = Result<Vec<u8>, E>>,
    write_offsets: impl FnOnce(&[u64], &mut DirectoryEncoder<'_, W, K>) -> TiffResult<()>,
) -> Result<(), E> {
    let (mut offsets, mut counts) = (Vec::new(), Vec::new());
    for strip in strips {
        let strip = strip?;
        counts.push(u32::try_from(strip.len()).unwrap_or(u32::MAX));
        offsets.push(directory.write_data(&strip[..])?);
    }
    write_offsets(&offsets, &mut directory)?;
    let bands = usize::from(layout.bands);
    let tag = Tag::from_u16_exhaustive;
    directory.write_tag(Tag::ImageWidth, layout.columns)?;
    directory.write_tag(Tag::ImageLength, layout.rows)?;
    directory.write_tag(Tag::BitsPerSample, &vec![32_u16; bands][..])?;
    directory.write_tag(Tag::Compression, DEFLATE)?;
    directory.write_tag(Tag::PhotometricInterpretation, BLACK_IS_ZERO)?;
    directory.write_tag(Tag::SamplesPerPixel, layout.bands)?;
    directory.write_tag(Tag::RowsPerStrip, layout.strip_rows)?;
    directory.write_tag(Tag::StripByteCounts, &counts[..])?;
    directory.write_tag(Tag::PlanarConfiguration, CHUNKY)?;
    directory.write_tag(Tag::Predictor, FLOATING_POINT_PREDICTOR)?;
    if bands > 1 {
        directory.write_tag(Tag::ExtraSamples, &vec![0_u16; bands - 1][..])?;
    }
    directory.write_tag(Tag::SampleFormat, &vec![IEEE_FLOAT; bands][..])?;
    let here = &layout.georeference;
    for (code, doubles) in [
        (33550, &here.scale),
        (33922, &here.tie_points),
        (34264, &here.transformation),
        (34736, &here.key_doubles),
    ] {
        if !doubles.is_empty() {
            directory.write_tag(tag(code), &doubles[..])?;
        }
    }
    if !here.keys.is_empty() {
        directory.write_tag(tag(34735), &here.keys[..])?;
    }
    if !here.key_texts.is_empty() {
        directory.write_tag(tag(34737), here.key_texts.as_str())?;
    }
    directory.write_tag(tag(42112), layout.metadata.as_str())?;
    directory.write_tag(Tag::GdalNodata, "nan")?;
    directory.finish()?;
    Ok(())
}
