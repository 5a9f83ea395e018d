//! What sensors in the field send: fixes of satellite receivers with and without a position, an IMU mounted at an angle, a
//! bag beside a table, clocks that are set.

use std::fmt::Write as _;
use std::fs;

use grouser_files::Document;
use grouser_files::columns::{self, Meaning};
use grouser_files::robot;
use grouser_log::message::{Value, build};
use grouser_log::{Error, Log};
use grouser_slip::{Measurement, Sample};

use crate::carts::{Message, WHEELS, log, readings, robot};
use crate::recordings::write;
use crate::scratch::Folder;

const IMU: &str = "sensor_msgs/Imu";
const FIX: &str = "sensor_msgs/NavSatFix";
const SECOND_NS: i64 = 1_000_000_000;

fn imu(time_ns: i64, rate: [f64; 3], acceleration: [f64; 3]) -> Message {
    let value = build::message([
        ("header", build::header(time_ns, "imu_link")),
        ("orientation", build::turn(0.0)),
        ("orientation_covariance", build::numbers(&[-1.0; 9])),
        ("angular_velocity", build::vector(rate)),
        ("angular_velocity_covariance", build::numbers(&[0.0; 9])),
        ("linear_acceleration", build::vector(acceleration)),
        ("linear_acceleration_covariance", build::numbers(&[0.0; 9])),
    ]);
    ("/imu", IMU, time_ns, value)
}

/// A fix of this status at a latitude; `variance` stands on the diagonal of a covariance of a known kind.
fn fix(time_ns: i64, status: i64, latitude: f64, variance: f64) -> Message {
    let mut covariance = [0.0; 9];
    for place in [0, 4, 8] {
        covariance[place] = variance;
    }
    let value = build::message([
        ("header", build::header(time_ns, "gps")),
        (
            "status",
            build::message([("status", Value::Int(status)), ("service", Value::UInt(1))]),
        ),
        ("latitude", Value::Float(latitude)),
        (
            "longitude",
            Value::Float(if latitude.is_nan() { f64::NAN } else { 9.0 }),
        ),
        ("altitude", Value::Float(400.0)),
        ("position_covariance", build::numbers(&covariance)),
        ("position_covariance_type", Value::UInt(2)),
    ]);
    ("/gps/fix", FIX, time_ns, value)
}

/// A drive to the north at 1 m/s, fixes at 5 Hz.
fn drive(status: i64, variance: f64) -> Vec<Message> {
    let at = |k: i64| 45.0 + 0.2 * k as f64 / 30.87 / 3600.0;
    (0..20)
        .map(|k| fix((k + 1) * SECOND_NS / 5, status, at(k), variance))
        .collect()
}

#[test]
fn fixes_are_used_once_the_receiver_has_its_solution() {
    let folder = Folder::new("fixes");
    // A receiver that starts has no position, then a poor one.
    let mut messages: Vec<Message> = (1..5).map(|k| fix(k, -1, 0.0, 0.0)).collect();
    messages.extend((5..9).map(|k| fix(k, 0, 45.0, 4.0)));
    messages.extend(drive(2, 4e-4));
    let log = log(&folder, "", &messages);
    assert!(log.measures(Meaning::DisplacementForward));
    assert!((log.position_sigma().unwrap() - 0.02).abs() < 1e-12);
    let ways: Vec<f64> = readings(&log)
        .iter()
        .filter_map(|sample| match sample.measurement {
            Measurement::Displacement { forward, .. } => Some(forward),
            _ => None,
        })
        .collect();
    assert!(
        ways.len() >= 18 && ways.iter().all(|way| (way - 0.2).abs() < 1e-3),
        "{ways:?}"
    );
    let left_out = log.left_out();
    assert_eq!(left_out.excluded, 8);
    assert!(left_out.exclusion.unwrap().contains("without a position"));
}

