//! The dynamics against closed forms: loads at rest, slip on a slope, energy, rest, steps, repetition.

use std::path::{Path, PathBuf};

use grouser_rover::dynamics::Vehicle;
use grouser_rover::ground::{Ground, HeightMap};
use grouser_rover::robot::RobotModel;
use grouser_rover::statics::{gradeability, stability_margins, wheel_loads};
use grouser_terra::{Kinematics, Settings, Slip, Soil, WheelOnSoil, catalogue};

fn robot(name: &str) -> RobotModel {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/robots");
    let path: PathBuf = root.join(format!("{name}.toml"));
    RobotModel::read(&path).unwrap()
}

fn dry_sand() -> Soil {
    catalogue::find("dry-sand").unwrap().soil().unwrap()
}

fn plane(slope_deg: f64) -> Ground {
    let tangent = slope_deg.to_radians().tan();
    let map = HeightMap::from_shape((16.0, 4.0), 0.05, |x, _| tangent * x).unwrap();
    Ground::new(map, vec![dry_sand()]).unwrap()
}

/// Rims at `speed` (m/s) by a stiff speed loop for `seconds`.
fn drive(vehicle: &mut Vehicle, ground: &mut Ground, speed: f64, seconds: f64, step: f64) {
    let mut integrals = vec![0.0; vehicle.wheels().len()];
    go_on(vehicle, ground, &mut integrals, (speed, seconds, step));
}

/// The same with the loop's integrals kept.
fn go_on(
    vehicle: &mut Vehicle,
    ground: &mut Ground,
    integrals: &mut [f64],
    (speed, seconds, step): (f64, f64, f64),
) {
    let end = vehicle.time() + seconds;
    while vehicle.time() < end - 0.5 * step {
        for (wheel, integral) in integrals.iter_mut().enumerate() {
            let radius = vehicle.model().wheels[wheel].wheel.radius();
            let off = speed / radius - vehicle.wheels()[wheel].encoder_rate;
            *integral += 20.0 * off * step;
            vehicle.set_input(wheel, 2.0 * off + *integral, 0.0);
        }
        vehicle.advance(ground);
    }
}

#[test]
fn a_robot_at_rest_stands_on_the_loads_of_its_statics() {
    for name in ["five-wheel", "skid-steer", "rocker-bogie"] {
        let mut ground = plane(0.0);
        let model = robot(name);
        let weight = model.weight();
        let expected = wheel_loads(&model, 0.0, 0.0);
        assert!(expected.stands, "{name}: {expected:?}");
        assert!((expected.loads.iter().sum::<f64>() - weight).abs() < 1e-6 * weight);
        let mut vehicle = Vehicle::new(model, &ground, (5.0, 0.0, 0.0), 1e-3).unwrap();
        drive(&mut vehicle, &mut ground, 0.0, 4.0, 1e-3);
        let sum: f64 = vehicle.wheels().iter().map(|wheel| wheel.load.normal).sum();
        assert!(
            (sum - weight).abs() < 1e-3 * weight,
            "{name}: {sum} of {weight}"
        );
        // Wheels sink by a tenth of a radius, and links and trim turn with them: a few per cent of the weight.
        for (wheel, load) in vehicle.wheels().iter().zip(&expected.loads) {
            let off = (wheel.load.normal - load).abs();
            assert!(
                off < 0.04 * weight,
                "{name}: {} for {load} N",
                wheel.load.normal
            );
        }
    }
}

#[test]
fn on_a_slope_the_slip_is_what_the_laws_demand() {
    let slope = 8.0_f64;
    let mut ground = plane(slope);
    let model = robot("skid-steer");
    let weight = model.weight();
    let mut vehicle = Vehicle::new(model, &ground, (2.0, 0.0, 0.0), 1e-3).unwrap();
    drive(&mut vehicle, &mut ground, 0.2, 20.0, 1e-3);
    let wheels = vehicle.wheels();
    let sum: f64 = wheels.iter().map(|wheel| wheel.load.normal).sum();
    let required = weight * slope.to_radians().sin();
    assert!((sum - weight * slope.to_radians().cos()).abs() < 2e-3 * weight);
    // The slip at which the four wheels under these loads have the pull that the slope requires, by the laws alone.
    let mounts = &vehicle.model().wheels;
    let pull = |slip: f64| -> f64 {
        mounts
            .iter()
            .zip(wheels)
            .map(|(mount, wheel)| {
                let pair = WheelOnSoil::new(mount.wheel, dry_sand(), Settings::default()).unwrap();
                let motion = Kinematics::straight(Slip::new(slip).unwrap());
                let solution = pair.under_load(wheel.load.normal, &motion).unwrap();
                solution.point().unwrap().forces.drawbar_pull
            })
            .sum()
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if pull(middle) < required {
            low = middle;
        } else {
            high = middle;
        }
    }
    for wheel in wheels {
        let slip = 1.0 - wheel.velocity[0] / wheel.rim;
        assert!((slip - low).abs() < 1e-3, "{slip} for {low}");
    }
}

