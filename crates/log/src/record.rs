//! The typed records that every reader gives.

/// One reading of one sensor, in SI units and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    /// When it was taken, ns, on the clock of its source.
    pub time_ns: i64,
    /// Which source it came from: the index of its table or topic.
    pub source: usize,
    /// What was read.
    pub reading: Reading,
}

/// What was read. Wheels are indices into [`Log::wheels`](crate::Log::wheels).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reading {
    /// A wheel's tick counter, as the hardware shows it; a signed one is cast.
    WheelCount {
        /// The wheel.
        wheel: usize,
        /// The counter.
        raw: u64,
    },
    /// The angle of a wheel's sensor shaft, rad.
    WheelAngle {
        /// The wheel.
        wheel: usize,
        /// rad.
        angle: f64,
    },
    /// The rate of a wheel's sensor shaft, rad/s.
    WheelRate {
        /// The wheel.
        wheel: usize,
        /// rad/s.
        rate: f64,
    },
    /// Torque on a wheel, N m, positive when it drives forwards.
    WheelTorque {
        /// The wheel.
        wheel: usize,
        /// N m.
        torque: f64,
    },
    /// What an accelerometer feels in the robot's frame, gravity's share on a slope included.
    Acceleration {
        /// m/s².
        forward: f64,
        /// m/s².
        left: f64,
    },
    /// The robot's yaw rate, rad/s.
    YawRate {
        /// rad/s.
        rate: f64,
    },
    /// Way since the last record of this kind, in the robot's frame.
    Displacement {
        /// m.
        forward: f64,
        /// m.
        left: f64,
        /// rad, where it was measured.
        turn: Option<f64>,
    },
    /// A pose in a fixed frame.
    Pose {
        /// m.
        x: f64,
        /// m.
        y: f64,
        /// rad.
        yaw: f64,
    },
    /// Speed over ground, in the robot's frame.
    Speed {
        /// m/s.
        forward: f64,
        /// m/s, where it was measured.
        left: Option<f64>,
    },
    /// Commanded speed, in the robot's frame.
    Command {
        /// m/s.
        forward: f64,
        /// m/s.
        left: f64,
    },
}
