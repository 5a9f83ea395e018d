//! What in the log is used: which sensor of the wheels, which reference.

use grouser_files::columns::Meaning;
use grouser_files::nearest;
use grouser_files::robot::{Corrections, RobotFile, WheelSensor};
use grouser_log::{Log, Measures};
use grouser_real::Real;
use grouser_slip::{Reference, WheelRole};

use crate::error::{Error, Result};
use crate::options::Options;

/// By which sensors a robot is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs {
    /// The wheels' sensor; samples of the others are not used.
    pub wheel_sensor: WheelSensor,
    /// What measures how fast the robot travels.
    pub reference: Reference,
    /// The position of a speed's sensor by the log's transforms, forwards and to the left, m; the robot file's own outranks it.
    pub speed_place: [f64; 2],
    /// The standard deviation of a place by the reference, m, where the log states it.
    pub position_sigma: Option<f64>,
    /// Is the acceleration measured forwards alone? That to the left is then the one of the turn.
    pub is_acceleration_forward_only: bool,
}

impl Inputs {
    /// The inputs that a log or a live source offers: the options' choice, else the robot file's, else the best.
    ///
    /// # Errors
    /// [`Error::NoWheels`], [`Error::WheelNotMeasured`], [`Error::NoTicks`] and [`Error::NoReference`] where the log does
    /// not hold what was chosen.
    ///
    /// ```
    /// use grouser_files::{columns, robot};
    /// use grouser_log::Log;
    /// use grouser_replay::{Inputs, Options};
    /// use grouser_slip::Reference;
    ///
    /// let example = std::path::Path::new("../../examples/five-wheel");
    /// let robot = robot::read(&example.join("robot.toml"))?;
    /// let log = Log::find(&[example.join("log.csv")], columns::read(&example.join("columns.toml"))?)?;
    /// assert_eq!(Inputs::of(&log, &robot, &Options::default())?.reference, Reference::FreeWheel);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(log: &impl Measures, file: &RobotFile, options: &Options) -> Result<Self> {
        let wheel_sensor = wheel_sensor(log, file, options.wheel_sensor)?;
        let reference = reference(log, file, wheel_sensor, options.reference)?;
        let position_sigma = log.position_sigma();
        mounting_has_effect(log, file, reference)?;
        let is_speed = reference == Reference::Speed;
        Ok(Self {
            wheel_sensor,
            reference,
            speed_place: if is_speed {
                log.speed_place()
            } else {
                [0.0; 2]
            },
            position_sigma,
            is_acceleration_forward_only: log.measures(Meaning::AccelerationForward)
                && !log.measures(Meaning::AccelerationLeft),
        })
    }
}

/// A speed along one axis that is turned further from forwards (cosine, 80°) measures a drift, and no slip. Limit.
const MIN_FORWARD_COS: f64 = 0.17;

/// The keys of the mounting have an effect on this reference.
fn mounting_has_effect(log: &impl Measures, file: &RobotFile, reference: Reference) -> Result<()> {
    let Corrections {
        pose_yaw_offset: yaw,
        reference_place: [x, y, z],
        ..
    } = file.corrections;
    let has_gyro = log.measures(Meaning::YawRate);
    let is_vector = log.measures(Meaning::SpeedLeft);
    let (places, yaws) = match reference {
        Reference::Pose => (true, true),
        Reference::Speed => (
            has_gyro && (is_vector || y != 0.0 || yaw != 0.0),
            log.measures(Meaning::SpeedForward)
                && (is_vector || Real::cos(yaw).abs() > MIN_FORWARD_COS),
        ),
        // of places without a heading it is the antenna's
        Reference::Displacement if log.position_sigma().is_some() => (false, false),
        Reference::Displacement => (has_gyro || log.measures(Meaning::DisplacementTurn), true),
        _ => (false, false),
    };
    let leans = file.body.is_some() && log.measures(Meaning::AccelerationForward);
    let without_effect = [
        ("reference_x_m", !places && [x, y] != [0.0; 2]),
        ("reference_z_m", !(yaws && leans) && z != 0.0),
        ("pose_yaw_offset_deg", !yaws && yaw != 0.0),
    ];
    match without_effect
        .into_iter()
        .find(|(_, is_in_vain)| *is_in_vain)
    {
        Some((key, _)) => Err(Error::NoEffect {
            key,
            reference: reference.name(),
        }),
        None => Ok(()),
    }
}

/// A wheel of a log.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LogWheel {
    /// Its index in the robot's order.
    pub(crate) index: usize,
    /// The angle of its sensor's shaft for one unit that the log holds.
    pub(crate) angle: f64,
    /// The rate of that shaft for one unit that the log holds.
    pub(crate) rate: f64,
    /// The torque for one unit that the log holds; `None` of a current whose motor is not known.
    pub(crate) torque: Option<f64>,
}

/// For every wheel of the log the robot's wheel.
pub(crate) fn robot_wheels(log: &impl Measures, file: &RobotFile) -> Result<Vec<LogWheel>> {
    let robot = &file.robot;
    log.wheels()
        .iter()
        .map(|name| {
            let index = robot.wheel_index(name).ok_or_else(|| {
                let names = robot.wheels().iter().map(|wheel| wheel.name.as_str());
                Error::UnknownWheel {
                    wheel: name.clone(),
                    robot: robot.name().into(),
                    meant: nearest(name, names).map(Into::into),
                }
            })?;
            let per_metre = 1.0 / robot.wheels()[index].travel_per_radian();
            let per_unit = |in_metres| {
                if log.measures_wheel(in_metres, name) {
                    per_metre
                } else {
                    1.0
                }
            };
            let is_current = log.measures_wheel(Meaning::MotorCurrent, name);
            Ok(LogWheel {
                index,
                angle: per_unit(Meaning::WheelDistance),
                rate: per_unit(Meaning::WheelSpeed),
                torque: if is_current {
                    torque_per_ampere(file, index)
                } else {
                    Some(1.0)
                },
            })
        })
        .collect()
}

