//! One wheel on one soil: operating points, derivatives, slip demand, best slip.

use grouser::real::Dual;
use grouser::terra;
use grouser::terra::{
    Accuracy, Angle, BatchKernel, Bulldozing, DualInputs, Kinematics, LoadOutcome, Settings,
    ShearLaw, Slip, SlopeOutcome, SolveStatus, WheelOnSoil as Contact,
};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::argument;
use crate::batch::{Column, part, write_codes};
use crate::error::{Details, input_error, raised};
use crate::soil::Soil;
use crate::wheel::Wheel;
use crate::workers;

type Floats<'py> = Bound<'py, PyArray1<f64>>;
/// A pickled operating point: contact, load (N), sinkage (m), slip, slip angle (degrees).
type State<'py> = (Bound<'py, WheelOnSoil>, Option<f64>, f64, f64, f64);
type Codes<'py> = Bound<'py, PyArray1<u8>>;

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
struct Given {
    load_n: Option<f64>,
    sinkage_m: f64,
    slip: f64,
    slip_angle_deg: f64,
}

impl OperatingPoint {
    fn solved(contact: &Bound<'_, WheelOnSoil>, given: Given) -> PyResult<Option<Self>> {
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

/// A wheel on a soil.
///
/// Parameters
/// ----------
/// wheel : Wheel
/// soil : Soil
/// reference_accuracy : bool
///     Integrals to rounding (1e-13) in place of 1e-9.
///
/// Raises
/// ------
/// InputError
///     The soil carries no wheel of this width.
///
/// Examples
/// --------
/// >>> from grouser.soils import Soil
/// >>> from grouser.wheel import Wheel, WheelOnSoil
/// >>> contact = WheelOnSoil(Wheel(radius_m=0.125, width_m=0.15), Soil.find("lunar"))
/// >>> point = contact.under_load(load_n=65.0, slip=0.25)
/// >>> round(point.sinkage_m, 6), round(point.drawbar_pull_n, 4)
/// (0.017007, 3.2949)
#[pyclass(frozen, module = "grouser._core")]
#[derive(Clone, Debug)]
pub(crate) struct WheelOnSoil {
    pub(crate) contact: Contact,
    wheel: Wheel,
    soil: Soil,
}

fn kinematics(slip: f64, slip_angle_deg: f64) -> terra::Result<Kinematics> {
    let slip = Slip::new(slip)?;
    if slip_angle_deg == 0.0 {
        return Ok(Kinematics::straight(slip));
    }
    Kinematics::with_slip_angle(slip, Angle::from_deg(slip_angle_deg))
}

fn at(column: terra::BatchInput<'_>, i: usize) -> f64 {
    match column {
        terra::BatchInput::Constant(x) => x,
        terra::BatchInput::Column(values) => values[i],
    }
}

/// Slopes between two looks at signals: a millisecond or two on lanes, a second one by one.
const SLOPES_PER_BLOCK: usize = 512;

/// Columns of the same length, computed point by point on threads.
fn rows<const N: usize>(
    py: Python<'_>,
    points: usize,
    threads: usize,
    compute: impl Fn(usize) -> (u8, [f64; N]) + Sync,
) -> PyResult<(Vec<u8>, Vec<[f64; N]>)> {
    /// Points between two looks at signals: one takes some 10 µs, a slip demand a millisecond.
    const BLOCK: usize = 64;
    let mut status = filled(0, points)?;
    let mut numbers = filled([f64::NAN; N], points)?;
    // a point costs some hundred times one of a batch: threads pay from a few dozen on
    let threads = workers::count(threads, points.saturating_mul(256));
    let mut from = 0;
    for (status, numbers) in status
        .chunks_mut(BLOCK * threads)
        .zip(numbers.chunks_mut(BLOCK * threads))
    {
        let n = status.len();
        let jobs = status
            .chunks_mut(BLOCK)
            .zip(numbers.chunks_mut(BLOCK))
            .enumerate()
            .map(|(k, (status, numbers))| {
                let compute = &compute;
                move || {
                    for (j, (status, numbers)) in status.iter_mut().zip(numbers).enumerate() {
                        (*status, *numbers) = compute(from + k * BLOCK + j);
                    }
                }
            })
            .collect();
        workers::run(py, jobs);
        py.check_signals()?;
        from += n;
    }
    Ok((status, numbers))
}

/// `points` times `value`; a `MemoryError` where there is no room for them.
fn filled<T: Clone>(value: T, points: usize) -> PyResult<Vec<T>> {
    let mut column = Vec::new();
    column
        .try_reserve_exact(points)
        .map_err(|_| PyMemoryError::new_err(format!("no memory for {points} points")))?;
    column.resize(points, value);
    Ok(column)
}

fn column<'py, const N: usize>(py: Python<'py>, rows: &[[f64; N]], k: usize) -> Floats<'py> {
    let column: Vec<f64> = rows.iter().map(|row| row[k]).collect();
    column.into_pyarray(py)
}

