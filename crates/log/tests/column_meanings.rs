//! What the numbers of columns, and the columns beside them, decide about what they mean.

use std::f64::consts::TAU;

use grouser_files::columns::Meaning as M;
use grouser_log::{Error, Sheet, suggest_for_sheets};

use crate::scratch::Folder;

fn read(bytes: &[u8]) -> Result<Sheet, Error> {
    let folder = Folder::new("meanings");
    Sheet::read(&folder.file("log.csv", bytes), |_| ())
}

/// A table of the time and the columns `names`, with their numbers in rows.
fn table(names: &str, rows: &[impl AsRef<str>]) -> Sheet {
    let rows = rows.iter().zip(0..);
    let rows = rows.map(|(row, time)| format!("{time},{}\n", row.as_ref()));
    read(format!("time_s,{names}\n{}", rows.collect::<String>()).as_bytes()).unwrap()
}

/// What the columns after the time mean, with their units.
fn meanings(sheet: &Sheet) -> Vec<Option<(M, &'static str)>> {
    let columns = sheet.columns[1..].iter();
    let guesses = columns.map(|column| column.guess.as_ref());
    let meanings = guesses.map(|guess| guess.map(|guess| (guess.meaning, guess.unit)));
    meanings.collect()
}

/// The names of the columns that mean something.
fn known(sheet: &Sheet) -> Vec<&str> {
    let known = sheet.columns.iter().filter(|c| c.guess.is_some());
    known.map(|column| column.name.as_str()).collect()
}

/// The line that is proposed for the only column beside the time.
fn line(name: &str, rows: &[&str]) -> String {
    let sheet = table(name, rows);
    let text = suggest_for_sheets([(&sheet, "log.csv")]);
    let start = format!("{{ column = \"{name}\",");
    let line = text.lines().find(|line| line.contains(&start));
    line.unwrap_or_default().to_owned()
}

#[test]
fn a_turn_and_zero_are_limits() {
    // in radians up to a turn a second; more in one row of a hundred and one counts, in one of a hundred it does not
    let rates = |beyond: f64, rows: usize| {
        let mut rows = vec!["0.5".to_owned(); rows];
        rows[7] = beyond.to_string();
        meanings(&table("yaw_rate", &rows))[0].unwrap().1
    };
    assert_eq!(rates(-TAU, 10), "rad/s");
    assert_eq!(rates(-6.3, 10), "deg/s");
    assert_eq!(rates(-6.3, 99), "deg/s");
    assert_eq!(rates(-6.3, 100), "rad/s");
    // a speed with a sign is negative at times
    let speed = |least: &str| {
        meanings(&table("gps_speed_m_s", &["1.5", least]))[0]
            .unwrap()
            .0
    };
    assert_eq!(speed("0"), M::SpeedSize);
    assert_eq!(speed("-0.1"), M::SpeedForward);
    // a number that stays does not fall
    let column = &table("left_ticks", &["1", "1", "0", "0"]).columns[1];
    assert_eq!(column.falls, 1);
}

#[test]
fn a_stated_unit_answers_the_question() {
    let of = |units: &str| {
        let text = format!("time,left_vel\n{units}0,0.5\n1,0.5\n");
        meanings(&read(text.as_bytes()).unwrap())[0]
    };
    assert_eq!(of("s,m/s\n"), Some((M::WheelSpeed, "m/s")));
    assert_eq!(of("s,rad/s\n"), Some((M::WheelRate, "rad/s")));
    assert_eq!(of(""), None);
    // a column may be called as a unit
    assert_eq!(
        known(&read(b"ms,left_ticks\n0,5\n100,7\n").unwrap()),
        ["left_ticks"]
    );
}

#[test]
fn what_may_be_a_way_or_a_heading_has_a_unit_of_it() {
    assert!(line("distance_mm", &["1.5", "2"]).contains("unit = \"mm\""));
    assert_eq!(line("distance_deg", &["1.5", "2"]), "");
    assert_eq!(line("distance", &["1.5", "x"]), "");
    assert_eq!(line("distance", &["", ""]), "");
    let speed = |least: &str| line("speed_m_s", &["1.5", least]);
    assert!(speed("0").contains("\"speed_size\""));
    assert!(speed("-0.1").contains("\"speed_forward\""));
    // a heading beside a place, by its size
    for (yaw, unit) in [("6.4", "rad"), ("6.5", "deg"), ("-6.5", "deg")] {
        let sheet = table(
            "pose_x,pose_y,heading",
            &[format!("1,2,{yaw}"), "1,2,0".to_owned()],
        );
        let text = suggest_for_sheets([(&sheet, "log.csv")]);
        let expected = format!("meaning = \"pose_yaw\", unit = \"{unit}\" }}");
        assert!(text.contains(&expected), "{yaw}\n{text}");
    }
}

#[test]
fn a_heading_beside_a_quaternion_is_not_proposed() {
    let is_proposed = |names: &str, row: &str| {
        let sheet = table(names, &[row, row]);
        suggest_for_sheets([(&sheet, "log.csv")]).contains("{ column = \"heading\",")
    };
    assert!(is_proposed("pose_x,pose_y,heading", "1,2,0.5"));
    assert!(!is_proposed(
        "pose_x,pose_y,qx,qy,qz,qw,heading",
        "1,2,0,0,0.6,0.8,0.5"
    ));
    assert!(!is_proposed(
        "pose_x,pose_y,pose_yaw,heading",
        "1,2,0.5,0.5"
    ));
}

