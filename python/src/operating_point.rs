//! One wheel on one soil at one sinkage and motion.

use grouser::terra;
use pyo3::prelude::*;

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
        let motion = raised(kinematics(given.slip, given.slip_angle_deg))?;
        let own = &contact.get().contact;
        let point = match given.load_n {
            Some(load) => raised(own.under_load(load, &motion))?.point(),
            None => Some(raised(own.at_sinkage(given.sinkage_m, &motion))?),
        };
        let made = (contact.clone().unbind(), given);
        Ok(point.map(|point| Self { point, made }))
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

    /// Sinkage, m.
    #[getter]
    fn sinkage_m(&self) -> f64 {
        self.point.sinkage
    }

    /// Entry angle, degrees.
    #[getter]
    fn theta_1_deg(&self) -> f64 {
        self.point.angles.theta_1.to_degrees()
    }

    /// Exit angle, degrees.
    #[getter]
    fn theta_2_deg(&self) -> f64 {
        self.point.angles.theta_2.to_degrees()
    }

    /// Angle of the greatest normal stress, degrees.
    #[getter]
    fn theta_m_deg(&self) -> f64 {
        self.point.angles.theta_m.to_degrees()
    }

    /// Vertical force, N.
    #[getter]
    fn vertical_force_n(&self) -> f64 {
        self.point.forces.vertical_force
    }

    /// Drawbar pull, N.
    #[getter]
    fn drawbar_pull_n(&self) -> f64 {
        self.point.forces.drawbar_pull
    }

    /// Side force, N.
    #[getter]
    fn side_force_n(&self) -> f64 {
        self.point.side_force
    }

    /// Torque, N m.
    #[getter]
    fn torque_nm(&self) -> f64 {
        self.point.forces.torque
    }

    /// Compaction resistance, N.
    #[getter]
    fn compaction_resistance_n(&self) -> f64 {
        self.point.forces.compaction_resistance
    }

    /// The share of the motor's work that pulls; `None` unless the wheel is driven and pulls.
    #[getter]
    fn tractive_efficiency(&self) -> Option<f64> {
        self.point.tractive_efficiency()
    }

    /// Energy per metre of travel, J/m; `None` for a wheel that spins on the spot.
    #[getter]
    fn energy_j_per_m(&self) -> Option<f64> {
        self.point.energy_per_metre()
    }

    /// Drawbar pull over vertical force; `None` where nothing is carried.
    #[getter]
    fn pull_coefficient(&self) -> Option<f64> {
        self.point.pull_coefficient()
    }

    /// The error of the integrals at most, N.
    #[getter]
    fn error_estimate_n(&self) -> f64 {
        self.point.error_estimate
    }

    /// What to keep in mind, by the keys that the command prints.
    #[getter]
    fn cautions(&self) -> Vec<&'static str> {
        self.point
            .cautions
            .iter()
            .map(terra::Caution::key)
            .collect()
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
            self.sinkage_m(),
            self.vertical_force_n(),
            self.drawbar_pull_n(),
            self.torque_nm(),
            self.cautions()
        )
    }
}
