//! `estimate --calibrate…` of logs in which something is wrong, of short logs, and of runs that differ; and `--truth` of tables that
//! do not fit the log.

use std::fmt::Write as _;
use std::process::Output;

use serde_json::Value;

use crate::repository;
use crate::repository::Folder;

const ROBOT: &str = "format = 1\nname = \"cart\"\n\
    [[table]]\nfile = \"*.csv\"\ntime = { column = \"t\", unit = \"s\" }\n\
    columns = [{ column = \"l\", meaning = \"wheel_angle\", wheel = \"left\", unit = \"rad\" }, \
    { column = \"r\", meaning = \"wheel_angle\", wheel = \"right\", unit = \"rad\" }, \
    { column = \"g\", meaning = \"yaw_rate\", unit = \"rad/s\" }, \
    { column = \"x\", meaning = \"pose_x\", unit = \"m\" }, \
    { column = \"y\", meaning = \"pose_y\", unit = \"m\" }, \
    { column = \"yaw\", meaning = \"pose_yaw\", unit = \"rad\" }]\n\
    [[wheel]]\nname = \"left\"\nx_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\n\
    [[wheel]]\nname = \"right\"\nx_m = 0.0\ny_m = -0.2\nradius_m = 0.1\ndrive = \"powered\"\n";

/// What is wrong in a log.
#[derive(Clone, Copy)]
struct Drive {
    duration_s: u32,
    /// True radius over that of the robot file.
    radius: f64,
    /// The yaw of the pose is this much more than that of the robot, rad.
    yaw_offset: f64,
    gyro_scale: f64,
    is_left_standing: bool,
    is_exchanged: bool,
    /// Share by which the left wheel's rim runs faster than the ground for one of eight seconds.
    left_slip: f64,
}

const SOUND: Drive = Drive {
    duration_s: 80,
    radius: 1.04,
    yaw_offset: 0.0,
    gyro_scale: 1.0,
    is_left_standing: false,
    is_exchanged: false,
    left_slip: 0.0,
};

impl Drive {
    /// A log of straight ways and bends to both sides at 50 Hz, with stops.
    fn log(self) -> String {
        let mut text = String::from("t,l,r,g,x,y,yaw\n");
        let (mut x, mut y, mut yaw) = (0.0, 0.0, 0.0_f64);
        let (mut left, mut right) = (0.0, 0.0);
        let (mut speed, mut rate) = (0.0, 0.0);
        let mut state = 7_u64;
        let mut noise = move |half_width: f64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            half_width * (2.0 * (state >> 32) as f64 / f64::from(u32::MAX) - 1.0)
        };
        for row in 0..50 * self.duration_s {
            let time_s = f64::from(row) * 0.02;
            let phase = row / 200 % 6;
            let wanted = [
                (0.0, 0.0),
                (0.5, 0.0),
                (0.4, 0.8),
                (0.5, 0.0),
                (0.4, -0.3),
                (0.3, 0.0),
            ][phase as usize];
            speed += (wanted.0 - speed) * 0.02 / 0.3;
            rate += (wanted.1 - rate) * 0.02 / 0.3;
            x += speed * 0.02 * yaw.cos();
            y += speed * 0.02 * yaw.sin();
            yaw += rate * 0.02;
            let is_slipping = row / 200 % 2 == 1;
            let faster = 1.0 + if is_slipping { self.left_slip } else { 0.0 };
            if !self.is_left_standing {
                left += faster * (speed - 0.2 * rate) * 0.02 / (0.1 * self.radius);
            }
            right += (speed + 0.2 * rate) * 0.02 / (0.1 * self.radius);
            let (l, r) = if self.is_exchanged {
                (right, left)
            } else {
                (left, right)
            };
            let _ = writeln!(
                text,
                "{time_s:.2},{l:.4},{r:.4},{:.5},{:.4},{:.4},{:.5}",
                self.gyro_scale * (rate + noise(0.005)),
                x + noise(0.002),
                y + noise(0.002),
                yaw + self.yaw_offset + noise(0.002),
            );
        }
        text
    }
}

/// The robot file, and a log of each drive.
fn logs(folder: &Folder, drives: &[Drive]) -> (String, Vec<String>) {
    let file =
        |(index, drive): (usize, &Drive)| folder.file(&format!("log{index}.csv"), drive.log());
    let logs = drives.iter().enumerate().map(file).collect();
    (folder.file("robot.toml", ROBOT), logs)
}

