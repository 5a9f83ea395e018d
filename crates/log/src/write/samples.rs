//! Samples as messages of ROS 2: a table becomes an MCAP file.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};

use grouser_slip::{Measurement, MeasurementKind, Sample};

use super::{McapWriter, Topic};
use crate::message::{Value, build, known};

/// Topic and type of each kind of message.
const TICKS: (&str, &str) = ("/wheel_ticks", known::WHEEL_TICKS);
const JOINTS: (&str, &str) = ("/joint_states", "sensor_msgs/JointState");
const CONTACTS: (&str, &str) = ("/wheel_contacts", known::JOINT_INTERFACES);
const IMU: (&str, &str) = ("/imu", "sensor_msgs/Imu");
const WAY: (&str, &str) = ("/displacement", known::DISPLACEMENT);
const POSE: (&str, &str) = ("/pose", "geometry_msgs/PoseStamped");
const SPEED: (&str, &str) = ("/ground_speed", "geometry_msgs/TwistStamped");
const COMMAND: (&str, &str) = ("/cmd_vel", "geometry_msgs/TwistStamped");

/// Writes samples as messages: counters as `grouser_msgs/WheelTicks`, angles and rates as
/// `sensor_msgs/JointState` with the wheels' names as joints (torques as their efforts), sinkages and entry angles as state
/// interfaces of `control_msgs/DynamicJointState`, yaw rate and acceleration as
/// `sensor_msgs/Imu`, a pose as
/// `geometry_msgs/PoseStamped`, speed over ground and command as `geometry_msgs/TwistStamped`, ways as
/// `grouser_msgs/Displacement`. Wheels of one time share one message.
///
/// Read again, the log is the same, but that a speed to the left that was not measured is 0.
///
/// ```
/// use grouser_log::write::SampleWriter;
/// use grouser_slip::{Measurement, Sample};
///
/// let mut writer = SampleWriter::new(Vec::new(), &["left".to_owned()])?;
/// for step in 0..10 {
///     let measurement = Measurement::WheelCount { wheel: 0, raw: 12 * step };
///     writer.sample(&Sample { time_ns: 20_000_000 * step as i64, measurement })?;
/// }
/// let (_, messages) = writer.finish()?;
/// assert_eq!(messages, 10);
/// # Ok::<(), std::io::Error>(())
/// ```
pub struct SampleWriter<W: Write> {
    writer: McapWriter<W>,
    topics: BTreeMap<&'static str, Topic>,
    wheels: Vec<String>,
    group: Vec<Sample>,
    messages: u64,
    unwritten: BTreeSet<MeasurementKind>,
}

