//! Input files: regular files only, hashed while they are read.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use sha2::{Digest as _, Sha256};

use crate::error::{Error, Result};

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
            let refuse = |error: io::Error| Error::file("read", path, &error);
            let found = std::fs::metadata(path).map_err(refuse)?;
            if !found.is_file() {
                let kind = if found.is_dir() {
                    "it is a directory"
                } else {
                    "it is not a regular file"
                };
                return Err(Error::File {
                    action: "read",
                    path: path.to_owned(),
                    reason: kind.to_owned(),
                    hint: (!found.is_dir()).then(|| "`-` reads standard input".to_owned()),
                });
            }
            (
                Box::new(File::open(path).map_err(refuse)?),
                Some(found.len()),
            )
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

    /// Its name and the SHA-256 of what was read, in hexadecimal.
    pub(crate) fn digest(self) -> (String, String) {
        use std::fmt::Write as _;
        let mut hex = String::with_capacity(64);
        for byte in self.hash.finalize() {
            // Writing to a string cannot fail.
            let _ = write!(hex, "{byte:02x}");
        }
        (self.path.display().to_string(), hex)
    }
}

impl Read for Input {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.source.read(buffer)?;
        self.hash.update(&buffer[..count]);
        Ok(count)
    }
}
