//! Soil learnt by the on-board computer, from sensors that the exact solver of another soil drives: not from the tables that
//! it chooses between.

use grouser_slip::control::Request;
use grouser_slip::onboard::{
    OnBoard, OnBoardSettings, SoilFamily, SoilInterval, SoilLearnSettings, SoilMember, SoilTables,
};
use grouser_slip::prior::{SoilDoubt, scaled_soil};
use grouser_slip::{Error, Measurement, Robot, Sample, Wheel};
use grouser_terra::{
    EARTH_GRAVITY_M_PER_S2, Kinematics, RigidWheel, Settings, Slip, SlopeOutcome, Soil,
    WheelOnSoil, catalogue,
};

const PERIOD_NS: i64 = 10_000_000;
const RADIUS_M: f64 = 0.1;
const WIDTH_M: f64 = 0.08;
const LOAD_N: f64 = 40.0;
const MAX_TORQUE_N_M: f64 = 8.0;
const TICKS_PER_TURN: u32 = 10_000;

/// Two powered wheels; a camera measures the way, so that no free wheel's skid is in the slip.
fn robot() -> Robot {
    let powered = |name: &str, y| {
        let wheel = Wheel::powered(name).at(0.0, y).radius(RADIUS_M);
        wheel
            .ticks_per_turn(TICKS_PER_TURN)
            .width(WIDTH_M)
            .load(LOAD_N)
    };
    Robot::new(
        "cart".into(),
        vec![powered("left", 0.2), powered("right", -0.2)],
    )
    .unwrap()
}

fn sand() -> Soil {
    catalogue::find("dry-sand").unwrap().soil().unwrap()
}

fn on_board() -> OnBoard {
    let robot = robot();
    let mut settings = OnBoardSettings::new(&robot);
    for setup in &mut settings.wheels {
        setup.max_torque = Some(MAX_TORQUE_N_M);
    }
    let doubt = SoilDoubt::default();
    settings.soil = SoilTables::solve(&robot, &settings.wheels, &sand(), doubt).unwrap();
    settings.soil.family = Some(SoilFamily::solve(&robot, &settings.wheels, &sand()).unwrap());
    settings.learn = Some(SoilLearnSettings::default());
    OnBoard::new(&robot, settings).unwrap()
}

/// Where the robot is in its drive.
struct Course {
    row: i64,
    angle: f64,
    way: f64,
    measures_torque: bool,
}

/// What a sensor of sinkage shows of the true one (m).
#[derive(Clone, Copy, PartialEq)]
enum Sensor {
    Absent,
    Sinkage,
    EntryAngle,
    /// NaN, below the ground, and beyond the radius in turn.
    Garbage,
    /// The same value all the time.
    Stuck,
}

/// Drives `rows` of 0.01 s at 0.25 m/s on `soil` at a slip; pull, torque and counts are those of the exact solver.
fn drive(on_board: &mut OnBoard, course: &mut Course, soil: &Soil, slip: f64, rows: i64) {
    drive_with(on_board, course, (soil, slip), rows, Sensor::Absent);
}

