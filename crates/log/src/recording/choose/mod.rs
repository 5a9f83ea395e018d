//! Which topics of a bag are used, and what for.

mod motion;
mod names;
mod wheels;
mod yaw_rate;

use grouser_files::columns::Meaning;
use grouser_files::nearest;
use grouser_files::topics::Topics;

use super::frames::{FramePose, Tree};
pub(super) use super::job::Job;
use super::preview::{Preview, TopicPreview};
use crate::error::{Error, Result};
use crate::message::known::{OUTPUT, TRUTH};
use crate::messages::Clock;
pub(super) use names::has_word;
pub(crate) use names::{is_command, is_of_wheels, is_over_ground, is_unmeasured, speed_of_number};

/// One topic that is used.
#[derive(Clone, Debug)]
pub(crate) struct Chosen {
    pub(crate) topic: String,
    pub(crate) type_name: String,
    pub(crate) jobs: Vec<Job>,
    pub(crate) words: Vec<String>,
    pub(crate) measures: Vec<(Meaning, Option<usize>)>,
    pub(crate) align: bool,
    /// How far its stamps are ahead of the recorder's clock, ns, where it has stamps.
    pub(crate) ahead_ns: Option<i64>,
}

/// What was chosen.
#[derive(Clone, Debug)]
pub(crate) struct Choice {
    pub(crate) topics: Vec<Chosen>,
    pub(crate) wheels: Vec<String>,
    pub(crate) clock: Clock,
    /// The standard deviation of a place by the reference, m, where its messages state it.
    pub(crate) position_sigma: Option<f64>,
    /// That which the robot file states, m.
    pub(crate) stated_sigma: Option<f64>,
    /// Position of the satellite receiver's antenna in the robot's frame, m.
    pub(crate) antenna: [f64; 2],
    /// Position of the sensor of the speed by the transforms, likewise.
    pub(crate) speed_place: [f64; 2],
    /// The pose that transforms hold, where it is used.
    pub(crate) frame_pose: Option<FramePose>,
    pub(crate) notes: Vec<String>,
}

/// Stamps of the topics of one run may differ by so much more than the recorder's clock says, s.
const STAMPS_APART: f64 = 10.0;

/// Chooses: what the robot file names, else by type and name.
pub(super) fn choose(preview: &Preview, topics: &Topics) -> Result<Choice> {
    let mut choosing = Choosing {
        preview,
        topics,
        others: Vec::new(),
        tree: Tree::default(),
        file: &preview.names(),
        choice: Choice {
            topics: Vec::new(),
            wheels: topics.joints.iter().map(|j| j.wheel.clone()).collect(),
            clock: Clock::Header,
            position_sigma: None,
            stated_sigma: topics.position_sigma,
            antenna: topics.antenna,
            speed_place: [0.0; 2],
            frame_pose: None,
            notes: Vec::new(),
        },
    };
    choosing.fields()?;
    choosing.wheels()?;
    choosing.suspension();
    choosing.contacts()?;
    choosing.tree = choosing.tree();
    choosing.yaw_rate()?;
    choosing.motion()?;
    choosing.command()?;
    choosing.say_unused();
    choosing.clock();
    Ok(choosing.choice)
}

struct Choosing<'a> {
    preview: &'a Preview,
    topics: &'a Topics,
    /// The namespaces of other robots, with a slash at both ends.
    others: Vec<String>,
    /// The frames by the topics that are not another robot's.
    tree: Tree,
    file: &'a str,
    choice: Choice,
}

impl<'a> Choosing<'a> {
    /// A topic that the robot file names under `key`.
    fn named(&self, key: &'static str, name: &str) -> Result<&'a TopicPreview> {
        let found = self.preview.topic(name).filter(|seen| seen.messages > 0);
        found.ok_or_else(|| {
            let all = self.preview.topics.iter().map(|s| s.channel.topic.as_str());
            Error::NoNamedTopic {
                file: self.file.to_owned(),
                key,
                topic: name.to_owned(),
                meant: nearest(name, all).map(Into::into),
            }
        })
    }

    fn unfit(&self, key: &'static str, seen: &TopicPreview, wanted: &'static str) -> Error {
        Error::UnfitTopic {
            file: self.file.to_owned(),
            key,
            topic: seen.channel.topic.clone(),
            type_name: seen.channel.type_name.clone(),
            wanted,
        }
    }

    /// The topics that may be chosen by type and name.
    fn free(&self) -> Vec<&'a TopicPreview> {
        let all = self.preview.topics.iter().filter(|seen| {
            let name = &seen.channel.topic;
            self.is_own(name) && !self.topics.named().any(|other| other == name)
        });
        all.collect()
    }

