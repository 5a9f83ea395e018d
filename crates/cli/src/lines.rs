//! The lines of a text file, one at a time, of bounded length.

use std::io::{BufRead as _, BufReader, Read as _};

use crate::error::{Error, Result};
use crate::input::Input;

/// A longer line is no row of a table.
const LONGEST: u64 = 1 << 20;

/// By how much a line may be longer than the one before without a second allocation, bytes.
const ROOM_TO_SPARE: usize = 32;

/// The lines of an input, without their ends.
pub(crate) struct Lines {
    reader: BufReader<Input>,
    /// Of the line read last, from 1.
    number: u64,
    bytes: u64,
    /// Room for a line: that of the one before.
    room: usize,
}

/// One line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Line {
    /// From 1.
    pub(crate) number: u64,
    /// What it says; bytes that are not UTF-8 became U+FFFD.
    pub(crate) text: String,
    /// Was it UTF-8?
    pub(crate) is_text: bool,
}

impl Lines {
    /// The lines of `input`.
    pub(crate) fn of(input: Input) -> Self {
        Self {
            reader: BufReader::new(input),
            number: 0,
            bytes: 0,
            room: 0,
        }
    }

    /// The next line; `None` at the end. A byte order mark before the first is left out.
    pub(crate) fn next(&mut self) -> Result<Option<Line>> {
        let mut bytes = Vec::with_capacity(self.room);
        let count = self
            .reader
            .by_ref()
            .take(LONGEST + 1)
            .read_until(b'\n', &mut bytes)
            .map_err(|error| Error::file("read", self.reader.get_ref().path(), &error))?;
        if count == 0 {
            return Ok(None);
        }
        self.number += 1;
        self.bytes += count as u64;
        self.room = count + ROOM_TO_SPARE;
        if bytes.last() != Some(&b'\n') && bytes.len() as u64 > LONGEST {
            return Err(Error::content(
                self.reader.get_ref().path(),
                format!("line {} is longer than the limit of 1 MiB", self.number),
                None,
            ));
        }
        while bytes
            .last()
            .is_some_and(|byte| matches!(byte, b'\n' | b'\r'))
        {
            bytes.pop();
        }
        if self.number == 1 && bytes.starts_with(b"\xef\xbb\xbf") {
            bytes.drain(..3);
        }
        let (text, is_text) = match String::from_utf8(bytes) {
            Ok(text) => (text, true),
            Err(error) => (
                String::from_utf8_lossy(error.as_bytes()).into_owned(),
                false,
            ),
        };
        Ok(Some(Line {
            number: self.number,
            text,
            is_text,
        }))
    }

    /// Bytes read so far.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The input, read to where the lines ended.
    pub(crate) fn into_input(self) -> Input {
        self.reader.into_inner()
    }
}
