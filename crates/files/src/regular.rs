//! Opening files that end: regular ones, read by copy and never mapped.

use std::fs::{self, File, FileType};
use std::io::{self, Read};
use std::path::Path;

use crate::error::{Error, Place, Result};

/// Opens a regular file for reading.
///
/// # Errors
/// [`Error::NotAFile`] for a directory, a pipe, a device or a socket (checked before opening: to open a
/// pipe may wait for ever); [`Error::Unreadable`] for whatever the system refuses, a loop of links
/// included.
///
/// ```
/// use grouser_files::{Error, regular};
///
/// let error = regular::open(std::path::Path::new("/")).unwrap_err();
/// assert!(matches!(error, Error::NotAFile { .. }));
/// ```
pub fn open(path: &Path) -> Result<File> {
    let name = || path.display().to_string();
    let unreadable = |source: io::Error| Error::Unreadable {
        file: name(),
        source,
    };
    let check = |kind: FileType| match what(kind) {
        None => Ok(()),
        Some(what) => Err(Error::NotAFile { file: name(), what }),
    };
    check(fs::metadata(path).map_err(unreadable)?.file_type())?;
    let file = File::open(path).map_err(unreadable)?;
    // Checked again on the open file: the name may have changed hands in between.
    check(file.metadata().map_err(unreadable)?.file_type())?;
    Ok(file)
}

fn what(kind: FileType) -> Option<&'static str> {
    if kind.is_file() {
        return None;
    }
    if kind.is_dir() {
        return Some("a directory");
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_fifo() {
            return Some("a pipe");
        }
        if kind.is_char_device() || kind.is_block_device() {
            return Some("a device");
        }
        if kind.is_socket() {
            return Some("a socket");
        }
    }
    Some("something else")
}

/// Reads a text file of at most `limit` bytes.
///
/// # Errors
/// As [`open`]; [`Error::TooLarge`]; [`Error::NotText`].
pub fn read_text(path: &Path, limit: u64) -> Result<String> {
    let file = path.display().to_string();
    let mut bytes = Vec::new();
    let read = open(path)?.take(limit + 1).read_to_end(&mut bytes);
    if let Err(source) = read {
        return Err(Error::Unreadable { file, source });
    }
    if bytes.len() as u64 > limit {
        return Err(Error::TooLarge { file, limit });
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let text = String::from_utf8_lossy(good);
        Error::NotText {
            at: place(&file, &text, text.len()),
        }
    })
}

/// The place of a byte offset in a text.
#[must_use]
pub fn place(file: &str, text: &str, offset: usize) -> Place {
    let before = text.get(..offset).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    Place {
        file: file.into(),
        line: before.matches('\n').count() + 1,
        column: before[line_start..].chars().count() + 1,
    }
}
