//! Scenario files.

use std::path::{Path, PathBuf};

use grouser_files::gravity::read_gravity;
use grouser_files::{Document, Section, nearest, read_fields};
use grouser_real::Real;
use grouser_slip::control::ControlSettings;
use grouser_slip::onboard::SoilLearnSettings;
use grouser_terra::{MultiPass, ShearLaw, catalogue};

use super::scenario::{
    GroundShape, GroundSpec, LearnSpec, Leg, PlanSpec, Region, Scenario, SoilChanges, SoilOrigin,
    SoilSpec,
};
use crate::dynamics::STEP_LIMITS_S;
use crate::error::{Error, Result};
use crate::ground::{
    CELL_LIMITS_M, Craters, HeightFile, PACKING_DEPTH_LIMITS_M, Packing, Place, Rocks,
    SCATTER_LENGTH_LIMITS_M, Shape, max_width, side_limits,
};
use crate::robot::RobotModel;
use crate::sensors::{FaultKind, FaultWindow, Schedule, SensorSettings};

/// Limits of a coordinate on a map, m.
const PLACE_LIMITS_M: (f64, f64) = (-1e6, 1e6);
const LENGTH_LIMITS_M: (f64, f64) = (1e-6, 1e6);
const ANY_NUMBER: (f64, f64) = (-1e18, 1e18);
/// The standard of a drive that plans its way, which is that of `LearnSettings` in grouser-terrain.
const PLAN_HYSTERESIS: f64 = 0.15;
/// A slip setpoint.
const SLIP_LIMITS: (f64, f64) = (0.01, 0.95);

/// Reads a scenario file; files that it names lie beside it.
///
/// # Errors
/// What the file lacks or says wrong, with its place.
///
/// ```
/// use grouser_rover::drive::read_scenario;
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/scenarios/sandbox.toml");
/// let scenario = read_scenario(file.as_ref())?;
/// let progress: f64 = scenario.legs.iter().filter_map(|leg| leg.distance).sum();
/// assert!(progress > 9.0); // m
/// scenario.check()?;
/// # Ok::<(), grouser_rover::Error>(())
/// ```
pub fn read_scenario(path: &Path) -> Result<Scenario> {
    let document = Document::read(path)?;
    let beside = path.parent().unwrap_or(Path::new(""));
    let name = path
        .file_stem()
        .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    document.parse(|root| {
        let robot_file = beside.join(root.text("robot")?);
        let robot = RobotModel::read(&robot_file)?;
        read(root, beside, name, (robot_file, robot))
    })
}

/// A scenario out of a document, for a robot that is at hand: the file that it names is not read.
///
/// # Errors
/// As [`read_scenario`].
pub fn parse_scenario(document: &Document, name: &str, robot: RobotModel) -> Result<Scenario> {
    document.parse(|root| {
        let robot_file = PathBuf::from(root.text("robot")?);
        read(root, Path::new(""), name.to_owned(), (robot_file, robot))
    })
}

fn read(
    root: &Section<'_>,
    beside: &Path,
    name: String,
    (robot_file, robot): (PathBuf, RobotModel),
) -> Result<Scenario> {
    let robot = match read_gravity(root)? {
        Some(gravity) => robot.under_gravity(gravity),
        None => robot,
    };
    let start = root
        .section("start", |s| {
            let or_zero =
                |key, limits| Ok::<_, Error>(s.optional_number(key, limits)?.unwrap_or(0.0));
            Ok::<_, Error>((
                or_zero("x_m", PLACE_LIMITS_M)?,
                or_zero("y_m", PLACE_LIMITS_M)?,
                or_zero("heading_deg", (-360.0, 360.0))?.to_radians(),
            ))
        })?
        .unwrap_or((0.0, 0.0, 0.0));
    let specs = read_soils(root, beside)?;
    let ground = root
        .section("ground", |section| {
            read_ground(section, root, specs, beside)
        })?
        .ok_or_else(|| Error::Missing {
            of: format!("scenario \"{name}\""),
            what: "its [ground]".into(),
        })?;
    let sensors = root.section("sensors", read_sensors)?.unwrap_or_default();
    let usual = ControlSettings::under_gravity(robot.linkage.gravity());
    let (control, optimum) = root
        .section("control", |s| read_control(s, &usual))?
        .unwrap_or((usual, None));
    let faults = read_faults(root, &robot)?;
    let duration = root.number("duration_s", (0.1, 1e6))?;
    let plan = root.section("plan", read_plan)?;
    let hysteresis = match &plan {
        Some(_) => PLAN_HYSTERESIS,
        None => SoilLearnSettings::default().hysteresis,
    };
    let learn = root.section("learn", |s| read_learn(s, hysteresis))?;
    let mut legs = root.sections("leg", read_leg)?;
    if let Some(plan) = &plan {
        if !legs.is_empty() {
            return Err(grouser_files::Error::Contradiction {
                at: root.place_of("plan"),
                message:
                    "a drive follows its [[leg]]s or plans its route; only one of them can be given"
                        .to_owned(),
            }
            .into());
        }
        legs.push(Leg {
            speed: plan.speed,
            heading: Real::atan2(plan.goal.1 - start.1, plan.goal.0 - start.0),
            // its navigator says when it has arrived
            distance: None,
            duration: None,
        });
    }
    let usual = Scenario::new(root.text("title")?, (robot_file, robot), ground, duration);
    let scenario = Scenario {
        name,
        seed: root
            .optional_whole("seed", (0, i64::MAX))?
            .unwrap_or(usual.seed),
        step: root.optional_number("step_s", STEP_LIMITS_S)?,
        start,
        legs,
        plan,
        learn,
        sensors,
        faults,
        control,
        optimum,
        hotel: root
            .optional_number("hotel_w", (0.0, 1e6))?
            .unwrap_or(usual.hotel),
        ..usual
    };
    scenario.check()?;
    Ok(scenario)
}

