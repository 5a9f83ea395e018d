//! What the step and the accuracy of the wheels' forces change in a motion, apart and together.

use std::path::Path;

use grouser_rover::drive::{Pilot, Simulation, read_scenario};
use grouser_rover::dynamics::{Vehicle, fastest_rate};
use grouser_rover::ground::{Ground, HeightMap};
use grouser_rover::robot::RobotModel;
use grouser_rover::vector::Vector;
use grouser_terra::{Accuracy, catalogue};

/// Where a robot is after three seconds: driven harder on one side, then braked, over waves of sand.
fn end(accuracy: Accuracy, steps_per_second: u32) -> Vector {
    let step = 1.0 / f64::from(steps_per_second);
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/robots");
    let model = RobotModel::read(&root.join("skid-steer.toml")).unwrap();
    let sand = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let waves = |x: f64, y: f64| 0.05 * (1.3 * x).sin() * (0.9 * y).cos();
    let map = HeightMap::from_shape((10.0, 6.0), 0.05, waves).unwrap();
    let mut ground = Ground::new(map, vec![sand]).unwrap();
    let mut vehicle = Vehicle::new(model, &ground, (2.0, 0.3, 0.2), step).unwrap();
    vehicle.set_accuracy(accuracy);
    let sides: Vec<f64> = vehicle
        .model()
        .wheels
        .iter()
        .map(|mount| mount.centre.y.signum())
        .collect();
    for time in 0..3 * steps_per_second {
        let driving = f64::from(time) * step < 1.8;
        for (wheel, side) in sides.iter().enumerate() {
            let torque = if driving { 4.5 - 2.0 * side } else { -1.0 };
            vehicle.set_input(wheel, torque, 0.0);
        }
        vehicle.advance(&mut ground);
    }
    vehicle.state().position
}

/// The accuracy for steps in time changes a motion far less than halving the step does. (Ruts are pressed cell by cell, so
/// that the step's own error does not fall in proportion to the step.)
#[test]
fn the_step_bounds_a_motion_not_the_accuracy_of_the_forces() {
    let exact = [1000, 2000, 4000].map(|steps| end(Accuracy::Reference, steps));
    let quick = end(Accuracy::Simulation, 1000);
    let way = (exact[0] - Vector::new(2.0, 0.3, exact[0].z)).length();
    let by_step = (exact[0] - exact[1]).length();
    let by_half = (exact[1] - exact[2]).length();
    let by_forces = (quick - exact[0]).length();
    println!(
        "{way:.3} m: step {by_step:.1e} m, its half {by_half:.1e} m, forces {by_forces:.1e} m"
    );
    assert!(way > 0.3, "{way}");
    assert!(by_step.max(by_half) < 2e-3 * way);
    assert!(by_forces > 0.0, "the quick kernel has served");
    assert!(
        by_forces < 1e-3 * by_step.min(by_half),
        "{by_forces} {by_step}"
    );
}

/// Drives of `scenario` in open loop: the way over the ground, m, and what the motors took, J, in the first six seconds.
fn open_loop(scenario: &str, step: Option<f64>) -> [f64; 2] {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/scenarios");
    let mut scenario = read_scenario(&root.join(scenario)).unwrap();
    scenario.step = step;
    let mut drive = Simulation::new(&scenario, Pilot::OpenLoop, 0.3, 7).unwrap();
    let (mut place, mut way) = (None, 0.0);
    drive.run(|frame| {
        let [x, y, z] = frame.place;
        let now = Vector::new(x, y, z);
        way += place
            .replace(now)
            .map_or(0.0, |before| (now - before).length());
        frame.time < 6.0
    });
    [way, drive.vehicle().ledger().electric]
}

/// The step that a scenario without one gets, against a tenth of the longest.
#[test]
fn the_usual_step_errs_by_less_than_a_thousandth() {
    for scenario in [
        "slope.toml",
        "sandbox.toml",
        "dunes.toml",
        "soft-patch.toml",
    ] {
        let [way, electric] = open_loop(scenario, Some(2.5e-4));
        let [usual_way, usual_electric] = open_loop(scenario, None);
        let errors = [usual_way / way - 1.0, usual_electric / electric - 1.0];
        println!("{scenario}: {way:.3} m, {electric:.1} J, off by {errors:?}");
        assert!(way > 0.5, "{way}");
        assert!(errors.iter().all(|error| error.abs() < 5e-4), "{errors:?}");
    }
}

