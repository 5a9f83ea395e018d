//! The libraries' errors as errors of the command.

use std::path::Path;

use grouser_files::{Error as FileError, Place};
use grouser_terra::OutOfRange;

use crate::error::{Details, Error, Kind};
use crate::law_error::Names;

impl From<FileError> for Error {
    fn from(error: FileError) -> Self {
        let hint = error.hint();
        let message = error.to_string();
        let content = |at: &Place, details: Details| {
            Self::new(Kind::Content, message.clone(), hint.clone()).with(Details {
                file: Some(at.file.clone()),
                line: Some(at.line as u64),
                ..details
            })
        };
        match &error {
            FileError::Unreadable { file, source } => Self::file("read", Path::new(file), source),
            FileError::NotAFile { file, what } => {
                let hint = "`-` reads standard input where a verb takes it";
                let hint = (*what == "a pipe").then(|| hint.to_owned());
                Self::refused_file("read", Path::new(file), &format!("it is {what}"), hint)
            }
            FileError::OutOfRange { at, range } => content(
                at,
                Details {
                    field: Some(range.field.clone()),
                    value: range.value.into(),
                    limit: vec![range.low, range.high].into(),
                    unit: Some(grouser_files::unit_of_key(&range.field))
                        .filter(|unit| !unit.is_empty())
                        .map(str::to_owned),
                    ..Details::default()
                },
            ),
            FileError::MissingKey { at, key, .. } | FileError::RemovedKey { at, key, .. } => {
                content(at, field(key))
            }
            FileError::UnknownKey { at, key, .. } | FileError::WrongType { at, key, .. } => {
                content(at, field(key))
            }
            FileError::BadChoice { at, key, value, .. } => content(
                at,
                Details {
                    value: value.as_str().into(),
                    ..field(key)
                },
            ),
            FileError::NotText { at }
            | FileError::Syntax { at, .. }
            | FileError::TooDeep { at, .. }
            | FileError::Format { at, .. }
            | FileError::Soil { at, .. }
            | FileError::Robot { at, .. }
            | FileError::Contradiction { at, .. } => content(at, Details::default()),
            _ => Self::new(Kind::Content, message, hint),
        }
    }
}

fn field(name: &str) -> Details {
    Details {
        field: Some(name.to_owned()),
        ..Details::default()
    }
}

impl From<grouser_log::Error> for Error {
    fn from(error: grouser_log::Error) -> Self {
        match error {
            grouser_log::Error::File(error) => error.into(),
            error => Self::new(Kind::Content, error.to_string(), error.hint()),
        }
    }
}

impl From<grouser_replay::Error> for Error {
    fn from(error: grouser_replay::Error) -> Self {
        match error {
            grouser_replay::Error::File(error) => error.into(),
            grouser_replay::Error::Log(error) => error.into(),
            grouser_replay::Error::Soil(error) => Names::Columns.error(&error),
            error => Self::new(Kind::Content, error.to_string(), error.hint()),
        }
    }
}

impl From<grouser_rover::Error> for Error {
    fn from(error: grouser_rover::Error) -> Self {
        use grouser_rover::Error as Rover;
        let hint = error.hint();
        match error {
            Rover::File(error) => error.into(),
            Rover::OutOfRange { of, range } => out_of_range(&of, range),
            Rover::Law { of, source } => Names::Columns.error(&source).of(&of),
            Rover::Terrain { ref file, .. } => {
                let file = file.display().to_string();
                Self::new(Kind::Content, error.to_string(), hint).with(Details {
                    file: Some(file),
                    ..Details::default()
                })
            }
            Rover::Unreadable { file, source } => Self::file("read", &file, &source),
            error => Self::new(Kind::Content, error.to_string(), hint),
        }
    }
}

/// A number of `of` outside its limits.
fn out_of_range(of: &str, range: OutOfRange) -> Error {
    Error::new(Kind::Content, format!("{of}: {range}"), None).with(Details {
        value: range.value.into(),
        limit: vec![range.low, range.high].into(),
        unit: Some(range.unit.to_owned()).filter(|unit| !matches!(unit.as_str(), "" | "1")),
        ..field(range.field)
    })
}

impl From<grouser_terrain::Error> for Error {
    fn from(error: grouser_terrain::Error) -> Self {
        use grouser_terrain::Error as Terrain;
        let hint = error.hint();
        match error {
            Terrain::OwnFile(error) => error.into(),
            Terrain::Rover(error) => error.into(),
            Terrain::File {
                action,
                file,
                source,
            } => Self::file(action, &file, &source),
            Terrain::OutOfRange { of, range } => out_of_range(&of, range),
            Terrain::Law { of, source } => Names::Columns.error(&source).of(&of),
            Terrain::Terrain { ref file, .. } => {
                let file = file.display().to_string();
                Self::new(Kind::Content, error.to_string(), hint).with(Details {
                    file: Some(file),
                    ..Details::default()
                })
            }
            Terrain::DoesNotStand { load, .. } => Self::new(Kind::Content, error.to_string(), hint)
                .with(Details {
                    value: load.into(),
                    limit: 0.0.into(),
                    unit: Some("N".to_owned()),
                    ..field("load")
                }),
            Terrain::OtherMap {
                field: ref name,
                ref value,
                ref limit,
                ..
            } => Self::new(Kind::Content, error.to_string(), hint).with(Details {
                value: value.as_str().into(),
                limit: limit.as_str().into(),
                ..field(name)
            }),
            error => Self::new(Kind::Content, error.to_string(), hint),
        }
    }
}

impl From<grouser_design::Error> for Error {
    fn from(error: grouser_design::Error) -> Self {
        match error {
            grouser_design::Error::File(error) => error.into(),
            grouser_design::Error::OutOfRange(range) => {
                Self::new(Kind::Value, format!("{range:#}"), None).with(Details {
                    field: Some(range.field),
                    value: range.value.into(),
                    limit: vec![range.low, range.high].into(),
                    unit: (range.unit != "1").then(|| range.unit.to_owned()),
                    ..Details::default()
                })
            }
            error => Self::new(Kind::Content, error.to_string(), error.hint()),
        }
    }
}

impl From<grouser_identify::Error> for Error {
    fn from(error: grouser_identify::Error) -> Self {
        use grouser_identify::Error as Identify;
        match error {
            Identify::File(error) => error.into(),
            Identify::Log(error) => error.into(),
            Identify::Content { path, message } => Self::content(&path, message, None),
            error => Self::new(Kind::Content, error.to_string(), None),
        }
    }
}

impl From<grouser_campaign::Error> for Error {
    fn from(error: grouser_campaign::Error) -> Self {
        use grouser_campaign::Error as Campaign;
        match error {
            Campaign::File(error) => error.into(),
            Campaign::Design(error) => error.into(),
            Campaign::Rover(error) => error.into(),
            error => Self::new(Kind::Content, error.to_string(), None),
        }
    }
}
