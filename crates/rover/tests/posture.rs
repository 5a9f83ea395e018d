//! A chassis with actuators: its margin against plain geometry, the posture that is chosen, and how it is moved.

use std::path::Path;

use grouser_files::Document;
use grouser_rover::Error;
use grouser_rover::body::MAX_FREEDOMS;
use grouser_rover::drive::{
    DriveResult, Outcome, Pilot, Scenario, Simulation, parse_scenario, read_scenario,
};
use grouser_rover::dynamics::Vehicle;
use grouser_rover::ground::{Ground, HeightMap};
use grouser_rover::robot::RobotModel;
use grouser_rover::statics::{PostureControl, tip_over_margin};
use grouser_rover::vector::Vector;
use grouser_terra::catalogue;

fn text() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/robots");
    std::fs::read_to_string(root.join("shoulders.toml")).unwrap()
}

fn parsed(text: String) -> Result<RobotModel, Error> {
    RobotModel::parse(&Document::from_text("robot.toml", text)?)
}

fn robot() -> RobotModel {
    parsed(text()).unwrap()
}

/// Gravity in the frame of a chassis with its left side up by `roll` and its nose up by `pitch`, rad.
fn gravity(roll: f64, pitch: f64) -> Vector {
    Vector::new(
        -pitch.sin(),
        -pitch.cos() * roll.sin(),
        -pitch.cos() * roll.cos(),
    )
}

/// kg, and its place, m.
type Mass = (f64, [f64; 3]);

/// The masses of the robot file with their places, and the lowest points of its wheels, in a posture: by the file's numbers and
/// plain trigonometry. Shoulders in rad, the battery in m.
fn masses_and_contacts([left, right, battery]: [f64; 3]) -> (Vec<Mass>, Vec<[f64; 3]>) {
    let model = robot();
    let chassis = &model.linkage.bodies()[0];
    assert_eq!(chassis.mass, 12.0);
    let height = chassis.centre.z;
    let mut masses = vec![(8.0, [0.0, 0.0, height]), (4.0, [0.0, battery, height])];
    let mut wheels = Vec::new();
    for (y, shoulder) in [(0.25, left), (-0.25, right)] {
        // two legs of 0.6 kg with their mass at the shoulder
        masses.push((1.2, [0.0, y, 0.35]));
        let angle = f64::atan2(0.2, 0.25) + shoulder;
        let length = f64::hypot(0.2, 0.25);
        for sense in [1.0, -1.0] {
            let at = [sense * length * angle.cos(), y, 0.35 - length * angle.sin()];
            masses.push((0.8, at));
            wheels.push(at);
        }
    }
    (masses, wheels)
}

/// The angle between gravity and the nearest side of the support, of a rigid robot on a plane through its contacts.
fn by_geometry(posture: [f64; 3], down: Vector) -> f64 {
    let vector = |[x, y, z]: [f64; 3]| Vector::new(x, y, z);
    let (masses, hubs) = masses_and_contacts(posture);
    let whole: f64 = masses.iter().map(|(mass, _)| mass).sum();
    let centre = masses.iter().fold(Vector::ZERO, |sum, (mass, at)| {
        sum + vector(*at) * (*mass / whole)
    });
    let hubs: Vec<Vector> = hubs.into_iter().map(vector).collect();
    // both wheels of a side have the same height: the plane is exact
    let normal = (hubs[0] - hubs[1]).cross(hubs[0] - hubs[2]).unit();
    let normal = if normal.z > 0.0 { normal } else { -normal };
    let at = |index: usize| hubs[index] - normal * 0.15;
    // front left, rear left, rear right, front right
    let corners = [at(0), at(1), at(3), at(2)];
    let middle = corners
        .iter()
        .fold(Vector::ZERO, |sum, at| sum + *at * 0.25);
    // gravity must point into the pyramid from the centre of gravity to the contacts
    let side = |index: usize| {
        let edge = corners[(index + 1) % 4] - corners[index];
        let across = edge.cross(corners[index] - centre).unit();
        let inward = across.dot(middle - centre).signum();
        (inward * across.dot(down)).asin()
    };
    (0..4).map(side).fold(f64::INFINITY, f64::min)
}

