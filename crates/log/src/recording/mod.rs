//! Bags and MCAP files as a part of a log: their topics as typed readings.

mod choose;
mod mounting;
mod peek;
mod reader;

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use grouser_files::columns::Meaning;
use grouser_files::topics::Topics;

use crate::error::Result;
use crate::messages::{Clock, LeftOut};
use choose::{Chosen, choose};
use peek::Peek;
pub(crate) use reader::RecordingReader;

/// A topic that a log uses, and what for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UsedTopic {
    /// The topic.
    pub topic: String,
    /// The full name of its type, as the file writes it.
    pub type_name: String,
    /// What it is used for, in words.
    pub used_for: String,
}

/// The bags and MCAP files of one run, with what their topics mean.
#[derive(Clone, Debug)]
pub(crate) struct Recording {
    pub(crate) files: Vec<PathBuf>,
    pub(crate) wheels: Vec<String>,
    pub(crate) notes: Vec<String>,
    topics: Arc<[Chosen]>,
    clock: Clock,
    left_out: Arc<Mutex<LeftOut>>,
}

impl Recording {
    /// Looks into the files and chooses their topics.
    pub(crate) fn open(files: Vec<PathBuf>, topics: &Topics) -> Result<Self> {
        let peek = Peek::read(&files, topics)?;
        let names: Vec<String> = files
            .iter()
            .map(|file| file.display().to_string())
            .collect();
        let choice = choose(&peek, topics, &names.join(", "))?;
        Ok(Self {
            files,
            wheels: choice.wheels,
            notes: choice.notes,
            topics: choice.topics.into(),
            clock: choice.clock,
            left_out: Arc::default(),
        })
    }

    /// How many topics are used: each is a source of its own.
    pub(crate) fn sources(&self) -> usize {
        self.topics.len()
    }

    pub(crate) fn measures(&self, meaning: Meaning) -> bool {
        let mut all = self.topics.iter().flat_map(|chosen| &chosen.measures);
        all.any(|(own, _)| *own == meaning)
    }

    pub(crate) fn measures_wheel(&self, meaning: Meaning, wheel: &str) -> bool {
        let mut all = self.topics.iter().flat_map(|chosen| &chosen.measures);
        let index = self.wheels.iter().position(|own| own == wheel);
        index.is_some() && all.any(|(own, of)| *own == meaning && *of == index)
    }

    /// Which topics' clocks are to be aligned with the others'.
    pub(crate) fn unaligned(&self) -> impl Iterator<Item = usize> {
        let topics = self.topics.iter().enumerate();
        topics
            .filter(|(_, chosen)| chosen.align)
            .map(|(index, _)| index)
    }

    pub(crate) fn used(&self) -> impl Iterator<Item = UsedTopic> {
        self.topics.iter().map(|chosen| UsedTopic {
            topic: chosen.topic.clone(),
            type_name: chosen.type_name.clone(),
            used_for: chosen.words.join(", "),
        })
    }

    pub(crate) fn begin(&self) {
        *self.lock() = LeftOut::default();
    }

    pub(crate) fn left_out(&self) -> LeftOut {
        self.lock().clone()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, LeftOut> {
        // Whoever panicked left a number behind, nothing half-written.
        self.left_out.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