/// Torque on a wheel per ampere of its motor, N m/A: the robot file's own number, else by its motor and gear.
fn torque_per_ampere(file: &RobotFile, index: usize) -> Option<f64> {
    let by_motor = || {
        let body = file.body.as_ref()?;
        let name = body.wheels.get(index)?.motor.as_ref()?;
        let motor = body.motors.iter().find(|motor| motor.name == *name)?;
        let gear = file.robot.wheels()[index].encoder.gear;
        Some(motor.constant * gear * motor.gear_efficiency)
    };
    let own = file.torque_per_ampere.get(index).copied().flatten();
    own.or_else(by_motor)
}

/// Wheels whose motor current is measured and not used, because nothing says what torque it is.
#[must_use]
pub fn unused_currents(log: &Log, file: &RobotFile) -> Vec<String> {
    let wheels = file.robot.wheels().iter().enumerate();
    let unused = wheels.filter(|(index, wheel)| {
        log.measures_wheel(Meaning::MotorCurrent, &wheel.name)
            && torque_per_ampere(file, *index).is_none()
    });
    unused.map(|(_, wheel)| wheel.name.clone()).collect()
}

/// The meanings of a sensor's readings.
const fn meanings(sensor: WheelSensor) -> &'static [Meaning] {
    match sensor {
        WheelSensor::Count => &[Meaning::WheelCount],
        WheelSensor::Angle => &[Meaning::WheelAngle, Meaning::WheelDistance],
        WheelSensor::Rate => &[Meaning::WheelRate, Meaning::WheelSpeed],
    }
}

fn measures(log: &impl Measures, sensor: WheelSensor, wheel: &str) -> bool {
    let mut all = meanings(sensor).iter();
    all.any(|meaning| log.measures_wheel(*meaning, wheel))
        || log.measures_wheel(Meaning::WheelEdge, wheel)
}

/// The sensor by which the wheels are measured: the option's, else the robot file's, else the first of
/// counts, angles and rates that the log holds.
fn wheel_sensor(
    log: &impl Measures,
    file: &RobotFile,
    chosen: Option<WheelSensor>,
) -> Result<WheelSensor> {
    let robot = &file.robot;
    let mut order = WheelSensor::NAMES.iter().map(|(_, sensor)| *sensor);
    let sensor = chosen
        .or(file.wheel_sensor)
        .or_else(|| {
            order.find(|&sensor| {
                meanings(sensor)
                    .iter()
                    .any(|meaning| log.measures(*meaning))
            })
        })
        .ok_or_else(|| Error::NoWheels {
            robot: robot.name().into(),
            is_of_tables: log.is_of_tables(),
        })?;
    for wheel in robot
        .wheels()
        .iter()
        .filter(|w| w.role == WheelRole::Powered)
    {
        if !measures(log, sensor, &wheel.name) {
            return Err(Error::WheelNotMeasured {
                wheel: wheel.name.clone(),
                sensor: sensor.name(),
            });
        }
        if sensor == WheelSensor::Count && wheel.encoder.ticks_per_turn.is_none() {
            return Err(Error::NoTicks {
                wheel: wheel.name.clone(),
            });
        }
    }
    Ok(sensor)
}

/// The reference: the option's, else the robot file's, else the best that the log holds. A robot file's `grip` is what
/// remains where nothing measures the robot's motion, so that anything that does outranks it.
fn reference(
    log: &impl Measures,
    file: &RobotFile,
    sensor: WheelSensor,
    chosen: Option<Reference>,
) -> Result<Reference> {
    let missing = |reference: Reference| -> Option<&'static str> {
        let needs = |meaning, what| (!log.measures(meaning)).then_some(what);
        match reference {
            Reference::Displacement => {
                needs(Meaning::DisplacementForward, "columns of displacement")
            }
            Reference::Pose => needs(Meaning::PoseX, "columns of a pose"),
            Reference::Speed if log.measures(Meaning::SpeedSize) => None,
            Reference::Speed => needs(Meaning::SpeedForward, "a column of speed over ground"),
            Reference::FreeWheel => {
                let mut free = file
                    .robot
                    .wheels()
                    .iter()
                    .filter(|w| w.role == WheelRole::Free);
                let any = free.clone().next().is_some();
                let all = free.all(|w| measures(log, sensor, &w.name));
                (!(any && all)).then_some("a free wheel that is measured")
            }
            Reference::Grip => needs(Meaning::YawRate, "a column of yaw rate"),
            _ => None,
        }
    };
    let preferred = file
        .reference
        .filter(|reference| *reference != Reference::Grip);
    match chosen.or(preferred) {
        Some(reference) => match missing(reference) {
            None => Ok(reference),
            Some(needs) => Err(Error::NoReference {
                reference: reference.name(),
                needs,
            }),
        },
        None => Reference::ALL
            .into_iter()
            .find(|&reference| missing(reference).is_none())
            .ok_or(Error::NoReference {
                reference: "any",
                needs: "a displacement, a pose, a speed over ground, a free wheel, or at least a yaw rate",
            }),
    }
}