const BAD: u8 = SolveStatus::BadInput.code();

#[pymethods]
impl WheelOnSoil {
    #[new]
    #[pyo3(signature = (wheel, soil, *, reference_accuracy=false, shear=None, bulldozing=None))]
    fn new(
        #[pyo3(from_py_with = argument::object)] wheel: Wheel,
        #[pyo3(from_py_with = argument::object)] soil: Soil,
        reference_accuracy: bool,
        shear: Option<&str>,
        bulldozing: Option<&str>,
    ) -> PyResult<Self> {
        let accuracy = if reference_accuracy {
            Accuracy::Reference
        } else {
            Accuracy::Standard
        };
        let shear_laws = ShearLaw::ALL;
        let ploughing = Bulldozing::ALL;
        let settings = Settings {
            accuracy,
            shear: choice("shear", shear, &shear_laws.map(|law| (law.key(), law)))?,
            bulldozing: choice(
                "bulldozing",
                bulldozing,
                &ploughing.map(|law| (law.key(), law)),
            )?,
        };
        let contact = raised(Contact::new(wheel.0, soil.soil, settings))?;
        Ok(Self {
            contact,
            wheel,
            soil,
        })
    }

    /// The wheel.
    #[getter]
    fn wheel(&self) -> Wheel {
        self.wheel.clone()
    }

    /// The soil.
    #[getter]
    fn soil(&self) -> Soil {
        self.soil.clone()
    }

    /// The operating point under a load.
    ///
    /// Parameters
    /// ----------
    /// load_n : float
    ///     Load, N.
    /// slip : float
    ///     Slip.
    /// slip_angle_deg : float
    ///     Slip angle, degrees, positive where the wheel drifts to its left.
    ///
    /// Returns
    /// -------
    /// OperatingPoint or None
    ///     `None` where no sinkage below the hub carries the load.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     A load, slip or angle outside its limits, or NaN.
    #[pyo3(signature = (*, load_n, slip, slip_angle_deg=0.0))]
    fn under_load(
        slf: &Bound<'_, Self>,
        #[pyo3(from_py_with = argument::number)] load_n: f64,
        #[pyo3(from_py_with = argument::number)] slip: f64,
        #[pyo3(from_py_with = argument::number)] slip_angle_deg: f64,
    ) -> PyResult<Option<OperatingPoint>> {
        let given = Given {
            load_n: Some(load_n),
            sinkage_m: f64::NAN,
            slip,
            slip_angle_deg,
        };
        OperatingPoint::solved(slf, given)
    }