fn estimate(robot: &str, logs: &[String], more: &[&str]) -> Output {
    let logs: Vec<&str> = logs.iter().map(String::as_str).collect();
    repository::grouser(&[&["estimate"], &logs[..], &["--robot", robot], more].concat())
}

fn printed(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn what_estimate_finds_wrong_in_a_log_is_not_calibrated_away() {
    for (name, drive, found) in [
        (
            "yaw",
            Drive {
                yaw_offset: 0.35,
                ..SOUND
            },
            "to the left of the direction",
        ),
        (
            "standing",
            Drive {
                is_left_standing: true,
                ..SOUND
            },
            "left is `Invalid(Inconsistent)`",
        ),
        (
            "exchanged",
            Drive {
                is_exchanged: true,
                ..SOUND
            },
            "encoders are exchanged",
        ),
        (
            "gyro",
            Drive {
                gyro_scale: 57.3,
                ..SOUND
            },
            "the gyro turns by",
        ),
    ] {
        let folder = Folder::new(&format!("calibrate-wrong-{name}"));
        let (robot, logs) = logs(&folder, &[drive]);
        let target = folder.path("new.toml");
        for flag in ["--calibrate", "--calibrate-radius"] {
            let output = estimate(&robot, &logs, &[flag, &target]);
            let text = printed(&output);
            if output.status.code() == Some(2) {
                // the distances do not fit any radius
                assert!(text.contains("no effective radius"), "{name}: {text}");
                continue;
            }
            assert_eq!(output.status.code(), Some(3), "{name}: {text}");
            assert!(
                text.starts_with("WARNING: ") && text.contains(found),
                "{name}: {text}"
            );
            assert!(text.contains("new.toml` is not written"), "{name}: {text}");
            assert!(!std::path::Path::new(&target).exists(), "{name}");
        }
        let output = estimate(&robot, &logs, &["--calibrate", &target, "--json"]);
        let object = json(&output);
        assert!(object["output"].is_null(), "{name}: {object}");
        assert!(
            object["doubts"][0].as_str().unwrap().contains(found),
            "{name}: {object}"
        );
    }
}

/// Radii that are described badly are what the calibration is for.
#[test]
fn wrong_radii_are_calibrated_without_a_doubt() {
    for radius in [0.6, 0.8, 1.04, 1.3, 1.8] {
        let folder = Folder::new(&format!("calibrate-radius-{radius}"));
        let (robot, logs) = logs(&folder, &[Drive { radius, ..SOUND }]);
        let target = folder.path("new.toml");
        for (flag, key) in [
            ("--calibrate", "radius"),
            ("--calibrate-radius", "radius_factor"),
        ] {
            let output = estimate(&robot, &logs, &[flag, &target, "--json"]);
            assert_eq!(
                output.status.code(),
                Some(0),
                "{radius}: {}",
                printed(&output)
            );
            let object = json(&output);
            let factor = object[key]
                .as_f64()
                .or_else(|| object[key]["value"].as_f64());
            assert!(
                (factor.unwrap() / radius - 1.0).abs() < 0.01,
                "{radius}: {object}"
            );
            assert!(
                object["doubts"].as_array().unwrap().is_empty() && object["output"].is_string()
            );
        }
    }
}

#[test]
fn a_log_that_is_too_short_to_calibrate_is_doubtful() {
    let folder = Folder::new("calibrate-short");
    let (robot, logs) = logs(&folder, &[SOUND]);
    for flag in ["--calibrate", "--calibrate-radius"] {
        let output = estimate(
            &robot,
            &logs,
            &[flag, &folder.path("new.toml"), "--from-s", "77.5"],
        );
        let text = printed(&output);
        assert_eq!(output.status.code(), Some(3), "{text}");
        assert!(
            text.contains("WARNING: the wheels ran") && text.contains("wrote "),
            "{text}"
        );
    }
}

#[test]
fn a_log_counts_once() {
    let folder = Folder::new("calibrate-twice");
    let (robot, logs) = logs(&folder, &[SOUND]);
    let aside = folder.path("./log0.csv");
    let twice = [logs[0].clone(), aside];
    for flag in ["--calibrate", "--calibrate-radius", "--calibrate-intervals"] {
        let output = estimate(&robot, &twice, &[flag, &folder.path("new.toml")]);
        let text = printed(&output);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains("log0.csv` belongs to two LOGs"), "{text}");
    }
}