#[test]
fn fixes_of_metres_are_used_where_there_are_no_better_ones() {
    let folder = Folder::new("metres");
    // a covariance of 0 is an unknown one, and satellites alone are no better than metres
    for (variance, sigma, says) in [
        (
            0.36,
            0.6,
            "`/gps/fix` has fixes with a standard deviation of 0.6 m: ",
        ),
        (
            100.0,
            10.0,
            "`/gps/fix` has fixes with a standard deviation of 10.0 m: ",
        ),
        (
            0.0,
            2.5,
            "`/gps/fix` does not say how accurate its fixes are, assumed is a standard deviation of 2.5 m: ",
        ),
    ] {
        let found = log(&folder, "", &drive(0, variance));
        assert!(found.measures(Meaning::DisplacementForward));
        assert!((found.position_sigma().unwrap() - sigma).abs() < 1e-12);
        let [note] = found.notes() else {
            panic!("{:?}", found.notes())
        };
        assert!(note.starts_with(says), "{note}");
        // the course is taken over four standard deviations
        let all = readings(&found);
        let is_way = |one: &&Sample| matches!(one.measurement, Measurement::Displacement { .. });
        let ways = all.iter().filter(is_way).count();
        assert!(
            if sigma < 2.0 { ways > 0 } else { ways == 0 },
            "{sigma}: {ways}"
        );
        assert_eq!(found.left_out().excluded, 0);
    }
    // one accurate fix in ten
    for (poor, are_left_out) in [(9, true), (10, false)] {
        let mut messages = drive(0, 1.44)[..poor].to_vec();
        messages.push(fix(3 * SECOND_NS, 2, 45.0, 0.25));
        let found = log(&folder, "", &messages);
        let sigma = if are_left_out { 0.5 } else { 1.2 };
        assert!((found.position_sigma().unwrap() - sigma).abs() < 1e-12);
        assert_eq!(found.notes().is_empty(), are_left_out);
        readings(&found);
        let left_out = found.left_out();
        let count = if are_left_out { poor as u64 } else { 0 };
        assert_eq!(left_out.excluded, count, "{:?}", left_out.exclusion);
        assert!(
            left_out
                .exclusion
                .is_none_or(|why| why.contains("that has better ones"))
        );
    }
}

#[test]
fn fixes_that_measure_nothing_are_excluded_with_their_reason() {
    for (name, message, reason) in [
        ("latitude", fix(5, 2, 91.0, 4e-4), "out of range"),
        ("no-fix", fix(5, -1, 45.0, 4e-4), "without a position"),
        ("altitude", fix(5, 2, f64::NAN, 4e-4), "or missing"),
        ("covariance", fix(5, 0, 45.0, 100.1), "above 10 m"),
    ] {
        let folder = Folder::new(name);
        // alone the topic is not used, with a note
        let alone = log(
            &folder,
            "",
            &[message.clone(), imu(6, [0.0; 3], [0.0, 0.0, 9.8])],
        );
        assert!(!alone.measures(Meaning::DisplacementForward), "{name}");
        assert!(
            alone.notes().join("\n").contains(reason),
            "{name}: {:?}",
            alone.notes()
        );
        // among others it is left out and counted
        let mut messages = drive(2, 4e-4);
        messages.push(("/gps/fix", FIX, 5 * SECOND_NS, message.3));
        let among = log(&folder, "", &messages);
        assert!(!readings(&among).is_empty(), "{name}");
        assert_eq!((among.left_out().excluded, name), (1, name));
        assert!(
            among.left_out().exclusion.unwrap().contains(reason),
            "{name}"
        );
    }
    // With a ground station a covariance of 0 is a centimetre solution of unknown error.
    let folder = Folder::new("rtk");
    let log = log(&folder, "", &drive(2, 0.0));
    assert!((log.position_sigma().unwrap() - 0.02).abs() < 1e-12);
}

