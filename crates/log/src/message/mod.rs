//! Messages by their definition, not by a list of known types.

pub mod build;
mod cdr;
mod cdr_writer;
mod covariance;
mod definition;
mod elements;
mod encode;
pub mod known;
mod shared;
mod spare;
mod types;
mod value;
mod view;

pub use cdr_writer::{CdrWriter, Header};
pub use covariance::Trust;
pub use definition::Definition;
pub(crate) use definition::short;
pub use elements::Elements;
pub(crate) use shared::{Decoders, SharedDecoder, decode};
pub(crate) use spare::{Spare, is_spare};
pub use value::Value;
pub use view::{Imu, JointState, NavSatFix, Odometry, Transform, View};

use crate::container::{Channel, Encoding};

/// The longest message that is decoded as JSON, bytes: its values may take eighty times as much.
pub const JSON_LIMIT: usize = 1 << 19;

/// Why a message or its definition cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MessageError {
    /// The definition says something that is not understood.
    #[error("the definition of `{type_name}` is not understood: {what}")]
    Definition {
        /// The type.
        type_name: String,
        /// What.
        what: String,
    },
    /// The message ends before its fields do.
    #[error("the message ends within `{field}`")]
    Short {
        /// The field.
        field: String,
    },
    /// A layout that is not read.
    #[error("the message is laid out as {found}, which is not read")]
    Layout {
        /// What it is.
        found: String,
    },
    /// A message of JSON that is longer than the limit.
    #[error("the message has {length} bytes, more than the limit of {limit} for JSON")]
    Long {
        /// Its length, bytes.
        length: usize,
        /// The limit, bytes.
        limit: usize,
    },
    /// A value that is not what its field holds, on writing.
    #[error("`{field}` is not what the definition says: {expected}")]
    Unfit {
        /// The field.
        field: String,
        /// What it should be.
        expected: String,
    },
    /// More elements than the limit.
    #[error("the message has more than {limit} elements by `{field}`")]
    TooMany {
        /// The field.
        field: String,
        /// The limit.
        limit: usize,
    },
    /// Text that is not UTF-8, or JSON that is none.
    #[error("`{field}` is not {expected}")]
    NotText {
        /// The field.
        field: String,
        /// What it should be.
        expected: &'static str,
    },
}

/// Reads the messages of one channel.
///
/// ```
/// use std::collections::BTreeMap;
///
/// use grouser_log::container::{Channel, Encoding};
/// use grouser_log::message::{Decoder, Definition, Value, build};
///
/// let text = "float64 roll\n";
/// let channel = Channel {
///     topic: "/tilt".into(),
///     type_name: "demo/msg/Tilt".into(),
///     encoding: Encoding::Cdr,
///     encoding_name: "cdr".into(),
///     definition_language: "ros2msg".into(),
///     definition: text.as_bytes().to_vec().into(),
///     metadata: BTreeMap::new(),
/// };
/// let bytes = Definition::parse("demo/msg/Tilt", text)?.encode(&build::message([("roll", Value::Float(0.1))]))?;
/// assert_eq!(Decoder::new(&channel)?.decode(&bytes)?.number_at("roll"), Some(0.1));
/// # Ok::<(), grouser_log::message::MessageError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Decoder {
    encoding: Encoding,
    definition: Option<Definition>,
}

impl Decoder {
    /// For a channel, by the definition that its file holds.
    ///
    /// # Errors
    /// [`MessageError::Definition`]; [`MessageError::Layout`] for an encoding that is not read.
    pub fn new(channel: &Channel) -> Result<Self, MessageError> {
        let definition = match channel.encoding {
            Encoding::Json => None,
            Encoding::Ros1 | Encoding::Cdr => {
                let mut text = String::from_utf8_lossy(&channel.definition);
                let language = channel.definition_language.as_str();
                let name = &channel.type_name;
                // databases of older releases hold the names of types alone
                if text.is_empty() && channel.encoding == Encoding::Cdr {
                    text = known::definition(&short(name)).unwrap_or_default().into();
                }
                Some(match language {
                    "ros1msg" => Definition::parse_ros1(name, &text)?,
                    "ros2msg" => Definition::parse(name, &text)?,
                    _ => {
                        return Err(MessageError::Layout {
                            found: format!("the schema language `{language}`"),
                        });
                    }
                })
            }
            Encoding::Other => {
                return Err(MessageError::Layout {
                    found: format!("`{}`", channel.encoding_name),
                });
            }
        };
        Ok(Self {
            encoding: channel.encoding,
            definition,
        })
    }

    /// All fields of a message.
    ///
    /// # Errors
    /// What the message lacks.
    pub fn decode(&self, data: &[u8]) -> Result<Value, MessageError> {
        let mut value = Value::Null;
        self.decode_into(data, &mut value)?;
        Ok(value)
    }

    /// As [`Decoder::decode`], into the value of the message before: its texts and arrays are used again, so
    /// that a message like it costs no allocation. After an error the value is some mixture.
    ///
    /// # Errors
    /// As [`Decoder::decode`].
    pub fn decode_into(&self, data: &[u8], value: &mut Value) -> Result<(), MessageError> {
        match (&self.definition, self.encoding) {
            (Some(definition), Encoding::Ros1) => {
                cdr::decode(definition, data, cdr::Layout::Ros1, value)
            }
            (Some(definition), _) => {
                let (layout, body) = cdr::Layout::of_cdr(data)?;
                cdr::decode(definition, body, layout, value)
            }
            (None, _) if data.len() > JSON_LIMIT => Err(MessageError::Long {
                length: data.len(),
                limit: JSON_LIMIT,
            }),
            (None, _) => {
                let json = serde_json::from_slice(data);
                let json = json.map_err(|_| MessageError::NotText {
                    field: "the message".to_owned(),
                    expected: "JSON",
                })?;
                *value = Value::from_json(json);
                Ok(())
            }
        }
    }
}
