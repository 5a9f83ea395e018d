//! What is wrong with a terrain, a robot on it, or a map.

use std::io;
use std::path::PathBuf;

use grouser_rover::ground::TerrainFault;
use grouser_terra::OutOfRange;

/// The result of everything that checks its input.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// A terrain, a robot or a map that cannot be used.
///
/// ```
/// use grouser_terrain::{Error, Headings};
///
/// let error = Headings::new(7).unwrap_err();
/// assert!(matches!(error, Error::OutOfRange { .. }));
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number lies outside its limits (NaN always does).
    #[error("{of}: {range}")]
    OutOfRange {
        /// What it belongs to.
        of: String,
        /// The number and its limits.
        range: OutOfRange,
    },
    /// A terrain file that cannot be used.
    #[error("{}: {fault}", .file.display())]
    Terrain {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        fault: TerrainFault,
    },
    /// A file that cannot be read or written.
    #[error("cannot {action} {}: {source}", .file.display())]
    File {
        /// What was tried.
        action: &'static str,
        /// The file.
        file: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// A file that is no slip map.
    #[error("{} is no slip map: {reason}", .file.display())]
    NotAMap {
        /// The file.
        file: PathBuf,
        /// Why not.
        reason: String,
    },
    /// The robot does not stand on the level as its description poses it.
    #[error(
        "robot \"{name}\" is not stable on level ground: a wheel carries {load} N, but must carry at least 0 N"
    )]
    DoesNotStand {
        /// The robot.
        name: String,
        /// The least load, N.
        load: f64,
    },
    /// The robot cannot pull itself on the level.
    #[error(
        "robot \"{name}\" does not move on this soil, not even on level ground (soil draw {draw})"
    )]
    DoesNotMove {
        /// The robot.
        name: String,
        /// Number of the soil draw; 0 is the soil itself.
        draw: usize,
    },
    /// A relief, a robot or a soil that is not the one a map was made for.
    #[error("{of} is not the map's: its {field} is {value}, the map's is {limit}")]
    OtherMap {
        /// What is not the map's.
        of: &'static str,
        /// In what it differs.
        field: String,
        /// Its own, with its unit.
        value: String,
        /// The map's.
        limit: String,
    },
    /// A start or a goal that cannot be one.
    // `Debug` writes 1e300 without its zeros
    #[error("{of} ({x:?}, {y:?}) {why}")]
    Place {
        /// Which.
        of: &'static str,
        /// m.
        x: f64,
        /// m.
        y: f64,
        /// What is wrong with it.
        why: String,
    },
    /// The soil has no draw that its laws accept.
    #[error("soil draws: no legal value of {field} was found in {tries} tries")]
    NoDraw {
        /// The number.
        field: &'static str,
        /// How often it was tried.
        tries: u32,
    },
    /// A scenario that does not plan its way.
    #[error("the scenario has no [plan]")]
    NoPlan,
    /// A raster of soils has a class that its legend does not list.
    #[error("{}: row {row}, column {column} (from 0) has class {value}, which the legend does not list", .file.display())]
    NoClass {
        /// The raster.
        file: PathBuf,
        /// The class.
        value: f32,
        /// From the upper edge.
        row: u32,
        /// From the left edge.
        column: u32,
    },
    /// A legend gives one class to two soils.
    #[error("soil map: class {class} is given to \"{}\" and to \"{}\"", .names[0], .names[1])]
    TwoSoils {
        /// The class.
        class: u32,
        /// The soils.
        names: [String; 2],
    },
    /// The laws of wheel and soil refuse a number.
    #[error("{of}: {source}")]
    Law {
        /// Of which wheel or soil.
        of: String,
        /// What they report.
        source: grouser_terra::Error,
    },
    /// One of our own files.
    #[error(transparent)]
    OwnFile(#[from] grouser_files::Error),
    /// The robot's or the terrain's library refuses something.
    #[error(transparent)]
    Rover(#[from] grouser_rover::Error),
}

impl Error {
    pub(crate) fn check(
        of: &str,
        field: &'static str,
        value: f64,
        limits: (f64, f64),
        unit: &'static str,
    ) -> Result<()> {
        OutOfRange::check(field, value, limits, unit).map_err(|range| Self::OutOfRange {
            of: of.to_owned(),
            range,
        })
    }

    /// What to do about it, where that is known.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::OwnFile(error) => error.hint(),
            Self::Rover(error) => error.hint(),
            Self::Terrain { fault, .. } => fault.hint().map(str::to_owned),
            Self::OtherMap { .. } => Some(
                "give what the map was made with, or make another map with `grouser map`"
                    .to_owned(),
            ),
            _ => None,
        }
    }
}
