//! One steepest slope in every command that knows one.

use super::program::{Folder, grouser};

const ROBOT: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../examples/robots/skid-steer.toml"
);
const DUNES: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../examples/terrain/dunes.asc"
);

fn number(value: &serde_json::Value, key: &str) -> f64 {
    value[key]
        .as_f64()
        .unwrap_or_else(|| panic!("{key}: {value}"))
}

#[test]
fn climb_map_and_design_agree_on_the_steepest_slope_of_a_robot() {
    let folder = Folder::new();
    let map = folder.path("map.tif");
    let map = map.to_str().unwrap();
    for max_slip in ["0.6", "0.4"] {
        let common = ["--soil", "dry-sand", "--max-slip", max_slip, "--json"];
        let run = |words: &[&str]| grouser(words.iter().chain(&common)).assert_done().json();
        let climbed = run(&["climb", "--robot", ROBOT]);
        let steepest = number(&climbed, "steepest_slope_deg");
        assert!((5.0..25.0).contains(&steepest), "{steepest}");
        let last = climbed["steps"].as_array().unwrap().last().unwrap();
        assert!((number(last, "slip") - number(&climbed, "max_slip")).abs() < 1e-3);
        let mapped = run(&["map", DUNES, "--robot", ROBOT, "--headings", "4", "-o", map]);
        let off = number(&mapped, "steepest_deg") - steepest;
        assert!(off.abs() < 1e-6, "{max_slip}: {off}");
        for (more, is_held) in [(-1e-5, true), (1e-5, false)] {
            let slope = format!("{:.8}", steepest + more);
            let words = ["design", ROBOT, "--slope-deg", &slope, "--points", "2"];
            let common = common.iter().copied();
            let made = grouser(words.into_iter().chain(common)).json();
            let station = &made["present"]["stations"][0];
            assert_eq!(station["slip"].is_number(), is_held, "{slope}: {station}");
        }
    }
}

#[test]
fn a_wheel_holds_slopes_up_to_the_steepest_that_climb_finds() {
    let wheel = [
        "--soil",
        "dry-sand",
        "--radius-m",
        "0.15",
        "--width-m",
        "0.1",
        "--load-n",
        "40",
    ];
    let climbed = grouser(["climb", "--json"].iter().chain(&wheel));
    let steepest = number(&climbed.assert_done().json(), "steepest_slope_deg");
    for (more, is_held) in [(-1e-6, true), (1e-6, false)] {
        let slope = format!("{:.9}", steepest + more);
        let words = ["wheel", "--json", "--slope-deg", &slope];
        let found = grouser(words.iter().chain(&wheel)).json();
        assert_eq!(
            found["slip_demand"].is_number(),
            is_held,
            "{slope}: {found}"
        );
    }
}
