//! DDS under ROS 2's conventions: topics begin with `rt/`, and a publisher's user data holds the hash of its type.
//!
//! A reader requests what its publisher offers: reliability, and for `/tf_static` what was sent before. The writers are
//! reliable and volatile.

use std::collections::{BTreeMap, BTreeSet};
use std::convert::Infallible;
use std::pin::Pin;
use std::task::{Context, Poll, Waker};
use std::time::Instant;

use futures_core::Stream as _;
use grouser_log::message::known;
use rustdds::bytes::Bytes;
use rustdds::discovery::{DiscoveredReaderData, DiscoveredWriterData};
use rustdds::no_key::{
    DataReaderStream, DataWriter, Decode, DefaultDecoder, DeserializerAdapter, SerializerAdapter,
};
use rustdds::policy::{Durability, History};
use rustdds::{
    DataWriterStatus, DomainParticipant, Duration, GUID, Publisher, QosPolicies, QosPolicyBuilder,
    RTPSEntity as _, RepresentationIdentifier, StatusEvented as _, Subscriber, Timestamp, Topic,
    TopicKind,
};

use super::dds_node::{self, GidLength, Guid};
use super::names::{dds_type, ros_type};
use super::{Endpoint, Fetched, Graph, Inbox, Source, Transport};
use crate::environment::Environment;
use crate::error::{Error, Result};

/// The messages that a reader or writer keeps: half a second at 2 kHz. The estimates of the first seconds are written at once.
const DEPTH: i32 = 1000;
/// A writer of diagnostics, one a second of 2 kB, keeps fewer: a thousand would fill memory for 17 minutes.
const DIAGNOSTICS_DEPTH: i32 = 10;
/// Events are rare: a thousand would fill memory for days.
const EVENTS_DEPTH: i32 = 100;
/// A writer waits for a slow reader at most so long, ms: less than a period of a control loop.
const MAX_BLOCKING_MS: i64 = 5;
/// Readers that come and go are noticed this often: a new one waits less than for its discovery.
const READERS_PERIOD: std::time::Duration = std::time::Duration::from_millis(100);
/// The bytes before a message's body: how it is encoded.
const ENCAPSULATION: usize = 4;
/// What stands before a topic's name.
const TOPIC: &str = "rt/";
/// What stands before the hash in a publisher's user data.
const HASH: &str = "typehash=";

/// A message as it is sent: encapsulation and body.
struct Raw(Bytes);

/// Takes and gives messages as they are.
struct RawAdapter;

#[derive(Clone)]
struct RawDecoder;

impl Decode<'_, Raw> for RawDecoder {
    type Error = Infallible;

    fn decode_bytes(
        self,
        bytes: &[u8],
        encoding: RepresentationIdentifier,
    ) -> std::result::Result<Raw, Infallible> {
        let kind = u8::from(encoding == RepresentationIdentifier::CDR_LE);
        let mut message = Vec::with_capacity(bytes.len() + ENCAPSULATION);
        message.extend_from_slice(&[0, kind, 0, 0]);
        message.extend_from_slice(bytes);
        Ok(Raw(message.into()))
    }
}

impl DeserializerAdapter<Raw> for RawAdapter {
    type Error = Infallible;
    type Decoded = Raw;

    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        &[
            RepresentationIdentifier::CDR_LE,
            RepresentationIdentifier::CDR_BE,
        ]
    }

    fn transform_decoded(decoded: Raw) -> Raw {
        decoded
    }
}

impl DefaultDecoder<Raw> for RawAdapter {
    type Decoder = RawDecoder;
    const DECODER: RawDecoder = RawDecoder;
}

impl SerializerAdapter<Raw> for RawAdapter {
    type Error = Infallible;

    fn output_encoding() -> RepresentationIdentifier {
        RepresentationIdentifier::CDR_LE
    }

    fn to_bytes(value: &Raw) -> std::result::Result<Bytes, Infallible> {
        // the encapsulation is added by the writer
        Ok(value.0.slice(ENCAPSULATION.min(value.0.len())..))
    }
}

