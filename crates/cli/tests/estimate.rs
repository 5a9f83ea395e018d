//! The verb `estimate` from outside: its keys, columns, exit codes, and what bad input gets.

use std::fmt::Write as _;
use std::fs;
use std::process::{Command, Output};

use serde_json::Value;

use crate::repository;
use crate::repository::{Folder, is_error_alone, root};

const LOG: &str = "examples/five-wheel/log.csv";
const ROBOT: &str = "examples/five-wheel/robot.toml";

fn grouser(arguments: &[&str]) -> Output {
    repository::grouser(&[&["estimate"], arguments].concat())
}

fn json(output: &Output) -> Value {
    let text = std::str::from_utf8(&output.stdout).unwrap();
    assert!(!text.contains("NaN") && !text.contains("inf"));
    serde_json::from_str(text).unwrap()
}

fn refused(arguments: &[&str], message: &str) {
    let arguments = [arguments, &["--json"]].concat();
    let output = grouser(&arguments);
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {printed}");
    assert!(is_error_alone(&output), "{arguments:?}");
    assert!(
        printed.starts_with("error: ") && printed.contains(message),
        "{arguments:?}: {printed}"
    );
}

#[test]
fn the_keys_of_the_contract_are_there_in_the_robots_order() {
    let output = grouser(&[LOG, "--robot", ROBOT, "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let found = json(&output);
    assert_eq!(found["reference"], "free-wheel");
    assert!((found["duration_s"].as_f64().unwrap() - 40.0).abs() < 1e-9);
    let wheels = found["wheels"].as_object().unwrap();
    let names: Vec<&String> = wheels.keys().collect();
    assert_eq!(
        names,
        [
            "front_left",
            "front_right",
            "rear_left",
            "rear_right",
            "fifth"
        ]
    );
    for (name, wheel) in wheels {
        let states = wheel["states"].as_object().unwrap();
        let total: f64 = states.values().map(|share| share.as_f64().unwrap()).sum();
        assert!((total - 1.0).abs() < 1e-9, "{name}");
        for key in ["median", "p5", "p95"] {
            assert_eq!(wheel[key].is_null(), name == "fifth", "{name} {key}");
        }
    }
    // Half of the time on firm ground at 0.05, plus the free wheel's skid and the wander of 0.02.
    let along = found["along"]["median"].as_f64().unwrap();
    assert!((along - 0.06).abs() < 0.01, "{along}");
    let hashes = found["provenance"]["input_sha256"].as_object().unwrap();
    for file in [LOG, ROBOT, "examples/five-wheel/columns.toml"] {
        assert_eq!(hashes[file].as_str().unwrap().len(), 64, "{file}");
    }
}

#[test]
fn the_table_has_the_columns_of_the_contract_and_every_wheel() {
    let folder = Folder::new("estimate-table");
    let table = folder.path("slip.csv");
    let output = grouser(&[LOG, "--robot", ROBOT, "-o", &table]);
    assert_eq!(output.status.code(), Some(0));
    let text = fs::read_to_string(&table).unwrap();
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some("time_s,wheel,slip,slip_sigma,motion,health,side_slip_angle_deg")
    );
    let mut count = 0;
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), 7, "{line}");
        assert!(fields[0].parse::<f64>().unwrap() >= 0.0);
        assert_eq!(fields[2].is_empty(), fields[3].is_empty());
        if !fields[2].is_empty() {
            assert!(fields[2].parse::<f64>().unwrap().abs() <= 1.0);
            assert!(fields[3].parse::<f64>().unwrap() > 0.0);
        }
        assert_eq!(fields[4].is_empty(), fields[5] == "Uninitialised", "{line}");
        count += 1;
    }
    assert_eq!(count, 5 * 2001);
}