/// The same with a sensor of the wheels' sinkage ten times a second.
fn drive_with(
    on_board: &mut OnBoard,
    course: &mut Course,
    (soil, slip): (&Soil, f64),
    rows: i64,
    sensor: Sensor,
) {
    let wheel = RigidWheel::new(RADIUS_M, WIDTH_M).unwrap();
    let contact = WheelOnSoil::new(wheel, *soil, Settings::default()).unwrap();
    let kinematics = Kinematics::straight(Slip::new(slip).unwrap());
    let forces = contact.under_load(LOAD_N, &kinematics).unwrap();
    let point = forces.point().unwrap();
    let (forces, sinkage) = (point.forces, point.sinkage);
    let pull = forces.drawbar_pull / LOAD_N;
    // uphill as steep as it can, so that it travels steadily
    let (sin, cos) = pull.atan().sin_cos();
    let force = [
        sin * EARTH_GRAVITY_M_PER_S2,
        0.0,
        cos * EARTH_GRAVITY_M_PER_S2,
    ];
    for _ in 0..rows {
        let time_ns = course.row * PERIOD_NS;
        let runs = course.row > 200;
        let speed = if runs { 0.25 } else { 0.0 };
        course.way += 0.01 * speed;
        course.angle += 0.01 * speed / (1.0 - slip) / RADIUS_M;
        let turns = course.angle / std::f64::consts::TAU;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a counter of whole ticks"
        )]
        let raw = (turns * f64::from(TICKS_PER_TURN)) as u64;
        let torque = if runs { forces.torque } else { 0.0 };
        let mut measurements = vec![
            Measurement::Inertial {
                force,
                rate: [0.0; 3],
            },
            Measurement::Displacement {
                forward: 0.01 * speed,
                left: 0.0,
                turn: None,
            },
        ];
        for wheel in 0..2 {
            measurements.push(Measurement::WheelCount { wheel, raw });
            let share = torque / MAX_TORQUE_N_M;
            if course.measures_torque {
                measurements.push(Measurement::MotorCurrent { wheel, share });
            }
            if sensor != Sensor::Absent && course.row % 10 == 0 {
                // a millimetre of noise with zero mean
                let turn = usize::try_from(course.row / 10 % 3).unwrap();
                let depth = sinkage + 0.001 * f64::from([-1_i8, 0, 1][turn]);
                measurements.push(match sensor {
                    Sensor::EntryAngle => Measurement::EntryAngle {
                        wheel,
                        angle: (1.0 - depth / RADIUS_M).acos(),
                    },
                    Sensor::Garbage => Measurement::Sinkage {
                        wheel,
                        depth: [f64::NAN, -0.05, 0.5][turn],
                    },
                    Sensor::Stuck => Measurement::Sinkage { wheel, depth: 0.09 },
                    _ => Measurement::Sinkage { wheel, depth },
                });
            }
        }
        for measurement in measurements {
            on_board.update(Sample {
                time_ns,
                measurement,
            });
        }
        on_board.tick(
            time_ns,
            Request {
                speed: 0.25,
                heading: 0.0,
                yaw_rate: None,
            },
        );
        course.row += 1;
    }
}

fn start() -> Course {
    Course {
        row: 0,
        angle: 0.0,
        way: 0.0,
        measures_torque: true,
    }
}

#[test]
fn strength_and_stiffness_are_found_and_forgotten_again() {
    let mut robot = on_board();
    let mut course = start();
    let weak = scaled_soil(&sand(), 0.7, 4.0).unwrap();
    assert!(robot.soil().unwrap().demand(0.1).is_none());
    drive(&mut robot, &mut course, &weak, 0.3, 6000);
    let learnt = robot.soil().unwrap().estimate();
    assert!(learnt.readings > 30, "{learnt:?}");
    for (of, truth) in [(learnt.strength, 0.7), (learnt.stiffness, 4.0)] {
        assert!(of.low < truth && truth < of.high, "{learnt:?}");
    }
    assert!(learnt.strength.mean < 0.8 && learnt.stiffness.mean > 2.5);
    // the exact solver of the weak soil, up to any slip: what 1° uphill demands
    let slope = 1.0_f64.to_radians();
    let wheel = RigidWheel::new(RADIUS_M, WIDTH_M).unwrap();
    let settings = Settings {
        max_slip: 1.0,
        ..Settings::default()
    };
    let contact = WheelOnSoil::new(wheel, weak, settings).unwrap();
    let exact = contact
        .slip_demand(LOAD_N, grouser_terra::Angle::from_rad(slope))
        .unwrap();
    let SlopeOutcome::Holds { slip: exact } = exact else {
        panic!("{exact:?}");
    };
    let exact = exact.value();
    let demand = robot.soil().unwrap().demand(slope).unwrap();
    let slip = demand.slip.unwrap();
    assert!(
        (slip.mean - exact).abs() < 2.0 * slip.sigma,
        "{slip:?} {exact}"
    );
    assert!(demand.fails < 0.5);
    assert!(robot.soil().unwrap().demand(0.5).unwrap().fails > 0.9);
    // back on the known sand
    drive(&mut robot, &mut course, &sand(), 0.2, 6000);
    let back = robot.soil().unwrap().estimate();
    assert!(
        back.strength.mean > 0.85 && back.stiffness.mean < 2.0,
        "{back:?}"
    );
    assert!(back.changes > learnt.changes);
}

