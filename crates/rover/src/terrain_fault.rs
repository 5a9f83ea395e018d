//! What is wrong with a terrain file.

use grouser_terra::OutOfRange;

/// What is wrong with a terrain file, with the value that it has and the limit that it passes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TerrainFault {
    /// Its ending names no kind of file that is read.
    #[error("a height map ends in .png, .asc, .txt, .grd, .tif or .tiff")]
    Kind,
    /// It has more bytes than are read.
    #[error("it has more than {limit} bytes, which is the most that is read")]
    TooManyBytes {
        /// bytes.
        limit: u64,
    },
    /// It announces more or fewer cells than a map holds.
    #[error(
        "it is {columns} x {rows} cells, but at least 2 x 2 and at most {limit} cells are read"
    )]
    Cells {
        /// Across.
        columns: u64,
        /// Down.
        rows: u64,
        /// Cells in all.
        limit: u64,
    },
    /// A number lies outside its limits (NaN always does).
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// There are more or fewer of something than the file announces.
    #[error("it has {found} {field}, but its size requires {expected}")]
    Count {
        /// Of what.
        field: &'static str,
        /// How many there are.
        found: u64,
        /// How many there should be.
        expected: u64,
    },
    /// It lacks something.
    #[error("it lacks {field}")]
    Missing {
        /// What it lacks.
        field: &'static str,
    },
    /// It does not tell the size of its cells in metres; why, stands in `why`.
    #[error("{why}: `cell_m` must give the size of its cells")]
    NoCell {
        /// Why the file's own size is none.
        why: NoCell,
    },
    /// A word is no number.
    #[error("`{word}` is no number (row {row}, column {column})")]
    NotANumber {
        /// The word, or its beginning.
        word: String,
        /// Its row among the heights, from 1; 0 in the header.
        row: u64,
        /// Its place in the row, from 1.
        column: u64,
    },
    /// A word of the header is not known.
    #[error("`{word}` is no header of an ASCII grid")]
    Header {
        /// The word, or its beginning.
        word: String,
    },
    /// Its numbers are of a kind that is not heights.
    #[error("its cells are {found}; {wanted} is read")]
    Samples {
        /// What they are.
        found: String,
        /// What is read.
        wanted: &'static str,
    },
    /// A tag states what cannot be read as heights in metres.
    #[error("its {tag} is {value}: {why}")]
    Tag {
        /// Its name.
        tag: &'static str,
        /// Its value.
        value: String,
        /// Why it is refused.
        why: &'static str,
        /// How to convert the file.
        convert: &'static str,
    },
    /// A file next to it changes what its numbers mean.
    #[error("`{file}` next to it states {states}, which is not read")]
    Beside {
        /// The name of that file.
        file: String,
        /// What it states.
        states: String,
        /// How to convert the elevation model.
        convert: &'static str,
    },
    /// It is cut short, or damaged, or uses what is not read.
    #[error("it cannot be decoded: {reason}")]
    Damaged {
        /// What the decoder says.
        reason: String,
    },
}

/// Why a file's own size of cells is none in metres.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoCell {
    /// A picture says nothing of sizes.
    #[error("a picture does not say how large it is")]
    Picture,
    /// It names no coordinate system.
    #[error("it names no coordinate system by ProjectedCRSGeoKey (3072)")]
    NoSystem,
    /// Its coordinates are degrees.
    #[error("GTModelTypeGeoKey (1024) is 2: its coordinates are degrees")]
    Degrees,
    /// An ASCII grid whose cells and corner are those of degrees.
    #[error("cells of {cell} with a corner within 180 by 90 look like degrees")]
    LooksLikeDegrees {
        /// As it stands in the file.
        cell: f64,
    },
    /// Its coordinates are in another unit of length.
    #[error("ProjLinearUnitsGeoKey (3076) is {code}: its coordinates are not in metres (9001)")]
    Unit {
        /// The EPSG code of the unit.
        code: u32,
    },
    /// It has no scale.
    #[error("it has no pixel scale")]
    NoScale,
    /// Its cells are no squares.
    #[error("its cells are {width} m by {height} m, not square")]
    NotSquare {
        /// m.
        width: f64,
        /// m.
        height: f64,
    },
    /// It does not state where it is, and its scale depends on the place.
    #[error(
        "it has no ModelTiepointTag (33922), and the scale of its coordinate system depends on the place"
    )]
    NoPlace,
    /// Its coordinate system is not known to be in metres that are true to scale.
    #[error(
        "ProjectedCRSGeoKey (3072) is {code}, which is not known to be in metres that are true to scale on the ground"
    )]
    System {
        /// The EPSG code of the system.
        code: u32,
    },
    /// The scale of its projection is not computed.
    #[error(
        "ProjMethodGeoKey (3075) is {code}, a projection whose scale on the ground is not computed"
    )]
    Method {
        /// GeoTIFF's code of the method.
        code: u32,
    },
    /// Its coordinates are not true to scale.
    #[error("{tag} is {code}: 1 m on the ground is {low:.4} m to {high:.4} m of its coordinates")]
    Scale {
        /// The name of the key.
        tag: &'static str,
        /// Its value.
        code: u32,
        /// Smallest scale.
        low: f64,
        /// Largest scale.
        high: f64,
    },
}

/// How to convert heights.
pub(crate) const HEIGHTS_TO_METRES: &str = "convert its heights to metres first, for example from feet by \
    `gdal_translate -scale 0 10000 0 3048 -ot Float32 in.tif out.tif` and `gdal_edit.py -units m out.tif`";

impl TerrainFault {
    /// What to do about it, where that is known.
    #[must_use]
    pub const fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Tag { convert, .. } | Self::Beside { convert, .. } => Some(convert),
            Self::NoCell { why } => Some(match why {
                NoCell::Picture | NoCell::NoSystem | NoCell::NoScale | NoCell::NotSquare { .. } => {
                    "`--cell-m`, or `cell_m` in a scenario, gives the size of its cells on the ground"
                }
                NoCell::Degrees
                | NoCell::LooksLikeDegrees { .. }
                | NoCell::Unit { .. }
                | NoCell::NoPlace
                | NoCell::System { .. }
                | NoCell::Method { .. }
                | NoCell::Scale { .. } => {
                    "project it first to metres that are true to scale, for example to the UTM zone of its place by \
                     `gdalwarp -r bilinear -t_srs EPSG:32632 in.tif out.tif`"
                }
            }),
            Self::Samples { .. } => Some(
                "`gdal_translate -b 1 -ot Float32 in.tif out.tif` writes its first band as floats",
            ),
            _ => None,
        }
    }

    /// What a decoder says.
    #[allow(
        clippy::needless_pass_by_value,
        reason = "it is in `map_err`, which gives values"
    )]
    pub(super) fn damaged(reason: impl ToString) -> Self {
        let mut reason = reason.to_string();
        if reason.len() > 200 {
            let end = (0..=200).rev().find(|end| reason.is_char_boundary(*end));
            reason.truncate(end.unwrap_or(0));
        }
        Self::Damaged { reason }
    }

    /// The beginning of a word, for a message.
    pub(super) fn shown(word: &str) -> String {
        word.chars().take(40).collect()
    }
}
