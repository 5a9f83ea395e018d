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

/// A quantity of the laws as the package's keywords have it: the name with its unit, and how many of the keyword's units
/// are one of the laws'.
fn keyword(field: &str, unit: &'static str) -> (String, &'static str, f64) {
    let own = |name: &str| (name.to_owned(), unit, 1.0);
    let with = |suffix: &str, unit, factor| (format!("{field}_{suffix}"), unit, factor);
    match (field, unit) {
        ("k_c", _) => ("k_c_kn_per_m_n1".to_owned(), "kN/m^(n+1)", 1e-3),
        ("k_phi", _) => ("k_phi_kn_per_m_n2".to_owned(), "kN/m^(n+2)", 1e-3),
        ("unit_weight", _) => own("unit_weight_n_per_m3"),
        ("tips", _) => own("grouser_tip_share"),
        ("speed", _) => own("rim_speed_mps"),
        ("min_tip_over", _) => own("min_tip_over_deg"),
        ("turn_energy", _) => own("turn_energy_j"),
        ("lug_count", _) => own("grouser_count"),
        ("lug_thickness", _) => own("grouser_thickness_m"),
        (_, "m") => with("m", unit, 1.0),
        (_, "N") => with("n", unit, 1.0),
        (_, "N m") => with("nm", unit, 1.0),
        (_, "rad") => with("deg", "deg", 1_f64.to_degrees()),
        (_, "Pa") => with("kpa", "kPa", 1e-3),
        _ => own(field),
    }
}

/// `x` in a keyword's unit, to fifteen digits: what 95 degrees became in radians is 95 again.
fn in_unit(x: f64, factor: f64) -> f64 {
    if factor == 1.0 || !x.is_finite() {
        return x;
    }
    format!("{:.14e}", x * factor).parse().unwrap_or(x * factor)
}

/// A number of the laws that lies outside its limits, by its keyword.
fn by_keyword(range: OutOfRange<&'static str>) -> OutOfRange<String> {
    let (field, unit, factor) = keyword(range.field, range.unit);
    OutOfRange {
        value: in_unit(range.value, factor),
        low: in_unit(range.low, factor),
        high: in_unit(range.high, factor),
        unit,
        field,
    }
}

/// What a number outside its limits carries; a file's key states its unit in its name.
fn out_of_range(error: OutOfRange<String>) -> Details {
    Details {
        value: number(error.value),
        limit: Some(Limit::Range((error.low, error.high))),
        unit: Some(match error.unit {
            "" => files::unit_of_key(&error.field),
            unit => unit,
        }),
        field: Some(error.field),
    }
}

fn place(x: f64, y: f64) -> Option<Py<PyAny>> {
    Python::attach(|py| Some((x, y).into_pyobject(py).ok()?.into_any().unbind()))
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

impl IntoPython for OutOfRange<&'static str> {
    fn into_python(self) -> PyErr {
        let range = self.named(self.field.to_owned());
        input_error(range.to_string(), out_of_range(range))
    }
}

impl IntoPython for terra::Error {
    fn into_python(self) -> PyErr {
        let field = self.field().map(ToOwned::to_owned);
        let message = self.to_string();
        let details = match self {
            Self::OutOfRange(range) => {
                let range = by_keyword(range);
                return input_error(range.to_string(), out_of_range(range));
            }
            Self::NotAbove {
                field,
                value,
                limit,
                unit,
            } => {
                let (field, unit, factor) = keyword(field, unit);
                Details {
                    field: Some(field),
                    value: number(in_unit(value, factor)),
                    limit: Some(Limit::Above(in_unit(limit, factor))),
                    unit: Some(unit),
                }
            }
            Self::NotFinite { field, value, unit } => {
                let (field, unit, _) = keyword(field, unit);
                Details {
                    field: Some(field),
                    value: number(value),
                    limit: None,
                    unit: Some(unit),
                }
            }
            Self::HubBuried { sinkage, radius } => Details {
                field: Some("sinkage_m".to_owned()),
                value: number(sinkage),
                limit: Some(Limit::Range((0.0, radius))),
                unit: Some("m"),
            },
            Self::ReboundAboveHub {
                rebound,
                sinkage,
                radius,
            } => Details {
                field: field.clone(),
                value: number(rebound),
                limit: Some(Limit::Range((0.0, radius / sinkage))),
                unit: Some("1"),
            },
            _ => Details {
                field: field.clone(),
                ..Details::default()
            },
        };
        // the message's field too, where its numbers are in the keyword's unit
        let message = match (field, &details.field, details.unit) {
            (Some(plain), Some(own), Some("m" | "N" | "N m")) if message.starts_with(&plain) => {
                message.replacen(&plain, own, 1)
            }
            _ => message,
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
                let plain = source.to_string();
                let error = source.into_python();
                Python::attach(|py| {
                    // the same details, under the message that names the place
                    let value = error.value(py);
                    let message = message.replace(&plain, &value.to_string());
                    let get = |name| value.getattr(name).map(Bound::unbind).ok();
                    InputError::new_err((
                        message,
                        get("field"),
                        get("value"),
                        get("limit"),
                        get("unit"),
                    ))
                })
            }
            E::OutOfRange { range, .. } => input_error(message, out_of_range(range)),
            E::MissingKey { key, .. } | E::RemovedKey { key, .. } => {
                input_error(message, Details::field(key))
            }
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
            E::OutOfRange { of, range } => {
                let range = by_keyword(range);
                input_error(format!("{of}: {range}"), out_of_range(range))
            }
            E::Place { of, x, y, .. } => {
                let field = format!("{}_m", of.trim_start_matches("the "));
                let message = message.replacen(of, &field, 1);
                let details = Details {
                    value: place(x, y),
                    unit: Some("m"),
                    ..Details::field(&field)
                };
                input_error(message, details)
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
