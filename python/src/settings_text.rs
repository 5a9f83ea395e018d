//! Keyword arguments as the text of a TOML file, so that files and keywords have one vocabulary, one set of
//! limits and one set of messages.

use grouser::files::{Document, TomlText};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyInt, PyString};

use crate::error::{raised, type_error};

/// The keys of a flat TOML file as a document; `name` stands for it in messages.
pub(crate) fn document(name: &str, keys: Option<&Bound<'_, PyDict>>) -> PyResult<Document> {
    let mut text = TomlText::new(&[]);
    for (key, value) in keys.into_iter().flatten() {
        let key: String = key.extract()?;
        if value.is_none() {
            continue;
        }
        if let Ok(flag) = value.extract::<bool>() {
            text.line(&format!("{key} = {flag}"));
        } else if let Ok(word) = value.cast::<PyString>() {
            text.text(&key, word.to_str()?);
        } else if value.is_instance_of::<PyInt>() {
            let integer = value.extract::<i64>().map_err(|_| {
                type_error(
                    format!("{name}: `{key}` is an integer beyond 64 bits, but must be a number"),
                    &key,
                )
            })?;
            text.whole(&key, integer);
        } else {
            text.number(&key, scalar(&key, &value)?);
        }
    }
    raised(Document::from_text(name, toml_numbers(text.finish())))
}

/// An error of such a document without line and column, which the caller's keywords do not have.
pub(crate) fn without_place(py: Python<'_>, name: &str, error: PyErr) -> PyErr {
    let message = error.value(py).to_string();
    let Some(rest) = message.strip_prefix(name) else {
        return error;
    };
    let rest = rest.trim_start_matches(|c: char| c == ':' || c.is_ascii_digit());
    let message = format!("{name}:{rest}");
    match error.value(py).setattr("args", (message,)) {
        Ok(()) => error,
        Err(other) => other,
    }
}

/// One number of a keyword argument.
pub(crate) fn scalar(key: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    value.extract::<f64>().map_err(|_| {
        let kind = value
            .get_type()
            .name()
            .map_or_else(|_| "an object".to_owned(), |name| name.to_string());
        type_error(format!("`{key}` is {kind}, but must be a number"), key)
    })
}

/// Rust writes `NaN`, TOML `nan`.
fn toml_numbers(text: String) -> String {
    text.replace(" = NaN\n", " = nan\n")
}
