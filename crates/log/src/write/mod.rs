//! Writing of MCAP files and ROS 1 bags, message by message.

mod bag;
mod chunk;
mod copy;
mod mcap;
mod samples;
mod table;
mod topic;

use std::io::{self, Seek, Write};

use lz4_flex::frame::{BlockSize, FrameEncoder, FrameInfo};

use crate::container::{Channel, Format};
pub use bag::BagWriter;
pub use copy::{Copied, copy, verify};
pub use mcap::McapWriter;
pub use samples::SampleWriter;
pub use table::{Table, write_table};
pub use topic::Topic;

/// When a message was recorded and published, ns, and its number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Times {
    /// When it was recorded, ns.
    pub log_ns: u64,
    /// When it was published, ns.
    pub publish_ns: u64,
    /// Its number on its channel; 0 where nobody counts.
    pub sequence: u32,
}

impl Times {
    /// Recorded and published at once.
    ///
    /// ```
    /// use grouser_log::write::Times;
    ///
    /// assert_eq!(Times::at(5).publish_ns, 5);
    /// ```
    #[must_use]
    pub const fn at(time_ns: u64) -> Self {
        Self {
            log_ns: time_ns,
            publish_ns: time_ns,
            sequence: 0,
        }
    }
}

/// A file of either format.
pub enum Writer<W: Write + Seek> {
    /// MCAP.
    Mcap(McapWriter<W>),
    /// A ROS 1 bag.
    Bag(BagWriter<W>),
}

impl<W: Write + Seek> Writer<W> {
    /// Begins a file; `profile` is MCAP's: `ros1`, `ros2` or empty.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn new(out: W, format: Format, profile: &str) -> io::Result<Self> {
        Ok(match format {
            Format::Mcap => Self::Mcap(McapWriter::new(out, profile)?),
            Format::Bag => Self::Bag(BagWriter::new(out)?),
            Format::Rosbag2 => return Err(invalid("databases of rosbag2 are not written")),
        })
    }

    /// Enters a channel; its number is for [`Writer::message`].
    ///
    /// # Errors
    /// What the system refuses; `InvalidInput` for a channel that the format does not hold.
    pub fn channel(&mut self, channel: &Channel) -> io::Result<u16> {
        match self {
            Self::Mcap(writer) => writer.channel(channel),
            Self::Bag(writer) => writer.channel(channel),
        }
    }

    /// Writes a message of a channel.
    ///
    /// # Errors
    /// What the system refuses; `InvalidInput` for a channel that was never entered.
    pub fn message(&mut self, channel: u16, times: Times, data: &[u8]) -> io::Result<()> {
        match self {
            Self::Mcap(writer) => writer.message(channel, times, data),
            Self::Bag(writer) => writer.message(channel, times, data),
        }
    }

    /// Ends the file with its index.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn finish(self) -> io::Result<W> {
        match self {
            Self::Mcap(writer) => writer.finish(),
            Self::Bag(writer) => writer.finish(),
        }
    }
}

/// What stays below 4 GiB because memory does.
fn length_u32(length: usize) -> io::Result<u32> {
    u32::try_from(length).map_err(|_| invalid("a text or a message is longer than 4 GiB"))
}

fn invalid(what: &'static str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, what)
}

/// A frame of LZ4, in blocks of 64 KiB: of a frame that is cut, all whole blocks can be read.
fn lz4(content: &[u8]) -> io::Result<Vec<u8>> {
    let info = FrameInfo::new().block_size(BlockSize::Max64KB);
    let mut encoder = FrameEncoder::with_frame_info(info, Vec::new());
    encoder.write_all(content)?;
    encoder.finish().map_err(io::Error::other)
}
