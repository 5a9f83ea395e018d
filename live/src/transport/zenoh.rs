//! Zenoh under rmw_zenoh's conventions: keys, liveliness tokens and attachments.
//!
//! | what | form |
//! |---|---|
//! | key of a topic | `domain/topic/type/hash` |
//! | token of a node | `@ros2_lv/domain/session/node/node/NN/enclave/namespace/name` |
//! | token of a publisher (`MP`), subscriber (`MS`) | the same with the entity's number and kind, and topic, type, hash, QoS |
//! | attachment of a message | sequence number, time of sending (ns), 16, the publisher's id |
//!
//! Source: rmw_zenoh's `docs/design.md`.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use zenoh::Wait as _;
use zenoh::bytes::ZBytes;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::sample::{Sample, SampleKind};

use super::names::{dds_type, ros_type};
use super::{Endpoint, Graph, Inbox, PublisherId, Transport};
use crate::environment::Environment;
use crate::error::{Error, Result};
use crate::type_hash;

/// Stands for a slash, and for nothing, within a part of a token.
const SLASH: &str = "%";
/// Reliable, volatile, the last ten: the QoS of the node's own topics.
const QOS: &str = "::,10:,:,:,,";
/// The durability of a QoS that requests what was sent before.
const TRANSIENT_LOCAL: &str = "1";
/// The reliability of a QoS that may lose messages.
const BEST_EFFORT: &str = "2";
const NODE: u32 = 0;

/// A session with what it announced.
pub(super) struct ZenohTransport {
    session: zenoh::Session,
    domain: u32,
    node: String,
    tokens: Arc<Mutex<BTreeSet<String>>>,
    subscribers: BTreeMap<usize, (Subscriber<()>, LivelinessToken)>,
    publishers: Vec<OwnPublisher>,
    entities: u32,
    /// Dropped last: the node's token and the watch over the others' tokens.
    _node_token: LivelinessToken,
    _watch: Subscriber<()>,
    warned: BTreeSet<Endpoint>,
}

struct OwnPublisher {
    topic: String,
    publisher: Publisher<'static>,
    id: PublisherId,
    sequence: i64,
    has_subscriber: Arc<AtomicBool>,
    _token: LivelinessToken,
}

fn failed(error: impl std::fmt::Display) -> Error {
    let text = error.to_string();
    // without the place in Zenoh's source
    let what = text.split(" at /").next().unwrap_or(&text).to_owned();
    Error::Transport {
        name: "zenoh",
        what,
    }
}

/// rmw_zenoh's session by default: a peer that knows the router of this machine.
fn configuration(environment: &Environment) -> Result<zenoh::Config> {
    if let Some(path) = &environment.zenoh_config {
        return zenoh::Config::from_file(path)
            .map_err(|error| failed(format!("{}: {error}", path.display())));
    }
    let mut config = zenoh::Config::default();
    for (key, value) in [
        ("mode", "\"peer\""),
        ("connect/endpoints", "[\"tcp/localhost:7447\"]"),
        ("connect/timeout_ms", "-1"),
        ("connect/exit_on_failure", "false"),
        ("listen/endpoints", "[\"tcp/localhost:0\"]"),
        ("scouting/multicast/enabled", "false"),
    ] {
        config.insert_json5(key, value).map_err(failed)?;
    }
    Ok(config)
}

impl ZenohTransport {
    pub(super) fn open(environment: &Environment, node: &str) -> Result<Self> {
        let session = zenoh::open(configuration(environment)?)
            .wait()
            .map_err(failed)?;
        let domain = environment.domain;
        let tokens: Arc<Mutex<BTreeSet<String>>> = Arc::default();
        let known = Arc::clone(&tokens);
        let watch = session
            .liveliness()
            .declare_subscriber(format!("@ros2_lv/{domain}/**"))
            .history(true)
            .callback(move |sample: Sample| {
                let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
                let token = sample.key_expr().to_string();
                match sample.kind() {
                    SampleKind::Put => known.insert(token),
                    SampleKind::Delete => known.remove(&token),
                };
            })
            .wait()
            .map_err(failed)?;
        let start = token_start(domain, &session, NODE);
        let token = format!("{start}/NN/{}", mangled_node(node));
        let node_token = session.liveliness().declare_token(token).wait();
        Ok(Self {
            _node_token: node_token.map_err(failed)?,
            _watch: watch,
            session,
            domain,
            node: node.to_owned(),
            tokens,
            subscribers: BTreeMap::new(),
            publishers: Vec::new(),
            entities: NODE,
            warned: BTreeSet::new(),
        })
    }