    /// The operating point at a sinkage (m).
    ///
    /// Raises
    /// ------
    /// InputError
    ///     A sinkage that is negative or reaches the hub; a slip or angle outside its limits, or NaN.
    #[pyo3(signature = (*, sinkage_m, slip, slip_angle_deg=0.0))]
    fn at_sinkage(
        slf: &Bound<'_, Self>,
        #[pyo3(from_py_with = argument::number)] sinkage_m: f64,
        #[pyo3(from_py_with = argument::number)] slip: f64,
        #[pyo3(from_py_with = argument::number)] slip_angle_deg: f64,
    ) -> PyResult<Option<OperatingPoint>> {
        let given = Given {
            load_n: None,
            sinkage_m,
            slip,
            slip_angle_deg,
        };
        OperatingPoint::solved(slf, given)
    }

    /// The slip in [0, 1] of the greatest drawbar pull under a load (N), and that pull (N); `None` where no
    /// slip carries the load.
    #[pyo3(signature = (*, load_n))]
    fn slip_of_maximum_pull(
        &self,
        #[pyo3(from_py_with = argument::number)] load_n: f64,
    ) -> PyResult<Option<(f64, f64)>> {
        let best = raised(self.contact.slip_of_maximum_pull(load_n))?;
        Ok(best.map(|best| (best.slip.value(), best.value)))
    }

    /// The slip in [0, 1] of the greatest tractive efficiency under a load (N), and that efficiency; `None`
    /// where no slip pulls.
    #[pyo3(signature = (*, load_n))]
    fn slip_of_maximum_efficiency(
        &self,
        #[pyo3(from_py_with = argument::number)] load_n: f64,
    ) -> PyResult<Option<(f64, f64)>> {
        let best = raised(self.contact.slip_of_maximum_efficiency(load_n))?;
        Ok(best.map(|best| (best.slip.value(), best.value)))
    }

    /// The steepest slope that a wheel of this weight (N) holds, degrees; `None` where it cannot pull
    /// itself on the level.
    #[pyo3(signature = (*, weight_n))]
    fn gradeability_deg(
        &self,
        #[pyo3(from_py_with = argument::number)] weight_n: f64,
    ) -> PyResult<Option<f64>> {
        Ok(raised(self.contact.gradeability(weight_n))?.map(Angle::deg))
    }

    /// The skid of a free wheel (a negative slip) under a load (N) against the friction of its bearing
    /// (N m); `None` where the soil does not turn it.
    #[pyo3(signature = (*, load_n, bearing_torque_nm=0.0))]
    fn free_slip(
        &self,
        #[pyo3(from_py_with = argument::number)] load_n: f64,
        #[pyo3(from_py_with = argument::number)] bearing_torque_nm: f64,
    ) -> PyResult<Option<f64>> {
        let slip = raised(self.contact.free_slip(load_n, bearing_torque_nm))?;
        Ok(slip.map(Slip::value))
    }

