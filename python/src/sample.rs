//! One reading of one sensor.

use grouser::slip::{self, Measurement};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::error::{Details, Limit, input_error, type_error};

/// One reading of one sensor: built by the function named after its kind.
///
/// Times are nanoseconds on one clock with any zero, wheels are indices in the robot's order. Forwards and
/// to the left are positive.
///
/// Examples
/// --------
/// >>> from grouser.slip import Sample
/// >>> Sample.wheel_count(time_ns=0, wheel=1, count=4095).kind
/// 'wheel-count'
#[pyclass(frozen, eq, from_py_object, module = "grouser._core")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample(pub(crate) slip::Sample);

const fn sample(time_ns: i64, measurement: Measurement) -> Sample {
    Sample(slip::Sample {
        time_ns,
        measurement,
    })
}

/// A time in ns.
struct TimeNs(i64);

/// The index of a wheel.
struct WheelIndex(usize);

/// A counter; a signed one may be negative.
struct Count(u64);

/// A whole number of `limits`; anything else is a typed error that names `field`.
fn whole(value: Borrowed<'_, '_, PyAny>, field: &str, limits: (i128, i128)) -> PyResult<i128> {
    let (low, high) = limits;
    let found = value.extract::<i128>();
    match found {
        Ok(number) if (low..=high).contains(&number) => Ok(number),
        Err(error) if error.is_instance_of::<PyTypeError>(value.py()) => {
            let kind = value.get_type().name()?;
            let message = format!("{field} is {kind}, but must be a whole number");
            Err(type_error(message, field))
        }
        _ => {
            let shown = value.str()?;
            let message = format!("{field} is {shown}, but must lie in [{low}, {high}]");
            let details = Details {
                value: Some(value.to_owned().unbind()),
                limit: Some(Limit::Range((low as f64, high as f64))),
                unit: Some("1"),
                ..Details::field(field)
            };
            Err(input_error(message, details))
        }
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for TimeNs {
    type Error = PyErr;

    fn extract(value: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let number = whole(value, "time_ns", (i64::MIN.into(), i64::MAX.into()))?;
        Ok(Self(i64::try_from(number).unwrap_or(i64::MAX)))
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for WheelIndex {
    type Error = PyErr;

    fn extract(value: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let number = whole(value, "wheel", (0, u32::MAX.into()))?;
        Ok(Self(usize::try_from(number).unwrap_or(usize::MAX)))
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for Count {
    type Error = PyErr;

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a counter is used modulo its width"
    )]
    fn extract(value: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let number = whole(value, "count", (i64::MIN.into(), u64::MAX.into()))?;
        Ok(Self(number as u64))
    }
}

/// Kind, wheel (-1 for the robot) and up to six numbers.
pub(crate) fn parts(measurement: &Measurement) -> (&'static str, i64, [f64; 6]) {
    const NAN: f64 = f64::NAN;
    let wheel = measurement
        .wheel()
        .and_then(|wheel| i64::try_from(wheel).ok())
        .unwrap_or(-1);
    let open = |x: Option<f64>| x.unwrap_or(NAN);
    let (kind, numbers) = match *measurement {
        // counts beyond 2^53 lose their last bits here; the sample keeps them
        Measurement::WheelCount { raw, .. } => {
            ("wheel-count", [raw as f64, NAN, NAN, NAN, NAN, NAN])
        }
        Measurement::WheelEdge { forward, .. } => {
            let step = if forward { 1.0 } else { -1.0 };
            ("wheel-edge", [step, NAN, NAN, NAN, NAN, NAN])
        }
        Measurement::WheelAngle { angle, .. } => ("wheel-angle", [angle, NAN, NAN, NAN, NAN, NAN]),
        Measurement::WheelRate { rate, .. } => ("wheel-rate", [rate, NAN, NAN, NAN, NAN, NAN]),
        Measurement::YawRate { rate } => ("yaw-rate", [rate, NAN, NAN, NAN, NAN, NAN]),
        Measurement::Displacement {
            forward,
            left,
            turn,
        } => ("displacement", [forward, left, open(turn), NAN, NAN, NAN]),
        Measurement::Pose { x, y, yaw } => ("pose", [x, y, yaw, NAN, NAN, NAN]),
        Measurement::Speed { forward, left } => {
            ("speed", [forward, open(left), NAN, NAN, NAN, NAN])
        }
        Measurement::Acceleration { forward, left } => {
            ("acceleration", [forward, left, NAN, NAN, NAN, NAN])
        }
        Measurement::Inertial { force, rate } => (
            "inertial",
            [force[0], force[1], force[2], rate[0], rate[1], rate[2]],
        ),
        Measurement::JointAngle { joint, angle } => {
            ("joint-angle", [joint as f64, angle, NAN, NAN, NAN, NAN])
        }
        Measurement::MotorCurrent { share, .. } => {
            ("motor-current", [share, NAN, NAN, NAN, NAN, NAN])
        }
        Measurement::Carrier {
            turn, forward, up, ..
        } => ("carrier", [turn, forward, up, NAN, NAN, NAN]),
        Measurement::WheelTorque { torque, .. } => {
            ("wheel-torque", [torque, NAN, NAN, NAN, NAN, NAN])
        }
        Measurement::Command { forward, left } => ("command", [forward, left, NAN, NAN, NAN, NAN]),
        _ => ("other", [NAN; 6]),
    };
    (kind, wheel, numbers)
}

#[pymethods]
impl Sample {
    /// A tick counter, as the hardware shows it; a signed counter may be negative.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, wheel, count))]
    fn wheel_count(time_ns: TimeNs, wheel: WheelIndex, count: Count) -> Self {
        let (wheel, raw) = (wheel.0, count.0);
        sample(time_ns.0, Measurement::WheelCount { wheel, raw })
    }

    /// The angle of a wheel sensor's shaft, unwrapped, rad.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, wheel, angle_rad))]
    fn wheel_angle(time_ns: TimeNs, wheel: WheelIndex, angle_rad: f64) -> Self {
        let (wheel, angle) = (wheel.0, angle_rad);
        sample(time_ns.0, Measurement::WheelAngle { wheel, angle })
    }

    /// The rate of a wheel sensor's shaft, rad/s.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, wheel, rate_rad_per_s))]
    fn wheel_rate(time_ns: TimeNs, wheel: WheelIndex, rate_rad_per_s: f64) -> Self {
        let (wheel, rate) = (wheel.0, rate_rad_per_s);
        sample(time_ns.0, Measurement::WheelRate { wheel, rate })
    }

    /// The robot's yaw rate, rad/s, to the left.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, rate_rad_per_s))]
    fn yaw_rate(time_ns: TimeNs, rate_rad_per_s: f64) -> Self {
        let rate = rate_rad_per_s;
        sample(time_ns.0, Measurement::YawRate { rate })
    }

    /// How far the robot moved since the last sample of this kind, in its own frame: m, m, rad.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, forward_m, left_m, turn_rad=None))]
    fn displacement(time_ns: TimeNs, forward_m: f64, left_m: f64, turn_rad: Option<f64>) -> Self {
        let measurement = Measurement::Displacement {
            forward: forward_m,
            left: left_m,
            turn: turn_rad,
        };
        sample(time_ns.0, measurement)
    }

    /// Where the robot is in a fixed frame: m, m, rad.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, x_m, y_m, yaw_rad))]
    fn pose(time_ns: TimeNs, x_m: f64, y_m: f64, yaw_rad: f64) -> Self {
        let (x, y, yaw) = (x_m, y_m, yaw_rad);
        sample(time_ns.0, Measurement::Pose { x, y, yaw })
    }

    /// The robot's speed over ground in its own frame, m/s.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, forward_mps, left_mps=None))]
    fn speed(time_ns: TimeNs, forward_mps: f64, left_mps: Option<f64>) -> Self {
        let (forward, left) = (forward_mps, left_mps);
        sample(time_ns.0, Measurement::Speed { forward, left })
    }

    /// Specific force in the robot's frame without gravity, m/s².
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, forward_mps2, left_mps2))]
    fn acceleration(time_ns: TimeNs, forward_mps2: f64, left_mps2: f64) -> Self {
        let (forward, left) = (forward_mps2, left_mps2);
        sample(time_ns.0, Measurement::Acceleration { forward, left })
    }

    /// An inertial unit's reading forwards, to the left, up: specific force (m/s²) and rate (rad/s). For
    /// `OnBoard`.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, force_mps2, rate_rad_per_s))]
    fn inertial(time_ns: TimeNs, force_mps2: [f64; 3], rate_rad_per_s: [f64; 3]) -> Self {
        let (force, rate) = (force_mps2, rate_rad_per_s);
        sample(time_ns.0, Measurement::Inertial { force, rate })
    }

    /// A motor's current over its greatest, signed by the torque. For `OnBoard`.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, wheel, share))]
    fn motor_current(time_ns: TimeNs, wheel: WheelIndex, share: f64) -> Self {
        let wheel = wheel.0;
        sample(time_ns.0, Measurement::MotorCurrent { wheel, share })
    }

    /// Torque on a wheel, N m, positive where it drives forwards.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, wheel, torque_nm))]
    fn wheel_torque(time_ns: TimeNs, wheel: WheelIndex, torque_nm: f64) -> Self {
        let (wheel, torque) = (wheel.0, torque_nm);
        sample(time_ns.0, Measurement::WheelTorque { wheel, torque })
    }

    /// When it was taken, ns.
    #[getter]
    fn time_ns(&self) -> i64 {
        self.0.time_ns
    }

    /// Its kind, such as `wheel-count` or `yaw-rate`.
    #[getter]
    fn kind(&self) -> &'static str {
        parts(&self.0.measurement).0
    }

    /// The wheel's index; `None` for a sensor of the robot.
    #[getter]
    fn wheel(&self) -> Option<usize> {
        self.0.measurement.wheel()
    }

    /// Its numbers, in the order of its function's arguments.
    #[getter]
    fn numbers(&self) -> Vec<f64> {
        let (_, _, numbers) = parts(&self.0.measurement);
        numbers.into_iter().filter(|x| !x.is_nan()).collect()
    }

    fn __repr__(&self) -> String {
        format!("Sample({:?})", self.0)
    }
}
