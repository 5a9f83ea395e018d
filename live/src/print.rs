//! What the node prints.

use std::io::Write as _;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use grouser_log::Intake;
use grouser_replay::{Inputs, Summary};
use grouser_slip::detect::{Change, Event};

/// A line on standard output.
pub(crate) fn say(line: &str) {
    let mut out = std::io::stdout().lock();
    // a closed terminal does not end the node
    let _ = writeln!(out, "{line}").and_then(|()| out.flush());
}

/// While the screen is open, problems are shown there: a line in between would break the picture.
pub(crate) static SCREEN_IS_OPEN: AtomicBool = AtomicBool::new(false);

/// A warning on standard error.
pub(crate) fn warn(line: &str) {
    if SCREEN_IS_OPEN.load(Ordering::Relaxed) {
        return;
    }
    let _ = writeln!(std::io::stderr(), "warning: {line}");
}

/// An error on standard error.
pub fn complain(line: &str) {
    let _ = writeln!(std::io::stderr(), "error: {line}");
}

/// Prints what is used, and how.
pub(crate) fn say_choice(intake: &Intake, inputs: &Inputs, hold: Duration) {
    for topic in intake.topics() {
        say(&format!(
            "{} ({}): {}",
            topic.topic, topic.type_name, topic.used_for
        ));
    }
    for note in intake.notes() {
        say(note);
    }
    say(&format!(
        "reference: {}; messages are held back for {:.1} ms",
        inputs.reference.name(),
        1e3 * hold.as_secs_f64()
    ));
}

/// An event in words.
pub(crate) fn event_line(change: &Change, names: &[String]) -> String {
    let wheel = |index: usize| names.get(index).map_or("", String::as_str);
    let what = match change.event {
        Event::HighSlip { wheel: i } => format!("high slip of {}", wheel(i)),
        Event::Stall { wheel: i } => format!("stall of {}", wheel(i)),
        Event::LiftOff { wheel: i } => format!("lift-off of {}", wheel(i)),
        Event::DigIn => "the wheels dig in".to_owned(),
        Event::Immobilised => "the robot is immobilised".to_owned(),
    };
    format!(
        "event: {what} {}",
        if change.begins { "begins" } else { "ends" }
    )
}

/// The end of a run in words.
pub(crate) fn summary_line(summary: &Summary, messages: u64, steps: u64) -> String {
    let wheels = summary
        .wheels
        .iter()
        .filter_map(|wheel| Some(format!("{} {:.3}", wheel.name, wheel.slip.median?)));
    let wheels: Vec<String> = wheels.collect();
    format!(
        "{messages} messages, {steps} estimates; median slip: {}",
        wheels.join(", ")
    )
}
