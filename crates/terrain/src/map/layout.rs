//! What a map's file holds beside its cells.

use std::collections::BTreeMap;
use std::fmt::Write as _; // writing to a string cannot fail

use grouser_files::soil::{SoilFile, to_toml};
use grouser_rover::ground::Georeference;
use grouser_rover::robot::RobotModel;
use grouser_terra::Soil;

use super::bands::{Band, Quantity};
use crate::error::{Error, Result};
use crate::headings::Headings;
use crate::raster::{Dem, RasterLayout};
use crate::table::Envelope;

/// Greatest size of a strip before it is packed, bytes: memory holds one for each thread.
const MAX_STRIP_BYTES: usize = 4 << 20;
/// The level of the CVaR unless another one is given: the mean of the worst tenth of the draws.
const CVAR_LEVEL: f64 = 0.9;
const MAX_STRIP_ROWS: usize = 64;
/// A number of this version in every map; another one is refused.
pub(crate) const VERSION: &str = "4";

/// What a map is made for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MapSettings {
    /// The directions.
    pub headings: Headings,
    /// The poses that are computed.
    pub envelope: Envelope,
    /// The share of the soil draws beyond which [`Quantity::EnergyCvar`] is the mean.
    pub cvar_level: f64,
}

impl MapSettings {
    /// Settings.
    #[must_use]
    pub const fn new(headings: Headings, envelope: Envelope) -> Self {
        Self {
            headings,
            envelope,
            cvar_level: CVAR_LEVEL,
        }
    }

    /// The same with another level of the CVaR.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] outside [0, 0.999]; 0 is the mean of all draws.
    pub fn with_cvar_level(self, cvar_level: f64) -> Result<Self> {
        Error::check("map", "CVaR level", cvar_level, (0.0, 0.999), "1")?;
        Ok(Self { cvar_level, ..self })
    }
}

/// The size of a map, where it lies, and what a planner needs of the robot.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MapLayout {
    /// Cells of a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Size of a cell, m.
    pub cell: f64,
    /// The directions.
    pub headings: Headings,
    /// Where it lies.
    pub georeference: Georeference,
    /// The robot's name.
    pub robot: String,
    /// The least radius on which the robot's middle turns, m; 0: it turns on the spot.
    pub turning_radius: f64,
    /// Radius of its smallest wheel, m; infinite where the map does not hold it.
    pub wheel_radius: f64,
    /// Gravity that the robot is under, m/s².
    pub gravity: f64,
    /// Soil draws behind the probabilities; 0: the soil is taken for exactly known.
    pub draws: u32,
    /// The level of [`Quantity::EnergyCvar`].
    pub cvar_level: f64,
    /// The names of the soils, by [`Quantity::Soil`].
    pub soils: Vec<String>,
    /// Numbers and laws of the first of them, as a soil file has them; empty where the map does not hold them.
    pub soil_numbers: String,
    /// SHA-256 of everything that the map was computed from, as hexadecimal digits.
    pub job: String,
}

impl MapLayout {
    /// The map of an elevation model.
    #[must_use]
    pub fn new(dem: &Dem, model: &RobotModel, headings: Headings, draws: usize, job: &str) -> Self {
        let (columns, rows) = dem.size();
        Self {
            georeference: dem.georeference().clone(),
            draws: u32::try_from(draws).unwrap_or(u32::MAX),
            job: job.to_owned(),
            ..Self::plain(columns, rows, dem.cell(), headings).of_robot(model)
        }
    }

    /// The same for a robot.
    #[must_use]
    pub fn of_robot(self, model: &RobotModel) -> Self {
        Self {
            robot: model.robot.name().to_owned(),
            turning_radius: turning_radius(model),
            wheel_radius: model
                .wheels
                .iter()
                .map(|mount| mount.wheel.radius())
                .fold(f64::INFINITY, f64::min),
            gravity: model.gravity(),
            ..self
        }
    }

    /// The same for a soil, under its name: a key of the catalogue or a soil file.
    #[must_use]
    pub fn of_soil(self, name: &str, soil: &Soil) -> Self {
        let file = SoilFile::new("", "", *soil.params());
        Self {
            soils: vec![name.to_owned()],
            // soil files have no keys for Reece's moduli
            soil_numbers: to_toml(&file, &[]).unwrap_or_default(),
            ..self
        }
    }

