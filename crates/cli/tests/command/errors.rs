//! What is wrong in a file is said with the file, the line, the key and the unit that the user has written.

use std::fs;

use serde_json::{Value, json};

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
fn a_negative_seed_of_a_scenario_is_refused() {
    let error = drive(
        &Folder::new(),
        "duration_s = 1.0\n[ground]",
        "duration_s = 1.0\nseed = -1\n[ground]",
    );
    assert_eq!(
        (&error["field"], &error["value"]),
        (&json!("seed"), &json!(-1.0))
    );
}

#[test]
fn a_soil_of_a_scenario_is_refused_at_its_key_in_its_unit() {
    let folder = Folder::new();
    for (from, to, at, message, limit, unit) in [
        (
            "phi_deg = 30.0",
            "phi_deg = 360",
            13,
            "`phi_deg` is 360, but must lie in [0, 89]",
            [0.0, 89.0],
            "deg",
        ),
        (
            "cohesion_kpa = 1.0",
            "cohesion_kpa = -5",
            14,
            "`cohesion_kpa` is -5, but must lie in [0, 100000]",
            [0.0, 1e5],
            "kPa",
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
        assert_eq!(error["unit"], unit);
    }
}

/// A file whose only fault is one number, with the verb that reads it.
struct Reader {
    /// Words before and after the file's name.
    words: [&'static [&'static str]; 2],
    text: String,
}

/// What `wheel` needs beside its soil.
const WHEEL: &[&str] = &[
    "--radius-m",
    "0.1",
    "--width-m",
    "0.1",
    "--slip",
    "0.2",
    "--load-n",
    "50",
    "--json",
];

