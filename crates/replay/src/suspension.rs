//! What rockers, arms and the inclination of the robot add to what its sensors show, as on board.

use grouser_files::robot::RobotFile;
use grouser_slip::onboard::{AttitudeFilter, Carriers};
use grouser_slip::{Measurement, Sample};

/// Where the file does not state gravity, it is the mean size of the specific force over this number of readings: over half a second at
/// 100 Hz a robot that rests or begins to drive accelerates by little of it.
const GRAVITY_READINGS: f64 = 50.0;

/// The robot's tilt: roll (right side down) and pitch (nose down), rad, and their rates, rad/s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tilt {
    pub(crate) roll: f64,
    pub(crate) pitch: f64,
    pub(crate) rates: [f64; 2],
}

/// The suspension of a robot whose file describes its body.
#[derive(Clone, Debug)]
pub(crate) struct Suspension {
    carriers: Carriers,
    /// `None` until gravity is known.
    attitude: Option<AttitudeFilter>,
    /// Sum of the sizes of the specific force, m/s², and their number.
    forces: [f64; 2],
    /// Rates of roll and pitch, rad/s.
    rates: [f64; 2],
}

impl Suspension {
    /// `None` where the file describes no body.
    pub(crate) fn new(file: &RobotFile) -> Option<Self> {
        let carriers = file.body.as_ref()?.carriers(&file.robot);
        Some(Self {
            carriers: Carriers::new(carriers.into_iter()),
            attitude: (file.gravity).map(|gravity| AttitudeFilter::new(0.0, gravity)),
            forces: [0.0; 2],
            rates: [0.0; 2],
        })
    }

    /// Does a measurement show the suspension alone, so that an estimator takes only what follows from it?
    pub(crate) const fn is_raw(measurement: &Measurement) -> bool {
        matches!(
            measurement,
            Measurement::Inertial { .. } | Measurement::JointAngle { .. }
        )
    }

    /// Takes a sample, and takes gravity's share out of a specific force; gives how each wheel is carried where the sample shows that.
    pub(crate) fn take(&mut self, sample: &mut Sample) -> Vec<Sample> {
        match &mut sample.measurement {
            Measurement::JointAngle { joint, angle } => {
                self.carriers.update(sample.time_ns, *joint, *angle);
            }
            Measurement::Inertial { force, rate } => {
                self.find_gravity(force);
                self.rates = [rate[0], rate[1]];
                if let Some(attitude) = &mut self.attitude {
                    attitude.update(sample.time_ns, *force, *rate);
                }
                return self.carriers.samples(sample.time_ns, rate[1]).collect();
            }
            Measurement::Acceleration { forward, left } => {
                if let Some(attitude) = &self.attitude {
                    [*forward, *left] = attitude.without_gravity([*forward, *left, 0.0]);
                }
            }
            _ => {}
        }
        Vec::new()
    }

    /// The tilt, once gravity is known.
    pub(crate) fn tilt(&self) -> Option<Tilt> {
        self.attitude.as_ref().map(|attitude| Tilt {
            roll: attitude.roll(),
            pitch: attitude.pitch(),
            rates: self.rates,
        })
    }

    fn find_gravity(&mut self, force: &[f64; 3]) {
        let size = force.iter().map(|part| part * part).sum::<f64>().sqrt();
        if self.attitude.is_some() || !size.is_finite() {
            return;
        }
        let [sum, count] = &mut self.forces;
        (*sum, *count) = (*sum + size, *count + 1.0);
        if *count >= GRAVITY_READINGS {
            self.attitude = Some(AttitudeFilter::new(0.0, *sum / *count));
        }
    }
}
