//! Fields written one after the other: CDR as ROS 2 writes it (XCDR 1, little-endian).

use std::fmt::Display;
use std::io::Write as _;

use super::MessageError;

/// The encapsulation: plain CDR, little-endian.
const HEAD: [u8; 4] = [0, 1, 0, 0];

/// `std_msgs/Header` of a message to be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header<'a> {
    /// The stamp, ns since 1970.
    pub time_ns: i64,
    /// The frame.
    pub frame: &'a str,
}

/// Writes the fields of one message into a buffer that is used again: for messages of a known type at a high rate, since
/// nothing is allocated once the buffer is as long as the message.
///
/// The caller writes the fields in the order of the type's definition. Nothing checks it:
/// [`Definition::encode`](super::Definition::encode) does, from fields with names.
///
/// ```
/// use grouser_log::message::{CdrWriter, Definition, Value, build};
///
/// let mut bytes = Vec::new();
/// let mut out = CdrWriter::new(&mut bytes);
/// out.text("left")?;
/// out.float64(0.1);
/// let definition = Definition::parse("demo/msg/Tilt", "string name\nfloat64 roll\n")?;
/// let fields = build::message([("name", Value::Text("left".into())), ("roll", Value::Float(0.1))]);
/// assert_eq!(bytes, definition.encode(&fields)?);
/// # Ok::<(), grouser_log::message::MessageError>(())
/// ```
#[derive(Debug)]
pub struct CdrWriter<'a> {
    bytes: &'a mut Vec<u8>,
}

impl<'a> CdrWriter<'a> {
    /// Begins a message in the place of what the buffer held.
    pub fn new(bytes: &'a mut Vec<u8>) -> Self {
        bytes.clear();
        bytes.extend_from_slice(&HEAD);
        Self { bytes }
    }

    /// A number by its bytes, the least first, aligned to its size.
    pub(super) fn number(&mut self, number: &[u8]) {
        // places are counted from behind the encapsulation
        let body = self.bytes.len() - HEAD.len();
        let at = HEAD.len() + body.next_multiple_of(number.len());
        self.bytes.resize(at, 0);
        self.bytes.extend_from_slice(number);
    }

    /// Bytes as they are.
    pub(super) fn raw(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// `int32`.
    pub fn int32(&mut self, value: i32) {
        self.number(&value.to_le_bytes());
    }

    /// `uint32`.
    pub fn uint32(&mut self, value: u32) {
        self.number(&value.to_le_bytes());
    }

    /// `float64`.
    pub fn float64(&mut self, value: f64) {
        self.number(&value.to_le_bytes());
    }

    /// Fields of `float64`, or an array of fixed length.
    pub fn float64s<const N: usize>(&mut self, values: [f64; N]) {
        for value in values {
            self.float64(value);
        }
    }

    /// The number of elements that follow, of an array of any length.
    ///
    /// # Errors
    /// [`MessageError::Unfit`] for 2³² or more.
    pub fn length(&mut self, length: usize) -> Result<(), MessageError> {
        self.uint32(length_of(length)?);
        Ok(())
    }

    /// `string`.
    ///
    /// # Errors
    /// [`MessageError::Unfit`] for a text of 4 GiB.
    pub fn text(&mut self, text: impl Display) -> Result<(), MessageError> {
        self.uint32(0);
        let start = self.bytes.len();
        // a vector refuses nothing
        let _ = write!(self.bytes, "{text}\0");
        let length = length_of(self.bytes.len() - start)?;
        self.bytes[start - 4..start].copy_from_slice(&length.to_le_bytes());
        Ok(())
    }

    /// `string[]`.
    ///
    /// # Errors
    /// As [`CdrWriter::text`].
    pub fn texts<T: Display>(
        &mut self,
        texts: impl ExactSizeIterator<Item = T>,
    ) -> Result<(), MessageError> {
        self.length(texts.len())?;
        for text in texts {
            self.text(text)?;
        }
        Ok(())
    }

    /// `float64[]`.
    ///
    /// # Errors
    /// As [`CdrWriter::length`].
    pub fn numbers(
        &mut self,
        numbers: impl ExactSizeIterator<Item = f64>,
    ) -> Result<(), MessageError> {
        self.length(numbers.len())?;
        for number in numbers {
            self.float64(number);
        }
        Ok(())
    }

    /// `std_msgs/Header`.
    ///
    /// # Errors
    /// [`MessageError::Unfit`] for a time that 32 bits of seconds do not hold (after 2038).
    pub fn header(&mut self, header: Header<'_>) -> Result<(), MessageError> {
        let seconds = header.time_ns.div_euclid(1_000_000_000);
        self.int32(i32::try_from(seconds).map_err(|_| MessageError::Unfit {
            field: "sec".to_owned(),
            expected: "4 bytes, signed".to_owned(),
        })?);
        let rest = header.time_ns.rem_euclid(1_000_000_000);
        self.uint32(u32::try_from(rest).unwrap_or_default());
        self.text(header.frame)
    }
}

fn length_of(length: usize) -> Result<u32, MessageError> {
    u32::try_from(length).map_err(|_| MessageError::Unfit {
        field: "the length of an array or a text".to_owned(),
        expected: "below 2^32".to_owned(),
    })
}