#[test]
fn the_antennas_place_is_a_key_and_needs_a_gyro() {
    let folder = Folder::new("antenna");
    let antenna = "[topics]\nfix = \"/gps/fix\"\nantenna_x_m = 0.4";
    let log = log(&folder, antenna, &drive(2, 4e-4));
    assert!(
        log.notes().join("\n").contains("antenna"),
        "{:?}",
        log.notes()
    );
    let text = robot::to_toml(&robot(antenna));
    let again = robot::parse(&Document::from_text("again.toml", text).unwrap()).unwrap();
    assert_eq!(again.topics.antenna, [0.4, 0.0]);
    assert_eq!(again.topics.fix.as_deref(), Some("/gps/fix"));
}

#[test]
fn an_imu_may_be_mounted_by_roll_pitch_and_yaw() {
    let folder = Folder::new("angles");
    // On its left side and turned round: its z axis points to the robot's right, its x axis backwards, its y axis up.
    let messages = [imu(2, [0.0, 0.3, 0.0], [-0.5, 9.8, 0.2])];
    let mounted = "[topics]\nimu_roll_deg = 90.0\nimu_yaw_deg = 180.0";
    let log = log(&folder, mounted, &messages);
    let found: Vec<Measurement> = readings(&log).iter().map(|s| s.measurement).collect();
    let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
    assert!(
        found
            .iter()
            .any(|m| matches!(m, Measurement::YawRate { rate } if close(*rate, 0.3))),
        "{found:?}"
    );
    assert!(
        found
            .iter()
            .any(|m| matches!(m, Measurement::Acceleration { forward, left }
            if close(*forward, 0.5) && close(*left, 0.2))),
        "{found:?}"
    );
    let file = robot(mounted);
    let again = Document::from_text("again.toml", robot::to_toml(&file)).unwrap();
    assert_eq!(robot::parse(&again).unwrap(), file);
    let both = format!("format = 1\nname = \"cart\"\n{mounted}\nimu_up = \"z\"\n{WHEELS}");
    let error = robot::parse(&Document::from_text("robot.toml", both).unwrap()).unwrap_err();
    assert!(
        error.to_string().contains("by its angles and by `imu_up`"),
        "{error}"
    );
}

#[test]
fn an_imu_in_a_frame_that_does_not_exist_is_named() {
    let folder = Folder::new("frame");
    let transforms = build::message([(
        "transforms",
        Value::Array(vec![build::message([
            ("header", build::header(1, "base_link")),
            ("child_frame_id", Value::Text("imu".into())),
            (
                "transform",
                build::message([
                    ("translation", build::vector([0.0; 3])),
                    ("rotation", build::turn(0.0)),
                ]),
            ),
        ])]),
    )]);
    let messages = [
        ("/tf_static", "tf2_msgs/TFMessage", 1, transforms),
        imu(2, [0.0, 0.0, 0.1], [0.0, 0.0, 9.8]),
    ];
    let notes = log(&folder, "", &messages).notes().join("\n");
    assert!(
        notes.contains("no transform holds its frame `imu_link`"),
        "{notes}"
    );
}

fn map(text: &str) -> columns::ColumnMap {
    let text = format!("format = 1\n[[table]]\n{text}");
    columns::parse(&Document::from_text("map.toml", text).unwrap()).unwrap()
}

const WHEEL: &str = "columns = [{ column = \"left\", meaning = \"wheel_rate\", wheel = \"left\", unit = \"rad/s\" }]";

