//! A table that is still written, as a file without an end.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::thread::sleep;
use std::time::Duration;

/// How often a file is looked at that has not grown.
const LOOK_INTERVAL: Duration = Duration::from_millis(50);

/// Reads a file; at its end waits until it has grown. A file that has become shorter was begun anew: it ends.
pub(crate) struct Growing<F> {
    file: File,
    /// Called before each wait.
    on_wait: F,
}

impl<F: FnMut()> Growing<F> {
    pub(crate) const fn new(file: File, on_wait: F) -> Self {
        Self { file, on_wait }
    }
}

impl<F: FnMut()> Read for Growing<F> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let length = self.file.read(buffer)?;
            if length > 0 || buffer.is_empty() {
                return Ok(length);
            }
            (self.on_wait)();
            if self.file.metadata()?.len() < self.file.stream_position()? {
                return Ok(0);
            }
            sleep(LOOK_INTERVAL);
        }
    }
}

impl<F> Seek for Growing<F> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}
