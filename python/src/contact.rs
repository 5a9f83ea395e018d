//! One wheel on one soil: operating points, derivatives, slip demand, best slip.

use grouser::real::Dual;
use grouser::terra;
use grouser::terra::{
    Accuracy, Angle, BatchKernel, BestOf, BestSlipColumns, Bulldozing, DualInputs, Kinematics,
    LoadOutcome, Settings, ShearLaw, Slip, SlopeOutcome, SolveStatus, WheelOnSoil as Contact,
};
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::argument::{self, choice};
use crate::batch::{Column, part, write_codes};
use crate::error::{Details, input_error, raised};
use crate::operating_point::{Given, OperatingPoint};
use crate::rows::{BAD, Codes, Floats, at, blocks, column, rows};
use crate::soil::Soil;
use crate::wheel::Wheel;

/// Slopes or loads between two looks at signals: some milliseconds on lanes.
const SLOPE_BLOCK: usize = 512;

/// A wheel on a soil.
///
/// Parameters
/// ----------
/// wheel : Wheel
/// soil : Soil
/// reference_accuracy : bool
///     Integrals to rounding (1e-13) in place of 1e-9.
/// shear : str, optional
///     Law of the shear stress where the soil has none of its own: `coupled` by default, `slip-velocity`,
///     `slip-velocity-regular`, `independent`, `towed-restart` or `towed-wong-reece`.
/// bulldozing : str, optional
///     Law of the soil that a drifting wheel ploughs where the soil has none of its own: `scaled` by default, `full`,
///     `chord`, `disc` or `off`.
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

pub(crate) fn kinematics(slip: f64, slip_angle_deg: f64) -> terra::Result<Kinematics> {
    let slip = Slip::new(slip)?;
    if slip_angle_deg == 0.0 {
        return Ok(Kinematics::straight(slip));
    }
    Kinematics::with_slip_angle(slip, Angle::from_deg(slip_angle_deg))
}

