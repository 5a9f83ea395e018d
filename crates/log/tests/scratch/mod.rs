//! A folder of its own for each test, and a log out of a text.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

use grouser_files::{Document, columns};
use grouser_log::{Error, Log};
use grouser_slip::Sample;

pub(crate) struct Folder(pub(crate) PathBuf);

impl Folder {
    pub(crate) fn new(name: &str) -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!("grouser-log-{name}-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(crate) fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, bytes).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A map of one table with time `t` (s), a count `n` of wheel `w`, and a yaw rate `g`.
pub(crate) fn map(options: &str) -> columns::ColumnMap {
    let text = format!(
        "format = 1\n[[table]]\n{options}\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [\n\
         {{ column = \"n\", meaning = \"wheel_count\", wheel = \"w\", unit = \"tick\" }},\n\
         {{ column = \"g\", meaning = \"yaw_rate\", unit = \"rad/s\" }},\n]\n"
    );
    columns::parse(&Document::from_text("map.toml", text).unwrap()).unwrap()
}

/// All records of a log of these bytes, or the error: never both.
pub(crate) fn read(name: &str, options: &str, bytes: &[u8]) -> Result<Vec<Sample>, Error> {
    let folder = Folder::new(name);
    let file = folder.file("log.csv", bytes);
    let log = Log::find(&[file], map(options))?;
    log.samples(&[])?.collect()
}
