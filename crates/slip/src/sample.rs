//! What sensors give: one sample is one reading of one sensor.

use crate::fault::Fault;

/// One reading of one sensor.
///
/// Times are nanoseconds on one clock with any zero: integers, so that a clock that counts from 1970
/// loses nothing.
///
/// ```
/// use grouser_slip::{Measurement, Sample};
///
/// let sample = Sample { time_ns: 20_000_000, measurement: Measurement::YawRate { rate: 0.1 } };
/// assert_eq!(sample.measurement.wheel(), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// When it was taken, ns.
    pub time_ns: i64,
    /// What was read.
    pub measurement: Measurement,
}

/// What a sensor reads.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Measurement {
    /// A tick counter, as the hardware shows it.
    WheelCount {
        /// The wheel's index in the robot's description.
        wheel: usize,
        /// The counter; bits above its width are ignored, so signed counters are cast.
        raw: u64,
    },
    /// One edge of an encoder, stamped with its own time.
    WheelEdge {
        /// The wheel's index.
        wheel: usize,
        /// Did it turn forwards?
        forward: bool,
    },
    /// The angle of the sensor's shaft, unwrapped.
    WheelAngle {
        /// The wheel's index.
        wheel: usize,
        /// rad.
        angle: f64,
    },
    /// The rate of the sensor's shaft, meant to hold since the last reading.
    WheelRate {
        /// The wheel's index.
        wheel: usize,
        /// rad/s.
        rate: f64,
    },
    /// The robot's yaw rate (a gyro).
    YawRate {
        /// rad/s, left positive.
        rate: f64,
    },
    /// How far the robot moved since the last sample of this kind, in the frame that it has halfway: headed half the turn
    /// further than at the last.
    Displacement {
        /// Forwards, m.
        forward: f64,
        /// To the left, m.
        left: f64,
        /// Turn to the left, rad; `None` where it is not measured.
        turn: Option<f64>,
    },
    /// Where the robot is, in a fixed frame.
    Pose {
        /// m.
        x: f64,
        /// m.
        y: f64,
        /// rad, from x towards y.
        yaw: f64,
    },
    /// A place without a heading, in a fixed frame: a fix, a tag, a prism. The filter of a robot without a free wheel takes it; what
    /// needs displacements takes those that come beside it.
    Position {
        /// m.
        x: f64,
        /// m.
        y: f64,
    },
    /// The robot's speed over ground, in its own frame.
    Speed {
        /// Forwards, m/s.
        forward: f64,
        /// To the left, m/s; `None` where it is not measured.
        left: Option<f64>,
    },
    /// Specific force in the robot's frame, m/s²: what an accelerometer feels, gravity's share on a slope included.
    Acceleration {
        /// Forwards.
        forward: f64,
        /// To the left.
        left: f64,
    },
    /// An inertial unit's own reading in the robot's frame: forwards, to the left, up. [`OnBoard`](crate::onboard::OnBoard)
    /// makes [`Measurement::Acceleration`] and [`Measurement::YawRate`] of it, which the filter takes.
    Inertial {
        /// Specific force, m/s².
        force: [f64; 3],
        /// Angular rate, rad/s.
        rate: [f64; 3],
    },
    /// The angle of a joint of the suspension (a rocker, an arm) from its rest, for [`OnBoard`](crate::onboard::OnBoard).
    JointAngle {
        /// The joint's index.
        joint: usize,
        /// rad, nose down positive.
        angle: f64,
    },
    /// The angle by which a wheel is steered beside its heading in the description, to the left positive.
    SteeringAngle {
        /// The wheel's index.
        wheel: usize,
        /// rad.
        angle: f64,
    },
    /// The angle of the robot's steering as a whole: of the middle of a steered axle, or of an articulated joint, to the left
    /// positive. Who knows the robot's steering makes [`Measurement::SteeringAngle`] of it; estimators ignore it.
    Steering {
        /// rad.
        angle: f64,
    },
    /// A motor's current, for [`OnBoard`](crate::onboard::OnBoard).
    MotorCurrent {
        /// The wheel's index.
        wheel: usize,
        /// Current over its greatest, signed by the torque, 1.
        share: f64,
    },
    /// How deep the lowest point of a wheel lies below the ground in front of it (a camera, a displacement sensor, the
    /// suspension's kinematics), for [`OnBoard`](crate::onboard::OnBoard).
    Sinkage {
        /// The wheel's index.
        wheel: usize,
        /// m.
        depth: f64,
    },
    /// The angle at which the ground in front of a wheel meets its rim, from the lowest point forwards: θ₁ of the paper, for
    /// [`OnBoard`](crate::onboard::OnBoard).
    EntryAngle {
        /// The wheel's index.
        wheel: usize,
        /// rad.
        angle: f64,
    },
    /// How what carries a wheel (a rocker, an arm) moves beside the level robot, its pitching included. A wheel's sensor
    /// counts against its carrier, and on curved ground no two wheels travel alike.
    Carrier {
        /// The wheel's index.
        wheel: usize,
        /// Turning about the axle, rad/s, nose down positive.
        turn: f64,
        /// Speed of the wheel's centre forwards by it, m/s.
        forward: f64,
        /// And upwards, m/s.
        up: f64,
    },
    /// Torque on a wheel, N m, positive when it drives forwards.
    WheelTorque {
        /// The wheel's index.
        wheel: usize,
        /// The torque.
        torque: f64,
    },
    /// The commanded speed; it sets the direction along which the robot's slip
    /// is counted.
    Command {
        /// Forwards, m/s.
        forward: f64,
        /// To the left, m/s.
        left: f64,
    },
}

