//! The records of one bag or MCAP file.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::Recording;
use super::choose::{Chosen, Job};
use super::mounting::{dot, yaw};
use crate::error::Result;
use crate::message::{Trust, Value, View};
use crate::messages::{Messages, Stamped};
use crate::record::{Reading, Record};

/// Records of one file in the order of time.
pub(crate) struct RecordingReader {
    messages: Messages,
    recording: Recording,
    /// The number of the first topic among the log's sources.
    first_source: usize,
    ready: VecDeque<Record>,
    read: Arc<AtomicU64>,
    counted: u64,
    done: bool,
}

impl RecordingReader {
    /// Opens a file. `shift_ns` is added to the times of each of the log's sources; what is read of the
    /// file is added to `read`.
    pub(crate) fn open(
        path: &Path,
        recording: &Recording,
        first_source: usize,
        (shift_ns, read): (&[i64], &Arc<AtomicU64>),
    ) -> Result<Self> {
        let topics = Arc::clone(&recording.topics);
        let shifts: Vec<i64> = (0..topics.len())
            .map(|index| shift_ns.get(first_source + index).copied().unwrap_or(0))
            .collect();
        let messages = Messages::open_shifted(path, recording.clock, move |channel| {
            let place = topics.iter().position(|c| c.topic == channel.topic)?;
            Some(shifts[place])
        })?;
        Ok(Self {
            messages,
            recording: recording.clone(),
            first_source,
            ready: VecDeque::new(),
            read: Arc::clone(read),
            counted: 0,
            done: false,
        })
    }

    /// The readings of a message, into the queue.
    fn take(&mut self, message: &Stamped) {
        let channel = &self.messages.channels()[message.channel];
        let place = |chosen: &Chosen| chosen.topic == channel.topic;
        let Some(index) = self.recording.topics.iter().position(place) else {
            return;
        };
        let view = View::new(&channel.type_name, &message.value);
        for job in &self.recording.topics[index].jobs {
            let push = |reading| {
                self.ready.push_back(Record {
                    time_ns: message.time_ns,
                    source: self.first_source + index,
                    reading,
                });
            };
            readings(job, view.as_ref(), &message.value, push);
        }
    }

    fn finish(&mut self) {
        if !std::mem::replace(&mut self.done, true) {
            self.recording.lock().add(self.messages.left_out());
        }
    }
}

impl Iterator for RecordingReader {
    type Item = Result<Record>;

    fn next(&mut self) -> Option<Self::Item> {
        while self.ready.is_empty() && !self.done {
            match self.messages.next() {
                Some(message) => {
                    self.take(&message);
                    self.messages.give_back(message);
                }
                None => self.finish(),
            }
            let offset = self.messages.offset();
            if offset > self.counted {
                self.read
                    .fetch_add(offset - self.counted, Ordering::Relaxed);
                self.counted = offset;
            }
        }
        self.ready.pop_front().map(Ok)
    }
}

