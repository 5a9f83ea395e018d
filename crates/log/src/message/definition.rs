//! Message definitions in the languages `ros1msg` and `ros2msg`.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use super::MessageError;

/// How deep types may stand in each other.
const DEPTH_LIMIT: usize = 32;
/// How many types a definition may have, and how many fields a type.
const COUNT_LIMIT: usize = 4096;
/// How many fields all types of a definition may have together.
const FIELD_LIMIT: usize = 1 << 15;

/// What a field holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Bool,
    Int(usize),
    UInt(usize),
    Float(usize),
    Text,
    WideText,
    /// ROS 1: two 32-bit numbers; signed for a duration.
    Time {
        signed: bool,
    },
    /// The index of its type.
    Struct(usize),
}

/// How often.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Many {
    One,
    Fixed(usize),
    Counted,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub(super) name: Arc<str>,
    pub(super) kind: Kind,
    pub(super) many: Many,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Type {
    name: String,
    pub(super) fields: Vec<Field>,
}

/// A message type with all types that it is made of; the first is the message.
///
/// ```
/// use grouser_log::message::{Definition, Value, build};
///
/// let definition = Definition::parse("demo/msg/Tilt", "float64 roll\nfloat64 pitch\n")?;
/// let tilt = build::message([("roll", Value::Float(0.1)), ("pitch", Value::Float(0.2))]);
/// assert_eq!(definition.encode(&tilt)?.len(), 4 + 16); // head and two numbers
/// # Ok::<(), grouser_log::message::MessageError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Definition {
    pub(super) types: Vec<Type>,
}

/// Where each type stands, by its name; of two of one name the first.
struct Names {
    places: BTreeMap<String, usize>,
    /// Types that definitions leave out because ROS 2 has them, behind all others.
    built_in: Vec<String>,
    count: usize,
}

impl Names {
    fn from_drafts(drafts: &[Draft<'_>]) -> Self {
        let mut places = BTreeMap::new();
        for (place, draft) in drafts.iter().enumerate() {
            places.entry(draft.name.clone()).or_insert(place);
        }
        Self {
            places,
            built_in: Vec::new(),
            count: drafts.len(),
        }
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.places.get(name).copied()
    }

    fn add_built_in(&mut self, name: String) -> usize {
        let place = self.count + self.built_in.len();
        self.places.insert(name.clone(), place);
        self.built_in.push(name);
        place
    }
}

struct Draft<'a> {
    name: String,
    lines: Vec<&'a str>,
}

impl Definition {
    /// Reads a definition of ROS 2: the message's own text, then each other type after a line of `=` and
    /// a line `MSG: package/Type`.
    ///
    /// # Errors
    /// [`MessageError::Definition`].
    ///
    /// ```
    /// use grouser_log::message::Definition;
    ///
    /// assert!(Definition::parse("demo/msg/Tilt", "float64[ roll\n").is_err());
    /// ```
    pub fn parse(type_name: &str, text: &str) -> Result<Self, MessageError> {
        // An octet: without sign.
        Self::read(type_name, text, Kind::UInt(1))
    }

    /// As [`Definition::parse`], of ROS 1: there a `byte` is an `int8`.
    ///
    /// # Errors
    /// [`MessageError::Definition`].
    pub fn parse_ros1(type_name: &str, text: &str) -> Result<Self, MessageError> {
        Self::read(type_name, text, Kind::Int(1))
    }

    fn read(type_name: &str, text: &str, byte: Kind) -> Result<Self, MessageError> {
        let wrong = |what: String| MessageError::Definition {
            type_name: type_name.to_owned(),
            what,
        };
        let mut drafts = vec![Draft {
            name: short(type_name).into_owned(),
            lines: Vec::new(),
        }];
        let mut after_rule = false;
        for line in text.lines() {
            let line = line.trim();
            if line.len() >= 3 && line.bytes().all(|byte| byte == b'=') {
                after_rule = true;
            } else if let Some(name) = line.strip_prefix("MSG:").filter(|_| after_rule) {
                drafts.push(Draft {
                    name: short(name.trim()).into_owned(),
                    lines: Vec::new(),
                });
                after_rule = false;
            } else if let Some(draft) = drafts.last_mut() {
                draft.lines.push(line);
            }
        }
        if drafts.len() > COUNT_LIMIT {
            return Err(wrong(format!("more than {COUNT_LIMIT} types")));
        }
        let mut names = Names::from_drafts(&drafts);
        let mut types = Vec::new();
        let mut all = 0;
        for draft in &drafts {
            let mut fields = Vec::new();
            for line in &draft.lines {
                let field = read_field(line, &draft.name, byte, &mut names).map_err(wrong)?;
                all += usize::from(field.is_some());
                fields.extend(field);
                if fields.len() > COUNT_LIMIT || all > FIELD_LIMIT {
                    return Err(wrong(format!(
                        "more than {COUNT_LIMIT} fields in a type, or {FIELD_LIMIT} in all"
                    )));
                }
            }
            types.push(Type {
                name: draft.name.clone(),
                fields,
            });
        }
        // Types that definitions leave out because ROS 2 has them built in.
        for name in names.built_in {
            let kinds = [("sec", Kind::Int(4)), ("nanosec", Kind::UInt(4))];
            let fields = kinds.map(|(name, kind)| Field {
                name: name.into(),
                kind,
                many: Many::One,
            });
            types.push(Type {
                name,
                fields: fields.into(),
            });
        }
        let definition = Self { types };
        // Depth by relaxation: a type that holds itself never comes to rest.
        let mut depth = vec![0_usize; definition.types.len()];
        loop {
            let mut moved = false;
            for index in 0..depth.len() {
                for field in &definition.types[index].fields {
                    if let Kind::Struct(inner) = field.kind
                        && depth[index] <= depth[inner]
                    {
                        depth[index] = depth[inner] + 1;
                        moved = true;
                        if depth[index] > DEPTH_LIMIT {
                            let name = &definition.types[index].name;
                            return Err(wrong(format!(
                                "`{name}` holds itself, or types are nested more than {DEPTH_LIMIT} deep"
                            )));
                        }
                    }
                }
            }
            if !moved {
                return Ok(definition);
            }
        }
    }
}

