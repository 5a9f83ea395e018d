//! `--record`: the messages that come in and go out, as an MCAP file.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use grouser_log::container::Channel;
use grouser_log::write::{McapWriter, Times};

use crate::error::{Error, Result};

/// A file in the making: a chunk is written after a second of messages.
pub(crate) struct Recorder {
    path: PathBuf,
    // not buffered: each chunk is whole in the file once it is written
    writer: McapWriter<File>,
    sequence: u32,
}

impl Recorder {
    /// Begins a new file.
    ///
    /// # Errors
    /// [`Error::File`], also where the file exists.
    pub(crate) fn create(path: &Path) -> Result<Self> {
        let failed = |source| Error::File {
            path: path.to_owned(),
            source,
        };
        let file = File::create_new(path).map_err(failed)?;
        let writer = McapWriter::new(file, "ros2").map_err(failed)?;
        Ok(Self {
            path: path.to_owned(),
            writer,
            sequence: 0,
        })
    }

    /// Enters a topic.
    pub(crate) fn channel(&mut self, channel: &Channel) -> io::Result<u16> {
        self.writer.channel(channel)
    }

    /// A message that came in or went out at `time_ns`.
    pub(crate) fn message(&mut self, channel: u16, time_ns: u64, bytes: &[u8]) -> io::Result<()> {
        self.sequence = self.sequence.wrapping_add(1);
        let mut times = Times::at(time_ns);
        times.sequence = self.sequence;
        self.writer.message(channel, times, bytes)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// [`Error::File`].
    pub(crate) fn finish(self) -> Result<PathBuf> {
        let path = self.path;
        match self.writer.finish() {
            Ok(_) => Ok(path),
            Err(source) => Err(Error::File { path, source }),
        }
    }
}