impl Measurement {
    /// The wheel that it belongs to, as an index in the robot's description.
    #[must_use]
    pub const fn wheel(&self) -> Option<usize> {
        match *self {
            Self::WheelCount { wheel, .. }
            | Self::WheelEdge { wheel, .. }
            | Self::WheelAngle { wheel, .. }
            | Self::WheelRate { wheel, .. }
            | Self::Carrier { wheel, .. }
            | Self::MotorCurrent { wheel, .. }
            | Self::Sinkage { wheel, .. }
            | Self::EntryAngle { wheel, .. }
            | Self::SteeringAngle { wheel, .. }
            | Self::WheelTorque { wheel, .. } => Some(wheel),
            _ => None,
        }
    }

    /// The same measurement of another wheel; without effect on measurements of the robot.
    ///
    /// ```
    /// use grouser_slip::Measurement;
    ///
    /// let moved = Measurement::WheelAngle { wheel: 0, angle: 1.5 }.with_wheel(3);
    /// assert_eq!(moved.wheel(), Some(3));
    /// ```
    #[must_use]
    pub const fn with_wheel(mut self, index: usize) -> Self {
        match &mut self {
            Self::WheelCount { wheel, .. }
            | Self::WheelEdge { wheel, .. }
            | Self::WheelAngle { wheel, .. }
            | Self::WheelRate { wheel, .. }
            | Self::Carrier { wheel, .. }
            | Self::MotorCurrent { wheel, .. }
            | Self::Sinkage { wheel, .. }
            | Self::EntryAngle { wheel, .. }
            | Self::SteeringAngle { wheel, .. }
            | Self::WheelTorque { wheel, .. } => *wheel = index,
            _ => {}
        }
        self
    }

    /// Does it tell how far or how fast a wheel turns?
    ///
    /// ```
    /// use grouser_slip::Measurement;
    ///
    /// assert!(Measurement::WheelRate { wheel: 0, rate: 2.0 }.is_rotation());
    /// assert!(!Measurement::YawRate { rate: 2.0 }.is_rotation());
    /// ```
    #[must_use]
    pub const fn is_rotation(&self) -> bool {
        matches!(
            self,
            Self::WheelCount { .. }
                | Self::WheelEdge { .. }
                | Self::WheelAngle { .. }
                | Self::WheelRate { .. }
        )
    }

    /// Refuses a reading that holds NaN or an infinity.
    pub(crate) fn check_finite(&self) -> Result<(), Fault> {
        let check = Fault::check_finite;
        match *self {
            // integers, and raw readings, which are checked where they are processed
            Self::WheelCount { .. }
            | Self::WheelEdge { .. }
            | Self::Inertial { .. }
            | Self::JointAngle { .. }
            | Self::Steering { .. }
            | Self::Sinkage { .. }
            | Self::EntryAngle { .. }
            | Self::MotorCurrent { .. } => Ok(()),
            Self::WheelAngle { angle, .. } => check("angle", angle, "rad"),
            Self::WheelRate { rate, .. } => check("rate", rate, "rad/s"),
            Self::YawRate { rate } => check("yaw rate", rate, "rad/s"),
            Self::Displacement {
                forward,
                left,
                turn,
            } => {
                check("displacement forward", forward, "m")?;
                check("displacement left", left, "m")?;
                check("displacement turn", turn.unwrap_or(0.0), "rad")
            }
            Self::Pose { x, y, yaw } => {
                check("pose x", x, "m")?;
                check("pose y", y, "m")?;
                check("pose yaw", yaw, "rad")
            }
            Self::Position { x, y } => {
                check("position x", x, "m")?;
                check("position y", y, "m")
            }
            Self::Speed { forward, left } => {
                check("speed forward", forward, "m/s")?;
                check("speed left", left.unwrap_or(0.0), "m/s")
            }
            Self::Acceleration { forward, left } => {
                check("acceleration forward", forward, "m/s²")?;
                check("acceleration left", left, "m/s²")
            }
            Self::SteeringAngle { angle, .. } => check("steering angle", angle, "rad"),
            Self::Carrier {
                turn, forward, up, ..
            } => {
                check("carrier turn", turn, "rad/s")?;
                check("carrier forward", forward, "m/s")?;
                check("carrier up", up, "m/s")
            }
            Self::WheelTorque { torque, .. } => check("torque", torque, "N m"),
            Self::Command { forward, left } => {
                check("command forward", forward, "m/s")?;
                check("command left", left, "m/s")
            }
        }
    }

    /// Is it raw, so that an estimator takes only what [`OnBoard`](crate::onboard::OnBoard) makes of it?
    pub(crate) const fn is_raw(&self) -> bool {
        matches!(
            self,
            Self::Inertial { .. }
                | Self::JointAngle { .. }
                | Self::Steering { .. }
                | Self::Sinkage { .. }
                | Self::EntryAngle { .. }
                | Self::MotorCurrent { .. }
        )
    }
}
