//! Wheels that sink too deep for the laws are said by every verb that computes with them.

use std::fs;

use serde_json::Value;

use super::program::{Folder, grouser};

/// 37 N on a wheel of 0.15 m in snow: half a radius deep, where the laws end at a third. On dry sand it is a tenth.
const WHEEL: [&str; 6] = [
    "--radius-m",
    "0.15",
    "--width-m",
    "0.12",
    "--load-n",
    "37.3",
];
const DEEP: &str = "a sixth of the wheel's diameter";

fn robot() -> String {
    let root = env!("CARGO_MANIFEST_DIR");
    format!("{root}/../../examples/robots/skid-steer.toml")
}

/// What a verb says with `--json`, and whether it warns of deep wheels.
fn answer(arguments: &[&str]) -> (Value, bool) {
    let said = grouser([arguments, &["--json"]].concat());
    let json = said.json();
    let warns = said.err.contains(DEEP);
    (json, warns)
}

#[test]
fn climb_says_it_of_each_slope() {
    let robot = robot();
    for (soil, is_deep) in [("snow", true), ("dry-sand", false)] {
        let robot = ["--robot", robot.as_str()];
        for of in [&WHEEL[..], &robot[..]] {
            let (json, warns) = answer(&[&["climb", "--soil", soil], of].concat());
            let level = &json["steps"][0]["cautions"];
            let keys: Vec<&str> = level
                .as_array()
                .unwrap()
                .iter()
                .map(|key| key.as_str().unwrap())
                .collect();
            assert_eq!(keys.contains(&"deep-sinkage"), is_deep, "{soil} {of:?}");
            assert_eq!(warns, is_deep, "{soil} {of:?}");
        }
    }
}

#[test]
fn optimize_says_it_of_what_it_found() {
    let folder = Folder::new();
    let path = folder.path("p.toml");
    for (soil, method, is_deep) in [
        ("snow", "minimax", true),
        ("dry-sand", "minimax", false),
        ("snow", "pareto", true),
    ] {
        let second = if method == "pareto" {
            "torque = \"torque_nm\"\n[pareto]\npopulation = 8\ngenerations = 2\n"
        } else {
            ""
        };
        fs::write(
            &path,
            format!(
                "format = 1\nmethod = \"{method}\"\n[variables]\nslip = {{ start = 0.2, lower = 0.01, upper = 0.8 }}\n\
                 [wheel]\nradius_m = 0.15\nwidth_m = 0.12\n[soil]\nkey = \"{soil}\"\n[state]\nload_n = 37.3\n\
                 [objectives]\npull = {{ maximise = \"drawbar_pull_n\" }}\n{second}"
            ),
        )
        .unwrap();
        assert_eq!(
            answer(&["optimize", &path.display().to_string()]).1,
            is_deep,
            "{soil} {method}"
        );
    }
}

#[test]
fn map_and_drive_say_for_how_much() {
    let folder = Folder::new();
    let (dem, map) = (folder.path("flat.asc"), folder.path("m.tif"));
    let row = "0 0 0 0 0 0 0 0\n".repeat(8);
    fs::write(
        &dem,
        format!("ncols 8\nnrows 8\nxllcorner 0\nyllcorner 0\ncellsize 1\n{row}"),
    )
    .unwrap();
    let (robot, dem, map) = (
        robot(),
        dem.display().to_string(),
        map.display().to_string(),
    );
    for (soil, is_deep) in [("snow", true), ("dry-sand", false)] {
        let (json, warns) = answer(&["map", &dem, "--robot", &robot, "--soil", soil, "-o", &map]);
        assert_eq!(
            json["deep"].as_f64(),
            Some(f64::from(u8::from(is_deep))),
            "{soil}"
        );
        assert_eq!(warns, is_deep, "{soil}");
        let (json, warns) = answer(&["plan", &map, "--from", "2,2", "--to", "6,6"]);
        let share = json["route"]["deep_share"].as_f64();
        assert_eq!(
            (share, warns),
            (Some(f64::from(u8::from(is_deep))), is_deep),
            "{soil}"
        );
        let scenario = folder.path("s.toml");
        fs::write(
            &scenario,
            format!(
                "format = 1\ntitle = \"level\"\nrobot = {robot:?}\nduration_s = 2.0\n[start]\nx_m = 2.0\n\
                 [ground]\nkind = \"flat\"\nsize_x_m = 6.0\nsize_y_m = 4.0\nsoil = \"{soil}\"\n\
                 [[leg]]\nspeed_m_per_s = 0.1\nduration_s = 2.0\n"
            ),
        )
        .unwrap();
        let (json, warns) = answer(&["drive", &scenario.display().to_string()]);
        let share = json["runs"][0]["deep_share"].as_f64().unwrap();
        assert_eq!((share > 0.5, warns), (is_deep, is_deep), "{soil}: {share}");
    }
}
