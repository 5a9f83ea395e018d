//! Scenarios that are written read back to the same values.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "an index out of a share"
)]

use std::path::{Path, PathBuf};

use grouser_files::{Document, soil};
use grouser_rover::Error;
use grouser_rover::drive::{
    GroundShape, GroundSpec, Leg, Scenario, SoilChanges, SoilOrigin, SoilSpec, parse_scenario,
    read_scenario, to_toml,
};
use grouser_rover::ground::{Craters, HeightFile, Place, Rocks, Shape};
use grouser_rover::sensors::{FaultKind, FaultWindow, Schedule, SensorSettings};
use grouser_slip::control::ControlSettings;
use grouser_slip::settings::{Field, FileUnit};
use grouser_terra::{MultiPass, ShearLaw, catalogue};
use proptest::prelude::*;

fn shipped() -> impl Iterator<Item = PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/scenarios");
    let all = std::fs::read_dir(folder).unwrap();
    all.map(|entry| entry.unwrap().path())
}

fn again(scenario: &Scenario) -> Scenario {
    let text = to_toml(scenario, &["written by a test"]);
    let document = Document::from_text("again.toml", text.clone()).unwrap();
    parse_scenario(&document, &scenario.name, scenario.robot.clone())
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[test]
fn every_shipped_scenario_is_the_same_again() {
    let mut count = 0;
    for path in shipped() {
        let scenario = read_scenario(&path).unwrap();
        assert!(again(&scenario) == scenario, "{}", path.display());
        count += 1;
    }
    assert!(count >= 9, "{count}");
}

/// Numbers in [0, 1), one after the other.
struct Draws(std::vec::IntoIter<f64>);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0.next().unwrap_or(0.25)
    }

    fn yes(&mut self) -> bool {
        self.next() < 0.5
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn of<T: Clone>(&mut self, all: &[T]) -> T {
        let index = (self.next() * all.len() as f64) as usize;
        all[index.min(all.len() - 1)].clone()
    }

    /// Some fields of settings, within their limits.
    fn fields<S: Copy>(&mut self, settings: &mut S, fields: &[Field<S>]) {
        for field in fields {
            if field.key.is_some() && self.yes() {
                let value = self.between(field.limits.0, field.limits.1.min(1e3));
                // an angle as a file has it: not every number of radians is one of degrees
                let in_file = match field.file_unit {
                    FileUnit::Degrees => value.to_degrees(),
                    _ => value,
                };
                field.set_from_file(settings, in_file);
            }
        }
    }
}

fn shape(draws: &mut Draws) -> GroundShape {
    if draws.next() < 0.1 {
        let cell = draws.yes().then(|| draws.between(0.1, 2.0));
        return GroundShape::File(HeightFile::new("a \"hill\".tif".into(), cell));
    }
    let (height, length) = (draws.between(0.0, 3.0), draws.between(0.1, 30.0));
    let shape = match (draws.next() * 5.0) as u32 {
        0 => Shape::Flat,
        1 => Shape::Slope {
            angle: draws.between(-60.0, 60.0).to_radians(),
            from: draws.between(-9.0, 9.0),
        },
        2 => Shape::Dunes { height, length },
        3 => Shape::Fractal {
            height,
            length,
            roughness: draws.next(),
        },
        _ => Shape::Craters(Craters {
            density: draws.between(0.0, 0.3),
            min_diameter: 0.1 + height,
            max_diameter: 4.0 + length,
        }),
    };
    GroundShape::Generated {
        shape,
        size: (draws.between(2.0, 50.0), draws.between(2.0, 50.0)),
        cell: draws.between(0.01, 1.0),
    }
}

fn ground(draws: &mut Draws) -> GroundSpec {
    let complete: Vec<&str> = catalogue::entries()
        .iter()
        .filter(|entry| entry.missing().count() == 0)
        .map(|entry| entry.key)
        .collect();
    let soil = |name: &str, draws: &mut Draws| {
        let mut changes = SoilChanges::default();
        for number in &mut changes.0 {
            if draws.next() < 0.2 {
                // 0.2 is legal for each of them, in its unit
                *number = Some(draws.between(0.2, 0.3));
            }
        }
        let origin = SoilOrigin::Catalogue(draws.of(&complete).to_owned());
        SoilSpec::new(name, origin, changes).unwrap()
    };
    let mut ground = GroundSpec::new(shape(draws), soil("main", draws));
    ground.soils.push(soil("a \\ \"soft\" one", draws));
    let (x, y) = (draws.between(-9.0, 9.0), draws.between(-9.0, 9.0));
    let place = if draws.yes() {
        let radius = draws.between(0.1, 3.0);
        Place::Disc { x, y, radius }
    } else {
        let (length, width) = (draws.between(0.1, 3.0), draws.between(0.1, 3.0));
        Place::Box {
            x,
            y,
            length,
            width,
        }
    };
    ground.regions.push(grouser_rover::drive::Region {
        soil: 1,
        place,
        wander: draws.between(0.0, 3.0),
    });
    ground.packing.scatter = draws.next();
    ground.packing.settling_way = draws.next();
    if draws.yes() {
        let law = MultiPass::new(0.1 + draws.next(), draws.next(), draws.next());
        ground.packing.multi_pass = Some(law.unwrap());
    } else {
        ground.packing.gain = draws.next();
    }
    ground.rocks = draws.yes().then(|| Rocks {
        density: draws.between(0.01, 3.0),
        size: draws.between(0.01, 0.3),
    });
    ground.world_laws = draws.yes().then(|| draws.of(&ShearLaw::ALL));
    ground
}

