//! What sensors give: one sample is one reading of one sensor.

mod parts;

use crate::fault::Fault;
use parts::{Cursor, Field, measurements};
pub use parts::{MeasurementField, MeasurementPart, MeasurementParts};

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

measurements! {
    /// A tick counter, as the hardware shows it.
    WheelCount of wheel = "wheel-count" => Rotation {
        /// The counter; bits above its width are ignored, so signed counters are cast.
        raw: u64 = "count", "tick";
    }
    /// One edge of an encoder, stamped with its own time.
    WheelEdge of wheel = "wheel-edge" => Rotation {
        /// Did it turn forwards?
        forward: bool = "forward", "1";
    }
    /// The angle of the sensor's shaft, unwrapped.
    WheelAngle of wheel = "wheel-angle" => Rotation {
        /// rad.
        angle: f64 = "angle_rad", "rad";
    }
    /// The rate of the sensor's shaft, meant to hold since the last reading.
    WheelRate of wheel = "wheel-rate" => Rotation {
        /// rad/s.
        rate: f64 = "rate_rad_per_s", "rad/s";
    }
    /// The robot's yaw rate (a gyro).
    YawRate = "yaw-rate" => Filter {
        /// rad/s, left positive.
        rate: f64 = "rate_rad_per_s", "rad/s";
    }
    /// How far the robot moved since the last sample of this kind, in the frame that it has halfway: headed half the turn
    /// further than at the last.
    Displacement = "displacement" => Filter {
        /// Forwards, m.
        forward: f64 = "forward_m", "m";
        /// To the left, m.
        left: f64 = "left_m", "m";
        /// Turn to the left, rad; `None` where it is not measured.
        turn: Option<f64> = "turn_rad", "rad";
    }
    /// Where the robot is, in a fixed frame.
    Pose = "pose" => Filter {
        /// m.
        x: f64 = "x_m", "m";
        /// m.
        y: f64 = "y_m", "m";
        /// rad, from x towards y.
        yaw: f64 = "yaw_rad", "rad";
    }
    /// A place without a heading, in a fixed frame: a fix, a tag, a prism. The filter of a robot without a free wheel takes it; what
    /// needs displacements takes those that come beside it.
    Position = "position" => Filter {
        /// m.
        x: f64 = "x_m", "m";
        /// m.
        y: f64 = "y_m", "m";
    }
    /// The robot's speed over ground, in its own frame.
    Speed = "speed" => Filter {
        /// Forwards, m/s.
        forward: f64 = "forward_mps", "m/s";
        /// To the left, m/s; `None` where it is not measured.
        left: Option<f64> = "left_mps", "m/s";
    }
    /// Specific force in the robot's frame, m/s²: what an accelerometer feels, gravity's share on a slope included.
    Acceleration = "acceleration" => Filter {
        /// Forwards.
        forward: f64 = "forward_mps2", "m/s²";
        /// To the left.
        left: f64 = "left_mps2", "m/s²";
    }
    /// An inertial unit's own reading in the robot's frame: forwards, to the left, up. [`OnBoard`](crate::onboard::OnBoard)
    /// makes [`Measurement::Acceleration`] and [`Measurement::YawRate`] of it, which the filter takes.
    Inertial = "inertial" => OnBoard {
        /// Specific force, m/s².
        force: [f64; 3] = "force_mps2", "m/s²";
        /// Angular rate, rad/s.
        rate: [f64; 3] = "rate_rad_per_s", "rad/s";
    }
    /// The angle of a joint of the suspension (a rocker, an arm) from its rest, for [`OnBoard`](crate::onboard::OnBoard).
    JointAngle = "joint-angle" => OnBoard {
        /// The joint's index.
        joint: usize = "joint", "1";
        /// rad, nose down positive.
        angle: f64 = "angle_rad", "rad";
    }
    /// The angle by which a wheel is steered beside its heading in the description, to the left positive.
    SteeringAngle of wheel = "steering-angle" => Filter {
        /// rad.
        angle: f64 = "angle_rad", "rad";
    }
    /// The angle of the robot's steering as a whole: of the middle of a steered axle, or of an articulated joint, to the left
    /// positive. Who knows the robot's steering makes [`Measurement::SteeringAngle`] of it; estimators ignore it.
    Steering = "steering" => OnBoard {
        /// rad.
        angle: f64 = "angle_rad", "rad";
    }
    /// A motor's current, for [`OnBoard`](crate::onboard::OnBoard).
    MotorCurrent of wheel = "motor-current" => OnBoard {
        /// Current over its greatest, signed by the torque, 1.
        share: f64 = "share", "1";
    }
    /// How deep the lowest point of a wheel lies below the ground in front of it (a camera, a displacement sensor, the
    /// suspension's kinematics), for [`OnBoard`](crate::onboard::OnBoard).
    Sinkage of wheel = "sinkage" => OnBoard {
        /// m.
        depth: f64 = "depth_m", "m";
    }
    /// The angle at which the ground in front of a wheel meets its rim, from the lowest point forwards: θ₁ of the paper, for
    /// [`OnBoard`](crate::onboard::OnBoard).
    EntryAngle of wheel = "entry-angle" => OnBoard {
        /// rad.
        angle: f64 = "angle_rad", "rad";
    }
    /// How what carries a wheel (a rocker, an arm) moves beside the level robot, its pitching included. A wheel's sensor
    /// counts against its carrier, and on curved ground no two wheels travel alike.
    Carrier of wheel = "carrier" => Filter {
        /// Turning about the axle, rad/s, nose down positive.
        turn: f64 = "turn_rad_per_s", "rad/s";
        /// Speed of the wheel's centre forwards by it, m/s.
        forward: f64 = "forward_mps", "m/s";
        /// And upwards, m/s.
        up: f64 = "up_mps", "m/s";
    }
    /// Torque on a wheel, positive when it drives forwards.
    WheelTorque of wheel = "wheel-torque" => Filter {
        /// N m.
        torque: f64 = "torque_nm", "N m";
    }
    /// The commanded speed; it sets the direction along which the robot's slip is counted.
    Command = "command" => Filter {
        /// Forwards, m/s.
        forward: f64 = "forward_mps", "m/s";
        /// To the left, m/s.
        left: f64 = "left_mps", "m/s";
    }
}

/// Who takes a kind of measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Taker {
    /// The filter: how far or how fast a wheel turns.
    Rotation,
    /// The filter.
    Filter,
    /// [`OnBoard`](crate::onboard::OnBoard) alone, which makes of it what an estimator takes.
    OnBoard,
}

impl Measurement {
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
        matches!(self.kind().taker(), Taker::Rotation)
    }

    /// Is it raw, so that an estimator takes only what [`OnBoard`](crate::onboard::OnBoard) makes of it?
    #[must_use]
    pub const fn is_raw(&self) -> bool {
        matches!(self.kind().taker(), Taker::OnBoard)
    }
}
