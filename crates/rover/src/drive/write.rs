//! A scenario as the text of its file.

use std::path::Path;

use grouser_files::gravity::KEY as GRAVITY_KEY;
use grouser_files::{TomlText, write_fields};
use grouser_slip::control::ControlSettings;

use super::scenario::{
    GroundShape, GroundSpec, PlanSpec, Scenario, SoilChanges, SoilOrigin, SoilSpec,
};
use crate::ground::{Packing, Place, Shape};
use crate::robot::RobotModel;
use crate::sensors::{Schedule, SensorSettings};

/// The text of a scenario file that reads back to the same scenario, bit for bit; an angle that no number of degrees gives is
/// written to the nearest one.
///
/// Paths are written as the scenario has them: relative ones lie beside the file that is written. `remarks` stand above
/// it as comments.
///
/// ```
/// use grouser_files::Document;
/// use grouser_rover::drive::{parse_scenario, read_scenario, to_toml};
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/scenarios/sandbox.toml");
/// let mut scenario = read_scenario(file.as_ref())?;
/// scenario.sensors.gyro_sigma = 0.01; // rad/s
/// let text = Document::from_text("noisy.toml", to_toml(&scenario, &["a noisier gyro"]).into())?;
/// let again = parse_scenario(&text, "sandbox", scenario.robot.clone())?;
/// assert_eq!(again, scenario);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn to_toml(scenario: &Scenario, remarks: &[&str]) -> String {
    let mut out = TomlText::new(remarks);
    out.text("title", &scenario.title);
    path(&mut out, "robot", &scenario.robot_file);
    out.number(GRAVITY_KEY, scenario.robot.gravity());
    out.whole("seed", scenario.seed.cast_signed());
    out.number("duration_s", scenario.duration);
    out.optional_number("step_s", scenario.step);
    out.nonzero("hotel_w", scenario.hotel);
    let world = scenario.ground.world_laws;
    out.optional_text("world_laws", world.map(grouser_terra::ShearLaw::key));
    let (x, y, heading) = scenario.start;
    out.header("[start]");
    out.number("x_m", x);
    out.number("y_m", y);
    out.degrees("heading_deg", heading);
    ground(&mut out, &scenario.ground);
    match &scenario.plan {
        Some(spec) => plan(&mut out, spec),
        None => {
            for leg in &scenario.legs {
                out.header("[[leg]]");
                out.number("speed_m_per_s", leg.speed);
                out.degrees("heading_deg", leg.heading);
                out.optional_number("distance_m", leg.distance);
                out.optional_number("duration_s", leg.duration);
            }
        }
    }
    if let Some(learn) = scenario.learn {
        out.header("[learn]");
        out.number("tile_m", learn.tile);
        out.number("hysteresis", learn.hysteresis);
    }
    out.header("[sensors]");
    let usual = SensorSettings::default();
    write_fields(&mut out, &scenario.sensors, &usual, SensorSettings::FIELDS);
    out.header("[control]");
    let usual = ControlSettings::under_gravity(scenario.robot.linkage.gravity());
    write_fields(&mut out, &scenario.control, &usual, ControlSettings::FIELDS);
    out.optional_number("optimum", scenario.optimum);
    faults(&mut out, &scenario.faults, &scenario.robot);
    out.finish()
}

fn path(out: &mut TomlText, key: &str, path: &Path) {
    out.text(key, &path.display().to_string());
}

