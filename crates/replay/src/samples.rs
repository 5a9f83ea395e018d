//! Which of a log's samples are used, and what they say.

use grouser_doctor::Held;
use grouser_files::columns::Meaning;
use grouser_files::robot::RobotFile;
use grouser_log::{Log, Measures};
use grouser_slip::{Measurement, Sample};

use crate::choice::{Inputs, LogWheel, robot_wheels};
use crate::error::Result;
use crate::options::Options;
use crate::wheel_sign::WheelSign;

/// The samples of a live source as those of the robot: wheels in the robot's order, speeds as rates, currents as torques; a
/// speed over ground of which only the size is measured has the sign of the wheels.
///
/// [`run`](crate::run()) does the same for a log.
#[derive(Clone, Debug)]
pub struct RobotSamples {
    wheels: Vec<LogWheel>,
    /// Where the speed over ground is measured by its size alone.
    sign: Option<WheelSign>,
}

impl RobotSamples {
    /// For the samples of `source`.
    ///
    /// # Errors
    /// [`Error::UnknownWheel`](crate::Error::UnknownWheel) for a wheel that the robot does not have.
    pub fn new(source: &impl Measures, file: &RobotFile) -> Result<Self> {
        let has_sign =
            source.measures(Meaning::SpeedForward) || !source.measures(Meaning::SpeedSize);
        Ok(Self {
            wheels: robot_wheels(source, file)?,
            sign: (!has_sign).then(|| WheelSign::new(&file.robot)),
        })
    }

    /// The sample for [`Engine::push`](crate::Engine::push); samples come in the order of time.
    #[must_use]
    pub fn convert(&mut self, sample: Sample) -> Sample {
        let mut sample = of_robot(sample, &self.wheels);
        if let Some(sign) = &mut self.sign {
            sign.apply(&mut sample);
        }
        sample
    }
}

/// A sample of the log as one of the robot, whose wheel `i` of the log is `wheels[i]`. A current whose torque is not known stays
/// one, A, of which only changes count.
pub(crate) fn of_robot(sample: Sample, wheels: &[LogWheel]) -> Sample {
    let Some(wheel) = sample.measurement.wheel() else {
        return sample;
    };
    let of = wheels[wheel];
    let wheel = of.index;
    let measurement = match sample.measurement {
        Measurement::WheelAngle { angle, .. } => Measurement::WheelAngle {
            wheel,
            angle: angle * of.angle,
        },
        Measurement::WheelRate { rate, .. } => Measurement::WheelRate {
            wheel,
            rate: rate * of.rate,
        },
        Measurement::WheelTorque { torque, .. } => match of.torque {
            Some(scale) => Measurement::WheelTorque {
                wheel,
                torque: torque * scale,
            },
            None => Measurement::MotorCurrent {
                wheel,
                share: torque,
            },
        },
        other => other.with_wheel(wheel),
    };
    Sample {
        measurement,
        ..sample
    }
}

/// Which readings of a log's reference only repeat its last update. `shifts` are added to the log's clocks, ns.
pub(crate) fn held(log: &Log, file: &RobotFile, options: &Options, shifts: &[i64]) -> Result<Held> {
    robot_wheels(log, file)?; // a wheel that the robot lacks is the first error to report
    let reference = Inputs::of(log, file, options)?.reference;
    Ok(Held::find(reference, log.samples(shifts)?)?)
}
