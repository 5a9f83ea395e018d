//! What the server serves: the page's files and modules, which are part of the program.

use grouser_page::{Document, files};

/// The modules that compute in the page, compressed, the explorer first.
static MODULES: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/modules.rs"));

/// The page with all its modules; with a `file` that it opens it has the explorer alone: a report stays small.
#[must_use]
pub fn page<'a>(file: Option<(&'a str, &'a [u8])>) -> Document<'a> {
    let (page, modules) = match file {
        Some((name, bytes)) => (Document::of_file(name, bytes), &MODULES[..1]),
        None => (Document::new(), MODULES),
    };
    modules
        .iter()
        .fold(page, |page, (name, bytes)| page.module(name, bytes))
}

/// The names of all files.
pub fn names() -> impl Iterator<Item = String> {
    let modules = MODULES.iter().map(|(name, _)| format!("{name}.wasm.gz"));
    files::ALL
        .iter()
        .map(|(name, _)| (*name).to_owned())
        .chain(modules)
}

/// A file by its name; `None` for any other name.
#[must_use]
pub fn find(name: &str) -> Option<&'static [u8]> {
    if let Some(module) = name.strip_suffix(".wasm.gz") {
        let (_, bytes) = MODULES.iter().find(|(own, _)| *own == module)?;
        return Some(bytes);
    }
    files::text(name).ok().map(str::as_bytes)
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
