//! What clap has to say, in the words of the other errors.

use std::ffi::OsString;

use clap::CommandFactory as _;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use serde_json::Value;

use crate::command::Command;
use crate::error::{Details, Error};
use crate::terminal;
use crate::verbs::FORMER;

/// Help and version to standard output with exit 0; everything else as an error with exit 2.
pub(crate) fn answer(error: &clap::Error, arguments: &[OsString]) -> u8 {
    let json = arguments.iter().any(|argument| argument == "--json");
    let nothing = arguments.len() <= 1;
    match error.kind() {
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand if !nothing => {
            terminal::complain(&usage(error, arguments), json)
        }
        ErrorKind::DisplayHelp
        | ErrorKind::DisplayVersion
        | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            match terminal::print_help(&error.render().to_string()) {
                Ok(()) => 0,
                Err(error) => terminal::complain(&error, json),
            }
        }
        _ => terminal::complain(&usage(error, arguments), json),
    }
}

fn usage(error: &clap::Error, arguments: &[OsString]) -> Error {
    let name = one(error, ContextKind::InvalidSubcommand).unwrap_or_default();
    let former = FORMER
        .iter()
        .find(|(former, _)| name == format!("`{former}`"));
    if let Some((_, verb)) = former {
        return Error::usage_without_hint(format!("{name} is now `grouser {verb}`"));
    }
    let field = one(error, ContextKind::InvalidArg).map(|name| name.trim_matches('`').to_owned());
    let field = field.filter(|name| name.starts_with("--") && !name.contains('`'));
    let value = one(error, ContextKind::InvalidValue).filter(|value| !value.is_empty());
    let number = value.as_deref().and_then(|text| text.parse::<f64>().ok());
    Error::usage(message(error), hint(error, arguments)).with(Details {
        field,
        value: number.map_or_else(|| value.into(), Value::from),
        limit: limits(error).map_or(Value::Null, |limits| limits.to_vec().into()),
        ..Details::default()
    })
}

/// The minimum and the maximum of a flag that takes whole numbers in a range.
fn limits(error: &clap::Error) -> Option<[i64; 2]> {
    let reason = std::error::Error::source(error)?.to_string();
    let (_, range) = reason.split_once(" is not in ")?;
    let (low, high) = range.split_once("..=")?;
    Some([low.parse().ok()?, high.parse().ok()?])
}

fn message(error: &clap::Error) -> String {
    let argument = one(error, ContextKind::InvalidArg);
    let value = one(error, ContextKind::InvalidValue).filter(|value| !value.is_empty());
    let subcommand = one(error, ContextKind::InvalidSubcommand);
    match (error.kind(), argument, value) {
        (ErrorKind::InvalidValue, Some(argument), None) => format!("{argument} needs a value"),
        (ErrorKind::InvalidValue, Some(argument), Some(value)) => {
            let valid = one(error, ContextKind::ValidValue).unwrap_or_default();
            format!("{argument} is `{value}`, but must be one of {valid}")
        }
        (ErrorKind::ValueValidation, Some(argument), Some(value)) => {
            let reason = std::error::Error::source(error).map(ToString::to_string);
            if let Some([low, high]) = limits(error) {
                return format!("{argument} is {value}, but must lie in [{low}, {high}]");
            }
            let reason = match reason.as_deref() {
                None => "is not valid there",
                Some("invalid digit found in string") => "must be a whole number",
                Some("number too large to fit in target type") => "is too large",
                Some(reason) => reason,
            };
            format!("{argument} is `{value}`, but {reason}")
        }
        (ErrorKind::UnknownArgument, Some(argument), _) => {
            format!("unexpected argument {argument}")
        }
        (ErrorKind::ArgumentConflict, Some(argument), _) => {
            match one(error, ContextKind::PriorArg) {
                Some(prior) if prior == argument => format!("{argument} is given more than once"),
                Some(prior) => format!("{argument} cannot be used with {prior}"),
                None => format!("{argument} cannot be used with the other arguments"),
            }
        }
        (ErrorKind::MissingRequiredArgument, Some(argument), _) => format!("missing {argument}"),
        (ErrorKind::InvalidSubcommand, ..) => {
            format!("unknown verb {}", subcommand.unwrap_or_default())
        }
        (
            ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand | ErrorKind::MissingSubcommand,
            ..,
        ) => "no verb given".to_owned(),
        (ErrorKind::InvalidUtf8, ..) => "an argument is not valid UTF-8".to_owned(),
        _ => first_paragraph(error),
    }
}

fn hint(error: &clap::Error, arguments: &[OsString]) -> String {
    let command = Command::command();
    let verb = arguments
        .iter()
        .skip(1)
        .find_map(|argument| command.find_subcommand(argument));
    let close = [
        ContextKind::SuggestedArg,
        ContextKind::SuggestedSubcommand,
        ContextKind::SuggestedValue,
    ]
    .into_iter()
    .find_map(|kind| one(error, kind));
    if let Some(close) = close {
        let unknown = one(error, ContextKind::InvalidArg).unwrap_or_default();
        let unit = unknown.trim_matches('`').rsplit('-').next();
        let mut masses = verb.iter().flat_map(|verb| verb.get_arguments());
        return match unit {
            Some("kg" | "g" | "lb") if close.ends_with("-n`") => {
                if masses.any(|argument| argument.get_long() == Some("mass-kg")) {
                    "loads are in newtons; give a mass by `--mass-kg`".to_owned()
                } else {
                    format!("{close} is in newtons (9.81 per kg on Earth)")
                }
            }
            Some("mm" | "cm" | "in" | "ft") if close.ends_with("-m`") => {
                format!("lengths are in metres: did you mean {close}?")
            }
            _ => format!("did you mean {close}?"),
        };
    }
    match verb {
        Some(verb) => format!("see `grouser {} --help`", verb.get_name()),
        None => "see `grouser --help`".to_owned(),
    }
}

/// A piece of clap's context with each name in backticks.
fn one(error: &clap::Error, kind: ContextKind) -> Option<String> {
    let quoted = |name: &String| match flags(name) {
        flags if flags.is_empty() => format!("`{name}`"),
        flags => flags
            .iter()
            .map(|flag| format!("`{flag}`"))
            .collect::<Vec<_>>()
            .join(" or "),
    };
    match error.get(kind)? {
        ContextValue::String(text) if kind == ContextKind::InvalidValue => Some(text.clone()),
        ContextValue::String(name) => Some(quoted(name)),
        ContextValue::Strings(names) if !names.is_empty() => {
            Some(names.iter().map(quoted).collect::<Vec<_>>().join(", "))
        }
        _ => None,
    }
}

/// The flags in clap's way of writing an argument (`--slip <S>`) or a choice of them
/// (`<--load-n <N>|--sinkage-m <M>>`).
fn flags(written: &str) -> Vec<&str> {
    let parts = written.split(['|', ' ', '<', '>']);
    parts.filter(|part| part.starts_with("--")).collect()
}

fn first_paragraph(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let text = text.split("\n\n").next().unwrap_or_default();
    text.trim_start_matches("error: ").trim().to_owned()
}
