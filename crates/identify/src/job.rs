//! Files that say what was tested and what is to be found.

use std::path::{Path, PathBuf};

use grouser_files::wheel_sizes::with_grousers;
use grouser_files::{Document, Section, nearest, soil};
use grouser_terra::{OpenSoil, RigidWheel};

use crate::error::{Error, Result};
use crate::least_squares::{Loss, StartSettings};
use crate::parameter::Parameter;
use crate::plate::{BagSource, DepthColumn, Plate, PlateSettings};
use crate::wheel::Scatter;

/// A job: tests of one soil.
///
/// ```toml
/// format = 1
/// name = "Sand of our test bed"
///
/// [[plate]]                       # force against depth, out of a table …
/// table = "plates.csv"            # depth_mm, force_n, plate_diameter_mm, test
///
/// [[plate]]                       # … or out of a bag and a text file
/// name = "60 mm disc"
/// diameter_m = 0.06
/// bag = "test.bag"
/// force_field = "wrench.wrench.force.z"
/// force_sign = -1.0               # −1 where the force reads negative when the plate is pressed in
/// stamp_field = "wrench.header.stamp"   # optional; `topic` too
/// depth_file = "test.txt"
/// height_field = 5                # fields of each line, from 1
/// height_unit = "mm"
/// clock_field = 7                 # the system's clock, s
/// controller_field = 6            # optional: the controller's own clock
/// controller_unit = "ms"
/// surface_m = -0.0096             # optional: the height of the surface
///
/// [plate_fit]                     # optional
/// least_depth_m = 0.002
/// fit_datum = false
///
/// [shear]
/// table = "shear.csv"             # normal_stress_kpa, displacement_mm, shear_stress_kpa
///
/// [wheel]
/// table = "wheel.csv"             # slip, load_n, and any of drawbar_pull_n, torque_nm, sinkage_mm, …
/// radius_m = 0.1
/// width_m = 0.05
/// grouser_height_m = 0.005        # lugs, if it has some; grouser_thickness_m too
/// grouser_count = 24
/// fit = ["k_shear_m", "c_1", "c_2", "sinkage_datum_m"]
/// pull_scatter_n = 0.5            # standard deviations of one reading
/// torque_scatter_nm = 0.05
/// sinkage_scatter_m = 0.0007
/// huber = 1.345                   # optional: outliers pull with a bounded force
/// intervals = "profile"           # or "linear"
///
/// [soil]                          # what is known besides, and the laws to identify with
/// cohesion_kpa = 0.0
/// phi_deg = 29.0
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Job {
    /// The soil's name.
    pub name: String,
    /// Its key, if it has one.
    pub key: Option<String>,
    /// What is known besides, and the laws to identify with.
    pub soil: OpenSoil,
    /// Plate tests.
    pub plates: Vec<PlateSource>,
    /// How they are fitted.
    pub plate_settings: PlateSettings,
    /// The table of shear tests.
    pub shear: Option<PathBuf>,
    /// Wheel tests.
    pub wheel: Option<WheelJob>,
}

/// The source of a plate test.
#[derive(Clone, Debug, PartialEq)]
pub enum PlateSource {
    /// In a table.
    Table(PathBuf),
    /// In a bag and a text file.
    Bag(Box<BagTest>),
}

/// A plate test in a bag and a text file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BagTest {
    /// Its name.
    pub name: String,
    /// The plate.
    pub plate: Plate,
    /// The force.
    pub source: BagSource,
    /// The depth.
    pub depth: DepthColumn,
}

/// Wheel tests and the numbers to be found from them.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct WheelJob {
    /// The table.
    pub table: PathBuf,
    /// The wheel.
    pub wheel: RigidWheel,
    /// What is to be found.
    pub parameters: Vec<Parameter>,
    /// What residuals are divided by.
    pub scatter: Scatter,
    /// What a residual costs.
    pub loss: Loss,
    /// Are intervals by profile likelihood wanted?
    pub profile: bool,
    /// From where the search begins.
    pub starts: StartSettings,
}

impl Job {
    /// A job without a test, of a soil of which nothing is known.
    ///
    /// ```
    /// use grouser_identify::{Job, PlateSource, identify};
    ///
    /// let mut job = Job::new("Sand of our test bed");
    /// job.plates = vec![PlateSource::Table("../../examples/bevameter/plates.csv".into())];
    /// let found = identify(&job)?;
    /// assert!(found.missing().contains(&"cohesion_kpa"));
    /// # Ok::<(), grouser_identify::Error>(())
    /// ```
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            key: None,
            soil: OpenSoil::default(),
            plates: Vec::new(),
            plate_settings: PlateSettings::default(),
            shear: None,
            wheel: None,
        }
    }

    /// Reads a job; paths in it are beside its file.
    ///
    /// # Errors
    /// What is missing or wrong in the file, with its place.
    pub fn read(document: &Document) -> Result<Self> {
        let job = document.parse(|root| -> std::result::Result<Self, grouser_files::Error> {
            let soil = root.section("soil", soil::read_open)?;
            let plates = root.sections("plate", |section| read_plate(section, document))?;
            let plate_settings = root.section("plate_fit", read_plate_settings)?;
            let shear = root.section("shear", |section| {
                Ok::<_, grouser_files::Error>(document.beside(section.text("table")?))
            })?;
            Ok(Self {
                name: root.text("name")?.to_owned(),
                key: root.optional_text("key")?.map(Into::into),
                soil: soil.unwrap_or_default(),
                plates,
                plate_settings: plate_settings.unwrap_or_default(),
                shear,
                wheel: root.section("wheel", |section| read_wheel(section, document))?,
            })
        })?;
        if job.plates.is_empty() && job.shear.is_none() && job.wheel.is_none() {
            return Err(Error::Missing {
                what: "a test",
                needed_by: format!("{} has no [[plate]], [shear] or [wheel]", document.name()),
            });
        }
        Ok(job)
    }

    /// The files that the job reads, in order.
    #[must_use]
    pub fn files(&self) -> Vec<&Path> {
        let mut list: Vec<&Path> = Vec::new();
        for plate in &self.plates {
            match plate {
                PlateSource::Table(path) => list.push(path),
                PlateSource::Bag(test) => {
                    list.push(&test.source.bag);
                    list.push(&test.depth.file);
                }
            }
        }
        list.extend(self.shear.as_deref());
        list.extend(self.wheel.as_ref().map(|wheel| wheel.table.as_path()));
        list
    }
}

