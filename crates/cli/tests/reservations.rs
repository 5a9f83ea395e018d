//! What `estimate` prints of parts of a result: one wheel, a span, readings that are seldom or not used.

use std::fmt::Write as _;
use std::fs;

use serde_json::Value;

use crate::repository::{Folder, grouser};

/// A cart of two wheels that drives straight, its rims at 0.5 m/s and itself at 0.4 m/s, beside a reference.
struct Cart {
    /// Time between two readings of the wheels, and of the reference, s.
    periods_s: [f64; 2],
    /// Spans without rows, and in which the left counter shows what it showed at their begin, s.
    pause_s: [f64; 2],
    frozen_s: [f64; 2],
    /// A span in which the cart drives at 0.1 m/s, s.
    slipping_s: [f64; 2],
    /// Is the reference a speed, and not a pose?
    by_speed: bool,
}

const CART: Cart = Cart {
    periods_s: [0.02, 0.1],
    pause_s: [0.0; 2],
    frozen_s: [0.0; 2],
    slipping_s: [0.0; 2],
    by_speed: false,
};

const DURATION_S: f64 = 60.0;

/// How much of a span is over at a time, s.
fn passed([from, to]: [f64; 2], time_s: f64) -> f64 {
    (time_s.min(to) - from).max(0.0)
}

impl Cart {
    /// Writes its log and its robot file, and returns the arguments for them.
    fn write(&self, folder: &Folder) -> [String; 3] {
        let mut wheels = String::from("t,left,right\n");
        let mut reference = String::from("t,v,x,y,yaw\n");
        let times = |period_s: f64| {
            #[allow(clippy::cast_possible_truncation, reason = "some thousands")]
            let rows = (DURATION_S / period_s) as i32;
            let all = (0..=rows).map(move |row| f64::from(row) * period_s);
            all.filter(|time_s| !(*time_s > self.pause_s[0] && *time_s < self.pause_s[1]))
        };
        for time_s in times(self.periods_s[0]) {
            let rim = |time_s: f64| 0.5 * time_s / 0.1;
            let is_frozen = time_s > self.frozen_s[0] && time_s < self.frozen_s[1];
            let left = if is_frozen { self.frozen_s[0] } else { time_s };
            let (left, right) = (rim(left), rim(time_s));
            writeln!(wheels, "{time_s},{left},{right}").unwrap();
        }
        for time_s in times(self.periods_s[1]) {
            let slipping = time_s > self.slipping_s[0] && time_s < self.slipping_s[1];
            let speed = if slipping { 0.1 } else { 0.4 };
            let place = 0.4 * time_s - 0.3 * passed(self.slipping_s, time_s);
            writeln!(reference, "{time_s},{speed},{place},0,0").unwrap();
        }
        let log = folder.path("log");
        fs::create_dir_all(&log).unwrap();
        fs::write(folder.path("log/wheels.csv"), wheels).unwrap();
        fs::write(folder.path("log/reference.csv"), reference).unwrap();
        let column = |name: &str, meaning: &str, unit: &str| {
            format!("{{ column = \"{name}\", meaning = \"{meaning}\", unit = \"{unit}\" }}, ")
        };
        let of_reference = if self.by_speed {
            column("v", "speed_forward", "m/s")
        } else {
            column("x", "pose_x", "m")
                + &column("y", "pose_y", "m")
                + &column("yaw", "pose_yaw", "rad")
        };
        let of_wheels: String = ["left", "right"]
            .map(|wheel| {
                let angle = column(wheel, "wheel_angle", "rad");
                angle.replace(" }, ", &format!(", wheel = \"{wheel}\" }}, "))
            })
            .concat();
        let mut robot = String::from("format = 1\nname = \"cart\"\n");
        for (file, columns) in [("wheels", of_wheels), ("reference", of_reference)] {
            writeln!(
                robot,
                "[[table]]\nfile = \"{file}.csv\"\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [{columns}]"
            )
            .unwrap();
        }
        for (wheel, y) in [("left", 0.2), ("right", -0.2)] {
            writeln!(
                robot,
                "[[wheel]]\nname = \"{wheel}\"\nx_m = 0.0\ny_m = {y:?}\nradius_m = 0.1\ndrive = \"powered\""
            )
            .unwrap();
        }
        let path = folder.path("robot.toml");
        fs::write(&path, robot).unwrap();
        [log, "--robot".to_owned(), path]
    }
}

