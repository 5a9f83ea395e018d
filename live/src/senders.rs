//! Which publishers of a topic are used: two that measure the same thing would contradict each other.

use std::collections::{BTreeMap, BTreeSet};
use std::time::{Duration, Instant};

use grouser_log::container::Channel;
use grouser_log::message::{Decoder, Elements, View};

use crate::transport::{Arrival, PublisherId};

/// A publisher that is silent for so long may be replaced by another: it was killed, and started again.
const SILENCE: Duration = Duration::from_millis(500);
/// Publishers that are kept at most; the oldest are forgotten.
const MAX_PUBLISHERS: usize = 64;

/// The publishers of one topic.
pub(crate) struct Senders {
    topic: String,
    /// Reads the joints; `None` for a topic whose messages name none.
    decoder: Option<Decoder>,
    known: BTreeMap<PublisherId, Sender>,
    ignored: u64,
}

struct Sender {
    joints: BTreeSet<String>,
    last: Instant,
    is_used: bool,
}

impl Senders {
    pub(crate) fn new(channel: &Channel) -> Self {
        let names_joints = matches!(
            channel.type_name.as_str(),
            "sensor_msgs/msg/JointState" | "grouser_msgs/msg/WheelTicks"
        );
        Self {
            topic: channel.topic.clone(),
            decoder: names_joints.then(|| Decoder::new(channel).ok()).flatten(),
            known: BTreeMap::new(),
            ignored: 0,
        }
    }

    /// Is this message used? Not where another publisher, which has not fallen silent, measures the same.
    pub(crate) fn accepts(&mut self, arrival: &Arrival, type_name: &str) -> bool {
        if !self.known.contains_key(&arrival.publisher) {
            self.enter(arrival, type_name);
        }
        let now = arrival.received;
        let Some(own) = self.known.get(&arrival.publisher) else {
            return true;
        };
        let mut is_used = own.is_used;
        if !is_used {
            // the other one may have ended in the meantime
            is_used = !self.rivals(&arrival.publisher, &own.joints, now);
        }
        if let Some(own) = self.known.get_mut(&arrival.publisher) {
            own.last = now;
            own.is_used = is_used;
        }
        self.ignored += u64::from(!is_used);
        is_used
    }

    fn enter(&mut self, arrival: &Arrival, type_name: &str) {
        if self.known.len() >= MAX_PUBLISHERS {
            let oldest = self.known.iter().min_by_key(|(_, sender)| sender.last);
            if let Some(id) = oldest.map(|(id, _)| *id) {
                self.known.remove(&id);
            }
        }
        let decoded = self
            .decoder
            .as_ref()
            .and_then(|decoder| decoder.decode(&arrival.bytes).ok());
        let view = decoded
            .as_ref()
            .and_then(|value| View::new(type_name, value));
        let joints = match view {
            Some(View::JointState(state)) => state.names,
            Some(View::WheelTicks { names, .. }) => names,
            _ => Elements::default(),
        };
        let joints: BTreeSet<String> = joints.iter().map(str::to_owned).collect();
        let is_used = !self.rivals(&arrival.publisher, &joints, arrival.received);
        self.known.insert(
            arrival.publisher,
            Sender {
                joints,
                last: arrival.received,
                is_used,
            },
        );
    }

    /// Is there another publisher in use that measures the same?
    fn rivals(&self, id: &PublisherId, joints: &BTreeSet<String>, now: Instant) -> bool {
        self.known.iter().any(|(other, sender)| {
            other != id
                && sender.is_used
                && now.saturating_duration_since(sender.last) < SILENCE
                && (self.decoder.is_none() || !sender.joints.is_disjoint(joints))
        })
    }

    /// What is wrong with the publishers, in words; `None` while nothing is.
    pub(crate) fn problem(&self, now: Instant) -> Option<String> {
        let is_active = |sender: &&Sender| now.saturating_duration_since(sender.last) < SILENCE;
        let count = self
            .known
            .values()
            .filter(is_active)
            .filter(|sender| !sender.is_used)
            .count();
        (count > 0).then(|| {
            let what = if self.decoder.is_some() { "the same joints" } else { "the same" };
            format!(
                "{} publishers of `{}` measure {what}: the first is used, {} messages of the others were ignored",
                count + 1,
                self.topic,
                self.ignored
            )
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;
    use grouser_log::message::{Definition, build, known};

    fn arrival(publisher: u8, joints: &[&str], received: Instant) -> Arrival {
        let text = known::definition("sensor_msgs/JointState").unwrap();
        let definition = Definition::parse("sensor_msgs/msg/JointState", &text).unwrap();
        let message = build::joint_state(build::header(1, ""), joints, [&[0.0], &[], &[]]);
        Arrival {
            subscription: 0,
            publisher: [publisher; 16],
            received,
            received_ns: 0,
            bytes: definition.encode(&message).unwrap(),
        }
    }

    #[test]
    fn of_two_that_measure_the_same_joint_the_first_is_used_until_it_falls_silent() {
        let channel = known::channel("/joint_states", "sensor_msgs/JointState").unwrap();
        let mut senders = Senders::new(&channel);
        let now = Instant::now();
        let mut accepts = |publisher, joint, later_ms| {
            let received = now + Duration::from_millis(later_ms);
            senders.accepts(&arrival(publisher, &[joint], received), &channel.type_name)
        };
        assert!(accepts(1, "left", 0));
        assert!(accepts(2, "right", 1), "another joint is no conflict");
        assert!(!accepts(3, "left", 2));
        assert!(accepts(1, "left", 3));
        // the first was killed: the third takes over after its silence
        assert!(!accepts(3, "left", 400));
        assert!(accepts(3, "left", 504));
        let problem = senders.problem(now + Duration::from_millis(2));
        assert!(problem.is_none_or(|words| words.contains("/joint_states")));
    }
}