#[test]
fn a_bag_and_a_table_are_on_one_clock_or_refused() {
    let folder = Folder::new("clocks");
    let start = 1_700_000_000_i64;
    let messages: Vec<Message> = (0..100)
        .map(|k| {
            imu(
                start * SECOND_NS + k * 10_000_000,
                [0.0, 0.0, 0.1],
                [0.0, 0.0, 9.8],
            )
        })
        .collect();
    let bag = write(&folder.0.join("run.mcap"), &messages);
    let mut table = String::from("t,left\n");
    for k in 0..100 {
        writeln!(table, "{},1.0", f64::from(k) * 0.01).unwrap();
    }
    let wheels = folder.0.join("wheels.csv");
    fs::write(&wheels, table).unwrap();
    let open = |time: &str| {
        let map = map(&format!("file = \"wheels.csv\"\n{time}\n{WHEEL}"));
        let paths = [bag.clone(), wheels.clone()];
        let log = Log::find_any(&paths, Some(map), &robot("").topics).unwrap();
        log.samples(&[])
            .unwrap()
            .collect::<Result<Vec<Sample>, Error>>()
    };
    let apart = open("time = { column = \"t\", unit = \"s\" }").unwrap_err();
    assert!(
        matches!(&apart, Error::Apart { by_s, .. } if (by_s - 1.7e9).abs() < 10.0),
        "{apart}"
    );
    assert!(apart.hint().unwrap().contains("offset_s"));
    let together =
        open("time = { column = \"t\", unit = \"s\", offset_s = 1_700_000_000.0 }").unwrap();
    let is_wheel = |sample: &Sample| matches!(sample.measurement, Measurement::WheelRate { .. });
    let first = together.iter().find(|sample| is_wheel(sample)).unwrap();
    assert_eq!(first.time_ns, start * SECOND_NS);
    assert_eq!(
        together.iter().filter(|sample| is_wheel(sample)).count(),
        100
    );
}

#[test]
fn a_date_that_jumps_back_is_an_error_with_its_place() {
    let map = map(&format!(
        "time = {{ column = \"t\", unit = \"date\" }}\n{WHEEL}"
    ));
    let table = "t,left\n2026-03-02T09:15:30Z,1\n2026-03-02T09:15:31Z,1\n2026-03-01T09:15:32Z,1\n";
    let bytes = std::io::Cursor::new(table.as_bytes());
    let log = Log::over("log.csv".as_ref(), bytes, Some(map), &robot("").topics).unwrap();
    let error = log.samples(&[]).unwrap().find_map(Result::err).unwrap();
    assert!(
        matches!(&error, Error::SetBack { at, by_s } if at.line == 4 && (by_s - 86_399.0).abs() < 1e-6),
        "{error}"
    );
}

/// Of a table's rows, by its columns.
fn table(columns: &str, rows: &str) -> Log {
    let map = map(&format!(
        "time = {{ column = \"t\", unit = \"s\" }}\n{columns}"
    ));
    let bytes = std::io::Cursor::new(rows.to_owned());
    Log::over("log.csv".as_ref(), bytes, Some(map), &robot("").topics).unwrap()
}

const PLACE: &str = "columns = [{ column = \"x\", meaning = \"pose_x\", unit = \"m\" }, \
     { column = \"y\", meaning = \"pose_y\", unit = \"m\" }, { column = \"yaw\", meaning = \"pose_yaw\", unit = \"rad\" }]";

#[test]
fn a_clock_is_set_back_by_more_than_a_minute() {
    let error = |rows: &str| {
        table(WHEEL, rows)
            .samples(&[])
            .unwrap()
            .find_map(Result::err)
    };
    assert!(error("t,left\n100,1\n40.001,1\n").is_none());
    let more = error("t,left\n100,1\n39.999,1\n").unwrap();
    assert!(matches!(more, Error::SetBack { .. }), "{more}");
}

/// A pose of zeros far from there, in a table that is filled up with them, is none: from 0.05 m on.
#[test]
fn zeros_beside_a_pose_that_is_far_are_none() {
    for (x, poses) in [("0.05", 2), ("0.051", 1)] {
        let log = table(PLACE, &format!("t,x,y,yaw\n1,{x},0,0\n2,0,0,0\n"));
        assert_eq!(readings(&log).len(), poses, "{x}");
    }
}

