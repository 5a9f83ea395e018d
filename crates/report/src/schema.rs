//! JSON schemas.

use serde_json::{Value, json};

use crate::Object;
use crate::field::{Field, Place};

/// An object with exactly these fields.
pub(crate) fn object<T>(fields: &[Field<'_, T>]) -> Value {
    let fields = || fields.iter().filter(|field| field.place != Place::Text);
    let properties = fields().map(|field| {
        let mut schema = field.schema.clone();
        if let Value::Object(schema) = &mut schema {
            schema.insert("description".to_owned(), field.words.into());
            if !field.unit().is_empty() {
                schema.insert("unit".to_owned(), field.unit().into());
            }
        }
        (field.key.to_owned(), schema)
    });
    let always = fields().filter(|field| field.place == Place::Everywhere);
    let keys: Vec<&str> = always.map(|field| field.key).collect();
    json!({
        "type": "object",
        "properties": properties.collect::<Object>(),
        "required": keys,
        "additionalProperties": false,
    })
}

/// The same, or `null`.
pub(crate) fn or_null(mut schema: Value) -> Value {
    schema["type"] = json!([schema["type"], "null"]);
    schema
}

/// An object whose keys are names.
pub(crate) fn named(item: &Value) -> Value {
    json!({"type": "object", "additionalProperties": item})
}

/// A list.
pub(crate) fn list(item: &Value) -> Value {
    json!({"type": "array", "items": item})
}
