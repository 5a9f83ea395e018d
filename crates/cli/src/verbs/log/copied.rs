//! A log and its copy: the paths that are refused, the damage, and what was copied.

use std::fmt::Write as _; // writing to a string cannot fail
use std::path::Path;

use grouser_log::container::{Damage, Format};
use grouser_log::write::Copied;
use grouser_report::{Fields, printable};

use crate::error::{Error, Result, shown};
use crate::figure_file::ending;

/// Places that are listed for people.
const MAX_DAMAGES_SHOWN: usize = 20;

/// A place that could not be read.
pub(super) fn damage<'a>() -> Fields<'a, &'a Damage> {
    Fields::new()
        .field("offset", "byte at which it begins", |damage: &Damage| {
            damage.offset
        })
        .field("bytes", "bytes that are lost", |damage| damage.bytes)
        .field("messages", "messages that are lost", |damage| {
            damage.messages
        })
        .field("what", "what is wrong", |damage: &'a Damage| {
            damage.what.as_str()
        })
}

/// The damage as lines.
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
    damages.iter().take(MAX_DAMAGES_SHOWN).map(one).collect()
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
        error @ grouser_log::Error::Differs { .. } => {
            let hint = "the file was not kept; the input is as it was";
            Error::refused_file("write", output, &error.to_string(), Some(hint.to_owned()))
        }
        error => error.into(),
    }
}

/// A copy and its place; `None` for one that was not kept.
#[derive(Clone, Copy)]
pub(super) struct Copy<'a> {
    pub(super) copied: &'a Copied,
    pub(super) output: Option<&'a Path>,
}

fn topics<'a>() -> Fields<'a, &'a (String, String, u64)> {
    Fields::new()
        .field(
            "topic",
            "topic",
            |(topic, ..): &'a (String, String, u64)| topic.as_str(),
        )
        .shown("")
        .field("type", "type", |(_, type_name, _)| type_name.as_str())
        .shown("")
        .field("messages", "messages", |(.., messages)| *messages)
        .shown("")
}

pub(super) fn fields<'a>() -> Fields<'a, Copy<'a>> {
    let status = |copied: &Copied| {
        if copied.is_partial() {
            "partial"
        } else {
            "whole"
        }
    };
    Fields::new()
        .field(
            "status",
            "`whole`, or `partial` where data were lost",
            move |c: Copy<'a>| status(c.copied),
        )
        .field("from", "format of the input", |c| c.copied.from.name())
        .field("output", "the file that was written", |c| {
            c.output.map(|path| path.display().to_string())
        })
        .field("messages", "messages that were copied", |c| {
            c.copied.messages
        })
        .rows("topics", "topics that were copied", topics(), |c| {
            &c.copied.channels
        })
        .field("damage_count", "damaged places of the input", |c| {
            c.copied.damage_count
        })
        .field("bytes_lost", "bytes that are lost", |c| c.copied.bytes_lost)
        .field("messages_lost", "messages that are lost", |c| {
            c.copied.messages_lost
        })
        .rows("damages", "the damaged places", damage(), |c| {
            &c.copied.damages
        })
        .field(
            "attachments_left_out",
            "attachments and metadata records that are left out",
            |c| c.copied.attached,
        )
        .field(
            "verified",
            "whether the copy was read again and found the same",
            |c| c.output.is_some(),
        )
}

/// What was copied, as text.
pub(super) fn text(copied: &Copied, output: &Path) -> String {
    let mut text = topics().table(&copied.channels);
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
