//! What carries messages: bytes by topic, and the graph of who sends and receives them.

#[cfg(feature = "dds")]
mod dds;
#[cfg(feature = "dds")]
mod dds_node;
mod inbox;
mod names;
#[cfg(feature = "zenoh")]
mod zenoh;

pub use inbox::{Arrival, Arrivals, Fetched, Inbox, PublisherId, Source, inbox};

use crate::environment::Environment;
use crate::error::{Error, Result};

/// Which transport.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Kind {
    /// Zenoh, as rmw_zenoh uses it.
    Zenoh,
    /// DDS, as rmw_fastrtps and rmw_cyclonedds use it.
    Dds,
}

/// The threads of Zenoh: by default five, of which four wake for each message. Of a node with 400 messages a second they take
/// 2.9 to 3.6 % of a processor, one alone 1.6 to 1.8 % (RESULTS.md, "The node").
const ONE_ZENOH_THREAD: (&str, &str) = (
    "ZENOH_RUNTIME",
    "(rx: (handover: net), tx: (handover: net), acc: (handover: net), app: (handover: net))",
);
/// One heap for all threads of glibc: another thread frees a message than the one that received it. With a heap for each thread
/// memory is 2 MB larger (RESULTS.md, same place).
const ONE_HEAP: (&str, &str) = ("MALLOC_ARENA_MAX", "1");

impl Kind {
    /// A variable, with its value, that the transport needs at the start of the program.
    pub(crate) const fn variable(self) -> (&'static str, &'static str) {
        match self {
            Self::Zenoh => ONE_ZENOH_THREAD,
            Self::Dds => ONE_HEAP,
        }
    }

    /// Its name in options and messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Zenoh => "zenoh",
            Self::Dds => "dds",
        }
    }
}

/// A publisher or subscriber of another program.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Endpoint {
    /// The topic, with its slash.
    pub topic: String,
    /// The type, `sensor_msgs/JointState`.
    pub type_name: String,
    /// The hash of the type's definition, where the other side states one.
    pub type_hash: Option<String>,
    /// The node, where it is known.
    pub node: String,
    /// Does it publish?
    pub is_publisher: bool,
    /// Is it reliable?
    pub is_reliable: bool,
    /// Does it keep or request what was sent before (transient local)?
    pub is_transient_local: bool,
}

/// Who else is there.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    /// Publishers and subscribers of other programs.
    pub endpoints: Vec<Endpoint>,
}

/// Carries bytes. A number that `subscribe` and `advertise` take or return is the caller's handle.
pub trait Transport {
    /// Who else is there now.
    fn graph(&mut self) -> Graph;

    /// Receives what is sent to the topic of a publisher, marked with `subscription`.
    ///
    /// # Errors
    /// [`Error::Transport`].
    fn subscribe(&mut self, subscription: usize, publisher: &Endpoint, inbox: &Inbox)
    -> Result<()>;

    /// Ends a subscription.
    fn unsubscribe(&mut self, subscription: usize);

    /// Announces a topic of a known type; returns its number for [`Transport::publish`].
    ///
    /// # Errors
    /// [`Error::Transport`], [`Error::UnknownType`].
    fn advertise(&mut self, topic: &str, type_name: &str) -> Result<usize>;

    /// Does anyone receive this topic? Where nobody does, its messages need not be made.
    fn has_subscriber(&mut self, publisher: usize) -> bool;

    /// Sends a message in CDR, with its encapsulation, to an announced topic.
    ///
    /// # Errors
    /// [`Error::Transport`].
    fn publish(&mut self, publisher: usize, bytes: &[u8]) -> Result<()>;

    /// What the transport reports since the last call, in words: incompatible qualities of service.
    fn warnings(&mut self) -> Vec<String>;

    /// Nothing has arrived for long: announces everything anew, where the transport may have lost a peer that is still there.
    ///
    /// # Errors
    /// [`Error::Transport`]; what was announced before is kept then.
    fn renew(&mut self) -> Result<()> {
        Ok(())
    }

    /// Leaves the graph.
    fn close(self: Box<Self>);
}

/// Opens a transport as the node `node`, a full name with its slash.
///
/// # Errors
/// [`Error::Transport`]; [`Error::NoTransport`] for one that was not built in.
pub fn open(kind: Kind, environment: &Environment, node: &str) -> Result<Box<dyn Transport>> {
    match kind {
        #[cfg(feature = "zenoh")]
        Kind::Zenoh => Ok(Box::new(zenoh::ZenohTransport::open(environment, node)?)),
        #[cfg(feature = "dds")]
        Kind::Dds => Ok(Box::new(dds::DdsTransport::open(environment, node)?)),
        #[allow(
            unreachable_patterns,
            reason = "reached where a transport is not built in"
        )]
        other => {
            let _ = (environment, node);
            Err(Error::NoTransport { name: other.name() })
        }
    }
}
