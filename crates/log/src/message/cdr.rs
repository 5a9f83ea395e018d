//! From bytes to fields: ROS 1 serialization and CDR (the plain encapsulations of XCDR 1).

use std::sync::Arc;

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

/// Decodes into `value`, whose texts and arrays are used again where they are of the same kind.
pub(super) fn decode(
    definition: &Definition,
    data: &[u8],
    layout: Layout,
    value: &mut Value,
) -> Result<(), MessageError> {
    let mut cursor = Cursor {
        definition,
        data,
        at: 0,
        layout,
        elements: 0,
    };
    cursor.record(0, value)
}

struct Cursor<'a> {
    definition: &'a Definition,
    data: &'a [u8],
    at: usize,
    layout: Layout,
    elements: usize,
}

impl<'a> Cursor<'a> {
    fn record(&mut self, index: usize, value: &mut Value) -> Result<(), MessageError> {
        let fields = &self.definition.types[index].fields;
        if fields.is_empty() && self.layout != Layout::Ros1 {
            // ROS 2 puts one byte into an empty message.
            self.bytes(1, "an empty message")?;
        }
        let values = fields_of(value, fields);
        for ((_, value), field) in values.iter_mut().zip(fields) {
            self.field(field, value)?;
        }
        Ok(())
    }

    fn field(&mut self, field: &Field, value: &mut Value) -> Result<(), MessageError> {
        let count = match field.many {
            Many::One => return self.one(field, value),
            Many::Fixed(count) => count,
            Many::Counted => usize::try_from(self.unsigned(4, &field.name)?).unwrap_or(usize::MAX),
        };
        if field.kind == Kind::UInt(1) {
            let bytes = self.bytes(count, &field.name)?;
            if let Value::Bytes(before) = value {
                before.clear();
                before.extend_from_slice(bytes);
            } else {
                *value = Value::Bytes(bytes.to_vec());
            }
            return Ok(());
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
        if !matches!(value, Value::Array(_)) {
            *value = Value::Array(Vec::new());
        }
        let Value::Array(values) = value else {
            return Ok(());
        };
        values.truncate(count);
        if field.kind == Kind::Float(8) && count > 0 {
            return self.doubles(count, &field.name, values);
        }
        for place in 0..count {
            if place == values.len() {
                values.push(Value::Null);
            }
            self.one(field, &mut values[place])?;
        }
        Ok(())
    }

    /// The array that messages have most often, at once.
    fn doubles(
        &mut self,
        count: usize,
        name: &str,
        values: &mut Vec<Value>,
    ) -> Result<(), MessageError> {
        let swapped = self.align(8);
        let bytes = self.bytes(count.saturating_mul(8), name)?;
        let (words, _) = bytes.as_chunks::<8>();
        values.clear();
        values.extend(words.iter().map(|word| {
            Value::Float(if swapped {
                f64::from_be_bytes(*word)
            } else {
                f64::from_le_bytes(*word)
            })
        }));
        Ok(())
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
        clippy::cast_possible_truncation,
        reason = "bits are taken as the number that they are"
    )]
    fn one(&mut self, field: &Field, value: &mut Value) -> Result<(), MessageError> {
        let name = &field.name;
        *value = match field.kind {
            Kind::Bool => Value::Bool(self.unsigned(1, name)? != 0),
            Kind::UInt(size) => Value::UInt(self.unsigned(size, name)?),
            Kind::Int(size) => Value::Int(self.signed(size, name)?),
            Kind::Float(4) => Value::Float(f32::from_bits(self.unsigned(4, name)? as u32).into()),
            Kind::Float(_) => Value::Float(f64::from_bits(self.unsigned(8, name)?)),
            Kind::Text => return self.text(name, value),
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
                return self.record(index, value);
            }
        };
        Ok(())
    }

    #[allow(
        clippy::cast_possible_wrap,
        reason = "bits are taken as the number that they are"
    )]
    fn signed(&mut self, size: usize, name: &str) -> Result<i64, MessageError> {
        let shift = 64 - 8 * size;
        Ok((self.unsigned(size, name)? << shift) as i64 >> shift)
    }

    /// Goes on to where a number of `size` bytes may stand; are its bytes swapped?
    fn align(&mut self, size: usize) -> bool {
        match self.layout {
            Layout::Ros1 => false,
            Layout::Cdr { big_endian } => {
                self.at = self.at.next_multiple_of(size);
                big_endian
            }
        }
    }

    fn unsigned(&mut self, size: usize, name: &str) -> Result<u64, MessageError> {
        Ok(match size {
            1 => self.word::<1>(name)?[0].into(),
            2 => u16::from_le_bytes(self.word(name)?).into(),
            4 => u32::from_le_bytes(self.word(name)?).into(),
            _ => u64::from_le_bytes(self.word(name)?),
        })
    }

    /// A number's bytes, the least first.
    fn word<const N: usize>(&mut self, name: &str) -> Result<[u8; N], MessageError> {
        let swapped = self.align(N);
        let bytes = self.bytes(N, name)?;
        let mut word: [u8; N] = bytes.try_into().map_err(|_| short(name))?;
        if swapped {
            word.reverse();
        }
        Ok(word)
    }

    fn text(&mut self, name: &str, value: &mut Value) -> Result<(), MessageError> {
        let length = usize::try_from(self.unsigned(4, name)?).unwrap_or(usize::MAX);
        let mut bytes = self.bytes(length, name)?;
        if self.layout != Layout::Ros1 {
            bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        }
        // ROS does not promise UTF-8: a text that is none is shown, not refused.
        let text = String::from_utf8_lossy(bytes);
        if let Value::Text(before) = value {
            before.clear();
            before.push_str(&text);
        } else {
            *value = Value::Text(text.into_owned());
        }
        Ok(())
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

/// The values of these fields: those that stand there from the message before, or new ones.
fn fields_of<'a>(value: &'a mut Value, fields: &[Field]) -> &'a mut [(Arc<str>, Value)] {
    let alike = match &*value {
        Value::Struct(values) => {
            let both = values.iter().zip(fields);
            values.len() == fields.len()
                && both.fold(true, |same, (a, b)| same & Arc::ptr_eq(&a.0, &b.name))
        }
        _ => false,
    };
    if !alike {
        let named = fields.iter().map(|f| (Arc::clone(&f.name), Value::Null));
        *value = Value::Struct(named.collect());
    }
    match value {
        Value::Struct(values) => values,
        _ => &mut [],
    }
}

#[cold]
fn short(field: &str) -> MessageError {
    MessageError::Short {
        field: field.to_owned(),
    }
}
