//! A bag or an MCAP file, whole or damaged, written anew with everything that can be read of it.

use std::io::{Seek, Write};
use std::path::Path;

use super::{Times, Writer};
use crate::container::{Container, Damage, Event, Format};
use crate::error::{Error, Result};

/// This many damages are kept; more are only counted.
const DAMAGES: usize = 1000;

/// What was written, and what was lost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Copied {
    /// The kind of file that was read.
    pub from: Format,
    /// Messages written.
    pub messages: u64,
    /// Channels with messages: topic, type and number of messages.
    pub channels: Vec<(String, String, u64)>,
    /// The first places that could not be read.
    pub damages: Vec<Damage>,
    /// How many there are in all.
    pub damage_count: u64,
    /// Bytes of the file that are lost in them.
    pub bytes_lost: u64,
    /// Messages that are lost in them, as far as the file states it.
    pub messages_lost: u64,
    /// Attachments and metadata records, which are not carried over.
    pub attached: u64,
    /// The CRC of all messages in their order.
    digest: u32,
}

impl Copied {
    /// Is anything lost?
    #[must_use]
    pub const fn is_partial(&self) -> bool {
        self.damage_count > 0 || self.attached > 0
    }
}

/// Adds a message to a digest: topic, time of recording, bytes.
fn digest(crc: &mut crc32fast::Hasher, topic: &str, log_time_ns: u64, data: &[u8]) {
    crc.update(topic.as_bytes());
    crc.update(&log_time_ns.to_le_bytes());
    crc.update(&(data.len() as u64).to_le_bytes());
    crc.update(data);
}

/// Copies every message that can be read of `path`, with its channel, times and number, in the order of
/// the file. `progress` receives the number of bytes read.
///
/// A bag has one time for each message and no numbers, and takes messages of ROS 1 only.
///
/// # Errors
/// What does not let the file be opened; [`Error::Output`] for what cannot be written. Damage is no
/// error: it is listed.
pub fn copy<W: Write + Seek>(
    path: &Path,
    out: W,
    format: Format,
    mut progress: impl FnMut(u64),
) -> Result<Copied> {
    let mut container = Container::open(path)?;
    let mut crc = crc32fast::Hasher::new();
    let profile = profile(path)?;
    let mut writer = Writer::new(out, format, &profile).map_err(Error::Output)?;
    // By channel of the source: its number in the target, and its messages.
    let mut ids: Vec<Option<(u16, u64)>> = Vec::new();
    let mut copied = Copied {
        from: container.format(),
        messages: 0,
        channels: Vec::new(),
        damages: Vec::new(),
        damage_count: 0,
        bytes_lost: 0,
        messages_lost: 0,
        attached: 0,
        digest: 0,
    };
    loop {
        progress(container.offset());
        match container.next() {
            None => break,
            Some(Event::Damage(damage)) => {
                copied.damage_count += 1;
                copied.bytes_lost += damage.bytes;
                copied.messages_lost += damage.messages.unwrap_or(0);
                if copied.damages.len() < DAMAGES {
                    copied.damages.push(damage);
                }
            }
            Some(Event::Message(message)) => {
                if ids.len() <= message.channel {
                    ids.resize(message.channel + 1, None);
                }
                let place = &mut ids[message.channel];
                if place.is_none() {
                    let id = writer.channel(message.of).map_err(Error::Output)?;
                    *place = Some((id, 0));
                }
                if let Some((id, count)) = place {
                    let times = Times {
                        log_ns: message.log_time_ns,
                        publish_ns: message.publish_time_ns,
                        sequence: message.sequence,
                    };
                    let written = writer.message(*id, times, message.data);
                    written.map_err(Error::Output)?;
                    *count += 1;
                    copied.messages += 1;
                    digest(
                        &mut crc,
                        &message.of.topic,
                        message.log_time_ns,
                        message.data,
                    );
                }
            }
        }
    }
    writer.finish().map_err(Error::Output)?;
    let channels = container.channels().iter().zip(&ids);
    copied.channels = channels
        .filter_map(|(channel, id)| {
            let (_, count) = (*id)?;
            Some((channel.topic.clone(), channel.type_name.clone(), count))
        })
        .collect();
    copied.attached = container.attached();
    copied.digest = crc.finalize();
    Ok(copied)
}

/// Whose conventions the file says it follows: that stands before its first message.
fn profile(path: &Path) -> Result<String> {
    let mut container = Container::open(path)?;
    container.next();
    Ok(container.profile().to_owned())
}

/// Reads what was written once more: is every message there as it was read, and no damage?
///
/// # Errors
/// [`Error::Differs`]; what does not let the file be opened.
pub fn verify(path: &Path, copied: &Copied) -> Result<()> {
    let mut container = Container::open(path)?;
    let mut crc = crc32fast::Hasher::new();
    let mut messages = 0;
    while let Some(event) = container.next() {
        match event {
            Event::Damage(damage) => {
                return Err(Error::Differs {
                    what: format!("at byte {}: {}", damage.offset, damage.what),
                });
            }
            Event::Message(message) => {
                messages += 1;
                digest(
                    &mut crc,
                    &message.of.topic,
                    message.log_time_ns,
                    message.data,
                );
            }
        }
    }
    if messages != copied.messages {
        return Err(Error::Differs {
            what: format!("{messages} messages, {} were written", copied.messages),
        });
    }
    if crc.finalize() != copied.digest {
        return Err(Error::Differs {
            what: "the messages' bytes or times".to_owned(),
        });
    }
    Ok(())
}
