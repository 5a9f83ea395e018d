//! A first look into bags: which topics there are, and what their first messages say.

use std::collections::BTreeMap;
use std::path::Path;

use grouser_files::topics::Topics;

use super::choose::{Choice, choose};
use super::frames::{FirstTransforms, is_static};
use super::intake::{Intake, recorded_ns};
use super::mounting::Accelerations;
use super::navigation::{Fixes, MAX_FIXES};
use crate::container::{Channel, Container, Event};
use crate::error::Result;
use crate::message::{Decoders, SharedDecoder, Value, View};
use crate::messages::stamp_of;
use crate::source::Source;
use crate::wrapped_angles::Angle;

/// This much of a file is read, bytes, and more only while something needed is missing.
const LOOK_BYTES: u64 = 64 << 20;
/// Messages of a file that is still written are waited for until they span this time, ns.
const LOOK_NS: u64 = 1_000_000_000;
/// Messages of a topic that are decoded: several senders may share one.
const MAX_MESSAGES: u64 = 64;
/// Messages whose joints' positions are looked at: a minute at 50 Hz.
const MAX_POSITIONS: u64 = 3000;
/// So many numbers that never show a motion, beside others that do, are not measured.
const MIN_NUMBERS: u32 = 20;
/// Joints of a topic that are kept.
const MAX_JOINTS: usize = 4096;
/// Messages of an IMU that are decoded, for the mean of gravity.
const MAX_ACCELERATIONS: f64 = 500.0;
/// Messages of an IMU that are looked at for one that measures acceleration.
const MAX_IMU_MESSAGES: u64 = 20_000;

/// A topic by its first messages.
#[derive(Clone, Debug)]
pub(super) struct TopicPreview {
    pub(super) channel: Channel,
    pub(super) messages: u64,
    /// Joints, with what their positions and velocities are.
    pub(super) joints: BTreeMap<String, [Numbers; 2]>,
    /// Their positions.
    pub(super) angles: BTreeMap<String, Angle>,
    /// Joints with a sinkage, an entry angle.
    pub(super) contacts: BTreeMap<String, [bool; 3]>,
    pub(super) accelerations: Accelerations,
    pub(super) fixes: Fixes,
    /// The first message that has a view, else the first.
    pub(super) sample: Option<Value>,
    /// How far the first stamp is ahead of the recorder's clock, ns; `None` without a stamp.
    pub(super) ahead_ns: Option<i64>,
}

/// The numbers that a driver sends of a joint: their position, or their velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Numbers {
    first: Option<f64>,
    has_nan: bool,
    count: u32,
    varies: bool,
}

impl Numbers {
    /// Takes a number of a joint at rest at `rest`, where that is known.
    fn take(&mut self, number: Option<f64>, rest: Option<f64>) {
        let Some(number) = number else { return };
        if number.is_finite() {
            self.count += 1;
            self.varies |= *self.first.get_or_insert(rest.unwrap_or(number)) != number;
        } else {
            self.has_nan = true;
        }
    }

    pub(super) const fn are_sent(&self) -> bool {
        self.has_nan || self.first.is_some()
    }

    /// Are there numbers, and do they change where `other` does?
    pub(super) const fn are_measured(&self, other: &Self) -> bool {
        self.first.is_some() && (self.varies || !other.varies || self.count < MIN_NUMBERS)
    }
}

/// The first messages of a run, by which the topics of an [`Intake`] are chosen.
///
/// What the robot file names is used; else types, names, and what the messages hold decide. An IMU's mounting is read
/// from its transforms and from gravity.
pub struct Preview {
    wanted: Topics,
    files: Vec<String>,
    /// Topics in the order in which they are met.
    pub(super) topics: Vec<TopicPreview>,
    pub(super) transforms: FirstTransforms,
    channels: Vec<Known>,
    decoders: Decoders,
    /// The first and the last time of the recorder, ns.
    span_ns: Option<(u64, u64)>,
    /// Did the writers complete all files?
    is_whole: bool,
}

/// A channel, its place among the topics, and its decoder where its messages are of use.
struct Known {
    channel: Channel,
    topic: usize,
    decoder: Option<SharedDecoder>,
}

