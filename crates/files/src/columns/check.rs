//! Which meanings of one table go together.

use super::{Column, Frame, Meaning};
use crate::error::{Error, Place, Result};
use crate::section::Section;

/// Is there any column, and do all go together?
pub(super) fn check_columns(section: &Section<'_>, columns: &[Column]) -> Result<()> {
    if columns.is_empty() {
        return Err(Error::MissingKey {
            at: section.place(),
            section: "[[table]]".into(),
            key: "columns",
        });
    }
    check_together(&section.place_of("columns"), columns)
}

/// Is every meaning there once, with those that it needs beside it?
pub(crate) fn check_together(at: &Place, columns: &[Column]) -> Result<()> {
    for (index, column) in columns.iter().enumerate() {
        let twice = columns[..index].iter().find(|other| {
            column.meaning.is_same_reading(other.meaning)
                && (&other.wheel, &other.joint) == (&column.wheel, &column.joint)
        });
        if let Some(other) = twice {
            let (name, other) = (column.meaning.name(), other.meaning.name());
            return Err(Error::Contradiction {
                at: at.clone(),
                message: if name == other {
                    format!("`{name}` is given by two columns")
                } else {
                    format!(
                        "`{other}` and `{name}` of one wheel are the same reading: leave one of them out"
                    )
                },
            });
        }
        let is_there = |meaning| columns.iter().any(|other| other.meaning == meaning);
        let twice = [
            (
                Meaning::Latitude,
                Meaning::PoseX,
                "`pose_x` and `latitude` are places of one robot: leave one of them out",
            ),
            (
                Meaning::OrientationZ,
                Meaning::PoseYaw,
                "`pose_yaw` and `orientation_z` are headings of one robot: leave one of them out",
            ),
        ];
        let twice =
            (twice.into_iter()).find(|(own, other, _)| column.meaning == *own && is_there(*other));
        if let Some((.., message)) = twice {
            return Err(Error::Contradiction {
                at: at.clone(),
                message: message.into(),
            });
        }
        if column.frame == Frame::Previous && !is_there(Meaning::DisplacementTurn) {
            return Err(Error::Contradiction {
                at: at.clone(),
                message: "`frame = \"previous\"` needs `displacement_turn` too".into(),
            });
        }
        let mut needs = column.meaning.needs().iter();
        if let Some(needed) = needs.find(|needed| !is_there(**needed)) {
            return Err(Error::Contradiction {
                at: at.clone(),
                message: format!("`{}` needs `{}` too", column.meaning.name(), needed.name()),
            });
        }
    }
    Ok(())
}
