//! Every law of a soil: the table of cases that the test `every_law` of `grouser-design` writes, as a point and as a curve.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use serde_json::{Value, json};

const SOIL: &str = include_str!("../../../crates/design/tests/every_law/soil.toml");
const CASES: &str = include_str!("../../../crates/design/tests/every_law/cases.csv");

fn answer(request: &Value) -> Value {
    serde_json::from_str(&grouser_page_wasm::answer(&request.to_string())).unwrap()
}

#[test]
fn every_law_is_that_of_the_table() {
    for row in CASES.lines().skip(1) {
        let columns: Vec<&str> = row.split(',').collect();
        let mut soil = SOIL.to_owned();
        for law in columns[0].split(' ') {
            let (key, name) = law.split_once('=').unwrap();
            soil.extend([key, " = \"", name, "\"\n"]);
        }
        let numbers: Vec<f64> = columns[1..].iter().map(|x| x.parse().unwrap()).collect();
        let [slip, angle, expected @ ..] = &numbers[..] else {
            panic!("{row}");
        };
        let common = json!({
            "soil": soil, "radius_m": 0.125, "width_m": 0.1, "load_n": 60.0, "slip_angle_deg": angle, "slip": slip,
            "slip_from": slip, "slip_to": slip + 0.1, "points": 2, "profile": 0,
        });
        for (call, quick) in [("wheel", false), ("curve", false), ("curve", true)] {
            let mut request = common.clone();
            (request["call"], request["quick"]) = (json!(call), json!(quick));
            let found = answer(&request);
            for (name, expected) in ["sinkage_m", "drawbar_pull_n", "torque_nm"]
                .into_iter()
                .zip(expected)
            {
                let value = found[name].get(0).unwrap_or(&found[name]);
                let value = value.as_f64().unwrap_or(f64::NAN);
                assert!(
                    (value - expected).abs() < 1e-6,
                    "{row}: {call} {quick} has {found}"
                );
            }
        }
    }
}