/// A scenario for the robot of one that is shipped, everything else drawn.
fn drawn(draws: &mut Draws) -> Scenario {
    let all: Vec<PathBuf> = shipped().collect();
    let own = read_scenario(&draws.of(&all)).unwrap();
    let robot = own.robot.under_gravity(draws.between(1.0, 12.0));
    let robot = (PathBuf::from("robots/a robot.toml"), robot);
    let mut scenario = Scenario::new("µ \"t\"", robot, ground(draws), draws.between(1.0, 99.0));
    scenario.seed = draws.next().to_bits();
    scenario.step = Some(draws.between(1e-4, 5e-3));
    scenario.hotel = draws.between(0.0, 9.0);
    scenario.start = (
        draws.between(-9.0, 9.0),
        draws.between(-9.0, 9.0),
        draws.between(-360.0, 360.0).to_radians(),
    );
    for _ in 0..3 {
        let heading = draws.between(-360.0, 360.0).to_radians();
        let mut leg = Leg::over(draws.between(-2.0, 2.0), heading, draws.between(0.1, 9.0));
        leg.duration = draws.yes().then(|| draws.between(0.1, 9.0));
        scenario.legs.push(leg);
    }
    draws.fields(&mut scenario.sensors, SensorSettings::FIELDS);
    let mut control = ControlSettings::default();
    draws.fields(&mut control, ControlSettings::FIELDS);
    // limits of one number by others
    let usual = std::mem::replace(&mut scenario.control, control);
    if scenario.check().is_err() {
        scenario.control = usual;
    }
    scenario.optimum = draws.yes().then(|| draws.between(0.01, 0.95));
    let faults = (0..3).map(|_| {
        let (_, kind, (low, high)) = draws.of(&FaultKind::NAMES);
        let from = draws.between(0.0, 9.0);
        let to = from + draws.between(0.0, 9.0);
        let mut window = FaultWindow::new(kind, (from, to), draws.between(low, high));
        window.wheel = draws.yes().then_some(0);
        window
    });
    scenario.faults = Schedule::new(faults.collect()).unwrap();
    scenario
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn a_drawn_scenario_is_the_same_again(draws in proptest::collection::vec(0.0..1.0_f64, 200)) {
        let scenario = drawn(&mut Draws(draws.into_iter()));
        prop_assert!(again(&scenario) == scenario, "{}", to_toml(&scenario, &[]));
    }
}

/// A soil out of a file beside the scenario, with a number changed.
#[test]
fn a_soil_comes_from_a_file_or_from_the_catalogue() {
    let folder = std::env::temp_dir().join(format!("grouser-scenario-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let lunar = catalogue::find("lunar").unwrap().soil().unwrap();
    let file = soil::SoilFile::new("our sand", "plates", *lunar.params());
    std::fs::write(folder.join("sand.toml"), soil::to_toml(&file, &[]).unwrap()).unwrap();
    let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/robots/skid-steer.toml");
    let scenario = |soil: &str| {
        let text = format!(
            "format = 1\ntitle = \"t\"\nrobot = {:?}\nduration_s = 9\n\n[[soil]]\nname = \"s\"\n{soil}\n[ground]\n\
             kind = \"flat\"\nsize_x_m = 9\nsize_y_m = 9\nsoil = \"s\"\n\n[[leg]]\nspeed_m_per_s = 0.3\ndistance_m = 2\n",
            std::path::absolute(&robot).unwrap().display().to_string()
        );
        std::fs::write(folder.join("s.toml"), text).unwrap();
        read_scenario(&folder.join("s.toml"))
    };
    let read = scenario("file = \"sand.toml\"\nphi_deg = 31.0\n").unwrap();
    let sand = &read.ground.soils[0];
    assert_eq!(sand.soil.params().n, lunar.params().n);
    assert!((sand.soil.params().phi.deg() - 31.0).abs() < 1e-12);
    assert_eq!(sand.source, "our sand (plates), completed by the scenario");
    assert!(read_scenario(&folder.join("s.toml")).unwrap() == again(&read));
    for (text, complaint) in [
        ("file = \"sand.toml\"\nkey = \"lunar\"\n", "not from both"),
        ("file = \"none.toml\"\n", "none.toml"),
        ("phi_deg = 31.0\n", "key"),
    ] {
        let error: Error = scenario(text).unwrap_err();
        assert!(error.to_string().contains(complaint), "{error}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
