//! What a log holds: topics, rates, gaps, jumps, damage, and what Grouser can use.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use grouser_real::Real;

use crate::container::{Channel, Container, Damage, Event, Format};
use crate::error::Result;
use crate::message::known::TRUTH;
use crate::message::{Decoders, Elements, SharedDecoder, Spare, Value, View, decode};
use crate::messages::stamp_of;
use crate::recording::{
    FirstTransforms, is_command, is_over_ground, is_static, is_unmeasured, poses,
};
use crate::source::Source;

/// Intervals are counted in bins, this many to a doubling.
const BINS_PER_DOUBLING: f64 = 8.0;
const BINS: usize = 512;
/// An interval of more than about five times the median is a gap, which is this many bins above it: 8 log2 5.
const GAP_BINS: usize = 19;
/// A clock that goes back by more than this jumps, ns: less is the order in which topics were recorded.
const JUMP_NS: u64 = 100_000_000;
/// This many damages are kept; more are only counted.
const DAMAGES: usize = 1000;
/// This many joints of a topic are named, and names of more bytes are left out.
const JOINTS: usize = 64;
const JOINT_NAME: usize = 256;

/// What Grouser can use a topic for.
///
/// ```
/// assert_eq!(grouser_log::Use::YawRate.words(), "yaw rate");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Use {
    /// Angles and rates of wheels.
    Wheels,
    /// Sinkages and entry angles of wheels.
    Contacts,
    /// The yaw rate.
    YawRate,
    /// A pose and a speed, of the wheels or of something better: the log does not say which.
    Motion,
    /// What was commanded.
    Command,
    /// Where it was on Earth.
    Position,
    /// How sensors are mounted.
    Mounting,
    /// The same, and where the robot is.
    Transforms,
}

impl Use {
    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Wheels => "wheel angles or rates",
            Self::Contacts => "sinkages, entry angles or encoder edges",
            Self::YawRate => "yaw rate",
            Self::Motion => "pose and speed",
            Self::Command => "commanded speed",
            Self::Position => "position on Earth",
            Self::Mounting => "mounting of sensors",
            Self::Transforms => "pose and mounting of sensors",
        }
    }
}

/// What is known of one topic.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Topic {
    /// The topic, its type and its definition.
    pub channel: Channel,
    /// Messages.
    pub messages: u64,
    /// Bytes of messages.
    pub bytes: u64,
    /// Time of the first one, ns.
    pub first_ns: u64,
    /// Time of the last one, ns.
    pub last_ns: u64,
    /// Messages per second; `None` for fewer than two.
    pub rate_hz: Option<f64>,
    /// Are the intervals those of the stamps in its messages' headers, and not those of their recording,
    /// which comes in bursts?
    pub stamped: bool,
    /// The longest interval, s.
    pub longest_s: f64,
    /// Intervals of more than five times the median.
    pub gaps: u64,
    /// How often its stamps or the recorder's clock went back by more than 0.1 s.
    pub jumps: u64,
    /// Messages that cannot be decoded, and why the first of them cannot.
    pub undecoded: u64,
    /// Why the first of them cannot be.
    pub problem: Option<String>,
    /// What Grouser can use it for.
    pub use_for: Option<Use>,
    /// The joints that it names.
    pub joints: Vec<String>,
    /// Of transforms that move a robot: its frame, and the frame in which it moves.
    pub moves: Option<(String, String)>,
}

/// What a log holds.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Survey {
    /// The kind of file.
    pub format: Format,
    /// Topics in the order in which they are met.
    pub topics: Vec<Topic>,
    /// The earliest time, ns.
    pub first_ns: Option<u64>,
    /// The latest time, ns.
    pub last_ns: Option<u64>,
    /// The first places that could not be read.
    pub damages: Vec<Damage>,
    /// How many there are in all.
    pub damage_count: u64,
    /// Bytes of the file that are lost in them.
    pub bytes_lost: u64,
}

struct Tally {
    topic: Topic,
    /// Shared by the channels of one definition.
    decoder: SharedDecoder,
    bins: Vec<u32>,
    last_seen: Option<u64>,
    last_stamp: Option<u64>,
}

impl Survey {
    /// Reads a whole file; `progress` receives the number of bytes read.
    ///
    /// # Errors
    /// What does not let the file be opened. Damage inside is no error: it is listed.
    pub fn read(path: &Path, progress: impl FnMut(u64)) -> Result<Self> {
        Self::read_run(std::slice::from_ref(&path.to_owned()), progress)
    }

    /// Reads all files of one run, such as the parts into which a recorder splits it: a topic of several files is one.
    /// Offsets of damages are counted from the first file's beginning.
    ///
    /// # Errors
    /// As [`Survey::read`]; [`Error::Empty`](crate::Error::Empty) without a file.
    pub fn read_run(paths: &[PathBuf], progress: impl FnMut(u64)) -> Result<Self> {
        let sources: Vec<Source> = paths.iter().cloned().map(Source::file).collect();
        Self::from_sources(&sources, progress)
    }