type Read<T> = std::result::Result<T, grouser_files::Error>;

const LENGTHS: [(&str, f64); 4] = [("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("in", 0.0254)];
const TIMES: [(&str, f64); 4] = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
const SIZE: (f64, f64) = (1e-3, 100.0);
/// Fields of a line, counted from 1.
const FIELDS: (i64, i64) = (1, 1000);

fn read_plate(section: &Section<'_>, document: &Document) -> Read<PlateSource> {
    if let Some(table) = section.optional_text("table")? {
        return Ok(PlateSource::Table(document.beside(table)));
    }
    let field = |key| section.optional_whole(key, FIELDS);
    let required = |key| section.whole(key, FIELDS);
    let bag = document.beside(section.text("bag")?);
    let name = section.optional_text("name")?;
    let diameter = section.number("diameter_m", SIZE)?;
    let controller = match field("controller_field")? {
        Some(field) => Some((field, section.choice("controller_unit", &TIMES)?)),
        None => None,
    };
    let plate =
        Plate::disc(diameter).map_err(|_| section.out_of_range("diameter_m", diameter, SIZE))?;
    Ok(PlateSource::Bag(Box::new(BagTest {
        name: name.map_or_else(
            || {
                let stem = bag.file_stem().unwrap_or_default();
                stem.to_string_lossy().into_owned()
            },
            Into::into,
        ),
        plate,
        source: BagSource {
            bag,
            topic: section.optional_text("topic")?.map(Into::into),
            force: section.text("force_field")?.to_owned(),
            stamp: section.optional_text("stamp_field")?.map(Into::into),
            sign: section
                .optional_number("force_sign", (-1.0, 1.0))?
                .unwrap_or(1.0)
                .signum(),
        },
        depth: DepthColumn {
            file: document.beside(section.text("depth_file")?),
            height: required("height_field")?,
            height_unit: section.choice("height_unit", &LENGTHS)?,
            clock: required("clock_field")?,
            controller,
            surface: section.optional_number("surface_m", (-1e3, 1e3))?,
        },
    })))
}

fn read_plate_settings(section: &Section<'_>) -> Read<PlateSettings> {
    let usual = PlateSettings::default();
    Ok(PlateSettings {
        least_depth: section
            .optional_number("least_depth_m", (1e-6, 10.0))?
            .unwrap_or(usual.least_depth),
        fit_datum: section.flag("fit_datum")?,
        loss: read_loss(section)?,
    })
}

fn read_loss(section: &Section<'_>) -> Read<Loss> {
    let threshold = section.optional_number("huber", (0.1, 100.0))?;
    Ok(threshold.map_or(Loss::Squares, |threshold| Loss::Huber { threshold }))
}

fn read_wheel(section: &Section<'_>, document: &Document) -> Read<WheelJob> {
    let (radius, width) = (
        section.number("radius_m", SIZE)?,
        section.number("width_m", SIZE)?,
    );
    let wheel = RigidWheel::new(radius, width).map_err(|source| section.refused_by_law(source))?;
    let wheel = with_grousers(section, wheel)?;
    let mut parameters = Vec::new();
    for name in section.texts("fit")? {
        let Some(parameter) = Parameter::named(name) else {
            let keys = || Parameter::all().map(Parameter::key);
            let allowed: Vec<String> = keys().map(|key| format!("\"{key}\"")).collect();
            return Err(grouser_files::Error::BadChoice {
                at: section.place_of("fit"),
                key: "fit".to_owned(),
                value: name.chars().take(64).collect(),
                allowed: allowed.join(", "),
                meant: nearest(name, keys()).map(Into::into),
            });
        };
        if !parameters.contains(&parameter) {
            parameters.push(parameter);
        }
    }
    let scatter = |key, usual| -> Read<f64> {
        Ok(section
            .optional_number(key, (1e-12, 1e12))?
            .unwrap_or(usual))
    };
    let noise = Scatter::default();
    let usual = StartSettings::default();
    Ok(WheelJob {
        table: document.beside(section.text("table")?),
        wheel,
        parameters,
        scatter: Scatter {
            pull: scatter("pull_scatter_n", noise.pull)?,
            side: scatter("side_scatter_n", noise.side)?,
            torque: scatter("torque_scatter_nm", noise.torque)?,
            sinkage: scatter("sinkage_scatter_m", noise.sinkage)?,
        },
        loss: read_loss(section)?,
        profile: section
            .optional_choice("intervals", &[("profile", true), ("linear", false)])?
            .unwrap_or(false),
        starts: StartSettings {
            starts: section
                .optional_whole("starts", (1, 1000))?
                .unwrap_or(usual.starts),
            seed: section
                .optional_whole("seed", (0, i64::MAX))?
                .unwrap_or(usual.seed),
        },
    })
}