    fn announce(
        &mut self,
        kind: &str,
        topic: &str,
        type_name: &str,
        hash: &str,
    ) -> Result<LivelinessToken> {
        self.entities += 1;
        let token = format!(
            "{}/{kind}/{}/{}/{}/{hash}/{QOS}",
            token_start(self.domain, &self.session, self.entities),
            mangled_node(&self.node),
            topic.replace('/', SLASH),
            dds_type(type_name)
        );
        let declared = self.session.liveliness().declare_token(token).wait();
        declared.map_err(failed)
    }

    fn key(&self, topic: &str, type_name: &str, hash: &str) -> String {
        let topic = topic.trim_matches('/');
        format!("{}/{topic}/{}/{hash}", self.domain, dds_type(type_name))
    }

    /// The hash with which peers expect a type: Humble's have none.
    fn own_hash(&mut self, type_name: &str) -> Result<String> {
        let others = self.graph().endpoints;
        let mut hashes = others.iter().filter_map(|other| other.type_hash.as_deref());
        let is_humble = hashes.next() == Some(type_hash::UNSUPPORTED)
            && hashes.all(|hash| hash == type_hash::UNSUPPORTED);
        if is_humble {
            return Ok(type_hash::UNSUPPORTED.to_owned());
        }
        type_hash::of_known(type_name).ok_or_else(|| Error::UnknownType {
            type_name: type_name.to_owned(),
        })
    }
}

/// The begin of a token of this session.
fn token_start(domain: u32, session: &zenoh::Session, entity: u32) -> String {
    format!("@ros2_lv/{domain}/{}/{NODE}/{entity}", session.zid())
}

/// Enclave, namespace and name of a node in a token.
fn mangled_node(node: &str) -> String {
    let (namespace, name) = node.rsplit_once('/').unwrap_or(("", node));
    let namespace = if namespace.is_empty() { "/" } else { namespace };
    format!("{SLASH}/{}/{name}", namespace.replace('/', SLASH))
}

/// The endpoint that a token of another session announces.
fn read_token(token: &str, own_session: &str) -> Option<Endpoint> {
    let mut parts = token.split('/').skip(2);
    let session = parts.next()?;
    if session == own_session {
        return None;
    }
    let kind = parts.nth(2)?;
    let mut parts = parts.skip(1);
    let namespace = parts.next()?.replace(SLASH, "/");
    let node = format!("{}/{}", namespace.trim_end_matches('/'), parts.next()?);
    let is_publisher = match kind {
        "MP" => true,
        "MS" => false,
        _ => return None,
    };
    let topic = parts.next()?.replace(SLASH, "/");
    let type_name = ros_type(parts.next()?)?;
    let hash = parts.next().map(str::to_owned);
    let qos = parts.next().unwrap_or_default();
    Some(Endpoint {
        topic,
        type_name,
        type_hash: hash,
        node,
        is_publisher,
        is_reliable: qos.split(':').next() != Some(BEST_EFFORT),
        is_transient_local: qos.split(':').nth(1) == Some(TRANSIENT_LOCAL),
    })
}

/// The publisher's id of a message's attachment: the last 16 bytes.
fn publisher_of(attachment: Option<&ZBytes>) -> PublisherId {
    let bytes = attachment.map(ZBytes::to_bytes).unwrap_or_default();
    let tail = bytes
        .len()
        .checked_sub(16)
        .and_then(|start| bytes.get(start..));
    tail.and_then(|tail| tail.try_into().ok())
        .unwrap_or_default()
}

impl Transport for ZenohTransport {
    fn graph(&mut self) -> Graph {
        let own = self.session.zid().to_string();
        let tokens = self.tokens.lock().unwrap_or_else(PoisonError::into_inner);
        let mut graph = Graph::default();
        let others = tokens.iter().filter_map(|token| read_token(token, &own));
        graph.endpoints.extend(others);
        graph
    }

