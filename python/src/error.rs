//! Errors of the libraries as Python exceptions with field, value, limit and unit.

use grouser::real::OutOfRange;
use grouser::{files, terra};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyString;

pyo3::import_exception!(grouser._errors, InputError);
pyo3::import_exception!(grouser._errors, InputTypeError);

/// The limit that a value violates.
#[derive(Clone, Copy, Debug, IntoPyObject)]
pub(crate) enum Limit {
    /// The least and the greatest value allowed.
    Range((f64, f64)),
    /// What must be exceeded.
    Above(f64),
}

/// What an exception carries besides its message.
#[derive(Debug, Default)]
pub(crate) struct Details {
    pub(crate) field: Option<String>,
    pub(crate) value: Option<Py<PyAny>>,
    pub(crate) limit: Option<Limit>,
    pub(crate) unit: Option<&'static str>,
}

impl Details {
    /// A field without more.
    pub(crate) fn field(name: &str) -> Self {
        Self {
            field: Some(name.to_owned()),
            ..Self::default()
        }
    }
}

/// An `InputError`.
pub(crate) fn input_error(message: String, details: Details) -> PyErr {
    InputError::new_err((
        message,
        details.field,
        details.value,
        details.limit,
        details.unit,
    ))
}

/// An `InputTypeError`.
pub(crate) fn type_error(message: String, field: &str) -> PyErr {
    InputTypeError::new_err((message, field.to_owned()))
}

fn number(value: f64) -> Option<Py<PyAny>> {
    Python::attach(|py| value.into_pyobject(py).ok().map(|n| n.into_any().unbind()))
}

/// What a number outside its limits carries; a pure number of a file's key has its unit in the key.
fn out_of_range(error: OutOfRange<String>) -> Details {
    Details {
        field: Some(error.field),
        value: number(error.value),
        limit: Some(Limit::Range((error.low, error.high))),
        unit: Some(error.unit),
    }
}

fn text(value: &str) -> Option<Py<PyAny>> {
    Python::attach(|py| Some(PyString::new(py, value).into_any().unbind()))
}

/// What becomes a Python exception.
pub(crate) trait IntoPython {
    /// The exception.
    fn into_python(self) -> PyErr;
}

/// `result` with its error as a Python exception.
pub(crate) fn raised<T, E: IntoPython>(result: Result<T, E>) -> PyResult<T> {
    result.map_err(IntoPython::into_python)
}

impl IntoPython for terra::Error {
    fn into_python(self) -> PyErr {
        let field = self.field().map(ToOwned::to_owned);
        let message = self.to_string();
        let details = match self {
            Self::OutOfRange(range) => out_of_range(range.named(range.field.to_owned())),
            Self::NotAbove {
                value, limit, unit, ..
            } => Details {
                field,
                value: number(value),
                limit: Some(Limit::Above(limit)),
                unit: Some(unit),
            },
            Self::NotFinite { value, unit, .. } => Details {
                field,
                value: number(value),
                limit: None,
                unit: Some(unit),
            },
            Self::HubBuried { sinkage, radius } => Details {
                field,
                value: number(sinkage),
                limit: Some(Limit::Range((0.0, radius))),
                unit: Some("m"),
            },
            Self::ReboundAboveHub {
                rebound,
                sinkage,
                radius,
            } => Details {
                field,
                value: number(rebound),
                limit: Some(Limit::Range((0.0, radius / sinkage))),
                unit: Some("1"),
            },
            _ => Details {
                field,
                ..Details::default()
            },
        };
        input_error(message, details)
    }
}

impl IntoPython for files::Error {
    fn into_python(self) -> PyErr {
        use files::Error as E;
        let message = match self.hint() {
            Some(hint) => format!("{self} ({hint})"),
            None => self.to_string(),
        };
        match self {
            E::Unreadable { file, source } => os_error(&file, &source),
            E::Soil { source, .. } => {
                let error = source.into_python();
                Python::attach(|py| {
                    // the same details, under the message that names the place
                    let value = error.value(py);
                    let get = |name| value.getattr(name).map(Bound::unbind).ok();
                    InputError::new_err((
                        message.clone(),
                        get("field"),
                        get("value"),
                        get("limit"),
                        get("unit"),
                    ))
                })
            }
            E::OutOfRange { range, .. } => input_error(message, out_of_range(range)),
            E::MissingKey { key, .. } => input_error(message, Details::field(key)),
            E::UnknownKey { key, .. } => input_error(message, Details::field(&key)),
            E::WrongType { key, .. } => type_error(message, &key),
            E::BadChoice { key, value, .. } => input_error(
                message,
                Details {
                    field: Some(key),
                    value: text(&value),
                    ..Details::default()
                },
            ),
            _ => input_error(message, Details::default()),
        }
    }
}

