//! The fields of a message.

use std::sync::Arc;

const NS_PER_S: i64 = 1_000_000_000;

/// A field, or a whole message.
///
/// ```
/// use grouser_log::message::Value;
///
/// let value = Value::Struct(vec![("ticks".into(), Value::Array(vec![Value::Int(-1)]))]);
/// assert_eq!(value.number_at("ticks[0]"), Some(-1.0));
/// assert_eq!(value.count_at("ticks[0]"), Some(u64::MAX)); // the bits of a counter
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Value {
    /// Nothing (JSON).
    Null,
    /// A truth value.
    Bool(bool),
    /// A signed whole number.
    Int(i64),
    /// A whole number without sign.
    UInt(u64),
    /// A number.
    Float(f64),
    /// Text.
    Text(String),
    /// An array of bytes.
    Bytes(Vec<u8>),
    /// An array of 32-bit floats, to be written: a large one in one piece. A decoded one is an
    /// [`Value::Array`].
    Floats(Vec<f32>),
    /// An array.
    Array(Vec<Value>),
    /// Fields by name, in their order.
    Struct(Vec<(Arc<str>, Value)>),
}

impl Value {
    /// A field by its path: `twist.twist.linear.x`, `transforms[0].child_frame_id`.
    ///
    /// ```
    /// use grouser_log::message::build;
    ///
    /// let message = build::twist_stamped(build::header(0, "base"), [0.2, 0.0, 0.0], [0.0; 3]);
    /// assert!(message.at("twist.linear.x").is_some());
    /// assert!(message.at("twist.linear.w").is_none());
    /// ```
    #[must_use]
    pub fn at(&self, path: &str) -> Option<&Self> {
        // paths are short: a search for many bytes at once costs more than it saves
        let find = |text: &str, byte| text.bytes().position(|one| one == byte);
        let mut rest = Some(path);
        let steps = std::iter::from_fn(|| {
            let path = rest?;
            let end = find(path, b'.');
            rest = end.map(|end| &path[end + 1..]);
            Some(&path[..end.unwrap_or(path.len())])
        });
        steps.into_iter().try_fold(self, |value, step| {
            let (name, places) = step.split_at(find(step, b'[').unwrap_or(step.len()));
            let Self::Struct(fields) = value else {
                return None;
            };
            let (_, field) = fields.iter().find(|(own, _)| &**own == name)?;
            places
                .split_terminator(']')
                .try_fold(field, |value, place| match value {
                    Self::Array(values) => {
                        values.get(place.strip_prefix('[')?.parse::<usize>().ok()?)
                    }
                    _ => None,
                })
        })
    }

    /// A number by its path, truth values as 0 and 1; also one of an array of bytes.
    ///
    /// ```
    /// use grouser_log::message::Value;
    ///
    /// let value = Value::Struct(vec![("on".into(), Value::Bool(true))]);
    /// assert_eq!(value.number_at("on"), Some(1.0));
    /// ```
    #[must_use]
    pub fn number_at(&self, path: &str) -> Option<f64> {
        match self.whole_at(path) {
            Some(Self::Bool(value)) => Some(f64::from(u8::from(value))),
            Some(value) => value.number(),
            None => self.at(path)?.number(),
        }
    }

    /// A whole number by its path, as the bits of a counter; a signed one is cast.
    ///
    /// ```
    /// use grouser_log::message::Value;
    ///
    /// let value = Value::Struct(vec![("ticks".into(), Value::UInt(u64::MAX))]);
    /// assert_eq!(value.count_at("ticks"), Some(u64::MAX)); // no digit is lost
    /// ```
    #[must_use]
    pub fn count_at(&self, path: &str) -> Option<u64> {
        match self.whole_at(path)? {
            Self::UInt(value) => Some(value),
            Self::Int(value) => Some(value.cast_unsigned()),
            _ => None,
        }
    }

    fn whole_at(&self, path: &str) -> Option<Self> {
        match self.at(path) {
            Some(value @ (Self::Bool(_) | Self::Int(_) | Self::UInt(_))) => Some(value.clone()),
            Some(_) => None,
            None => {
                let (array, place) = path.strip_suffix(']')?.rsplit_once('[')?;
                let Self::Bytes(bytes) = self.at(array)? else {
                    return None;
                };
                let byte = bytes.get(place.parse::<usize>().ok()?)?;
                Some(Self::UInt((*byte).into()))
            }
        }
    }

    /// It as a number.
    #[must_use]
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Int(value) => Some(*value as f64),
            Self::UInt(value) => Some(*value as f64),
            Self::Float(value) => Some(*value),
            _ => None,
        }
    }

    /// It as text.
    #[must_use]
    pub fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Its elements, if it is an array.
    #[must_use]
    pub fn elements(&self) -> Option<&[Self]> {
        match self {
            Self::Array(values) => Some(values),
            _ => None,
        }
    }

    /// A time in ns, from `sec` and `nanosec` or `nsec`; `None` also where the nanoseconds are a second or more.
    ///
    /// ```
    /// use grouser_log::message::{Value, build};
    ///
    /// let stamp = build::message([("sec", Value::Int(2)), ("nanosec", Value::UInt(5))]);
    /// assert_eq!(stamp.time_ns(), Some(2_000_000_005));
    /// ```
    #[must_use]
    pub fn time_ns(&self) -> Option<i64> {
        let whole = |value: &Self| match value {
            Self::Int(value) => Some(*value),
            Self::UInt(value) => i64::try_from(*value).ok(),
            _ => None,
        };
        let sec = self.at("sec").or_else(|| self.at("secs")).and_then(whole)?;
        let nanosec = ["nanosec", "nsec", "nsecs"]
            .iter()
            .find_map(|name| self.at(name))
            .and_then(whole)
            .filter(|nanosec| (0..NS_PER_S).contains(nanosec))?;
        sec.checked_mul(NS_PER_S)?.checked_add(nanosec)
    }

    pub(super) fn from_json(json: serde_json::Value) -> Self {
        use serde_json::Value as Json;
        match json {
            Json::Null => Self::Null,
            Json::Bool(value) => Self::Bool(value),
            Json::Number(number) => number
                .as_i64()
                .map(Self::Int)
                .or_else(|| number.as_u64().map(Self::UInt))
                .or_else(|| number.as_f64().map(Self::Float))
                .unwrap_or(Self::Null),
            Json::String(text) => Self::Text(text),
            Json::Array(values) => Self::Array(values.into_iter().map(Self::from_json).collect()),
            Json::Object(fields) => Self::Struct(
                fields
                    .into_iter()
                    .map(|(name, value)| (name.into(), Self::from_json(value)))
                    .collect(),
            ),
        }
    }
}