/// Of two tables of places without a heading one is followed, and the other is as if it were not there.
#[test]
fn one_table_of_places_is_followed() {
    let folder = Folder::new("places");
    let place = "{ column = \"x\", meaning = \"pose_x\", unit = \"m\" }, { column = \"y\", meaning = \"pose_y\", unit = \"m\" }";
    let gyro = "{ column = \"g\", meaning = \"yaw_rate\", unit = \"rad/s\" }";
    let rows = |by: f64| {
        let row = |k: i32| format!("{},{},{by},0\n", 0.1 * f64::from(k), 0.05 * f64::from(k));
        format!("t,x,y,g\n{}", (0..100).map(row).collect::<String>())
    };
    let read = |second: &str| {
        let paths = [("a.csv", 0.0), ("b.csv", 0.3)].map(|(name, by)| {
            let path = folder.0.join(name);
            fs::write(&path, rows(by)).unwrap();
            path
        });
        let time = "time = { column = \"t\", unit = \"s\" }";
        let map = map(&format!(
            "file = \"a.csv\"\n{time}\ncolumns = [{place}, {gyro}]\n[[table]]\nfile = \"b.csv\"\n{time}\ncolumns = [{second}]"
        ));
        readings(&Log::find_any(&paths, Some(map), &robot("").topics).unwrap())
    };
    assert_eq!(
        read(place).len(),
        read("{ column = \"g\", meaning = \"acceleration_forward\", unit = \"m/s2\" }").len() - 100
    );
}

#[test]
fn a_log_of_tables_is_known() {
    use grouser_log::Measures as _;
    assert!(table(WHEEL, "t,left\n1,1\n").is_of_tables());
    let folder = Folder::new("messages");
    assert!(!log(&folder, "", &[imu(SECOND_NS, [0.0; 3], [0.0, 0.0, 9.8])]).is_of_tables());
}

#[test]
fn one_axis_of_an_accelerometer_is_a_measurement() {
    let map = map("time = { column = \"t\", unit = \"s\" }\ncolumns = [\
         { column = \"a\", meaning = \"acceleration_forward\", unit = \"g\" }]");
    let bytes = std::io::Cursor::new(&b"t,a\n0,0.1\n"[..]);
    let log = Log::over("log.csv".as_ref(), bytes, Some(map), &robot("").topics).unwrap();
    assert!(log.measures(Meaning::AccelerationForward) && !log.measures(Meaning::AccelerationLeft));
    let found = readings(&log)[0].measurement;
    assert!(
        matches!(found, Measurement::Acceleration { forward, .. } if (forward - 0.980_665).abs() < 1e-12),
        "{found:?}"
    );
}

#[test]
fn files_of_one_clock_may_be_far_apart() {
    let folder = Folder::new("one-clock");
    let row = |k: i64| imu(k * SECOND_NS, [0.0, 0.0, 0.1], [0.0, 0.0, 9.8]);
    let files = [(0, 1), (1, 200)].map(|(number, second)| {
        write(&folder.0.join(format!("run_{number}.mcap")), &[row(second)])
    });
    let table = |seconds: &[i64]| {
        let rows = seconds.iter().map(|second| format!("{second},1.0\n"));
        let text = format!("t,left\n{}", rows.collect::<String>());
        folder.file("wheels.csv", text.as_bytes())
    };
    let time = "time = { column = \"t\", unit = \"s\" }";
    let count = |paths: &[std::path::PathBuf]| {
        let map = map(&format!("file = \"wheels.csv\"\n{time}\n{WHEEL}"));
        let log = Log::find_any(paths, Some(map), &robot("").topics).unwrap();
        let samples = log.samples(&[]).unwrap();
        samples
            .collect::<Result<Vec<Sample>, Error>>()
            .map(|all| all.len())
            .ok()
    };
    // the second file of the recording begins long after the table's end
    let [first, second] = files;
    assert_eq!(count(&[table(&[0]), first, second.clone()]), Some(3));
    // a recording begins long after a row of the table, which goes on
    assert_eq!(count(&[table(&[0, 1000]), second.clone()]), Some(3));
    assert_eq!(count(&[table(&[0]), second]), None);
}
