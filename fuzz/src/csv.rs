//! A table out of any bytes: records or an error, never both, and never more than rows.
use std::cell::RefCell;
use std::fs;
use std::path::PathBuf;

use grouser_files::{Document, columns};
use grouser_log::Log;
use grouser_slip::Measurement;

const OPTIONS: [&str; 6] = [
    "",
    "separator = \";\"\ndecimal = \",\"",
    "separator = \"tab\"",
    "missing = [\"nan\"]",
    "header_lines = 2\nnames_line = 1",
    "",
];

thread_local! {
    /// A file in memory where the system has one.
    static FILE: RefCell<PathBuf> = {
        let memory = PathBuf::from("/dev/shm");
        let folder = if memory.is_dir() { memory } else { std::env::temp_dir() };
        RefCell::new(folder.join(format!("grouser-fuzz-{}.csv", std::process::id())))
    };
}

pub fn run(bytes: &[u8]) {
    let Some((&kind, table)) = bytes.split_first() else {
        return;
    };
    let options = OPTIONS[usize::from(kind) % OPTIONS.len()];
    let text = format!(
        "format = 1\n[[table]]\n{options}\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [\n\
         {{ column = \"n\", meaning = \"wheel_count\", wheel = \"w\", unit = \"tick\" }},\n\
         {{ column = \"g\", meaning = \"yaw_rate\", unit = \"rad/s\" }},\n]\n"
    );
    let document = Document::from_text("map.toml", text).expect("a document");
    let map = columns::parse(&document).expect("a map");
    FILE.with_borrow(|file| {
        fs::write(file, table).expect("a file");
        let Ok(log) = Log::find(std::slice::from_ref(file), map) else {
            return;
        };
        let Ok(records) = log.samples(&[]) else {
            return;
        };
        let Ok(records) = records.collect::<Result<Vec<_>, _>>() else {
            return;
        };
        if !table.starts_with(&[0x1f, 0x8b]) {
            let rows = table.split(|byte| matches!(byte, b'\n' | b'\r')).count();
            assert!(records.len() <= 2 * rows);
        }
        for record in records {
            if let Measurement::YawRate { rate } = record.measurement {
                assert!(rate.is_finite());
            }
        }
    });
}
