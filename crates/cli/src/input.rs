//! Input files: regular files only, hashed while they are read where the hash is reported.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use grouser_files::regular;
use grouser_rover::robot::RobotModel;
use sha2::{Digest as _, Sha256};

use crate::error::{Error, Result, shown};
use crate::figure_file::ending;
use crate::files_in_use;

/// The name that stands for standard input or standard output.
pub(crate) const STANDARD: &str = "-";

/// The robot of a file.
pub(crate) fn robot(path: &Path) -> Result<RobotModel> {
    RobotModel::read(path).map_err(|error| Error::from(error).in_file(path))
}

/// A file being read, or standard input.
pub(crate) struct Input {
    source: Box<dyn Read + Send>,
    /// `None` where nobody reads it.
    hash: Option<Sha256>,
    path: PathBuf,
    length: Option<u64>,
}

impl Input {
    /// Opens `path`; `-` is standard input.
    ///
    /// What has no end (a device) or may never begin (a pipe nobody writes to) is refused, so that no
    /// verb hangs on its arguments.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let (source, length): (Box<dyn Read + Send>, _) = if path == Path::new(STANDARD) {
            (Box::new(io::stdin()), None)
        } else {
            let file = regular::open(path)?;
            files_in_use::reads(path);
            let length = file.metadata().ok().map(|found| found.len());
            (Box::new(file), length)
        };
        Ok(Self {
            source,
            hash: Some(Sha256::new()),
            path: path.to_owned(),
            length,
        })
    }

    /// Opens a CSV table, which is long, and hashes it only if that is reported.
    pub(crate) fn open_table(path: &Path, is_reported: bool) -> Result<Self> {
        refuse_parquet(path)?;
        let mut input = Self::open(path)?;
        input.hash = input.hash.filter(|_| is_reported);
        Ok(input)
    }

    /// Its name as given.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Its size in bytes when it was opened; standard input has none.
    pub(crate) fn length(&self) -> Option<u64> {
        self.length
    }

    /// Its name and the SHA-256 of what was read, where it is reported.
    pub(crate) fn digest(self) -> Option<(String, String)> {
        let digest = self.hash.map(hexadecimal)?;
        Some((self.path.display().to_string(), digest))
    }
}

/// Refuses a table whose name says Parquet: a CSV table of that name would mislead whoever opens it.
pub(crate) fn refuse_parquet(path: &Path) -> Result<()> {
    match ending(path).as_deref() {
        Some("parquet") => Err(Error::usage(
            format!("{} is a Parquet file, not a CSV table", shown(path)),
            "convert it, or solve it in Python with `under_load` and `at_sinkage`",
        )),
        _ => Ok(()),
    }
}

/// The SHA-256 of `bytes`.
pub(crate) fn digest(bytes: &[u8]) -> String {
    hexadecimal(Sha256::new_with_prefix(bytes))
}

fn hexadecimal(hash: Sha256) -> String {
    use std::fmt::Write as _;
    let mut hex = String::with_capacity(64);
    for byte in hash.finalize() {
        // Writing to a string cannot fail.
        let _ = write!(hex, "{byte:02x}");
    }
    hex
}

impl Read for Input {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.source.read(buffer)?;
        if let Some(hash) = &mut self.hash {
            hash.update(&buffer[..count]);
        }
        Ok(count)
    }
}