    /// A map of this size, of a robot that turns on the spot, at no particular place: for maps that are made by hand.
    #[must_use]
    pub fn plain(columns: u32, rows: u32, cell: f64, headings: Headings) -> Self {
        Self {
            columns,
            rows,
            cell,
            headings,
            georeference: Georeference::of_grid(cell, [0.0, cell * f64::from(rows)]),
            robot: String::new(),
            turning_radius: 0.0,
            wheel_radius: f64::INFINITY,
            gravity: grouser_terra::EARTH_GRAVITY_M_PER_S2,
            draws: 0,
            cvar_level: CVAR_LEVEL,
            soils: Vec::new(),
            soil_numbers: String::new(),
            job: String::new(),
        }
    }

    /// The place of the centre of a cell, m: from the lower left corner of the map where the file gives none.
    #[must_use]
    pub fn place_of(&self, column: u32, row: u32) -> [f64; 2] {
        self.georeference.centre(column, row).unwrap_or([
            (f64::from(column) + 0.5) * self.cell,
            (f64::from(self.rows) - f64::from(row) - 0.5) * self.cell,
        ])
    }

    /// Bands of its file.
    #[must_use]
    pub const fn bands(&self) -> usize {
        Band::count(self.headings)
    }

    /// Rows of a strip, the unit in which a map is computed, stored and resumed.
    #[must_use]
    pub fn strip_rows(&self) -> u32 {
        let row = self.columns as usize * self.bands() * size_of::<f32>();
        u32::try_from((MAX_STRIP_BYTES / row.max(1)).clamp(1, MAX_STRIP_ROWS)).unwrap_or(1)
    }

    /// Strips in all.
    #[must_use]
    pub fn strips(&self) -> u32 {
        self.rows.div_ceil(self.strip_rows())
    }

    /// Rows of a strip.
    #[must_use]
    pub fn rows_of(&self, strip: u32) -> std::ops::Range<u32> {
        let first = strip * self.strip_rows();
        first..self.rows.min(first + self.strip_rows())
    }

    /// The file's layout.
    #[must_use]
    pub(crate) fn raster(&self) -> RasterLayout {
        RasterLayout {
            columns: self.columns,
            rows: self.rows,
            bands: u16::try_from(self.bands()).unwrap_or(u16::MAX),
            strip_rows: self.strip_rows(),
            georeference: self.georeference.clone(),
            metadata: self.metadata(),
        }
    }

    fn metadata(&self) -> String {
        let mut out = String::from("<GDALMetadata>\n");
        for (name, value) in [
            ("GROUSER_MAP", VERSION.to_owned()),
            ("GROUSER_HEADINGS", self.headings.count().to_string()),
            ("GROUSER_CELL_M", format!("{}", self.cell)),
            ("GROUSER_ROBOT", escaped(&self.robot)),
            (
                "GROUSER_TURNING_RADIUS_M",
                format!("{}", self.turning_radius),
            ),
            ("GROUSER_WHEEL_RADIUS_M", format!("{}", self.wheel_radius)),
            ("GROUSER_GRAVITY_M_PER_S2", format!("{}", self.gravity)),
            ("GROUSER_SOIL_DRAWS", self.draws.to_string()),
            ("GROUSER_CVAR_LEVEL", format!("{}", self.cvar_level)),
            ("GROUSER_JOB_SHA256", self.job.clone()),
            ("GROUSER_SOIL_NUMBERS", escaped(&self.soil_numbers)),
        ] {
            let _ = writeln!(out, "  <Item name=\"{name}\">{value}</Item>");
        }
        for (index, name) in self.soils.iter().enumerate() {
            let name = escaped(name);
            let _ = writeln!(out, "  <Item name=\"GROUSER_SOIL_{index}\">{name}</Item>");
        }
        for quantity in Quantity::ALL {
            for heading in 0..self.headings.count() {
                let band = Band { quantity, heading };
                let _ = writeln!(
                    out,
                    "  <Item name=\"DESCRIPTION\" sample=\"{}\" role=\"description\">{}</Item>",
                    band.index(self.headings),
                    band.name(self.headings)
                );
            }
        }
        out.push_str("</GDALMetadata>\n");
        out
    }

