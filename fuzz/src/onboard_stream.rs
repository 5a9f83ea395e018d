//! The robot's computer under any samples, requests, settings and saved states: commands finite and within their limits.

use std::sync::LazyLock;

use grouser_slip::control::{ControlSettings, Decides, Request};
use grouser_slip::detect::DetectSettings;
use grouser_slip::filter::FilterSettings;
use grouser_slip::onboard::{
    OnBoard, OnBoardSettings, SoilFamily, SoilLearnSettings, SoilTables, StartPolicy,
};
use grouser_slip::prior::SoilDoubt;
use grouser_terra::catalogue;

use crate::bytes::Bytes;
use crate::{settings, stream};

const WHEELS: u8 = 5;
const MAX_TORQUE_NM: f64 = 5.0;
const MAX_STEERING_RAD: f64 = 0.6;

/// Tables of the robot of [`stream::plain_robot`] on dry sand, which take a second.
static TABLES: LazyLock<SoilTables> = LazyLock::new(|| {
    let robot = stream::plain_robot(32, WHEELS);
    let mut setups = OnBoardSettings::new(&robot).wheels;
    for setup in &mut setups {
        setup.max_torque = Some(MAX_TORQUE_NM);
    }
    let soil = catalogue::find("dry-sand")
        .expect("a soil")
        .soil()
        .expect("its numbers");
    let mut tables =
        SoilTables::solve(&robot, &setups, &soil, SoilDoubt::default()).expect("tables");
    tables.family = Some(SoilFamily::solve(&robot, &setups, &soil).expect("a family"));
    tables
});

pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes(bytes);
    let robot = stream::plain_robot(32, WHEELS);
    let mut given = OnBoardSettings::new(&robot);
    given.filter = settings::drawn(&mut bytes, FilterSettings::FIELDS);
    given.detect = settings::drawn(&mut bytes, DetectSettings::FIELDS);
    let mut control: ControlSettings = settings::drawn(&mut bytes, ControlSettings::FIELDS);
    let flags = bytes.u8();
    control.decides = [
        Decides::Nothing,
        Decides::Stops,
        Decides::BacksOut,
        Decides::Everything,
    ][usize::from(flags % 4)];
    given.control = control;
    given.warm_up = given.warm_up.min(control.blind_time);
    if flags & 4 != 0 {
        given.soil = TABLES.clone();
        given.learn = (flags & 8 != 0).then(SoilLearnSettings::default);
    }
    if flags & 16 != 0 {
        given.start_policy = StartPolicy::Refuse;
    }
    for setup in &mut given.wheels {
        setup.max_torque = (flags & 32 != 0).then_some(MAX_TORQUE_NM);
        setup.max_steering_angle = if flags & 64 != 0 {
            MAX_STEERING_RAD
        } else {
            0.0
        };
    }
    let Ok(mut computer) = OnBoard::new(&robot, given.clone()) else {
        return;
    };
    let mut request = Request {
        speed: 0.3,
        heading: 0.0,
        yaw_rate: None,
    };
    let mut time_ns = 0_i64;
    while !bytes.is_empty() {
        time_ns = stream::time(&mut bytes, time_ns);
        match bytes.u8() % 16 {
            0 => {
                request = Request {
                    speed: bytes.any(),
                    heading: bytes.any(),
                    yaw_rate: (bytes.u8() % 2 == 0).then(|| bytes.any()),
                };
            }
            1 => {
                let state = computer.state();
                if let Ok(mut other) = OnBoard::new(&robot, given.clone()) {
                    other.restore(&state).expect("its own state");
                    computer = other;
                }
            }
            2 => {
                let _ = computer
                    .set_steering_angle(usize::from(bytes.u8() % (WHEELS + 1)), bytes.any());
            }
            3..=9 => {
                let now_ns = time_ns.saturating_add(i64::from(bytes.u8()) * 1_000_000);
                computer.update_at(now_ns, stream::sample(&mut bytes, time_ns, WHEELS));
            }
            _ => check(&mut computer, time_ns, request, &control),
        }
    }
}

fn check(computer: &mut OnBoard, time_ns: i64, request: Request, control: &ControlSettings) {
    for command in computer.tick(time_ns, request) {
        let speed = command.rim_speed.abs();
        assert!(speed <= control.max_rim_speed, "{command:?}");
        assert!(
            (0.0..=control.max_traction).contains(&command.traction),
            "{command:?}"
        );
        assert!(
            command.steering_angle.abs() <= MAX_STEERING_RAD + 1e-9,
            "{command:?}"
        );
    }
    if let Some(soil) = computer.soil() {
        let reported = soil.estimate();
        for interval in [
            reported.strength,
            reported.stiffness,
            reported.friction_angle,
        ] {
            assert!(
                interval.low <= interval.mean && interval.mean <= interval.high,
                "{reported:?}"
            );
        }
    }
    stream::check(computer.estimate().wheels);
}