/// A participant with what it announced.
pub(super) struct DdsTransport {
    participant: DomainParticipant,
    publisher: Publisher,
    subscriber: Subscriber,
    readers: BTreeMap<usize, Reader>,
    writers: Vec<Writer>,
    /// Topics with the subscribers to which they do not fit, and what is to be reported of them.
    warned: BTreeSet<(String, GUID)>,
    warnings: Vec<String>,
    domain: u16,
    node: String,
    /// Announces the node in ROS 2's graph.
    announcer: DataWriter<Raw, RawAdapter>,
}

/// A subscription, with what it takes to make it again.
struct Reader {
    guid: Guid,
    publisher: Endpoint,
    inbox: Inbox,
}

/// The samples that a reader holds.
struct Samples(DataReaderStream<Raw, RawAdapter>);

impl Source for Samples {
    fn fetch(&mut self, waker: &Waker) -> Option<Fetched> {
        loop {
            match Pin::new(&mut self.0).poll_next(&mut Context::from_waker(waker)) {
                Poll::Ready(Some(Ok(sample))) => {
                    let info = sample.sample_info();
                    return Some(Fetched {
                        publisher: info.writer_guid().to_bytes(),
                        sent: info.source_timestamp().map_or(0, Timestamp::to_ticks),
                        bytes: sample.into_value().0.into(),
                    });
                }
                // what the reader cannot take apart is lost, as on a bad network
                Poll::Ready(Some(Err(_))) => {}
                Poll::Ready(None) | Poll::Pending => return None,
            }
        }
    }
}

/// A writer of the node's own.
struct Writer {
    topic: String,
    type_name: String,
    data: DataWriter<Raw, RawAdapter>,
    /// The readers that get its messages now.
    readers: i32,
    /// When that is looked at next: each look is a call of the system.
    look_due: Instant,
}

fn failed(error: impl std::fmt::Display) -> Error {
    Error::Transport {
        name: "dds",
        what: error.to_string(),
    }
}

fn writer_qos(type_name: &str) -> QosPolicies {
    let depth = match type_name {
        "diagnostic_msgs/DiagnosticArray" => DIAGNOSTICS_DEPTH,
        known::SLIP_EVENT => EVENTS_DEPTH,
        _ => DEPTH,
    };
    QosPolicyBuilder::new()
        .reliable(Duration::from_millis(MAX_BLOCKING_MS))
        .durability(Durability::Volatile)
        .history(History::KeepLast { depth })
        .build()
}

/// As of every participant of ROS 2: who comes later still gets the last announcement.
fn announcement_qos() -> QosPolicies {
    QosPolicyBuilder::new()
        .reliable(Duration::from_millis(MAX_BLOCKING_MS))
        .durability(Durability::TransientLocal)
        .history(History::KeepLast { depth: 1 })
        .build()
}

/// What the publisher offers is requested, so that every publisher fits.
fn reader_qos(publisher: &Endpoint) -> QosPolicies {
    let qos = QosPolicyBuilder::new().history(History::KeepLast { depth: DEPTH });
    let qos = if publisher.is_reliable {
        qos.reliable(Duration::from_millis(MAX_BLOCKING_MS))
    } else {
        qos.best_effort()
    };
    let durability = if publisher.is_transient_local {
        Durability::TransientLocal
    } else {
        Durability::Volatile
    };
    qos.durability(durability).build()
}

impl DdsTransport {
    pub(super) fn open(environment: &Environment, node: &str) -> Result<Self> {
        Self::of_domain(u16::try_from(environment.domain).map_err(failed)?, node)
    }

