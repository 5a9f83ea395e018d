//! The page's files, which are part of the program: nothing is read from the disk while it serves.

use crate::error::{Error, Result};

static FILES: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/assets.rs"));

/// The modules that a page carries, in the order in which they are embedded: the explorer first, without which no page
/// starts.
pub const MODULES: [&str; 4] = ["explore", "drive", "log", "optimize"];

/// The names of all files.
pub fn names() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|(name, _)| *name)
}

/// A file by its name; `None` for any other name.
#[must_use]
pub fn find(name: &str) -> Option<&'static [u8]> {
    let (_, bytes) = FILES.iter().find(|(own, _)| *own == name)?;
    Some(bytes)
}

/// A file that the page cannot do without.
///
/// # Errors
/// [`Error::Missing`] if it is not there, or no text where one is expected.
pub fn text(name: &str) -> Result<&'static str> {
    find(name)
        .and_then(|bytes| std::str::from_utf8(bytes).ok())
        .ok_or_else(|| Error::Missing {
            name: name.to_owned(),
        })
}

/// What a browser takes a file for.
#[must_use]
pub fn content_type(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("gz") => "application/gzip",
        _ => "application/octet-stream",
    }
}