#[test]
fn sinkages_and_entry_angles_tell_stiffness_from_strength() {
    let soil = scaled_soil(&sand(), 0.7, 0.8).unwrap();
    let learn = |sensor| {
        let mut robot = on_board();
        // pull alone: stiff and weak, or soft and strong?
        let mut course = start();
        course.measures_torque = false;
        drive_with(&mut robot, &mut course, (&soil, 0.3), 800, sensor);
        robot.soil().unwrap().estimate()
    };
    let without = learn(Sensor::Absent);
    assert_eq!(without.contact_readings, 0);
    for sensor in [Sensor::Sinkage, Sensor::EntryAngle] {
        let with = learn(sensor);
        assert_eq!(with.readings, without.readings);
        assert!(
            with.contact_readings > 3 && with.contacts_refused == 0,
            "{with:?}"
        );
        assert!(
            with.stiffness.low < 0.8 && 0.8 < with.stiffness.high,
            "{with:?}"
        );
        let ratio = |of: SoilInterval| (of.high / of.low).ln();
        assert!(
            ratio(with.stiffness) < 0.9 * ratio(without.stiffness),
            "{with:?} {without:?}"
        );
    }
}

#[test]
fn a_broken_sensor_of_sinkage_changes_nothing() {
    let learn = |sensor| {
        let mut robot = on_board();
        drive_with(&mut robot, &mut start(), (&sand(), 0.3), 6000, sensor);
        (
            robot.state().soil.unwrap(),
            robot.soil().unwrap().estimate(),
        )
    };
    let (belief, _) = learn(Sensor::Absent);
    let (by_garbage, estimate) = learn(Sensor::Garbage);
    assert_eq!(by_garbage, belief);
    assert_eq!(
        (estimate.contacts_refused, estimate.contact_readings),
        (1200, 0)
    );
    let (by_stuck, estimate) = learn(Sensor::Stuck);
    assert_eq!(by_stuck, belief);
    assert!(
        estimate.contacts_stuck > 30 && estimate.contact_readings == 0,
        "{estimate:?}"
    );
}

#[test]
fn the_ground_that_soft_ground_is_compared_with_follows_a_robot_s_length_later() {
    let mut robot = on_board();
    let mut course = start();
    let weak = scaled_soil(&sand(), 0.7, 4.0).unwrap();
    drive(&mut robot, &mut course, &weak, 0.3, 6000);
    let slope = 1.0_f64.to_radians();
    let mean = |robot: &OnBoard, before: bool| {
        let soil = robot.soil().unwrap();
        let demand = if before {
            soil.demand_before(slope)
        } else {
            soil.demand(slope)
        };
        demand.and_then(|demand| demand.slip).unwrap().mean
    };
    let on_weak = mean(&robot, true);
    assert!((mean(&robot, false) - on_weak).abs() < 0.02);
    // another soil moves the newest belief, and not yet what soft ground is reported from
    let before = robot.soil().unwrap().estimate();
    while robot.soil().unwrap().estimate().changes == before.changes {
        assert!(course.row < 12_000, "the belief never changed");
        drive(&mut robot, &mut course, &sand(), 0.2, 10);
    }
    assert!((mean(&robot, false) - on_weak).abs() > 1e-3);
    assert!((mean(&robot, true) - on_weak).abs() < 1e-12);
    // once the robot has driven on, it follows
    drive(&mut robot, &mut course, &sand(), 0.2, 6000);
    assert!((mean(&robot, true) - mean(&robot, false)).abs() < 1e-3);
    assert!((mean(&robot, true) - on_weak).abs() > 1e-3);
}

#[test]
fn a_belief_outlasts_a_restart_and_a_broken_one_is_refused() {
    let mut robot = on_board();
    let weak = scaled_soil(&sand(), 0.7, 4.0).unwrap();
    drive(&mut robot, &mut start(), &weak, 0.3, 4000);
    let state = robot.state();
    let mut after = on_board();
    after.restore(&state).unwrap();
    assert_eq!(after.state().soil, state.soil);
    // the belief in use before is older by less than the hysteresis
    let fails = |robot: &OnBoard| robot.soil().unwrap().demand(0.15).unwrap().fails;
    let hysteresis = SoilLearnSettings::default().hysteresis;
    assert!((fails(&after) - fails(&robot)).abs() < hysteresis);
    let unchanged = after.state();
    for weight in [f64::NAN, -0.1, 0.9] {
        let mut broken = state;
        let mut belief = broken.soil.unwrap();
        belief.weights[15] = weight;
        broken.soil = Some(belief);
        assert!(after.restore(&broken).is_err(), "{weight}");
        assert_eq!(after.state(), unchanged);
    }
}

