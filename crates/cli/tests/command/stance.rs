//! `robot --stance`: what a robot's wheels carry at rest.

use super::program::grouser;

#[test]
fn loads_carry_the_weight_and_shift_uphill() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/robots/skid-steer.toml"
    );
    let stand = |pitch: &str| {
        let run = grouser(["robot", file, "--stance", "--pitch-deg", pitch, "--json"]);
        run.assert_done().json()
    };
    let load = |object: &serde_json::Value, wheel: &str| object["loads_n"][wheel].as_f64().unwrap();
    let level = stand("0");
    let wheels = ["front_left", "front_right", "rear_left", "rear_right"];
    let sum: f64 = wheels.iter().map(|wheel| load(&level, wheel)).sum();
    // 12 kg of chassis and four wheels of 0.8 kg
    assert!((sum - 15.2 * 9.80665).abs() < 1e-6, "{sum}");
    let uphill = stand("15");
    assert!(load(&uphill, "rear_left") > load(&level, "rear_left"));
    let tips = |object: &serde_json::Value| object["margins"]["tip_over_deg"].as_f64().unwrap();
    assert!((tips(&level) - tips(&uphill) - 15.0).abs() < 1e-6);
    assert!(uphill["posture"]["tip_over_deg"].as_f64().unwrap() >= tips(&uphill));
    assert!(level["on_heights"].is_null());
}

#[test]
fn on_uneven_heights_it_says_how_the_links_lie() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/robots/five-wheel.toml"
    );
    let heights = "0.05,0,0,0,0,0";
    let run = grouser(["robot", file, "--stance", "--heights-m", heights, "--json"]);
    let object = run.assert_done().json();
    let stance = &object["on_heights"];
    assert_eq!(stance["settled"], true);
    // a differential halves what one rocker does, and the chassis leans less than the wheel is raised
    let roll = stance["roll_deg"].as_f64().unwrap();
    assert!(roll > 0.5 && roll < 6.0, "{roll}");
    let refused = grouser(["robot", file, "--stance", "--heights-m", "0.05,0"]);
    refused.assert_refused("number of heights");
}