#[test]
fn the_interval_of_a_radius_contains_how_runs_differ() {
    let folder = Folder::new("calibrate-scatter");
    let radii = [0.98, 1.01, 0.995, 1.02];
    let drives = radii.map(|radius| Drive {
        radius,
        duration_s: 40,
        ..SOUND
    });
    let (robot, logs) = logs(&folder, &drives);
    let output = estimate(
        &robot,
        &logs,
        &["--calibrate", &folder.path("new.toml"), "--json"],
    );
    let object = json(&output);
    let [value, half] = ["value", "half_width"].map(|key| object["radius"][key].as_f64().unwrap());
    // their mean is 1.00125, with a standard error of 0.0087; Student's t of three degrees of freedom is 3.18
    assert!((value - 1.001).abs() < 0.003, "{object}");
    assert!((0.022..0.034).contains(&half), "{object}");
}

#[test]
fn few_runs_do_not_narrow_intervals() {
    let folder = Folder::new("calibrate-intervals-few");
    let (robot, logs) = logs(
        &folder,
        &[
            Drive {
                left_slip: 0.15,
                ..SOUND
            },
            SOUND,
            Drive {
                radius: 1.045,
                ..SOUND
            },
        ],
    );
    let output = estimate(
        &robot,
        &logs,
        &["--calibrate-intervals", &folder.path("new.toml")],
    );
    let text = printed(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(text.starts_with("interval factor: 1.000\n"), "{text}");
    assert!(
        text.contains("of the slips by the reference")
            && text.contains("not observable: errors of radii"),
        "{text}"
    );
}

/// A table of true slips of the left wheel at these times.
fn truth(times: impl Iterator<Item = f64>) -> String {
    let mut text = String::from("time_s,left_slip\n");
    for time in times {
        let _ = writeln!(text, "{time:.2},0.05");
    }
    text
}

#[test]
fn true_slips_that_do_not_fit_the_log_are_doubtful_or_refused() {
    let folder = Folder::new("truth-misfit");
    let (robot, logs) = logs(&folder, &[SOUND]);
    let compare = |name: &str, text: String| {
        let file = folder.file(name, text);
        let output = estimate(&robot, &logs, &["--truth", &file]);
        let object = estimate(&robot, &logs, &["--truth", &file, "--json"]);
        assert_eq!(output.status.code(), object.status.code());
        (output.status.code(), printed(&output), json(&object))
    };
    let times = || (0..4000).map(|row| f64::from(row) * 0.02);
    let (code, text, object) = compare("fit.truth", truth(times()));
    assert_eq!(code, Some(0), "{text}");
    assert!(
        text.contains("NOTE: there is no true slip of right"),
        "{text}"
    );
    assert!(
        object["truth"][0]["count"].as_u64().unwrap() > 3000,
        "{object}"
    );
    for (name, text) in [
        ("epoch", truth(times().map(|time| time + 1.7e9))),
        ("milliseconds", truth(times().map(|time| 1000.0 * time))),
        (
            "second",
            truth(times().filter(|time| (40.0..41.0).contains(time))),
        ),
    ] {
        let (code, text, object) = compare(&format!("{name}.truth"), text);
        assert_eq!(code, Some(3), "{name}: {text}");
        assert!(
            text.contains("WARNING: left: ") && text.contains("have a true slip at the same time"),
            "{name}: {text}"
        );
        assert!(
            object["doubts"][0].as_str().unwrap().starts_with("left: "),
            "{name}: {object}"
        );
    }
    let (code, text, object) = compare("seldom.truth", truth((0..80).map(f64::from)));
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("NOTE: left: "), "{text}");
    assert!(object["truth"][0]["lag_s"].is_null(), "{object}");
    for (name, text, message) in [
        (
            "empty",
            "time_s,left_slip\n".to_owned(),
            "holds no slip of a wheel",
        ),
        (
            "reversed",
            truth(times().map(|time| 80.0 - time)),
            "line 3, column 1 `time_s`: is 0.02 s older than the row before it",
        ),
    ] {
        let (code, text, _) = compare(&format!("{name}.truth"), text);
        assert_eq!(code, Some(2), "{name}: {text}");
        assert!(text.contains(message), "{name}: {text}");
    }
}
