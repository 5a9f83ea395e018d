//! The verb `log` from outside: what it says, writes, and refuses.

#[path = "../../log/tests/support/measured_data.rs"]
mod measured_file;

use std::fmt::Write as _; // writing to a string cannot fail
use std::fs;

use serde_json::Value;

use crate::repository::{Folder, grouser, root};
use measured_file::measured_data;

const TABLE: &str = "examples/five-wheel/log.csv";
const MCAP: &str = "examples/five-wheel/log.mcap";
const ROBOT: &str = "examples/five-wheel/robot.toml";
const JACKAL: &str = "examples/jackal/robot.toml";

/// The JSON object of a run that ends with `code`.
fn json(arguments: &[&str], code: i32) -> Value {
    let output = grouser(&[arguments, &["--json"]].concat());
    let printed = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {printed}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn refused(arguments: &[&str], message: &str) {
    let output = grouser(arguments);
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {printed}");
    assert!(
        output.stdout.is_empty() && printed.contains(message),
        "{arguments:?}: {printed}"
    );
}

/// The Jackal's bag.
fn jackal() -> Option<String> {
    data("jackal/jackal_61s.bag")
}

/// A file of the measured data.
fn data(name: &str) -> Option<String> {
    Some(measured_data(name)?.to_str().unwrap().to_owned())
}

/// Slip against time, as `estimate` writes it.
fn slips(log: &str, robot: &str, more: &[&str], folder: &Folder) -> String {
    let out = folder.path("slips.csv");
    let output = grouser(&[&["estimate", log, "--robot", robot, "-o", &out], more].concat());
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    fs::read_to_string(out).unwrap()
}

#[test]
fn a_table_becomes_mcap_with_the_same_slips() {
    let folder = Folder::new("log-table");
    let mcap = folder.path("run.mcap");
    let object = json(&["log", "convert", TABLE, &mcap], 0);
    assert_eq!(object["records"], 2001 * 6);
    assert_eq!(object["messages"], 2001 * 2);
    assert_eq!(
        slips(&mcap, ROBOT, &[], &folder),
        slips(TABLE, ROBOT, &[], &folder)
    );
    // And one topic of it a table again, which a column map reads.
    let table = folder.path("ticks.csv");
    let object = json(
        &["log", "convert", &mcap, &table, "--topic", "/wheel_ticks"],
        0,
    );
    assert_eq!(object["rows"], 2001);
    let text = fs::read_to_string(&table).unwrap();
    let second = "20000000,0,20000000,base_link,front_left,front_right,rear_left,rear_right,fifth,\
                  60000,100,65000,30000,64000";
    assert_eq!(text.lines().nth(2), Some(second));
}

#[test]
fn a_run_of_several_tables_becomes_one_mcap_with_the_same_slips() {
    let Some(imu) = data("kobuki/left_faulty__mobile_base_sensors_imu_data.csv.gz") else {
        return;
    };
    let run = imu.replace("__mobile_base_sensors_imu_data.csv.gz", "");
    let folder = Folder::new("log-kobuki");
    let (mcap, robot) = (folder.path("run.mcap"), "examples/kobuki/robot.toml");
    let map = ["--map", "examples/kobuki/columns.toml"];
    json(&[&["log", "convert", &run, &mcap], &map[..]].concat(), 0);
    // Its gyro has a clock of its own in both, which is estimated.
    assert_eq!(
        slips(&mcap, robot, &[], &folder),
        slips(&run, robot, &[], &folder)
    );
}

#[test]
fn a_bag_becomes_mcap_and_a_bag_again_without_a_loss() {
    let Some(bag) = jackal() else { return };
    let folder = Folder::new("log-bag");
    let (mcap, again) = (folder.path("j.mcap"), folder.path("j.bag"));
    let object = json(&["log", "convert", &bag, &mcap], 0);
    assert_eq!(
        (&object["messages"], &object["verified"]),
        (&6121.into(), &true.into())
    );
    json(&["log", "convert", &mcap, &again], 0);
    let of = |log: &str| slips(log, JACKAL, &[], &folder);
    assert_eq!(of(&bag), of(&mcap));
    assert_eq!(of(&bag), of(&again));
}

#[test]
fn a_partial_recovery_exits_3_with_a_report_and_a_verified_file() {
    let folder = Folder::new("log-e7");
    let bytes = fs::read(root().join(MCAP)).unwrap();
    let (cut, saved) = (folder.path("cut.mcap"), folder.path("saved.mcap"));
    // The power went off within a chunk.
    fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let object = json(&["log", "recover", &cut, &saved], 3);
    assert_eq!(
        (&object["status"], &object["verified"]),
        (&"partial".into(), &true.into())
    );
    let messages = object["messages"].as_u64().unwrap();
    assert!(messages > 1900 && messages < 4002, "{messages}");
    let damage = &object["damages"][0];
    let offset = usize::try_from(damage["offset"].as_u64().unwrap()).unwrap();
    // The place is where a chunk begins: its opcode.
    assert_eq!(bytes[offset], 6);
    assert_eq!(object["bytes_lost"], (bytes.len() / 2 - offset) as u64);
    // What was saved is whole, and is the beginning of what was there.
    let info = json(&["log", "info", &saved], 0);
    assert_eq!(info["damage_count"], 0);
    // a slip by the whole log would use what was lost
    let whole = slips(MCAP, ROBOT, &["--to-s", "19", "--online"], &folder);
    assert_eq!(
        slips(&saved, ROBOT, &["--to-s", "19", "--online"], &folder),
        whole
    );
    // The same as text, with the place.
    let again = grouser(&["log", "recover", &cut, &saved]);
    assert_eq!(again.status.code(), Some(3));
    let printed = String::from_utf8(again.stdout).unwrap();
    assert!(
        printed.contains(&format!("damaged at byte {offset}, ")),
        "{printed}"
    );
    // Recovered once more it is whole.
    let twice = folder.path("twice.mcap");
    assert_eq!(
        json(&["log", "recover", &saved, &twice], 0)["status"],
        "whole"
    );
}

#[test]
fn a_table_whose_last_line_is_cut_off_is_used_up_to_it() {
    let folder = Folder::new("log-cut-table");
    let table = fs::read_to_string(root().join(TABLE)).unwrap();
    let whole: Vec<&str> = table.lines().collect();
    let (last, before) = whole.split_last().unwrap();
    fs::create_dir(folder.path("rows")).unwrap();
    let (cut, rows) = (folder.path("log.csv"), folder.path("rows/log.csv"));
    let text = before.join("\n") + "\n";
    fs::write(&rows, &text).unwrap();
    fs::write(&cut, text + &last[..last.len() / 2]).unwrap();
    assert_eq!(
        slips(&cut, ROBOT, &[], &folder),
        slips(&rows, ROBOT, &[], &folder)
    );
    let object = json(&["estimate", &cut, "--robot", ROBOT], 0);
    let place = object["left_out"]["cut_off"][0].as_str().unwrap();
    assert!(place.ends_with("log.csv: line 2002"), "{place}");
    let map = "examples/five-wheel/columns.toml";
    let out = folder.path("out.mcap");
    json(&["log", "convert", &cut, &out, "--map", map], 3);
    assert_eq!(json(&["log", "info", &cut], 0)["cut_off"], true);
    for arguments in [
        &["estimate", &cut, "--robot", ROBOT][..],
        &["log", "info", &cut],
        &["log", "convert", &cut, &out, "--map", map],
    ] {
        let printed = String::from_utf8(grouser(arguments).stderr).unwrap();
        assert!(printed.contains("cut off"), "{arguments:?}: {printed}");
    }
}

#[test]
fn an_estimate_reads_a_damaged_log_as_far_as_it_can_and_says_so() {
    let folder = Folder::new("log-damaged");
    let bytes = fs::read(root().join(MCAP)).unwrap();
    let cut = folder.path("cut.mcap");
    fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let object = json(&["estimate", &cut, "--robot", ROBOT], 0);
    assert_eq!(object["left_out"]["damages"], 1);
    assert!(object["duration_s"].as_f64().unwrap() > 19.0, "{object}");
    assert_eq!(object["topics"][0]["topic"], "/wheel_ticks");
    let printed = grouser(&["estimate", &cut, "--robot", ROBOT]).stderr;
    let printed = String::from_utf8(printed).unwrap();
    assert!(
        printed.contains("warning: 1 places of the log are damaged"),
        "{printed}"
    );
}

#[test]
fn what_cannot_be_read_at_all_leaves_no_file() {
    let folder = Folder::new("log-e7-nothing");
    let (cut, saved) = (folder.path("cut.mcap"), folder.path("saved.mcap"));
    fs::write(&cut, &fs::read(root().join(MCAP)).unwrap()[..60]).unwrap();
    let object = json(&["log", "recover", &cut, &saved], 1);
    assert_eq!(
        (&object["messages"], &object["output"]),
        (&0.into(), &Value::Null)
    );
    assert_eq!(folder.names(), ["cut.mcap"]);
}

#[test]
fn a_damaged_bag_is_recovered_as_a_bag() {
    let Some(bag) = jackal() else { return };
    let folder = Folder::new("log-bag-cut");
    let bytes = fs::read(bag).unwrap();
    let (cut, saved) = (folder.path("cut.bag"), folder.path("saved.bag"));
    fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let object = json(&["log", "recover", &cut, &saved], 3);
    assert!(object["messages"].as_u64().unwrap() > 2000, "{object}");
    assert_eq!(json(&["log", "info", &saved], 0)["damage_count"], 0);
}

/// A radius and a number of ticks that nobody measured would scale every slip.
#[test]
fn a_suggested_robot_is_refused_until_its_placeholders_are_numbers() {
    let folder = Folder::new("log-suggest");
    let mut logs = vec![TABLE.to_owned(), MCAP.to_owned()];
    logs.extend(jackal());
    for log in logs {
        let robot = folder.path("robot.toml");
        let output = grouser(&["log", "info", &log, "--suggest-robot"]);
        assert!(output.status.success());
        let proposed = String::from_utf8(output.stdout).unwrap();
        fs::write(&robot, &proposed).unwrap();
        refused(
            &["estimate", &log, "--robot", &robot],
            "`radius_m` is still the placeholder",
        );
        let measured = proposed.replace("radius_m = \"measure\"", "radius_m = 0.1");
        if measured.contains("ticks_per_turn") {
            fs::write(&robot, &measured).unwrap();
            refused(&["estimate", &log, "--robot", &robot], "`ticks_per_turn`");
        }
        fs::write(&robot, measured.replace("= \"measure\"", "= 1000")).unwrap();
        let rows = slips(&log, &robot, &[], &folder);
        assert!(rows.lines().count() > 1000, "{log}");
    }
}

#[test]
fn a_folder_is_one_run() {
    let folder = Folder::new("log-folder");
    let bytes = fs::read(root().join(MCAP)).unwrap();
    // As rosbag2 splits a recording, with its metadata beside it.
    for part in ["run_0.mcap", "run_1.mcap"] {
        fs::write(folder.0.join(part), &bytes).unwrap();
    }
    fs::write(
        folder.0.join("metadata.yaml"),
        "rosbag2_bagfile_information:\n",
    )
    .unwrap();
    let path = folder.0.to_str().unwrap();
    let (one, both) = (
        json(&["log", "info", MCAP], 0),
        json(&["log", "info", path], 0),
    );
    let topics = |object: &Value| object["topics"].as_array().unwrap().clone();
    assert_eq!(topics(&one).len(), topics(&both).len());
    for (one, both) in topics(&one).iter().zip(topics(&both)) {
        let messages = |topic: &Value| topic["messages"].as_u64().unwrap();
        assert_eq!(2 * messages(one), messages(&both), "{both}");
    }
    let printed = String::from_utf8(grouser(&["log", "info", path]).stdout).unwrap();
    assert!(printed.contains("not read: metadata.yaml"), "{printed}");
    let output = grouser(&["log", "info", path, "--suggest-robot"]);
    assert!(
        String::from_utf8(output.stdout)
            .unwrap()
            .contains("/wheel_ticks")
    );

    // Tables of one run, in a folder that holds something else as well.
    let folder = Folder::new("log-tables");
    fs::write(
        folder.0.join("wheels.csv"),
        "t,left_ticks,right_ticks\n0,1,2\n1,2,3\n",
    )
    .unwrap();
    fs::write(folder.0.join("imu.csv"), "t,gyro_z\n0,0.1\n1,0.2\n").unwrap();
    fs::write(folder.0.join("notes.md"), "a drive\n").unwrap();
    let path = folder.0.to_str().unwrap();
    let object = json(&["log", "info", path, "--suggest-robot"], 0);
    assert_eq!(object["tables"][1]["file"], "wheels.csv");
    assert!(object["recording"].is_null());
    let robot = object["suggested_robot"].as_str().unwrap();
    assert_eq!(robot.matches("[[table]]").count(), 2, "{robot}");
    assert_eq!(robot.matches("[[wheel]]").count(), 2, "{robot}");
    fs::remove_file(folder.0.join("wheels.csv")).unwrap();
    fs::remove_file(folder.0.join("imu.csv")).unwrap();
    refused(&["log", "info", path], "holds no log");
}

#[test]
fn a_tables_columns_are_reported_with_what_they_probably_mean() {
    let object = json(&["log", "info", TABLE], 0);
    assert_eq!(
        (&object["rows"], &object["duration_s"]),
        (&2001.into(), &40.0.into())
    );
    assert_eq!(
        object["columns"][5]["probably"],
        "wheel_count of fifth in tick"
    );
    assert_eq!(object["lacks"].as_array().unwrap().len(), 1);
    assert_eq!(
        (&object["gaps"], &object["clock_jumps"]),
        (&0.into(), &0.into())
    );
}

#[test]
fn speeds_of_rims_measure_wheels() {
    let folder = Folder::new("log-rims");
    let table = folder.0.join("log.csv");
    let text = "time_s,WheelSpeed_FL [km/h],WheelSpeed_FR [km/h],wz_rad_s,GPS_Speed [km/h]\n0,1,1,0,1\n0.1,1,2,0,1\n";
    fs::write(&table, text).unwrap();
    let object = json(&["log", "info", table.to_str().unwrap()], 0);
    assert_eq!(object["lacks"].as_array().unwrap().len(), 0, "{object}");
    assert_eq!(
        object["columns"][1]["probably"],
        "wheel_speed of fl in km/h"
    );
}

/// Wheels by their angles and a path as SLAM writes it, in one folder: the proposed robot file needs a radius alone.
#[test]
fn a_path_of_slam_beside_a_log_of_wheels_measures_their_slip() {
    const RADIUS_M: f64 = 0.09;
    // of both wheels, so that neither the turn nor their difference shows it
    const TRUE_SLIP: f64 = 0.3;
    let folder = Folder::new("log-slam");
    let (mut wheels, mut path) = (String::from("time,left_rad,right_rad\n"), String::new());
    for row in 0..600 {
        // on a circle of 2 m to the left, at 0.1 m/s from 2 s on
        let way = (0.1 * (0.1 * f64::from(row) - 2.0)).max(0.0);
        let turn = way / 2.0;
        let time = 1.7e9 + 0.1 * f64::from(row);
        let angle = |side: f64| (way + side * turn) / (1.0 - TRUE_SLIP) / RADIUS_M;
        writeln!(wheels, "{time:.3},{:.6},{:.6}", angle(-0.2), angle(0.2)).unwrap();
        if row % 2 == 0 {
            let (sin, cos) = turn.sin_cos();
            let (z, w) = (0.5 * turn).sin_cos();
            writeln!(
                path,
                "{time:.6} {:.6} {:.6} 0.2 0 0 {z:.7} {w:.7}",
                2.0 * sin,
                2.0 - 2.0 * cos
            )
            .unwrap();
        }
    }
    fs::write(folder.0.join("wheels.csv"), wheels).unwrap();
    fs::write(folder.0.join("slam.txt"), path).unwrap();
    let log = folder.0.to_str().unwrap();
    let proposed = json(&["log", "info", log, "--suggest-robot"], 0);
    let proposed = proposed["suggested_robot"].as_str().unwrap();
    let robot = folder.0.join("robot.toml");
    fs::write(
        &robot,
        proposed.replace("\"measure\"", &RADIUS_M.to_string()),
    )
    .unwrap();
    let files = ["wheels.csv", "slam.txt"].map(|name| folder.0.join(name));
    let [wheels, path] = files.each_ref().map(|file| file.to_str().unwrap());
    let found = json(
        &["estimate", wheels, path, "--robot", robot.to_str().unwrap()],
        0,
    );
    assert_eq!(found["reference"], "pose");
    for wheel in ["left", "right"] {
        let median = found["wheels"][wheel]["median"].as_f64().unwrap();
        assert!((median - TRUE_SLIP).abs() < 0.01, "{found}");
    }
}

#[test]
fn joints_have_no_readings_in_metres_or_amperes() {
    let folder = Folder::new("log-metres");
    let (table, map) = (folder.path("log.csv"), folder.path("columns.toml"));
    fs::write(&table, "t,v\n0,1\n1,2\n").unwrap();
    for (meaning, unit) in [
        ("wheel_distance", "m"),
        ("wheel_speed", "m/s"),
        ("motor_current", "A"),
    ] {
        let text = format!(
            "format = 1\n[[table]]\ntime = {{ column = \"t\", unit = \"s\" }}\n\
             columns = [{{ column = \"v\", meaning = \"{meaning}\", wheel = \"w\", unit = \"{unit}\" }}]\n"
        );
        fs::write(&map, text).unwrap();
        let mcap = folder.path("log.mcap");
        refused(
            &["log", "convert", &table, &mcap],
            &format!("`{meaning}` of wheel `w`"),
        );
    }
}

#[test]
fn types_stand_whole_in_their_lines_when_piped() {
    let output = grouser(&["log", "info", MCAP]);
    let printed = String::from_utf8(output.stdout).unwrap();
    let line = printed
        .lines()
        .find(|line| line.starts_with("/wheel_ticks"))
        .unwrap();
    assert!(
        line.contains("grouser_msgs/msg/WheelTicks") && line.ends_with("wheel angles or rates"),
        "{line}"
    );
}

#[test]
fn what_makes_no_sense_is_refused() {
    let folder = Folder::new("log-refused");
    let out = |name: &str| folder.path(name);
    refused(&["log", "convert", MCAP, &out("x.csv")], "holds 2 topics");
    refused(
        &["log", "convert", MCAP, &out("x.csv"), "--topic", "/imuu"],
        "did you mean `/imu`?",
    );
    refused(
        &["log", "convert", MCAP, &out("x.bag")],
        "messages of ROS 1 only",
    );
    refused(&["log", "convert", TABLE, &out("x.bag")], "does not become");
    refused(&["log", "convert", MCAP, &out("x.db3")], "does not end in");
    refused(
        &["log", "convert", MCAP, MCAP],
        "it is read by the same command",
    );
    refused(
        &["log", "recover", TABLE, &out("x.mcap")],
        "begins neither like",
    );
    refused(
        &["estimate", "examples/five-wheel/log", "--robot", ROBOT],
        "means both tables and bags",
    );
    assert!(folder.names().is_empty(), "{:?}", folder.names());
    // a database that its recorder did not close
    let database = out("run_0.db3");
    fs::write(&database, b"SQLite format 3\0\x10\0\x01\x01").unwrap();
    fs::write(out("run_0.db3-wal"), b"changes").unwrap();
    for verb in [&["log", "info"][..], &["estimate", "--robot", ROBOT]] {
        refused(
            &[verb, &[&database]].concat(),
            "`sqlite3 FILE 'PRAGMA wal_checkpoint(TRUNCATE)'` writes them into the database",
        );
    }
}

/// Fixes of a receiver become displacements: that the places are lost is stated.
#[test]
fn places_that_become_displacements_are_stated() {
    let folder = Folder::new("log-convert-places");
    let mut table = String::from("t,ticks,lat,lon\n");
    for i in 0..100 {
        let _ = writeln!(
            table,
            "{},{},{:.7},8.5",
            0.1 * f64::from(i),
            10 * i,
            47.0 + 1e-6 * f64::from(i)
        );
    }
    fs::write(folder.path("log.csv"), table).unwrap();
    let map = |position: &str| {
        let text = format!(
            "format = 1\n[[table]]\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [\n\
             {{ column = \"ticks\", meaning = \"wheel_count\", wheel = \"a\", unit = \"tick\" }},\n{position}]\n"
        );
        fs::write(folder.path("columns.toml"), text).unwrap();
        let output = grouser(&[
            "log",
            "convert",
            &folder.path("log.csv"),
            &folder.path("out.mcap"),
        ]);
        let printed = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{printed}");
        printed
    };
    let places = map(
        "{ column = \"lat\", meaning = \"latitude\", unit = \"deg\" },\n{ column = \"lon\", meaning = \"longitude\", unit = \"deg\" },\n",
    );
    assert!(
        places.contains("(`latitude`) are written as displacements"),
        "{places}"
    );
    assert!(!map("").contains("displacements"));
}