const BUILT_IN: [&str; 2] = ["builtin_interfaces/Time", "builtin_interfaces/Duration"];

/// `package/Type` of `package/msg/Type`.
pub(crate) fn short(name: &str) -> Cow<'_, str> {
    match name.split_once("/msg/") {
        Some((package, name)) => Cow::Owned(format!("{package}/{name}")),
        None => Cow::Borrowed(name),
    }
}

fn read_field(
    line: &str,
    own: &str,
    byte: Kind,
    names: &mut Names,
) -> Result<Option<Field>, String> {
    let bare = line.split('#').next().unwrap_or("").trim();
    let Some((kind, rest)) = bare.split_once(char::is_whitespace) else {
        return if bare.is_empty() {
            Ok(None)
        } else {
            Err(format!("`{}`", bare.chars().take(64).collect::<String>()))
        };
    };
    let rest = rest.trim_start();
    let end = rest.find(|letter: char| !letter.is_alphanumeric() && letter != '_');
    let (name, after) = rest.split_at(end.unwrap_or(rest.len()));
    // A constant; a bare word after the name is a default, which is no concern here.
    if after.trim_start().starts_with('=') {
        return Ok(None);
    }
    if name.is_empty() {
        return Err(format!("`{}`", bare.chars().take(64).collect::<String>()));
    }
    let (kind, many) = match kind.split_once('[') {
        None => (kind, Many::One),
        Some((kind, count)) => {
            let count = count.strip_suffix(']').ok_or("an array without `]`")?;
            if count.is_empty() || count.starts_with("<=") {
                (kind, Many::Counted)
            } else {
                let count = count
                    .parse()
                    .map_err(|_| format!("an array of `{count}`"))?;
                (kind, Many::Fixed(count))
            }
        }
    };
    let kind = match kind.split("<=").next().unwrap_or(kind) {
        "bool" => Kind::Bool,
        "int8" => Kind::Int(1),
        "byte" => byte,
        "char" | "uint8" => Kind::UInt(1),
        "int16" => Kind::Int(2),
        "uint16" => Kind::UInt(2),
        "int32" => Kind::Int(4),
        "uint32" => Kind::UInt(4),
        "int64" => Kind::Int(8),
        "uint64" => Kind::UInt(8),
        "float32" => Kind::Float(4),
        "float64" => Kind::Float(8),
        "string" => Kind::Text,
        "wstring" => Kind::WideText,
        "time" => Kind::Time { signed: false },
        "duration" => Kind::Time { signed: true },
        other => Kind::Struct(find(other, own, names)?),
    };
    Ok(Some(Field {
        name: name.into(),
        kind,
        many,
    }))
}

/// The index of a type that is named in a field of the type `own`.
fn find(name: &str, own: &str, names: &mut Names) -> Result<usize, String> {
    let name = short(name);
    let full = if name.contains('/') {
        name.into_owned()
    } else {
        let package = own.split('/').next().unwrap_or("");
        let near = format!("{package}/{name}");
        if name == "Header" && names.place(&near).is_none() {
            "std_msgs/Header".to_owned()
        } else {
            near
        }
    };
    if let Some(place) = names.place(&full) {
        return Ok(place);
    }
    if BUILT_IN.contains(&full.as_str()) {
        return Ok(names.add_built_in(full));
    }
    Err(format!(
        "the type `{}` is not there",
        full.chars().take(64).collect::<String>()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_is_signed_in_ros_1_and_not_in_ros_2() {
        let text = "byte level\nbyte[] all\nchar c\n";
        let kinds = |definition: Definition| -> Vec<Kind> {
            definition.types[0]
                .fields
                .iter()
                .map(|field| field.kind)
                .collect()
        };
        let ros1 = Definition::parse_ros1("t/T", text).unwrap();
        assert_eq!(kinds(ros1), [Kind::Int(1), Kind::Int(1), Kind::UInt(1)]);
        let ros2 = Definition::parse("t/T", text).unwrap();
        assert_eq!(kinds(ros2), [Kind::UInt(1); 3]);
    }
}