    /// Columns (load, slip, slip angle in degrees) to operating points: status, sinkage, vertical force, drawbar pull, torque and
    /// side force. The public function is `grouser.wheel.operating_points`.
    fn _operating_points<'py>(
        &self,
        py: Python<'py>,
        columns: [Column<'py>; 3],
        points: usize,
        threads: usize,
    ) -> PyResult<(Codes<'py>, [Floats<'py>; 5])> {
        let [load, slip, angle] = inputs(&columns)?;
        check_lengths(&[load, slip, angle], points)?;
        let (status, numbers) = rows(py, points, threads, |i| {
            let solved = kinematics(at(slip, i), at(angle, i))
                .and_then(|motion| self.contact.under_load(at(load, i), &motion));
            match solved.map(|solution| solution.outcome) {
                Err(_) => (BAD, [f64::NAN; 5]),
                Ok(LoadOutcome::Solved(point)) => {
                    let f = point.forces;
                    let row = [
                        point.sinkage,
                        f.vertical_force,
                        f.drawbar_pull,
                        f.torque,
                        point.side_force,
                    ];
                    (SolveStatus::Solved.code(), row)
                }
                Ok(outcome) => (outcome.status().code(), [f64::NAN; 5]),
            }
        })?;
        Ok((
            status.into_pyarray(py),
            std::array::from_fn(|k| column(py, &numbers, k)),
        ))
    }

    /// Columns (weight, slope in degrees) to slip demands: status and slip. The public function is `grouser.wheel.slip_demand`.
    fn _slip_demand<'py>(
        &self,
        py: Python<'py>,
        columns: [Column<'py>; 2],
        points: usize,
        threads: usize,
    ) -> PyResult<(Codes<'py>, Floats<'py>)> {
        let [weight, slope] = inputs(&columns)?;
        check_lengths(&[weight, slope], points)?;
        let slope: Vec<f64> = (0..points).map(|i| at(slope, i).to_radians()).collect();
        let mut codes = filled(0, points)?;
        let mut slips = filled(f64::NAN, points)?;
        // with other settings than the batch's each slope is a block of its own, one by one
        let is_usual = *self.contact.settings() == Settings::default();
        let kernel = BatchKernel::new(*self.contact.soil());
        let threads = workers::count(threads, points.saturating_mul(64));
        let mut from = 0;
        for (codes, slips) in codes
            .chunks_mut(SLOPES_PER_BLOCK * threads)
            .zip(slips.chunks_mut(SLOPES_PER_BLOCK * threads))
        {
            let n = codes.len();
            let jobs = codes
                .chunks_mut(SLOPES_PER_BLOCK)
                .zip(slips.chunks_mut(SLOPES_PER_BLOCK))
                .enumerate()
                .map(|(k, (codes, slips))| {
                    let begin = from + k * SLOPES_PER_BLOCK;
                    let weight = part(weight, begin, begin + codes.len());
                    let slope = &slope[begin..begin + codes.len()];
                    let (kernel, contact) = (&kernel, &self.contact);
                    move || {
                        if is_usual {
                            let mut status = vec![SolveStatus::default(); codes.len()];
                            let wheel = contact.wheel();
                            kernel.slip_demand(wheel, weight, slope, slips, &mut status)?;
                            write_codes(codes, &status);
                        } else {
                            for (i, (code, slip)) in codes.iter_mut().zip(slips).enumerate() {
                                let slope = Angle::from_rad(slope[i]);
                                (*code, *slip) = match contact.slip_demand(at(weight, i), slope) {
                                    Err(_) => (BAD, f64::NAN),
                                    Ok(SlopeOutcome::Holds { slip }) => {
                                        (SolveStatus::Solved.code(), slip.value())
                                    }
                                    Ok(_) => (SolveStatus::NoSolution.code(), f64::NAN),
                                };
                            }
                        }
                        Ok(())
                    }
                })
                .collect();
            from += n;
            for result in workers::run(py, jobs) {
                raised::<_, terra::Error>(result)?;
            }
            py.check_signals()?;
        }
        Ok((codes.into_pyarray(py), slips.into_pyarray(py)))
    }

    /// Columns (load, slip) to derivatives: status, and for each point the values of sinkage, drawbar pull and torque,
    /// and their derivatives in slip, radius, width and load. The public function is
    /// `grouser.wheel.jacobian`.
    fn _jacobian<'py>(
        &self,
        py: Python<'py>,
        columns: [Column<'py>; 2],
        points: usize,
        threads: usize,
    ) -> PyResult<(Codes<'py>, Floats<'py>)> {
        let [load, slip] = inputs(&columns)?;
        check_lengths(&[load, slip], points)?;
        let (status, numbers) = rows(py, points, threads, |i| {
            match derivatives(&self.contact, at(slip, i), at(load, i)) {
                Err(_) => (BAD, [f64::NAN; 15]),
                Ok(None) => (SolveStatus::NoSolution.code(), [f64::NAN; 15]),
                Ok(Some(row)) => (SolveStatus::Solved.code(), row),
            }
        })?;
        let flat: Vec<f64> = numbers.into_iter().flatten().collect();
        Ok((status.into_pyarray(py), flat.into_pyarray(py)))
    }

    fn __repr__(&self) -> PyResult<String> {
        Python::attach(|py| {
            let wheel = Bound::new(py, self.wheel.clone())?.repr()?.to_string();
            let soil = Bound::new(py, self.soil.clone())?.repr()?.to_string();
            Ok(format!("WheelOnSoil({wheel}, {soil})"))
        })
    }

    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<((Wheel, Soil), Bound<'py, pyo3::types::PyDict>)> {
        let settings = self.contact.settings();
        let keys = pyo3::types::PyDict::new(py);
        keys.set_item(
            "reference_accuracy",
            settings.accuracy == Accuracy::Reference,
        )?;
        keys.set_item("shear", settings.shear.key())?;
        keys.set_item("bulldozing", settings.bulldozing.key())?;
        Ok(((self.wheel.clone(), self.soil.clone()), keys))
    }
}