fn read_leg(s: &Section<'_>) -> grouser_files::Result<Leg> {
    Ok(Leg {
        speed: s.number("speed_m_per_s", (-10.0, 10.0))?,
        heading: s
            .optional_number("heading_deg", (-360.0, 360.0))?
            .unwrap_or(0.0)
            .to_radians(),
        distance: s.optional_number("distance_m", LENGTH_LIMITS_M)?,
        duration: s.optional_number("duration_s", (1e-3, 1e6))?,
    })
}

fn read_plan(s: &Section<'_>) -> grouser_files::Result<PlanSpec> {
    let or = |key, limits, other: f64| Ok(s.optional_number(key, limits)?.unwrap_or(other));
    let headings = s.optional_integer("headings")?.unwrap_or(8);
    let Some(headings) = [4_u8, 8, 16]
        .into_iter()
        .find(|h| i64::from(*h) == headings)
    else {
        return Err(s.out_of_range("headings", headings as f64, (4.0, 16.0)));
    };
    Ok(PlanSpec {
        goal: (
            s.number("goal_x_m", PLACE_LIMITS_M)?,
            s.number("goal_y_m", PLACE_LIMITS_M)?,
        ),
        speed: s.number("speed_m_per_s", (1e-3, 10.0))?,
        cell: or("cell_m", (0.05, 100.0), 0.5)?,
        headings,
        max_risk: or("max_risk", (0.0, 1.0), 0.25)?,
        turn_energy: or("turn_energy_j", (0.0, 1e9), 5.0)?,
        margin: or("margin_m", (0.0, 1e4), 10.0)?,
    })
}

fn read_learn(s: &Section<'_>, hysteresis: f64) -> grouser_files::Result<LearnSpec> {
    let or = |key, limits, other: f64| Ok(s.optional_number(key, limits)?.unwrap_or(other));
    Ok(LearnSpec {
        tile: or("tile_m", (0.1, 1e4), 2.0)?,
        hysteresis: or("hysteresis", (0.0, 1.0), hysteresis)?,
    })
}

/// The soils; their files lie beside the scenario.
fn read_soils(root: &Section<'_>, beside: &Path) -> Result<Vec<SoilSpec>> {
    let soils = root.sections("soil", |s| {
        let origin = match s.optional_text("file")? {
            Some(_) if s.has("key") => {
                return Err(grouser_files::Error::Contradiction {
                    at: s.place_of("file"),
                    message:
                        "a soil comes from the catalogue (`key`) or from a `file`, not from both"
                            .to_owned(),
                });
            }
            Some(file) => SoilOrigin::File(beside.join(file)),
            None => SoilOrigin::Catalogue(s.text("key")?.to_owned()),
        };
        let mut changes = SoilChanges::default();
        for (slot, key) in changes.0.iter_mut().zip(SoilChanges::KEYS) {
            *slot = s.optional_number(key, ANY_NUMBER)?;
        }
        let soil = SoilSpec::new(s.text("name")?, origin, changes);
        Ok(soil.map_err(|error| match error {
            Error::Law { source, .. } => s.refused_by_law(source).into(),
            other => other,
        }))
    })?;
    soils.into_iter().collect()
}

