//! Robot files.

use std::path::PathBuf;

use grouser::files::robot::{self, RobotFile};
use grouser::files::{Document, columns};
use grouser::slip::WheelRole;
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::argument;
use crate::error::raised;

/// A robot: its wheels, and how their slip is to be estimated.
///
/// `Robot.read` reads a robot file, `Robot.from_toml` the text of one; docs/robots.md describes its keys.
#[pyclass(frozen, eq, from_py_object, module = "grouser._core")]
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Robot(pub(crate) RobotFile);

#[pymethods]
impl Robot {
    /// Reads a robot file (TOML). Where it does not say what the columns of tables mean, `columns.toml` beside it does.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     The file cannot be read.
    /// InputError
    ///     What the file lacks or has wrong, with its line.
    #[staticmethod]
    fn read(#[pyo3(from_py_with = argument::path)] path: PathBuf) -> PyResult<Self> {
        let mut file = raised(robot::read(&path))?;
        let beside = path.with_file_name("columns.toml");
        if file.columns.is_none() && beside.exists() {
            file.columns = Some(raised(columns::read(&beside))?);
        }
        Ok(Self(file))
    }

    /// A robot from the text of a robot file.
    #[staticmethod]
    fn from_toml(#[pyo3(from_py_with = argument::text)] text: String) -> PyResult<Self> {
        let document = raised(Document::from_text("robot", text))?;
        raised(robot::parse(&document)).map(Self)
    }

    /// The text of a robot file that reads back to the same numbers.
    fn to_toml(&self) -> String {
        robot::to_toml(&self.0)
    }

    /// The name.
    #[getter]
    fn name(&self) -> &str {
        self.0.robot.name()
    }

    /// The names of the wheels, in the order of their indices.
    #[getter]
    fn wheels(&self) -> Vec<&str> {
        let wheels = self.0.robot.wheels().iter();
        wheels.map(|wheel| wheel.name.as_str()).collect()
    }

    /// Whether each wheel is powered; the others roll freely.
    #[getter]
    fn powered(&self) -> Vec<bool> {
        let wheels = self.0.robot.wheels().iter();
        wheels
            .map(|wheel| wheel.role == WheelRole::Powered)
            .collect()
    }

    fn __repr__(&self) -> String {
        format!("Robot(name={:?}, wheels={:?})", self.name(), self.wheels())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let class: Bound<'py, PyType> = slf.get_type();
        Ok((class.getattr("from_toml")?, (slf.get().to_toml(),)))
    }
}
