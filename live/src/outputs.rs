//! What the node publishes.

use std::io;
use std::time::Instant;

use grouser_log::container::Channel;
use grouser_log::message::{Definition, Header, MessageError, Value, build, known};
use grouser_replay::messages::{
    slip_event, wheel_statuses, write_odometry, write_transform, write_twist, write_wheel_slip,
};
use grouser_replay::{Odometry, Row, Sink, Step};
use grouser_slip::detect::Change;
use grouser_slip::{Health, Invalid, WheelEstimate};

use crate::error::Error;
use crate::recorder::Recorder;
use crate::transport::Transport;

/// Frames of the messages.
pub(crate) struct Frames {
    pub(crate) base: String,
    pub(crate) odom: String,
}

/// A topic of the node's own.
pub(crate) struct Topic {
    publisher: usize,
    channel: Channel,
    definition: Definition,
    /// The message at hand.
    pub(crate) bytes: Vec<u8>,
    record: Option<u16>,
    /// Messages that the transport did not take.
    unsent: u64,
    /// Messages that cannot be encoded, and why the first cannot.
    unencoded: (u64, Option<String>),
}

impl Topic {
    /// Announces a topic of a known type.
    pub(crate) fn announce(
        transport: &mut dyn Transport,
        topic: &str,
        type_name: &str,
    ) -> crate::Result<Self> {
        let channel = known::channel(topic, type_name).ok_or_else(|| Error::UnknownType {
            type_name: type_name.to_owned(),
        })?;
        let text = String::from_utf8_lossy(&channel.definition);
        Ok(Self {
            publisher: transport.advertise(topic, type_name)?,
            definition: Definition::parse(type_name, &text)?,
            channel,
            bytes: Vec::new(),
            record: None,
            unsent: 0,
            unencoded: (0, None),
        })
    }

    /// Encodes, publishes and records a message of named fields.
    fn send(
        &mut self,
        transport: &mut dyn Transport,
        recorder: &mut Option<Recorder>,
        time_ns: i64,
        message: &Value,
    ) {
        let encoded = self.definition.encode(message);
        let written = encoded.map(|bytes| self.bytes = bytes);
        self.send_written(transport, recorder, time_ns, written);
    }

    /// Publishes and records the message that was `written` into the bytes: has the transport taken it? One that cannot be
    /// encoded is dropped and counted. A recording that fails ends, with a warning, and the node goes on.
    pub(crate) fn send_written(
        &mut self,
        transport: &mut dyn Transport,
        recorder: &mut Option<Recorder>,
        time_ns: i64,
        written: Result<(), MessageError>,
    ) -> bool {
        if let Err(error) = written {
            self.unencoded.0 += 1;
            self.unencoded
                .1
                .get_or_insert_with(|| format!("`{}`: {error}", self.channel.topic));
            return false;
        }
        record(
            recorder,
            &mut self.record,
            &self.channel,
            u64::try_from(time_ns).unwrap_or(0),
            &self.bytes,
        );
        // a reader that does not keep up, or a transport that is busy, does not end the node: the message is lost, and counted
        let is_sent = transport.publish(self.publisher, &self.bytes).is_ok();
        self.unsent += u64::from(!is_sent);
        is_sent
    }
}

/// The topics of the node.
pub(crate) struct Outputs {
    pub(crate) transport: Box<dyn Transport>,
    pub(crate) recorder: Option<Recorder>,
    names: Vec<String>,
    frames: Frames,
    slip: Topic,
    odometry: Topic,
    twist: Topic,
    events: Topic,
    diagnostics: Topic,
    transform: Option<Topic>,
    /// What was published last.
    pub(crate) latest: Vec<WheelEstimate>,
    pub(crate) latest_ns: Option<i64>,
    /// When that was.
    pub(crate) latest_at: Option<Instant>,
    /// Forward speed of the robot with it, m/s.
    pub(crate) latest_speed: Option<f64>,
    pub(crate) last_odometry: Option<Odometry>,
    /// Events that began or ended, for the terminal.
    pub(crate) changes: Vec<Change>,
    pub(crate) steps: u64,
}

impl Outputs {
    /// Announces the topics; `name` gives a topic's full name.
    pub(crate) fn announce(
        mut transport: Box<dyn Transport>,
        names: Vec<String>,
        frames: Frames,
        publishes_tf: bool,
        name: impl Fn(&str) -> crate::Result<String>,
    ) -> crate::Result<Self> {
        let mut topic =
            |topic: String, type_name: &str| Topic::announce(transport.as_mut(), &topic, type_name);
        let tf = publishes_tf.then(|| topic("/tf".to_owned(), "tf2_msgs/TFMessage"));
        Ok(Self {
            slip: topic(name("grouser/slip")?, known::WHEEL_SLIP)?,
            odometry: topic(name("grouser/odom")?, "nav_msgs/Odometry")?,
            twist: topic(
                name("grouser/twist")?,
                "geometry_msgs/TwistWithCovarianceStamped",
            )?,
            events: topic(name("grouser/events")?, known::SLIP_EVENT)?,
            diagnostics: topic("/diagnostics".to_owned(), "diagnostic_msgs/DiagnosticArray")?,
            transform: tf.transpose()?,
            transport,
            recorder: None,
            names,
            frames,
            latest: Vec::new(),
            latest_ns: None,
            latest_at: None,
            latest_speed: None,
            last_odometry: None,
            changes: Vec::new(),
            steps: 0,
        })
    }