/// The index of the soil that the file or the catalogue knows by this name.
fn soil_index(of: &str, name: &str, soils: &mut Vec<SoilSpec>) -> Result<usize> {
    if let Some(index) = soils.iter().position(|spec| spec.name == name) {
        return Ok(index);
    }
    if catalogue::find(name).is_none() {
        let own = soils.iter().map(|spec| spec.name.as_str());
        let keys = catalogue::entries().iter().map(|entry| entry.key);
        return Err(Error::Unknown {
            of: of.to_owned(),
            name: name.to_owned(),
            meant: nearest(name, own.chain(keys)).map(Into::into),
        });
    }
    let origin = SoilOrigin::Catalogue(name.to_owned());
    soils.push(SoilSpec::new(name, origin, SoilChanges::default())?);
    Ok(soils.len() - 1)
}

fn read_ground(
    s: &Section<'_>,
    root: &Section<'_>,
    mut soils: Vec<SoilSpec>,
    beside: &Path,
) -> Result<GroundSpec> {
    let main = soil_index("[ground]", s.text("soil")?, &mut soils)?;
    soils.swap(0, main);
    let shape = read_shape(s, beside)?;
    let or =
        |key, limits, other: f64| Ok::<_, Error>(s.optional_number(key, limits)?.unwrap_or(other));
    let standard = Packing::default();
    let packing = Packing {
        gain: or("packing", (0.0, 10.0), standard.gain)?,
        depth: or("packing_depth_m", PACKING_DEPTH_LIMITS_M, standard.depth)?,
        scatter: or("scatter", (0.0, 1.0), standard.scatter)?,
        scatter_length: or(
            "scatter_length_m",
            SCATTER_LENGTH_LIMITS_M,
            standard.scatter_length,
        )?,
        multi_pass: s.section("multi_pass", read_multi_pass)?,
        settling_way: or("settling_way_m", (0.0, 10.0), standard.settling_way)?,
    };
    if packing.gain > 0.0 && packing.multi_pass.is_some() {
        return Err(grouser_files::Error::Contradiction {
            at: s.place_of("multi_pass"),
            message: "`packing` and `multi_pass` both strengthen the soil of a rut; only one of them can be given"
                .to_owned(),
        }
        .into());
    }
    let density = or("rocks_per_m2", (0.0, 100.0), 0.0)?;
    let size = or("rock_size_m", LENGTH_LIMITS_M, 0.1)?;
    let regions = read_regions(root, &mut soils)?;
    Ok(GroundSpec {
        shape,
        soils,
        regions,
        packing,
        rocks: (density > 0.0).then_some(Rocks { density, size }),
        world_laws: root
            .optional_choice("world_laws", &ShearLaw::ALL.map(|law| (law.key(), law)))?,
    })
}

/// `multi_pass = { k_1 = …, k_2 = …, k_3 = … }`.
fn read_multi_pass(s: &Section<'_>) -> Result<MultiPass> {
    let [k_1, k_2, k_3] = ["k_1", "k_2", "k_3"].map(|key| s.number(key, (0.0, 100.0)));
    MultiPass::new(k_1?, k_2?, k_3?).map_err(|source| Error::Law {
        of: "[ground] multi_pass".to_owned(),
        source,
    })
}

#[derive(Clone, Copy)]
enum Kind {
    Flat,
    Slope,
    Dunes,
    Fractal,
    Craters,
    File,
}