impl Preview {
    /// Nothing is known yet; `wanted` is the robot file's `[topics]`.
    #[must_use]
    pub fn new(wanted: &Topics) -> Self {
        Self {
            wanted: wanted.clone(),
            files: Vec::new(),
            topics: Vec::new(),
            transforms: FirstTransforms::default(),
            channels: Vec::new(),
            decoders: Decoders::default(),
            span_ns: None,
            is_whole: true,
        }
    }

    /// Reads the beginning of an MCAP file or a bag: 64 MiB, and more only while something is missing.
    ///
    /// # Errors
    /// What does not let the file be opened.
    pub fn read(&mut self, path: &Path) -> Result<()> {
        self.read_source(&Source::file(path.to_owned()))
    }

    pub(super) fn read_source(&mut self, source: &Source) -> Result<()> {
        let mut container = Container::from_source(source)?;
        self.files.push(source.name());
        let mut channels = BTreeMap::new();
        let mut looked = LOOK_BYTES;
        loop {
            let offset = container.offset();
            if offset > looked {
                // Not for every message: a chunk at a time.
                looked = offset + (1 << 20);
                if self.is_complete() {
                    return Ok(());
                }
            }
            match container.next() {
                None => {
                    self.is_whole &= container.is_complete();
                    return Ok(());
                }
                Some(Event::Damage(_)) => {}
                Some(Event::Message(message)) => {
                    let channel = *channels
                        .entry(message.channel)
                        .or_insert_with(|| self.channel(message.of));
                    self.push(channel, message.data, message.log_time_ns);
                }
            }
        }
    }

    /// The number under which messages of `channel` are pushed.
    pub fn channel(&mut self, channel: &Channel) -> usize {
        let known = self
            .channels
            .iter()
            .position(|known| known.channel == *channel);
        known.unwrap_or_else(|| {
            let topic = self.enter(channel);
            let mut fields = self.wanted.fields.iter();
            let is_used = View::exists_for(&channel.type_name)
                || fields.any(|field| field.topic == channel.topic);
            self.channels.push(Known {
                channel: channel.clone(),
                topic,
                decoder: is_used.then(|| self.decoders.of(channel)),
            });
            self.channels.len() - 1
        })
    }

    /// Takes a message of a channel, recorded at `log_time_ns`.
    pub fn push(&mut self, channel: usize, bytes: &[u8], log_time_ns: u64) {
        let Some(known) = self.channels.get(channel) else {
            return;
        };
        let (first, last) = self.span_ns.unwrap_or((log_time_ns, log_time_ns));
        self.span_ns = Some((first.min(log_time_ns), last.max(log_time_ns)));
        let seen = &mut self.topics[known.topic];
        seen.messages += 1;
        let Some(Ok(decoder)) = known.decoder.as_deref() else {
            return;
        };
        let is_enough = match seen.view() {
            Some(View::Imu(_)) => {
                seen.accelerations.count() >= MAX_ACCELERATIONS || seen.messages > MAX_IMU_MESSAGES
            }
            Some(View::Transforms(_)) => false,
            Some(View::JointState(_)) => seen.messages > MAX_POSITIONS,
            // A receiver may need minutes for its best solution.
            Some(View::NavSatFix(_)) => seen.messages > MAX_FIXES as u64,
            _ => seen.messages > MAX_MESSAGES,
        };
        if is_enough {
            return;
        }
        let Ok(value) = decoder.decode(bytes) else {
            return;
        };
        if seen.ahead_ns.is_none() {
            let stamp = stamp_of(&value).ok().flatten();
            seen.ahead_ns = stamp.map(|stamp| stamp.saturating_sub(recorded_ns(log_time_ns)));
        }
        let view = View::new(&known.channel.type_name, &value);
        match &view {
            Some(View::Transforms(all)) => {
                let is_static = is_static(&known.channel.topic);
                for one in all.iter() {
                    self.transforms.enter(known.topic, &one, is_static);
                }
            }
            Some(view) => seen.take(view),
            None => {}
        }
        if seen.sample.is_none() || (view.is_some() && seen.view().is_none()) {
            seen.sample = Some(value);
        }
    }