#[test]
fn a_wheel_alone_is_an_open_question_where_it_is_no_counter() {
    for (name, numbers, is_open) in [
        ("wheel_fl", ["0.5", "1.5"], true),
        ("wheel_fl", ["1", "2"], false),
        ("wheel_fl", ["0.5", "x"], false),
        ("wheel_x", ["0.5", "1.5"], false),
        ("gate_fl", ["0.5", "1.5"], false),
    ] {
        let found = line(name, &numbers).contains("its name does not say");
        assert_eq!(found, is_open, "{name} {numbers:?}");
    }
}

#[test]
fn a_pose_of_bare_names_is_of_numbers_in_its_units() {
    let pose = |names: &str, row: &str| known(&table(names, &[row, row])).join(" ");
    assert_eq!(pose("x,y,theta", "1,2,0.5"), "x y theta");
    // about a turn in radians at the most
    assert_eq!(pose("x,y,theta", "1,2,6.4"), "x y theta");
    assert_eq!(pose("x,y,theta", "1,2,-6.5"), "");
    assert_eq!(pose("x,y,theta", "1,2,word"), "");
    assert_eq!(pose("x,y,theta", "1,,0.5"), "");
    // an angle is no place
    assert_eq!(pose("x_deg,y_deg,theta", "1,2,0.5"), "");
    // `tx` is a place in m beside a whole quaternion
    assert_eq!(
        pose("tx,ty,qx,qy,qz,qw", "1,2,0,0,0.6,0.8"),
        "tx ty qx qy qz qw"
    );
    assert_eq!(pose("tx,ty,qx,qy,qz", "1,2,0,0,0.6"), "");
}

#[test]
fn a_quaternion_is_of_four_parts_of_its_size() {
    let parts = |names: &str, row: &str| {
        known(&table(
            &format!("pose_x,pose_y,{names}"),
            &[&format!("1,2,{row}")],
        ))
        .len()
            - 2
    };
    let names = "quat_x,quat_y,quat_z,quat_w";
    assert_eq!(parts(names, "0,0,-0.6,0.8"), 4);
    assert_eq!(parts(names, "0,0,-1.001,0"), 4);
    // without that about z there is no heading
    assert_eq!(parts(names, "0,0,-1.002,0"), 0);
    assert_eq!(parts(names, "0,0,word,0.8"), 0);
    assert_eq!(parts(names, "0,0,,0.8"), 0);
    // other names are of other things
    assert_eq!(parts("a_x,a_y,a_z,a_w", "0,0,-0.6,0.8"), 0);
    // of two that which is named as the place
    let four = |name: &str| {
        ["x", "y", "z", "w"]
            .map(|part| format!("{name}_{part}"))
            .join(",")
    };
    let of_pose = ["pose_quat_x", "pose_quat_y", "pose_quat_z", "pose_quat_w"];
    for names in [
        ["pose_quat", "arm_tool_quat"],
        ["arm_tool_quat", "pose_quat"],
    ] {
        let names = names.map(four).join(",");
        let found = table(
            &format!("pose_x,pose_y,{names}"),
            &["1,2,0,0,0.6,0.8,0,0,0.6,0.8"],
        );
        assert_eq!(known(&found)[2..], of_pose, "{names}");
    }
    // one without its real part is none
    let names = format!("pose_quat_x,pose_quat_y,pose_quat_z,{}", four("arm_quat"));
    let found = table(
        &format!("pose_x,pose_y,{names}"),
        &["1,2,0,0,0.6,0,0,0.6,0.8"],
    );
    let of_arm = ["arm_quat_x", "arm_quat_y", "arm_quat_z", "arm_quat_w"];
    assert_eq!(known(&found)[2..], of_arm);
}

#[test]
fn seconds_and_nanoseconds_are_one_time() {
    let text = "sec,nanosec,left_angle\n5,250000000,1\n5,750000000,1\n6,500000000,1\n";
    let time = read(text.as_bytes()).unwrap().time.unwrap();
    assert_eq!((time.unit, time.nanoseconds), ("s", Some(1)));
    assert!((time.duration_s - 1.25).abs() < 1e-9, "{time:?}");
    assert_eq!(time.jumps, 0);
    // and dates, by seconds since 1970 that are rounded
    let day = "2024-05-06T23:59:";
    let text =
        format!("datetime,left_angle\n{day}58.5,1\n{day}59.0,1\n{day}59.5,1\n{day}59.75,1\n");
    let time = read(text.as_bytes()).unwrap().time.unwrap();
    assert_eq!((time.unit, time.jumps), ("date", 0));
    assert!((time.duration_s - 1.25).abs() < 1e-6, "{time:?}");
    assert!((time.rate_hz.unwrap() - 2.0).abs() < 1e-5, "{time:?}");
}

#[test]
fn bytes_that_are_no_text_end_a_table_only_where_it_is_cut_off() {
    let with = |rows: usize, damage: &[u8]| {
        let rows = (0..rows).map(|row| format!("{row},0.5\n"));
        let text = format!("time,left_angle\n{}", rows.collect::<String>());
        read(&[text.as_bytes(), damage].concat())
    };
    // in the lines by which the layout is found, and behind them
    for rows in [5, 100] {
        let cut = with(rows, b"7,\xff").unwrap();
        assert_eq!(
            (cut.rows, cut.ragged, cut.is_cut_off),
            (rows as u64, 1, true)
        );
        let error = with(rows, b"7,\xff\n8,0.5\n").unwrap_err().to_string();
        assert!(error.contains("is not UTF-8 text"), "{error}");
    }
    // a header alone does not show a table
    let error = with(0, b"7,\xff").unwrap_err().to_string();
    assert!(error.contains("is not UTF-8 text"), "{error}");
}
