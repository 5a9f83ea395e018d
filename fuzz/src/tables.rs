//! Tables of tests and of soils, and maps of places, out of any text: read or refused with words.

use std::path::Path;

use grouser_files::Document;
use grouser_identify::Job;
use grouser_identify::table::Table;
use grouser_terrain::SoilIntervals;

pub fn run(bytes: &[u8]) {
    let Some((&kind, bytes)) = bytes.split_first() else {
        return;
    };
    let Ok(text) = core::str::from_utf8(bytes) else {
        return;
    };
    if kind % 2 == 0 {
        if let Err(error) = Table::parse(Path::new("table.csv"), text) {
            assert!(!error.to_string().is_empty());
        }
        return;
    }
    let Ok(document) = Document::from_text("file.toml", text.to_owned()) else {
        return;
    };
    if let Err(error) = Job::read(&document) {
        assert!(!error.to_string().is_empty());
    }
    if let Ok(intervals) = SoilIntervals::parse(&document) {
        let soil = grouser_terra::catalogue::find("dry-sand")
            .expect("a soil")
            .soil()
            .expect("its numbers");
        let _ = intervals.draw(&soil, 8, 1);
    }
}
