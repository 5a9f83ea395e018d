//! The dynamics against closed forms: loads at rest, slip on a slope, energy, rest, steps, repetition.

use std::path::{Path, PathBuf};

use grouser_rover::body::{Body, BodyState, Hold, Link, Linkage, MAX_FREEDOMS, MAX_SPEEDS, Speeds};
use grouser_rover::dynamics::Vehicle;
use grouser_rover::ground::{Ground, HeightMap};
use grouser_rover::robot::RobotModel;
use grouser_rover::statics::{stability_margins, wheel_loads};
use grouser_rover::vector::{Attitude, Tensor, Vector};
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

/// A chassis with two links, one upon the other, that one freedom turns either way.
fn differential_in_one_chain() -> Linkage {
    let body = |link, centre: [f64; 3]| Body {
        link,
        mass: 3.0,
        centre: Vector::new(centre[0], centre[1], centre[2]),
        inertia: Tensor {
            diagonal: Vector::new(0.05, 0.07, 0.06),
            products: Vector::new(0.002, -0.004, 0.003),
        },
    };
    let link = |on, x, sign| Link {
        on,
        pivot: Vector::new(x, 0.1, 0.3),
        freedom: 0,
        sign,
    };
    let hold = Hold {
        stiffness: 0.0,
        damping: 0.0,
        preload: 0.0,
        range: 3.0,
        driven: None,
    };
    Linkage::new(
        vec![
            body(None, [0.0, 0.0, 0.3]),
            body(Some(0), [0.3, 0.2, 0.2]),
            body(Some(0), [0.4, -0.1, 0.1]),
            body(Some(1), [0.6, 0.1, 0.2]),
        ],
        vec![link(None, 0.1, 1.0), link(Some(0), 0.4, -1.0)],
        vec![hold],
    )
}

/// The kinetic energy sums the bodies one by one; the equations join them and solve the chassis' velocity first.
#[test]
fn accelerations_are_those_of_the_kinetic_energy() {
    let linkages = [
        robot("five-wheel").linkage,
        robot("rocker-bogie").linkage,
        differential_in_one_chain(),
    ];
    for linkage in linkages.map(|linkage| linkage.under_gravity(0.0)) {
        let size = 6 + linkage.freedoms();
        let number = |i: usize, seed: f64| (12.9898 * (i as f64 + seed)).sin();
        let mut state = BodyState::at(Vector::ZERO, Attitude::from_angles(0.3, -0.2, 0.9));
        for (i, joint) in state.joints.iter_mut().enumerate().take(size - 6) {
            *joint = 0.3 * number(i, 0.4);
        }
        let energy = |state: &BodyState| linkage.energy(state, &linkage.pose(state)).0;
        let accelerate = |state: &BodyState, forces: &Speeds| {
            linkage.accelerate(state, &linkage.pose(state), forces, &[0.0; MAX_FREEDOMS])
        };
        let power = |forces: &Speeds, speeds: &Speeds| -> f64 {
            forces.iter().zip(speeds).map(|(f, u)| f * u).sum()
        };
        // from rest, a = M⁻¹ f and so f · a = aᵀ M a, twice the energy at the speeds a
        let mut forces = [0.0; MAX_SPEEDS];
        for round in 0..8 {
            for (i, force) in forces.iter_mut().enumerate().take(size) {
                *force = number(i, 3.7 * f64::from(round));
            }
            let speeds = accelerate(&state, &forces);
            let mut moving = state;
            moving.speeds = speeds;
            let twice = 2.0 * energy(&moving);
            let work = power(&forces, &speeds);
            assert!((twice - work).abs() < 1e-12 * work, "{twice} {work}");
        }
        // in motion the energy grows by the power of the forces; central difference, error of the second order
        for (i, speed) in state.speeds.iter_mut().enumerate().take(size) {
            *speed = 2.0 * number(i, 1.3);
        }
        let rates = accelerate(&state, &forces);
        let after = |h: f64| {
            let mut moved = state;
            linkage.advance(&mut moved, h);
            for (speed, rate) in moved.speeds.iter_mut().zip(rates) {
                *speed += h * rate;
            }
            energy(&moved)
        };
        let growth = (after(1e-5) - after(-1e-5)) / 2e-5;
        let work = power(&forces, &state.speeds);
        assert!(
            (growth - work).abs() < 1e-6 * energy(&state),
            "{growth} {work}"
        );
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
    // the loop is sampled at the step, and the ruts' cells add their noise
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
fn margins_of_a_simple_robot_are_those_of_the_books() {
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
}