/// An `OSError` with its number and file, so that Python raises `FileNotFoundError` and its like.
pub(crate) fn os_error(file: &str, source: &std::io::Error) -> PyErr {
    match source.raw_os_error() {
        Some(code) => PyOSError::new_err((code, source.to_string(), file.to_owned())),
        None => PyOSError::new_err(format!("{file}: {source}")),
    }
}

impl IntoPython for grouser::opt::Error {
    fn into_python(self) -> PyErr {
        use grouser::opt::Error as E;
        let message = self.to_string();
        let details = match self {
            E::NotFinite { field, value, .. } => Details {
                value: number(value),
                ..Details::field(field)
            },
            E::InconsistentBounds { name, lower, upper } => Details {
                value: number(lower),
                limit: Some(Limit::Range((f64::NEG_INFINITY, upper))),
                ..Details::field(&name)
            },
            E::UnboundedVariable { name, .. } => Details::field(&name),
            E::OutOfRange(error) => out_of_range(error),
            E::WrongLength {
                what,
                given,
                expected,
            } => Details {
                value: number(given as f64),
                limit: Some(Limit::Range((expected as f64, expected as f64))),
                ..Details::field(&what)
            },
            E::DuplicateName { name } => Details::field(&name),
            _ => Details::default(),
        };
        input_error(message, details)
    }
}

/// An error with a message, and of files and soils with their details.
macro_rules! layered {
    ($($error:ty { $($inner:path),* })*) => {$(
        impl IntoPython for $error {
            fn into_python(self) -> PyErr {
                match self {
                    $($inner(error) => error.into_python(),)*
                    error => input_error(error.to_string(), Details::default()),
                }
            }
        }
    )*};
}

layered! {
    grouser::design::Error { grouser::design::Error::File }
    grouser::replay::Error {
        grouser::replay::Error::Log,
        grouser::replay::Error::File,
        grouser::replay::Error::Settings,
        grouser::replay::Error::Soil
    }
    grouser::log::Error { grouser::log::Error::File }
    grouser::identify::Error { grouser::identify::Error::File, grouser::identify::Error::Log }
    grouser::rover::Error { grouser::rover::Error::File, grouser::rover::Error::Estimator }
}

impl IntoPython for grouser::terrain::Error {
    fn into_python(self) -> PyErr {
        use grouser::terrain::Error as E;
        let message = match self.hint() {
            Some(hint) => format!("{self} ({hint})"),
            None => self.to_string(),
        };
        match self {
            E::OutOfRange { range, .. } => {
                input_error(message, out_of_range(range.named(range.field.to_owned())))
            }
            E::File { file, source, .. } => os_error(&file.display().to_string(), &source),
            E::Law { source, .. } => source.into_python(),
            E::OwnFile(error) => error.into_python(),
            E::Rover(error) => error.into_python(),
            _ => input_error(message, Details::default()),
        }
    }
}

impl IntoPython for grouser::slip::Error {
    fn into_python(self) -> PyErr {
        use grouser::slip::Error as E;
        let message = self.to_string();
        let details = match self {
            E::OutOfRange { range, .. } => out_of_range(range.named(range.field.to_owned())),
            E::WheelCount { count, limit } => Details {
                value: number(count as f64),
                limit: Some(Limit::Range((1.0, limit as f64))),
                ..Details::field("wheels")
            },
            E::UnknownWheel { index, wheels } => Details {
                value: number(index as f64),
                limit: Some(Limit::Range((0.0, wheels as f64 - 1.0))),
                ..Details::field("wheel")
            },
            E::Law { source, .. } => return source.into_python(),
            _ => Details::default(),
        };
        input_error(message, details)
    }
}
