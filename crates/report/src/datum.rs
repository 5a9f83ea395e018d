//! Values that a field may have.

use serde_json::{Value, json};

/// A value of a field: how it appears in JSON, and its type in the schema.
///
/// ```
/// use grouser_report::Datum;
///
/// assert_eq!(Some(0.5).json(), 0.5);
/// assert_eq!(<Option<f64>>::schema()["type"][0], "number");
/// ```
pub trait Datum {
    /// The type as a JSON schema.
    fn schema() -> Value;
    /// The value; `null` for NaN and infinity.
    fn json(self) -> Value;
}

macro_rules! data {
    ($($kind:expr => $($datum:ty),+;)+) => {$($(
        impl Datum for $datum {
            fn schema() -> Value {
                json!({"type": $kind})
            }
            fn json(self) -> Value {
                Value::from(self)
            }
        }
    )+)+};
}

data! {
    ["number", "null"] => f64;
    "integer" => u8, u32, u64, usize, i64;
    "string" => &str, String;
    "boolean" => bool;
}

impl<D: Datum> Datum for Option<D> {
    fn schema() -> Value {
        let mut schema = D::schema();
        if let Some(kind @ Value::String(_)) = schema.get_mut("type") {
            *kind = json!([kind, "null"]);
        }
        schema
    }

    fn json(self) -> Value {
        self.map_or(Value::Null, D::json)
    }
}

impl<D: Datum> Datum for Vec<D> {
    fn schema() -> Value {
        json!({"type": "array", "items": D::schema()})
    }

    fn json(self) -> Value {
        self.into_iter().map(D::json).collect()
    }
}

/// Any JSON value.
impl Datum for Value {
    fn schema() -> Value {
        json!({})
    }

    fn json(self) -> Value {
        self
    }
}
