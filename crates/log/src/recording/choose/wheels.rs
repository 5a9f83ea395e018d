//! Which topics measure the wheels.

use grouser_files::columns::Meaning;
use grouser_files::topics::{Topics, WheelOdometry};

use super::names::joint_by_name;
use super::{Choosing, Job, TopicPreview};
use crate::error::{Error, Result};
use crate::message::View;
use crate::slots::{Slots, measured};
use crate::wrapped_angles::Angle;

impl<'a> Choosing<'a> {
    pub(super) fn fields(&mut self) -> Result<()> {
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
                .map(|field| (measured(&topic.fields, field), wheel_of(&field.wheel)))
                .collect();
            let slots = Slots::new(&topic.fields, &self.choice.wheels);
            let gives_fixes = slots.gives_fixes();
            if slots.gives_places() && !gives_fixes {
                self.place_sigma(&topic.topic);
            }
            let paths = topic.fields.iter().map(|f| f.column.clone()).collect();
            let job = Job::Fields(slots, paths);
            if gives_fixes {
                self.field_fixes(seen, &job);
            }
            self.take(seen, job, "fields", &measures);
        }
        Ok(())
    }

    pub(super) fn wheels(&mut self) -> Result<()> {
        let topics = self.topics;
        let joints_of =
            |seen: &TopicPreview| joints_in(topics, &seen.joints.keys().collect::<Vec<_>>());
        let mut found = Vec::new();
        if let Some(name) = &self.topics.wheels {
            let seen = self.named("wheels", name)?;
            if joints_of(seen).is_empty() {
                return Err(Error::NoJoints {
                    file: self.file.to_owned(),
                    topic: name.clone(),
                    joints: seen.joints.keys().cloned().collect::<Vec<_>>().join(", "),
                });
            }
            found.push(seen);
        } else if !self.measures_wheels() {
            // Of counters and of joints the one with the most wheels, the first of these: the wheels' sensor
            // is chosen among all that was measured.
            let best = |free: &[&'a TopicPreview], wanted| {
                let free = free.iter().filter(|seen| is_ticks(seen) == wanted);
                let all = free.map(|seen| (joints_of(seen).len(), *seen));
                let all = all.filter(|(count, _)| *count > 0);
                let best = all.reduce(|a, b| if b.0 > a.0 { b } else { a });
                best.map(|(_, seen)| seen)
            };
            for free in [self.free(), self.free_or_of_fields()] {
                if found.is_empty() {
                    found.extend(
                        [true, false]
                            .into_iter()
                            .filter_map(|wanted| best(&free, wanted)),
                    );
                }
            }
        }
        if let Some(own) = found.first() {
            self.find_other_robots(own);
        }
        for seen in found {
            let joints = joints_of(seen);
            let (mut measures, mut unmeasured) = (Vec::new(), Vec::new());
            for (name, wheel) in &joints {
                let [positions, velocities] = seen.joints.get(name).copied().unwrap_or_default();
                let has = [
                    (is_ticks(seen), Meaning::WheelCount),
                    (positions.are_measured(&velocities), Meaning::WheelAngle),
                    (velocities.are_measured(&positions), Meaning::WheelRate),
                ];
                for (are_sent, has, what, other) in [
                    (positions.are_sent(), has[1].0, "positions", "velocities"),
                    (velocities.are_sent(), has[2].0, "velocities", "positions"),
                ] {
                    if are_sent && !has {
                        unmeasured.push((name.clone(), what, other));
                    }
                }
                let has = has.into_iter().filter(|(has, _)| *has);
                measures.extend(has.map(|(_, meaning)| (meaning, Some(*wheel))));
            }
            if let Some((_, what, other)) = unmeasured.first() {
                let names: Vec<&str> = unmeasured.iter().map(|(name, ..)| name.as_str()).collect();
                self.choice.notes.push(format!(
                    "the {what} of {} in `{}` are no numbers, or show no motion: {other} are used",
                    names.join(", "),
                    seen.channel.topic
                ));
            }
            let wraps =
                |(name, _): &(String, usize)| seen.angles.get(name).is_some_and(Angle::wraps);
            if joints.iter().any(wraps) {
                self.choice.notes.push(format!(
                    "the positions in `{}` jump by whole turns, as angles that are kept within one: they are put together \
                     again",
                    seen.channel.topic
                ));
            }
            let word = format!("wheels by {} joints", joints.len());
            self.take(seen, Job::Joints(joints), &word, &measures);
        }
        if let Some(odometry) = &self.topics.wheel_odometry {
            self.wheel_odometry(odometry)?;
        }
        Ok(())
    }

    /// The topic with the most joints of the suspension, the first of these.
    pub(super) fn suspension(&mut self) {
        let Some(all) = &self.topics.suspension else {
            return;
        };
        let joints_of = |seen: &TopicPreview| {
            let known = all.iter().filter(|of| seen.joints.contains_key(&of.link));
            known
                .map(|of| (of.link.clone(), of.joint, of.sign))
                .collect::<Vec<_>>()
        };
        let found = (self.free().into_iter())
            .map(|seen| (joints_of(seen), seen))
            .reduce(|a, b| if b.0.len() > a.0.len() { b } else { a });
        if let Some((joints, seen)) = found.filter(|(joints, _)| !joints.is_empty()) {
            let word = format!("angles of {} links", joints.len());
            self.take(seen, Job::Suspension(joints), &word, &[]);
        }
    }

    /// Topics of the same wheels in another namespace are another robot's, and so is all that is in there.
    fn find_other_robots(&mut self, own: &TopicPreview) {
        let wheels = joints_in(self.topics, &own.joints.keys().collect::<Vec<_>>()).len();
        let alike = self.free().into_iter().filter_map(|seen| {
            let is_alike =
                joints_in(self.topics, &seen.joints.keys().collect::<Vec<_>>()).len() == wheels;
            let other = other_namespace(&own.channel.topic, &seen.channel.topic);
            Some((seen, other?)).filter(|_| is_alike)
        });
        for (seen, other) in alike.collect::<Vec<_>>() {
            if !self.others.contains(&other) {
                self.choice.notes.push(format!(
                    "`{}` has the same wheels as `{}`: what is under `{other}` is taken for another robot's and not used, but where \
                     `[topics]` of the robot file names it",
                    seen.channel.topic, own.channel.topic
                ));
                self.others.push(other);
            }
        }
    }

    /// Sinkages, entry angles and edges: the topic that the robot file names, else each that measures some of them first.
    pub(super) fn contacts(&mut self) -> Result<()> {
        let found = if let Some(name) = &self.topics.contact {
            let seen = self.named("contact", name)?;
            if seen.contacts.is_empty() {
                const WANTED: &str =
                    "control_msgs/DynamicJointState with `sinkage`, `entry_angle` or `edge`";
                return Err(self.unfit("contact", seen, WANTED));
            }
            if self.contacts_of(seen).0.is_empty() {
                return Err(Error::NoJoints {
                    file: self.file.to_owned(),
                    topic: seen.channel.topic.clone(),
                    joints: seen.contacts.keys().cloned().collect::<Vec<_>>().join(", "),
                });
            }
            vec![seen]
        } else {
            let free = self.free().into_iter();
            free.filter(|seen| !seen.contacts.is_empty()).collect()
        };
        let mut all = Vec::new();
        for seen in found {
            let (joints, measures) = self.contacts_of(seen);
            if joints.is_empty() || measures.iter().any(|one| all.contains(one)) {
                continue;
            }
            all.extend_from_slice(&measures);
            let has_edges = |(meaning, _): &(Meaning, _)| *meaning == Meaning::WheelEdge;
            let word = if measures.iter().all(has_edges) {
                format!("encoder edges of {} wheels", joints.len())
            } else {
                format!("sinkages or entry angles of {} wheels", joints.len())
            };
            self.take(seen, Job::Contacts(joints), &word, &measures);
        }
        Ok(())
    }

    /// The wheels of a topic of contacts by joint, and what it measures of each.
    #[allow(clippy::type_complexity, reason = "what `take` takes")]
    fn contacts_of(
        &self,
        seen: &TopicPreview,
    ) -> (Vec<(String, usize)>, Vec<(Meaning, Option<usize>)>) {
        let joints = joints_in(self.topics, &seen.contacts.keys().collect::<Vec<_>>());
        let mut measures = Vec::new();
        for (name, wheel) in &joints {
            let has = seen.contacts.get(name).copied().unwrap_or_default();
            let meanings = [Meaning::Sinkage, Meaning::EntryAngle, Meaning::WheelEdge];
            let has = meanings.into_iter().zip(has).filter(|(_, has)| *has);
            measures.extend(has.map(|(meaning, _)| (meaning, Some(*wheel))));
        }
        (joints, measures)
    }

    fn wheel_odometry(&mut self, odometry: &WheelOdometry) -> Result<()> {
        let seen = self.named("wheel_odometry", &odometry.topic)?;
        if !matches!(seen.view(), Some(View::Odometry(_))) {
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
            &measures,
        );
        Ok(())
    }
}

