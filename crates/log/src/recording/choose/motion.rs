//! The topics that measure the robot's place and speed, and the one of its command.

use grouser_files::columns::Meaning;

use super::names::{
    has_word, is_command, is_of_wheels, is_over_ground, is_unmeasured, speed_of_number,
};
use super::{Choosing, Job, TopicPreview};
use crate::error::{Error, Result};
use crate::message::{View, short};
use crate::recording::frames::{FramePair, FramePose, is_static, poses, prefix};
use crate::recording::mounting::Base;
use crate::recording::navigation::{FixColumns, UNSTATED_SIGMA_M, place_sigma};

/// Words in the name of a topic whose velocity is to the east, north and up, as satellite receivers send it.
const ON_EARTH: &[&str] = &["gps", "gnss", "fix", "navsat", "ublox"];

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
const WAY: [(Meaning, Option<usize>); 3] = [
    (Meaning::DisplacementForward, None),
    (Meaning::DisplacementLeft, None),
    (Meaning::DisplacementTurn, None),
];

impl Choosing<'_> {
    pub(super) fn motion(&mut self) -> Result<()> {
        self.named_motion()?;
        self.free_motion();
        Ok(())
    }

    /// What the robot file names.
    fn named_motion(&mut self) -> Result<()> {
        if let Some(name) = &self.topics.pose {
            let seen = self.named("pose", name)?;
            match seen.view() {
                Some(View::Odometry(_) | View::Pose { .. }) => self.pose(seen),
                Some(View::Point(_)) => self.places(seen),
                Some(View::Transforms(_)) => self.named_transforms(seen)?,
                _ => {
                    let wanted = "nav_msgs/Odometry, tf2_msgs/TFMessage or, of geometry_msgs, PoseStamped, \
                                  PoseWithCovarianceStamped, TransformStamped or PointStamped";
                    return Err(self.unfit("pose", seen, wanted));
                }
            }
            let frames = [&self.topics.pose_frame, &self.topics.pose_child_frame];
            if frames.into_iter().any(Option::is_some) && self.choice.frame_pose.is_none() {
                return Err(self.unfit("pose_frame", seen, "tf2_msgs/TFMessage"));
            }
        }
        if let Some(name) = &self.topics.speed {
            let seen = self.named("speed", name)?;
            if !matches!(seen.view(), Some(View::Odometry(_) | View::Twist { .. })) {
                let wanted =
                    "nav_msgs/Odometry or geometry_msgs/TwistStamped or TwistWithCovarianceStamped";
                return Err(self.unfit("speed", seen, wanted));
            }
            self.speed(seen);
        }
        if let Some(name) = &self.topics.fix {
            let seen = self.named("fix", name)?;
            if !matches!(seen.view(), Some(View::NavSatFix(_))) {
                return Err(self.unfit("fix", seen, "sensor_msgs/NavSatFix"));
            }
            self.fixes(Some(seen));
        }
        Ok(())
    }

    /// What is chosen by type and name.
    fn free_motion(&mut self) {
        let free = self.free_or_of_fields();
        let first = |fits: fn(&View, &str) -> bool| {
            let mut all = free.iter();
            all.find(|seen| {
                let view = seen.view();
                view.is_some_and(|view| fits(&view, &seen.channel.topic))
            })
            .copied()
        };
        let pose_of = |type_name: &str, fits: fn(&str) -> bool| {
            let mut all = free.iter();
            all.find(|seen| {
                let (own, topic) = (short(&seen.channel.type_name), &seen.channel.topic);
                seen.view().is_some() && own == type_name && !is_unmeasured(topic) && fits(topic)
            })
            .copied()
        };
        if !self.measures(Meaning::DisplacementForward)
            && let Some(seen) = first(|view, _| matches!(view, View::Displacement { .. }))
        {
            self.take(seen, Job::Displacement, "displacement", &WAY);
        }
        if !self.measures(Meaning::PoseX)
            && let Some(seen) = free
                .iter()
                .find(|seen| match seen.view() {
                    Some(View::Odometry(_)) => is_over_ground(&seen.channel.topic),
                    Some(View::Pose { .. }) => {
                        short(&seen.channel.type_name) == "geometry_msgs/PoseStamped"
                            && !is_unmeasured(&seen.channel.topic)
                    }
                    _ => false,
                })
                .copied()
                .or_else(|| {
                    let type_name = "geometry_msgs/PoseWithCovarianceStamped";
                    pose_of(type_name, |topic| !is_of_wheels(topic))
                })
                .or_else(|| pose_of("geometry_msgs/TransformStamped", is_over_ground))
        {
            self.pose(seen);
        }
        if !self.measures(Meaning::DisplacementForward) && !self.measures(Meaning::PoseX) {
            let place = first(|view, topic| {
                matches!(view, View::Point(_)) && !is_unmeasured(topic) && is_over_ground(topic)
            });
            match place {
                Some(seen) => self.places(seen),
                None => self.fixes(first(|view, _| matches!(view, View::NavSatFix(_)))),
            }
        }
        self.free_transforms();
        if self.choice.antenna != [0.0; 2]
            && self.choice.position_sigma.is_some()
            && !self.measures(Meaning::YawRate)
        {
            self.choice.notes.push(
                "the antenna is not above the robot's origin and no yaw rate is measured: its motion in turns is not \
                 corrected"
                    .to_owned(),
            );
        }
        if !self.measures_speed()
            && let Some(seen) = first(|view, topic| {
                matches!(view, View::Odometry(_) | View::Twist { .. })
                    && is_over_ground(topic)
                    && !has_word(topic, &["cmd"])
            })
        {
            let is_twist = matches!(seen.view(), Some(View::Twist { .. }));
            if is_twist && has_word(&seen.channel.topic, ON_EARTH) {
                let word = "size of the speed over ground, to the east and north";
                self.take(seen, Job::SpeedOnEarth, word, &[(Meaning::SpeedSize, None)]);
            } else {
                self.speed(seen);
            }
        }
    }

    /// The base in the frame that a topic's messages name at `path`, where the transforms lead to it and the robot file does not
    /// state the mounting; and that frame.
    fn base(&self, seen: &TopicPreview, path: &str) -> Option<(Base, String)> {
        let frame = seen.sample.as_ref()?.at(path)?.text()?;
        let base = Base::of(&self.tree, frame).filter(|_| !self.topics.is_mounting_stated)?;
        Some((base, frame.to_owned()))
    }

    /// A speed; that of a sensor's frame is along the robot's axes by the transforms that never change.
    fn speed(&mut self, seen: &TopicPreview) {
        let path = match seen.view() {
            Some(View::Odometry(_)) => "child_frame_id",
            _ => "header.frame_id",
        };
        let (base, word) = of_frame("speed over ground", self.base(seen, path));
        if let Some(base) = &base {
            self.choice.speed_place = [base.place[0], base.place[1]];
        }
        self.take(seen, Job::Speed(base), &word, &SPEED);
    }

    /// A pose; that of a sensor's frame becomes the robot's by the transforms that never change.
    fn pose(&mut self, seen: &TopicPreview) {
        let (base, word) = of_frame("pose", self.base(seen, "child_frame_id"));
        self.take(seen, Job::Pose(base), &word, &POSE);
    }

    /// Places without a heading.
    fn places(&mut self, seen: &TopicPreview) {
        self.place_sigma(&seen.channel.topic);
        self.take(
            seen,
            Job::Place,
            "displacement between positions",
            &WAY[..2],
        );
    }

    /// How accurate places without a heading are.
    pub(super) fn place_sigma(&mut self, topic: &str) {
        let (sigma, note) = place_sigma(topic, self.topics);
        self.choice.position_sigma = Some(sigma);
        self.choice.notes.extend(note);
    }

    /// How accurate the fixes in the numbers of a message are, by the first of them.
    pub(super) fn field_fixes(&mut self, seen: &TopicPreview, job: &Job) {
        let mut fixes = FixColumns::new(self.topics.position_sigma);
        let mut fix = |fix| fixes.place(fix).ok();
        if let Some(value) = &seen.sample {
            job.measurements(None, value, &mut fix, &mut |_| ());
        }
        let (found, note) = fixes.seen.choose(&seen.channel.topic);
        let sigma = found.map(|(sigma, _)| sigma).or(self.topics.position_sigma);
        self.choice.position_sigma = Some(sigma.unwrap_or(UNSTATED_SIGMA_M));
        self.choice.notes.extend(note.filter(|_| found.is_some()));
    }

    /// Fixes of a satellite receiver, with their accuracy where it is poor.
    fn fixes(&mut self, seen: Option<&TopicPreview>) {
        let Some(seen) = seen else {
            return;
        };
        let (sigma, note) = seen.fixes.choose(&seen.channel.topic);
        self.choice.notes.extend(note);
        let Some((sigma, limit)) = sigma else {
            return;
        };
        let base = self.base(seen, "header.frame_id");
        let base = base.filter(|_| self.topics.antenna == [0.0; 2]);
        let (base, word) = of_frame("displacement between fixes", base);
        if let Some(base) = base {
            self.choice.antenna = [base.place[0], base.place[1]];
        }
        self.take(seen, Job::Fix(limit), &word, &WAY[..2]);
        self.choice.position_sigma = Some(sigma);
    }

    pub(super) fn command(&mut self) -> Result<()> {
        let seen = if let Some(name) = &self.topics.command {
            let seen = self.named("command", name)?;
            if !matches!(seen.view(), Some(View::Twist { .. })) {
                let wanted = "geometry_msgs/Twist or TwistStamped";
                return Err(self.unfit("command", seen, wanted));
            }
            Some(seen)
        } else if self.measures(Meaning::CommandForward) {
            None
        } else {
            self.free().into_iter().find(|seen| {
                matches!(seen.view(), Some(View::Twist { .. })) && is_command(&seen.channel.topic)
            })
        };
        if let Some(seen) = seen {
            self.take(seen, Job::Command, "commanded speed", &COMMAND);
        }
        Ok(())
    }

    /// Odometry that says nothing of where it comes from is not believed to measure the ground: most is
    /// made of the wheels, and would show no slip. Nor are poses, places and speeds whose names do not say what they are of.
    pub(super) fn say_unused(&mut self) {
        let used = &self.choice.topics;
        let unused = self
            .free()
            .into_iter()
            .filter(|seen| !used.iter().any(|chosen| chosen.topic == seen.channel.topic));
        let has_speed = self.measures_speed();
        let notes: Vec<String> = unused
            .filter_map(|seen| {
                let topic = &seen.channel.topic;
                if let Some(meaning) = speed_of_number(topic, &seen.channel.type_name).filter(|_| !has_speed) {
                    return Some(format!(
                        "`{topic}` is not used: if it is the speed over ground, `[[topics.field]]` with `topic = \"{topic}\"`, \
                         `field = \"data\"`, `meaning = \"{}\"` and `unit = \"m/s\"` reads it",
                        meaning.name()
                    ));
                }
                let keys = match seen.view()? {
                    View::Odometry(_) => {
                        "`pose` or `speed` if it measures the ground, as `wheel_odometry` if it was made of the wheels"
                    }
                    View::Pose { .. } | View::Point(_) if !is_unmeasured(topic) => {
                        "`pose` if it measures where the robot is"
                    }
                    View::Twist { .. }
                        if !is_command(topic)
                            && short(&seen.channel.type_name) != "geometry_msgs/Twist" =>
                    {
                        "`speed` if it measures the ground, as `command` if it was commanded"
                    }
                    _ => return None,
                };
                Some(format!(
                    "`{topic}` is not used: name it in `[topics]` of the robot file as {keys}, or under `ignore`"
                ))
            })
            .collect();
        self.choice.notes.extend(notes);
    }

    /// A topic of transforms that the robot file names.
    fn named_transforms(&mut self, seen: &TopicPreview) -> Result<()> {
        let topics = self.topics;
        let (fixed, base) = (
            topics.pose_frame.as_deref(),
            topics.pose_child_frame.as_deref(),
        );
        let named = |topic: usize| {
            let name = &self.preview.topics[topic].channel.topic;
            *name == seen.channel.topic || (is_static(name) && self.is_own(name))
        };
        let tree = self.preview.transforms.tree(named);
        let found = poses(&tree, fixed, base);
        let Some(pair) = self.of_this_robot(&found).cloned() else {
            return Err(Error::NoFramePose {
                file: self.file.to_owned(),
                topic: seen.channel.topic.clone(),
                poses: if found.is_empty() {
                    "no pose of the robot's frame that moves in the fixed one".to_owned()
                } else {
                    format!("several: {}", in_words(&found))
                },
            });
        };
        self.take_transforms(FramePose::new(tree, pair), Some(&seen.channel.topic));
        Ok(())
    }

    /// Where nothing else measures where the robot is: transforms of a map to the robot.
    fn free_transforms(&mut self) {
        let found = poses(&self.tree, None, None);
        let is_absolute = found.first().is_some_and(|pair| pair.is_absolute);
        let measures = |meaning| self.measures(meaning);
        if measures(Meaning::PoseX) {
            return;
        }
        let is_placed = measures(Meaning::DisplacementForward);
        let own = self.of_this_robot(&found);
        let (is, hint) = if let Some(pair) = own.filter(|_| is_absolute && !is_placed) {
            let pose = FramePose::new(self.tree.clone(), pair.clone());
            return self.take_transforms(pose, None);
        } else if is_absolute && is_placed {
            ("other positions are used", "name their topic as `pose`")
        } else if is_absolute {
            (
                "of several robots",
                "name their topic as `pose`, and the robot's as `pose_child_frame`",
            )
        } else if !found.is_empty() && !is_placed && !self.measures_speed() {
            (
                "not used",
                "name their topic as `pose` if it measures the ground; most odometry is made of the wheels",
            )
        } else {
            return;
        };
        let frames = in_words(&found);
        self.choice.notes.push(format!(
            "the transforms hold a pose ({frames}) that is {is}: {hint} in `[topics]` of the robot file"
        ));
    }

    /// Of poses by transforms the only one, or that of the robot whose wheels are measured.
    fn of_this_robot<'p>(&self, found: &'p [FramePair]) -> Option<&'p FramePair> {
        if let [one] = found {
            return Some(one);
        }
        let wheels = prefix(self.wheel_topic()?.trim_start_matches('/'));
        let mut own = found.iter().filter(|pair| {
            let prefix = prefix(&pair.base);
            prefix == wheels || wheels.ends_with(&format!("/{prefix}")) && !prefix.is_empty()
        });
        own.next().filter(|_| own.next().is_none())
    }

    /// Takes the topics of transforms of which the pose is made: the one that is named, else all, and those that never change.
    fn take_transforms(&mut self, pose: FramePose, named: Option<&String>) {
        let words = pose.words();
        self.choice.frame_pose = Some(pose);
        for seen in &self.preview.topics {
            let name = &seen.channel.topic;
            if !matches!(seen.view(), Some(View::Transforms(_))) || !self.is_own(name) {
                continue;
            }
            if is_static(name) {
                self.take(seen, Job::Transforms, "frames that do not move", &[]);
            } else if named.is_none_or(|named| named == name) {
                self.take(seen, Job::Transforms, &words, &POSE);
            }
        }
    }
}

/// What a topic measures, in words, and the base of its frame where it is another.
fn of_frame(what: &str, base: Option<(Base, String)>) -> (Option<Base>, String) {
    match base {
        Some((base, frame)) => (
            Some(base),
            format!("{what} of `{frame}`, whose mounting the transforms state"),
        ),
        None => (None, what.to_owned()),
    }
}

fn in_words(poses: &[FramePair]) -> String {
    let one = |pair: &FramePair| format!("`{}` in `{}`", pair.base, pair.fixed);
    poses.iter().map(one).collect::<Vec<_>>().join(", ")
}
