//! One wheel on one soil at one sinkage and motion.

use grouser::terra::{self, FieldValue, ReadField, ResultField};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::argument;
use crate::contact::{WheelOnSoil, kinematics};
use crate::error::raised;

/// A pickled operating point: contact, load (N), sinkage (m), slip, slip angle (degrees).
type State<'py> = (Bound<'py, WheelOnSoil>, Option<f64>, f64, f64, f64);

/// A wheel at one sinkage and one motion: geometry, forces and how far to trust them.
///
/// Lengths in m, forces in N (vertical upwards, drawbar pull forwards, side force to the left), torque in
/// N m (positive where a motor drives), angles in degrees.
#[pyclass(frozen, module = "grouser._core")]
#[derive(Debug)]
pub(crate) struct OperatingPoint {
    point: terra::OperatingPoint,
    solution: terra::LoadSolution,
    /// What it was computed from; pickled instead of it.
    made: (Py<WheelOnSoil>, Given),
}

/// Load (N) or sinkage (m), slip and slip angle (degrees).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given {
    pub(crate) load_n: Option<f64>,
    pub(crate) sinkage_m: f64,
    pub(crate) slip: f64,
    pub(crate) slip_angle_deg: f64,
}

impl OperatingPoint {
    /// The point that a load or a sinkage has; `None` where nothing carries the load.
    pub(crate) fn solved(contact: &Bound<'_, WheelOnSoil>, given: Given) -> PyResult<Option<Self>> {
        let solution = given.solve(contact.get())?;
        let made = (contact.clone().unbind(), given);
        Ok(solution.point().map(|point| Self {
            point,
            solution,
            made,
        }))
    }
}

impl Given {
    fn solve(self, contact: &WheelOnSoil) -> PyResult<terra::LoadSolution> {
        let motion = raised(kinematics(self.slip, self.slip_angle_deg))?;
        let sinkage = terra::Prescribed::Sinkage(self.sinkage_m);
        let prescribed = self.load_n.map_or(sinkage, terra::Prescribed::Load);
        raised(contact.contact.solve(prescribed, &motion))
    }

    /// All declared fields, as the command prints them.
    pub(crate) fn fields<'py>(
        self,
        py: Python<'py>,
        contact: &WheelOnSoil,
    ) -> PyResult<Bound<'py, PyDict>> {
        let solution = self.solve(contact)?;
        let dict = PyDict::new(py);
        for field in terra::LoadSolution::FIELDS {
            dict.set_item(field.key, value(py, field, &solution)?)?;
        }
        let point = solution.point();
        if let Some(lugs) = point.and_then(|point| contact.contact.lug_passage(&point)) {
            for field in terra::LugPassage::FIELDS {
                dict.set_item(field.key, value(py, field, &lugs)?)?;
            }
        }
        Ok(dict)
    }
}

/// The value of a declared field.
fn value<'py, T>(py: Python<'py>, field: &ResultField<T>, of: &T) -> PyResult<Bound<'py, PyAny>> {
    match field.value(of) {
        FieldValue::Missing => Ok(py.None().into_bound(py)),
        FieldValue::Number(number) => number.into_bound_py_any(py),
        FieldValue::Whole(number) => number.into_bound_py_any(py),
        FieldValue::Text(text) => text.into_bound_py_any(py),
        FieldValue::Texts => {
            let mut all = Vec::new();
            if let ReadField::Texts(read) = field.read {
                read(of, &mut |text| all.push(text));
            }
            all.into_bound_py_any(py)
        }
    }
}

#[pymethods]
impl OperatingPoint {
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, State<'py>)> {
        let (contact, given) = &slf.get().made;
        let state = (
            contact.bind(slf.py()).clone(),
            given.load_n,
            given.sinkage_m,
            given.slip,
            given.slip_angle_deg,
        );
        Ok((slf.get_type().getattr("_again")?, state))
    }

    #[staticmethod]
    fn _again(
        contact: &Bound<'_, WheelOnSoil>,
        load_n: Option<f64>,
        sinkage_m: f64,
        slip: f64,
        slip_angle_deg: f64,
    ) -> PyResult<Option<Self>> {
        let given = Given {
            load_n,
            sinkage_m,
            slip,
            slip_angle_deg,
        };
        Self::solved(contact, given)
    }

    /// Slip: positive where the wheel drives, negative where it brakes.
    #[getter]
    fn slip(&self) -> f64 {
        self.point.kinematics.slip().value()
    }

    /// Key and words of each declared field, of which `grouser._declared` makes properties.
    #[staticmethod]
    fn _fields() -> Vec<(&'static str, &'static str)> {
        let own = terra::LoadSolution::FIELDS.iter();
        let lugs = terra::LugPassage::FIELDS.iter();
        own.map(|field| (field.key, field.words))
            .chain(lugs.map(|field| (field.key, field.words)))
            .collect()
    }

    /// A declared field by its key; `None` where it has no value.
    fn _value<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        if let Some(field) = terra::LoadSolution::FIELDS.iter().find(|f| f.key == key) {
            return value(py, field, &self.solution);
        }
        let lugs = terra::LugPassage::FIELDS.iter().find(|f| f.key == key);
        let passage = self.made.0.get().contact.lug_passage(&self.point);
        match lugs.zip(passage) {
            Some((field, lugs)) => value(py, field, &lugs),
            None => Ok(py.None().into_bound(py)),
        }
    }

    /// Normal stress at an angle (degrees from the vertical, towards the front), Pa.
    fn normal_stress_pa(&self, #[pyo3(from_py_with = argument::number)] theta_deg: f64) -> f64 {
        self.point.normal_stress(theta_deg.to_radians())
    }

    /// Shear stress along and across the wheel at an angle (degrees), Pa.
    fn shear_stress_pa(
        &self,
        #[pyo3(from_py_with = argument::number)] theta_deg: f64,
    ) -> (f64, f64) {
        self.point.shear_stress(theta_deg.to_radians())
    }

    fn __repr__(&self) -> String {
        format!(
            "OperatingPoint(slip={}, sinkage_m={}, vertical_force_n={}, drawbar_pull_n={}, torque_nm={}, cautions={:?})",
            self.slip(),
            self.point.sinkage,
            self.point.forces.vertical_force,
            self.point.forces.drawbar_pull,
            self.point.forces.torque,
            self.point
                .cautions
                .iter()
                .map(terra::Caution::key)
                .collect::<Vec<_>>()
        )
    }
}
