//! One reading of one sensor.

use grouser::slip::{self, Measurement, MeasurementKind, MeasurementPart, MeasurementParts};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::argument::{self, named};
use crate::error::{Details, input_error};

/// One reading of one sensor: built by the function named after its kind.
///
/// Times are nanoseconds on one clock with any zero, wheels are indices in the robot's order. Forwards and
/// to the left are positive.
///
/// Examples
/// --------
/// >>> from grouser.slip import Sample
/// >>> Sample.wheel_count(time_ns=0, wheel=1, count=4095).kind
/// 'wheel-count'
#[pyclass(frozen, eq, from_py_object, module = "grouser._core")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample(pub(crate) slip::Sample);

/// A kind's name, what it is, is it of a wheel, and its other keywords: each with its unit and may it be `None`.
type Kind = (
    &'static str,
    &'static str,
    bool,
    Vec<(&'static str, &'static str, bool)>,
);

/// Kind, wheel (-1 for the robot) and up to six numbers; counts beyond 2^53 lose their last bits here, the sample keeps them.
pub(crate) fn parts(measurement: &Measurement) -> (&'static str, i64, [f64; 6]) {
    let MeasurementParts {
        index,
        count,
        numbers,
    } = measurement.parts();
    let wheel = measurement
        .wheel()
        .and_then(|wheel| i64::try_from(wheel).ok());
    let mut numbers = numbers.map(|number| number.unwrap_or(f64::NAN));
    for field in measurement.kind().fields().iter().rev() {
        let first = match field.part {
            MeasurementPart::Index => index as f64,
            MeasurementPart::Count => count as f64,
            MeasurementPart::Number
            | MeasurementPart::YesOrNo
            | MeasurementPart::OptionalNumber
            | MeasurementPart::Vector => continue,
        };
        numbers.rotate_right(1);
        numbers[0] = first;
    }
    (measurement.kind().name(), wheel.unwrap_or(-1), numbers)
}

#[pymethods]
impl Sample {
    /// When it was taken, ns.
    #[getter]
    fn time_ns(&self) -> i64 {
        self.0.time_ns
    }

    /// Its kind, such as `wheel-count` or `yaw-rate`.
    #[getter]
    fn kind(&self) -> &'static str {
        self.0.measurement.kind().name()
    }

    /// The wheel's index; `None` for a sensor of the robot.
    #[getter]
    fn wheel(&self) -> Option<usize> {
        self.0.measurement.wheel()
    }

    /// Its numbers, in the order of its function's arguments.
    #[getter]
    fn numbers(&self) -> Vec<f64> {
        let (_, _, numbers) = parts(&self.0.measurement);
        numbers.into_iter().filter(|x| !x.is_nan()).collect()
    }

    fn __repr__(&self) -> String {
        format!("Sample({:?})", self.0)
    }

    #[allow(
        clippy::type_complexity,
        reason = "the pair that the protocol of pickle wants"
    )]
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (&'static str, Bound<'py, PyDict>))> {
        let sample = &slf.get().0;
        let MeasurementParts {
            index,
            count,
            numbers,
        } = sample.measurement.parts();
        let values = PyDict::new(slf.py());
        values.set_item("time_ns", sample.time_ns)?;
        values.set_item("wheel", sample.measurement.wheel())?;
        let mut numbers = numbers.into_iter();
        for field in sample.measurement.kind().fields() {
            let mut number = || numbers.next().flatten();
            match field.part {
                MeasurementPart::Index => values.set_item(field.key, index)?,
                MeasurementPart::Count => values.set_item(field.key, count)?,
                MeasurementPart::YesOrNo => values.set_item(field.key, number() > Some(0.0))?,
                MeasurementPart::Number | MeasurementPart::OptionalNumber => {
                    values.set_item(field.key, number())?;
                }
                MeasurementPart::Vector => {
                    values.set_item(field.key, [number(), number(), number()])?;
                }
            }
        }
        Ok((slf.get_type().getattr("_of")?, (slf.get().kind(), values)))
    }

    /// Every kind, of which `grouser._declared` makes functions.
    #[staticmethod]
    fn _kinds() -> Vec<Kind> {
        let kinds = MeasurementKind::ALL.iter().map(|kind| {
            let fields = kind.fields().iter().map(|field| {
                let may_lack = field.part == MeasurementPart::OptionalNumber;
                (field.key, field.unit, may_lack)
            });
            let fields = fields.collect();
            (kind.name(), kind.words(), kind.is_of_a_wheel(), fields)
        });
        kinds.collect()
    }

    /// The sample of that kind with these keywords.
    #[staticmethod]
    fn _of(kind: &str, values: &Bound<'_, PyDict>) -> PyResult<Self> {
        let value = |key: &'static str| {
            let found = values.get_item(key)?;
            found.ok_or_else(|| PyKeyError::new_err(key))
        };
        let mut kinds = MeasurementKind::ALL.iter();
        let kind = *kinds.find(|own| own.name() == kind).ok_or_else(|| {
            let message = format!("kind is `{kind}`, but must be one that Sample makes");
            input_error(message, Details::field("kind"))
        })?;
        let time_ns = named("time_ns", &value("time_ns")?, argument::time_ns)?;
        let mut parts = MeasurementParts::default();
        if kind.is_of_a_wheel() {
            parts.index = named("wheel", &value("wheel")?, argument::count)?;
        }
        let mut numbers = Vec::new();
        for field in kind.fields() {
            let (key, given) = (field.key, value(field.key)?);
            match field.part {
                MeasurementPart::Index => parts.index = named(key, &given, argument::count)?,
                MeasurementPart::Count => parts.count = named(key, &given, argument::counter)?,
                MeasurementPart::Number => {
                    numbers.push(Some(named(key, &given, argument::number)?));
                }
                MeasurementPart::YesOrNo => {
                    let yes = named(key, &given, argument::flag)?;
                    numbers.push(Some(if yes { 1.0 } else { -1.0 }));
                }
                MeasurementPart::OptionalNumber => {
                    numbers.push(named(key, &given, argument::optional_number)?);
                }
                MeasurementPart::Vector => {
                    numbers.extend(named(key, &given, argument::vector)?.map(Some));
                }
            }
        }
        for (part, number) in parts.numbers.iter_mut().zip(numbers) {
            *part = number;
        }
        let measurement = Measurement::from_parts(kind, parts);
        let measurement = measurement.ok_or_else(|| PyKeyError::new_err("a number is missing"))?;
        Ok(Self(slip::Sample {
            time_ns,
            measurement,
        }))
    }
}
