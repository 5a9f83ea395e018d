//! Simulated drives, by our controller or by one written in Python.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use grouser::rover::drive::{self, DriveResult, Frame, Pilot};
use grouser::slip::Robot;
use grouser::slip::control::WheelCommand;
use grouser::slip::onboard::SoilTables;
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::argument;
use crate::error::{Details, input_error, raised};
use crate::slip::{control_dict, decision_text, observation_dict};

/// A scenario: robot, ground, way, sensors and faults.
#[pyclass(frozen, from_py_object, module = "grouser._core")]
#[derive(Clone, Debug)]
pub(crate) struct Scenario {
    scenario: drive::Scenario,
    path: PathBuf,
    optimum: f64,
    /// What robots know of the soil, once a drive needed it: the same for every seed and pilot.
    tables: Arc<OnceLock<SoilTables>>,
}

impl Scenario {
    /// A drive of it.
    pub(crate) fn simulation(
        &self,
        pilot: Pilot,
        seed: u64,
    ) -> grouser::rover::Result<drive::Simulation> {
        let tables = match self.tables.get() {
            Some(tables) => tables,
            None => {
                let made = drive::Simulation::soil_tables(&self.scenario)?;
                self.tables.get_or_init(|| made)
            }
        };
        drive::Simulation::with_tables(&self.scenario, pilot, self.optimum, seed, tables)
    }

    pub(crate) fn wheel_count(&self) -> usize {
        self.scenario.robot.robot.wheels().len()
    }
}

#[pymethods]
impl Scenario {
    /// Reads a scenario file (TOML) and the robot file that it names.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     A file cannot be read.
    /// InputError
    ///     What a file lacks or has wrong, with its line; and a scenario with `[plan]`, whose drives plan their own way:
    ///     `grouser drive` alone does that.
    #[staticmethod]
    fn read(
        py: Python<'_>,
        #[pyo3(from_py_with = argument::path)] path: PathBuf,
    ) -> PyResult<Self> {
        py.detach(|| {
            let scenario = raised(drive::read_scenario(&path))?;
            if scenario.plan.is_some() {
                let message = format!(
                    "{}: [plan]: a drive that plans its own way is `grouser drive`'s alone; give legs instead",
                    path.display()
                );
                return Err(input_error(message, Details::field("plan")));
            }
            let optimum = raised(scenario.slip_setpoint())?;
            Ok(Self {
                scenario,
                path: std::path::absolute(&path)?,
                optimum,
                tables: Arc::default(),
            })
        })
    }

    /// The name, from the file.
    #[getter]
    fn name(&self) -> &str {
        &self.scenario.name
    }

    /// What it shows.
    #[getter]
    fn title(&self) -> &str {
        &self.scenario.title
    }

    /// The seed that the file gives.
    #[getter]
    fn seed(&self) -> u64 {
        self.scenario.seed
    }

    /// The longest duration, s.
    #[getter]
    fn duration_s(&self) -> f64 {
        self.scenario.duration
    }

    /// The slip setpoint: the file's, else the slip of greatest tractive efficiency.
    #[getter]
    fn optimum_slip(&self) -> f64 {
        self.optimum
    }

    /// The settings of the controller by their keys in `[control]`, as `grouser.slip.OnBoard` takes them.
    #[getter]
    fn control<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mut control = self.scenario.control;
        control.optimum = self.optimum;
        control_dict(py, &control)
    }

    /// The names of the wheels, in the order of their indices.
    #[getter]
    fn wheels(&self) -> Vec<String> {
        let wheels = self.scenario.robot.robot.wheels().iter();
        wheels.map(|wheel| wheel.name.clone()).collect()
    }

    fn __repr__(&self) -> String {
        format!("Scenario({:?})", self.path.display().to_string())
    }

    /// A scenario is pickled as its path: robot and height maps are files beside it.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (PathBuf,))> {
        Ok((slf.get_type().getattr("read")?, (slf.get().path.clone(),)))
    }
}

/// A simulated drive under way, period by period.
#[pyclass(module = "grouser._core")]
pub(crate) struct Simulation {
    drive: drive::Simulation,
    wheels: usize,
    goes_on: bool,
    track: Vec<[f64; TRACK.len()]>,
    slips: Vec<f64>,
    estimates: Vec<f64>,
}

/// The columns of a track.
const TRACK: [&str; 11] = [
    "time_s",
    "x_m",
    "y_m",
    "z_m",
    "roll_deg",
    "pitch_deg",
    "yaw_deg",
    "speed_mps",
    "estimated_speed_mps",
    "energy_j",
    "distance_m",
];

fn track_row(frame: &Frame<'_>) -> [f64; TRACK.len()] {
    let [x, y, z] = frame.place;
    let [roll, pitch, yaw] = frame.angles.map(f64::to_degrees);
    let estimated = frame.estimated_speed.unwrap_or(f64::NAN);
    [
        frame.time,
        x,
        y,
        z,
        roll,
        pitch,
        yaw,
        frame.speed,
        estimated,
        frame.energy,
        frame.distance,
    ]
}

