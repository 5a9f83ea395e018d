//! What the step and the accuracy of the wheels' forces change in a motion, apart and together.

use std::path::Path;

use grouser_rover::drive::{Pilot, Simulation, read_scenario};
use grouser_rover::dynamics::Vehicle;
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
fn open_loop(scenario: &str, step_s: f64) -> [f64; 2] {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/scenarios");
    let mut scenario = read_scenario(&root.join(scenario)).unwrap();
    scenario.step = step_s;
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

/// docs/drive.md offers a step of 2.5 ms for sweeps, with these errors.
#[test]
fn a_step_for_sweeps_errs_by_a_thousandth() {
    for scenario in ["slope.toml", "sandbox.toml", "dunes.toml"] {
        let [way, electric] = open_loop(scenario, 2.5e-4);
        let [long_way, long_electric] = open_loop(scenario, 2.5e-3);
        let errors = [long_way / way - 1.0, long_electric / electric - 1.0];
        println!("{scenario}: {way:.3} m, {electric:.1} J, off by {errors:?}");
        assert!(way > 0.5, "{way}");
        assert!(errors.iter().all(|error| error.abs() < 2e-3), "{errors:?}");
    }
}
