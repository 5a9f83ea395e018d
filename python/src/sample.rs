//! One reading of one sensor.

use grouser::slip::{self, Measurement};
use pyo3::prelude::*;

use crate::argument;
use crate::error::{Details, input_error};

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

/// A pickled sample: kind, time (ns), wheel, counter, numbers.
type State = (String, i64, i64, u64, [f64; 6]);

const fn sample(time_ns: i64, measurement: Measurement) -> Sample {
    Sample(slip::Sample {
        time_ns,
        measurement,
    })
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
    fn wheel_count(
        #[pyo3(from_py_with = argument::time_ns)] time_ns: i64,
        #[pyo3(from_py_with = argument::count)] wheel: usize,
        #[pyo3(from_py_with = argument::counter)] count: u64,
    ) -> Self {
        let (wheel, raw) = (wheel, count);
        sample(time_ns, Measurement::WheelCount { wheel, raw })
    }

    /// The angle of a wheel sensor's shaft, unwrapped, rad.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, wheel, angle_rad))]
    fn wheel_angle(
        #[pyo3(from_py_with = argument::time_ns)] time_ns: i64,
        #[pyo3(from_py_with = argument::count)] wheel: usize,
        #[pyo3(from_py_with = argument::number)] angle_rad: f64,
    ) -> Self {
        let (wheel, angle) = (wheel, angle_rad);
        sample(time_ns, Measurement::WheelAngle { wheel, angle })
    }

    /// The rate of a wheel sensor's shaft, rad/s.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, wheel, rate_rad_per_s))]
    fn wheel_rate(
        #[pyo3(from_py_with = argument::time_ns)] time_ns: i64,
        #[pyo3(from_py_with = argument::count)] wheel: usize,
        #[pyo3(from_py_with = argument::number)] rate_rad_per_s: f64,
    ) -> Self {
        let (wheel, rate) = (wheel, rate_rad_per_s);
        sample(time_ns, Measurement::WheelRate { wheel, rate })
    }

    /// The robot's yaw rate, rad/s, to the left.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, rate_rad_per_s))]
    fn yaw_rate(
        #[pyo3(from_py_with = argument::time_ns)] time_ns: i64,
        #[pyo3(from_py_with = argument::number)] rate_rad_per_s: f64,
    ) -> Self {
        let rate = rate_rad_per_s;
        sample(time_ns, Measurement::YawRate { rate })
    }

    /// How far the robot moved since the last sample of this kind, in its own frame: m, m, rad.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, forward_m, left_m, turn_rad=None))]
    fn displacement(
        #[pyo3(from_py_with = argument::time_ns)] time_ns: i64,
        #[pyo3(from_py_with = argument::number)] forward_m: f64,
        #[pyo3(from_py_with = argument::number)] left_m: f64,
        #[pyo3(from_py_with = argument::optional_number)] turn_rad: Option<f64>,
    ) -> Self {
        let measurement = Measurement::Displacement {
            forward: forward_m,
            left: left_m,
            turn: turn_rad,
        };
        sample(time_ns, measurement)
    }

    /// Where the robot is in a fixed frame: m, m, rad.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, x_m, y_m, yaw_rad))]
    fn pose(
        #[pyo3(from_py_with = argument::time_ns)] time_ns: i64,
        #[pyo3(from_py_with = argument::number)] x_m: f64,
        #[pyo3(from_py_with = argument::number)] y_m: f64,
        #[pyo3(from_py_with = argument::number)] yaw_rad: f64,
    ) -> Self {
        let (x, y, yaw) = (x_m, y_m, yaw_rad);
        sample(time_ns, Measurement::Pose { x, y, yaw })
    }

    /// The robot's speed over ground in its own frame, m/s.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, forward_mps, left_mps=None))]
    fn speed(
        #[pyo3(from_py_with = argument::time_ns)] time_ns: i64,
        #[pyo3(from_py_with = argument::number)] forward_mps: f64,
        #[pyo3(from_py_with = argument::optional_number)] left_mps: Option<f64>,
    ) -> Self {
        let (forward, left) = (forward_mps, left_mps);
        sample(time_ns, Measurement::Speed { forward, left })
    }

    /// Specific force in the robot's frame without gravity, m/s².
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, forward_mps2, left_mps2))]
    fn acceleration(
        #[pyo3(from_py_with = argument::time_ns)] time_ns: i64,
        #[pyo3(from_py_with = argument::number)] forward_mps2: f64,
        #[pyo3(from_py_with = argument::number)] left_mps2: f64,
    ) -> Self {
        let (forward, left) = (forward_mps2, left_mps2);
        sample(time_ns, Measurement::Acceleration { forward, left })
    }

    /// An inertial unit's reading forwards, to the left, up: specific force (m/s²) and rate (rad/s). For
    /// `OnBoard`.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, force_mps2, rate_rad_per_s))]
    fn inertial(
        #[pyo3(from_py_with = argument::time_ns)] time_ns: i64,
        #[pyo3(from_py_with = argument::vector)] force_mps2: [f64; 3],
        #[pyo3(from_py_with = argument::vector)] rate_rad_per_s: [f64; 3],
    ) -> Self {
        let (force, rate) = (force_mps2, rate_rad_per_s);
        sample(time_ns, Measurement::Inertial { force, rate })
    }

    /// A motor's current over its greatest, signed by the torque. For `OnBoard`.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, wheel, share))]
    fn motor_current(
        #[pyo3(from_py_with = argument::time_ns)] time_ns: i64,
        #[pyo3(from_py_with = argument::count)] wheel: usize,
        #[pyo3(from_py_with = argument::number)] share: f64,
    ) -> Self {
        sample(time_ns, Measurement::MotorCurrent { wheel, share })
    }

    /// Torque on a wheel, N m, positive where it drives forwards.
    #[staticmethod]
    #[pyo3(signature = (*, time_ns, wheel, torque_nm))]
    fn wheel_torque(
        #[pyo3(from_py_with = argument::time_ns)] time_ns: i64,
        #[pyo3(from_py_with = argument::count)] wheel: usize,
        #[pyo3(from_py_with = argument::number)] torque_nm: f64,
    ) -> Self {
        let (wheel, torque) = (wheel, torque_nm);
        sample(time_ns, Measurement::WheelTorque { wheel, torque })
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

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, State)> {
        let own = &slf.get().0;
        let (kind, wheel, numbers) = parts(&own.measurement);
        let raw = match own.measurement {
            Measurement::WheelCount { raw, .. } => raw,
            _ => 0,
        };
        let state = (kind.to_owned(), own.time_ns, wheel, raw, numbers);
        Ok((slf.get_type().getattr("_again")?, state))
    }

    #[staticmethod]
    fn _again(kind: &str, time_ns: i64, wheel: i64, raw: u64, numbers: [f64; 6]) -> PyResult<Self> {
        let wheel = usize::try_from(wheel).unwrap_or(0);
        let [a, b, c, ..] = numbers;
        let some = |x: f64| (!x.is_nan()).then_some(x);
        let measurement = match kind {
            "wheel-count" => Measurement::WheelCount { wheel, raw },
            "wheel-angle" => Measurement::WheelAngle { wheel, angle: a },
            "wheel-rate" => Measurement::WheelRate { wheel, rate: a },
            "yaw-rate" => Measurement::YawRate { rate: a },
            "displacement" => Measurement::Displacement {
                forward: a,
                left: b,
                turn: some(c),
            },
            "pose" => Measurement::Pose { x: a, y: b, yaw: c },
            "speed" => Measurement::Speed {
                forward: a,
                left: some(b),
            },
            "acceleration" => Measurement::Acceleration {
                forward: a,
                left: b,
            },
            "inertial" => Measurement::Inertial {
                force: [a, b, c],
                rate: [numbers[3], numbers[4], numbers[5]],
            },
            "motor-current" => Measurement::MotorCurrent { wheel, share: a },
            "wheel-torque" => Measurement::WheelTorque { wheel, torque: a },
            _ => {
                let message = format!("kind is `{kind}`, but must be one that Sample makes");
                return Err(input_error(message, Details::field("kind")));
            }
        };
        Ok(sample(time_ns, measurement))
    }
}