    /// Were all topics met that the robot file names, and one that measures wheels?
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let wheels = |seen: &TopicPreview| !seen.joints.is_empty();
        let is_seen = |name| self.topic(name).is_some_and(|seen| seen.messages > 0);
        (!self.wanted.fields.is_empty()
            || self.wanted.wheel_odometry.is_some()
            || self.topics.iter().any(wheels))
            && self.wanted.named().all(is_seen)
    }

    /// Can topics be chosen of files that are still written? Sensors begin one after the other.
    pub(super) fn has_looked(&self) -> bool {
        let looked_ns = self.span_ns.map_or(0, |(first, last)| last - first);
        self.is_whole || (self.is_complete() && looked_ns >= LOOK_NS)
    }

    /// Chooses the topics; messages are then pushed into the intake, from the first on.
    ///
    /// # Errors
    /// [`Error::NoNamedTopic`](crate::Error::NoNamedTopic), [`Error::UnfitTopic`](crate::Error::UnfitTopic) or
    /// [`Error::NoJoints`](crate::Error::NoJoints) where the robot file does not fit the messages.
    pub fn into_intake(self) -> Result<Intake> {
        Ok(Intake::alone(self.choose()?))
    }

    pub(super) fn choose(&self) -> Result<Choice> {
        choose(self, &self.wanted)
    }

    /// What the messages came from, for errors.
    pub(super) fn names(&self) -> String {
        if self.files.is_empty() {
            "the messages".to_owned()
        } else {
            self.files.join(", ")
        }
    }

    pub(super) fn topic(&self, name: &str) -> Option<&TopicPreview> {
        self.topics.iter().find(|seen| seen.channel.topic == name)
    }

    fn enter(&mut self, channel: &Channel) -> usize {
        let alike = |seen: &TopicPreview| {
            seen.channel.topic == channel.topic && seen.channel.type_name == channel.type_name
        };
        self.topics.iter().position(alike).unwrap_or_else(|| {
            self.topics.push(TopicPreview {
                channel: channel.clone(),
                messages: 0,
                joints: BTreeMap::new(),
                angles: BTreeMap::new(),
                contacts: BTreeMap::new(),
                accelerations: Accelerations::default(),
                fixes: Fixes::default(),
                sample: None,
                ahead_ns: None,
            });
            self.topics.len() - 1
        })
    }
}