    /// Of a map's file.
    pub(crate) fn parse(
        metadata: &str,
        (columns, rows): (u32, u32),
        georeference: Georeference,
    ) -> std::result::Result<Self, String> {
        let items = items(metadata);
        let text = |name: &str| {
            let found = items.get(name).copied();
            found.ok_or_else(|| format!("its metadata (tag 42112) lacks {name}"))
        };
        let number = |name: &str, limits: (f64, f64)| -> std::result::Result<f64, String> {
            let word = text(name)?;
            let value = word.parse::<f64>().ok();
            value
                .filter(|value| (limits.0..=limits.1).contains(value))
                .ok_or_else(|| {
                    format!(
                        "{name} is `{}`, but must lie in [{}, {}]",
                        word.chars().take(40).collect::<String>(),
                        limits.0,
                        limits.1
                    )
                })
        };
        let version = text("GROUSER_MAP")?;
        if version != VERSION {
            return Err(format!(
                "it is a map of format {version}, and this program reads format {VERSION}"
            ));
        }
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the limits just checked"
        )]
        let whole = |value: f64| value as u32;
        let count = u8::try_from(whole(number("GROUSER_HEADINGS", (4.0, 16.0))?)).unwrap_or(0);
        Ok(Self {
            columns,
            rows,
            cell: number("GROUSER_CELL_M", (1e-3, 1e3))?,
            headings: Headings::new(count).map_err(|error| error.to_string())?,
            georeference,
            robot: unescaped(text("GROUSER_ROBOT")?),
            turning_radius: number("GROUSER_TURNING_RADIUS_M", (0.0, 1e4))?,
            // earlier maps have none
            wheel_radius: number("GROUSER_WHEEL_RADIUS_M", (1e-3, f64::INFINITY))
                .unwrap_or(f64::INFINITY),
            gravity: number("GROUSER_GRAVITY_M_PER_S2", (1e-3, 1e3))?,
            draws: whole(number("GROUSER_SOIL_DRAWS", (0.0, 1e6))?),
            cvar_level: number("GROUSER_CVAR_LEVEL", (0.0, 0.999))?,
            soils: (0..)
                .map_while(|index| items.get(format!("GROUSER_SOIL_{index}").as_str()))
                .map(|name| unescaped(name))
                .collect(),
            soil_numbers: items
                .get("GROUSER_SOIL_NUMBERS")
                .map_or_else(String::new, |text| unescaped(text)),
            job: text("GROUSER_JOB_SHA256")?.to_owned(),
        })
    }
}

/// Names and texts of the items of GDAL's metadata that belong to no band.
fn items(metadata: &str) -> BTreeMap<&str, &str> {
    metadata
        .split("<Item ")
        .skip(1)
        .filter_map(|item| {
            let (head, rest) = item.split_once('>')?;
            let name = head.strip_prefix("name=\"")?.strip_suffix('"')?;
            let (text, _) = rest.split_once("</Item>")?;
            Some((name, text))
        })
        .collect()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

/// What [`escaped`] was given.
fn unescaped(text: &str) -> String {
    text.replace("&gt;", ">")
        .replace("&lt;", "<")
        .replace("&amp;", "&")
}

/// The least radius on which the middle of a robot turns without its wheels slipping sideways: 0 where no wheel steers
/// (it turns on the spot by skidding).
///
/// The centre of the turn lies on the common axle line of the wheels that do not steer, or, where all steer, abreast of
/// their middle; every steered wheel stays within its range.
pub(crate) fn turning_radius(model: &RobotModel) -> f64 {
    let carries = model.wheels.iter().filter(|mount| mount.motor.is_some());
    let (steered, fixed): (Vec<_>, Vec<_>) = carries.partition(|mount| mount.steer_range > 0.0);
    if steered.is_empty() {
        return 0.0;
    }
    let line = if fixed.is_empty() { &steered } else { &fixed };
    let axle = line.iter().map(|mount| mount.centre.x).sum::<f64>() / line.len() as f64;
    let needed = steered.iter().map(|mount| {
        let ahead = (mount.centre.x - axle).abs();
        // the inner wheel stands closer to the centre of the turn
        ahead / mount.steer_range.min(1.57).tan() + mount.centre.y.abs()
    });
    needed.fold(0.0, f64::max)
}
