//! Soil parameters from tests, with their intervals.

use std::path::PathBuf;

use grouser::files::{Document, soil as soil_file};
use grouser::identify::least_squares::Interval;
use grouser::identify::{Identification, IdentifiedNumber, Job, identify as run};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::raised;
use crate::workers;

/// Name with its unit, value, standard error, interval (open ends are `None`), verdict.
type Number = (String, f64, f64, Option<f64>, Option<f64>, &'static str);

fn numbers(found: &Identification) -> Vec<Number> {
    let number = |own: IdentifiedNumber| {
        let Interval { low, high } = own.interval;
        (
            own.name,
            own.value,
            own.standard_error,
            low,
            high,
            own.verdict.key(),
        )
    };
    found.numbers().into_iter().map(number).collect()
}

/// Identifies the soil of a job file; returns the text of the soil file (`None` where numbers are missing),
/// the missing numbers, the identified numbers, and the doubts.
#[pyfunction]
pub(crate) fn identify<'py>(
    py: Python<'py>,
    path: PathBuf,
    threads: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let job = move || {
        let job = raised(Job::read(&raised(Document::read(&path))?))?;
        let found = raised(run(&job))?;
        let missing = found.missing();
        let text = if missing.is_empty() {
            let (file, remarks) = found.soil_file(&job);
            let remarks: Vec<&str> = remarks.iter().map(String::as_str).collect();
            Some(raised(soil_file::to_toml(&file, &remarks))?)
        } else {
            None
        };
        let doubts: Vec<String> = found.doubts().iter().map(ToString::to_string).collect();
        Ok::<_, PyErr>((text, missing, numbers(&found), doubts))
    };
    let (text, missing, numbers, doubts) = workers::interruptible(py, threads, job, || ())??;
    let dict = PyDict::new(py);
    dict.set_item("text", text)?;
    dict.set_item("missing", missing)?;
    dict.set_item("numbers", numbers)?;
    dict.set_item("doubts", doubts)?;
    Ok(dict)
}
