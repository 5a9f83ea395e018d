//! Where a GeoTIFF lies on the ground.

use std::io::{BufRead, Seek};

use tiff::decoder::Decoder;
use tiff::tags::Tag;

use super::epsg::HEIGHTS_IN_METRES;
use super::projection::{check_scale, is_listed};
use crate::terrain_fault::{HEIGHTS_TO_METRES, NoCell, TerrainFault};

/// GeoTIFF's keys: the model type with its values, where in a cell its coordinates are, the coordinate systems, and
/// the units of coordinates and of heights.
const MODEL_TYPE_KEY: u32 = 1024;
const PROJECTED: u32 = 1;
const GEOGRAPHIC: u32 = 2;
const RASTER_TYPE_KEY: u32 = 1025;
const PIXEL_IS_POINT: u32 = 2;
const LINEAR_UNITS_KEY: u32 = 3076;
const VERTICAL_SYSTEM_KEY: u32 = 4096;
const VERTICAL_UNITS_KEY: u32 = 4099;
/// GeoTIFF's code for what the file describes itself.
pub(super) const USER_DEFINED: u32 = 32_767;
/// EPSG's code of the metre.
const METRE: u32 = 9001;
/// GeoTIFF's tag of numbers of the coordinate system, which its keys refer to.
pub(super) const KEY_DOUBLES_TAG: u16 = 34_736;
/// Relative difference of the sides of a square cell: rounding of the file.
const MAX_SIDE_DIFFERENCE: f64 = 1e-9;

/// The tags that place an image on the ground, as the file has them; empty where it has none.
///
/// ```
/// use grouser_rover::ground::Georeference;
///
/// // cells of 2 m, the outer corner of the upper left one at (100, 50)
/// let here = Georeference::of_grid(2.0, [100.0, 50.0]);
/// assert_eq!(here.centre(0, 0), Some([101.0, 49.0]));
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

    pub(super) fn from_decoder<R: BufRead + Seek>(decoder: &mut Decoder<R>) -> Self {
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

    /// The entry of a key: where its value is, and the value or its index there.
    fn entry(&self, wanted: u32) -> Option<[u16; 2]> {
        let mut entries = self.keys.chunks_exact(4).skip(1);
        let found = entries.find(|entry| u32::from(entry[0]) == wanted);
        found.map(|entry| [entry[1], entry[3]])
    }

    /// A key of the coordinate system that is a whole number.
    pub(super) fn key(&self, wanted: u32) -> Option<u32> {
        let [held, value] = self.entry(wanted)?;
        (held == 0).then_some(value.into())
    }

    /// A key of the coordinate system that is a number.
    pub(super) fn number(&self, wanted: u32) -> Option<f64> {
        let [held, index] = self.entry(wanted)?;
        let found = self.key_doubles.get(usize::from(index)).copied();
        found.filter(|_| held == KEY_DOUBLES_TAG)
    }

    /// Refuses heights that are not metres upwards.
    pub(super) fn check_heights(&self) -> Result<(), TerrainFault> {
        let refused = |tag, code: u32, why| TerrainFault::Tag {
            tag,
            value: code.to_string(),
            why,
            convert: HEIGHTS_TO_METRES,
        };
        if let Some(code) = self.key(VERTICAL_UNITS_KEY).filter(|code| *code != METRE) {
            let why = "its heights are not in metres (9001)";
            return Err(refused("VerticalUnitsGeoKey (4099)", code, why));
        }
        let system = self.key(VERTICAL_SYSTEM_KEY);
        let odd =
            system.filter(|code| *code != USER_DEFINED && !is_listed(&HEIGHTS_IN_METRES, *code));
        odd.map_or(Ok(()), |code| {
            let why = "that system is not known to have metres upwards";
            Err(refused("VerticalGeoKey (4096)", code, why))
        })
    }

    /// Refuses images whose columns do not run to the east, or rows not to the south.
    pub(super) fn check_orientation(&self) -> Result<(), TerrainFault> {
        let straight = match (self.scale.as_slice(), self.transformation.as_slice()) {
            ([width, height, ..], _) => !(*width < 0.0 || *height < 0.0),
            (_, [a, b, _, _, d, e, ..]) => *b == 0.0 && *d == 0.0 && !(*a < 0.0 || *e > 0.0),
            _ => true,
        };
        if straight {
            return Ok(());
        }
        Err(TerrainFault::Tag {
            tag: if self.scale.is_empty() {
                "ModelTransformationTag (34264)"
            } else {
                "ModelPixelScaleTag (33550)"
            },
            value: "turned or mirrored".into(),
            why: "its columns must run to the east and its rows to the south",
            convert: "`gdalwarp -r bilinear in.tif out.tif` turns it",
        })
    }

    /// The size of a cell of an image of `size` columns and rows, m.
    ///
    /// # Errors
    /// [`TerrainFault::NoCell`]: no coordinate system, degrees, another unit than metres, a projection that is not true to
    /// scale there, no scale, cells that are not square.
    pub fn cell(&self, size: (u32, u32)) -> Result<f64, TerrainFault> {
        self.metres(size)
            .map_err(|why| TerrainFault::NoCell { why })
    }

    fn metres(&self, size: (u32, u32)) -> Result<f64, NoCell> {
        match self.key(MODEL_TYPE_KEY) {
            Some(PROJECTED) => {}
            Some(GEOGRAPHIC) => return Err(NoCell::Degrees),
            _ => return Err(NoCell::NoSystem),
        }
        if let Some(code) = self.key(LINEAR_UNITS_KEY).filter(|code| *code != METRE) {
            return Err(NoCell::Unit { code });
        }
        let [width, height] = match (self.scale.as_slice(), self.transformation.as_slice()) {
            ([width, height, ..], _) => [*width, *height],
            // rows of a 4 x 4 matrix from column and row to x and y
            (_, [a, _, _, _, _, e, ..]) => [a.abs(), e.abs()],
            _ => return Err(NoCell::NoScale),
        };
        if !((width - height).abs() <= MAX_SIDE_DIFFERENCE * width.abs()) {
            return Err(NoCell::NotSquare { width, height });
        }
        check_scale(self, size)?;
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