#[test]
fn figures_are_drawn_in_both_formats() {
    let folder = Folder::new("estimate-figures");
    let (svg, png) = (folder.path("slip.svg"), folder.path("slip.png"));
    let output = grouser(&[LOG, "--robot", ROBOT, "-o", &svg, "-o", &png]);
    assert_eq!(output.status.code(), Some(0));
    let svg = fs::read_to_string(svg).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("Slip against time of five wheels"));
    assert!(fs::read(png).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn a_soil_says_what_the_slip_means() {
    let in_the_patch = [
        "--from-s", "16.5", "--to-s", "19", "--soil", "dry-sand", "--json",
    ];
    let found = json(&grouser(
        &[&[LOG, "--robot", ROBOT], &in_the_patch[..]].concat(),
    ));
    assert_eq!(found["provenance"]["soil"]["key"], "dry-sand");
    let soil = &found["wheels"]["rear_left"]["soil"];
    let number = |key: &str| soil[key].as_f64().unwrap();
    // The same by `wheel`, the other door to the model.
    let wheel = crate::repository::program()
        .args([
            "wheel",
            "--soil",
            "dry-sand",
            "--radius-m",
            "0.1",
            "--width-m",
            "0.1",
        ])
        .args([
            "--load-n",
            "60",
            "--slip",
            &number("slip").to_string(),
            "--json",
        ])
        .output()
        .unwrap();
    let wheel = json(&wheel);
    for key in ["sinkage_m", "drawbar_pull_n", "torque_nm"] {
        let other = wheel[key].as_f64().unwrap();
        assert!((number(key) - other).abs() <= 1e-12 * other.abs(), "{key}");
    }
    assert!(number("slip_of_best_efficiency") > number("slip"));
    assert!(number("slip_with_reference_skid") < number("slip"));
    assert!(found["wheels"]["fifth"]["soil"].is_null());
    let missing = [LOG, "--robot", ROBOT, "--soil", "hit-lss1"];
    refused(&missing, "`--c-1`");
    refused(
        &[
            LOG,
            "--robot",
            "examples/robotino/robot.toml",
            "--soil",
            "dry-sand",
        ],
        "examples/five-wheel/log.csv",
    );
}

#[test]
fn a_log_without_motion_ends_with_1_and_its_status() {
    let folder = Folder::new("estimate-still");
    let header = fs::read_to_string(root().join(LOG)).unwrap();
    let header = header.lines().next().unwrap();
    let rows: Vec<String> = (0..100)
        .map(|i| format!("{},5,5,5,5,5,0", 20 * i))
        .collect();
    let log = folder.file("log.csv", format!("{header}\n{}\n", rows.join("\n")));
    let output = grouser(&[&log, "--robot", ROBOT, "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let found = json(&output);
    assert_eq!(found["status"], "no slip");
    assert!(
        found["wheels"]["front_left"]["median"].is_null() && found["along"]["median"].is_null()
    );
    assert!(String::from_utf8_lossy(&output.stderr).starts_with("error: "));
}

#[test]
fn a_radius_is_calibrated_into_a_robot_file_that_works() {
    let folder = Folder::new("estimate-calibrate");
    let robot = folder.path("robot.toml");
    let firm = ["--from-s", "4", "--to-s", "10.5"];
    let calibrate = [
        &[LOG, "--robot", ROBOT, "--calibrate-radius", &robot],
        &firm[..],
        &["--json"],
    ];
    let found = json(&grouser(&calibrate.concat()));
    let factor = found["radius_factor"].as_f64().unwrap();
    assert!((factor - 0.95).abs() < 0.02, "{factor}");
    // the whole run crosses a soft patch
    let slipping = [
        LOG,
        "--robot",
        ROBOT,
        "--calibrate-radius",
        &folder.path("slip.toml"),
    ];
    let output = grouser(&slipping);
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(
        text.starts_with("WARNING: radius x 0.864") && text.contains("wheels that slip"),
        "{text}"
    );
    let again = [
        &[
            LOG,
            "--robot",
            &robot,
            "--map",
            "examples/five-wheel/columns.toml",
        ],
        &firm[..],
        &["--json"],
    ];
    let found = json(&grouser(&again.concat()));
    let overall = found["along"]["overall"].as_f64().unwrap();
    assert!(overall.abs() < 0.001, "{overall}");
    // The free wheel's own radius stays.
    assert!(
        fs::read_to_string(&robot)
            .unwrap()
            .contains("radius_m = 0.1\nwidth_m = 0.05")
    );
}

/// A cart that stops and drives on, seven seconds each, and positions that are stamped 0.15 s late: a log of two tables, and the robot file
/// with its text.
fn late_positions(folder: &Folder) -> (String, &'static str) {
    let (mut wheels, mut positions) = (String::from("t,w\n"), String::from("t,x,y,yaw\n"));
    let (mut x, mut speed) = (0.0, 0.0);
    for row in 0..6000 {
        let time_s = f64::from(row) * 0.01;
        let target = if row / 700 % 2 == 0 { 0.0 } else { 0.5 };
        speed += (target - speed) * 0.01 / 0.3;
        x += speed * 0.01;
        let _ = writeln!(wheels, "{time_s:.2},{:.5}", x / 0.9 / 0.1);
        if row % 20 == 0 {
            let _ = writeln!(positions, "{:.2},{x:.4},0,0", time_s + 0.15);
        }
    }
    fs::create_dir(folder.path("log")).unwrap();
    fs::write(folder.path("log/wheels.csv"), wheels).unwrap();
    fs::write(folder.path("log/positions.csv"), positions).unwrap();
    let robot = folder.path("robot.toml");
    let text = "format = 1\nname = \"cart\"\n\
        [[table]]\nfile = \"wheels.csv\"\ntime = { column = \"t\", unit = \"s\" }\n\
        columns = [{ column = \"w\", meaning = \"wheel_angle\", wheel = \"w\", unit = \"rad\" }]\n\
        [[table]]\nfile = \"positions.csv\"\ntime = { column = \"t\", unit = \"s\" }\n\
        columns = [{ column = \"x\", meaning = \"pose_x\", unit = \"m\" }, \
        { column = \"y\", meaning = \"pose_y\", unit = \"m\" }, \
        { column = \"yaw\", meaning = \"pose_yaw\", unit = \"rad\" }]\n\
        [[wheel]]\nname = \"w\"\nx_m = 0.0\ny_m = 0.0\nradius_m = 0.1\ndrive = \"powered\"\n";
    fs::write(&robot, text).unwrap();
    (robot, text)
}

#[test]
fn a_reference_that_lags_is_reported_used_and_calibrated() {
    let folder = Folder::new("estimate-delay");
    let (robot, text) = late_positions(&folder);
    let log = folder.path("log");
    let output = grouser(&[&log, "--robot", &robot]);
    let shown = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(shown.contains("the reference lags by 0.15"), "{shown}");
    let calibrated = folder.path("calibrated.toml");
    let found = json(&grouser(&[
        &log,
        "--robot",
        &robot,
        "--calibrate",
        &calibrated,
        "--json",
    ]));
    let delay_s = found["reference_delay"]["delay_s"].as_f64().unwrap();
    assert!((delay_s - 0.15).abs() < 0.01, "{delay_s}");
    // stamps of whole seconds; and a log without wheels
    let fine = fs::read_to_string(folder.path("log/wheels.csv")).unwrap();
    let coarse = fine.lines().map(|line| {
        let (time, rest) = line.split_once(',').unwrap();
        format!("{},{rest}\n", time.split('.').next().unwrap())
    });
    fs::create_dir(folder.path("coarse")).unwrap();
    let positions = fs::read_to_string(folder.path("log/positions.csv")).unwrap();
    fs::write(folder.path("coarse/positions.csv"), &positions).unwrap();
    let printed = |log: &str| {
        let output = grouser(&[log, "--robot", &robot]);
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let hint = printed(&folder.path("coarse"));
    assert!(
        hint.contains("measures no powered wheel")
            && hint.contains("`wheel_distance`")
            && !hint.contains("topics")
            && !hint.contains("JointState"),
        "{hint}"
    );
    let coarse: Vec<String> = coarse.collect();
    fs::write(folder.path("coarse/wheels.csv"), coarse.concat()).unwrap();
    let warning = printed(&folder.path("coarse"));
    let second = |line: &String| line.split(',').next().unwrap().to_owned();
    let same = coarse
        .windows(2)
        .filter(|two| second(&two[0]) == second(&two[1]));
    let rows = coarse.len() - 1 + positions.lines().count() - 1;
    let counts = format!(
        "since {} of {rows} rows of the tables have the time of the row before",
        same.count()
    );
    assert!(warning.contains(&counts), "{counts}: {warning}");
    // the files of one run are no runs
    let [wheels, positions] =
        ["wheels", "positions"].map(|name| folder.path(&format!("log/{name}.csv")));
    let output = grouser(&[
        &wheels,
        &positions,
        "--robot",
        &robot,
        "--calibrate",
        &calibrated,
    ]);
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{printed}");
    assert!(
        printed.contains("wheels.csv`: reference `any` needs")
            && printed.contains("hint: each LOG is a run of its own"),
        "{printed}"
    );
    let found = json(&grouser(&[&log, "--robot", &calibrated, "--json"]));
    let delay = &found["reference_delay"];
    assert_eq!(
        delay["stated_s"].as_f64(),
        Some((1e3 * delay_s).round() * 1e-3)
    );
    assert_eq!(delay["is_clear"].as_bool(), Some(false));
    fs::write(
        &robot,
        text.replace(
            "[[wheel]]",
            "[filter]\nreference_latency_s = 0.0\n[[wheel]]",
        ),
    )
    .unwrap();
    let output = grouser(&[&log, "--robot", &robot]);
    let warned = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        warned.contains("but `reference_latency_s` is 0: not applied"),
        "{warned}"
    );
}

#[test]
fn bad_usage_and_input_are_refused_with_2_and_leave_nothing() {
    let folder = Folder::new("estimate-refused");
    let table = folder.path("slip.csv");
    let with = |log: &str, robot: &str, message: &str| {
        refused(&[log, "--robot", robot, "-o", &table], message);
    };
    with("no/such/log.csv", ROBOT, "no/such/log.csv");
    with("no-such-log.csv", ROBOT, "no-such-log.csv");
    with(LOG, "no/such/robot.toml", "no/such/robot.toml");
    with("examples", ROBOT, "no file fits the column map");
    with("/dev/zero", ROBOT, "/dev/zero");
    with(LOG, "/dev/zero", "is a device");
    with(LOG, "examples", "is a directory");
    with(LOG, LOG, "log.csv:1:");
    with("", ROBOT, "");
    refused(&[LOG], "--robot");
    refused(&["--robot", ROBOT], "LOG");
    for (flag, value, message) in [
        ("--window-s", "0.5", "the slip filter replaces"),
        ("--window-s", "-1", "the slip filter replaces"),
        ("--method", "window", "the slip filter replaces"),
        ("--from-s", "inf", "finite"),
        ("--reference", "pose", "columns of a pose"),
        ("--reference", "moon", "must be one of"),
        ("--wheel-sensor", "angle", "by angle"),
        ("--wheel-sensor", "", "must be one of"),
        ("--map", ROBOT, "no key `table`"),
        ("--map", "/dev/null", "is a device"),
        ("--soil", "moon-dust", "not in the catalogue"),
        ("-o", "slip.xlsx", "does not end in"),
        ("-o", "no/such/folder/slip.csv", "no/such/folder"),
    ] {
        refused(&[LOG, "--robot", ROBOT, "-o", &table, flag, value], message);
    }
    // Broken in the middle: nothing is left of the table that was begun.
    let whole = fs::read_to_string(root().join(LOG)).unwrap();
    let sick = Folder::new("estimate-sick");
    let log = sick.file("log.csv", whole.replacen("\n39000,", "\n39000,x", 1));
    with(&log, ROBOT, "line 1952, column 2 `front_left_ticks`");
    assert!(folder.names().is_empty());
}

#[cfg(unix)]
#[test]
fn a_pipe_as_a_log_does_not_hang() {
    let folder = Folder::new("estimate-pipe");
    let pipe = folder.path("log.csv");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    refused(&[&pipe, "--robot", ROBOT], "is a pipe");
}

#[test]
fn a_wide_window_of_time_or_none_of_it_is_no_panic() {
    for (from, to, code) in [
        ("0", "1e9", 0),
        ("-5", "100", 0),
        ("50", "60", 1),
        ("20", "10", 1),
    ] {
        let output = grouser(&[
            LOG, "--robot", ROBOT, "--from-s", from, "--to-s", to, "--json",
        ]);
        assert_eq!(output.status.code(), Some(code), "{from} {to}");
        json(&output);
    }
}

#[test]
fn a_wrong_unit_is_found_by_the_check() {
    let folder = Folder::new("estimate-check");
    let example = root().join("examples/five-wheel");
    let columns = fs::read_to_string(example.join("columns.toml")).unwrap();
    // The gyro's numbers are rad/s; they are read as degrees.
    let wrong = columns.replace("unit = \"rad/s\"", "unit = \"deg/s\"");
    assert_ne!(wrong, columns);
    let map = folder.file("columns.toml", &wrong);
    let right = grouser(&[LOG, "--robot", ROBOT, "--check", "--json"]);
    assert_eq!(right.status.code(), Some(0));
    assert_eq!(json(&right)["start_check"]["status"], "plausible");
    let output = grouser(&[LOG, "--robot", ROBOT, "--map", &map, "--check", "--json"]);
    assert_eq!(output.status.code(), Some(3), "a result that is doubtful");
    let check = json(&output)["start_check"].clone();
    assert_eq!(check["status"], "implausible", "{check}");
    assert!(
        check["message"].as_str().unwrap().contains("yaw rate"),
        "{check}"
    );
    assert!(json(&grouser(&[LOG, "--robot", ROBOT, "--json"]))["start_check"].is_null());
}
