//! Standard output and standard error: complete, in order, and never a panic.

use std::io::{self, IsTerminal as _, Write as _};
use std::path::Path;

use grouser_report::{Layout, wrapped};
use serde_json::Value;

use crate::error::{Error, Result};
use crate::exit::BAD_INPUT;

/// Columns of a line where nobody looks at it.
const PIPED_COLUMNS: usize = 80;

/// Blanks before the rest of a line that was too long.
const HANGING: usize = 2;

/// Chooses digits and details of the results, and the width of their lines: `COLUMNS`, else the terminal's.
pub(crate) fn lay_out(digits: usize, details: bool) {
    let stdout = console::Term::stdout();
    let terminal = || {
        Some(usize::from(
            stdout.size_checked().filter(|_| stdout.is_term())?.1,
        ))
    };
    let set = std::env::var("COLUMNS")
        .ok()
        .and_then(|set| set.parse().ok());
    let columns = set.or_else(terminal).unwrap_or(PIPED_COLUMNS);
    Layout {
        digits,
        columns,
        details,
    }
    .choose();
}

/// Writes a result to standard output, its first line in bold on a terminal.
pub(crate) fn print(text: &str) -> Result<()> {
    let (headline, rest) = text.split_once('\n').unwrap_or((text, ""));
    let headline = lines(headline);
    if io::stdout().is_terminal() && allows_colour() && !headline.trim().is_empty() {
        print_raw(&format!(
            "{BOLD}{}{RESET}\n{}",
            headline.trim_end(),
            lines(rest)
        ))
    } else {
        print_raw(&(headline + &lines(rest)))
    }
}

/// Writes help to standard output.
pub(crate) fn print_help(text: &str) -> Result<()> {
    print_file(&help(text))
}

/// Help, no wider than the terminal.
pub(crate) fn help(text: &str) -> String {
    wrapped(text, Layout::current().columns, 0)
}

/// Writes a text to standard output as it is.
pub(crate) fn print_file(text: &str) -> Result<()> {
    print_raw(&printable(text))
}

/// The lines of a text for people. Control characters, which names in files may hold, are shown and not sent.
fn lines(text: &str) -> String {
    wrapped(&printable(text), Layout::current().columns, HANGING)
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

/// Writes at once. A reader that has gone away is no error.
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
    let _ = io::stderr().lock().write_all(lines(text).as_bytes());
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

/// Do both outputs go to a terminal?
pub(crate) fn is_one() -> bool {
    io::stdout().is_terminal() && io::stderr().is_terminal()
}

/// `warning: …` on standard error.
pub(crate) fn warn(message: &str) {
    say("warning", YELLOW, message);
}

const BOLD: &str = "\x1b[1m";
const RESET: &str = "\x1b[0m";
const RED: &str = "\x1b[1;31m";
const YELLOW: &str = "\x1b[1;33m";
const CYAN: &str = "\x1b[1;36m";

fn say(label: &str, colour: &str, message: &str) {
    let mut err = io::stderr().lock();
    let mut text = lines(&format!("{label}: {message}"));
    if io::stderr().is_terminal() && allows_colour() {
        text.replace_range(..label.len(), &format!("{colour}{label}{RESET}"));
    }
    // Where standard error fails, nothing can be reported any more.
    let _ = err.write_all(text.as_bytes());
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

fn allows_colour() -> bool {
    let off =
        |name, off: fn(&std::ffi::OsStr) -> bool| std::env::var_os(name).is_some_and(|v| off(&v));
    !off("NO_COLOR", |v| !v.is_empty()) && !off("TERM", |v| v == "dumb")
}
