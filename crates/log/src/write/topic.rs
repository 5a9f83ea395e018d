//! Topics of known types in an MCAP file for ROS 2.

use std::io::{self, Write};

use super::{McapWriter, Times, invalid};
use crate::message::{Definition, Value, known};

/// A topic of a known type, to which messages are sent.
#[derive(Clone, Debug)]
pub struct Topic {
    id: u16,
    definition: Definition,
    sent: u32,
}

impl<W: Write> McapWriter<W> {
    /// Begins a topic of one of the types of [`known`].
    ///
    /// # Errors
    /// `InvalidInput` for a type that is not known.
    pub fn topic(&mut self, topic: &str, type_name: &str) -> io::Result<Topic> {
        let channel =
            known::channel(topic, type_name).ok_or_else(|| invalid("the type is not known"))?;
        let text = String::from_utf8_lossy(&channel.definition);
        let definition = Definition::parse(type_name, &text).map_err(io::Error::other)?;
        let id = self.channel(&channel)?;
        Ok(Topic {
            id,
            definition,
            sent: 0,
        })
    }

    /// Writes a message of a topic, recorded and published at `time_ns`.
    ///
    /// # Errors
    /// `InvalidInput` for a time before 1970; what the definition does not hold; what the system refuses.
    pub fn send(&mut self, topic: &mut Topic, time_ns: i64, value: &Value) -> io::Result<()> {
        let data = topic.definition.encode(value);
        let data = data.map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error))?;
        self.send_encoded(topic, time_ns, &data)
    }

    /// As [`McapWriter::send`], of a message that a [`CdrWriter`](crate::message::CdrWriter) wrote.
    ///
    /// # Errors
    /// `InvalidInput` for a time before 1970; what the system refuses.
    pub fn send_encoded(&mut self, topic: &mut Topic, time_ns: i64, data: &[u8]) -> io::Result<()> {
        let time = u64::try_from(time_ns).map_err(|_| invalid("MCAP holds no time before 1970"))?;
        topic.sent = topic.sent.wrapping_add(1);
        let times = Times {
            sequence: topic.sent,
            ..Times::at(time)
        };
        self.message(topic.id, times, data)
    }
}
