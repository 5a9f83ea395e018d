//! From one angle of the steering to the angles of the wheels.

use grouser_files::steering::{Steering, SteeringKind};
use grouser_real::Real;
use grouser_slip::{Measurement, Robot, Sample};

/// Steers the wheels of a robot by one angle.
#[derive(Clone, Debug)]
pub(crate) struct WheelSteering {
    kind: SteeringKind,
    /// Index and position of each steered wheel, m.
    wheels: Vec<(usize, f64, f64)>,
    /// Position of the unsteered wheels along the robot, and that of the steered ones from there, m.
    rear: f64,
    wheelbase: f64,
}

impl WheelSteering {
    /// For the steering of a robot file.
    #[must_use]
    pub(crate) fn new(steering: &Steering, robot: &Robot) -> Self {
        let all = robot.wheels().iter().enumerate();
        let (wheels, others): (Vec<_>, Vec<_>) = all
            .map(|(index, wheel)| (index, wheel.x, wheel.y))
            .partition(|(index, _, _)| steering.wheels.contains(index));
        let mean = |of: &[(usize, f64, f64)]| {
            of.iter().map(|wheel| wheel.1).sum::<f64>() / of.len() as f64
        };
        let rear = mean(&others);
        Self {
            kind: steering.kind,
            rear,
            wheelbase: mean(&wheels) - rear,
            wheels,
        }
    }

    /// The angles of the wheels that a sample of the steering means; nothing for other samples.
    pub(crate) fn angles(&self, sample: &Sample) -> impl Iterator<Item = Sample> {
        let angle = match sample.measurement {
            Measurement::Steering { angle } => Some(angle).filter(|angle| angle.is_finite()),
            _ => None,
        };
        let time_ns = sample.time_ns;
        angle.into_iter().flat_map(move |angle| {
            self.wheels.iter().map(move |&(wheel, x, y)| Sample {
                time_ns,
                measurement: Measurement::SteeringAngle {
                    wheel,
                    angle: self.wheel_angle(angle, x, y),
                },
            })
        })
    }

    /// Does the robot turn as its wheels stand? Of an articulated one the rate of the joint counts too.
    pub(crate) const fn is_ackermann(&self) -> bool {
        matches!(self.kind, SteeringKind::Ackermann)
    }

    /// With Ackermann's steering all wheels turn about one point on the line of the unsteered ones, at R = L / tan δ to the left:
    /// tan δ_i = (x_i − x_r) / (R − y_i). The wheels of an articulated robot's other body turn with it.
    fn wheel_angle(&self, angle: f64, x: f64, y: f64) -> f64 {
        if !self.is_ackermann() {
            return angle;
        }
        let tan = Real::tan(angle);
        Real::atan(tan * (x - self.rear) / (self.wheelbase - y * tan))
    }
}
