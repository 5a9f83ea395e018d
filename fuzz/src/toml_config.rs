//! Soil, robot, columns and problem files out of any text: parsed or refused at a place.
#![no_main]

use grouser_files::{Document, columns, robot, soil};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let Ok(document) = Document::from_text("file.toml", text.to_owned()) else {
        return;
    };
    if let Err(error) = soil::parse(&document) {
        assert!(!error.to_string().is_empty());
    }
    if let Err(error) = robot::parse(&document) {
        assert!(!error.to_string().is_empty());
    }
    if let Err(error) = columns::parse(&document) {
        assert!(!error.to_string().is_empty());
    }
    if let Err(error) = grouser_design::parse(&document) {
        assert!(!error.to_string().is_empty());
    }
});
