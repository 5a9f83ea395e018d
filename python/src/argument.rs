//! Arguments of the module's own functions: what has the wrong type or size is a typed error.
//!
//! PyO3 adds a note with the argument's name to an error of its conversion; the exceptions take the name from it
//! (`add_note` in `python/grouser/_errors.py`).

use std::path::PathBuf;

use pyo3::PyClass;
use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyString};

use crate::error::{Details, InputTypeError, Limit, input_error};

/// `value` is no `expected`.
fn wrong_type(value: &Bound<'_, PyAny>, expected: &str) -> PyErr {
    let kind = value.get_type().name();
    let kind = kind.map_or_else(|_| "an object".to_owned(), |name| name.to_string());
    let message = format!("is {kind}, but must be {expected}");
    InputTypeError::new_err((message, None::<String>, value.clone().unbind()))
}

/// `value` does not lie in `limits`.
fn out_of_limits(value: &Bound<'_, PyAny>, limits: (f64, f64)) -> PyErr {
    let shown = value
        .str()
        .map_or_else(|_| "too large".to_owned(), |text| text.to_string());
    let message = format!("is {shown}, but must lie in [{}, {}]", limits.0, limits.1);
    let details = Details {
        value: Some(value.clone().unbind()),
        limit: Some(Limit::Range(limits)),
        unit: Some("1"),
        ..Details::default()
    };
    input_error(message, details)
}

/// A real number.
pub(crate) fn number(value: &Bound<'_, PyAny>) -> PyResult<f64> {
    if let Ok(float) = value.cast::<PyFloat>() {
        return Ok(float.value());
    }
    // NumPy's booleans are no `PyBool`, but floats to Python
    if value.extract::<bool>().is_ok() {
        return Err(wrong_type(value, "a number"));
    }
    value.extract::<f64>().map_err(|error| {
        if error.is_instance_of::<PyOverflowError>(value.py()) {
            out_of_limits(value, (f64::MIN, f64::MAX))
        } else {
            wrong_type(value, "a number")
        }
    })
}

/// A real number, or `None`.
pub(crate) fn optional_number(value: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    if value.is_none() {
        Ok(None)
    } else {
        number(value).map(Some)
    }
}

/// A whole number from `low` to `high`.
fn whole(value: &Bound<'_, PyAny>, (low, high): (i128, i128)) -> PyResult<i128> {
    if value.is_instance_of::<PyBool>() {
        return Err(wrong_type(value, "a whole number"));
    }
    match value.extract::<i128>() {
        Ok(found) if (low..=high).contains(&found) => Ok(found),
        Err(error) if error.is_instance_of::<PyTypeError>(value.py()) => {
            Err(wrong_type(value, "a whole number"))
        }
        _ => Err(out_of_limits(value, (low as f64, high as f64))),
    }
}

/// A time in ns.
pub(crate) fn time_ns(value: &Bound<'_, PyAny>) -> PyResult<i64> {
    let found = whole(value, (i64::MIN.into(), i64::MAX.into()))?;
    Ok(i64::try_from(found).unwrap_or(i64::MAX))
}

/// A time in ns, or `None`.
pub(crate) fn optional_time_ns(value: &Bound<'_, PyAny>) -> PyResult<Option<i64>> {
    if value.is_none() {
        Ok(None)
    } else {
        time_ns(value).map(Some)
    }
}

/// An index or a number of things.
pub(crate) fn count(value: &Bound<'_, PyAny>) -> PyResult<usize> {
    let found = whole(value, (0, u32::MAX.into()))?;
    Ok(usize::try_from(found).unwrap_or(usize::MAX))
}

/// A number of things, or `None`.
pub(crate) fn optional_count(value: &Bound<'_, PyAny>) -> PyResult<Option<u32>> {
    if value.is_none() {
        return Ok(None);
    }
    let found = whole(value, (0, u32::MAX.into()))?;
    Ok(Some(u32::try_from(found).unwrap_or(u32::MAX)))
}

/// A counter; a signed one may be negative.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a counter is used modulo its width"
)]
pub(crate) fn counter(value: &Bound<'_, PyAny>) -> PyResult<u64> {
    whole(value, (i64::MIN.into(), u64::MAX.into())).map(|found| found as u64)
}

/// Three real numbers.
pub(crate) fn vector(value: &Bound<'_, PyAny>) -> PyResult<[f64; 3]> {
    let three: [Bound<'_, PyAny>; 3] = value
        .extract()
        .map_err(|_| wrong_type(value, "three numbers"))?;
    let [x, y, z] = three.each_ref().map(number);
    Ok([x?, y?, z?])
}

/// `True` or `False`.
pub(crate) fn flag(value: &Bound<'_, PyAny>) -> PyResult<bool> {
    value
        .extract()
        .map_err(|_| wrong_type(value, "True or False"))
}

/// A path.
pub(crate) fn path(value: &Bound<'_, PyAny>) -> PyResult<PathBuf> {
    value.extract().map_err(|_| wrong_type(value, "a path"))
}

/// A path, or `None`.
pub(crate) fn optional_path(value: &Bound<'_, PyAny>) -> PyResult<Option<PathBuf>> {
    if value.is_none() {
        Ok(None)
    } else {
        path(value).map(Some)
    }
}

/// Text.
pub(crate) fn text(value: &Bound<'_, PyAny>) -> PyResult<String> {
    value.extract().map_err(|_| {
        if value.is_instance_of::<PyString>() {
            let message = "has a lone surrogate, but must be text that UTF-8 holds";
            input_error(message.to_owned(), Details::default())
        } else {
            wrong_type(value, "text")
        }
    })
}

/// What is no argument of its own, read by `read`: its errors name `field`, as PyO3 does it for arguments.
pub(crate) fn named<T>(
    field: &str,
    value: &Bound<'_, PyAny>,
    read: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<T>,
) -> PyResult<T> {
    read(value).inspect_err(|error| {
        let note = format!("while processing '{field}'");
        // an error without a name is better than another error
        let _ = error.value(value.py()).call_method1("add_note", (note,));
    })
}

/// Text, or `None`.
pub(crate) fn optional_text(value: &Bound<'_, PyAny>) -> PyResult<Option<String>> {
    if value.is_none() {
        Ok(None)
    } else {
        text(value).map(Some)
    }
}

/// One of `choices` by its name; `None` where no word is given.
pub(crate) fn choice<T: Copy>(
    field: &str,
    word: Option<&str>,
    choices: &[(&str, T)],
) -> PyResult<Option<T>> {
    let Some(word) = word else { return Ok(None) };
    if let Some((_, choice)) = choices.iter().find(|(name, _)| *name == word) {
        return Ok(Some(*choice));
    }
    let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
    let message = format!(
        "{field} is `{word}`, but must be one of {}",
        names.join(", ")
    );
    Err(input_error(message, Details::field(field)))
}

/// An object of this package.
pub(crate) fn object<T: PyClass + Clone>(value: &Bound<'_, PyAny>) -> PyResult<T> {
    let found = value
        .cast::<T>()
        .map_err(|_| wrong_type(value, &format!("a {}", T::NAME)))?;
    Ok(found.borrow().clone())
}