fn joints([left, right, _]: [f64; 3]) -> [f64; MAX_FREEDOMS] {
    let mut joints = [0.0; MAX_FREEDOMS];
    (joints[0], joints[1]) = (left, right);
    joints
}

fn placed(posture: [f64; 3]) -> RobotModel {
    let mut model = robot();
    for (index, position) in posture.into_iter().enumerate() {
        model.place_actuator(index, position);
    }
    model
}

#[test]
fn margins_in_a_posture_are_those_of_plain_geometry() {
    for posture in [
        [0.0, 0.0, 0.0],
        [-0.4, 0.2, 0.08],
        [0.25, -0.5, -0.1],
        [-0.5, -0.5, 0.0],
    ] {
        let model = placed(posture);
        for (roll, pitch) in [(0.0, 0.0), (0.3, 0.0), (-0.2, 0.1), (0.1, -0.4), (0.6, 0.0)] {
            let down = gravity(roll, pitch);
            let expected = by_geometry(posture, down);
            let margin = tip_over_margin(&model, &joints(posture), down);
            if expected > 0.0 {
                assert!(
                    (margin - expected).abs() < 1e-6,
                    "{posture:?} {roll} {pitch}: {margin} {expected}"
                );
            } else {
                // it falls over several sides at once
                assert!(
                    margin < 0.0,
                    "{posture:?} {roll} {pitch}: {margin} {expected}"
                );
            }
        }
    }
}

/// Ground whose roll grows: the chassis that knows the attitude and moves freely is further from tipping over than the
/// fixed one, and further than in any other posture of a grid.
#[test]
fn the_posture_that_is_chosen_has_the_maximum_margin_on_growing_roll() {
    let mut control = PostureControl::new(&robot());
    let mut posture = [0.0; 3];
    for degrees in 0..=30 {
        let slope = f64::from(degrees).to_radians();
        // the roll of the chassis is that of the ground and of its own posture
        let lean = |[left, right, _]: [f64; 3]| {
            let height =
                |shoulder: f64| f64::hypot(0.2, 0.25) * (f64::atan2(0.2, 0.25) + shoulder).sin();
            ((height(left) - height(right)) / 0.5).atan()
        };
        let roll = slope + lean(posture);
        for (joint, angle) in joints(posture).into_iter().enumerate() {
            control.set_joint(joint, angle);
        }
        let setpoints = control.update((roll, 0.0), &posture);
        posture = setpoints.try_into().unwrap();
        let margin = |posture| by_geometry(posture, gravity(slope + lean(posture), 0.0));
        let (fixed, chosen) = (margin([0.0; 3]), margin(posture));
        assert!(chosen > fixed + 0.08, "{degrees} deg: {fixed} {chosen}");
        let mut best = f64::NEG_INFINITY;
        for left in 0..=9 {
            for right in 0..=9 {
                for battery in 0..=4 {
                    let at = |place: i32| f64::to_radians(-30.0 + 5.0 * f64::from(place));
                    let battery = -0.12 + 0.06 * f64::from(battery);
                    best = best.max(margin([at(left), at(right), battery]));
                }
            }
        }
        // a gain of half a degree moves nothing, and positions are searched to a fiftieth
        assert!(
            chosen > best - 0.02,
            "{degrees} deg: {chosen}, but {best} is possible"
        );
    }
}

#[test]
fn an_attitude_that_is_no_number_moves_nothing() {
    let mut control = PostureControl::new(&robot());
    control.set_joint(0, f64::NAN);
    control.set_joint(99, 0.1);
    assert_eq!(control.update((f64::NAN, 0.0), &[0.0; 3]), [0.0; 3]);
    assert_eq!(control.update((0.0, f64::INFINITY), &[f64::NAN]), [0.0; 3]);
    assert!(
        control
            .update((0.1, 0.0), &[f64::NAN])
            .iter()
            .all(|own| own.is_finite())
    );
    assert!(
        control
            .update((0.2, 0.0), &[0.0; 3])
            .iter()
            .all(|own| own.is_finite())
    );
}

fn on_flat(model: RobotModel) -> (Vehicle, Ground) {
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let map = HeightMap::from_shape((6.0, 4.0), 0.1, |_, _| 0.0).unwrap();
    let ground = Ground::new(map, vec![soil]).unwrap();
    let vehicle = Vehicle::new(model, &ground, (2.0, 0.0, 0.0), 1e-3).unwrap();
    (vehicle, ground)
}

