//! One quantity of a result.

use serde_json::Value;

use crate::layout::Layout;
use crate::number::{exact, short, shown};
use crate::unit::{factor, unit_of};
use crate::words::printable;

/// One quantity: its key, its words, its type, and where its value comes from.
pub(crate) struct Field<'a, T> {
    pub(crate) key: &'static str,
    pub(crate) words: &'static str,
    pub(crate) schema: Value,
    /// `None` where the JSON object has no such key.
    pub(crate) value: Box<dyn Fn(T) -> Option<Value> + 'a>,
    pub(crate) shown: Option<Shown>,
    pub(crate) is_given: bool,
    pub(crate) place: Place,
}

/// Which views have a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// All.
    Everywhere,
    /// All, but not in every JSON object.
    Sometimes,
    /// Only those for people.
    Text,
}

/// How people see a quantity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown {
    pub(crate) label: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) digits: Digits,
    pub(crate) missing: &'static str,
    pub(crate) at_right: bool,
    pub(crate) is_detail: bool,
}

impl Shown {
    /// Is it printed in this run?
    pub(crate) fn is_printed(&self) -> bool {
        !self.is_detail || Layout::current().details
    }
}

/// How many digits people see.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Digits {
    /// Those of the layout.
    Significant,
    Decimals(usize),
    /// As many as the number needs.
    All,
}

impl<T> Field<'_, T> {
    /// The unit that the key carries; empty for a pure number.
    pub(crate) fn unit(&self) -> &'static str {
        unit_of(self.key)
    }

    pub(crate) fn is_number(&self) -> bool {
        let kind = &self.schema["type"];
        let kind = kind.get(0).unwrap_or(kind);
        kind == "number" || kind == "integer"
    }

    /// The value for people.
    pub(crate) fn cell(&self, value: &Value) -> String {
        let Some(view) = self.shown else {
            return String::new();
        };
        match value {
            Value::Null => view.missing.to_owned(),
            Value::Number(number) if number.is_f64() => {
                let value = number.as_f64().unwrap_or(f64::NAN) * factor(self.unit(), view.unit);
                match view.digits {
                    Digits::Significant => shown(value),
                    Digits::Decimals(places) => format!("{value:.places$}"),
                    Digits::All => value.to_string(),
                }
            }
            Value::String(text) => printable(text),
            other => other.to_string(),
        }
    }

    /// The value in a CSV table; empty where there is none.
    pub(crate) fn csv_cell(&self, value: &Value) -> String {
        match value {
            Value::Null => String::new(),
            Value::Number(number) => match number.as_f64().filter(|_| number.is_f64()) {
                Some(number) if self.is_given => short(number),
                Some(number) => exact(number),
                None => number.to_string(),
            },
            Value::String(text) => quoted(text),
            // keys, which have no space
            Value::Array(words) if words.iter().all(Value::is_string) => {
                let words: Vec<&str> = words.iter().filter_map(Value::as_str).collect();
                quoted(&words.join(" "))
            }
            other => quoted(&other.to_string()),
        }
    }
}

/// A text as a field of a CSV table.
pub(crate) fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) || text.trim() != text {
        format!(
            "\"{}\"",
            text.replace('"', "\"\"").replace(['\n', '\r'], " ")
        )
    } else {
        text.to_owned()
    }
}
