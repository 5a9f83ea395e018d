//! Input files: regular files only, hashed while they are read.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use grouser_files::regular;
use sha2::{Digest as _, Sha256};

use crate::error::Result;

/// The name that stands for standard input.
pub(crate) const STANDARD_INPUT: &str = "-";

/// A file being read, or standard input.
pub(crate) struct Input {
    source: Box<dyn Read + Send>,
    hash: Sha256,
    path: PathBuf,
    length: Option<u64>,
}

impl Input {
    /// Opens `path`; `-` is standard input.
    ///
    /// What has no end (a device) or may never begin (a pipe nobody writes to) is refused, so that no
    /// verb hangs on its arguments.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let (source, length): (Box<dyn Read + Send>, _) = if path == Path::new(STANDARD_INPUT) {
            (Box::new(io::stdin()), None)
        } else {
            let file = regular::open(path)?;
            let length = file.metadata().ok().map(|found| found.len());
            (Box::new(file), length)
        };
        Ok(Self {
            source,
            hash: Sha256::new(),
            path: path.to_owned(),
            length,
        })
    }

    /// Its name as given.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Its size in bytes when it was opened; standard input has none.
    pub(crate) fn length(&self) -> Option<u64> {
        self.length
    }

    /// Its name and the SHA-256 of what was read.
    pub(crate) fn digest(self) -> (String, String) {
        (self.path.display().to_string(), hexadecimal(self.hash))
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
        self.hash.update(&buffer[..count]);
        Ok(count)
    }
}
