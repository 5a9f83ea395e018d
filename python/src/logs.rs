//! Recorded logs, and live streams, through the slip estimator.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use grouser::files::columns;
use grouser::files::robot::{RobotFile, WheelSensor};
use grouser::log::Log as Recorded;
use grouser::replay::{Engine as Replay, Inputs, Options, Row, Sink, Spread, Summary, run_into};
use grouser::slip::Reference;
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::argument::{self, choice};
use crate::error::{Details, input_error, raised};
use crate::robot::Robot;
use crate::sample::{Sample, parts};
use crate::workers;

/// Opens the files of a log with the robot's topics; the columns of tables are those of `columns`, else of
/// the robot file.
fn open(paths: &[PathBuf], robot: &RobotFile, columns: Option<PathBuf>) -> PyResult<Recorded> {
    let map = match columns {
        Some(path) => Some(raised(columns::read(&path))?),
        None if robot.columns.is_none() && raised(Recorded::needs_columns(paths))? => {
            return Err(input_error(
                "columns is None, but the log is a table: `columns` is the path of its column map, which a robot file or \
                 `columns.toml` beside it may hold, too"
                    .to_owned(),
                Details::field("columns"),
            ));
        }
        None => robot.columns.clone(),
    };
    raised(Recorded::find_any(paths, map, &robot.topics))
}

/// The options of a run, as keywords.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Choices {
    reference: Option<String>,
    wheel_sensor: Option<String>,
    from_s: Option<f64>,
    to_s: Option<f64>,
    offline: bool,
}

fn references() -> [(&'static str, Reference); 5] {
    Reference::ALL.map(|reference| (reference.name(), reference))
}

impl Choices {
    fn options(&self) -> PyResult<Options> {
        Ok(Options {
            offline: self.offline,
            reference: choice("reference", self.reference.as_deref(), &references())?,
            wheel_sensor: choice(
                "wheel_sensor",
                self.wheel_sensor.as_deref(),
                &WheelSensor::NAMES,
            )?,
            from_s: self.from_s,
            to_s: self.to_s,
            learn_soil: None,
        })
    }
}

/// Rows as columns.
#[derive(Default)]
struct Columns {
    time_s: Vec<f64>,
    wheel: Vec<u32>,
    slip: Vec<f64>,
    slip_sigma: Vec<f64>,
    side_slip_angle: Vec<f64>,
    motion: Vec<&'static str>,
    health: Vec<String>,
    /// Set by an interrupt.
    is_stopped: Arc<AtomicBool>,
}

impl Sink for Columns {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        if self.is_stopped.load(Ordering::Relaxed) {
            return Err(io::ErrorKind::Interrupted.into());
        }
        self.time_s.push(row.time_s);
        self.wheel
            .push(u32::try_from(row.wheel).unwrap_or(u32::MAX));
        self.slip.push(row.slip.unwrap_or(f64::NAN));
        self.slip_sigma.push(row.slip_sigma.unwrap_or(f64::NAN));
        let angle = row.side_slip_angle.map_or(f64::NAN, f64::to_degrees);
        self.side_slip_angle.push(angle);
        self.motion.push(row.motion.map_or("Unknown", |m| m.name()));
        self.health.push(row.health.to_string());
        Ok(())
    }
}

impl Columns {
    /// The rows so far as a dictionary of arrays; the columns are empty afterwards.
    fn take<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let stop = self.is_stopped.clone();
        let all = std::mem::take(self);
        self.is_stopped = stop;
        let dict = PyDict::new(py);
        dict.set_item("time_s", all.time_s.into_pyarray(py))?;
        dict.set_item("wheel", all.wheel.into_pyarray(py))?;
        dict.set_item("slip", all.slip.into_pyarray(py))?;
        dict.set_item("slip_sigma", all.slip_sigma.into_pyarray(py))?;
        dict.set_item("side_slip_angle_deg", all.side_slip_angle.into_pyarray(py))?;
        dict.set_item("motion", all.motion)?;
        dict.set_item("health", all.health)?;
        Ok(dict)
    }
}

fn spread_dict<'py>(py: Python<'py>, spread: &Spread) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("count", spread.count)?;
    dict.set_item("median", spread.median)?;
    dict.set_item("p5", spread.p5)?;
    dict.set_item("p95", spread.p95)?;
    Ok(dict)
}

fn summary_dict<'py>(py: Python<'py>, summary: &Summary) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("status", summary.status.name())?;
    dict.set_item("reference", summary.reference.name())?;
    dict.set_item("wheel_sensor", summary.wheel_sensor)?;
    dict.set_item("duration_s", summary.duration_s)?;
    let wheels = summary
        .wheels
        .iter()
        .map(|wheel| {
            let own = PyDict::new(py);
            own.set_item("name", &wheel.name)?;
            own.set_item("is_reference", wheel.is_reference)?;
            own.set_item("slip", spread_dict(py, &wheel.slip)?)?;
            own.set_item("motions", wheel.states.clone())?;
            own.set_item("healths", wheel.healths.clone())?;
            Ok(own)
        })
        .collect::<PyResult<Vec<_>>>()?;
    dict.set_item("wheels", wheels)?;
    dict.set_item("along_slip", spread_dict(py, &summary.along.slip)?)?;
    dict.set_item("overall_slip", summary.along.overall)?;
    dict.set_item("overall_slip_90", summary.along.overall_90)?;
    dict.set_item("travel_wheels_m", summary.along.travel_wheels)?;
    dict.set_item("travel_reference_m", summary.along.travel_reference)?;
    dict.set_item("travel_reference_m_90", summary.along.travel_reference_90)?;
    dict.set_item("clock_offset_s", summary.clock_offset_s)?;
    let delay = summary.reference_delay;
    dict.set_item("reference_delay_s", delay.map(|delay| delay.delay_s))?;
    dict.set_item("rejected", summary.rejected.total())?;
    let odometry = summary.odometry.as_ref();
    dict.set_item("pose", odometry.map(|odometry| odometry.pose))?;
    dict.set_item(
        "pose_covariance",
        odometry.map(|odometry| odometry.pose_covariance),
    )?;
    dict.set_item("doubts", summary.doubts_in_words())?;
    dict.set_item("reservations", summary.reservations())?;
    Ok(dict)
}

