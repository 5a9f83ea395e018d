//! The first seconds: which topics there are, and what their first messages say.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant};

use grouser_files::robot::RobotFile;
use grouser_log::container::Channel;
use grouser_log::message::{View, known};
use grouser_log::{Intake, Preview};

use crate::error::Result;
use crate::print::{say, warn};
use crate::transport::{Arrival, Arrivals, Endpoint, Inbox, Transport};
use crate::type_hash;

/// The graph is looked at this often.
const GRAPH_PERIOD: Duration = Duration::from_millis(100);
/// What is missing is reported this often.
const REPORT_PERIOD: Duration = Duration::from_secs(5);
/// Messages that are kept until the topics are chosen, bytes: ten minutes of ten sensors.
const MAX_BACKLOG_BYTES: usize = 256 << 20;
/// Messages out of order are held back for this many times the lateness that the first of them showed.
const HOLD_FACTOR: i64 = 2;
/// Limits of the hold that is chosen.
const MIN_HOLD: Duration = Duration::from_millis(2);
const MAX_HOLD: Duration = Duration::from_millis(500);

/// What the first seconds gave.
pub(crate) struct Looked {
    pub(crate) intake: Intake,
    /// The subscriptions' channels; those that are not used have ended.
    pub(crate) channels: Vec<Channel>,
    /// The messages so far, in the order of arrival.
    pub(crate) backlog: Vec<Arrival>,
    pub(crate) hold: Duration,
}

/// Subscribes to what could be of use, and reports what cannot.
pub(crate) struct Subscriptions {
    wanted: BTreeSet<String>,
    ignored: BTreeSet<String>,
    known: BTreeSet<(String, String)>,
    refused: BTreeSet<Endpoint>,
    pub(crate) channels: Vec<Channel>,
}

impl Subscriptions {
    pub(crate) fn new(robot: &RobotFile) -> Self {
        let fields = robot
            .topics
            .fields
            .iter()
            .map(|fields| fields.topic.clone());
        Self {
            wanted: fields.collect(),
            ignored: robot.topics.ignore.iter().cloned().collect(),
            known: BTreeSet::new(),
            refused: BTreeSet::new(),
            channels: Vec::new(),
        }
    }

    /// Is it one of the kinds of topics that an estimate can use?
    fn is_of_use(&self, endpoint: &Endpoint) -> bool {
        let topic = &endpoint.topic;
        let is_own = topic.contains(known::OUTPUT);
        endpoint.is_publisher
            && !is_own
            && !self.ignored.contains(topic)
            && (View::exists_for(&known::ros2_name(&endpoint.type_name))
                || self.wanted.contains(topic))
    }

    /// Subscribes to new topics of use; gives the topics that are new.
    pub(crate) fn follow(
        &mut self,
        transport: &mut dyn Transport,
        inbox: &Inbox,
    ) -> Result<Vec<String>> {
        let mut new = Vec::new();
        for endpoint in self.fitting(transport) {
            let key = (endpoint.topic.clone(), endpoint.type_name.clone());
            if !self.known.insert(key) {
                continue;
            }
            if let Some(channel) = known::channel(&endpoint.topic, &endpoint.type_name) {
                transport.subscribe(self.channels.len(), &endpoint, inbox)?;
                new.push(endpoint.topic.clone());
                self.channels.push(channel);
            }
        }
        Ok(new)
    }

    /// Topics of use that appeared since.
    pub(crate) fn unknown(&mut self, transport: &mut dyn Transport) -> Vec<String> {
        let fitting = self.fitting(transport);
        let is_new = |endpoint: &Endpoint| {
            !self
                .known
                .contains(&(endpoint.topic.clone(), endpoint.type_name.clone()))
        };
        fitting
            .into_iter()
            .filter(is_new)
            .map(|endpoint| endpoint.topic)
            .collect()
    }

    /// Publishers of use whose definitions are ours; the others are reported once.
    pub(crate) fn fitting(&mut self, transport: &mut dyn Transport) -> Vec<Endpoint> {
        let mut fitting = Vec::new();
        for endpoint in transport.graph().endpoints {
            if !self.is_of_use(&endpoint) {
                continue;
            }
            match misfit(&endpoint) {
                None => fitting.push(endpoint),
                Some(words) => {
                    if self.refused.insert(endpoint) {
                        warn(&words);
                    }
                }
            }
        }
        fitting
    }
}

/// Why a publisher's messages cannot be decoded.
pub(crate) fn misfit(endpoint: &Endpoint) -> Option<String> {
    let Endpoint {
        topic,
        type_name,
        node,
        ..
    } = endpoint;
    let Some(own) = type_hash::of_known(type_name) else {
        return Some(format!(
            "`{topic}` is not used: the definition of its type {type_name} is not known"
        ));
    };
    let other = endpoint.type_hash.as_deref()?;
    (other != own && other != type_hash::UNSUPPORTED).then(|| {
        format!(
            "`{topic}` of {node} is not used: its type {type_name} has the hash {other}, which is of another definition; \
             the one known here has {own}"
        )
    })
}

