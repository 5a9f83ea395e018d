//! The heights of a GeoTIFF, m: every tag that changes their meaning is applied, or the file is refused.
//!
//! Source: the OGC GeoTIFF standard 1.1; GDAL's documentation of its metadata (tag 42112): `SCALE`, `OFFSET` and
//! `UNITTYPE` of a band.

use std::io::{BufRead, Seek};

use grouser_terra::OutOfRange;

use super::georeference::Georeference;
use super::geotiff::GeoTiff;
use super::{HEIGHT_LIMITS_M, UndeclaredNoData};
use crate::terrain_fault::{HEIGHTS_TO_METRES, TerrainFault};

type Fault<T> = Result<T, TerrainFault>;

/// GDAL's metadata: XML.
const METADATA_TAG: u16 = 42_112;
/// Names of the metre, in lower case, as GDAL and others write them.
const METRES: [&str; 6] = ["", "m", "metre", "metres", "meter", "meters"];

/// A GeoTIFF of heights, read some rows at a time.
///
/// ```
/// use std::io::Cursor;
/// use grouser_rover::ground::HeightTiff;
///
/// assert!(HeightTiff::open(Cursor::new(b"no TIFF".to_vec()), None).is_err());
/// ```
pub struct HeightTiff<R: BufRead + Seek> {
    tiff: GeoTiff<R>,
    cell: f64,
    numbers: Numbers,
    undeclared: Option<UndeclaredNoData>,
}

impl<R: BufRead + Seek> HeightTiff<R> {
    /// Opens a file; `cell` (m) is its size of cells on the ground in place of the file's own.
    ///
    /// # Errors
    /// What the file lacks or lies about; a tag after which its numbers are not heights in metres, upwards, on cells
    /// of metres true to scale. No cell is decoded.
    pub fn open(reader: R, cell: Option<f64>) -> Fault<Self> {
        let mut tiff = GeoTiff::open(reader)?;
        if tiff.bands() != 1 {
            return Err(TerrainFault::Samples {
                found: format!("{} bands", tiff.bands()),
                wanted: "one band of heights",
            });
        }
        tiff.check_mask()?;
        let numbers = Numbers::from_metadata(&tiff.text(METADATA_TAG).unwrap_or_default())?;
        let georeference = tiff.georeference();
        georeference.check_heights()?;
        georeference.check_orientation()?;
        let cell = match cell {
            Some(cell) => cell,
            None => georeference.cell(tiff.size())?,
        };
        Ok(Self {
            tiff,
            cell,
            numbers,
            undeclared: None,
        })
    }

    /// Columns and rows.
    #[must_use]
    pub const fn size(&self) -> (u32, u32) {
        self.tiff.size()
    }

    /// Size of a cell, m.
    #[must_use]
    pub const fn cell(&self) -> f64 {
        self.cell
    }

    /// Where it lies.
    #[must_use]
    pub const fn georeference(&self) -> &Georeference {
        self.tiff.georeference()
    }

    /// What was read as unknown so far, although the file does not declare it.
    #[must_use]
    pub const fn undeclared(&self) -> Option<UndeclaredNoData> {
        self.undeclared
    }

    /// Rows of a piece, but for the lowest ones.
    #[must_use]
    pub const fn piece_height(&self) -> u32 {
        self.tiff.piece_height()
    }

    /// Appends the rows of all pieces side by side that begin at row `top`, NaN where no height is known; gives the
    /// row after them.
    ///
    /// # Errors
    /// A piece that is damaged or has another size than the file says; a height that no ground has.
    pub fn read_rows(&mut self, top: u32, heights: &mut Vec<f32>) -> Fault<u32> {
        let Self {
            tiff,
            numbers,
            undeclared,
            ..
        } = self;
        let (across, columns) = (tiff.pieces_across(), tiff.size().0 as usize);
        let first = top / tiff.piece_height() * across;
        let high = tiff.place(first).high;
        let start = heights.len();
        heights.resize(start + high as usize * columns, f32::NAN);
        let mut beyond = None;
        for index in first..first + across {
            let place = tiff.place(index);
            let mut cells = (0..place.cells()).map(|i| {
                let (row, column) = (i / place.wide as usize, i % place.wide as usize);
                start + row * columns + place.left as usize + column
            });
            tiff.read_piece(index, |value| {
                let Some(slot) = cells.next().and_then(|cell| heights.get_mut(cell)) else {
                    return;
                };
                if UndeclaredNoData::is_one(value.into()) {
                    UndeclaredNoData::count(undeclared, value.into());
                } else if !value.is_nan() {
                    let height = numbers.height(value);
                    let (low, high) = HEIGHT_LIMITS_M;
                    if !(low..=high).contains(&height) {
                        beyond = Some(height);
                    }
                    *slot = height;
                }
            })?;
        }
        if let Some(height) = beyond {
            OutOfRange::check("height", height.into(), height_limits(), "m")?;
        }
        Ok(top + high)
    }
}

fn height_limits() -> (f64, f64) {
    let (low, high) = HEIGHT_LIMITS_M;
    (low.into(), high.into())
}

/// What turns the numbers of the file into heights.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Numbers {
    scale: f64,
    offset: f64,
}

impl Numbers {
    fn height(self, value: f32) -> f32 {
        #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
        let height = (f64::from(value) * self.scale + self.offset) as f32;
        height
    }

    /// Of the first band.
    fn from_metadata(metadata: &str) -> Fault<Self> {
        let refused = |tag, value: &str, why| TerrainFault::Tag {
            tag,
            value: TerrainFault::shown(value),
            why,
            convert: HEIGHTS_TO_METRES,
        };
        let mut numbers = Self {
            scale: 1.0,
            offset: 0.0,
        };
        for item in metadata.split("<Item ").skip(1) {
            let Some((head, rest)) = item.split_once('>') else {
                continue;
            };
            let text = rest
                .split_once("</Item>")
                .map_or("", |(text, _)| text)
                .trim();
            let attribute = |name: &str| {
                let (_, value) = head.split_once(&format!("{name}=\""))?;
                value.split_once('"').map(|(value, _)| value)
            };
            // GDAL writes the role, and the name of the band's item in capitals
            let name = attribute("role").or_else(|| attribute("name"));
            if attribute("sample").is_some_and(|sample| sample != "0") {
                continue;
            }
            let (tag, place) = match name.unwrap_or_default().to_ascii_lowercase().as_str() {
                "scale" => ("SCALE of GDAL_METADATA (42112)", &mut numbers.scale),
                "offset" => ("OFFSET of GDAL_METADATA (42112)", &mut numbers.offset),
                "unittype" if !METRES.contains(&text.to_ascii_lowercase().as_str()) => {
                    let why = "its heights are not in metres";
                    return Err(refused("UNITTYPE of GDAL_METADATA (42112)", text, why));
                }
                _ => continue,
            };
            let number = text.parse().ok().filter(|number: &f64| number.is_finite());
            *place = number.ok_or_else(|| refused(tag, text, "that is not a number"))?;
        }
        Ok(numbers)
    }
}
