//! `log`: what a recorded log holds, in another format, and what can be saved of a damaged one.

pub(crate) mod convert;
pub(crate) mod info;
pub(crate) mod recover;
pub(crate) mod sheet;

use std::fmt::Write as _; // writing to a string cannot fail
use std::path::Path;

use grouser_log::container::{Damage, Format};
use grouser_log::write::Copied;
use serde_json::Value;

use crate::error::{Error, Result, shown};
use crate::figure_file::ending;
use crate::report::{Object, Report};
use crate::session::Session;
use grouser_report::Table;

#[derive(clap::Args, Debug)]
#[command(
    about = "Tell what a recorded log holds, convert it, recover a damaged one (MCAP, ROS 1 bag, CSV)"
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    job: Job,
}

#[derive(clap::Subcommand, Debug)]
enum Job {
    /// Topics or columns, types, rates, gaps, clock jumps, damage, and what Grouser can use
    Info(info::Arguments),
    /// Write a log in another format, chosen by the ending of OUT: .mcap, .bag, or .csv for one topic
    Convert(convert::Arguments),
    /// Write everything that can be read of a damaged MCAP file or bag, and say what is lost
    Recover(recover::Arguments),
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    match &arguments.job {
        Job::Info(arguments) => info::run(arguments, session),
        Job::Convert(arguments) => convert::run(arguments, session),
        Job::Recover(arguments) => recover::run(arguments, session),
    }
}

/// An object of these keys, in this order.
pub(super) fn keyed<const N: usize>(fields: [(&str, Value); N]) -> Object {
    let fields = fields.into_iter();
    fields.map(|(key, value)| (key.to_owned(), value)).collect()
}

/// Names come from the file: what would move a terminal's cursor is shown, not sent.
pub(super) fn printable(text: &str) -> String {
    let letters = text.chars();
    letters
        .map(|letter| {
            if letter.is_control() {
                '\u{fffd}'
            } else {
                letter
            }
        })
        .collect()
}

/// Places that could not be read, for JSON.
pub(super) fn damages_object(damages: &[Damage]) -> Value {
    let one = |damage: &Damage| {
        Value::Object(keyed([
            ("offset", Value::from(damage.offset)),
            ("bytes", Value::from(damage.bytes)),
            ("messages", Value::from(damage.messages)),
            ("what", Value::from(damage.what.as_str())),
        ]))
    };
    damages.iter().map(one).collect()
}

/// The same as lines, the first twenty.
pub(super) fn damages_text(damages: &[Damage]) -> String {
    let one = |damage: &Damage| {
        let messages = damage
            .messages
            .map_or_else(String::new, |lost| format!(" and {lost} messages"));
        format!(
            "damaged at byte {}, {} bytes{messages} lost: {}\n",
            damage.offset,
            damage.bytes,
            printable(&damage.what)
        )
    };
    damages.iter().take(20).map(one).collect()
}

/// The format that the ending of an output's name chooses; `None` for a table.
pub(super) fn target(path: &Path) -> Result<Option<Format>> {
    match ending(path).as_deref() {
        Some("mcap") => Ok(Some(Format::Mcap)),
        Some("bag") => Ok(Some(Format::Bag)),
        Some("csv") => Ok(None),
        _ => Err(Error::usage(
            format!("{} does not end in `.mcap`, `.bag` or `.csv`", shown(path)),
            "the ending of the output's name chooses its format",
        )),
    }
}

/// Refuses to write over the file that is read.
pub(super) fn refuse_same(input: &Path, output: &Path) -> Result<()> {
    let whole = |path: &Path| std::fs::canonicalize(path).ok();
    match (whole(input), whole(output)) {
        (Some(a), Some(b)) if a == b => Err(Error::usage(
            format!("{} would be written over itself", shown(input)),
            "give the output another name: the input stays as it is",
        )),
        _ => Ok(()),
    }
}

/// What an operation on a log and its copy could not do.
pub(super) fn copy_error(error: grouser_log::Error, output: &Path) -> Error {
    match error {
        grouser_log::Error::Output(reason) => Error::file("write", output, &reason),
        error @ grouser_log::Error::Differs { .. } => Error::File {
            action: "write",
            path: output.to_owned(),
            reason: error.to_string(),
            hint: Some("the file was not kept; the input is as it was".to_owned()),
        },
        error => super::estimate::log_error(error),
    }
}

/// What was copied, for JSON.
pub(super) fn copied_object(copied: &Copied, output: &Path) -> Object {
    let topic = |(topic, type_name, messages): &(String, String, u64)| {
        Value::Object(keyed([
            ("topic", Value::from(topic.as_str())),
            ("type", Value::from(type_name.as_str())),
            ("messages", Value::from(*messages)),
        ]))
    };
    keyed([
        ("status", Value::from(status(copied))),
        ("from", Value::from(copied.from.name())),
        ("output", Value::from(output.display().to_string())),
        ("messages", Value::from(copied.messages)),
        ("topics", copied.channels.iter().map(topic).collect()),
        ("damage_count", Value::from(copied.damage_count)),
        ("bytes_lost", Value::from(copied.bytes_lost)),
        ("messages_lost", Value::from(copied.messages_lost)),
        ("damages", damages_object(&copied.damages)),
        ("attachments_left_out", Value::from(copied.attached)),
        ("verified", Value::from(true)),
    ])
}

fn status(copied: &Copied) -> &'static str {
    if copied.is_partial() {
        "partial"
    } else {
        "whole"
    }
}

/// What was copied, as text.
pub(super) fn copied_text(copied: &Copied, output: &Path) -> String {
    let mut table = Table::new().text("topic").text("type").number("messages");
    for (topic, type_name, messages) in &copied.channels {
        table.row([printable(topic), printable(type_name), messages.to_string()]);
    }
    let mut text = table.render();
    text.push('\n');
    text.push_str(&damages_text(&copied.damages));
    if copied.attached > 0 {
        let _ = writeln!(
            text,
            "{} attachments and metadata records are left out",
            copied.attached
        );
    }
    let _ = writeln!(
        text,
        "wrote {}: {} messages, read again and found the same; {} places of the input are damaged, {} \
         bytes are lost in them",
        shown(output),
        copied.messages,
        copied.damage_count,
        copied.bytes_lost
    );
    text
}