#[pymethods]
impl Simulation {
    /// `pilot` is `open-loop`, `controller` or `fixed-chassis`.
    #[new]
    fn new(
        py: Python<'_>,
        #[pyo3(from_py_with = argument::object)] scenario: Scenario,
        #[pyo3(from_py_with = argument::text)] pilot: String,
        seed: u64,
    ) -> PyResult<Self> {
        let Some(pilot) = Pilot::ALL.into_iter().find(|own| own.name() == pilot) else {
            let names = Pilot::ALL.map(Pilot::name).join(", ");
            let message = format!("pilot is `{pilot}`, but must be one of {names}");
            return Err(input_error(message, Details::field("pilot")));
        };
        let wheels = scenario.wheel_count();
        let drive = py.detach(|| scenario.simulation(pilot, seed));
        Ok(Self {
            drive: raised(drive)?,
            wheels,
            goes_on: true,
            track: Vec::new(),
            slips: Vec::new(),
            estimates: Vec::new(),
        })
    }

    /// Runs up to `periods` periods of 0.01 s; returns whether the drive goes on.
    fn run_periods(&mut self, py: Python<'_>, periods: usize) -> PyResult<bool> {
        for k in 0..periods {
            if !self.goes_on {
                break;
            }
            py.detach(|| self.period());
            if k % 16 == 15 {
                py.check_signals()?;
            }
        }
        Ok(self.goes_on)
    }

    /// Sets rim speed (m/s), traction and steering angle (rad) of each wheel for the next period.
    fn set_commands(&mut self, commands: Vec<(f64, f64, f64)>) -> PyResult<()> {
        let commands: Vec<WheelCommand> = commands
            .into_iter()
            .map(|(rim_speed, traction, steering_angle)| WheelCommand {
                rim_speed,
                traction,
                steering_angle,
            })
            .collect();
        raised(self.drive.set_commands(&commands))
    }

    /// What the robot's computer knows, as `grouser.drive.Observation` takes it.
    fn _observation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let computer = self.drive.on_board();
        let request = self.drive.request();
        let wheels = computer.observations().iter();
        let wheels: Vec<Bound<'py, PyDict>> = wheels
            .map(|wheel| observation_dict(py, wheel))
            .collect::<PyResult<_>>()?;
        let attitude = computer.attitude();
        let dict = PyDict::new(py);
        dict.set_item("time_s", self.drive.vehicle().time())?;
        dict.set_item("wheels", wheels)?;
        dict.set_item("speed_mps", computer.speed())?;
        dict.set_item("heading_rad", attitude.heading())?;
        dict.set_item("pitch_rad", attitude.pitch())?;
        dict.set_item("roll_rad", attitude.roll())?;
        dict.set_item("requested_speed_mps", request.speed)?;
        dict.set_item("requested_heading_rad", request.heading)?;
        Ok(dict)
    }

    /// The track so far as columns: of the robot, and true and estimated slip of each wheel row by row.
    fn _track<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (k, name) in TRACK.iter().enumerate() {
            let column: Vec<f64> = self.track.iter().map(|row| row[k]).collect();
            dict.set_item(name, column.into_pyarray(py))?;
        }
        dict.set_item("slip", self.slips.clone().into_pyarray(py))?;
        dict.set_item("estimated_slip", self.estimates.clone().into_pyarray(py))?;
        dict.set_item("wheels", self.wheels)?;
        Ok(dict)
    }

    fn _result<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let robot = &self.drive.vehicle().model().robot;
        result_dict(py, &self.drive.result(), robot)
    }
}

impl Simulation {
    fn period(&mut self) {
        let Self {
            drive,
            track,
            slips,
            estimates,
            ..
        } = self;
        let mut sink = |frame: &Frame<'_>| {
            track.push(track_row(frame));
            for wheel in frame.wheels {
                slips.push(wheel.slip.unwrap_or(f64::NAN));
                estimates.push(wheel.observation.slip.unwrap_or(f64::NAN));
            }
            true
        };
        self.goes_on = drive.period(&mut sink);
    }
}

fn result_dict<'py>(
    py: Python<'py>,
    result: &DriveResult,
    robot: &Robot,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("outcome", result.outcome.name())?;
    dict.set_item("duration_s", result.duration)?;
    dict.set_item("distance_m", result.distance)?;
    dict.set_item("way_m", result.way)?;
    dict.set_item("energy_j", result.energy)?;
    dict.set_item("energy_j_per_m", result.energy_per_metre())?;
    dict.set_item("worst_slip", result.worst_slip)?;
    dict.set_item("deep_share", result.deep_share)?;
    let undeclared = result.undeclared.map(|found| found.to_string());
    dict.set_item("undeclared_no_data", undeclared)?;
    dict.set_item("slip_rmse", result.slip.rmse)?;
    dict.set_item("slip_bias", result.slip.bias)?;
    dict.set_item("refused", result.refused)?;
    dict.set_item("end_m", result.end)?;
    let decisions: Vec<(f64, String)> = result
        .decisions
        .iter()
        .map(|named| (named.time, decision_text(&named.decision, robot)))
        .collect();
    dict.set_item("decisions", decisions)?;
    dict.set_item("decision_count", result.decision_count)?;
    Ok(dict)
}