    fn of_domain(domain: u16, node: &str) -> Result<Self> {
        let participant = DomainParticipant::new(domain).map_err(failed)?;
        let default = QosPolicies::qos_none();
        let publisher = participant.create_publisher(&default).map_err(failed)?;
        let qos = announcement_qos();
        let (name, kind) = (dds_node::TOPIC.to_owned(), dds_node::TYPE.to_owned());
        let topic = participant.create_topic(name, kind, &qos, TopicKind::NoKey);
        let announcer = publisher
            .create_datawriter_no_key::<Raw, RawAdapter>(&topic.map_err(failed)?, Some(qos))
            .map_err(failed)?;
        Ok(Self {
            node: node.to_owned(),
            announcer,
            publisher,
            subscriber: participant.create_subscriber(&default).map_err(failed)?,
            participant,
            readers: BTreeMap::new(),
            writers: Vec::new(),
            warned: BTreeSet::new(),
            warnings: Vec::new(),
            domain,
        })
    }

    /// Announces which readers and writers the node has. Until a publisher of ROS 2 is known, its release is not, on which
    /// the message depends.
    fn announce_node(&self) -> Result<()> {
        let publishers = self.readers.values().map(|reader| &reader.publisher);
        let Some(has_hashes) = publishers
            .map(|publisher| publisher.type_hash.is_some())
            .reduce(|a, b| a || b)
        else {
            return Ok(());
        };
        let length = if has_hashes {
            GidLength::Later
        } else {
            GidLength::Humble
        };
        let readers: Vec<Guid> = self.readers.values().map(|reader| reader.guid).collect();
        let writers = self.writers.iter();
        let writers: Vec<Guid> = writers
            .map(|writer| writer.data.guid().to_bytes())
            .collect();
        let participant = self.participant.guid().to_bytes();
        let message = dds_node::message(length, participant, &self.node, [&readers, &writers])?;
        self.announcer
            .write(Raw(message.into()), None)
            .map_err(failed)
    }

    fn topic(&self, topic: &str, type_name: &str, qos: &QosPolicies) -> Result<Topic> {
        let name = format!("{TOPIC}{}", topic.trim_start_matches('/'));
        let topic = self
            .participant
            .create_topic(name, dds_type(type_name), qos, TopicKind::NoKey);
        topic.map_err(failed)
    }
}

/// An endpoint of another participant; `None` for what belongs to no message of ROS 2.
fn endpoint(
    topic: &str,
    type_name: &str,
    user_data: &[u8],
    qos: &QosPolicies,
    is_publisher: bool,
) -> Option<Endpoint> {
    let text = String::from_utf8_lossy(user_data);
    let hash = text
        .split_once(HASH)
        .map(|(_, rest)| rest.split([';', '\0']).next().unwrap_or(rest));
    Some(Endpoint {
        topic: format!("/{}", topic.strip_prefix(TOPIC)?),
        type_name: ros_type(type_name)?,
        type_hash: hash.map(str::to_owned),
        // DDS names no nodes
        node: "a DDS participant".to_owned(),
        is_publisher,
        is_reliable: qos.is_reliable(),
        is_transient_local: qos.durability() == Some(Durability::TransientLocal),
    })
}

fn of_writer(writer: &DiscoveredWriterData) -> Option<Endpoint> {
    let (data, text) = (&writer.publication_topic_data, &writer.user_data);
    endpoint(&data.topic_name, &data.type_name, text, &data.qos(), true)
}

fn of_reader(reader: &DiscoveredReaderData) -> Option<Endpoint> {
    let (data, text) = (&reader.subscription_topic_data, &reader.user_data);
    endpoint(
        data.topic_name(),
        data.type_name(),
        text,
        &data.qos(),
        false,
    )
}

impl Transport for DdsTransport {
    fn graph(&mut self) -> Graph {
        let own = self.participant.guid().prefix;
        let writers = self.participant.discovered_writers();
        let writers = writers
            .iter()
            .filter(|writer| writer.writer_proxy.remote_writer_guid.prefix != own);
        let readers = self.participant.discovered_readers();
        let readers = readers
            .iter()
            .filter(|reader| reader.reader_proxy.remote_reader_guid.prefix != own);
        Graph {
            endpoints: writers
                .filter_map(of_writer)
                .chain(readers.filter_map(of_reader))
                .collect(),
        }
    }

