//! Soil parameters from tests, with their intervals.

use std::path::PathBuf;

use grouser::files::{Document, soil as soil_file};
use grouser::identify::least_squares::Interval;
use grouser::identify::{Identification, Job, identify as run};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::raised;
use crate::workers;

/// Name with its unit, value, standard error, interval (open ends are `None`), verdict.
type Number = (String, f64, f64, Option<f64>, Option<f64>, &'static str);

fn number(
    name: &str,
    scale: f64,
    (value, standard_error): (f64, f64),
    interval: &Interval,
    verdict: &'static str,
) -> Number {
    let end = |x: Option<f64>| x.map(|x| x / scale);
    (
        name.to_owned(),
        value / scale,
        standard_error / scale,
        end(interval.low),
        end(interval.high),
        verdict,
    )
}

fn numbers(found: &Identification) -> Vec<Number> {
    let mut all = Vec::new();
    if let Some(stage) = &found.plates {
        for own in &stage.fit.parameters {
            let value = (own.value, own.standard_error);
            let verdict = own.verdict.key();
            all.push(number(&own.name, 1.0, value, &own.interval, verdict));
        }
    }
    if let Some(stage) = &found.shear {
        let fit = &stage.fit;
        let keys = [
            ("cohesion_kpa", 1e3),
            ("phi_deg", 1_f64.to_radians()),
            ("k_shear_m", 1.0),
        ];
        for (k, (name, scale)) in keys.into_iter().enumerate() {
            let value = (fit.values[k], fit.standard_errors[k]);
            let verdict = fit.uncertainty.verdicts.get(k).map_or("", |v| v.key());
            all.push(number(name, scale, value, &fit.intervals[k], verdict));
        }
    }
    if let Some(stage) = &found.wheel {
        for own in &stage.numbers {
            let scale = 1.0 / own.parameter.to_key_unit(1.0);
            let value = (own.value, own.standard_error);
            let (name, verdict) = (own.parameter.key(), own.verdict.key());
            all.push(number(name, scale, value, &own.interval, verdict));
        }
    }
    all
}

/// Identifies the soil of a job file; returns the text of the soil file (`None` where numbers are missing),
/// the missing numbers, and the identified numbers.
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
        Ok::<_, PyErr>((text, missing, numbers(&found)))
    };
    let (text, missing, numbers) = workers::interruptible(py, threads, job, || ())??;
    let dict = PyDict::new(py);
    dict.set_item("text", text)?;
    dict.set_item("missing", missing)?;
    dict.set_item("numbers", numbers)?;
    Ok(dict)
}
