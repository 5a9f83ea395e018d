//! Lines of a table, with a limit to their length.

use std::io::{BufRead, Read};

use crate::error::{Cell, Error, Result};

/// The greatest length of a line, bytes.
pub const LINE_LIMIT: usize = 1 << 20;

/// Reads lines one by one into a buffer that it keeps.
pub(crate) struct Lines {
    input: Box<dyn BufRead + Send>,
    file: String,
    line: u64,
    buffer: Vec<u8>,
}

impl Lines {
    pub(crate) fn new(input: Box<dyn BufRead + Send>, file: String) -> Self {
        Self {
            input,
            file,
            line: 0,
            buffer: Vec::new(),
        }
    }

    /// The place of the line that was read last.
    pub(crate) fn cell(&self) -> Cell {
        Cell {
            file: self.file.clone(),
            line: self.line,
            column: None,
            name: None,
        }
    }

    /// Moves to the next line: true if there is one.
    ///
    /// A line ends with LF or CR LF; a byte-order mark of UTF-8 before the first is left out.
    pub(crate) fn advance(&mut self) -> Result<bool> {
        self.buffer.clear();
        self.line += 1;
        let limit = LINE_LIMIT as u64 + 2;
        let read = (&mut self.input)
            .take(limit)
            .read_until(b'\n', &mut self.buffer);
        if let Err(source) = read {
            return Err(Error::Unreadable {
                at: self.cell(),
                source,
            });
        }
        if self.buffer.is_empty() {
            return Ok(false);
        }
        if self.buffer.last() == Some(&b'\n') {
            self.buffer.pop();
            if self.buffer.last() == Some(&b'\r') {
                self.buffer.pop();
            }
        }
        if self.buffer.len() > LINE_LIMIT {
            return Err(Error::LongLine {
                at: self.cell(),
                limit: LINE_LIMIT,
            });
        }
        if self.line == 1 {
            if self.buffer.starts_with(&[0xef, 0xbb, 0xbf]) {
                self.buffer.drain(..3);
            } else if self.buffer.starts_with(&[0xff, 0xfe])
                || self.buffer.starts_with(&[0xfe, 0xff])
            {
                return Err(self.malformed("is UTF-16, but must be UTF-8"));
            }
        }
        if self.buffer.contains(&0) {
            return Err(self.malformed("holds a NUL byte"));
        }
        if self.buffer.contains(&b'\r') {
            return Err(self.malformed("holds a carriage return that does not end it"));
        }
        Ok(true)
    }

    pub(crate) fn malformed(&self, what: &'static str) -> Error {
        Error::Malformed {
            at: self.cell(),
            what,
        }
    }

    /// The line that was read last.
    pub(crate) fn text(&self) -> Result<&str> {
        std::str::from_utf8(&self.buffer).map_err(|_| self.malformed("is not UTF-8 text"))
    }
}
