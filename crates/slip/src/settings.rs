//! How the estimator works: one value per line, each with its default.

use crate::error::{Result, check_range};

/// What tells how fast the robot travels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reference {
    /// The robot's free wheels, taken to roll without slip [Ani2012, P23]. They do skid a little on
    /// soft ground (MODEL.md 7): the slips then come out too high by −s_f (1 − S).
    FreeWheel,
    /// Measured displacements, in the robot's frame (a camera, visual odometry).
    Displacement,
    /// A measured pose (a camera from above, motion capture, GNSS).
    Pose,
    /// A measured speed over ground.
    Speed,
    /// None of these: the wheel that runs slowest for the robot's yaw rate is taken to grip.
    Grip,
}

impl Reference {
    /// Every reference, the one to be preferred first.
    pub const ALL: [Self; 5] = [
        Self::Displacement,
        Self::Pose,
        Self::Speed,
        Self::FreeWheel,
        Self::Grip,
    ];

    /// Its name in files and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::FreeWheel => "free-wheel",
            Self::Displacement => "displacement",
            Self::Pose => "pose",
            Self::Speed => "speed",
            Self::Grip => "grip",
        }
    }
}

/// How the estimator works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// What tells how fast the robot travels.
    pub reference: Reference,
    /// Speeds are means over this time, s.
    pub window: f64,
    /// A wheel or a robot slower than this stands still, m/s.
    pub standstill_speed: f64,
    /// A wheel whose faster speed is below this has no slip worth a number, m/s.
    pub low_speed: f64,
    /// A slip whose sigma is above this is marked as quantised.
    pub max_sigma: f64,
    /// No part of the robot moves faster than this, m/s: what says so is a jump of its sensor.
    pub max_speed: f64,
    /// A sensor silent for longer than this has dropped out, s.
    pub dropout: f64,
    /// Error of a measured position or displacement (one sigma at each end of a window), m.
    pub position_sigma: f64,
    /// Error of a measured yaw angle or turn, rad.
    pub yaw_sigma: f64,
    /// Error of a measured speed over ground, m/s.
    pub speed_sigma: f64,
    /// Error of a measured yaw rate, as a mean over a window, rad/s.
    pub yaw_rate_sigma: f64,
    /// How far a robot whose wheels all point one way may drift sideways, m/s.
    pub lateral_sigma: f64,
    /// How many samples of each sensor a window may hold; faster sensors are thinned.
    pub history: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            reference: Reference::FreeWheel,
            window: 0.5,
            standstill_speed: 0.002,
            low_speed: 0.01,
            max_sigma: 0.25,
            max_speed: 20.0,
            dropout: 0.5,
            position_sigma: 0.001,
            yaw_sigma: 0.005,
            speed_sigma: 0.01,
            yaw_rate_sigma: 0.005,
            lateral_sigma: 0.01,
            history: 512,
        }
    }
}

impl Settings {
    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) that names the field.
    pub fn check(&self) -> Result<()> {
        let of = "estimator";
        check_range(of, "window", self.window, (1e-3, 100.0), "s")?;
        let speed = (0.0, 100.0);
        check_range(of, "standstill_speed", self.standstill_speed, speed, "m/s")?;
        check_range(of, "low_speed", self.low_speed, speed, "m/s")?;
        check_range(of, "max_sigma", self.max_sigma, (0.0, 10.0), "1")?;
        check_range(of, "max_speed", self.max_speed, (1e-3, 1e3), "m/s")?;
        check_range(of, "dropout", self.dropout, (1e-3, 1e3), "s")?;
        let sigma = (1e-9, 1e3);
        check_range(of, "position_sigma", self.position_sigma, sigma, "m")?;
        check_range(of, "yaw_sigma", self.yaw_sigma, sigma, "rad")?;
        check_range(of, "speed_sigma", self.speed_sigma, sigma, "m/s")?;
        check_range(of, "yaw_rate_sigma", self.yaw_rate_sigma, sigma, "rad/s")?;
        check_range(of, "lateral_sigma", self.lateral_sigma, sigma, "m/s")?;
        check_range(of, "history", self.history as f64, (8.0, 1e6), "1")
    }
}