/// A step that a scenario gives is refused where the robot would shake.
#[test]
fn a_step_that_is_too_long_is_refused() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/scenarios");
    let mut scenario = read_scenario(&root.join("sandbox.toml")).unwrap();
    for (step, is_stable) in [(1e-3, true), (3e-3, true), (4e-3, false)] {
        scenario.step = Some(step);
        let made = Simulation::new(&scenario, Pilot::OpenLoop, 0.3, 7);
        assert_eq!(made.is_ok(), is_stable, "{step} s");
        let Err(error) = made else { continue };
        assert!(
            matches!(error, grouser_rover::Error::OutOfRange { .. })
                && error.to_string().contains("step_s"),
            "{error}"
        );
    }
}

/// Shipped robots under a gravity (m/s²).
fn robot(name: &str, gravity: f64) -> RobotModel {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/robots");
    let model = RobotModel::read(&root.join(name).with_extension("toml")).unwrap();
    model.under_gravity(gravity)
}

/// Flat ground of a soil of the catalogue, its nodes so far apart that no rut is pressed.
fn flat(soil: &str) -> Ground {
    let soil = catalogue::find(soil).unwrap().soil().unwrap();
    let map = HeightMap::from_shape((16.0, 4.0), 2.0, |_, _| 0.0).unwrap();
    Ground::new(map, vec![soil]).unwrap()
}

/// Errors fall faster than the step (to a quarter, but for the corner where a wheel's direction is settled) while a robot starts, sways and runs into its motors' limit of voltage.
#[test]
fn steps_are_of_second_order() {
    for name in ["five-wheel", "skid-steer", "rocker-bogie"] {
        let end = |step: f64, steps: u32| {
            let mut ground = flat("dry-sand");
            let start = (5.0, 0.0, 0.0);
            let mut vehicle = Vehicle::new(robot(name, 9.81), &ground, start, step).unwrap();
            for index in 0..steps {
                let time = f64::from(index) * step;
                let rises = 1.0 - (-(time - 1.0).max(0.0)).exp();
                let torque = 3.0 * rises * (1.0 + 0.2 * (3.0 * time).sin());
                for wheel in 0..vehicle.wheels().len() {
                    vehicle.set_input(wheel, torque, 0.0);
                }
                vehicle.advance(&mut ground);
            }
            vehicle.state().position.x
        };
        let [whole, half, quarter] =
            [(2.5e-3, 1200), (1.25e-3, 2400), (6.25e-4, 4800)].map(|(step, n)| end(step, n));
        let (error, by_half) = (whole - half, half - quarter);
        println!("{name}: {whole:.4} m, {error:.1e} m, with half the step {by_half:.1e} m");
        assert!((whole - 5.0) > 0.5, "{whole}");
        assert!(error.abs() < 5e-4 * (whole - 5.0), "{error}");
        assert!(
            by_half.abs() < error.abs() / 2.2,
            "{name}: {error} {by_half}"
        );
    }
}

/// The greatest of a robot's speeds, m/s and rad/s, after it has stood for two seconds.
fn unrest(model: &RobotModel, soil: &str, step: f64) -> f64 {
    let mut ground = flat(soil);
    let mut vehicle = Vehicle::new(model.clone(), &ground, (5.0, 0.0, 0.0), step).unwrap();
    let mut greatest: f64 = 0.0;
    while vehicle.time() < 2.1 {
        vehicle.advance(&mut ground);
        if vehicle.time() > 2.0 {
            let speeds = vehicle.state().speeds.iter().map(|speed| speed.abs());
            greatest = speeds.fold(greatest, f64::max);
        }
    }
    greatest
}

/// The rate of the fastest part, from the robot's inertia and the soil's stiffness, is where stepping ceases to be stable.
#[test]
fn the_fastest_rate_bounds_the_step() {
    for name in ["five-wheel", "skid-steer", "rocker-bogie"] {
        for gravity in [1.62, 9.81] {
            for soil in ["dry-sand", "sandy-loam", "clayey-soil", "lunar"] {
                let model = robot(name, gravity);
                let soils = [catalogue::find(soil).unwrap().soil().unwrap()];
                let rate = fastest_rate(&model, &soils, 1.0, 0.0).unwrap();
                let calm = unrest(&model, soil, (0.8 / rate).clamp(1e-5, 5e-3));
                assert!(
                    calm < 1e-3,
                    "{name} {gravity} {soil}: {calm} at 0.8/{rate} s"
                );
                // four equal wheels at rest on firm soil excite nothing but heave
                if rate > 500.0 && name != "skid-steer" {
                    let restless = unrest(&model, soil, 1.5 / rate);
                    assert!(
                        restless > 3e-3,
                        "{name} {gravity} {soil}: {restless} at 1.5/{rate} s"
                    );
                }
            }
        }
    }
}
