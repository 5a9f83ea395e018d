//! Standard output and standard error: complete, in order, and never a panic.

use std::io::{self, IsTerminal as _, Write as _};
use std::path::Path;

use serde_json::Value;

use crate::error::{Error, Result};
use crate::exit::BAD_INPUT;

/// Writes `text` to standard output at once. A reader that has gone away is no error. Control characters, which names in
/// files may hold, are shown and not sent.
pub(crate) fn print(text: &str) -> Result<()> {
    print_raw(&printable(text))
}

/// Writes an object to standard output as JSON. JSON leaves the controls from U+007F to U+009F as they are, which
/// terminals obey as well: they are escaped.
pub(crate) fn print_json(object: &Value) -> Result<()> {
    use std::fmt::Write as _; // writing to a string cannot fail
    let mut text = String::new();
    for letter in format!("{object:#}\n").chars() {
        if letter.is_control() && letter != '\n' {
            let _ = write!(text, "\\u{:04x}", u32::from(letter));
        } else {
            text.push(letter);
        }
    }
    print_raw(&text)
}

fn print_raw(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Error::file("write", Path::new("standard output"), &error))
        }
        _ => Ok(()),
    }
}

/// `error: …` and `hint: …` on standard error, under `json` an object on standard output too, and the exit code that
/// goes with them.
pub(crate) fn complain(error: &Error, json: bool) -> u8 {
    if json {
        // Where standard output fails, standard error still says what is wrong.
        let _ = print_json(&error.object());
    }
    say("error", RED, &error.to_string());
    if let Some(hint) = error.hint() {
        say("hint", CYAN, hint);
    }
    BAD_INPUT
}

/// Text on standard error.
pub(crate) fn remark(text: &str) {
    // Where standard error fails, nobody reads it.
    let _ = io::stderr().lock().write_all(printable(text).as_bytes());
}

/// The step that a job is at, on standard error where somebody looks at it.
pub(crate) fn progress(step: &str) {
    if io::stderr().is_terminal() {
        remark(&format!("{step}\n"));
    }
}

/// `error: …` on standard error, for a job that ended without its result.
pub(crate) fn fail(message: &str) {
    say("error", RED, message);
}

/// `warning: …` on standard error.
pub(crate) fn warn(message: &str) {
    say("warning", YELLOW, message);
}

const RED: &str = "\x1b[1;31m";
const YELLOW: &str = "\x1b[1;33m";
const CYAN: &str = "\x1b[1;36m";

fn say(label: &str, colour: &str, message: &str) {
    let mut err = io::stderr().lock();
    let message = printable(message);
    // Where standard error fails, nothing can be reported any more.
    let _ = if in_colour() {
        writeln!(err, "{colour}{label}\x1b[0m: {message}")
    } else {
        writeln!(err, "{label}: {message}")
    };
}

/// A file name, a flag's value or a name in a file may hold escape sequences: they are shown, not obeyed.
pub(crate) fn printable(message: &str) -> String {
    let mut shown = String::with_capacity(message.len());
    for letter in message.chars() {
        if letter.is_control() && !matches!(letter, '\n' | '\t') {
            shown.extend(letter.escape_default());
        } else {
            shown.push(letter);
        }
    }
    shown
}

fn in_colour() -> bool {
    let off =
        |name, off: fn(&std::ffi::OsStr) -> bool| std::env::var_os(name).is_some_and(|v| off(&v));
    io::stderr().is_terminal()
        && !off("NO_COLOR", |v| !v.is_empty())
        && !off("TERM", |v| v == "dumb")
}