#[test]
fn actuators_move_within_speed_and_power_and_the_energy_balances() {
    let (mut vehicle, mut ground) = on_flat(robot());
    for _ in 0..1000 {
        vehicle.advance(&mut ground);
    }
    let stored = |vehicle: &Vehicle| {
        let (kinetic, potential) = vehicle.energy();
        kinetic + potential
    };
    let spent = |vehicle: &Vehicle| {
        let own = vehicle.ledger();
        own.motor_heat + own.soil + own.bearings + own.dampers - own.electric
    };
    for (posture, rises) in [([0.2, 0.2, 0.1], true), ([-0.3, -0.3, -0.1], false)] {
        for (index, setpoint) in posture.into_iter().enumerate() {
            vehicle.set_actuator(index, setpoint);
        }
        let (before, books) = (
            vehicle.ledger().actuators,
            stored(&vehicle) + spent(&vehicle),
        );
        let height = vehicle.state().position.z;
        let mut last: Vec<f64> = vehicle
            .model()
            .actuators
            .iter()
            .map(|own| own.position)
            .collect();
        let mut drawn = before;
        for _ in 0..12_000 {
            vehicle.advance(&mut ground);
            let now = vehicle.ledger().actuators;
            assert!(
                now - drawn <= 100.0 * 1e-3 + 1e-9,
                "40 W, 40 W and 20 W at most"
            );
            drawn = now;
            for (own, last) in vehicle.model().actuators.iter().zip(&mut last) {
                assert!((own.position - *last).abs() <= own.speed * 1e-3 + 1e-12);
                *last = own.position;
            }
        }
        for (own, setpoint) in vehicle.model().actuators.iter().zip(posture) {
            assert_eq!(own.position, setpoint, "{}", own.name);
        }
        let lifted = vehicle.state().position.z - height;
        assert_eq!(lifted > 0.0, rises, "{lifted}");
        let energy = drawn - before;
        // the wheels stay on the ground
        let wheels: f64 = vehicle.model().wheels.iter().map(|wheel| wheel.mass).sum();
        let work = (vehicle.model().weight() - wheels * vehicle.model().gravity()) * lifted;
        println!("{posture:?}: {energy} J for {work} J");
        // half of the power is mechanical
        if rises {
            assert!(energy > 2.0 * work, "{energy} {work}");
        }
        let off = stored(&vehicle) + spent(&vehicle) - books;
        assert!(
            off.abs() < 0.05 * (energy + work.abs()),
            "{off} of {energy} and {work}"
        );
    }
}

#[test]
fn a_weak_actuator_is_slower_and_one_without_power_for_its_load_still_lowers() {
    let lifted_in_2_s = |power: &str| {
        let text = text().replace("power_w = 40.0", power);
        let (mut vehicle, mut ground) = on_flat(parsed(text).unwrap());
        vehicle.set_actuator(0, 0.26);
        vehicle.set_actuator(1, 0.26);
        for _ in 0..2000 {
            vehicle.advance(&mut ground);
        }
        vehicle.model().actuators[0].position
    };
    let (strong, weak) = (
        lifted_in_2_s("power_w = 40.0"),
        lifted_in_2_s("power_w = 1.0"),
    );
    assert!(weak > 0.0 && weak < 0.5 * strong, "{weak} {strong}");
}