/// The namespace of `other`, up to the first part in which it differs from `own`: `/r0/` of `/r0/joint_states` beside
/// `/r1/joint_states`. `None` where only their last parts differ.
fn other_namespace(own: &str, other: &str) -> Option<String> {
    let own = own.split_inclusive('/');
    let parts = other.split_inclusive('/');
    let same: String = own
        .zip(parts)
        .take_while(|(own, other)| own == other)
        .map(|(_, other)| other)
        .collect();
    let rest = &other[same.len()..];
    let end = rest.find('/')?;
    Some(format!("{same}{}", &rest[..=end]))
}

fn is_ticks(seen: &TopicPreview) -> bool {
    matches!(seen.view(), Some(View::WheelTicks { .. }))
}

/// The joints of the robot's wheels among these names.
fn joints_in(topics: &Topics, names: &[&String]) -> Vec<(String, usize)> {
    let joints = topics.joints.iter().enumerate();
    let found = joints.filter_map(|(index, wheel)| {
        let name = match &wheel.joint {
            // Logs of our own name the wheels themselves.
            Some(joint) => [joint, &wheel.wheel]
                .into_iter()
                .find(|name| names.contains(name))
                .cloned(),
            None => joint_by_name(&wheel.wheel, names),
        };
        Some((name?, index))
    });
    found.collect()
}
