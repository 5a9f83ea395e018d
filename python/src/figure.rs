//! Line charts as SVG or PNG, and their files.

use std::io;
use std::path::PathBuf;

use grouser::figure::{Axis, Chart, Curve, Figure, Points, Style};
use grouser::files;
use numpy::{PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::argument;
use crate::error::{Details, input_error};

/// Lines: x, y, label (empty for none), and whether they are points.
type Lines<'py> = Vec<(
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    Bound<'py, PyAny>,
    bool,
)>;

/// A chart as the text of SVG, or as PNG at a resolution; titles and labels may contain `*italic*`, `_{subscript}` and `^{superscript}`.
#[pyfunction]
pub(crate) fn chart<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = argument::text)] title: String,
    #[pyo3(from_py_with = argument::text)] x_title: String,
    #[pyo3(from_py_with = argument::text)] y_title: String,
    lines: Lines<'py>,
    dots_per_inch: Option<f64>,
) -> PyResult<Bound<'py, PyBytes>> {
    let mut chart = Chart::new(Axis::new(x_title), Axis::new(y_title));
    for (k, (x, y, label, is_points)) in lines.iter().enumerate() {
        let (x, y) = (x.to_vec()?, y.to_vec()?);
        let label = argument::named("label", label, argument::text)?;
        let points = x.into_iter().zip(y).map(|(x, y)| [x, y]);
        chart = if *is_points {
            chart.points(Points::new(points))
        } else {
            let curve = Curve::new(points).style(Style::numbered(k));
            chart.curve(if label.is_empty() {
                curve
            } else {
                curve.label(label)
            })
        };
    }
    let figure = Figure::new(title).panel(chart);
    let bytes = py.detach(|| match dots_per_inch {
        Some(dots_per_inch) => figure
            .png(dots_per_inch)
            .map_err(|error| input_error(error.to_string(), Details::field("dots_per_inch"))),
        None => Ok(figure.svg().into_bytes()),
    })?;
    Ok(PyBytes::new(py, &bytes))
}

/// Writes a file as a whole, or leaves what was there.
#[pyfunction]
pub(crate) fn write_file(py: Python<'_>, path: PathBuf, bytes: Vec<u8>) -> PyResult<()> {
    py.detach(|| {
        files::write_whole(&path, &bytes).map_err(|error| {
            let error = io::Error::from(error);
            io::Error::new(error.kind(), format!("{}: {error}", path.display())).into()
        })
    })
}
