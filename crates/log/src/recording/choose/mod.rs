//! Which topics of a bag are used, and what for.

mod motion;
mod names;
mod wheels;
mod yaw_rate;

use grouser_files::columns::Meaning;
use grouser_files::nearest;
use grouser_files::topics::Topics;

use super::peek::{Peek, Seen};
use crate::error::{Error, Result};
use crate::message::known::TRUTH;
use crate::messages::Clock;
use crate::slots::Slots;

/// What a topic is used for.
#[derive(Clone, Debug)]
pub(super) enum Job {
    /// Angles, rates or counts of wheels: each joint's name and its wheel.
    Joints(Vec<(String, usize)>),
    /// The yaw rate about this direction.
    YawRate([f64; 3]),
    /// The acceleration along these directions, forwards and to the left.
    Acceleration([[f64; 3]; 2]),
    /// A pose.
    Pose,
    /// A speed over ground.
    Speed,
    /// A way since the last message.
    Displacement,
    /// A commanded speed.
    Command,
    /// Wheels by an odometry that was made of them.
    WheelOdometry(Vec<(usize, f64, f64)>),
    /// Numbers by their paths.
    Fields(Slots, Vec<String>),
}

/// One topic that is used.
#[derive(Clone, Debug)]
pub(super) struct Chosen {
    pub(super) topic: String,
    pub(super) type_name: String,
    pub(super) jobs: Vec<Job>,
    pub(super) words: Vec<String>,
    pub(super) measures: Vec<(Meaning, Option<usize>)>,
    pub(super) align: bool,
}

/// What was chosen.
#[derive(Debug)]
pub(super) struct Choice {
    pub(super) topics: Vec<Chosen>,
    pub(super) wheels: Vec<String>,
    pub(super) clock: Clock,
    pub(super) notes: Vec<String>,
}

/// Stamps of the topics of one run may differ by so much more than the recorder's clock says, s.
const STAMPS_APART: f64 = 10.0;

/// Chooses: what the robot file names, else by type and name.
pub(super) fn choose(peek: &Peek, topics: &Topics, file: &str) -> Result<Choice> {
    let mut choosing = Choosing {
        peek,
        topics,
        file,
        choice: Choice {
            topics: Vec::new(),
            wheels: topics.joints.iter().map(|j| j.wheel.clone()).collect(),
            clock: Clock::Header,
            notes: Vec::new(),
        },
    };
    choosing.fields()?;
    choosing.wheels()?;
    choosing.yaw_rate()?;
    choosing.motion()?;
    choosing.command()?;
    choosing.say_unused();
    choosing.clock();
    Ok(choosing.choice)
}

struct Choosing<'a> {
    peek: &'a Peek,
    topics: &'a Topics,
    file: &'a str,
    choice: Choice,
}

impl<'a> Choosing<'a> {
    /// A topic that the robot file names under `key`.
    fn named(&self, key: &'static str, name: &str) -> Result<&'a Seen> {
        let found = self.peek.topic(name).filter(|seen| seen.messages > 0);
        found.ok_or_else(|| {
            let all = self.peek.topics.iter().map(|s| s.channel.topic.as_str());
            Error::NoNamedTopic {
                file: self.file.to_owned(),
                key,
                topic: name.to_owned(),
                meant: nearest(name, all).map(Into::into),
            }
        })
    }

    fn unfit(&self, key: &'static str, seen: &Seen, wanted: &'static str) -> Error {
        Error::UnfitTopic {
            file: self.file.to_owned(),
            key,
            topic: seen.channel.topic.clone(),
            type_name: seen.channel.type_name.clone(),
            wanted,
        }
    }

    /// The topics that may be chosen by type and name.
    fn free(&self) -> impl Iterator<Item = &'a Seen> {
        let topics = self.topics;
        self.peek.topics.iter().filter(move |seen| {
            let name = &seen.channel.topic;
            seen.view.is_some()
                && !topics.ignore.contains(name)
                && !name.starts_with(TRUTH)
                && !topics.named().any(|other| other == name)
        })
    }

    fn take(
        &mut self,
        seen: &Seen,
        job: Job,
        word: impl Into<String>,
        measures: impl IntoIterator<Item = (Meaning, Option<usize>)>,
    ) -> &mut Chosen {
        let name = &seen.channel.topic;
        let known = self.choice.topics.iter().position(|c| c.topic == *name);
        let index = known.unwrap_or_else(|| {
            self.choice.topics.push(Chosen {
                topic: name.clone(),
                type_name: seen.channel.type_name.clone(),
                jobs: Vec::new(),
                words: Vec::new(),
                measures: Vec::new(),
                align: false,
            });
            self.choice.topics.len() - 1
        });
        let chosen = &mut self.choice.topics[index];
        chosen.jobs.push(job);
        chosen.words.push(word.into());
        chosen.measures.extend(measures);
        chosen
    }

    fn measures(&self, meaning: Meaning) -> bool {
        let mut all = self.choice.topics.iter().flat_map(|c| &c.measures);
        all.any(|(own, _)| *own == meaning)
    }

    fn measures_wheels(&self) -> bool {
        let mut all = self.choice.topics.iter().flat_map(|c| &c.measures);
        all.any(|(meaning, _)| meaning.is_of_a_wheel() && *meaning != Meaning::WheelTorque)
    }

    /// Stamps count, unless they cannot be of one clock.
    fn clock(&mut self) {
        if self.topics.recorder_clock {
            self.choice.clock = Clock::Recorder;
            return;
        }
        let used = self.choice.topics.iter();
        let ahead =
            used.filter_map(|c| Some(self.peek.topic(&c.topic)?.stamp_ahead.unwrap_or(0.0)));
        let (least, most) = ahead.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), s| {
            (s.min(least), s.max(most))
        });
        if most - least > STAMPS_APART {
            self.choice.clock = Clock::Recorder;
            self.choice.notes.push(format!(
                "the stamps of the topics are {:.0} s apart: times of recording are used",
                most - least
            ));
        }
    }
}