impl<W: Write> SampleWriter<W> {
    /// Begins a file; `wheels` are the names to which samples refer.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn new(out: W, wheels: &[String]) -> io::Result<Self> {
        Ok(Self {
            writer: McapWriter::new(out, "ros2")?,
            topics: BTreeMap::new(),
            wheels: wheels.to_vec(),
            group: Vec::new(),
            messages: 0,
            unwritten: BTreeSet::new(),
        })
    }

    /// Writes a sample, not earlier than those before.
    ///
    /// # Errors
    /// What the system refuses; `InvalidInput` for times before 1970.
    pub fn sample(&mut self, sample: &Sample) -> io::Result<()> {
        let follows = |other: &Sample| {
            let (a, b) = (&other.measurement, &sample.measurement);
            let same_kind = std::mem::discriminant(a) == std::mem::discriminant(b);
            other.time_ns != sample.time_ns || (same_kind && a.wheel() == b.wheel())
        };
        // A sensor that has two samples of one time gets two messages.
        if self.group.iter().any(follows) {
            self.flush()?;
        }
        self.group.push(*sample);
        Ok(())
    }

    /// The kinds that no message of these types has, of which samples came: they are not in the file.
    #[must_use]
    pub const fn unwritten(&self) -> &BTreeSet<MeasurementKind> {
        &self.unwritten
    }

    /// Ends the file; gives it with the number of its messages.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn finish(mut self) -> io::Result<(W, u64)> {
        self.flush()?;
        Ok((self.writer.finish()?, self.messages))
    }

    fn flush(&mut self) -> io::Result<()> {
        let group = std::mem::take(&mut self.group);
        let Some(time_ns) = group.first().map(|sample| sample.time_ns) else {
            return Ok(());
        };
        let header = || build::header(time_ns, "base_link");
        let (mut ticks, mut joints) = (Vec::new(), [const { Vec::new() }; 3]);
        let mut contacts: BTreeMap<usize, [Option<f64>; 3]> = BTreeMap::new();
        let (mut yaw_rate, mut acceleration) = (None, None);
        for sample in &group {
            match sample.measurement {
                Measurement::WheelCount { wheel, raw } => ticks.push((wheel, raw)),
                Measurement::WheelAngle { wheel, angle } => joints[0].push((wheel, angle)),
                Measurement::WheelRate { wheel, rate } => joints[1].push((wheel, rate)),
                Measurement::WheelTorque { wheel, torque } => joints[2].push((wheel, torque)),
                Measurement::Sinkage { wheel, depth } => {
                    contacts.entry(wheel).or_default()[0] = Some(depth);
                }
                Measurement::EntryAngle { wheel, angle } => {
                    contacts.entry(wheel).or_default()[1] = Some(angle);
                }
                Measurement::WheelEdge { wheel, forward } => {
                    let direction = if forward { 1.0 } else { -1.0 };
                    contacts.entry(wheel).or_default()[2] = Some(direction);
                }
                Measurement::YawRate { rate } => yaw_rate = Some(rate),
                Measurement::Acceleration { forward, left } => acceleration = Some([forward, left]),
                Measurement::Displacement {
                    forward,
                    left,
                    turn,
                } => {
                    let value = build::displacement(header(), forward, left, turn);
                    self.send(WAY, time_ns, &value)?;
                }
                Measurement::Pose { x, y, yaw } => {
                    let pose = build::pose(x, y, yaw);
                    let value = build::message([("header", header()), ("pose", pose)]);
                    self.send(POSE, time_ns, &value)?;
                }
                Measurement::Speed { forward, left } => {
                    let linear = [forward, left.unwrap_or(0.0), 0.0];
                    let value = build::twist_stamped(header(), linear, [0.0; 3]);
                    self.send(SPEED, time_ns, &value)?;
                }
                Measurement::Command { forward, left } => {
                    let linear = [forward, left, 0.0];
                    let value = build::twist_stamped(header(), linear, [0.0; 3]);
                    self.send(COMMAND, time_ns, &value)?;
                }
                Measurement::Position { .. }
                | Measurement::Inertial { .. }
                | Measurement::JointAngle { .. }
                | Measurement::SteeringAngle { .. }
                | Measurement::Steering { .. }
                | Measurement::MotorCurrent { .. }
                | Measurement::Carrier { .. } => {
                    self.unwritten.insert(sample.measurement.kind());
                }
            }
        }
        if yaw_rate.is_some() || acceleration.is_some() {
            let value = build::planar_imu(header(), yaw_rate, acceleration);
            self.send(IMU, time_ns, &value)?;
        }
        if !ticks.is_empty() {
            let (wheels, raw): (Vec<usize>, Vec<u64>) = ticks.into_iter().unzip();
            let value = build::wheel_ticks(header(), &self.names(&wheels), &raw);
            self.send(TICKS, time_ns, &value)?;
        }
        if !contacts.is_empty() {
            let (wheels, values): (Vec<usize>, Vec<_>) = contacts.into_iter().unzip();
            let value = build::wheel_contacts(header(), &self.names(&wheels), &values);
            self.send(CONTACTS, time_ns, &value)?;
        }
        // An array of a JointState holds all of its joints, or none: what is measured of the same wheels shares one.
        while let Some(first) = joints.iter().find(|part| !part.is_empty()) {
            let wheels: Vec<usize> = first.iter().map(|(wheel, _)| *wheel).collect();
            let states = joints.each_mut().map(|part| {
                let alike = part.iter().map(|(wheel, _)| wheel).eq(&wheels);
                let taken = if alike {
                    std::mem::take(part)
                } else {
                    Vec::new()
                };
                taken
                    .into_iter()
                    .map(|(_, value)| value)
                    .collect::<Vec<f64>>()
            });
            let value = build::joint_state(
                header(),
                &self.names(&wheels),
                states.each_ref().map(Vec::as_slice),
            );
            self.send(JOINTS, time_ns, &value)?;
        }
        Ok(())
    }

    fn names(&self, wheels: &[usize]) -> Vec<&str> {
        let names = wheels.iter().map(|wheel| self.wheels.get(*wheel));
        names.map(|name| name.map_or("", String::as_str)).collect()
    }

    fn send(
        &mut self,
        (name, type_name): (&'static str, &'static str),
        time_ns: i64,
        value: &Value,
    ) -> io::Result<()> {
        let topic = match self.topics.entry(name) {
            std::collections::btree_map::Entry::Occupied(known) => known.into_mut(),
            std::collections::btree_map::Entry::Vacant(new) => {
                new.insert(self.writer.topic(name, type_name)?)
            }
        };
        self.messages += 1;
        self.writer.send(topic, time_ns, value)
    }
}