#[pymethods]
impl WheelOnSoil {
    #[new]
    #[pyo3(signature = (wheel, soil, *, reference_accuracy=false, shear=None, bulldozing=None))]
    fn new(
        #[pyo3(from_py_with = argument::object)] wheel: Wheel,
        #[pyo3(from_py_with = argument::object)] soil: Soil,
        #[pyo3(from_py_with = argument::flag)] reference_accuracy: bool,
        #[pyo3(from_py_with = argument::optional_text)] shear: Option<String>,
        #[pyo3(from_py_with = argument::optional_text)] bulldozing: Option<String>,
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
            shear: choice(
                "shear",
                shear.as_deref(),
                &shear_laws.map(|law| (law.key(), law)),
            )?
            .unwrap_or_default(),
            bulldozing: choice(
                "bulldozing",
                bulldozing.as_deref(),
                &ploughing.map(|law| (law.key(), law)),
            )?
            .unwrap_or_default(),
            ..Settings::default()
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

    /// All numbers of `grouser wheel --json` at a load or a sinkage, by their keys; with `status` and `max_load_n` also where
    /// no sinkage carries the load.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     Neither or both of `load_n` and `sinkage_m`; a value outside its limits, or NaN.
    #[pyo3(signature = (*, load_n=None, sinkage_m=None, slip, slip_angle_deg=0.0))]
    fn result<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = argument::optional_number)] load_n: Option<f64>,
        #[pyo3(from_py_with = argument::optional_number)] sinkage_m: Option<f64>,
        #[pyo3(from_py_with = argument::number)] slip: f64,
        #[pyo3(from_py_with = argument::number)] slip_angle_deg: f64,
    ) -> PyResult<Bound<'py, PyDict>> {
        if load_n.is_some() == sinkage_m.is_some() {
            let message = "exactly one of load_n and sinkage_m is needed".to_owned();
            return Err(input_error(message, Details::field("load_n")));
        }
        let given = Given {
            load_n,
            sinkage_m: sinkage_m.unwrap_or(f64::NAN),
            slip,
            slip_angle_deg,
        };
        given.fields(py, self)
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
        let [load, slip, angle] = inputs(&columns, points)?;
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
        let [weight, slope] = inputs(&columns, points)?;
        let (status, slips) = if *self.contact.settings() == Settings::default() {
            let slope: Vec<f64> = (0..points).map(|i| at(slope, i).to_radians()).collect();
            let kernel = BatchKernel::new(*self.contact.soil());
            blocks(py, points, (threads, SLOPE_BLOCK), |from, codes, slips| {
                let own = from..from + codes.len();
                let weight = part(weight, own.start, own.end);
                let mut status = vec![SolveStatus::BadInput; codes.len()];
                // columns of one length, and a wheel that is on this soil already
                let _ = kernel.slip_demand(
                    self.contact.wheel(),
                    weight,
                    &slope[own],
                    slips,
                    &mut status,
                );
                write_codes(codes, &status);
            })?
        } else {
            rows(py, points, threads, |i| {
                match self
                    .contact
                    .slip_demand(at(weight, i), Angle::from_deg(at(slope, i)))
                {
                    Err(_) => (BAD, f64::NAN),
                    Ok(SlopeOutcome::Holds { slip }) => (SolveStatus::Solved.code(), slip.value()),
                    Ok(_) => (SolveStatus::NoSolution.code(), f64::NAN),
                }
            })?
        };
        Ok((status.into_pyarray(py), slips.into_pyarray(py)))
    }

    /// A column of loads to best slips: status, slip and value. The public functions are
    /// `grouser.wheel.slip_of_maximum_pull` and `slip_of_maximum_efficiency`.
    fn _best_slip<'py>(
        &self,
        py: Python<'py>,
        of_pull: bool,
        columns: [Column<'py>; 1],
        points: usize,
        threads: usize,
    ) -> PyResult<(Codes<'py>, [Floats<'py>; 2])> {
        let [load] = inputs(&columns, points)?;
        let (status, best) = if *self.contact.settings() == Settings::default() {
            let kernel = BatchKernel::new(*self.contact.soil());
            let of = if of_pull {
                BestOf::Pull
            } else {
                BestOf::Efficiency
            };
            blocks(py, points, (threads, SLOPE_BLOCK), |from, codes, best| {
                let n = codes.len();
                let (mut slip, mut value) = (vec![f64::NAN; n], vec![f64::NAN; n]);
                let mut status = vec![SolveStatus::BadInput; n];
                let mut columns = BestSlipColumns {
                    slip: &mut slip,
                    value: &mut value,
                    status: &mut status,
                };
                // columns of one length, and a wheel that is on this soil already
                let _ = kernel.best_slip(
                    self.contact.wheel(),
                    of,
                    part(load, from, from + n),
                    &mut columns,
                );
                write_codes(codes, &status);
                for (best, pair) in best.iter_mut().zip(slip.into_iter().zip(value)) {
                    *best = pair.into();
                }
            })?
        } else {
            rows(py, points, threads, |i| {
                let best = if of_pull {
                    self.contact.slip_of_maximum_pull(at(load, i))
                } else {
                    self.contact.slip_of_maximum_efficiency(at(load, i))
                };
                match best {
                    Err(_) => (BAD, [f64::NAN; 2]),
                    Ok(Some(best)) => (SolveStatus::Solved.code(), [best.slip.value(), best.value]),
                    Ok(None) => (SolveStatus::NoSolution.code(), [f64::NAN; 2]),
                }
            })?
        };
        Ok((
            status.into_pyarray(py),
            std::array::from_fn(|k| column(py, &best, k)),
        ))
    }

    /// Columns (load, friction of the bearing) to skids: status and slip. The public function is `grouser.wheel.free_slip`.
    fn _free_slip<'py>(
        &self,
        py: Python<'py>,
        columns: [Column<'py>; 2],
        points: usize,
        threads: usize,
    ) -> PyResult<(Codes<'py>, Floats<'py>)> {
        let [load, bearing] = inputs(&columns, points)?;
        let (status, slips) = rows(py, points, threads, |i| {
            match self.contact.free_slip(at(load, i), at(bearing, i)) {
                Err(_) => (BAD, f64::NAN),
                Ok(Some(slip)) => (SolveStatus::Solved.code(), slip.value()),
                Ok(None) => (SolveStatus::NoSolution.code(), f64::NAN),
            }
        })?;
        Ok((status.into_pyarray(py), slips.into_pyarray(py)))
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
        let [load, slip] = inputs(&columns, points)?;
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

/// Columns of `points` values each, or constants.
fn inputs<'a, const N: usize>(
    columns: &'a [Column<'_>; N],
    points: usize,
) -> PyResult<[terra::BatchInput<'a>; N]> {
    let mut inputs = [terra::BatchInput::Constant(f64::NAN); N];
    for (input, column) in inputs.iter_mut().zip(columns) {
        *input = column.input()?;
        if let terra::BatchInput::Column(values) = input
            && values.len() != points
        {
            let (expected, found) = (points, values.len());
            return raised(Err(terra::Error::Lengths { expected, found }));
        }
    }
    Ok(inputs)
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