fn choice<T: Copy + Default>(
    field: &str,
    word: Option<&str>,
    choices: &[(&str, T)],
) -> PyResult<T> {
    let Some(word) = word else {
        return Ok(T::default());
    };
    let found = choices.iter().find(|(key, _)| *key == word);
    found.map(|(_, law)| *law).ok_or_else(|| {
        let keys: Vec<&str> = choices.iter().map(|(key, _)| *key).collect();
        let message = format!(
            "{field} is `{word}`, but must be one of {}",
            keys.join(", ")
        );
        input_error(message, Details::field(field))
    })
}

fn inputs<'a, const N: usize>(
    columns: &'a [Column<'_>; N],
) -> PyResult<[terra::BatchInput<'a>; N]> {
    let mut inputs = [terra::BatchInput::Constant(f64::NAN); N];
    for (input, column) in inputs.iter_mut().zip(columns) {
        *input = column.input()?;
    }
    Ok(inputs)
}

fn check_lengths(columns: &[terra::BatchInput<'_>], expected: usize) -> PyResult<()> {
    for column in columns {
        if let terra::BatchInput::Column(values) = column
            && values.len() != expected
        {
            let found = values.len();
            return raised(Err(terra::Error::Lengths { expected, found }));
        }
    }
    Ok(())
}

/// Three values, and their derivatives in slip, radius, width and load, row by row.
fn derivatives(contact: &Contact, slip: f64, load: f64) -> terra::Result<Option<[f64; 15]>> {
    let motion = Kinematics::straight(Slip::new(slip)?);
    let mut inputs = DualInputs::<4>::new(contact, &motion);
    inputs.motion.slip = Dual::variable(slip, 0);
    // radii of a wheel with grousers move with the rim
    let size = &mut inputs.size;
    for radius in [
        &mut size.radius,
        &mut size.shear_radius,
        &mut size.rim_radius,
    ] {
        radius.gradient[1] = 1.0;
    }
    size.width.gradient[2] = 1.0;
    let solved = inputs.under_load(contact, &motion, Dual::variable(load, 3))?;
    Ok(solved.map(|s| {
        let mut row = [0.0; 15];
        let quantities = [s.sinkage, s.forces.drawbar_pull, s.forces.torque];
        for (k, quantity) in quantities.iter().enumerate() {
            row[k] = quantity.value;
            row[3 + 4 * k..7 + 4 * k].copy_from_slice(&quantity.gradient);
        }
        row
    }))
}

/// Slips of wheels from the speed of the hub and of the rim.
#[pyfunction]
pub(crate) fn slips_from_speeds<'py>(
    py: Python<'py>,
    forward: PyReadonlyArray1<'py, f64>,
    rim: PyReadonlyArray1<'py, f64>,
) -> PyResult<Floats<'py>> {
    let (forward, rim) = (forward.as_slice()?, rim.as_slice()?);
    let slips: Vec<f64> = py.detach(|| {
        let pairs = forward.iter().zip(rim);
        pairs
            .map(|(v, u)| Slip::from_speeds(*v, *u).map_or(f64::NAN, Slip::value))
            .collect()
    });
    Ok(slips.into_pyarray(py))
}
