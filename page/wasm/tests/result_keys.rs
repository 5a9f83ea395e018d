//! The keys of an answer are those of the command, but for the exceptions of the shared list.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeSet;

use serde_json::{Value, json};

#[test]
fn a_wheel_has_the_keys_of_the_command() {
    let list = include_str!("../../../crates/cli/tests/result_keys.json");
    let list: Value = serde_json::from_str(list).unwrap();
    let request = json!({
        "call": "wheel", "soil": include_str!("../../../crates/design/tests/every_law/soil.toml"), "radius_m": 0.125,
        "width_m": 0.1, "load_n": 60.0, "slope_deg": 5.0, "profile": 2, "grouser_height_m": 0.01, "grouser_count": 12,
        "grouser_thickness_m": 0.002,
    });
    let found = grouser_page_wasm::answer(&request.to_string());
    let found: Value = serde_json::from_str(&found).unwrap();
    let found: BTreeSet<&str> = found
        .as_object()
        .unwrap()
        .keys()
        .map(|key| &**key)
        .collect();
    let wheel = &list["wheel"];
    let of = |key: &str| -> BTreeSet<&str> {
        let exceptions = wheel["page"][key].as_object().unwrap();
        exceptions.keys().map(|key| &**key).collect()
    };
    let keys = wheel["keys"].as_array().unwrap().iter();
    let keys: BTreeSet<&str> = keys.map(|key| key.as_str().unwrap()).collect();
    let (lacks, adds) = (&keys - &found, &found - &keys);
    assert_eq!((lacks, adds), (of("lacks"), of("adds")));
}
