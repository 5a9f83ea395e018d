//! The scenarios and problems that a page has without a file.

use serde_json::{Value, json};

/// Name, scenario file, robot file.
#[cfg(feature = "drive")]
const EXAMPLES: [(&str, &str, &str); 3] = [
    (
        "sandbox",
        include_str!("../../../examples/scenarios/sandbox.toml"),
        include_str!("../../../examples/robots/five-wheel.toml"),
    ),
    (
        "soft-patch",
        include_str!("../../../examples/scenarios/soft-patch.toml"),
        include_str!("../../../examples/robots/five-wheel.toml"),
    ),
    (
        "slope",
        include_str!("../../../examples/scenarios/slope.toml"),
        include_str!("../../../examples/robots/five-wheel.toml"),
    ),
];

/// Problem files for the optimiser: name, text.
#[cfg(feature = "optimize")]
const PROBLEMS: [(&str, &str); 4] = [
    (
        "dry-sand-wheel",
        include_str!("../../../examples/problems/dry-sand-wheel.toml"),
    ),
    (
        "pull-against-torque",
        include_str!("../../../examples/problems/pull-against-torque.toml"),
    ),
    (
        "running-slip",
        include_str!("../../../examples/problems/running-slip.toml"),
    ),
    (
        "robust-wheel",
        include_str!("../../../examples/problems/robust-wheel.toml"),
    ),
];

/// The scenarios with their robots, as the texts of their files.
#[cfg(feature = "drive")]
pub(crate) fn scenarios() -> Value {
    let examples: Vec<Value> = EXAMPLES
        .iter()
        .map(
            |(name, scenario, robot)| json!({ "name": name, "scenario": scenario, "robot": robot }),
        )
        .collect();
    json!({ "examples": examples })
}

/// The problems, as the texts of their files.
#[cfg(feature = "optimize")]
pub(crate) fn problems() -> Value {
    let problems: Vec<Value> = PROBLEMS
        .iter()
        .map(|(name, text)| json!({ "name": name, "text": text }))
        .collect();
    json!({ "problems": problems })
}