/// What a message says for one job.
fn readings(job: &Job, view: Option<&View>, value: &Value, mut push: impl FnMut(Reading)) {
    let usable = |trust: &[Trust]| trust.iter().all(|trust| trust.is_usable());
    match (job, view) {
        (Job::Joints(joints), Some(view)) => wheel_readings(joints, view, push),
        (Job::YawRate(up), Some(View::Imu(imu))) => {
            let trusted = imu.angular_rate_trust.iter().zip(up);
            let usable = trusted
                .clone()
                .all(|(trust, u)| u.abs() < 0.1 || *trust != Trust::DoNotUse);
            if let Some(rate) = imu.angular_rate.filter(|_| usable) {
                push(Reading::YawRate {
                    rate: dot(*up, rate),
                });
            }
        }
        (Job::Acceleration([forward, left]), Some(View::Imu(imu))) => {
            if let Some(felt) = imu.acceleration {
                push(Reading::Acceleration {
                    forward: dot(*forward, felt),
                    left: dot(*left, felt),
                });
            }
        }
        (Job::Pose, Some(View::Odometry(odometry))) => {
            if let Some(yaw) = yaw(odometry.orientation).filter(|_| usable(&odometry.pose_trust)) {
                let [x, y, _] = odometry.position;
                push(Reading::Pose { x, y, yaw });
            }
        }
        (
            Job::Pose,
            Some(View::Pose {
                position,
                orientation,
            }),
        ) => {
            if let Some(yaw) = yaw(*orientation) {
                let [x, y, _] = *position;
                push(Reading::Pose { x, y, yaw });
            }
        }
        (Job::Speed, Some(View::Odometry(odometry))) if odometry.twist_trust[0].is_usable() => {
            let [forward, left, _] = odometry.linear;
            push(Reading::Speed {
                forward,
                left: odometry.twist_trust[1].is_usable().then_some(left),
            });
        }
        (Job::Speed, Some(View::Twist { linear, .. })) => push(Reading::Speed {
            forward: linear[0],
            left: Some(linear[1]),
        }),
        (Job::Command, Some(View::Twist { linear, .. })) => push(Reading::Command {
            forward: linear[0],
            left: linear[1],
        }),
        (
            Job::Displacement,
            Some(View::Displacement {
                forward,
                left,
                turn,
            }),
        ) => push(Reading::Displacement {
            forward: *forward,
            left: *left,
            turn: *turn,
        }),
        (Job::WheelOdometry(wheels), Some(View::Odometry(odometry))) => {
            let [trust, _, turn_trust] = odometry.twist_trust;
            if usable(&[trust, turn_trust]) {
                let (speed, turn) = (odometry.linear[0], odometry.angular[2]);
                for (wheel, per_speed, per_turn) in wheels {
                    push(Reading::WheelRate {
                        wheel: *wheel,
                        rate: per_speed * speed + per_turn * turn,
                    });
                }
            }
        }
        (Job::Fields(slots, paths), _) => {
            let found = slots.readings(
                |part| {
                    let number = value.number_at(&paths[part.column]);
                    Ok::<_, Infallible>(number.map(|number| number * part.factor))
                },
                |part| {
                    let path = &paths[part.column];
                    Ok(value
                        .count_at(path)
                        .or_else(|| whole(value.number_at(path))))
                },
                push,
            );
            let Ok(()) = found;
        }
        _ => {}
    }
}

/// A counter that is sent as a number with a point.
#[allow(
    clippy::cast_possible_truncation,
    reason = "whole and below 2^53 in size, as is checked"
)]
fn whole(number: Option<f64>) -> Option<u64> {
    let number = number?;
    (number.fract() == 0.0 && number.abs() < 9_007_199_254_740_992.0)
        .then(|| (number as i64).cast_unsigned())
}

fn wheel_readings(joints: &[(String, usize)], view: &View, mut push: impl FnMut(Reading)) {
    let names = match view {
        View::JointState(state) => &state.names,
        View::WheelTicks { names, .. } => names,
        _ => return,
    };
    for (place, name) in names.iter().enumerate() {
        let Some(&(_, wheel)) = joints.iter().find(|(joint, _)| joint == name) else {
            continue;
        };
        match view {
            View::JointState(state) => {
                if let Some(&angle) = state.position.get(place) {
                    push(Reading::WheelAngle { wheel, angle });
                }
                if let Some(&rate) = state.velocity.get(place) {
                    push(Reading::WheelRate { wheel, rate });
                }
                // drivers that measure none say NaN
                if let Some(&torque) = state.effort.get(place).filter(|e| e.is_finite()) {
                    push(Reading::WheelTorque { wheel, torque });
                }
            }
            View::WheelTicks { ticks, .. } => {
                if let Some(&raw) = ticks.get(place) {
                    push(Reading::WheelCount { wheel, raw });
                }
            }
            _ => {}
        }
    }
}
