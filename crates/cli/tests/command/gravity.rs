//! Gravity: a flag precedes the scenario's, that precedes the robot file's, and without any it is the Earth's.

use std::fs;

use super::program::{Folder, Said, grouser};

const MOON_M_PER_S2: f64 = 1.62;
const EARTH_M_PER_S2: f64 = 9.806_65;

const WHEEL: [&str; 6] = [
    "--soil",
    "lunar",
    "--radius-m",
    "0.125",
    "--width-m",
    "0.15",
];

fn example(name: &str) -> String {
    format!("{}/../../examples/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// The skid-steer robot, as it is or with one more line at the head of its file.
fn robot(folder: &Folder, line: &str) -> String {
    let text = fs::read_to_string(example("robots/skid-steer.toml")).unwrap();
    let text = text.replace("format = 1\n", &format!("format = 1\n{line}\n"));
    let path = folder.path("robot.toml");
    fs::write(&path, text).unwrap();
    path.display().to_string()
}

fn with(verb: &str, more: &[&str]) -> Said {
    let words = std::iter::once(verb)
        .chain(WHEEL)
        .chain(more.iter().copied());
    grouser(words.chain(["--json"]).collect::<Vec<_>>())
}

#[test]
fn a_mass_under_a_gravity_is_its_load_in_wheel_and_climb() {
    let load = (20.0 * MOON_M_PER_S2).to_string();
    for (verb, more) in [
        ("wheel", vec!["--slip", "0.3"]),
        ("wheel", vec!["--slip", "0:0.9", "--points", "3"]),
        ("climb", vec![]),
    ] {
        let by = |words: &[&str]| {
            let run = with(verb, &[words, &more].concat());
            let mut object = run.assert_done().json();
            object.as_object_mut().unwrap().remove("provenance");
            object.as_object_mut().unwrap().remove("gravity_m_per_s2");
            object
        };
        let named = by(&["--mass-kg", "20", "--gravity-m-per-s2", "moon"]);
        assert_eq!(named, by(&["--load-n", &load]), "{verb}");
        let number = by(&["--mass-kg", "20", "--gravity-m-per-s2", "1.62"]);
        assert_eq!(named, number, "{verb}");
        assert_ne!(named, by(&["--mass-kg", "20"]), "{verb}");
    }
    with("climb", &["--mass-kg", "20", "--gravity-m-per-s2", "venus"]).assert_refused("venus");
    // a load is the weight already: a gravity beside it would be ignored
    for verb in ["wheel", "climb"] {
        let given = ["--load-n", "20", "--gravity-m-per-s2", "moon"];
        let slip = ["--slip", "0.2"];
        let all = given.iter().chain(slip.iter().filter(|_| verb == "wheel"));
        let refused = with(verb, &all.copied().collect::<Vec<_>>());
        refused.assert_refused(verb);
        assert!(refused.err.contains("only with `--mass-kg`"), "{refused:?}");
    }
}

/// The sum of the loads of a robot at rest, N.
fn weight(words: &[&str]) -> f64 {
    let run = grouser([&["robot"], words, &["--stance", "--json"]].concat());
    let object = run.assert_done().json();
    let loads = object["loads_n"].as_object().unwrap();
    loads.values().map(|load| load.as_f64().unwrap()).sum()
}

#[test]
fn a_flag_precedes_the_robot_file() {
    let folder = Folder::new();
    let plain = robot(&folder, "");
    let earth = weight(&[&plain]);
    assert!((earth / EARTH_M_PER_S2 - 15.2).abs() < 1e-6);
    let moon = robot(&folder, "gravity_m_per_s2 = \"moon\"");
    assert!((weight(&[&moon]) / MOON_M_PER_S2 - 15.2).abs() < 1e-6);
    let flag = weight(&[&moon, "--gravity-m-per-s2", "mars"]);
    assert!((flag / 3.71 - 15.2).abs() < 1e-6);
    let climb = |words: &[&str]| {
        let fixed = ["climb", "--soil", "dry-sand", "--robot"];
        let run = grouser([&fixed, words, &["--json"]].concat());
        run.assert_done().json()["gravity_m_per_s2"].clone()
    };
    assert_eq!(climb(&[&moon]), MOON_M_PER_S2);
    assert_eq!(
        climb(&[&moon, "--gravity-m-per-s2", "earth"]),
        EARTH_M_PER_S2
    );
}

#[test]
fn a_map_keeps_its_gravity_for_the_scenario_of_a_plan() {
    let folder = Folder::new();
    let path = |name: &str| folder.path(name).display().to_string();
    let (dem, moon) = (
        example("terrain/dunes.asc"),
        robot(&folder, "gravity_m_per_s2 = 1.62"),
    );
    let (map, way) = (path("map.tif"), path("way.toml"));
    let fixed = [
        "map", &dem, "--robot", &moon, "--soil", "dry-sand", "-o", &map, "--json",
    ];
    let made = grouser(fixed).assert_done().json();
    assert_eq!(made["gravity_m_per_s2"], MOON_M_PER_S2);
    let to = [
        "plan",
        &map,
        "--from",
        "3,3",
        "--to",
        "9,9",
        "--scenario",
        &way,
    ];
    let by = ["--dem", &dem, "--robot", &moon, "--soil", "dry-sand"];
    grouser([&to[..], &by].concat()).assert_done();
    let scenario = fs::read_to_string(way).unwrap();
    assert!(
        scenario.contains("\ngravity_m_per_s2 = 1.62\n"),
        "{scenario}"
    );
}

#[test]
fn a_scenario_precedes_the_robot_file() {
    let folder = Folder::new();
    robot(&folder, "gravity_m_per_s2 = \"moon\"");
    let text = "format = 1\ntitle = \"level\"\nrobot = \"robot.toml\"\nduration_s = 1.0\nGRAVITY\n\
                [ground]\nkind = \"flat\"\nsize_x_m = 6.0\nsize_y_m = 4.0\nsoil = \"dry-sand\"\n[control]\noptimum = 0.3\n\
                [[leg]]\nspeed_m_per_s = 0.1\nduration_s = 1.0\n";
    let energy = |line: &str| {
        let path = folder.path("level.toml");
        fs::write(&path, text.replace("GRAVITY", line)).unwrap();
        let run = grouser(["drive", &path.display().to_string(), "--json"]);
        let object = run.assert_done().json();
        object["runs"][0]["energy_in_soil_j"].as_f64().unwrap()
    };
    let moon = energy("");
    assert_eq!(moon, energy("gravity_m_per_s2 = \"moon\""));
    let earth = energy("gravity_m_per_s2 = \"earth\"");
    assert!(earth > 1.5 * moon, "{earth} {moon}");
}