    pub(crate) fn from_sources(sources: &[Source], mut progress: impl FnMut(u64)) -> Result<Self> {
        let (mut tallies, mut transforms) = (Vec::new(), FirstTransforms::default());
        let mut survey = None;
        let mut bytes_before = 0;
        for source in sources {
            let mut container = Container::from_source(source)?;
            let survey = survey.get_or_insert_with(|| Self {
                format: container.format(),
                topics: Vec::new(),
                first_ns: None,
                last_ns: None,
                damages: Vec::new(),
                damage_count: 0,
                bytes_lost: 0,
            });
            survey.read_file(&mut container, (&mut tallies, &mut transforms), |offset| {
                progress(bytes_before + offset);
                bytes_before
            });
            bytes_before += container.offset();
        }
        let mut survey = survey.ok_or_else(|| crate::Error::Empty {
            file: "the run".to_owned(),
            what: "no file",
        })?;
        survey.topics = tallies.into_iter().map(Tally::finish).collect();
        survey.find_poses(&transforms);
        Ok(survey)
    }

    /// Adds a file to the tallies. `progress` receives its offset and returns the bytes of the files before.
    fn read_file(
        &mut self,
        container: &mut Container,
        (tallies, transforms): (&mut Vec<Tally>, &mut FirstTransforms),
        mut progress: impl FnMut(u64) -> u64,
    ) {
        // Two channels of one file may share a topic; those of another file are the same channels again.
        let earlier_files = tallies.len();
        // The place of each of the file's channels among the tallies.
        let mut places: BTreeMap<usize, usize> = BTreeMap::new();
        let (mut decoders, mut spare) = (Decoders::default(), Spare::default());
        let mut known = 0;
        let mut enter = |tallies: &mut Vec<Tally>, index: usize, channel: &Channel| {
            *places.entry(index).or_insert_with(|| {
                let same = |tally: &Tally| {
                    tally.topic.channel.topic == channel.topic
                        && tally.topic.channel.type_name == channel.type_name
                };
                if let Some(place) = tallies[..earlier_files].iter().position(same) {
                    return place;
                }
                tallies.push(Tally::new(channel, decoders.of(channel)));
                tallies.len() - 1
            })
        };
        loop {
            let before = progress(container.offset());
            for channel in &container.channels()[known..] {
                enter(tallies, known, channel);
                known += 1;
            }
            match container.next() {
                None => break,
                Some(Event::Damage(mut damage)) => {
                    damage.offset += before;
                    self.damage_count += 1;
                    self.bytes_lost += damage.bytes;
                    if self.damages.len() < DAMAGES {
                        self.damages.push(damage);
                    }
                }
                Some(Event::Message(message)) => {
                    let (index, time) = (message.channel, message.log_time_ns);
                    self.first_ns = Some(self.first_ns.map_or(time, |first| first.min(time)));
                    self.last_ns = Some(self.last_ns.map_or(time, |last| last.max(time)));
                    // Its channel may have been met on the way to it.
                    let place = enter(tallies, index, message.of);
                    let mut value = spare.take(index);
                    tallies[place].take(time, message.data, &mut value);
                    if tallies[place].topic.use_for == Some(Use::Mounting)
                        && let Some(View::Transforms(all)) =
                            View::new(&message.of.type_name, &value)
                    {
                        let is_static = is_static(&message.of.topic);
                        let all = all.iter();
                        all.for_each(|one| transforms.enter(place, &one, is_static));
                    }
                    spare.keep(index, message.data.len(), value);
                }
            }
        }
    }

    /// Which topics of transforms move a robot, with all that never change.
    fn find_poses(&mut self, transforms: &FirstTransforms) {
        let are_static: Vec<bool> = self
            .topics
            .iter()
            .map(|topic| is_static(&topic.channel.topic))
            .collect();
        for (place, topic) in self
            .topics
            .iter_mut()
            .enumerate()
            .filter(|(place, _)| !are_static[*place])
        {
            if topic.use_for == Some(Use::Mounting) {
                let found = poses(
                    &transforms.tree(|other| other == place || are_static[other]),
                    None,
                    None,
                );
                let best = found.first();
                topic.moves = best.map(|pair| (pair.base.clone(), pair.fixed.clone()));
                if best.is_some_and(|pair| pair.is_absolute) {
                    topic.use_for = Some(Use::Transforms);
                }
            }
        }
    }

    /// How long it is, s.
    #[must_use]
    pub fn duration_s(&self) -> Option<f64> {
        Some((self.last_ns? - self.first_ns?) as f64 * 1e-9)
    }

    /// Is there a topic of that use with messages?
    #[must_use]
    pub fn has(&self, wanted: Use) -> bool {
        self.topics
            .iter()
            .any(|topic| topic.use_for == Some(wanted))
    }
}

