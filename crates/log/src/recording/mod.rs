//! Bags and MCAP files as a part of a log: their topics as samples.

mod choose;
mod frames;
mod intake;
mod job;
mod mounting;
pub(crate) mod navigation;
mod preview;
mod reader;

use std::sync::{Arc, Mutex, PoisonError};

use grouser_files::columns::Meaning;
use grouser_files::topics::Topics;
use grouser_slip::Reference;

use crate::error::Result;
use crate::messages::LeftOut;
use crate::source::Source;
use choose::Choice;
pub(crate) use choose::{is_command, is_of_wheels, is_over_ground, is_unmeasured, speed_of_number};
pub(crate) use frames::{FirstTransforms, is_static, poses};
pub use intake::Intake;
pub use preview::Preview;
pub(crate) use reader::RecordingReader;

/// A topic that a log uses, and what for.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct UsedTopic {
    /// The topic.
    pub topic: String,
    /// The full name of its type, as the file writes it.
    pub type_name: String,
    /// What it is used for, in words.
    pub used_for: String,
    /// The references that it measures; an estimate uses one.
    pub references: Vec<Reference>,
}

impl Choice {
    pub(crate) fn measures(&self, meaning: Meaning) -> bool {
        let mut all = self.topics.iter().flat_map(|chosen| &chosen.measures);
        all.any(|(own, _)| *own == meaning)
    }

    pub(crate) fn measures_wheel(&self, meaning: Meaning, wheel: &str) -> bool {
        let mut all = self.topics.iter().flat_map(|chosen| &chosen.measures);
        let index = self.wheels.iter().position(|own| own == wheel);
        index.is_some() && all.any(|(own, of)| *own == meaning && *of == index)
    }

    pub(crate) fn used(&self) -> impl Iterator<Item = UsedTopic> {
        self.topics.iter().map(|chosen| UsedTopic {
            topic: chosen.topic.clone(),
            type_name: chosen.type_name.clone(),
            used_for: chosen.words.join(", "),
            references: (chosen.measures.iter())
                .filter_map(|(meaning, _)| meaning.reference())
                .collect(),
        })
    }
}

/// The bags and MCAP files of one run, with the meaning of their topics.
#[derive(Clone, Debug)]
pub(crate) struct Recording {
    pub(crate) files: Vec<Source>,
    pub(crate) choice: Arc<Choice>,
    left_out: Arc<Mutex<LeftOut>>,
}

impl Recording {
    /// Looks into the files and chooses their topics; of files that are still written, once they have what it needs.
    pub(crate) fn open(files: Vec<Source>, topics: &Topics) -> Result<Self> {
        let preview = loop {
            let mut preview = Preview::new(topics);
            let growing = files.iter().find(|file| file.is_growing());
            let known = growing.map_or(0, Source::bytes);
            for file in &files {
                preview.read_source(&file.as_it_is())?;
            }
            match growing {
                Some(file) if !preview.has_looked() => file.grown(known)?,
                _ => break preview,
            };
        };
        Ok(Self {
            files,
            choice: Arc::new(preview.choose()?),
            left_out: Arc::default(),
        })
    }

    /// The same files, of which only the topics that measure a wheel are decoded.
    pub(crate) fn of_wheels(&self) -> Self {
        let mut choice = Choice::clone(&self.choice);
        choice
            .topics
            .retain(|topic| topic.measures.iter().any(|(_, wheel)| wheel.is_some()));
        Self {
            files: self.files.clone(),
            choice: Arc::new(choice),
            left_out: Arc::default(),
        }
    }

    pub(crate) fn begin(&self) {
        *self.lock() = LeftOut::default();
    }

    pub(crate) fn left_out(&self) -> LeftOut {
        self.lock().clone()
    }

    fn add(&self, left_out: &LeftOut) {
        self.lock().add(left_out);
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, LeftOut> {
        // Whoever panicked left a number behind, nothing half-written.
        self.left_out.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
