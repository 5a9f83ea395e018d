//! Which topic is the inertial unit, and how it is mounted: yaw rate and acceleration.

use grouser_files::columns::Meaning;

use super::names::{has_word, other_words};
use super::{Choosing, Job, TopicPreview};
use crate::error::Result;
use crate::message::{Imu, Trust, View};
use crate::recording::mounting::{agree, axes_by_file, axes_by_transforms, has_frame};

impl Choosing<'_> {
    pub(super) fn yaw_rate(&mut self) -> Result<()> {
        let seen = if let Some(name) = &self.topics.yaw_rate {
            let seen = self.named("yaw_rate", name)?;
            if !matches!(seen.view(), Some(View::Imu(_))) {
                return Err(self.unfit("yaw_rate", seen, "sensor_msgs/Imu"));
            }
            Some(seen)
        } else if self.measures(Meaning::YawRate) {
            None
        } else {
            let imus = self
                .free_or_of_fields()
                .into_iter()
                .filter(|seen| match seen.view() {
                    Some(View::Imu(imu)) => imu.angular_rate.is_some(),
                    _ => false,
                });
            self.of_several_imus(&imus.collect::<Vec<_>>())
        };
        let Some((seen, Some(View::Imu(imu)))) = seen.map(|seen| (seen, seen.view())) else {
            return Ok(());
        };
        let (up, by) = self.up(seen, &imu);
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
        let chosen = self.take(seen, Job::YawRate(up), &word, &[(Meaning::YawRate, None)]);
        chosen.align = align;
        self.acceleration(seen, &imu, up);
        Ok(())
    }

    /// The one in the namespace of the wheels, filtered data before raw, the first of these; others are noted.
    fn of_several_imus<'t>(&mut self, imus: &[&'t TopicPreview]) -> Option<&'t TopicPreview> {
        let wheels = self.wheel_topic().unwrap_or_default();
        let is_raw = |topic: &str| has_word(topic, &["raw"]);
        let apart = |seen: &&&TopicPreview| {
            let topic = &seen.channel.topic;
            (
                std::cmp::Reverse(shared_namespace(wheels, topic)),
                is_raw(topic),
            )
        };
        let own = *imus.iter().min_by_key(apart)?;
        // the same sensor before and after a filter
        let sensor = |topic: &str| other_words(topic, &["raw", "data", "filtered"]);
        let own_topic = &own.channel.topic;
        let others = imus.iter().map(|seen| &seen.channel.topic);
        let others = others.filter(|topic| sensor(topic) != sensor(own_topic));
        let others: Vec<String> = others.map(|topic| format!("`{topic}`")).collect();
        if !others.is_empty() {
            self.choice.notes.push(format!(
                "the yaw rate is that of `{own_topic}`, not of {}: `yaw_rate` in `[topics]` of the robot file decides",
                others.join(", ")
            ));
        }
        Some(own)
    }

    /// The acceleration, where the robot file or transforms give the forward axis and neither gravity nor covariances
    /// contradict it.
    fn acceleration(&mut self, seen: &TopicPreview, imu: &Imu<'_>, up: [f64; 3]) {
        let axes = match self.topics.imu_forward {
            Some(forward) => axes_by_file(forward, up),
            None => axes_by_transforms(&self.tree, imu.frame).filter(|axes| agree(axes[2], up)),
        };
        let Some([forward, left, level]) = axes else {
            // Drivers without an accelerometer leave zeros.
            if seen.accelerations.up().is_some() {
                let topic = &seen.channel.topic;
                let why = match self.topics.imu_forward {
                    Some(_) => "`imu_forward` in the robot file is not level",
                    None => {
                        "no transforms give its forward axis (`imu_forward` in the robot file does)"
                    }
                };
                let tree = &self.tree;
                let lost = match self.topics.imu_forward {
                    None if !tree.is_empty() && !has_frame(tree, imu.frame) => {
                        format!("no transform holds its frame `{}`; ", imu.frame)
                    }
                    _ => String::new(),
                };
                self.choice.notes.push(format!(
                    "the accelerations of `{topic}` are not used: {lost}{why}"
                ));
            }
            return;
        };
        let unusable = |axis: usize| imu.acceleration_trust[axis] == Trust::DoNotUse;
        let along = |direction: [f64; 3]| (0..3).filter(move |axis| direction[*axis].abs() > 0.1);
        let mut needed = along(forward).chain(along(left));
        let planar = along(up).any(unusable);
        let is_measured = planar
            || seen
                .accelerations
                .up()
                .is_some_and(|gravity| agree(gravity, up));
        if imu.acceleration.is_none() || needed.any(unusable) || !is_measured {
            return;
        }
        if self.topics.suspension.is_some() && !planar {
            let axes = [forward, left, level];
            self.take(seen, Job::Inertial(axes), "attitude", &[]);
        }
        let measures = [Meaning::AccelerationForward, Meaning::AccelerationLeft];
        self.take(
            seen,
            Job::Acceleration([forward, left]),
            "acceleration",
            &measures.map(|meaning| (meaning, None)),
        );
    }

    /// The direction that points up in an IMU's frame, and its source in words.
    fn up(&mut self, seen: &TopicPreview, imu: &Imu<'_>) -> ([f64; 3], &'static str) {
        let topic = &seen.channel.topic;
        if let Some(up) = self.topics.imu_up {
            return (up, "by the robot file");
        }
        let axes = axes_by_transforms(&self.tree, imu.frame);
        let by_transforms = axes.map(|[_, _, up]| up);
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
                if let Some(up) = only_usable(imu) {
                    return (up, "the only one to be used");
                }
                self.choice.notes.push(format!(
                    "neither transforms nor gravity tell how the IMU of `{topic}` is mounted: its z axis \
                     is taken to point up (`imu_up` in the robot file decides)"
                ));
                ([0.0, 0.0, 1.0], "taken to point up")
            }
        }
    }
}

/// In how many parts the namespaces of two topics agree, from the first on.
fn shared_namespace(a: &str, b: &str) -> usize {
    let parts = |topic: &str| -> Vec<String> {
        let namespace = topic.trim_start_matches('/').rsplit_once('/');
        namespace.map_or(Vec::new(), |(namespace, _)| {
            namespace.split('/').map(str::to_owned).collect()
        })
    };
    let (a, b) = (parts(a), parts(b));
    a.iter().zip(&b).take_while(|(a, b)| a == b).count()
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

/// The axis of a gyro that gives one rate alone, by its covariances: a robot's is its yaw rate.
fn only_usable(imu: &Imu<'_>) -> Option<[f64; 3]> {
    let usable = imu
        .angular_rate_trust
        .map(|trust| f64::from(u8::from(trust != Trust::DoNotUse)));
    (usable.iter().sum::<f64>() == 1.0).then_some(usable)
}