/// A log through the estimator: columns of rows, and the summary.
#[pyfunction]
pub(crate) fn estimate<'py>(
    py: Python<'py>,
    paths: Vec<PathBuf>,
    #[pyo3(from_py_with = argument::object)] robot: Robot,
    columns: Option<PathBuf>,
    choices: Choices,
) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
    let options = choices.options()?;
    let rows = Columns::default();
    let stop = rows.is_stopped.clone();
    let job = move || {
        let mut rows = rows;
        let log = open(&paths, &robot.0, columns)?;
        let summary = raised(run_into(&log, &robot.0, &options, &mut rows))?;
        Ok::<_, PyErr>((rows, summary))
    };
    let (mut rows, summary) =
        workers::interruptible(py, 1, job, || stop.store(true, Ordering::Relaxed))??;
    Ok((rows.take(py)?, summary_dict(py, &summary)?))
}

/// The samples of a log, in order of time, as columns: time (ns), index of the kind, wheel (-1 for the
/// robot), six numbers; and the kinds and the wheels' names.
#[pyfunction]
pub(crate) fn read_samples<'py>(
    py: Python<'py>,
    paths: Vec<PathBuf>,
    #[pyo3(from_py_with = argument::object)] robot: Robot,
    columns: Option<PathBuf>,
) -> PyResult<Bound<'py, PyDict>> {
    let job = move || {
        let log = open(&paths, &robot.0, columns)?;
        let (mut times, mut kinds, mut wheels, mut numbers) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut names: Vec<&'static str> = Vec::new();
        for sample in raised(log.samples(&[]))? {
            let sample = raised(sample)?;
            let (kind, wheel, values) = parts(&sample.measurement);
            let index = names.iter().position(|name| *name == kind);
            let index = index.unwrap_or_else(|| {
                names.push(kind);
                names.len() - 1
            });
            times.push(sample.time_ns);
            kinds.push(u8::try_from(index).unwrap_or(u8::MAX));
            wheels.push(wheel);
            numbers.extend_from_slice(&values);
        }
        let notes: Vec<String> = log.notes().to_vec();
        let own: Vec<String> = log.wheels().to_vec();
        Ok::<_, PyErr>(((times, kinds, wheels, numbers), names, own, notes))
    };
    let (columns, kinds, wheels, notes) = workers::interruptible(py, 1, job, || ())??;
    let dict = PyDict::new(py);
    dict.set_item("time_ns", columns.0.into_pyarray(py))?;
    dict.set_item("kind", columns.1.into_pyarray(py))?;
    dict.set_item("wheel", columns.2.into_pyarray(py))?;
    dict.set_item("numbers", columns.3.into_pyarray(py))?;
    dict.set_item("kinds", kinds)?;
    dict.set_item("wheels", wheels)?;
    dict.set_item("notes", notes)?;
    Ok(dict)
}

/// Samples of a live source through the estimator, in the order of time.
#[pyclass(module = "grouser._core")]
pub(crate) struct Engine {
    replay: Option<Replay>,
    rows: Columns,
}

fn ended() -> PyErr {
    input_error(
        "the engine has finished, but a sample was pushed".to_owned(),
        Details::field("sample"),
    )
}

#[pymethods]
impl Engine {
    #[new]
    fn new(
        #[pyo3(from_py_with = argument::object)] robot: Robot,
        #[pyo3(from_py_with = argument::text)] reference: String,
        #[pyo3(from_py_with = argument::text)] wheel_sensor: String,
        choices: Choices,
    ) -> PyResult<Self> {
        let reference = choice("reference", Some(&reference), &references())?;
        let wheel_sensor = choice("wheel_sensor", Some(&wheel_sensor), &WheelSensor::NAMES)?;
        let inputs = Inputs {
            wheel_sensor: wheel_sensor.unwrap_or(WheelSensor::Count),
            reference: reference.unwrap_or(Reference::Grip),
            speed_place: [0.0; 2],
            position_sigma: None,
            is_acceleration_forward_only: false,
        };
        let replay = raised(Replay::new(&robot.0, inputs, &choices.options()?))?;
        Ok(Self {
            replay: Some(replay),
            rows: Columns::default(),
        })
    }

    /// Takes a sample, not earlier than those before.
    fn push(&mut self, #[pyo3(from_py_with = argument::object)] sample: Sample) -> PyResult<()> {
        let replay = self.replay.as_mut().ok_or_else(ended)?;
        raised(replay.push(sample.0, &mut self.rows))
    }

    /// The rows since the last call, as columns.
    fn _rows<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.rows.take(py)
    }

    fn _finish<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let replay = self.replay.take().ok_or_else(ended)?;
        let summary = raised(replay.finish(&mut self.rows))?;
        summary_dict(py, &summary)
    }
}