    /// The wheels.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    fn topics(&self) -> impl Iterator<Item = &Topic> {
        let own = [
            &self.slip,
            &self.odometry,
            &self.twist,
            &self.events,
            &self.diagnostics,
        ];
        own.into_iter().chain(&self.transform)
    }

    /// Messages of the estimate that the transport did not take.
    pub(crate) fn unsent(&self) -> u64 {
        self.topics().map(|topic| topic.unsent).sum()
    }

    /// Messages of the estimate that cannot be encoded, and why the first cannot.
    pub(crate) fn unencoded(&self) -> (u64, Option<&str>) {
        let count = self.topics().map(|topic| topic.unencoded.0).sum();
        let mut reasons = self.topics().map(|topic| topic.unencoded.1.as_deref());
        (count, reasons.find_map(|reason| reason))
    }

    /// Publishes diagnostics: the node's own status first, then the wheels'.
    pub(crate) fn publish_diagnostics(&mut self, time_ns: i64, node: Value) {
        let mut statuses = vec![node];
        statuses.extend(wheel_statuses(&self.names, &self.latest));
        let message = build::message([
            ("header", build::header(time_ns, "")),
            ("status", Value::Array(statuses)),
        ]);
        let (transport, recorder) = (self.transport.as_mut(), &mut self.recorder);
        self.diagnostics
            .send(transport, recorder, time_ns, &message);
    }

    /// The wheels are silent: no slip is claimed any more.
    pub(crate) fn publish_silence(&mut self, time_ns: i64) {
        for wheel in &mut self.latest {
            (wheel.slip, wheel.sigma, wheel.motion) = (None, None, None);
            wheel.health = Health::Invalid(Invalid::Dropout);
        }
        self.publish_slip(time_ns);
    }

    /// Does anyone receive or record a topic?
    fn is_wanted(&mut self, topic: fn(&Self) -> &Topic) -> bool {
        let publisher = topic(self).publisher;
        self.recorder.is_some() || self.transport.has_subscriber(publisher)
    }

    fn publish_slip(&mut self, time_ns: i64) {
        if !self.is_wanted(|own| &own.slip) {
            return;
        }
        let frame = &self.frames.base;
        let (header, bytes) = (Header { time_ns, frame }, &mut self.slip.bytes);
        let written = write_wheel_slip(bytes, header, &self.names, &self.latest);
        let (transport, recorder) = (self.transport.as_mut(), &mut self.recorder);
        self.slip
            .send_written(transport, recorder, time_ns, written);
    }

    fn publish_odometry(&mut self, time_ns: i64, odometry: &Odometry) {
        let wants = [
            self.is_wanted(|own| &own.odometry),
            self.is_wanted(|own| &own.twist),
        ];
        let [base, odom] = [&self.frames.base, &self.frames.odom];
        let [in_base, in_odom] = [base, odom].map(|frame| Header { time_ns, frame });
        let (transport, recorder) = (self.transport.as_mut(), &mut self.recorder);
        if wants[0] {
            let bytes = &mut self.odometry.bytes;
            let written = write_odometry(bytes, in_odom, base, odometry);
            self.odometry
                .send_written(transport, recorder, time_ns, written);
        }
        if wants[1] {
            let written = write_twist(&mut self.twist.bytes, in_base, odometry);
            self.twist
                .send_written(transport, recorder, time_ns, written);
        }
        if let Some(topic) = &mut self.transform {
            let written = write_transform(&mut topic.bytes, in_odom, base, odometry);
            topic.send_written(transport, recorder, time_ns, written);
        }
    }
}

/// Records a message; `id` is the channel's number once it is entered.
pub(crate) fn record(
    recorder: &mut Option<Recorder>,
    id: &mut Option<u16>,
    channel: &Channel,
    time_ns: u64,
    bytes: &[u8],
) {
    let Some(open) = recorder else { return };
    let entered = match *id {
        Some(id) => Ok(id),
        None => open.channel(channel),
    };
    let written = entered.and_then(|entered| {
        *id = Some(entered);
        open.message(entered, time_ns, bytes)
    });
    if let Err(error) = written {
        crate::print::warn(&format!("the recording ends here: {error}"));
        *recorder = None;
    }
}

impl Sink for Outputs {
    fn row(&mut self, _row: &Row<'_>) -> io::Result<()> {
        Ok(())
    }

    fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        self.steps += 1;
        self.latest.clear();
        self.latest.extend_from_slice(step.wheels);
        self.latest_ns = Some(step.time_ns);
        self.latest_at = Some(Instant::now());
        self.latest_speed = step.odometry.map(|odometry| odometry.velocity[0]);
        self.publish_slip(step.time_ns);
        if let Some(odometry) = step.odometry {
            self.last_odometry = Some(odometry);
            self.publish_odometry(step.time_ns, &odometry);
        }
        Ok(())
    }

    fn event(&mut self, change: &Change) -> io::Result<()> {
        self.changes.push(*change);
        let header = build::header(change.time_ns, &self.frames.base);
        let message = slip_event(header, &self.names, change);
        let (transport, recorder) = (self.transport.as_mut(), &mut self.recorder);
        self.events
            .send(transport, recorder, change.time_ns, &message);
        Ok(())
    }
}