    fn subscribe(
        &mut self,
        subscription: usize,
        publisher: &Endpoint,
        inbox: &Inbox,
    ) -> Result<()> {
        let (topic, type_name) = (&publisher.topic, &publisher.type_name);
        let hash = publisher
            .type_hash
            .clone()
            .unwrap_or_else(|| "*".to_owned());
        let token = self.announce("MS", topic, type_name, &hash)?;
        let inbox = inbox.clone();
        let subscriber = self
            .session
            .declare_subscriber(self.key(topic, type_name, &hash))
            .callback(move |sample: Sample| {
                let id = publisher_of(sample.attachment());
                inbox.put(subscription, id, sample.payload().to_bytes().into_owned());
            })
            .wait()
            .map_err(failed)?;
        self.subscribers.insert(subscription, (subscriber, token));
        Ok(())
    }

    fn unsubscribe(&mut self, subscription: usize) {
        self.subscribers.remove(&subscription);
    }

    fn advertise(&mut self, topic: &str, type_name: &str) -> Result<usize> {
        let hash = self.own_hash(type_name)?;
        let publisher = self
            .session
            .declare_publisher(self.key(topic, type_name, &hash))
            .wait()
            .map_err(failed)?;
        let token = self.announce("MP", topic, type_name, &hash)?;
        let has_subscriber = Arc::new(AtomicBool::new(false));
        let changed = Arc::clone(&has_subscriber);
        publisher
            .matching_listener()
            .callback(move |status| changed.store(status.matching(), Ordering::Relaxed))
            .background()
            .wait()
            .map_err(failed)?;
        let matches = publisher.matching_status().wait().map_err(failed)?;
        has_subscriber.fetch_or(matches.matching(), Ordering::Relaxed);
        // unique in the graph: the session's id, and the entity's number
        let mut id = self.session.zid().to_le_bytes();
        for (byte, number) in id.iter_mut().zip(self.entities.to_le_bytes()) {
            *byte ^= number;
        }
        self.publishers.push(OwnPublisher {
            topic: topic.to_owned(),
            publisher,
            id,
            sequence: 0,
            has_subscriber,
            _token: token,
        });
        Ok(self.publishers.len() - 1)
    }

    fn has_subscriber(&mut self, publisher: usize) -> bool {
        let own = self.publishers.get(publisher);
        own.is_some_and(|own| own.has_subscriber.load(Ordering::Relaxed))
    }

    fn publish(&mut self, publisher: usize, bytes: &[u8]) -> Result<()> {
        let Some(own) = self.publishers.get_mut(publisher) else {
            return Ok(());
        };
        own.sequence += 1;
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let now_ns = since.map_or(0, |since| {
            i64::try_from(since.as_nanos()).unwrap_or(i64::MAX)
        });
        let mut attachment = [16; 33];
        attachment[..8].copy_from_slice(&own.sequence.to_le_bytes());
        attachment[8..16].copy_from_slice(&now_ns.to_le_bytes());
        attachment[17..].copy_from_slice(&own.id);
        let put = own.publisher.put(bytes).attachment(attachment).wait();
        put.map_err(failed)
    }

    fn warnings(&mut self) -> Vec<String> {
        let others = self.graph().endpoints;
        let mut words = Vec::new();
        for other in others {
            let is_ours = self.publishers.iter().any(|own| own.topic == other.topic);
            if is_ours
                && !other.is_publisher
                && other.is_transient_local
                && self.warned.insert(other.clone())
            {
                words.push(format!(
                    "QoS: {} requests `{}` as transient local, but it is published as volatile: {} gets no messages from before it began",
                    other.node, other.topic, other.node
                ));
            }
        }
        words
    }

    fn close(mut self: Box<Self>) {
        self.subscribers.clear();
        self.publishers.clear();
        // what cannot be closed in order is closed by the end of the process
        let _ = self.session.close().wait();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_of_others_are_read_and_ours_left_out() {
        let token = "@ros2_lv/0/aa/0/11/MS/%/%robot/listener/%joint_states/sensor_msgs::msg::dds_::JointState_/RIHS01_x/:1:,10:,:,:,,";
        let endpoint = read_token(token, "bb").unwrap();
        assert_eq!(endpoint.node, "/robot/listener");
        assert_eq!(endpoint.topic, "/joint_states");
        assert_eq!(endpoint.type_name, "sensor_msgs/JointState");
        assert!(endpoint.is_transient_local && !endpoint.is_publisher);
        assert!(read_token(token, "aa").is_none());
        assert!(read_token("@ros2_lv/0/aa/0/0/NN/%/%/talker", "bb").is_none());
    }
}
