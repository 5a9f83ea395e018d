//! From fields to bytes: CDR as ROS 2 writes it (XCDR 1, little-endian).

use super::definition::{Definition, Field, Kind, Many};
use super::{CdrWriter, MessageError, Value};

impl Definition {
    /// A message as CDR. The fields must be those of the definition, in its order.
    ///
    /// # Errors
    /// [`MessageError::Unfit`] for a value that is not what its field holds; [`MessageError::Layout`] for
    /// what is not written (wide text, times of ROS 1).
    ///
    /// ```
    /// use grouser_log::message::{Definition, MessageError, Value, build};
    ///
    /// let definition = Definition::parse("demo/msg/Tilt", "float64 roll\n")?;
    /// let other = build::message([("pitch", Value::Float(0.1))]);
    /// assert!(matches!(definition.encode(&other), Err(MessageError::Unfit { .. })));
    /// # Ok::<(), MessageError>(())
    /// ```
    pub fn encode(&self, value: &Value) -> Result<Vec<u8>, MessageError> {
        let mut bytes = Vec::new();
        self.put_record(0, "the message", value, &mut CdrWriter::new(&mut bytes))?;
        Ok(bytes)
    }

    fn put_record(
        &self,
        index: usize,
        name: &str,
        value: &Value,
        out: &mut CdrWriter<'_>,
    ) -> Result<(), MessageError> {
        let fields = &self.types[index].fields;
        let Value::Struct(values) = value else {
            return Err(unfit(name, "a message"));
        };
        let alike = values.len() == fields.len()
            && values
                .iter()
                .zip(fields)
                .all(|(given, field)| given.0 == field.name);
        if !alike {
            let names: Vec<&str> = fields.iter().map(|field| &*field.name).collect();
            return Err(unfit(name, &format!("the fields {}", names.join(", "))));
        }
        if fields.is_empty() {
            // ROS 2 puts one byte into an empty message.
            out.raw(&[0]);
        }
        for ((_, value), field) in values.iter().zip(fields) {
            self.put_field(field, value, out)?;
        }
        Ok(())
    }

    fn put_field(
        &self,
        field: &Field,
        value: &Value,
        out: &mut CdrWriter<'_>,
    ) -> Result<(), MessageError> {
        if field.many == Many::One {
            return self.put_one(field, value, out);
        }
        let length = match value {
            Value::Array(values) => values.len(),
            Value::Bytes(bytes) if field.kind == Kind::UInt(1) => bytes.len(),
            Value::Floats(numbers) if field.kind == Kind::Float(4) => numbers.len(),
            _ => return Err(unfit(&field.name, "an array")),
        };
        match field.many {
            Many::Fixed(count) if count != length => {
                return Err(unfit(&field.name, &format!("an array of {count}")));
            }
            Many::Fixed(_) | Many::One => {}
            Many::Counted => out.length(length)?,
        }
        match value {
            Value::Bytes(bytes) => out.raw(bytes),
            Value::Floats(numbers) => {
                for number in numbers {
                    out.number(&number.to_le_bytes());
                }
            }
            Value::Array(values) => {
                for value in values {
                    self.put_one(field, value, out)?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn put_one(
        &self,
        field: &Field,
        value: &Value,
        out: &mut CdrWriter<'_>,
    ) -> Result<(), MessageError> {
        let name = &*field.name;
        match (field.kind, value) {
            (Kind::Struct(index), _) => self.put_record(index, name, value, out),
            (Kind::Bool, Value::Bool(value)) => {
                out.raw(&[u8::from(*value)]);
                Ok(())
            }
            (Kind::UInt(size), _) => {
                let whole = match value {
                    Value::UInt(value) => Some(*value),
                    Value::Int(value) => u64::try_from(*value).ok(),
                    _ => None,
                };
                let fits = whole.filter(|whole| size == 8 || whole >> (8 * size) == 0);
                let whole = fits.ok_or_else(|| unfit(name, &format!("{size} bytes")))?;
                out.number(&whole.to_le_bytes()[..size]);
                Ok(())
            }
            (Kind::Int(size), _) => {
                let whole = match value {
                    Value::Int(value) => Some(*value),
                    Value::UInt(value) => i64::try_from(*value).ok(),
                    _ => None,
                };
                let shift = 64 - 8 * size;
                let fits = whole.filter(|whole| whole << shift >> shift == *whole);
                let whole = fits.ok_or_else(|| unfit(name, &format!("{size} bytes, signed")))?;
                out.number(&whole.to_le_bytes()[..size]);
                Ok(())
            }
            (Kind::Float(size), _) => {
                let number = value.number().ok_or_else(|| unfit(name, "a number"))?;
                if size == 4 {
                    #[allow(
                        clippy::cast_possible_truncation,
                        reason = "a field of 32 bits holds no more"
                    )]
                    out.number(&(number as f32).to_le_bytes());
                } else {
                    out.number(&number.to_le_bytes());
                }
                Ok(())
            }
            (Kind::Text, Value::Text(text)) => out.text(text),
            (Kind::WideText | Kind::Time { .. }, _) => Err(MessageError::Layout {
                found: format!("wide text or a time of ROS 1 in `{name}`"),
            }),
            (Kind::Bool, _) => Err(unfit(name, "true or false")),
            (Kind::Text, _) => Err(unfit(name, "a text")),
        }
    }
}

fn unfit(field: &str, expected: &str) -> MessageError {
    MessageError::Unfit {
        field: field.to_owned(),
        expected: expected.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_stand_where_cdr_puts_them() {
        let text = "uint8 a\nfloat64 b\nstring c\nint16[2] d\nuint8[] e\n";
        let definition = Definition::parse("t/T", text).unwrap();
        let field = |name: &str, value| (name.into(), value);
        let value = Value::Struct(vec![
            field("a", Value::UInt(7)),
            field("b", Value::Float(1.0)),
            field("c", Value::Text("hi".into())),
            field("d", Value::Array(vec![Value::Int(-1), Value::Int(2)])),
            field("e", Value::Bytes(vec![9])),
        ]);
        let expected = [
            0, 1, 0, 0, // encapsulation
            7, 0, 0, 0, 0, 0, 0, 0, // a, and room before 8 bytes
            0, 0, 0, 0, 0, 0, 0xf0, 0x3f, // 1.0
            3, 0, 0, 0, b'h', b'i', 0, 0, // text with its zero, and room before 2 bytes
            0xff, 0xff, 2, 0, // d
            1, 0, 0, 0, 9, // e
        ];
        assert_eq!(definition.encode(&value).unwrap(), expected);
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let definition = Definition::parse("t/T", "uint8 a\n").unwrap();
        let of = |value| Value::Struct(vec![("a".into(), value)]);
        let error = definition.encode(&of(Value::UInt(256))).unwrap_err();
        assert_eq!(
            error.to_string(),
            "`a` is not what the definition says: 1 bytes"
        );
        assert!(definition.encode(&of(Value::Float(1.0))).is_err());
        assert!(definition.encode(&Value::Struct(vec![])).is_err());
    }
}