    /// The same, and behind them topics that fields name: a field leaves the other contents of its topic free.
    fn free_or_of_fields(&self) -> Vec<&'a TopicPreview> {
        let of_fields = self.preview.topics.iter().filter(|seen| {
            let name = &seen.channel.topic;
            let mut fields = self.topics.fields.iter();
            self.is_own(name)
                && fields.any(|field| field.topic == *name)
                && !self.topics.named_whole().any(|other| other == name)
        });
        self.free().into_iter().chain(of_fields).collect()
    }

    /// Is a topic neither ignored nor another robot's, nor what a simulation or this program says?
    fn is_own(&self, topic: &str) -> bool {
        !self.topics.ignore.iter().any(|other| other == topic)
            && !self.others.iter().any(|other| topic.starts_with(other))
            && !topic.starts_with(TRUTH)
            && !topic.contains(OUTPUT)
    }

    /// The frames by topics that may be used.
    fn tree(&self) -> Tree {
        let name = |topic: usize| &self.preview.topics[topic].channel.topic;
        let transforms = &self.preview.transforms;
        transforms.tree(|topic| self.is_own(name(topic)))
    }

    /// The topic by which the wheels are measured.
    fn wheel_topic(&self) -> Option<&str> {
        let of_wheel = |chosen: &&Chosen| chosen.measures.iter().any(|(_, wheel)| wheel.is_some());
        let chosen = self.choice.topics.iter().find(of_wheel)?;
        Some(&chosen.topic)
    }

    fn take(
        &mut self,
        seen: &TopicPreview,
        job: Job,
        word: &str,
        measures: &[(Meaning, Option<usize>)],
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
                ahead_ns: seen.ahead_ns,
            });
            self.choice.topics.len() - 1
        });
        let chosen = &mut self.choice.topics[index];
        chosen.jobs.push(job);
        chosen.words.push(word.to_owned());
        chosen.measures.extend_from_slice(measures);
        chosen
    }

    fn measures(&self, meaning: Meaning) -> bool {
        let mut all = self.choice.topics.iter().flat_map(|c| &c.measures);
        all.any(|(own, _)| *own == meaning)
    }

    /// A speed over ground, with its sign or without.
    fn measures_speed(&self) -> bool {
        self.measures(Meaning::SpeedForward) || self.measures(Meaning::SpeedSize)
    }

    fn measures_wheels(&self) -> bool {
        let mut all = self.choice.topics.iter().flat_map(|c| &c.measures);
        let turns = |meaning: Meaning| {
            meaning.is_of_a_wheel()
                && !matches!(
                    meaning,
                    Meaning::WheelTorque
                        | Meaning::MotorCurrent
                        | Meaning::Sinkage
                        | Meaning::EntryAngle
                        | Meaning::WheelSteering
                )
        };
        all.any(|(meaning, _)| turns(*meaning))
    }

    /// Stamps count, unless they cannot be of one clock.
    fn clock(&mut self) {
        if self.topics.recorder_clock {
            self.choice.clock = Clock::Recorder;
            return;
        }
        // transforms that never change may be older than the recording, and measure nothing
        let used = self.choice.topics.iter().filter(|c| !c.measures.is_empty());
        let ahead = used.map(|c| c.ahead_ns.unwrap_or(0) as f64 * 1e-9);
        let (least, most) = ahead.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), s| {
            (s.min(least), s.max(most))
        });
        if most - least > STAMPS_APART {
            self.choice.clock = Clock::Recorder;
            self.choice.notes.push(format!(
                "the stamps of the topics differ by {:.0} s: times of recording are used",
                most - least
            ));
        }
    }
}