fn ground(out: &mut TomlText, ground: &GroundSpec) {
    for spec in &ground.soils {
        soil(out, spec);
    }
    let name = |index: usize| {
        ground
            .soils
            .get(index)
            .map_or("", |spec| spec.name.as_str())
    };
    out.header("[ground]");
    out.text("soil", name(0));
    shape(out, &ground.shape);
    let Packing {
        gain,
        depth,
        scatter,
        scatter_length,
        multi_pass,
        settling_way,
    } = ground.packing;
    out.number("packing", gain);
    out.number("packing_depth_m", depth);
    out.number("scatter", scatter);
    out.number("scatter_length_m", scatter_length);
    out.number("settling_way_m", settling_way);
    if let Some(law) = multi_pass {
        let [k_1, k_2, k_3] = law.numbers();
        out.line(&format!(
            "multi_pass = {{ k_1 = {k_1:?}, k_2 = {k_2:?}, k_3 = {k_3:?} }}"
        ));
    }
    if let Some(rocks) = ground.rocks {
        out.number("rocks_per_m2", rocks.density);
        out.number("rock_size_m", rocks.size);
    }
    for region in &ground.regions {
        out.header("[[region]]");
        out.text("soil", name(region.soil));
        match region.place {
            Place::Disc { x, y, radius } => {
                out.number("x_m", x);
                out.number("y_m", y);
                out.number("radius_m", radius);
            }
            Place::Box {
                x,
                y,
                length,
                width,
            } => {
                out.number("x_m", x);
                out.number("y_m", y);
                out.number("length_m", length);
                out.number("width_m", width);
            }
        }
        out.number("wander_m", region.wander);
    }
}

fn soil(out: &mut TomlText, spec: &SoilSpec) {
    out.header("[[soil]]");
    out.text("name", &spec.name);
    match &spec.origin {
        SoilOrigin::Catalogue(key) => out.text("key", key),
        SoilOrigin::File(file) => path(out, "file", file),
    }
    for (key, value) in SoilChanges::KEYS.into_iter().zip(spec.changes.0) {
        out.optional_number(key, value);
    }
}

fn shape(out: &mut TomlText, shape: &GroundShape) {
    let (shape, size, cell) = match shape {
        GroundShape::File(file) => {
            out.text("kind", "file");
            path(out, "file", &file.path);
            out.optional_number("cell_m", file.cell);
            out.number("height_step_m", file.height_step);
            return;
        }
        GroundShape::Generated { shape, size, cell } => (shape, size, *cell),
    };
    match shape {
        Shape::Flat => out.text("kind", "flat"),
        Shape::Slope { angle, from } => {
            out.text("kind", "slope");
            out.degrees("slope_deg", *angle);
            out.number("from_m", *from);
        }
        Shape::Dunes { height, length } => {
            out.text("kind", "dunes");
            out.number("height_m", *height);
            out.number("length_m", *length);
        }
        Shape::Fractal {
            height,
            length,
            roughness,
        } => {
            out.text("kind", "fractal");
            out.number("height_m", *height);
            out.number("length_m", *length);
            out.number("roughness", *roughness);
        }
        Shape::Craters(craters) => {
            out.text("kind", "craters");
            out.number("density", craters.density);
            out.number("min_diameter_m", craters.min_diameter);
            out.number("max_diameter_m", craters.max_diameter);
        }
    }
    out.number("size_x_m", size.0);
    out.number("size_y_m", size.1);
    out.number("cell_m", cell);
}

fn plan(out: &mut TomlText, plan: &PlanSpec) {
    out.header("[plan]");
    for (key, value) in [
        ("goal_x_m", plan.goal.0),
        ("goal_y_m", plan.goal.1),
        ("speed_m_per_s", plan.speed),
        ("cell_m", plan.cell),
        ("max_risk", plan.max_risk),
        ("turn_energy_j", plan.turn_energy),
        ("margin_m", plan.margin),
    ] {
        out.number(key, value);
    }
    out.whole("headings", plan.headings);
}

fn faults(out: &mut TomlText, faults: &Schedule, robot: &RobotModel) {
    for window in faults.windows() {
        out.header("[[fault]]");
        out.text("kind", window.kind.name());
        let wheel = window.wheel.and_then(|index| robot.wheels.get(index));
        out.optional_text("wheel", wheel.map(|wheel| wheel.name.as_str()));
        out.number("from_s", window.from);
        out.number("to_s", window.to);
        out.number("value", window.value);
    }
}
