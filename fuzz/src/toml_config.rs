//! Soil, robot, columns, problem, mission and scenario files out of any text: parsed or refused at a place.

use std::sync::LazyLock;

use grouser_files::{Document, columns, robot, soil};
use grouser_rover::drive::parse_scenario;
use grouser_rover::robot::RobotModel;

static ROBOT: LazyLock<RobotModel> = LazyLock::new(|| {
    let text = include_str!("../../examples/robots/five-wheel.toml");
    let document = Document::from_text("robot.toml", text.to_owned()).expect("a document");
    RobotModel::parse(&document).expect("a robot")
});

pub fn run(bytes: &[u8]) {
    let Ok(text) = core::str::from_utf8(bytes) else {
        return;
    };
    let Ok(document) = Document::from_text("file.toml", text.to_owned()) else {
        return;
    };
    said(soil::parse(&document));
    said(robot::parse(&document));
    said(RobotModel::parse(&document));
    said(columns::parse(&document));
    said(grouser_design::parse(&document));
    said(grouser_design::mission::parse(&document));
    said(
        parse_scenario(&document, "scenario", ROBOT.clone()).and_then(|scenario| scenario.check()),
    );
}

/// What is refused is refused with words.
fn said<T, E: std::fmt::Display>(result: Result<T, E>) {
    if let Err(error) = result {
        assert!(!error.to_string().is_empty());
    }
}
