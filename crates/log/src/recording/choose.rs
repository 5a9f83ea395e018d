//! Which topics of a bag are used, and what for.

use grouser_files::columns::Meaning;
use grouser_files::nearest;
use grouser_files::topics::{Topics, WheelOdometry};

use super::mounting::{agree, up_by_transforms};
use super::peek::{Peek, Seen};
use crate::error::{Error, Result};
use crate::message::{Imu, Trust, View};
use crate::messages::Clock;
use crate::slots::Slots;

/// What a topic is used for.
#[derive(Clone, Debug)]
pub(super) enum Job {
    /// Angles, rates or counts of wheels: each joint's name and its wheel.
    Joints(Vec<(String, usize)>),
    /// The yaw rate about this direction.
    YawRate([f64; 3]),
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

/// Words in a topic's name that say that it measures the ground, not the wheels.
const OVER_GROUND: &[&str] = &[
    "vio",
    "vo",
    "visual",
    "vision",
    "camera",
    "zed",
    "t265",
    "rtabmap",
    "slam",
    "lidar",
    "laser",
    "icp",
    "gps",
    "gnss",
    "rtk",
    "truth",
    "groundtruth",
    "mocap",
    "vicon",
    "optitrack",
    "qualisys",
    "aruco",
    "apriltag",
    "flow",
    "ground",
];
/// Stamps of the topics of one run may differ by so much more than the recorder's clock says, s.
const STAMPS_APART: f64 = 10.0;

/// The words of a name: `/vicon/robot_1` is `vicon`, `robot`, `1`.
fn words(name: &str) -> impl Iterator<Item = String> + '_ {
    name.split(|letter: char| !letter.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
}

fn is_over_ground(topic: &str) -> bool {
    let mut words = words(topic);
    words.any(|word| OVER_GROUND.contains(&word.as_str()))
}

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
        all.any(|(meaning, _)| meaning.is_of_a_wheel())
    }

    fn fields(&mut self) -> Result<()> {
        for topic in &self.topics.fields {
            let seen = self.named("field", &topic.topic)?;
            for field in &topic.fields {
                // An array may be empty at first, but what has no such name will never have it.
                let number = seen
                    .sample
                    .as_ref()
                    .map(|value| value.number_at(&field.column));
                if number == Some(None) {
                    return Err(Error::NoField {
                        file: self.file.to_owned(),
                        topic: topic.topic.clone(),
                        field: field.column.clone(),
                    });
                }
                if let Some(wheel) = &field.wheel
                    && !self.choice.wheels.contains(wheel)
                {
                    self.choice.wheels.push(wheel.clone());
                }
            }
            let wheel_of = |wheel: &Option<String>| {
                let wheel = wheel.as_ref()?;
                self.choice.wheels.iter().position(|own| own == wheel)
            };
            let measures: Vec<_> = topic
                .fields
                .iter()
                .map(|field| (field.meaning, wheel_of(&field.wheel)))
                .collect();
            let slots = Slots::new(&topic.fields, &self.choice.wheels);
            let paths = topic.fields.iter().map(|f| f.column.clone()).collect();
            self.take(seen, Job::Fields(slots, paths), "fields", measures);
        }
        Ok(())
    }

    fn wheels(&mut self) -> Result<()> {
        let joints_of = |seen: &Seen| -> Vec<(String, usize)> {
            let joints = self.topics.joints.iter().enumerate();
            let found = joints.filter_map(|(index, wheel)| {
                let name = match &wheel.joint {
                    Some(joint) => seen.joints.contains_key(joint).then(|| joint.clone()),
                    None => joint_by_name(&wheel.wheel, seen.joints.keys()),
                };
                Some((name?, index))
            });
            found.collect()
        };
        let seen = if let Some(name) = &self.topics.wheels {
            let seen = self.named("wheels", name)?;
            if joints_of(seen).is_empty() {
                return Err(Error::NoJoints {
                    file: self.file.to_owned(),
                    topic: name.clone(),
                    joints: seen.joints.keys().cloned().collect::<Vec<_>>().join(", "),
                });
            }
            Some(seen)
        } else if self.measures_wheels() {
            None
        } else {
            // The one with the most wheels, the first of these.
            let free = self.free().map(|seen| (joints_of(seen).len(), seen));
            let best = free.filter(|(count, _)| *count > 0);
            let best = best.reduce(|a, b| if b.0 > a.0 { b } else { a });
            best.map(|(_, seen)| seen)
        };
        if let Some(seen) = seen {
            let joints = joints_of(seen);
            let is_ticks = matches!(seen.view, Some(View::WheelTicks { .. }));
            let mut measures = Vec::new();
            for (name, wheel) in &joints {
                let (position, velocity) = seen.joints.get(name).copied().unwrap_or_default();
                let has = [
                    (is_ticks, Meaning::WheelCount),
                    (position, Meaning::WheelAngle),
                    (velocity, Meaning::WheelRate),
                ];
                let has = has.into_iter().filter(|(has, _)| *has);
                measures.extend(has.map(|(_, meaning)| (meaning, Some(*wheel))));
            }
            let word = format!("wheels by {} joints", joints.len());
            self.take(seen, Job::Joints(joints), word, measures);
        }
        if let Some(odometry) = &self.topics.wheel_odometry {
            self.wheel_odometry(odometry)?;
        }
        Ok(())
    }

    fn wheel_odometry(&mut self, odometry: &WheelOdometry) -> Result<()> {
        let seen = self.named("wheel_odometry", &odometry.topic)?;
        if !matches!(seen.view, Some(View::Odometry(_))) {
            return Err(self.unfit("wheel_odometry", seen, "nav_msgs/Odometry"));
        }
        let names = &self.choice.wheels;
        let wheels: Vec<(usize, f64, f64)> = odometry
            .wheels
            .iter()
            .filter_map(|wheel| {
                let index = names.iter().position(|name| *name == wheel.wheel)?;
                Some((index, wheel.per_speed, wheel.per_turn))
            })
            .collect();
        let measures: Vec<_> = wheels
            .iter()
            .map(|(wheel, _, _)| (Meaning::WheelRate, Some(*wheel)))
            .collect();
        self.take(
            seen,
            Job::WheelOdometry(wheels),
            "rates of the wheels",
            measures,
        );
        Ok(())
    }

    fn yaw_rate(&mut self) -> Result<()> {
        let seen = if let Some(name) = &self.topics.yaw_rate {
            let seen = self.named("yaw_rate", name)?;
            if !matches!(seen.view, Some(View::Imu(_))) {
                return Err(self.unfit("yaw_rate", seen, "sensor_msgs/Imu"));
            }
            Some(seen)
        } else if self.measures(Meaning::YawRate) {
            None
        } else {
            // Filtered data before raw, the first of these.
            let imus = self.free().filter(|seen| match &seen.view {
                Some(View::Imu(imu)) => imu.angular_rate.is_some(),
                _ => false,
            });
            imus.min_by_key(|seen| words(&seen.channel.topic).any(|word| word == "raw"))
        };
        let Some((seen, Some(View::Imu(imu)))) = seen.map(|seen| (seen, &seen.view)) else {
            return Ok(());
        };
        let (up, by) = self.up(seen, imu);
        let usable = imu
            .angular_rate_trust
            .iter()
            .zip(up)
            .all(|(trust, u)| u.abs() < 0.1 || *trust != Trust::DoNotUse);
        if imu.angular_rate.is_none() || !usable {
            let what = format!(
                "`{}` says by its covariance that its rate about the vertical is not to be used",
                seen.channel.topic
            );
            self.choice.notes.push(what);
            return Ok(());
        }
        let word = format!("yaw rate about its {} ({by})", direction(up));
        let align = self.topics.align_clock;
        let chosen = self.take(seen, Job::YawRate(up), word, [(Meaning::YawRate, None)]);
        chosen.align = align;
        Ok(())
    }

    /// Which way is up for an IMU, and what tells it.
    fn up(&mut self, seen: &Seen, imu: &Imu) -> ([f64; 3], &'static str) {
        let topic = &seen.channel.topic;
        if let Some(up) = self.topics.imu_up {
            return (up, "by the robot file");
        }
        let by_transforms = up_by_transforms(&self.peek.transforms, &imu.frame);
        match (by_transforms, seen.accelerations.up()) {
            (Some(up), None) => (up, "by its transforms"),
            (Some(up), Some(gravity)) if agree(up, gravity) => (up, "by its transforms"),
            (Some(up), Some(gravity)) => {
                self.choice.notes.push(format!(
                    "the transforms of `{topic}` say that {} points up, but gravity says {}: gravity is \
                     believed (`imu_up` in the robot file decides)",
                    direction(up),
                    direction(gravity)
                ));
                (gravity, "by gravity")
            }
            (None, Some(gravity)) => (gravity, "by gravity"),
            (None, None) => {
                self.choice.notes.push(format!(
                    "neither transforms nor gravity tell how the IMU of `{topic}` is mounted: its z axis \
                     is taken to point up (`imu_up` in the robot file decides)"
                ));
                ([0.0, 0.0, 1.0], "taken to point up")
            }
        }
    }

    fn motion(&mut self) -> Result<()> {
        if let Some(name) = &self.topics.pose {
            let seen = self.named("pose", name)?;
            if !matches!(seen.view, Some(View::Odometry(_) | View::Pose { .. })) {
                let wanted = "nav_msgs/Odometry or geometry_msgs/PoseStamped";
                return Err(self.unfit("pose", seen, wanted));
            }
            self.take(seen, Job::Pose, "pose", POSE);
        }
        if let Some(name) = &self.topics.speed {
            let seen = self.named("speed", name)?;
            if !matches!(seen.view, Some(View::Odometry(_) | View::Twist { .. })) {
                let wanted = "nav_msgs/Odometry or geometry_msgs/TwistStamped";
                return Err(self.unfit("speed", seen, wanted));
            }
            self.take(seen, Job::Speed, "speed over ground", SPEED);
        }
        let free: Vec<&Seen> = self.free().collect();
        let first = |fits: fn(&View, &str) -> bool| {
            let mut all = free.iter();
            all.find(|seen| {
                let view = seen.view.as_ref();
                view.is_some_and(|view| fits(view, &seen.channel.topic))
            })
            .copied()
        };
        if !self.measures(Meaning::DisplacementForward)
            && let Some(seen) = first(|view, _| matches!(view, View::Displacement { .. }))
        {
            self.take(seen, Job::Displacement, "way since the last message", WAY);
        }
        if !self.measures(Meaning::PoseX)
            && let Some(seen) = first(|view, topic| match view {
                View::Odometry(_) => is_over_ground(topic),
                View::Pose { .. } => !words(topic).any(|word| word == "goal"),
                _ => false,
            })
        {
            self.take(seen, Job::Pose, "pose", POSE);
        }
        if !self.measures(Meaning::SpeedForward)
            && let Some(seen) = first(|view, topic| {
                matches!(view, View::Odometry(_) | View::Twist { .. })
                    && is_over_ground(topic)
                    && !words(topic).any(|word| word == "cmd")
            })
        {
            self.take(seen, Job::Speed, "speed over ground", SPEED);
        }
        Ok(())
    }

    fn command(&mut self) -> Result<()> {
        let seen = if let Some(name) = &self.topics.command {
            let seen = self.named("command", name)?;
            if !matches!(seen.view, Some(View::Twist { .. })) {
                let wanted = "geometry_msgs/Twist or TwistStamped";
                return Err(self.unfit("command", seen, wanted));
            }
            Some(seen)
        } else if self.measures(Meaning::CommandForward) {
            None
        } else {
            self.free().find(|seen| {
                matches!(seen.view, Some(View::Twist { .. }))
                    && words(&seen.channel.topic).any(|word| word == "cmd" || word == "command")
            })
        };
        if let Some(seen) = seen {
            self.take(seen, Job::Command, "commanded speed", COMMAND);
        }
        Ok(())
    }

    /// Odometry that says nothing of where it comes from is not believed to measure the ground: most is
    /// made of the wheels, and would show no slip.
    fn say_unused(&mut self) {
        let unused = self.free().filter(|seen| {
            matches!(seen.view, Some(View::Odometry(_)))
                && !self
                    .choice
                    .topics
                    .iter()
                    .any(|c| c.topic == seen.channel.topic)
        });
        let notes: Vec<String> = unused
            .map(|seen| {
                format!(
                    "`{}` is not used: name it in `[topics]` of the robot file as `pose` or `speed` if it \
                     measures the ground, as `wheel_odometry` if it was made of the wheels, or under `ignore`",
                    seen.channel.topic
                )
            })
            .collect();
        self.choice.notes.extend(notes);
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

const POSE: [(Meaning, Option<usize>); 3] = [
    (Meaning::PoseX, None),
    (Meaning::PoseY, None),
    (Meaning::PoseYaw, None),
];
const SPEED: [(Meaning, Option<usize>); 2] =
    [(Meaning::SpeedForward, None), (Meaning::SpeedLeft, None)];
const COMMAND: [(Meaning, Option<usize>); 2] = [
    (Meaning::CommandForward, None),
    (Meaning::CommandLeft, None),
];
const WAY: [(Meaning, Option<usize>); 2] = [
    (Meaning::DisplacementForward, None),
    (Meaning::DisplacementLeft, None),
];

/// The joint whose name is the wheel's, the words `joint`, `wheel` and `link` aside: `front_left` is
/// `front_left_wheel_joint`. Two such joints are none.
fn joint_by_name<'a>(wheel: &str, joints: impl Iterator<Item = &'a String>) -> Option<String> {
    let core = |name: &str| -> Vec<String> {
        words(name)
            .filter(|word| !matches!(word.as_str(), "joint" | "wheel" | "link"))
            .collect()
    };
    let own = core(wheel);
    let mut alike = Vec::new();
    for joint in joints {
        if joint == wheel {
            return Some(joint.clone());
        }
        if !own.is_empty() && core(joint) == own {
            alike.push(joint);
        }
    }
    match alike.as_slice() {
        [one] => Some((*one).clone()),
        _ => None,
    }
}