impl Tally {
    fn new(channel: &Channel, decoder: SharedDecoder) -> Self {
        Self {
            decoder,
            topic: Topic {
                channel: channel.clone(),
                messages: 0,
                bytes: 0,
                first_ns: 0,
                last_ns: 0,
                rate_hz: None,
                stamped: false,
                longest_s: 0.0,
                gaps: 0,
                jumps: 0,
                undecoded: 0,
                problem: None,
                use_for: None,
                joints: Vec::new(),
                moves: None,
            },
            bins: Vec::new(),
            last_seen: None,
            last_stamp: None,
        }
    }

    /// A message; `value` is what it is decoded into.
    fn take(&mut self, time: u64, data: &[u8], value: &mut Value) {
        let topic = &mut self.topic;
        if topic.messages == 0 {
            (topic.first_ns, topic.last_ns) = (time, time);
        }
        topic.messages += 1;
        topic.bytes += data.len() as u64;
        topic.first_ns = topic.first_ns.min(time);
        topic.last_ns = topic.last_ns.max(time);
        let decoded = decode(&self.decoder, data, value);
        // transforms of several senders, some ahead of their time, share a topic
        let is_tree = ["TFMessage", "tfMessage"]
            .iter()
            .any(|kind| topic.channel.type_name.ends_with(kind));
        let stamp = decoded.as_ref().ok().filter(|()| !is_tree);
        let stamp = stamp.and_then(|()| stamp_of(value).ok().flatten());
        let stamp = stamp.map(i64::cast_unsigned);
        if topic.messages == 1 {
            topic.stamped = stamp.is_some();
        }
        let recorded = self.last_seen.replace(time);
        let stamped = match stamp {
            Some(_) => std::mem::replace(&mut self.last_stamp, stamp),
            None => None,
        };
        let back = |last: Option<u64>, now: u64| {
            last.is_some_and(|last| now.saturating_add(JUMP_NS) < last)
        };
        if back(recorded, time) || stamp.is_some_and(|stamp| back(stamped, stamp)) {
            topic.jumps += 1;
        }
        let pair = if topic.stamped {
            stamped.zip(stamp)
        } else {
            recorded.map(|last| (last, time))
        };
        if let Some((last, now)) = pair {
            let interval = now.saturating_sub(last);
            topic.longest_s = topic.longest_s.max(interval as f64 * 1e-9);
            self.bins.resize(BINS, 0);
            self.bins[bin(interval)] += 1;
        }
        match decoded {
            Err(problem) => {
                topic.undecoded += 1;
                topic.problem.get_or_insert(problem);
            }
            Ok(()) if topic.use_for.is_none() => {
                let view = View::new(&topic.channel.type_name, value);
                let names = match view {
                    Some(View::JointState(joints)) => joints.names,
                    Some(View::WheelTicks { names, .. } | View::WheelContacts { names, .. }) => {
                        names
                    }
                    _ => Elements::default(),
                };
                let names = names.iter().filter(|name| name.len() <= JOINT_NAME);
                topic.joints = names.take(JOINTS).map(str::to_owned).collect();
                let robots = !topic.channel.topic.starts_with(TRUTH);
                let name = topic.channel.topic.as_str();
                let view = view.as_ref().filter(|_| robots);
                topic.use_for = view.and_then(|view| use_of(view, name));
            }
            Ok(()) => {}
        }
    }

    fn finish(self) -> Topic {
        let mut topic = self.topic;
        let span = (topic.last_ns - topic.first_ns) as f64 * 1e-9;
        if span > 0.0 {
            topic.rate_hz = Some((topic.messages - 1) as f64 / span);
        }
        let total: u32 = self.bins.iter().sum();
        let mut passed = 0;
        let median = self.bins.iter().position(|count| {
            passed += count;
            2 * passed >= total
        });
        // A topic without a rhythm has no gaps.
        if let Some(median) = median.filter(|_| total >= 8) {
            let first = median + GAP_BINS + 1;
            topic.gaps = self
                .bins
                .iter()
                .skip(first)
                .map(|count| u64::from(*count))
                .sum();
        }
        topic
    }
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and 512"
)]
fn bin(interval_ns: u64) -> usize {
    let doublings = Real::ln(interval_ns.max(1) as f64) * std::f64::consts::LOG2_E;
    let place = doublings * BINS_PER_DOUBLING;
    (place as usize).min(BINS - 1)
}

fn use_of(view: &View<'_>, topic: &str) -> Option<Use> {
    Some(match view {
        View::JointState(_) | View::WheelTicks { .. } => Use::Wheels,
        View::WheelContacts { .. } => Use::Contacts,
        View::Imu(imu) => {
            imu.angular_rate?;
            Use::YawRate
        }
        View::Pose { .. } | View::Point(_) if is_unmeasured(topic) => return None,
        View::Odometry(_) | View::Pose { .. } | View::Point(_) | View::Displacement { .. } => {
            Use::Motion
        }
        View::Twist { .. } if is_over_ground(topic) => Use::Motion,
        View::Twist { .. } if is_command(topic) => Use::Command,
        View::Twist { .. } => return None,
        View::NavSatFix(_) => Use::Position,
        View::Transforms(_) => Use::Mounting,
    })
}
