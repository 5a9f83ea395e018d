//! A log and its copy: the paths that are refused, the damage, and what was copied.

use std::fmt::Write as _; // writing to a string cannot fail
use std::path::Path;

use grouser_log::container::{Damage, Format};
use grouser_log::write::Copied;
use grouser_report::{Fields, fields, printable};

use crate::error::{Error, Result, shown};
use crate::figure_file::ending;

/// Maximum number of damaged places that are listed.
const MAX_DAMAGES_SHOWN: usize = 20;

/// A place that could not be read.
pub(super) fn damage<'a>() -> Fields<'a, &'a Damage> {
    fields! { |damage: &'a Damage|
        "offset" "byte at which it begins" = damage.offset;
        "bytes" "bytes that are lost" = damage.bytes;
        "messages" "messages that are lost" = damage.messages;
        "what" "what is wrong" = damage.what.as_str();
    }
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
    fields! { |topic: &'a (String, String, u64)|
        "topic" "topic" .shown("") = topic.0.as_str();
        "type" "type" .shown("") = topic.1.as_str();
        "messages" "messages" .shown("") = topic.2;
    }
}

pub(super) fn fields<'a>() -> Fields<'a, Copy<'a>> {
    let status = |copied: &Copied| {
        if copied.is_partial() {
            "partial"
        } else {
            "whole"
        }
    };
    fields! { |copy: Copy<'a>|
        "status" "`whole`, or `partial` where data were lost" = status(copy.copied);
        "from" "format of the input" = copy.copied.from.name();
        "output" "the file that was written" = copy.output.map(|path| path.display().to_string());
        "messages" "messages that were copied" = copy.copied.messages;
        "topics" "topics that were copied" rows(topics()) = &copy.copied.channels;
        "damage_count" "damaged places of the input" = copy.copied.damage_count;
        "bytes_lost" "bytes that are lost" = copy.copied.bytes_lost;
        "messages_lost" "messages that are lost" = copy.copied.messages_lost;
        "damages" "the damaged places" rows(damage()) = &copy.copied.damages;
        "attachments_left_out" "attachments and metadata records that are left out" = copy.copied.attached;
        "verified" "whether the copy was read again and found the same" = copy.output.is_some();
    }
}

/// What was copied, as text.
pub(super) fn text(copied: &Copied, output: &Path) -> String {
    let mut text = format!(
        "wrote {}: {} messages, verified by reading them again\n{} damaged places in the input, {} bytes lost\n",
        shown(output),
        copied.messages,
        copied.damage_count,
        copied.bytes_lost
    );
    if copied.attached > 0 {
        let _ = writeln!(
            text,
            "{} attachments and metadata records are left out",
            copied.attached
        );
    }
    let _ = write!(text, "\n{}", topics().table(&copied.channels));
    text + &damages_text(&copied.damages)
}