impl TopicPreview {
    /// The view of the first message that has one.
    pub(super) fn view(&self) -> Option<View<'_>> {
        View::new(&self.channel.type_name, self.sample.as_ref()?)
    }

    fn take(&mut self, view: &View) {
        match view {
            View::JointState(joints) => {
                for (index, name) in joints.names.iter().enumerate() {
                    let is_full = self.messages > MAX_MESSAGES || self.joints.len() >= MAX_JOINTS;
                    if is_full && !self.joints.contains_key(name) {
                        continue;
                    }
                    if let Some(angle) = joints.position.get(index) {
                        let own = self.angles.entry(name.to_owned()).or_default();
                        own.unwrapped(angle);
                    }
                    let [positions, velocities] = self.joints.entry(name.to_owned()).or_default();
                    positions.take(joints.position.get(index), None);
                    velocities.take(joints.velocity.get(index), Some(0.0));
                }
            }
            View::WheelTicks { names, .. } => {
                let names = names
                    .iter()
                    .map(|name| (name.to_owned(), Default::default()));
                self.joints.extend(names.take(MAX_JOINTS));
            }
            View::WheelContacts { names, contacts } => {
                for (name, measured) in names.iter().zip(contacts.iter()) {
                    if self.contacts.len() >= MAX_JOINTS && !self.contacts.contains_key(name) {
                        continue;
                    }
                    let has = self.contacts.entry(name.to_owned()).or_default();
                    for (has, value) in has.iter_mut().zip(measured) {
                        *has |= value.is_some();
                    }
                }
            }
            View::Imu(imu) => {
                if let Some(acceleration) = imu.acceleration {
                    self.accelerations.add(acceleration);
                }
            }
            View::NavSatFix(fix) => self.fixes.add(fix),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::build;

    #[test]
    fn files_that_are_written_are_looked_at_for_a_second() {
        let mut preview = Preview::new(&Topics::default());
        assert!(preview.has_looked(), "no file is open");
        preview.is_whole = false;
        preview.span_ns = Some((7, 7 + LOOK_NS));
        assert!(!preview.has_looked(), "no wheel was met");
        let channel = crate::message::known::channel("/joints", "sensor_msgs/JointState").unwrap();
        let topic = preview.enter(&channel);
        preview.topics[topic]
            .joints
            .insert("left".to_owned(), Default::default());
        assert!(preview.has_looked());
        preview.span_ns = Some((7, 6 + LOOK_NS));
        assert!(!preview.has_looked());
        preview.span_ns = None;
        assert!(!preview.has_looked());
    }

    #[test]
    fn joints_have_what_some_message_has_of_them() {
        let channel = crate::message::known::channel("/joints", "sensor_msgs/JointState").unwrap();
        let mut preview = Preview::new(&Topics::default());
        let topic = preview.enter(&channel);
        let seen = &mut preview.topics[topic];
        let take = |seen: &mut TopicPreview, names: &[&str], parts: [&[f64]; 3]| {
            let value = build::joint_state(build::header(5, ""), names, parts);
            let view = View::new(&channel.type_name, &value).unwrap();
            seen.take(&view);
        };
        take(seen, &["a", "b", "c"], [&[1.0], &[1.0, 2.0], &[]]);
        let of = |[position, velocity]: [Numbers; 2]| {
            (
                position.are_measured(&velocity),
                velocity.are_measured(&position),
            )
        };
        let has = |seen: &TopicPreview| ["a", "b", "c"].map(|name| of(seen.joints[name]));
        assert_eq!(has(seen), [(true, true), (false, true), (false, false)]);
        take(seen, &["a", "b", "c"], [&[1.0], &[1.0, 2.0], &[]]);
        assert_eq!(has(seen), [(true, true), (false, true), (false, false)]);
        // a driver that leaves one of them at 0, or that sends no numbers
        for row in 0..MIN_NUMBERS {
            take(
                seen,
                &["d", "e"],
                [&[0.0, f64::NAN], &[f64::from(row); 2], &[]],
            );
        }
        assert_eq!(
            ["d", "e"].map(|name| of(seen.joints[name])),
            [(false, true); 2]
        );
        let many: Vec<String> = (0..5000).map(|number| format!("joint_{number}")).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        take(seen, &many, [&[], &[], &[]]);
        assert_eq!(seen.joints.len(), MAX_JOINTS);
        // one that is known has room
        take(seen, &["c"], [&[1.0], &[], &[]]);
        assert_eq!(of(seen.joints["c"]), (true, false));
    }

    #[test]
    fn contacts_have_what_some_message_has_of_them() {
        let channel =
            crate::message::known::channel("/contacts", crate::message::known::JOINT_INTERFACES)
                .unwrap();
        let mut preview = Preview::new(&Topics::default());
        let topic = preview.enter(&channel);
        let seen = &mut preview.topics[topic];
        let take = |seen: &mut TopicPreview, names: &[&str], contacts: &[[Option<f64>; 2]]| {
            let value = build::wheel_contacts(build::header(5, ""), names, contacts);
            let view = View::new(&channel.type_name, &value).unwrap();
            seen.take(&view);
        };
        take(seen, &["a", "b"], &[[Some(0.1), None], [None, Some(0.2)]]);
        take(
            seen,
            &["a", "b"],
            &[[Some(0.1), None], [Some(0.3), Some(0.2)]],
        );
        assert_eq!(
            (seen.contacts["a"], seen.contacts["b"]),
            ([true, false, false], [true, true, false])
        );
        let many: Vec<String> = (0..5000).map(|number| format!("joint_{number}")).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        take(seen, &many, &vec![[Some(0.1), None]; many.len()]);
        assert_eq!(seen.contacts.len(), MAX_JOINTS);
        take(seen, &["a"], &[[None, Some(0.1)]]);
        assert_eq!(seen.contacts["a"], [true, true, false]);
    }
}
