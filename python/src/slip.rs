//! The slip filter and the on-board computer, sample by sample.

use grouser::real::OutOfRange;
use grouser::slip::control::{ControlSettings, Decision, Request, WheelObservation};
use grouser::slip::filter::{FilterOutput, SlipFilter as Filter};
use grouser::slip::onboard::{OnBoard as Computer, OnBoardSettings};
use grouser::slip::settings::{Field, FileUnit};
use grouser::slip::{Motion, Slip, WheelEstimate};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::argument;
use crate::error::{Details, input_error, raised};
use crate::robot::Robot;
use crate::sample::Sample;

fn wheel_dict<'py>(py: Python<'py>, wheel: &WheelEstimate) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("slip", wheel.slip.map(Slip::value))?;
    dict.set_item("slip_sigma", wheel.sigma)?;
    dict.set_item("motion", wheel.motion.map(Motion::name))?;
    dict.set_item("health", wheel.health.to_string())?;
    dict.set_item("forward_speed_mps", wheel.forward_speed.map(|s| s.value))?;
    dict.set_item("rim_speed_mps", wheel.rim_speed.map(|s| s.value))?;
    Ok(dict)
}

/// The filter's output as `grouser.slip.Estimate` takes it.
fn output_dict<'py>(py: Python<'py>, output: &FilterOutput<'_>) -> PyResult<Bound<'py, PyDict>> {
    let wheels: Vec<Bound<'py, PyDict>> = output
        .wheels
        .iter()
        .map(|wheel| wheel_dict(py, wheel))
        .collect::<PyResult<_>>()?;
    let body = &output.body;
    let place = body.odometry;
    let dict = PyDict::new(py);
    dict.set_item("time_ns", output.time_ns)?;
    dict.set_item("wheels", wheels)?;
    for (key, measured) in [
        ("forward_speed_mps", body.forward),
        ("left_speed_mps", body.left),
        ("yaw_rate_rad_per_s", body.yaw_rate),
        ("common_slip", body.common_slip),
    ] {
        dict.set_item(key, (measured.value, measured.variance.max(0.0).sqrt()))?;
    }
    dict.set_item("pose", (place.x, place.y, place.yaw))?;
    dict.set_item("pose_covariance", place.covariance)?;
    dict.set_item("distance_m", body.distance)?;
    dict.set_item("distance_of_wheels_m", body.distance_of_wheels)?;
    dict.set_item("reference_age_s", output.reference_age)?;
    dict.set_item("rejected", output.rejected.total())?;
    dict.set_item("dropped", output.dropped)?;
    dict.set_item("clock_steps", output.clock_steps)?;
    Ok(dict)
}

/// Slip of every wheel from all sensors together, one sample at a time.
#[pyclass(module = "grouser._core")]
#[derive(Clone, Debug)]
pub(crate) struct SlipFilter {
    filter: Filter,
    robot: Robot,
}

#[pymethods]
impl SlipFilter {
    #[new]
    fn new(#[pyo3(from_py_with = argument::object)] robot: Robot) -> PyResult<Self> {
        let filter = raised(Filter::new(&robot.0.robot, robot.0.filter))?;
        Ok(Self { filter, robot })
    }

    /// Uses a sample; returns why it was refused, or `None`. A refused sample changes nothing.
    fn update(
        &mut self,
        #[pyo3(from_py_with = argument::object)] sample: Sample,
    ) -> Option<String> {
        let refused = self.filter.update(sample.0).err();
        refused.map(|fault| fault.to_string())
    }

    /// A wheel is steered by this angle (rad, to the left) from now on.
    fn set_steering_angle(
        &mut self,
        #[pyo3(from_py_with = argument::count)] wheel: usize,
        #[pyo3(from_py_with = argument::number)] angle_rad: f64,
    ) -> PyResult<()> {
        raised(self.filter.set_steering_angle(wheel, angle_rad))
    }

    fn _latest<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        output_dict(py, &self.filter.latest())
    }

    fn _estimate_at<'py>(
        &mut self,
        py: Python<'py>,
        #[pyo3(from_py_with = argument::time_ns)] now_ns: i64,
    ) -> PyResult<Bound<'py, PyDict>> {
        output_dict(py, &self.filter.estimate_at(now_ns))
    }

    /// The robot.
    #[getter]
    fn robot(&self) -> Robot {
        self.robot.clone()
    }

    fn __copy__(&self) -> Self {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: Bound<'_, PyAny>) -> Self {
        self.clone()
    }
}

/// What is known of each wheel as `grouser.slip.WheelObservation` takes it.
pub(crate) fn observation_dict<'py>(
    py: Python<'py>,
    wheel: &WheelObservation,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("slip", wheel.slip)?;
    dict.set_item("slip_sigma", wheel.sigma)?;
    dict.set_item("health", wheel.health.to_string())?;
    dict.set_item("motion", wheel.motion.map(Motion::name))?;
    dict.set_item("forward_speed_mps", wheel.forward_speed)?;
    dict.set_item("rim_speed_mps", wheel.rim_speed)?;
    dict.set_item("torque_share", wheel.torque_share)?;
    dict.set_item("firmness", wheel.firmness)?;
    dict.set_item("load_n", wheel.load)?;
    Ok(dict)
}

/// A decision and the wheel that it is about.
pub(crate) fn decision_text(decision: &Decision, robot: &grouser::slip::Robot) -> String {
    let wheel = decision.wheel.and_then(|index| robot.wheels().get(index));
    wheel.map_or_else(
        || decision.to_string(),
        |wheel| format!("{decision}, {}", wheel.name),
    )
}

/// Speeds (m/s) and headings (rad) beyond these are none of a robot: the controller does not drive by them.
const REQUEST_LIMITS: (f64, f64) = (-1e6, 1e6);