/// Listens until the topics that the robot file needs have sent, and for at least `look`; `None` where `stop` ends it.
pub(crate) fn look(
    transport: &mut dyn Transport,
    (robot, look): (&RobotFile, Duration),
    (inbox, arrivals): (&Inbox, &mut Arrivals),
    subscriptions: &mut Subscriptions,
    stop: &dyn Fn() -> bool,
) -> Result<Option<Looked>> {
    let mut preview = Preview::new(&robot.topics);
    let mut numbers: Vec<usize> = Vec::new();
    let mut backlog: Vec<Arrival> = Vec::new();
    let mut bytes = 0;
    let mut order = Order::default();
    let mut begun = None;
    let mut reported = Instant::now();
    let mut graph_due = Instant::now();
    loop {
        if stop() {
            return Ok(None);
        }
        let now = Instant::now();
        if now >= graph_due {
            graph_due = now + GRAPH_PERIOD;
            subscriptions.follow(transport, inbox)?;
            for channel in &subscriptions.channels[numbers.len()..] {
                numbers.push(preview.channel(channel));
            }
            transport.warnings().iter().for_each(|words| warn(words));
        }
        match arrivals.recv_timeout(GRAPH_PERIOD) {
            Ok(arrival) => {
                begun.get_or_insert(arrival.received);
                if let Some(number) = numbers.get(arrival.subscription) {
                    preview.push(*number, &arrival.bytes, arrival.received_ns);
                    order.take(&arrival, &subscriptions.channels[arrival.subscription]);
                }
                bytes += arrival.bytes.len();
                if bytes > MAX_BACKLOG_BYTES {
                    // the estimate begins later
                    backlog.clear();
                    bytes = 0;
                }
                backlog.push(arrival);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(None),
        }
        let has_looked = begun.is_some_and(|begun: Instant| begun.elapsed() >= look);
        if has_looked && preview.is_complete() {
            break;
        }
        if reported.elapsed() >= REPORT_PERIOD {
            reported = Instant::now();
            if transport.graph().endpoints.is_empty() {
                say(
                    "waiting: no topic is seen; are domain and transport those of the robot, and does Zenoh's router run?",
                );
            } else {
                let what = missing(robot, &subscriptions.channels, &backlog);
                say(&format!("waiting for {what}"));
            }
        }
    }
    let intake = preview.into_intake()?;
    let used: BTreeSet<String> = intake.topics().map(|topic| topic.topic).collect();
    for (subscription, channel) in subscriptions.channels.iter().enumerate() {
        if !used.contains(&channel.topic) {
            transport.unsubscribe(subscription);
        }
    }
    Ok(Some(Looked {
        hold: order.hold(&used),
        intake,
        channels: subscriptions.channels.clone(),
        backlog,
    }))
}

/// Which of the named topics have not sent, in words.
fn missing(robot: &RobotFile, channels: &[Channel], backlog: &[Arrival]) -> String {
    let sent: BTreeSet<&str> = backlog
        .iter()
        .filter_map(|arrival| Some(channels.get(arrival.subscription)?.topic.as_str()))
        .collect();
    let named: Vec<&str> = robot
        .topics
        .named()
        .filter(|name| !sent.contains(name))
        .collect();
    if named.is_empty() {
        "a topic that measures wheels (sensor_msgs/JointState)".to_owned()
    } else {
        named.join(", ")
    }
}

/// How far messages arrive from their order of time.
#[derive(Default)]
struct Order {
    newest_ns: Option<i64>,
    /// By topic: how far its messages stood behind the newest, ns.
    late_ns: BTreeMap<String, i64>,
    /// Topics whose stamps were equal to another topic's.
    shared: BTreeSet<String>,
    last: BTreeMap<String, i64>,
}

impl Order {
    fn take(&mut self, arrival: &Arrival, channel: &Channel) {
        let Some(stamp) = stamp_ns(&arrival.bytes, &channel.type_name) else {
            return;
        };
        let newest = *self.newest_ns.get_or_insert(stamp);
        self.newest_ns = Some(newest.max(stamp));
        let late = self.late_ns.entry(channel.topic.clone()).or_default();
        *late = (*late).max(newest.saturating_sub(stamp));
        let others = self
            .last
            .iter()
            .filter(|(topic, last)| **topic != channel.topic && **last == stamp);
        let others: Vec<String> = others.map(|(topic, _)| topic.clone()).collect();
        if !others.is_empty() {
            self.shared.extend(others);
            self.shared.insert(channel.topic.clone());
        }
        self.last.insert(channel.topic.clone(), stamp);
    }

    /// How long messages are held back: not at all where the topics in use arrive in order, each with stamps of its own.
    fn hold(&self, used: &BTreeSet<String>) -> Duration {
        let late = self
            .late_ns
            .iter()
            .filter(|(topic, _)| used.contains(*topic))
            .map(|(_, late)| *late);
        let late_ns = late.max().unwrap_or(0);
        let shares = self
            .shared
            .iter()
            .filter(|topic| used.contains(*topic))
            .count()
            > 1;
        if late_ns == 0 && !shares {
            return Duration::ZERO;
        }
        let hold =
            Duration::from_nanos(u64::try_from(HOLD_FACTOR.saturating_mul(late_ns)).unwrap_or(0));
        hold.clamp(MIN_HOLD, MAX_HOLD)
    }
}

/// The stamp of a message whose type begins with a header: little-endian CDR after four bytes of encapsulation.
fn stamp_ns(bytes: &[u8], type_name: &str) -> Option<i64> {
    let text = known::definition(&type_name.replacen("/msg/", "/", 1))?;
    if !text.starts_with("std_msgs/Header header") && !text.contains("\nstd_msgs/Header header\n") {
        return None;
    }
    let number = |at: usize| Some(i32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    (bytes.get(1) == Some(&1)).then_some(())?;
    Some(i64::from(number(4)?) * 1_000_000_000 + i64::from(number(8)?))
}
