//! `--command`: the requested motion comes in, and goes out limited by slip.

mod limiter;
mod motion;

use std::time::{Duration, Instant};

use grouser_log::container::Channel;
use grouser_log::message::{Decoder, Header, Value, known};
use grouser_slip::Robot;

use crate::error::{Error, Result};
use crate::outputs::{Outputs, Topic, record};
use crate::senders::Senders;
use crate::transport::{Arrival, Inbox};
pub(crate) use limiter::CommandLimits;
use limiter::{CommandLimiter, Known};
use motion::{MotionRequest, Refusal};

/// The number of its subscription, which no topic of the estimate has.
pub(crate) const SUBSCRIPTION: usize = usize::MAX;
/// The limited motion is published this often: a usual rate of a base's control loop.
const PERIOD: Duration = Duration::from_millis(20);
/// A publisher of commands is looked for this often.
const LOOK_PERIOD: Duration = Duration::from_millis(200);
/// The zero of a node that ends is sent so often at most until the transport takes it.
const MAX_ZERO_TRIES: u32 = 5;
/// A refused command is reported for this long.
const REPORT_TIME: Duration = Duration::from_secs(2);

/// The topics of commands, and what lies between them.
pub(crate) struct CommandPath {
    topic: String,
    output_topic: String,
    frame: String,
    limiter: CommandLimiter,
    open: Option<OpenTopics>,
    look_due: Instant,
    due: Instant,
    refusal: Option<(Instant, Refusal)>,
    refused: u64,
}

/// Both topics, once the type of the commands is known by their publisher.
struct OpenTopics {
    input: Channel,
    input_record: Option<u16>,
    decoder: Decoder,
    /// The last command, into which the next is decoded.
    value: Value,
    senders: Senders,
    output: Topic,
    is_stamped: bool,
}

impl CommandPath {
    /// Commands of `topic`; the limited ones are published as `output_topic`.
    ///
    /// # Errors
    /// [`Error::Slip`] for limits that the controller does not take.
    pub(crate) fn new(
        (topic, output_topic): (String, String),
        frame: String,
        (robot, has_steering): (&Robot, bool),
        limits: CommandLimits,
    ) -> Result<Self> {
        let now = Instant::now();
        Ok(Self {
            topic,
            output_topic,
            frame,
            limiter: CommandLimiter::new(robot, limits, (has_steering, now))?,
            open: None,
            look_due: now,
            due: now,
            refusal: None,
            refused: 0,
        })
    }

    /// The topic of the commands.
    pub(crate) fn topic(&self) -> &str {
        &self.topic
    }

    /// What it does, in words.
    pub(crate) fn choice(&self) -> String {
        format!(
            "commands of {} go to {}, limited by slip",
            self.topic, self.output_topic
        )
    }

    /// Until it is to be called again.
    pub(crate) fn wait(&self, now: Instant) -> Duration {
        self.due.saturating_duration_since(now)
    }

    /// A message of the subscription [`SUBSCRIPTION`].
    pub(crate) fn take(&mut self, arrival: &Arrival, outputs: &mut Outputs) {
        let Some(open) = &mut self.open else { return };
        if !open.senders.accepts(arrival, &open.input.type_name) {
            return;
        }
        record(
            &mut outputs.recorder,
            &mut open.input_record,
            &open.input,
            arrival.received_ns,
            &arrival.bytes,
        );
        let decoded = open.decoder.decode_into(&arrival.bytes, &mut open.value);
        let read = decoded.map_err(|_| Refusal::Undecoded);
        match read.and_then(|()| MotionRequest::read(&open.input.type_name, &open.value)) {
            Ok(request) => self.limiter.request(arrival.received, request),
            // a refused command counts as none: if no other comes, the robot stops
            Err(refusal) => {
                self.refused += 1;
                self.refusal = Some((arrival.received, refusal));
            }
        }
    }