/// The settings that `[control]` of a scenario has, by its keys.
fn control_fields() -> impl Iterator<Item = (&'static str, &'static Field<ControlSettings>)> {
    ControlSettings::FIELDS.iter().filter_map(|field| {
        // a scenario without an optimum has one of its soil
        let is_optimum = field.name == "optimum";
        let key = field.key.or_else(|| is_optimum.then_some(field.name))?;
        Some((key, field))
    })
}

fn set_control(
    settings: &mut ControlSettings,
    key: &str,
    value: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let Some((known, field)) = control_fields().find(|(known, _)| *known == key) else {
        let keys: Vec<&str> = control_fields().map(|(key, _)| key).collect();
        let message = format!("`{key}` is no setting; there are {}", keys.join(", "));
        return Err(input_error(message, Details::field(key)));
    };
    let value = argument::named(key, value, argument::number)?;
    let unit = match (field.file_unit, field.unit) {
        (FileUnit::Degrees, "rad") => "deg",
        (FileUnit::Degrees, _) => "deg/s",
        (_, unit) => unit,
    };
    raised(OutOfRange::check(
        known,
        value,
        field.limits_in_file(),
        unit,
    ))?;
    field.set_from_file(settings, value);
    Ok(())
}

/// The settings by the keys of `[control]`.
pub(crate) fn control_dict<'py>(
    py: Python<'py>,
    settings: &ControlSettings,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (key, field) in control_fields() {
        let value = field.get(settings);
        let value = match field.file_unit {
            FileUnit::Degrees => value.to_degrees(),
            _ => value,
        };
        dict.set_item(key, value)?;
    }
    Ok(dict)
}

/// The object that a robot's computer runs: filter, detector, attitude and slip controller.
#[pyclass(module = "grouser._core")]
#[derive(Clone, Debug)]
pub(crate) struct OnBoard {
    computer: Computer,
    robot: Robot,
}

#[pymethods]
impl OnBoard {
    #[new]
    #[pyo3(signature = (robot, *, heading_rad=0.0, **control))]
    fn new(
        #[pyo3(from_py_with = argument::object)] robot: Robot,
        #[pyo3(from_py_with = argument::number)] heading_rad: f64,
        control: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut settings = OnBoardSettings::new(&robot.0.robot);
        settings.filter = robot.0.filter;
        settings.heading = heading_rad;
        for (key, value) in control.into_iter().flatten() {
            set_control(&mut settings.control, &argument::text(&key)?, &value)?;
        }
        let computer = raised(Computer::new(&robot.0.robot, settings))?;
        Ok(Self { computer, robot })
    }

    /// Takes a sample that is stamped by the computer's own clock, or one that arrives at `now_ns`.
    #[pyo3(signature = (sample, *, now_ns=None))]
    fn update(
        &mut self,
        #[pyo3(from_py_with = argument::object)] sample: Sample,
        #[pyo3(from_py_with = argument::optional_time_ns)] now_ns: Option<i64>,
    ) {
        self.computer
            .update_at(now_ns.unwrap_or(sample.0.time_ns), sample.0);
    }

    /// A wheel is steered by this angle (rad, to the left) from now on.
    fn set_steering_angle(
        &mut self,
        #[pyo3(from_py_with = argument::count)] wheel: usize,
        #[pyo3(from_py_with = argument::number)] angle_rad: f64,
    ) -> PyResult<()> {
        raised(self.computer.set_steering_angle(wheel, angle_rad))
    }

    /// Rim speed (m/s), traction and steering angle (rad) of each wheel.
    fn _tick(
        &mut self,
        #[pyo3(from_py_with = argument::time_ns)] now_ns: i64,
        #[pyo3(from_py_with = argument::number)] speed_mps: f64,
        #[pyo3(from_py_with = argument::number)] heading_rad: f64,
    ) -> PyResult<Vec<(f64, f64, f64)>> {
        for (field, value, unit) in [
            ("speed_mps", speed_mps, "m/s"),
            ("heading_rad", heading_rad, "rad"),
        ] {
            raised(OutOfRange::check(field, value, REQUEST_LIMITS, unit))?;
        }
        let request = Request {
            speed: speed_mps,
            heading: heading_rad,
            yaw_rate: None,
        };
        let commands = self.computer.tick(now_ns, request).iter();
        Ok(commands
            .map(|command| (command.rim_speed, command.traction, command.steering_angle))
            .collect())
    }

    fn _observations<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let wheels = self.computer.observations().iter();
        wheels.map(|wheel| observation_dict(py, wheel)).collect()
    }

    fn _estimate<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        output_dict(py, &self.computer.estimate())
    }

    /// Forward speed of the robot, m/s; `None` while no wheel shows it.
    #[getter]
    fn speed_mps(&self) -> Option<f64> {
        self.computer.speed()
    }

    /// What the robot does: `Forward`, `Traverse`, `BackOut`, `Detour` or `Stopped`.
    #[getter]
    fn mode(&self) -> &'static str {
        self.computer.mode().name()
    }

    /// The decision of the last tick with its reason, or `None`.
    #[getter]
    fn decision(&self) -> Option<String> {
        self.computer
            .decision()
            .map(|decision| decision_text(&decision, &self.robot.0.robot))
    }

    /// What in the sensors contradicts the robot's description; `None` while nothing does.
    #[getter]
    fn start_fault(&self) -> Option<String> {
        self.computer.start_fault().map(|fault| fault.to_string())
    }

    /// The robot.
    #[getter]
    fn robot(&self) -> Robot {
        self.robot.clone()
    }

    fn __copy__(&self) -> Self {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: Bound<'_, PyAny>) -> Self {
        self.clone()
    }
}
