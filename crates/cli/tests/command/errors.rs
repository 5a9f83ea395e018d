//! What is wrong in a file is said with the file, the line, the key and the unit that the user has written.

use std::fs;

use serde_json::Value;

use super::program::{Folder, Said, grouser, line};

const SCENARIO: &str = "format = 1
title = \"level\"
robot = \"ROBOT\"
duration_s = 1.0
[ground]
kind = \"flat\"
size_x_m = 6.0
size_y_m = 4.0
soil = \"soft\"
[[soil]]
name = \"soft\"
key = \"dry-sand\"
phi_deg = 30.0
cohesion_kpa = 1.0
[[leg]]
speed_m_per_s = 0.1
duration_s = 1.0
";

fn example(name: &str) -> String {
    format!("{}/../../examples/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn refused(said: &Said) -> Value {
    said.assert_refused("bad input");
    said.json()["error"].take()
}

/// The scenario with one line replaced.
fn drive(folder: &Folder, from: &str, to: &str) -> Value {
    let text = SCENARIO.replace("ROBOT", &example("robots/skid-steer.toml"));
    assert!(text.contains(from), "{from}");
    let path = folder.path("s.toml");
    fs::write(&path, text.replace(from, to)).unwrap();
    refused(&grouser(["drive", &path.display().to_string(), "--json"]))
}

#[test]
fn a_soil_of_a_scenario_is_refused_at_its_key_in_its_unit() {
    let folder = Folder::new();
    for (from, to, at, message, limit) in [
        (
            "phi_deg = 30.0",
            "phi_deg = 360",
            13,
            "`phi_deg` is 360, but must lie in [0, 89]",
            [0.0, 89.0],
        ),
        (
            "cohesion_kpa = 1.0",
            "cohesion_kpa = -5",
            14,
            "`cohesion_kpa` is -5, but must lie in [0, 100000]",
            [0.0, 1e5],
        ),
    ] {
        let error = drive(&folder, from, to);
        let said = error["message"].as_str().unwrap();
        assert!(said.contains(&format!("s.toml:{at}:")), "{error}");
        assert!(said.ends_with(message), "{error}");
        assert_eq!(
            (&error["line"], &error["limit"]),
            (&at.into(), &serde_json::json!(limit))
        );
        assert!(error["file"].as_str().unwrap().ends_with("s.toml"));
        assert_eq!(error["field"], from.split(' ').next().unwrap());
    }
}

#[test]
fn what_a_scenario_describes_is_refused_with_its_file_and_numbers() {
    let folder = Folder::new();
    let error = drive(&folder, "size_x_m = 6.0", "size_x_m = 1e-5");
    assert!(
        error["message"].as_str().unwrap().contains("s.toml: "),
        "{error}"
    );
    assert!(error["file"].as_str().unwrap().ends_with("s.toml"));
    for key in ["field", "value", "limit"] {
        assert!(!error[key].is_null(), "{key} {error}");
    }
    // no number of hundreds of digits
    let robot = fs::read_to_string(example("robots/skid-steer.toml")).unwrap();
    let radius = robot
        .lines()
        .find(|line| line.starts_with("radius_m"))
        .unwrap();
    let path = folder.path("huge.toml");
    fs::write(&path, robot.replace(radius, "radius_m = 1e308")).unwrap();
    let error = refused(&grouser([
        "robot",
        &path.display().to_string(),
        "--stance",
        "--json",
    ]));
    let message = error["message"].as_str().unwrap();
    assert!(
        message.contains("1e308") && message.len() < 200,
        "{message}"
    );
}

#[test]
fn intervals_without_their_soil_are_refused_in_the_unit_of_the_key() {
    let folder = Folder::new();
    let intervals = "format = 1\nsource = \"a test\"\ncohesion_kpa = { low = 0.4, high = 0.5 }\n";
    let path = folder.file("i.toml", intervals);
    let error = refused(&grouser([
        "map",
        &example("terrain/dunes.asc"),
        "--robot",
        &example("robots/skid-steer.toml"),
        "--soil",
        "dry-sand",
        "--soil-intervals",
        &path.display().to_string(),
        "-o",
        &folder.path("m.tif").display().to_string(),
        "--json",
    ]));
    let message = error["message"].as_str().unwrap();
    assert!(message.ends_with("must lie in [0.4, 0.5]"), "{message}");
    assert_eq!(
        (&error["field"], &error["unit"]),
        (&"cohesion_kpa".into(), &Value::Null)
    );
    assert_eq!(error["limit"], serde_json::json!([0.4, 0.5]));
}

#[test]
fn a_log_that_is_not_there_and_a_count_that_is_none_are_called_so() {
    let folder = Folder::new();
    for out in ["out.csv", "out.mcap"] {
        let (log, out) = (folder.path("nope.mcap"), folder.path(out));
        let said = line(&format!(
            "log convert {} {} --json",
            log.display(),
            out.display()
        ));
        let error = refused(&said);
        assert_eq!(error["kind"], "file");
        assert!(
            error["message"]
                .as_str()
                .unwrap()
                .ends_with("no such file or directory"),
            "{error}"
        );
    }
    let said = line(
        "wheel --soil dry-sand --radius-m 0.1 --width-m 0.1 --slip 0.2 --load-n 50 --grouser-height-m 0.01 --grouser-count 12.5",
    );
    said.assert_refused("half a lug");
    assert!(said.err.contains("must be a whole number"), "{said:?}");
}
