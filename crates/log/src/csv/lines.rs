//! Lines of a table, with a limit to their length.

use std::io::{BufRead, Read};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use crate::error::{Cell, Error, Result};
use crate::source::Source;

/// The maximum length of a line, bytes.
pub const LINE_LIMIT: usize = 1 << 20;

/// The lines of a table, one by one, in a buffer that is used again.
///
/// ```
/// use grouser_log::csv::Lines;
///
/// let mut lines = Lines::over(&b"slip,load_n\n0.2,40\n"[..], "runs.csv");
/// assert!(lines.advance()? && lines.text()? == "slip,load_n");
/// assert!(lines.advance()? && lines.text()? == "0.2,40");
/// assert_eq!(lines.cell().to_string(), "runs.csv: line 2");
/// assert!(!lines.advance()?);
/// # Ok::<(), grouser_log::Error>(())
/// ```
pub struct Lines<R = Box<dyn BufRead + Send>> {
    input: R,
    file: String,
    line: u64,
    bytes: u64,
    is_ended: bool,
    buffer: Vec<u8>,
}

impl Lines {
    /// Opens a regular file; a gzip file is decompressed, whatever its name.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn open(path: &Path) -> Result<Self> {
        Self::from_source(&Source::file(path.to_owned()), &Arc::default())
    }

    /// Bytes that are read of the file are added to `count`.
    pub(crate) fn from_source(source: &Source, count: &Arc<AtomicU64>) -> Result<Self> {
        Ok(Self::over(source.text(count)?, &source.name()))
    }
}

/// The names of a header line that is marked as a comment, as `# timestamp tx ty` is.
pub(crate) fn names(line: &str) -> &str {
    line.strip_prefix("# ").unwrap_or(line)
}

impl<R: BufRead> Lines<R> {
    /// Reads from `input`; errors call it `file`.
    ///
    /// ```
    /// use grouser_log::csv::Lines;
    ///
    /// let mut lines = Lines::over(&b""[..], "empty.csv");
    /// assert!(!lines.advance()?);
    /// # Ok::<(), grouser_log::Error>(())
    /// ```
    pub fn over(input: R, file: &str) -> Self {
        Self {
            input,
            file: file.to_owned(),
            line: 0,
            bytes: 0,
            is_ended: true,
            buffer: Vec::new(),
        }
    }

    /// The place of the current line.
    ///
    /// ```
    /// use grouser_log::csv::Lines;
    ///
    /// let mut lines = Lines::over(&b"slip\n"[..], "runs.csv");
    /// lines.advance()?;
    /// assert_eq!(lines.cell().to_string(), "runs.csv: line 1");
    /// # Ok::<(), grouser_log::Error>(())
    /// ```
    #[must_use]
    pub fn cell(&self) -> Cell {
        Cell {
            file: self.file.clone(),
            line: self.line,
            column: None,
            name: None,
        }
    }

    /// The number of the current line, from 1.
    #[must_use]
    pub const fn number(&self) -> u64 {
        self.line
    }

    /// Does a line end close the current line? The last one of a file without it may be cut off.
    pub(crate) const fn is_ended(&self) -> bool {
        self.is_ended
    }

    /// Bytes read so far.
    #[must_use]
    pub const fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Moves to the next line; returns false at the end.
    ///
    /// A line ends with LF or CR LF. A UTF-8 byte-order mark before the first line is left out.
    ///
    /// # Errors
    /// [`Error::LongLine`]; [`Error::Unreadable`] for what the system or the decompressor refuses.
    pub fn advance(&mut self) -> Result<bool> {
        self.buffer.clear();
        self.line += 1;
        let limit = LINE_LIMIT as u64 + 2;
        let read = (&mut self.input)
            .take(limit)
            .read_until(b'\n', &mut self.buffer);
        self.bytes += self.buffer.len() as u64;
        if let Err(source) = read {
            return Err(Error::Unreadable {
                at: self.cell(),
                source,
            });
        }
        if self.buffer.is_empty() {
            return Ok(false);
        }
        self.is_ended = self.buffer.last() == Some(&b'\n');
        if self.is_ended {
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
        if self.line == 1 && self.buffer.starts_with(b"\xef\xbb\xbf") {
            self.buffer.drain(..3);
        }
        Ok(true)
    }

    /// The current line as text, without its end.
    ///
    /// ```
    /// use grouser_log::csv::Lines;
    ///
    /// let mut lines = Lines::over(&b"\xef\xbb\xbfslip\r\n"[..], "runs.csv");
    /// lines.advance()?;
    /// assert_eq!(lines.text()?, "slip"); // without mark and line end
    /// # Ok::<(), grouser_log::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Malformed`] for bytes that are not UTF-8, a NUL byte, or a carriage return inside the line.
    pub fn text(&self) -> Result<&str> {
        let bytes = &self.buffer[..];
        let what = if self.line == 1
            && [b"\xff\xfe", b"\xfe\xff"]
                .iter()
                .any(|mark| bytes.starts_with(*mark))
        {
            "is UTF-16, but must be UTF-8"
        } else if bytes.contains(&0) {
            "holds a NUL byte"
        } else if bytes.contains(&b'\r') {
            "holds a carriage return that does not end it"
        } else if let Ok(text) = std::str::from_utf8(bytes) {
            return Ok(text);
        } else {
            "is not UTF-8 text"
        };
        Err(Error::Malformed {
            at: self.cell(),
            what,
        })
    }
}
