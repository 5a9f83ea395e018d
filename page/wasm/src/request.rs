//! A request: fields by name, each with a typed way to fail.

use serde_json::{Map, Value};

/// Longest request, bytes: a few soils and numbers, or the text of some files.
const MAX_REQUEST_BYTES: usize = 1 << 20;

/// Why a request has no answer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Problem {
    /// The field that is wrong, where it is one.
    pub(crate) field: Option<String>,
    /// What is wrong, with value, limit and unit.
    pub(crate) message: String,
}

impl Problem {
    pub(crate) fn new(field: &str, message: impl Into<String>) -> Self {
        Self {
            field: Some(field.to_owned()),
            message: message.into(),
        }
    }
}

#[cfg(feature = "explore")]
impl From<grouser_terra::Error> for Problem {
    fn from(error: grouser_terra::Error) -> Self {
        Self {
            field: error.field().map(str::to_owned),
            message: error.to_string(),
        }
    }
}

impl From<grouser_files::Error> for Problem {
    fn from(error: grouser_files::Error) -> Self {
        Self {
            field: None,
            message: error.to_string(),
        }
    }
}

#[cfg(any(feature = "drive", feature = "log", feature = "optimize"))]
impl Problem {
    /// Whatever another crate refuses, in its own words.
    pub(crate) fn from_error(error: impl std::fmt::Display) -> Self {
        Self {
            field: None,
            message: error.to_string(),
        }
    }
}

/// An object of named values.
pub(crate) struct Request<'a>(std::borrow::Cow<'a, Map<String, Value>>);

impl Request<'static> {
    /// Reads a request.
    pub(crate) fn parse(text: &str) -> Result<Self, Problem> {
        if text.len() > MAX_REQUEST_BYTES {
            let length = text.len();
            return Err(Problem {
                field: None,
                message: format!(
                    "the request has {length} bytes, but at most {MAX_REQUEST_BYTES} are read"
                ),
            });
        }
        match serde_json::from_str(text) {
            Ok(Value::Object(fields)) => Ok(Self(std::borrow::Cow::Owned(fields))),
            Ok(_) => Err(Problem {
                field: None,
                message: "a request is an object".to_owned(),
            }),
            Err(error) => Err(Problem {
                field: None,
                message: format!("the request is no JSON: {error}"),
            }),
        }
    }
}

#[cfg_attr(
    not(all(
        feature = "explore",
        feature = "drive",
        feature = "figure",
        feature = "log",
        feature = "optimize"
    )),
    allow(dead_code, reason = "each module reads the fields that it has")
)]
impl Request<'_> {
    /// A text that must be there.
    pub(crate) fn text(&self, field: &str) -> Result<&str, Problem> {
        match self.0.get(field) {
            Some(Value::String(text)) => Ok(text),
            Some(_) => Err(Problem::new(field, format!("`{field}` must be a text"))),
            None => Err(Problem::new(field, format!("`{field}` is missing"))),
        }
    }

    /// A text, if it is there and not null.
    pub(crate) fn optional_text(&self, field: &str) -> Result<Option<&str>, Problem> {
        match self.0.get(field) {
            None | Some(Value::Null) => Ok(None),
            Some(_) => self.text(field).map(Some),
        }
    }

    /// A finite number that must be there.
    pub(crate) fn number(&self, field: &str) -> Result<f64, Problem> {
        self.optional_number(field)?
            .ok_or_else(|| Problem::new(field, format!("`{field}` is missing")))
    }

    /// A finite number, if it is there and not null.
    pub(crate) fn optional_number(&self, field: &str) -> Result<Option<f64>, Problem> {
        match self.0.get(field) {
            None | Some(Value::Null) => Ok(None),
            Some(value) => match value.as_f64() {
                Some(number) if number.is_finite() => Ok(Some(number)),
                _ => Err(Problem::new(
                    field,
                    format!("`{field}` must be a finite number"),
                )),
            },
        }
    }

    /// A whole number from 0 to `max`.
    pub(crate) fn count(&self, field: &str, max: u32) -> Result<u32, Problem> {
        let value = self.0.get(field).and_then(Value::as_u64);
        value
            .and_then(|count| u32::try_from(count).ok())
            .filter(|count| *count <= max)
            .ok_or_else(|| {
                Problem::new(
                    field,
                    format!("`{field}` must be a whole number from 0 to {max}"),
                )
            })
    }

    /// The `name` and the `bytes` of each file in a list, if it is there and not null.
    pub(crate) fn sizes(&self, field: &str) -> Result<Option<Vec<(&str, usize)>>, Problem> {
        fn size(file: &Value) -> Option<(&str, usize)> {
            let bytes = u32::try_from(file.get("bytes")?.as_u64()?).ok()?;
            Some((file.get("name")?.as_str()?, usize::try_from(bytes).ok()?))
        }
        let files = match self.0.get(field) {
            None | Some(Value::Null) => return Ok(None),
            Some(files) => files.as_array(),
        };
        let sizes = files.and_then(|files| files.iter().map(size).collect());
        let wrong = || {
            Problem::new(
                field,
                format!("`{field}` must have the name and the bytes of each file"),
            )
        };
        sizes.map(Some).ok_or_else(wrong)
    }

    /// A list that must be there, of at most `max` values.
    pub(crate) fn list(&self, field: &str, max: usize) -> Result<&[Value], Problem> {
        let list = self.0.get(field).and_then(Value::as_array);
        list.map(Vec::as_slice)
            .filter(|list| !list.is_empty() && list.len() <= max)
            .ok_or_else(|| Problem::new(field, format!("`{field}` must be a list of 1 to {max}")))
    }

    /// Is the field there and true?
    pub(crate) fn is_set(&self, field: &str) -> bool {
        self.0.get(field) == Some(&Value::Bool(true))
    }
}
