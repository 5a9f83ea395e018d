//! A first look into bags: which topics there are, and what their first messages say.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use grouser_files::topics::Topics;

use super::mounting::{Accelerations, Tree, enter};
use crate::container::{Channel, Container, Event};
use crate::error::Result;
use crate::message::{Decoders, SharedDecoder, Value, View};
use crate::messages::stamp_of;

/// So much of a file is looked through, bytes, unless something is missing that is needed.
const LOOK: u64 = 64 << 20;
/// So many messages of a topic are decoded: several senders may share one.
const MESSAGES: u64 = 64;
/// So many joints of a topic are kept.
const JOINTS: usize = 4096;
/// So many messages of an IMU are decoded, for gravity.
const ACCELERATIONS: f64 = 500.0;

/// What the first messages of a topic say.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    pub(super) channel: Channel,
    pub(super) messages: u64,
    /// What a message is, by the first that has a view.
    pub(super) view: Option<View>,
    /// Joints, and whether they have a position, a velocity.
    pub(super) joints: BTreeMap<String, (bool, bool)>,
    pub(super) accelerations: Accelerations,
    /// The first message, where fields of it are asked for.
    pub(super) sample: Option<Value>,
    /// How far the first stamp is ahead of the recorder's clock, s; `None` without a stamp.
    pub(super) stamp_ahead: Option<f64>,
}

/// What the files of a run hold, by topic in the order in which they are met.
#[derive(Debug, Default)]
pub(super) struct Peek {
    pub(super) topics: Vec<Seen>,
    pub(super) transforms: Tree,
}

impl Peek {
    /// Looks into the files of one run.
    pub(super) fn read(files: &[PathBuf], topics: &Topics) -> Result<Self> {
        let mut peek = Self::default();
        for file in files {
            peek.look(file, topics)?;
        }
        Ok(peek)
    }

    pub(super) fn topic(&self, name: &str) -> Option<&Seen> {
        self.topics.iter().find(|seen| seen.channel.topic == name)
    }

    /// Is all there that the robot file names, and something that measures wheels?
    fn is_enough(&self, topics: &Topics) -> bool {
        let wheels = |seen: &Seen| !seen.joints.is_empty();
        let is_seen = |name| self.topic(name).is_some_and(|seen| seen.messages > 0);
        (!topics.fields.is_empty()
            || topics.wheel_odometry.is_some()
            || self.topics.iter().any(wheels))
            && topics.named().all(is_seen)
    }

    fn look(&mut self, file: &Path, topics: &Topics) -> Result<()> {
        let mut container = Container::open(file)?;
        let mut decoders: BTreeMap<usize, (usize, Option<SharedDecoder>)> = BTreeMap::new();
        let mut shared = Decoders::default();
        let mut looked = 0;
        loop {
            let offset = container.offset();
            if offset > LOOK && offset > looked {
                // Not for every message: a chunk at a time.
                looked = offset + (1 << 20);
                if self.is_enough(topics) {
                    return Ok(());
                }
            }
            let message = match container.next() {
                None => return Ok(()),
                Some(Event::Damage(_)) => continue,
                Some(Event::Message(message)) => message,
            };
            let (index, decoder) = decoders.entry(message.channel).or_insert_with(|| {
                let index = self.enter(message.of);
                let fields = topics.fields.iter();
                let wanted = View::exists_for(&message.of.type_name)
                    || fields.clone().any(|f| f.topic == message.of.topic);
                let decoder = if wanted {
                    Some(shared.of(message.of))
                } else {
                    None
                };
                (index, decoder)
            });
            let seen = &mut self.topics[*index];
            seen.messages += 1;
            let Some(Ok(decoder)) = decoder.as_deref() else {
                continue;
            };
            let is_enough = match &seen.view {
                Some(View::Imu(_)) => seen.accelerations.count() >= ACCELERATIONS,
                Some(View::Transforms(_)) => false,
                _ => seen.messages > MESSAGES,
            };
            if is_enough {
                continue;
            }
            let Ok(value) = decoder.decode(message.data) else {
                continue;
            };
            if seen.stamp_ahead.is_none() {
                let log = i128::from(message.log_time_ns);
                let ahead = stamp_of(&value).map(|stamp| i128::from(stamp) - log);
                seen.stamp_ahead = ahead.map(|ns| ns as f64 * 1e-9);
            }
            let view = View::new(&message.of.type_name, &value);
            if let Some(view) = view {
                seen.take(&view, &mut self.transforms);
                seen.view.get_or_insert(view);
            }
            seen.sample.get_or_insert(value);
        }
    }

    fn enter(&mut self, channel: &Channel) -> usize {
        let alike = |seen: &Seen| {
            seen.channel.topic == channel.topic && seen.channel.type_name == channel.type_name
        };
        self.topics.iter().position(alike).unwrap_or_else(|| {
            self.topics.push(Seen {
                channel: channel.clone(),
                messages: 0,
                view: None,
                joints: BTreeMap::new(),
                accelerations: Accelerations::default(),
                sample: None,
                stamp_ahead: None,
            });
            self.topics.len() - 1
        })
    }
}

impl Seen {
    fn take(&mut self, view: &View, transforms: &mut Tree) {
        match view {
            View::JointState(joints) => {
                for (index, name) in joints.names.iter().enumerate() {
                    if self.joints.len() >= JOINTS && !self.joints.contains_key(name) {
                        continue;
                    }
                    let has = self.joints.entry(name.clone()).or_default();
                    has.0 |= index < joints.position.len();
                    has.1 |= index < joints.velocity.len();
                }
            }
            View::WheelTicks { names, .. } => {
                let names = names.iter().map(|name| (name.clone(), (false, false)));
                self.joints.extend(names.take(JOINTS));
            }
            View::Imu(imu) => {
                if let Some(acceleration) = imu.acceleration {
                    self.accelerations.add(acceleration);
                }
            }
            View::Transforms(all) => all.iter().for_each(|one| enter(transforms, one)),
            _ => {}
        }
    }
}
