//! From bytes to fields: ROS 1 serialization and CDR (the plain encapsulations of XCDR 1).

use super::definition::{Definition, Field, Kind, Many};
use super::{MessageError, Value};

/// How many elements and fields a message may have in all, bytes in arrays of bytes aside: each takes
/// about 50 bytes of memory, whatever it took in the message.
const ELEMENT_LIMIT: usize = 1 << 18;

/// How numbers and texts stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    /// Little-endian, packed.
    Ros1,
    /// Aligned to their size from the start.
    Cdr { big_endian: bool },
}

impl Layout {
    /// The layout that a message of CDR declares, and the bytes after that.
    pub(super) fn of_cdr(data: &[u8]) -> Result<(Self, &[u8]), MessageError> {
        match data {
            [0, kind @ (0 | 1), _, _, body @ ..] => Ok((
                Self::Cdr {
                    big_endian: *kind == 0,
                },
                body,
            )),
            [a, b, _, _, ..] => Err(MessageError::Layout {
                found: format!("encapsulation {:#06x}", u16::from_be_bytes([*a, *b])),
            }),
            _ => Err(MessageError::Short {
                field: "the encapsulation".to_owned(),
            }),
        }
    }
}

pub(super) fn decode(
    definition: &Definition,
    data: &[u8],
    layout: Layout,
) -> Result<Value, MessageError> {
    let mut cursor = Cursor {
        definition,
        data,
        at: 0,
        layout,
        elements: 0,
    };
    cursor.record(0)
}

struct Cursor<'a> {
    definition: &'a Definition,
    data: &'a [u8],
    at: usize,
    layout: Layout,
    elements: usize,
}

impl<'a> Cursor<'a> {
    fn record(&mut self, index: usize) -> Result<Value, MessageError> {
        let definition = self.definition;
        let fields = &definition.types[index].fields;
        if fields.is_empty() && self.layout != Layout::Ros1 {
            // ROS 2 puts one byte into an empty message.
            self.bytes(1, "an empty message")?;
        }
        let mut values = Vec::with_capacity(fields.len());
        for field in fields {
            values.push((field.name.clone(), self.field(field)?));
        }
        Ok(Value::Struct(values))
    }

    fn field(&mut self, field: &Field) -> Result<Value, MessageError> {
        let count = match field.many {
            Many::One => return self.one(field),
            Many::Fixed(count) => count,
            Many::Counted => usize::try_from(self.unsigned(4, &field.name)?).unwrap_or(usize::MAX),
        };
        if field.kind == Kind::UInt(1) {
            return Ok(Value::Bytes(self.bytes(count, &field.name)?.to_vec()));
        }
        self.count(count, field)?;
        let least = match field.kind {
            Kind::Struct(_) => 0,
            Kind::Int(size) | Kind::UInt(size) | Kind::Float(size) => size,
            Kind::Bool => 1,
            Kind::Text | Kind::WideText => 4,
            Kind::Time { .. } => 8,
        };
        if least.saturating_mul(count) > self.data.len().saturating_sub(self.at) {
            return Err(short(&field.name));
        }
        let mut values = Vec::with_capacity(if least > 0 { count } else { 0 });
        for _ in 0..count {
            values.push(self.one(field)?);
        }
        Ok(Value::Array(values))
    }

    fn count(&mut self, more: usize, field: &Field) -> Result<(), MessageError> {
        self.elements = self.elements.saturating_add(more);
        if self.elements > ELEMENT_LIMIT {
            return Err(MessageError::TooMany {
                field: field.name.to_string(),
                limit: ELEMENT_LIMIT,
            });
        }
        Ok(())
    }

    #[allow(
        clippy::cast_possible_wrap,
        clippy::cast_possible_truncation,
        reason = "bits are taken as the number that they are"
    )]
    fn one(&mut self, field: &Field) -> Result<Value, MessageError> {
        let name = &field.name;
        Ok(match field.kind {
            Kind::Bool => Value::Bool(self.unsigned(1, name)? != 0),
            Kind::UInt(size) => Value::UInt(self.unsigned(size, name)?),
            Kind::Int(size) => Value::Int(self.signed(size, name)?),
            Kind::Float(4) => Value::Float(f32::from_bits(self.unsigned(4, name)? as u32).into()),
            Kind::Float(_) => Value::Float(f64::from_bits(self.unsigned(8, name)?)),
            Kind::Text => Value::Text(self.text(name)?),
            Kind::WideText => {
                return Err(MessageError::Layout {
                    found: format!("wide text in `{name}`"),
                });
            }
            Kind::Time { signed } => {
                let (sec, nanosec) = if signed {
                    (
                        Value::Int(self.signed(4, name)?),
                        Value::Int(self.signed(4, name)?),
                    )
                } else {
                    (
                        Value::UInt(self.unsigned(4, name)?),
                        Value::UInt(self.unsigned(4, name)?),
                    )
                };
                Value::Struct(vec![("sec".into(), sec), ("nanosec".into(), nanosec)])
            }
            Kind::Struct(index) => {
                self.count(1 + self.definition.types[index].fields.len(), field)?;
                self.record(index)?
            }
        })
    }

    fn signed(&mut self, size: usize, name: &str) -> Result<i64, MessageError> {
        let shift = 64 - 8 * size;
        #[allow(
            clippy::cast_possible_wrap,
            reason = "bits are taken as the number that they are"
        )]
        Ok((self.unsigned(size, name)? << shift) as i64 >> shift)
    }

    fn unsigned(&mut self, size: usize, name: &str) -> Result<u64, MessageError> {
        let mut big_endian = false;
        if let Layout::Cdr { big_endian: is } = self.layout {
            self.at = self.at.next_multiple_of(size);
            big_endian = is;
        }
        let bytes = self.bytes(size, name)?;
        let mut whole = [0; 8];
        if big_endian {
            whole[8 - size..].copy_from_slice(bytes);
            Ok(u64::from_be_bytes(whole))
        } else {
            whole[..size].copy_from_slice(bytes);
            Ok(u64::from_le_bytes(whole))
        }
    }

    fn text(&mut self, name: &str) -> Result<String, MessageError> {
        let length = usize::try_from(self.unsigned(4, name)?).unwrap_or(usize::MAX);
        let mut bytes = self.bytes(length, name)?;
        if self.layout != Layout::Ros1 {
            bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        }
        // ROS does not promise UTF-8: a text that is none is shown, not refused.
        Ok(String::from_utf8_lossy(bytes).into_owned())
    }

    fn bytes(&mut self, count: usize, name: &str) -> Result<&'a [u8], MessageError> {
        let end = self
            .at
            .checked_add(count)
            .filter(|end| *end <= self.data.len());
        let end = end.ok_or_else(|| short(name))?;
        let bytes = &self.data[self.at..end];
        self.at = end;
        Ok(bytes)
    }
}

fn short(field: &str) -> MessageError {
    MessageError::Short {
        field: field.to_owned(),
    }
}