    fn subscribe(
        &mut self,
        subscription: usize,
        publisher: &Endpoint,
        inbox: &Inbox,
    ) -> Result<()> {
        let qos = reader_qos(publisher);
        let topic = self.topic(&publisher.topic, &publisher.type_name, &qos)?;
        let reader = self
            .subscriber
            .create_datareader_no_key::<Raw, RawAdapter>(&topic, Some(qos))
            .map_err(failed)?;
        let guid = reader.guid().to_bytes();
        inbox.begin(subscription, Samples(reader.async_sample_stream()));
        let reader = Reader {
            guid,
            publisher: publisher.clone(),
            inbox: inbox.clone(),
        };
        self.readers.insert(subscription, reader);
        self.announce_node()
    }

    fn unsubscribe(&mut self, subscription: usize) {
        if let Some(reader) = self.readers.remove(&subscription) {
            reader.inbox.end(subscription);
            // a reader too many in the graph is no reason to end
            let _ = self.announce_node();
        }
    }

    fn advertise(&mut self, topic: &str, type_name: &str) -> Result<usize> {
        let qos = writer_qos(type_name);
        let dds_topic = self.topic(topic, type_name, &qos)?;
        let writer = self
            .publisher
            .create_datawriter_no_key::<Raw, RawAdapter>(&dds_topic, Some(qos))
            .map_err(failed)?;
        self.writers.push(Writer {
            topic: topic.to_owned(),
            type_name: type_name.to_owned(),
            data: writer,
            readers: 0,
            look_due: Instant::now(),
        });
        self.announce_node()?;
        Ok(self.writers.len() - 1)
    }

    fn has_subscriber(&mut self, publisher: usize) -> bool {
        let Some(writer) = self.writers.get_mut(publisher) else {
            return false;
        };
        let now = Instant::now();
        if now < writer.look_due {
            return writer.readers > 0;
        }
        writer.look_due = now + READERS_PERIOD;
        while let Some(status) = writer.data.try_recv_status() {
            match status {
                DataWriterStatus::PublicationMatched { current, .. } => {
                    writer.readers = current.count();
                }
                DataWriterStatus::OfferedIncompatibleQos {
                    last_policy_id,
                    reader,
                    ..
                } if self.warned.insert((writer.topic.clone(), reader)) => {
                    self.warnings.push(format!(
                        "QoS: a subscriber of `{}` requests another {last_policy_id:?} than reliable, volatile, keep last: it \
                         gets no messages",
                        writer.topic
                    ));
                }
                _ => {}
            }
        }
        writer.readers > 0
    }

    fn publish(&mut self, publisher: usize, bytes: &[u8]) -> Result<()> {
        let Some(own) = self.writers.get(publisher) else {
            return Ok(());
        };
        let message = Raw(Bytes::copy_from_slice(bytes));
        own.data.write(message, None).map_err(failed)
    }

    fn warnings(&mut self) -> Vec<String> {
        for publisher in 0..self.writers.len() {
            self.has_subscriber(publisher);
        }
        std::mem::take(&mut self.warnings)
    }

    /// RustDDS forgets a participant whose announcements were lost for its lease; the other side, which still knows this one,
    /// does not send its endpoints again. To a new participant it does.
    fn renew(&mut self) -> Result<()> {
        let mut new = Self::of_domain(self.domain, &self.node)?;
        for own in &self.writers {
            new.advertise(&own.topic, &own.type_name)?;
        }
        for (subscription, reader) in &self.readers {
            new.subscribe(*subscription, &reader.publisher, &reader.inbox)?;
        }
        let old = std::mem::replace(self, new);
        // its threads take a moment to end
        std::thread::spawn(move || Box::new(old).close());
        Ok(())
    }

    fn close(mut self: Box<Self>) {
        self.readers.clear();
        self.writers.clear();
    }
}