fn readers() -> [(&'static str, Reader); 4] {
    let soil = "format = 1
name = \"s\"
k_c_kn_per_m_n1 = 0.99
k_phi_kn_per_m_n2 = 1528.0
n = 1.1
cohesion_kpa = 1.04
phi_deg = 28.0
k_shear_m = 0.018
c_1 = 0.4
c_2 = 0.2
";
    let robot = fs::read_to_string(example("robots/skid-steer.toml")).unwrap();
    let scenario = SCENARIO.replace("ROBOT", &example("robots/skid-steer.toml"));
    let scenario = format!("{scenario}[sensors]\n[control]\n[start]\n");
    let problem = "format = 1
method = \"minimax\"
[variables]
slip = { start = 0.2, lower = 0.05, upper = 0.6 }
[wheel]
radius_m = 0.1
width_m = 0.1
[soil]
key = \"dry-sand\"
[state]
load_n = 50.0
[objectives]
f = \"torque_nm\"
";
    let reader = |words, text: &str| Reader {
        words,
        text: text.to_owned(),
    };
    [
        ("soil", reader([&["wheel", "--soil"], WHEEL], soil)),
        (
            "robot",
            reader([&["robot"], &["--stance", "--json"]], &robot),
        ),
        ("scenario", reader([&["drive"], &["--json"]], &scenario)),
        ("problem", reader([&["optimize"], &["--json"]], problem)),
    ]
}

/// Keys whose unit is another than the program's own: file, section, key, and its limits in the key's unit.
const KEYS: &[(&str, &str, &str, [f64; 2])] = &[
    ("soil", "", "cohesion_kpa", [0.0, 1e5]),
    ("soil", "", "phi_deg", [0.0, 89.0]),
    ("soil", "", "k_c_kn_per_m_n1", [-1e9, 1e9]),
    ("soil", "", "k_phi_kn_per_m_n2", [-1e9, 1e9]),
    ("soil", "", "k_shear_1_m_per_rad", [0.0, 10.0]),
    (
        "robot",
        "[estimator]",
        "yaw_sigma_deg",
        [5.729_577_951_308_232e-8, 57_295.779_513_082_32],
    ),
    (
        "robot",
        "[estimator]",
        "pose_yaw_offset_deg",
        [-360.0, 360.0],
    ),
    (
        "robot",
        "[estimator]",
        "entry_angle_sigma_deg",
        [1e-4, 57.0],
    ),
    ("robot", "[[wheel]]", "heading_deg", [-360.0, 360.0]),
    ("robot", "[[wheel]]", "roller_deg", [-80.0, 80.0]),
    ("robot", "[[wheel]]", "camber_deg", [-30.0, 30.0]),
    ("robot", "[[wheel]]", "caster_deg", [-45.0, 45.0]),
    ("robot", "[[wheel]]", "steer_range_deg", [0.0, 180.0]),
    ("robot", "[[wheel]]", "steer_rate_deg_per_s", [0.1, 1e4]),
    ("robot", "[[wheel]]", "radius_m", [1e-3, 10.0]),
    ("scenario", "[[soil]]", "cohesion_kpa", [0.0, 1e5]),
    ("scenario", "[[soil]]", "phi_deg", [0.0, 89.0]),
    ("scenario", "[[leg]]", "heading_deg", [-360.0, 360.0]),
    ("scenario", "[start]", "heading_deg", [-360.0, 360.0]),
    (
        "scenario",
        "[sensors]",
        "gyro_sigma_deg_per_s",
        [0.0, 572.957_795_130_823_2],
    ),
    (
        "scenario",
        "[sensors]",
        "gyro_bias_deg_per_s",
        [0.0, 572.957_795_130_823_2],
    ),
    (
        "scenario",
        "[sensors]",
        "joint_sigma_deg",
        [0.0, 57.295_779_513_082_32],
    ),
    (
        "scenario",
        "[sensors]",
        "entry_angle_sigma_deg",
        [0.0, 57.295_779_513_082_32],
    ),
    (
        "scenario",
        "[sensors]",
        "entry_angle_bias_deg",
        [0.0, 57.295_779_513_082_32],
    ),
    ("scenario", "[control]", "steep_deg", [0.0, 90.0]),
    ("scenario", "[control]", "level_deg", [0.0, 90.0]),
    ("scenario", "[control]", "traverse_angle_deg", [0.0, 90.0]),
    ("scenario", "[control]", "most_tilt_deg", [0.0, 90.0]),
    ("problem", "[soil]", "cohesion_kpa", [0.0, 1e5]),
    ("problem", "[soil]", "phi_deg", [0.0, 89.0]),
    ("problem", "[soil]", "k_c_kn_per_m_n1", [-1e9, 1e9]),
    ("problem", "[soil]", "k_phi_kn_per_m_n2", [-1e9, 1e9]),
    ("problem", "[state]", "slope_deg", [-89.9, 89.9]),
    ("problem", "[state]", "theta_deg", [-90.0, 90.0]),
];

#[test]
fn a_number_is_refused_at_its_key_and_in_the_unit_of_the_key() {
    let folder = Folder::new();
    let readers = readers();
    for (kind, section, key, limits) in KEYS {
        let (_, reader) = readers.iter().find(|(name, _)| name == kind).unwrap();
        // the first section of this name without the key, and with a bad one in its first line
        let bad = format!("{key} = 2e9");
        let mut lines: Vec<&str> = reader.text.lines().collect();
        let first = match *section {
            "" => 0,
            name => lines.iter().position(|line| *line == name).unwrap(),
        };
        let end = lines[first + 1..]
            .iter()
            .position(|line| line.starts_with('['));
        let end = end.map_or(lines.len(), |end| first + 1 + end);
        let is_given = |line: &&str| line.split(" = ").next() == Some(*key);
        if let Some(given) = lines[first..end].iter().position(is_given) {
            lines.remove(first + given);
        }
        lines.insert(first + 1, &bad);
        let path = folder.file("f.toml", lines.join("\n"));
        let path = path.display().to_string();
        let [before, after] = reader.words;
        let said = grouser([before, &[&path], after].concat());
        let error = refused(&said);
        let case = format!("{kind} {section} {key}: {error}");
        assert_eq!(error["field"], *key, "{case}");
        assert_eq!(error["value"], 2e9, "{case}");
        let found = [0, 1].map(|end| error["limit"][end].as_f64().unwrap());
        for (found, expected) in found.iter().zip(limits) {
            assert!((found - expected).abs() <= 1e-9 * expected.abs(), "{case}");
        }
        assert_eq!(error["line"], first + 2, "{case}");
        assert!(
            error["file"].as_str().unwrap().ends_with("f.toml"),
            "{case}"
        );
    }
}

#[test]
fn flags_that_are_out_of_range_have_field_value_limit_and_unit() {
    let wheel = "--soil dry-sand --radius-m 0.1 --width-m 0.1";
    for (words, field, value, limit, unit) in [
        (
            format!("climb {wheel} --load-n 0 --json"),
            "--load-n",
            0.0,
            serde_json::json!(0.0),
            "N".into(),
        ),
        (
            format!("climb {wheel} --mass-kg -1 --gravity-m-per-s2 moon --json"),
            "--mass-kg",
            -1.0,
            serde_json::json!(0.0),
            "kg".into(),
        ),
        (
            format!("climb {wheel} --load-n 50 --certify 100 --json"),
            "--certify",
            100.0,
            serde_json::json!([0.001, 30.0]),
            "deg".into(),
        ),
        (
            format!("wheel {wheel} --load-n 50 --slip 0:0.9 --points 1 --json"),
            "--points",
            1.0,
            serde_json::json!([2, 100_000]),
            Value::Null,
        ),
    ] {
        let error = refused(&line(&words));
        assert_eq!(error["field"], field, "{error}");
        assert_eq!(error["value"].as_f64(), Some(value), "{error}");
        assert_eq!(
            (&error["limit"], &error["unit"]),
            (&limit, &unit),
            "{error}"
        );
    }
    let said = line(&format!(
        "wheel {wheel} --load-n 50 --slip 0:0.9 --points 1"
    ));
    assert!(
        said.err
            .contains("`--points` is 1, but must lie in [2, 100000]"),
        "{said:?}"
    );
}

#[test]
fn a_robot_that_hangs_is_refused() {
    let folder = Folder::new();
    let robot = fs::read_to_string(example("robots/skid-steer.toml")).unwrap();
    // its weight lies before its front wheels
    let hanging = robot.replace("cg_x_m = 0.0", "cg_x_m = 0.9");
    assert_ne!(hanging, robot);
    let path = folder.file("hanging.toml", hanging);
    let (path, dem) = (path.display().to_string(), example("terrain/dunes.asc"));
    let map = folder.path("m.tif").display().to_string();
    for words in [
        &["climb", "--robot", &path, "--soil", "dry-sand", "--json"] as &[&str],
        &[
            "map", &dem, "--robot", &path, "--soil", "dry-sand", "-o", &map, "--json",
        ],
    ] {
        let error = refused(&grouser(words));
        assert!(error["value"].as_f64() < Some(0.0), "{error}");
        assert_eq!(
            (&error["field"], &error["limit"], &error["unit"]),
            (&"load".into(), &serde_json::json!(0.0), &"N".into()),
            "{error}"
        );
    }
}

#[test]
fn what_a_scenario_describes_is_refused_with_its_file_and_numbers() {
    let folder = Folder::new();
    let error = drive(&folder, "size_x_m = 6.0", "size_x_m = 1e-5");
    assert!(
        error["message"].as_str().unwrap().contains("s.toml:7:12: "),
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
fn numbers_of_the_ground_and_of_faults_are_refused_at_their_keys() {
    let folder = Folder::new();
    let ground = |key: &str, value: f64| {
        let from = "soil = \"soft\"";
        drive(&folder, from, &format!("{from}\n{key} = {value}"))
    };
    let fault = |keys: &str| {
        let from = "[[leg]]";
        drive(&folder, from, &format!("[[fault]]\n{keys}\n{from}"))
    };
    // 10^5 nodes along a side, 2^25 in all: beside 80 001 columns 419 rows
    for (error, field, limit) in [
        (
            drive(&folder, "size_x_m = 6.0", "size_x_m = 100000"),
            "size_x_m",
            [0.1, 4999.95],
        ),
        (
            drive(&folder, "size_y_m = 4.0", "size_y_m = 0.01"),
            "size_y_m",
            [0.1, 4999.95],
        ),
        (
            drive(
                &folder,
                "size_x_m = 6.0\nsize_y_m = 4.0",
                "size_x_m = 4000\nsize_y_m = 4000",
            ),
            "size_y_m",
            [0.1, 20.9],
        ),
        (ground("cell_m", 2000.0), "cell_m", [0.001, 1000.0]),
        (
            ground("packing_depth_m", 11.0),
            "packing_depth_m",
            [1e-4, 10.0],
        ),
        (
            ground("packing_depth_m", 1e-5),
            "packing_depth_m",
            [1e-4, 10.0],
        ),
        (
            ground("scatter_length_m", 2e4),
            "scatter_length_m",
            [1e-3, 1e4],
        ),
        (
            fault("kind = \"pulse-loss\"\nfrom_s = 1\nvalue = 1.5"),
            "value",
            [0.0, 1.0],
        ),
        (
            fault("kind = \"motor-off\"\nfrom_s = 3\nto_s = 2"),
            "to_s",
            [3.0, 1e9],
        ),
    ] {
        assert_eq!(error["field"], json!(field), "{error}");
        for (found, own) in error["limit"].as_array().unwrap().iter().zip(limit) {
            assert!(
                (found.as_f64().unwrap() - own).abs() <= 1e-9 * own,
                "{error}"
            );
        }
        assert!(error["line"].as_u64() > Some(5), "{error}");
        let message = error["message"].as_str().unwrap();
        assert!(message.contains(&format!("`{field}` is")), "{message}");
    }
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

/// What a first user tries: a column in another unit, standard input where it is not read, a robot file for a description.
#[test]
fn first_errors_state_what_is_needed() {
    let folder = Folder::new();
    let table = folder.file(
        "in.csv",
        "soil,radius_mm,width_m,slip,load_n\nlunar,100,0.1,0.2,40\n",
    );
    let said = grouser(["batch", table.to_str().unwrap(), "-o", "-"]);
    said.assert_refused("another unit");
    assert!(
        said.err
            .contains("no column `radius_m`; `radius_mm` is in another unit"),
        "{said:?}"
    );
    let said = line("log info -");
    said.assert_refused("standard input");
    assert!(
        said.err
            .contains("hint: standard input is read by `batch` alone"),
        "{said:?}"
    );
    let robot = folder.file("robot.toml", "format = 1\n");
    let said = grouser(["robot", robot.to_str().unwrap()]);
    said.assert_refused("no URDF");
    assert!(
        said.err.contains("`--stance` reads a robot file"),
        "{said:?}"
    );
}
