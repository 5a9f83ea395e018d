//! How good the sensors are: one value per line, each with its default.

use crate::error::{Error, Result};

/// How good the sensors are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorSettings {
    /// Readings of encoders, inertial unit and currents, 1/s.
    pub rate: f64,
    /// Noise of the angular velocity, rad/s a reading.
    pub gyro_sigma: f64,
    /// Spread of the gyro's constant bias, rad/s.
    pub gyro_bias: f64,
    /// Noise of the acceleration, m/s² a reading.
    pub accelerometer_sigma: f64,
    /// Noise of the angles of rockers and arms, rad a reading.
    pub joint_sigma: f64,
    /// Noise of the current over its greatest.
    pub current_sigma: f64,
    /// Pictures for camera odometry, 1/s; 0: no camera.
    pub camera_rate: f64,
    /// Noise of the way between two pictures, m.
    pub camera_sigma: f64,
    /// How late the camera's way comes, s.
    pub camera_latency: f64,
    /// Fixes, 1/s; 0: none.
    pub gnss_rate: f64,
    /// Noise of a fix, m.
    pub gnss_sigma: f64,
    /// How late a fix comes, s.
    pub gnss_latency: f64,
}

impl Default for SensorSettings {
    fn default() -> Self {
        Self {
            rate: 100.0,
            gyro_sigma: 0.003,
            gyro_bias: 0.0005,
            accelerometer_sigma: 0.05,
            joint_sigma: 0.0005,
            current_sigma: 0.01,
            camera_rate: 0.0,
            camera_sigma: 0.002,
            camera_latency: 0.08,
            gnss_rate: 0.0,
            gnss_sigma: 0.02,
            gnss_latency: 0.1,
        }
    }
}

impl SensorSettings {
    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::OutOfRange`].
    pub fn check(&self) -> Result<()> {
        let of = "sensors";
        Error::check(of, "rate", self.rate, (1.0, 1000.0), "Hz")?;
        for (field, value, most, unit) in [
            ("gyro_sigma", self.gyro_sigma, 10.0, "rad/s"),
            ("gyro_bias", self.gyro_bias, 10.0, "rad/s"),
            (
                "accelerometer_sigma",
                self.accelerometer_sigma,
                100.0,
                "m/s^2",
            ),
            ("joint_sigma", self.joint_sigma, 1.0, "rad"),
            ("current_sigma", self.current_sigma, 1.0, "1"),
            ("camera_rate", self.camera_rate, 200.0, "Hz"),
            ("camera_sigma", self.camera_sigma, 10.0, "m"),
            ("camera_latency", self.camera_latency, 2.0, "s"),
            ("gnss_rate", self.gnss_rate, 100.0, "Hz"),
            ("gnss_sigma", self.gnss_sigma, 100.0, "m"),
            ("gnss_latency", self.gnss_latency, 2.0, "s"),
        ] {
            Error::check(of, field, value, (0.0, most), unit)?;
        }
        Ok(())
    }
}