#[test]
fn actuators_that_cannot_be_are_refused_with_field_value_limit_and_unit() {
    for (from, to, said) in [
        (
            "max_deg = 15.0",
            "max_deg = 95.0",
            "`max_deg` is 95, but must lie in [0, 90]",
        ),
        (
            "max_deg = 15.0",
            "max_deg = nan",
            "`max_deg` is NaN, but must lie in [0, 90]",
        ),
        (
            "max_deg = 15.0",
            "max_deg = 60.0",
            "max_deg is 60 deg, but must lie in [-40, 40]",
        ),
        (
            "min_deg = -30.0 ",
            "min_deg = 1.0 ",
            "`min_deg` is 1, but must lie in [-90, 0]",
        ),
        (
            "power_w = 40.0",
            "power_w = 0.0",
            "`power_w` is 0, but must lie in [0.001, 1000000]",
        ),
        (
            "speed_m_per_s = 0.03",
            "speed_m_per_s = -1.0",
            "`speed_m_per_s` is -1",
        ),
        (
            "mass_kg = 4.0",
            "mass_kg = 14.0",
            "mass_kg is 14 kg, but must lie in [0, 12]",
        ),
        (
            "stiffness_nm_per_rad = 2000.0",
            "stiffness_nm_per_rad = 0.0",
            "stiffness_nm_per_rad is 0 N m/rad",
        ),
        (
            "link = \"left_front\"",
            "link = \"left_fron\"",
            "did you mean `left_front`",
        ),
        (
            "link = \"right_front\"",
            "link = \"left_rear\"",
            "actuators of one link: 2",
        ),
        ("along = \"y\"", "along = \"w\"", "along"),
        ("kind = \"mass\"", "kind = \"camber\"", "kind"),
        (
            "efficiency = 0.5",
            "efficiency = 1.5",
            "`efficiency` is 1.5",
        ),
    ] {
        let changed = text().replacen(from, to, 1);
        assert_ne!(changed, text(), "{from}");
        let error = parsed(changed).unwrap_err().to_string();
        assert!(error.contains(said), "{to}: {error}");
    }
}

fn driven(scenario: &Scenario, pilot: Pilot, seed: u64, mut see: impl FnMut(f64)) -> DriveResult {
    let mut drive = Simulation::new(scenario, pilot, 0.4, seed).unwrap();
    drive.run(|frame| {
        frame.tip_over_margin.into_iter().for_each(&mut see);
        true
    })
}

/// `grouser drive side-slope.toml --compare controller,fixed-chassis --sweep 20`: 20 of 20 arrive, 20 of 20 tip over.
#[test]
fn the_side_slope_tips_the_fixed_chassis_over_and_not_the_one_that_leans() {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/scenarios/side-slope.toml");
    let scenario = read_scenario(&file).unwrap();
    for seed in 1..=3 {
        let fixed = driven(&scenario, Pilot::FixedChassis, seed, |_| ());
        assert_eq!(fixed.outcome, Outcome::Tipped);
        assert_eq!(fixed.ledger.actuators, 0.0);
        let leans = driven(&scenario, Pilot::Controller, seed, |_| ());
        assert_eq!(leans.outcome, Outcome::Arrived);
        assert!(
            leans.min_tip_over_margin.unwrap() > 0.1,
            "{:?}",
            leans.min_tip_over_margin
        );
        assert!(leans.energy_error.abs() < 0.01, "{}", leans.energy_error);
        let drawn = leans.ledger.actuators;
        assert!(
            drawn > 1.0 && drawn < 0.2 * leans.energy,
            "{drawn} of {}",
            leans.energy
        );
    }
}

/// Over stones of up to half a wheel's height the margin is larger on average and its minimum too.
#[test]
fn over_stones_the_chassis_keeps_further_from_tipping_over() {
    let text = "format = 1\ntitle = \"Stones\"\nrobot = \"shoulders.toml\"\nduration_s = 60.0\n[start]\nx_m = 1.0\n\
        [ground]\nkind = \"slope\"\nslope_deg = 0.0\nsize_x_m = 10.0\nsize_y_m = 6.0\nsoil = \"dry-sand\"\n\
        rocks_per_m2 = 3.0\nrock_size_m = 0.3\n[[leg]]\nspeed_m_per_s = 0.2\ndistance_m = 6.0\n";
    let document = Document::from_text("stones.toml", text.into()).unwrap();
    let scenario = parse_scenario(&document, "stones", robot()).unwrap();
    for seed in 1..=3 {
        let margins = |pilot| {
            let (mut sum, mut count) = (0.0, 0.0);
            let result = driven(&scenario, pilot, seed, |margin| {
                sum += margin;
                count += 1.0;
            });
            println!(
                "{} {seed}: {:?}, mean {}, minimum {:?}",
                pilot.name(),
                result.outcome,
                sum / count,
                result.min_tip_over_margin
            );
            (sum / count, result.min_tip_over_margin.unwrap())
        };
        let (fixed, moved) = (margins(Pilot::FixedChassis), margins(Pilot::Controller));
        assert!(
            moved.0 > fixed.0 && moved.1 > fixed.1,
            "{fixed:?} {moved:?}"
        );
    }
}