/// The text of a run that ends with 0, its standard error, and its JSON object.
fn run(arguments: &[String; 3], more: &[&str]) -> (String, String, Value) {
    let mut all = vec!["estimate"];
    all.extend(arguments.iter().map(String::as_str));
    all.extend(more);
    let output = grouser(&all);
    let text = String::from_utf8(output.stdout).unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}{errors}");
    all.push("--json");
    let object = serde_json::from_slice(&grouser(&all).stdout).unwrap();
    (text, errors, object)
}

fn notes(text: &str) -> Vec<&str> {
    let notes = text.lines().filter_map(|line| line.strip_prefix("NOTE: "));
    notes.collect()
}

#[test]
fn a_counter_that_stands_is_named_with_its_span() {
    let folder = Folder::new("notes-frozen");
    let sane = run(&CART.write(&folder), &[]);
    assert!(notes(&sane.0).is_empty(), "{}", sane.0);
    assert_eq!(sane.2["reservations"], serde_json::json!([]));
    let frozen = Cart {
        frozen_s: [20.0, 32.0],
        ..CART
    };
    let (text, _, object) = run(&frozen.write(&folder), &[]);
    let note = notes(&text);
    assert!(
        note.len() == 1 && note[0].starts_with("left is `Invalid(Inconsistent)` from 2"),
        "{text}"
    );
    assert_eq!(object["reservations"][0], note[0]);
    let span = &object["wheels"]["left"]["inconsistent_s"];
    let [from, to] = [&span[0], &span[1]].map(|time| time.as_f64().unwrap());
    assert!(
        (20.1..26.0).contains(&from) && (31.9..32.1).contains(&to),
        "{span}"
    );
    assert!(object["wheels"]["right"]["inconsistent_s"].is_null());
}

#[test]
fn wheels_that_are_mostly_not_ok_are_named() {
    let folder = Folder::new("notes-lost");
    let lost = Cart {
        periods_s: [0.02, 20.0],
        by_speed: true,
        ..CART
    };
    let (text, _, object) = run(&lost.write(&folder), &[]);
    let note = notes(&text);
    assert!(
        note.len() == 1
            && note[0].starts_with("left, right: `Ok` for at most ")
            && note[0].contains("`Degraded(ReferenceLost)`"),
        "{text}"
    );
    let healths = &object["wheels"]["left"]["healths_moving"];
    assert!(healths["Ok"].as_f64().unwrap() < 0.5, "{healths}");
}

#[test]
fn wheels_that_are_read_seldom_have_their_slips() {
    let folder = Folder::new("notes-seldom");
    for period_s in [0.7, 1.3, 5.0] {
        let seldom = Cart {
            periods_s: [period_s, 0.1],
            ..CART
        };
        let arguments = seldom.write(&folder);
        for more in [&[][..], &["--online"]] {
            let (text, _, object) = run(&arguments, more);
            assert!(notes(&text).is_empty(), "{text}");
            let wheel = &object["wheels"]["left"];
            let slip = wheel["median"].as_f64().unwrap();
            assert!((slip - 0.2).abs() < 0.01, "{period_s}: {slip}");
            let total = object["along"]["overall"].as_f64().unwrap();
            assert!((total - 0.2).abs() < 0.01, "{period_s}: {total}");
            let period = wheel["period_s"].as_f64().unwrap();
            assert!((period - period_s).abs() < 0.05, "{period}");
        }
    }
}

