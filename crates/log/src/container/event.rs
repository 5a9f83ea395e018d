//! What a container holds: its format, its channels, and what reading it gives.

use std::collections::BTreeMap;
use std::sync::Arc;

/// How the bytes of a message are laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Encoding {
    /// ROS 1.
    Ros1,
    /// ROS 2: CDR.
    Cdr,
    /// JSON.
    Json,
    /// Something that is not read.
    Other,
}

/// A topic with its type.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The topic.
    pub topic: String,
    /// The full name of the message's type, as the file writes it.
    pub type_name: String,
    /// How its messages are laid out.
    pub encoding: Encoding,
    /// That encoding's name in MCAP.
    pub encoding_name: String,
    /// What language the definition is in, by its name in MCAP.
    pub definition_language: String,
    /// The definition of the type; equal ones of a file are held once.
    pub definition: Arc<[u8]>,
    /// What else the file says of it: of an MCAP file its metadata, of a bag the fields of its connection.
    pub metadata: BTreeMap<String, String>,
}

/// One message.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Message<'a> {
    /// The index of its channel in [`Container::channels`](super::Container::channels).
    pub channel: usize,
    /// That channel.
    pub of: &'a Channel,
    /// When it was recorded, ns.
    pub log_time_ns: u64,
    /// When it was published, ns, where the file states it; else as recorded.
    pub publish_time_ns: u64,
    /// Its number, where the file counts.
    pub sequence: u32,
    /// Its bytes.
    pub data: &'a [u8],
}

/// A place that could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Damage {
    /// Where it begins, bytes from the file's start.
    pub offset: u64,
    /// How many bytes of the file are lost there.
    pub bytes: u64,
    /// How many messages are lost there, where the chunk's index follows and states it.
    pub messages: Option<u64>,
    /// What is wrong.
    pub what: String,
}

/// What comes next in a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Event<'a> {
    /// A message.
    Message(Message<'a>),
    /// A place that could not be read; what follows it is read.
    Damage(Damage),
}

/// A kind of file.
///
/// ```
/// use grouser_log::container::Format;
///
/// assert_ne!(Format::Mcap.name(), Format::Bag.name());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// MCAP.
    Mcap,
    /// A ROS 1 bag.
    Bag,
    /// A SQLite database of rosbag2.
    Rosbag2,
}

impl Format {
    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mcap => "MCAP",
            Self::Bag => "ROS 1 bag",
            Self::Rosbag2 => "rosbag2 database",
        }
    }
}
