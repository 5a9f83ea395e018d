//! Where a GeoTIFF lies on the ground.

use std::io::{BufRead, Seek};

use tiff::decoder::Decoder;
use tiff::tags::Tag;

use crate::terrain_fault::{NoCell, TerrainFault};

/// GeoTIFF's keys: the model type with its values, where in a cell its coordinates are, and the units of coordinates and of heights.
const MODEL_TYPE_KEY: u32 = 1024;
const PROJECTED: u32 = 1;
const GEOGRAPHIC: u32 = 2;
const RASTER_TYPE_KEY: u32 = 1025;
const PIXEL_IS_POINT: u32 = 2;
const LINEAR_UNITS_KEY: u32 = 3076;
const VERTICAL_UNITS_KEY: u32 = 4099;
/// EPSG's code of the metre.
const METRE: u32 = 9001;

/// The tags that place an image on the ground, as the file has them; empty where it has none.
///
/// ```
/// use grouser_rover::ground::Georeference;
///
/// // cells of 2 m, the outer corner of the upper left one at (100, 50)
/// let here = Georeference::of_grid(2.0, [100.0, 50.0]);
/// assert_eq!(here.cell_without_system(), Ok(2.0));
/// assert_eq!(here.centre(0, 0), Some([101.0, 49.0]));
/// assert!(!here.has_system());
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Georeference {
    /// ModelPixelScaleTag (33550).
    pub scale: Vec<f64>,
    /// ModelTiepointTag (33922).
    pub tie_points: Vec<f64>,
    /// ModelTransformationTag (34264).
    pub transformation: Vec<f64>,
    /// GeoKeyDirectoryTag (34735).
    pub keys: Vec<u16>,
    /// GeoDoubleParamsTag (34736).
    pub key_doubles: Vec<f64>,
    /// GeoAsciiParamsTag (34737), without its final zero.
    pub key_texts: String,
}

impl Georeference {
    /// Cells of `cell` (m) whose upper left one has its outer corner at `corner` (m), in no coordinate system.
    #[must_use]
    pub fn of_grid(cell: f64, [x, y]: [f64; 2]) -> Self {
        Self {
            scale: vec![cell, cell, 0.0],
            tie_points: vec![0.0, 0.0, 0.0, x, y, 0.0],
            ..Self::default()
        }
    }

    pub(super) fn of<R: BufRead + Seek>(decoder: &mut Decoder<R>) -> Self {
        let mut doubles = |tag| decoder.get_tag_f64_vec(tag).unwrap_or_default();
        Self {
            scale: doubles(Tag::ModelPixelScaleTag),
            tie_points: doubles(Tag::ModelTiepointTag),
            transformation: doubles(Tag::ModelTransformationTag),
            key_doubles: doubles(Tag::GeoDoubleParamsTag),
            keys: decoder
                .get_tag_u16_vec(Tag::GeoKeyDirectoryTag)
                .unwrap_or_default(),
            key_texts: decoder
                .get_tag_ascii_string(Tag::GeoAsciiParamsTag)
                .map(|text| text.trim_end_matches('\0').to_owned())
                .unwrap_or_default(),
        }
    }

    /// A key of the coordinate system that is a whole number.
    fn key(&self, wanted: u32) -> Option<u32> {
        let mut entries = self.keys.chunks_exact(4).skip(1);
        let found = entries.find(|entry| u32::from(entry[0]) == wanted && entry[1] == 0);
        found.map(|entry| entry[3].into())
    }

    /// EPSG's code of the unit of heights, where the file names one.
    #[must_use]
    pub fn height_unit(&self) -> Option<u32> {
        self.key(VERTICAL_UNITS_KEY)
    }

    /// Does the file name a coordinate system?
    #[must_use]
    pub fn has_system(&self) -> bool {
        matches!(self.key(MODEL_TYPE_KEY), Some(PROJECTED | GEOGRAPHIC))
    }

    /// The size of a cell, m.
    ///
    /// # Errors
    /// [`TerrainFault::NoCell`]: no coordinate system, degrees, another unit than metres, no scale, cells that are no squares.
    pub fn cell(&self) -> Result<f64, TerrainFault> {
        if self.has_system() {
            self.cell_without_system()
        } else {
            Err(TerrainFault::NoCell {
                why: NoCell::NoSystem,
            })
        }
    }

    /// As [`Georeference::cell`], but coordinates in no system count as metres.
    ///
    /// # Errors
    /// As [`Georeference::cell`].
    pub fn cell_without_system(&self) -> Result<f64, TerrainFault> {
        let none = |why| Err(TerrainFault::NoCell { why });
        if self.key(MODEL_TYPE_KEY) == Some(GEOGRAPHIC) {
            return none(NoCell::Degrees);
        }
        if let Some(code) = self.key(LINEAR_UNITS_KEY).filter(|code| *code != METRE) {
            return none(NoCell::Unit { code });
        }
        let [width, height] = match self.scale.as_slice() {
            [width, height, ..] => [*width, *height],
            // rows of a 4 x 4 matrix from column and row to x and y
            _ => match self.transformation.as_slice() {
                [a, b, _, _, d, e, ..] if *b == 0.0 && *d == 0.0 => [a.abs(), e.abs()],
                [_, _, _, _, _, _, ..] => return none(NoCell::Turned),
                _ => return none(NoCell::NoScale),
            },
        };
        if !((width - height).abs() <= 1e-9 * width.abs()) {
            return none(NoCell::NotSquare { width, height });
        }
        Ok(width)
    }

    /// The coordinates of the centre of a cell; `None` where the file places none.
    #[must_use]
    pub fn centre(&self, column: u32, row: u32) -> Option<[f64; 2]> {
        let half = if self.key(RASTER_TYPE_KEY) == Some(PIXEL_IS_POINT) {
            0.0
        } else {
            0.5
        };
        let (column, row) = (f64::from(column) + half, f64::from(row) + half);
        match (self.scale.as_slice(), self.tie_points.as_slice()) {
            ([width, height, ..], [i, j, _, x, y, ..]) => {
                Some([x + (column - i) * width, y - (row - j) * height])
            }
            _ => match self.transformation.as_slice() {
                [a, b, _, x, d, e, _, y, ..] => {
                    Some([a * column + b * row + x, d * column + e * row + y])
                }
                _ => None,
            },
        }
    }
}