#[test]
fn a_pause_of_the_recording_is_no_rounded_time() {
    let folder = Folder::new("notes-pause");
    let pause = Cart {
        pause_s: [20.0, 45.0],
        ..CART
    };
    let (_, warnings, object) = run(&pause.write(&folder), &[]);
    assert!(
        object["rejected"]["not_later"].as_u64().unwrap() > 0,
        "{object}"
    );
    assert!(
        warnings.contains("after a pause of the recording") && !warnings.contains("rounded"),
        "{warnings}"
    );
}

#[test]
fn events_are_printed_from_begin_to_end() {
    let folder = Folder::new("notes-events");
    let slipping = Cart {
        slipping_s: [20.0, 30.0],
        ..CART
    };
    let (text, _, object) = run(
        &slipping.write(&folder),
        &["--from-s", "10", "--to-s", "50"],
    );
    assert!(text.contains("\n40.0 s of 60.0 s of log, "), "{text}");
    let events = object["filter"]["events"].as_array().unwrap();
    let time = |begins: bool| {
        let mut all = events.iter();
        let of = |event: &&Value| {
            event["event"] == "high slip" && event["wheel"] == "left" && event["begins"] == begins
        };
        all.find(of).unwrap()["time_s"].as_f64().unwrap()
    };
    let line = format!(
        "high slip of left from {:.1} s to {:.1} s",
        time(true),
        time(false)
    );
    assert!(text.lines().any(|own| own == line), "{line}\n{text}");
    assert!(time(true) > 20.0 && time(false) > 30.0);
}

#[test]
fn of_several_references_those_that_are_not_used_are_named() {
    let folder = Folder::new("notes-references");
    let [log, flag, robot] = CART.write(&folder);
    let both = fs::read_to_string(&robot).unwrap().replace(
        "columns = [{ column = \"x\"",
        "columns = [{ column = \"v\", meaning = \"speed_forward\", unit = \"m/s\" }, { column = \"x\"",
    );
    fs::write(&robot, &both).unwrap();
    let (text, _, _) = run(&[log, flag.clone(), robot.clone()], &[]);
    assert_eq!(
        notes(&text),
        [
            "`speed` is measured too but not used (reference: `pose`); `--reference speed` selects it"
        ]
    );
    // the same as topics of messages
    let map = folder.path("map.toml");
    let tables = &both[both.find("[[table]]").unwrap()..both.find("[[wheel]]").unwrap()];
    fs::write(&map, format!("format = 1\n{tables}")).unwrap();
    let topics = folder.path("topics");
    fs::create_dir(&topics).unwrap();
    for table in ["wheels", "reference"] {
        let (from, to) = (
            folder.path(&format!("log/{table}.csv")),
            folder.path(&format!("topics/{table}.mcap")),
        );
        let output = grouser(&["log", "convert", &from, &to, "--map", &map]);
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
    let of_wheels = &both[both.find("[[wheel]]").unwrap()..];
    fs::write(&robot, format!("format = 1\nname = \"cart\"\n{of_wheels}")).unwrap();
    let (text, _, object) = run(&[topics, flag, robot], &[]);
    assert!(notes(&text).is_empty(), "{text}");
    let line = "/ground_speed: speed over ground (not used: the reference is `pose`)";
    assert!(text.lines().any(|own| own == line), "{text}");
    let topics = object["topics"].as_array().unwrap();
    let others: Vec<&Value> = (topics.iter())
        .filter(|topic| topic["is_other_reference"] == true)
        .map(|topic| &topic["topic"])
        .collect();
    assert_eq!(others, ["/ground_speed"]);
}

#[test]
fn a_log_of_wheels_alone_is_refused_with_what_it_lacks() {
    let folder = Folder::new("notes-wheels");
    let [log, flag, robot] = CART.write(&folder);
    fs::remove_file(folder.path("log/reference.csv")).unwrap();
    let output = grouser(&["estimate", &log, &flag, &robot]);
    assert_eq!(output.status.code(), Some(2));
    let printed = String::from_utf8(output.stderr).unwrap();
    let hint = &printed[printed.find("hint: ").unwrap()..];
    for word in ["a pose", "a speed over ground", "a free wheel", "a gyro"] {
        assert!(hint.contains(word), "{word}: {printed}");
    }
}