#[test]
fn a_family_that_is_none_is_refused() {
    let robot = robot();
    let mut settings = OnBoardSettings::new(&robot);
    settings.learn = Some(SoilLearnSettings::default());
    let error = OnBoard::new(&robot, settings.clone()).unwrap_err();
    assert_eq!(error, Error::MissingFamily);
    // no wheel has a motor
    assert!(SoilFamily::solve(&robot, &settings.wheels, &sand()).is_err());
    for setup in &mut settings.wheels {
        setup.max_torque = Some(MAX_TORQUE_N_M);
    }
    let family = SoilFamily::solve(&robot, &settings.wheels, &sand()).unwrap();
    let members: Vec<SoilMember> = family.members().to_vec();
    assert!(SoilFamily::from_members(&members, family.friction()).is_ok());
    assert!(SoilFamily::from_members(&members[1..], family.friction()).is_err());
    let mut broken = members;
    broken[3].pulls[7] = f64::NAN;
    assert!(SoilFamily::from_members(&broken, family.friction()).is_err());
}

/// Every number that a drive over three soils leaves, as it was when the figures of RESULTS.md were measured: what moves one
/// moves them. `GROUSER_WRITE_PINNED=1` writes them anew.
#[test]
fn a_drive_over_three_soils_ends_in_the_same_numbers() {
    let mut robot = on_board();
    let mut course = start();
    let mut lines = Vec::new();
    let weak = scaled_soil(&sand(), 0.7, 4.0).unwrap();
    let soft = scaled_soil(&sand(), 0.9, 0.6).unwrap();
    for (leg, soil, slip, rows, sensor) in [
        ("weak", &weak, 0.3, 900, Sensor::Absent),
        ("sand", &sand(), 0.15, 1500, Sensor::EntryAngle),
        ("soft", &soft, 0.25, 1000, Sensor::Sinkage),
    ] {
        drive_with(&mut robot, &mut course, (soil, slip), rows, sensor);
        let mut line = |name: &str, values: &[f64]| {
            let values: Vec<String> = values.iter().map(|x| format!("{x:.9e}")).collect();
            lines.push(format!("{leg} {name} {}", values.join(" ")));
        };
        let learner = robot.soil().unwrap();
        let of = |x: SoilInterval| [x.mean, x.low, x.high];
        let learnt = learner.estimate();
        line("strength", &of(learnt.strength));
        line("stiffness", &of(learnt.stiffness));
        line("friction", &of(learnt.friction_angle));
        let counts = [learnt.readings, learnt.contact_readings, learnt.changes];
        line("counts", &counts.map(f64::from));
        line(
            "scale",
            &[learnt.error_scale, learner.running_slip().unwrap()],
        );
        line("weights", &learner.belief().weights);
        for slip in [0.02, 0.33, 0.9] {
            line("pull", &of(learner.predict_pull(slip, 0.03)));
            line("torque", &[learner.torque_ratio(slip)]);
        }
        for slope in [-0.1, 0.0, 0.07, 0.2, 0.4] {
            for demand in [learner.demand(slope), learner.demand_before(slope)] {
                let demand = demand.unwrap();
                let slip = demand.slip.map_or([2.0; 2], |slip| [slip.mean, slip.sigma]);
                line("demand", &[demand.fails, slip[0], slip[1]]);
            }
        }
        let seen = robot.observations()[1];
        let firmness = seen.firmness.unwrap_or(-1.0);
        let speeds = [seen.forward_speed, seen.rim_speed, robot.speed()];
        line(
            "wheel",
            &[seen.slip.unwrap(), seen.sigma.unwrap(), firmness],
        );
        line("speeds", &speeds.map(Option::unwrap));
        let attitude = robot.attitude();
        line(
            "attitude",
            &[attitude.roll(), attitude.pitch(), attitude.heading()],
        );
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/learnt_soil/drive.txt");
    if std::env::var_os("GROUSER_WRITE_PINNED").is_some() {
        std::fs::create_dir_all(std::path::Path::new(path).parent().unwrap()).unwrap();
        std::fs::write(path, lines.join("\n") + "\n").unwrap();
    }
    let pinned = std::fs::read_to_string(path).unwrap();
    assert_eq!(pinned.lines().count(), lines.len());
    for (expected, found) in pinned.lines().zip(&lines) {
        let numbers = |line: &str| -> Vec<f64> {
            line.split(' ')
                .filter_map(|word| word.parse().ok())
                .collect()
        };
        let (expected_numbers, found_numbers) = (numbers(expected), numbers(found));
        assert_eq!(expected_numbers.len(), found_numbers.len(), "{expected}");
        for (a, b) in expected_numbers.iter().zip(&found_numbers) {
            // another platform's functions differ in the last bits
            assert!(
                (a - b).abs() <= 1e-7 * a.abs() + 1e-12,
                "{expected} was, {found} is"
            );
        }
    }
}