fn read_shape(s: &Section<'_>, beside: &Path) -> Result<GroundShape> {
    let kinds = [
        ("flat", Kind::Flat),
        ("slope", Kind::Slope),
        ("dunes", Kind::Dunes),
        ("fractal", Kind::Fractal),
        ("craters", Kind::Craters),
        ("file", Kind::File),
    ];
    let kind = s.choice("kind", &kinds)?;
    if matches!(kind, Kind::File) {
        return Ok(GroundShape::File(HeightFile {
            path: beside.join(s.text("file")?),
            cell: s.optional_number("cell_m", CELL_LIMITS_M)?,
            height_step: s
                .optional_number("height_step_m", LENGTH_LIMITS_M)?
                .unwrap_or(0.001),
        }));
    }
    let shape = match kind {
        Kind::Slope => Shape::Slope {
            angle: s.number("slope_deg", (-60.0, 60.0))?.to_radians(),
            from: s.optional_number("from_m", PLACE_LIMITS_M)?.unwrap_or(-1e3),
        },
        Kind::Dunes => Shape::Dunes {
            height: s.number("height_m", (0.0, 1e3))?,
            length: s.number("length_m", LENGTH_LIMITS_M)?,
        },
        Kind::Fractal => Shape::Fractal {
            height: s.number("height_m", (0.0, 1e3))?,
            length: s.number("length_m", LENGTH_LIMITS_M)?,
            roughness: s.optional_number("roughness", (0.0, 1.0))?.unwrap_or(0.5),
        },
        Kind::Craters => {
            let min_diameter = s.number("min_diameter_m", (0.1, 1e3))?;
            Shape::Craters(Craters {
                density: s
                    .optional_number("density", (0.0, 0.3))?
                    .unwrap_or(Craters::EQUILIBRIUM_DENSITY),
                min_diameter,
                max_diameter: s.number("max_diameter_m", (min_diameter, 1e4))?,
            })
        }
        Kind::Flat | Kind::File => Shape::Flat,
    };
    let cell = s.optional_number("cell_m", CELL_LIMITS_M)?.unwrap_or(0.05);
    let sides = side_limits(cell);
    let length = s.number("size_x_m", sides)?;
    let widest = max_width(length, cell).min(sides.1);
    let width = s.number("size_y_m", (sides.0, widest))?;
    Ok(GroundShape::Generated {
        shape,
        size: (length, width),
        cell,
    })
}

fn read_regions(root: &Section<'_>, soils: &mut Vec<SoilSpec>) -> Result<Vec<Region>> {
    let texts = root.sections("region", |s| {
        let x = s.number("x_m", PLACE_LIMITS_M)?;
        let y = s.number("y_m", PLACE_LIMITS_M)?;
        let place = if s.has("radius_m") {
            Place::Disc {
                x,
                y,
                radius: s.number("radius_m", LENGTH_LIMITS_M)?,
            }
        } else {
            Place::Box {
                x,
                y,
                length: s.number("length_m", LENGTH_LIMITS_M)?,
                width: s.number("width_m", LENGTH_LIMITS_M)?,
            }
        };
        let wander = s.optional_number("wander_m", (0.0, 1e6))?.unwrap_or(0.0);
        Ok((s.text("soil")?.to_owned(), place, wander))
    })?;
    texts
        .into_iter()
        .map(|(name, place, wander)| {
            Ok(Region {
                soil: soil_index("[[region]]", &name, soils)?,
                place,
                wander,
            })
        })
        .collect()
}

fn read_sensors(s: &Section<'_>) -> Result<SensorSettings> {
    let mut out = SensorSettings::default();
    read_fields(s, &mut out, SensorSettings::FIELDS)?;
    Ok(out)
}

/// The controller's settings, and the slip setpoint where the file gives one.
fn read_control(
    s: &Section<'_>,
    usual: &ControlSettings,
) -> Result<(ControlSettings, Option<f64>)> {
    let mut out = *usual;
    read_fields(s, &mut out, ControlSettings::FIELDS)?;
    out.check().map_err(|error| {
        let refused = match &error {
            grouser_slip::Error::OutOfRange { range, .. } => s.refused(range),
            _ => None,
        };
        refused.map_or_else(|| Error::from(error), Error::from)
    })?;
    Ok((out, s.optional_number("optimum", SLIP_LIMITS)?))
}

fn read_faults(root: &Section<'_>, robot: &RobotModel) -> Result<Schedule> {
    let kinds = FaultKind::NAMES.map(|(name, kind, limits)| (name, (kind, limits)));
    let texts = root.sections("fault", |s| {
        let (kind, limits) = s.choice("kind", &kinds)?;
        let from = s.number("from_s", (0.0, 1e9))?;
        let window = FaultWindow {
            kind,
            wheel: None,
            from,
            to: s.optional_number("to_s", (from, 1e9))?.unwrap_or(1e9),
            // where a kind needs a value and has none, the schedule says so
            value: s.optional_number("value", limits)?.unwrap_or(0.0),
        };
        Ok((window, s.optional_text("wheel")?.map(str::to_owned)))
    })?;
    let windows: Result<Vec<_>> = texts
        .into_iter()
        .map(|(window, wheel)| {
            let wheel = match wheel {
                None => None,
                Some(name) => Some(robot.robot.wheel_index(&name).ok_or_else(|| {
                    let names = robot.wheels.iter().map(|wheel| wheel.name.as_str());
                    Error::Unknown {
                        of: "[[fault]]".into(),
                        meant: nearest(&name, names).map(Into::into),
                        name,
                    }
                })?),
            };
            Ok(FaultWindow { wheel, ..window })
        })
        .collect();
    Schedule::new(windows?)
}