/// A direction in words: an axis, or its three parts.
fn direction(up: [f64; 3]) -> String {
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        if up[axis].abs() > 0.9999 {
            let sign = if up[axis] < 0.0 { "-" } else { "" };
            return format!("{sign}{name} axis");
        }
    }
    format!("direction ({:.3}, {:.3}, {:.3})", up[0], up[1], up[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_are_found_by_the_wheels_names() {
        let joints = ["front_left_wheel_joint", "front_right_wheel_joint", "arm"].map(String::from);
        let found = |wheel| joint_by_name(wheel, joints.iter());
        assert_eq!(found("front_left").unwrap(), "front_left_wheel_joint");
        assert_eq!(found("arm").unwrap(), "arm");
        assert_eq!(found("left"), None);
        assert_eq!(found("wheel"), None);
        let twice = ["left_joint", "left_wheel"].map(String::from);
        assert_eq!(joint_by_name("left", twice.iter()), None);
    }

    #[test]
    fn only_names_that_say_so_are_of_the_ground() {
        assert!(is_over_ground("/camera/odom/sample"));
        assert!(is_over_ground("/vicon/jackal"));
        for wheels in [
            "/odom",
            "/jackal_velocity_controller/odom",
            "/odometry/filtered",
        ] {
            assert!(!is_over_ground(wheels), "{wheels}");
        }
    }
}