    /// Publishes the limited motion where it is due.
    pub(crate) fn tick(
        &mut self,
        now: Instant,
        now_ns: i64,
        outputs: &mut Outputs,
        inbox: &Inbox,
    ) -> Result<()> {
        if now < self.due {
            return Ok(());
        }
        // a loop that was late goes on from now: what was missed is not made up for
        self.due = now + PERIOD;
        if self.open.is_none() && now >= self.look_due {
            self.look_due = now + LOOK_PERIOD;
            self.open = self.look(outputs, inbox)?;
        }
        let motion = self.limiter.tick(
            now,
            &Known {
                wheels: &outputs.latest,
                age: outputs
                    .latest_at
                    .map(|at| now.saturating_duration_since(at)),
                speed: outputs.latest_speed,
            },
        );
        if let (Some(motion), Some(open)) = (motion, &mut self.open) {
            publish(open, outputs, (&self.frame, now_ns), motion);
        }
        Ok(())
    }

    /// The last message of a node that ends: a zero, again if the transport does not take it.
    pub(crate) fn stop(&mut self, now_ns: i64, outputs: &mut Outputs) {
        let Some(open) = &mut self.open else { return };
        let zero = MotionRequest::default();
        let mut tries = 0..MAX_ZERO_TRIES;
        tries.any(|_| publish(open, outputs, (&self.frame, now_ns), zero));
    }

    /// The first publisher of commands decides their type.
    fn look(&self, outputs: &mut Outputs, inbox: &Inbox) -> Result<Option<OpenTopics>> {
        let graph = outputs.transport.graph();
        let is_command = |type_name: &str| {
            matches!(
                type_name,
                "geometry_msgs/Twist" | "geometry_msgs/TwistStamped"
            )
        };
        let publisher = graph.endpoints.iter().find(|endpoint| {
            endpoint.is_publisher
                && endpoint.topic == self.topic
                && is_command(&endpoint.type_name)
                && crate::look::misfit(endpoint).is_none()
        });
        let Some(publisher) = publisher else {
            return Ok(None);
        };
        let type_name = &publisher.type_name;
        let input = known::channel(&self.topic, type_name).ok_or_else(|| Error::UnknownType {
            type_name: type_name.clone(),
        })?;
        outputs
            .transport
            .subscribe(SUBSCRIPTION, publisher, inbox)?;
        Ok(Some(OpenTopics {
            decoder: Decoder::new(&input)?,
            value: Value::Null,
            senders: Senders::new(&input),
            output: Topic::announce(outputs.transport.as_mut(), &self.output_topic, type_name)?,
            is_stamped: type_name == "geometry_msgs/TwistStamped",
            input,
            input_record: None,
        }))
    }

    /// What is wrong, in words.
    pub(crate) fn problems(&self, now: Instant) -> Vec<String> {
        let mut problems = Vec::new();
        let Some(open) = &self.open else {
            return vec![format!("no command has a publisher on `{}`", self.topic)];
        };
        if let Some(hold) = self.limiter.hold() {
            problems.push(hold.words().to_owned());
        }
        if let Some((_, refusal)) =
            (self.refusal).filter(|(at, _)| now.saturating_duration_since(*at) < REPORT_TIME)
        {
            problems.push(refusal.words());
        }
        problems.extend(open.senders.problem(now));
        problems
    }

    /// The share of the requested motion that passed last.
    pub(crate) fn share(&self) -> f64 {
        self.limiter.share()
    }

    /// For the diagnostics.
    pub(crate) fn values(&self) -> [(&'static str, String); 2] {
        [
            ("command_share", format!("{:.3}", self.limiter.share())),
            ("commands_refused", self.refused.to_string()),
        ]
    }
}

/// Has the transport taken the motion?
fn publish(
    open: &mut OpenTopics,
    outputs: &mut Outputs,
    (frame, now_ns): (&str, i64),
    motion: MotionRequest,
) -> bool {
    let header = Header {
        time_ns: now_ns,
        frame,
    };
    let output = &mut open.output;
    let header = open.is_stamped.then_some(header);
    let written = motion.write(&mut output.bytes, header);
    let (transport, recorder) = (outputs.transport.as_mut(), &mut outputs.recorder);
    output.send_written(transport, recorder, now_ns, written)
}