#[test]
fn the_books_of_energy_close() {
    let mut ground = plane(6.0);
    let mut vehicle = Vehicle::new(robot("five-wheel"), &ground, (2.0, 0.0, 0.0), 1e-3).unwrap();
    drive(&mut vehicle, &mut ground, 0.0, 2.0, 1e-3);
    let stored = |vehicle: &Vehicle| {
        let (kinetic, potential) = vehicle.energy();
        kinetic + potential
    };
    let (before, from) = (stored(&vehicle), *vehicle.ledger());
    drive(&mut vehicle, &mut ground, 0.25, 12.0, 1e-3);
    let to = *vehicle.ledger();
    let electric = to.electric - from.electric;
    let spent = (to.motor_heat - from.motor_heat)
        + (to.soil - from.soil)
        + (to.bearings - from.bearings)
        + (to.dampers - from.dampers)
        + (stored(&vehicle) - before);
    assert!(electric > 50.0);
    assert!(
        (electric - spent).abs() < 0.01 * electric,
        "{electric} J in, {spent} J out"
    );
}

#[test]
fn a_braked_robot_does_not_creep_down_a_slope() {
    let mut ground = plane(10.0);
    let mut vehicle = Vehicle::new(robot("five-wheel"), &ground, (5.0, 0.0, 0.0), 1e-3).unwrap();
    // the speed loop's integral takes some seconds to hold the wheels
    let mut integrals = vec![0.0; vehicle.wheels().len()];
    go_on(&mut vehicle, &mut ground, &mut integrals, (0.0, 8.0, 1e-3));
    let at = vehicle.state().position;
    go_on(&mut vehicle, &mut ground, &mut integrals, (0.0, 20.0, 1e-3));
    let moved = (vehicle.state().position - at).length();
    assert!(moved < 2e-4, "{moved} m in 20 s");
    assert!(vehicle.state().velocity().length() < 1e-5);
}

#[test]
fn halving_the_step_converges() {
    let run = |step: f64| {
        let mut ground = plane(4.0);
        let mut vehicle =
            Vehicle::new(robot("five-wheel"), &ground, (2.0, 0.0, 0.0), step).unwrap();
        drive(&mut vehicle, &mut ground, 0.0, 1.0, step);
        drive(&mut vehicle, &mut ground, 0.2, 4.0, step);
        vehicle.state().position.x
    };
    let [coarse, middle, fine] = [2e-3, 1e-3, 5e-4].map(run);
    // first order: each halving halves the error; the ruts' cells add their noise
    assert!((middle - fine).abs() < 0.8 * (coarse - middle).abs() + 2e-4);
    assert!((middle - fine).abs() < 2e-3, "{coarse} {middle} {fine}");
}

#[test]
fn the_same_run_has_the_same_bits() {
    let run = || {
        let mut ground = plane(5.0);
        let mut vehicle =
            Vehicle::new(robot("rocker-bogie"), &ground, (2.0, 0.0, 0.3), 1e-3).unwrap();
        drive(&mut vehicle, &mut ground, 0.2, 2.0, 1e-3);
        *vehicle.state()
    };
    assert_eq!(run(), run());
}

#[test]
fn margins_and_gradeability_of_a_simple_robot_are_those_of_the_books() {
    let model = robot("skid-steer");
    let margins = stability_margins(&model, 0.0, 0.0);
    let state = grouser_rover::body::BodyState::at(
        grouser_rover::vector::Vector::ZERO,
        grouser_rover::vector::Attitude::LEVEL,
    );
    let height = model.linkage.centre(&model.linkage.pose(&state)).z;
    // the nearest edges are the axles, 0.22 m away
    assert!((margins.horizontal - 0.22).abs() < 1e-9);
    assert!((margins.tip_over - (0.22_f64 / height).atan()).abs() < 1e-9);
    let arm = 0.22_f64.hypot(height);
    assert!((margins.vertical - (arm - height)).abs() < 1e-9);
    // uphill the rear edge comes nearer by just the slope
    let uphill = stability_margins(&model, 0.2, 0.0);
    assert!((uphill.tip_over - (margins.tip_over - 0.2)).abs() < 1e-9);
    // four equal wheels climb what one of them climbs; on the slope the rear ones carry more, so a little less
    let climbs = gradeability(&model, &dry_sand()).unwrap();
    let (one, whole) = (climbs.wheels[0].unwrap(), climbs.whole.unwrap());
    assert!(whole < one && whole > 0.9 * one, "{whole} {one}");
}
