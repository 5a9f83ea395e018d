//! A robot description out of any XML: a robot file that is read again, or a refusal with words.

use grouser_files::{Document, robot, urdf};

pub fn run(bytes: &[u8]) {
    let Ok(text) = core::str::from_utf8(bytes) else {
        return;
    };
    match urdf::robot_file(text) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(converted) => {
            let document = Document::from_text("robot.toml", converted.text).expect("valid TOML");
            if let Err(error) = robot::parse(&document) {
                assert!(!error.to_string().is_empty());
            }
        }
    }
}
