//! How good the sensors are: one value per line, each with its default.

use grouser_slip::settings::{Field, check_fields};

use crate::error::Result;

/// How good the sensors are.
///
/// ```
/// use grouser_rover::sensors::SensorSettings;
///
/// let mut settings = SensorSettings::default();
/// settings.check()?;
/// settings.rate = f64::NAN;
/// assert!(settings.check().is_err());
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SensorSettings {
    /// Readings of encoders, inertial unit and currents, 1/s.
    pub rate: f64,
    /// Resolution of the clock that stamps each edge of free wheels' encoders, s; 0: they are counted at `rate`.
    pub edge_clock: f64,
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
    /// Readings of every wheel's sinkage, 1/s; 0: no such sensor.
    pub sinkage_rate: f64,
    /// Noise of a sinkage, m a reading.
    pub sinkage_sigma: f64,
    /// Spread of each wheel's constant error of its sinkage, m.
    pub sinkage_bias: f64,
    /// Readings of every wheel's entry angle, 1/s; 0: no such sensor.
    pub entry_angle_rate: f64,
    /// Noise of an entry angle, rad a reading.
    pub entry_angle_sigma: f64,
    /// Spread of each wheel's constant error of its entry angle, rad.
    pub entry_angle_bias: f64,
}

impl Default for SensorSettings {
    fn default() -> Self {
        Self {
            rate: 100.0,
            edge_clock: 0.0,
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
            sinkage_rate: 0.0,
            sinkage_sigma: 0.002,
            sinkage_bias: 0.002,
            entry_angle_rate: 0.0,
            entry_angle_sigma: 0.04,
            entry_angle_bias: 0.04,
        }
    }
}

impl SensorSettings {
    /// Every number of the settings, in the order of the struct.
    pub const FIELDS: &[Field<Self>] = &[
        Row::new("rate", "Hz", (1.0, 1000.0), |s| &mut s.rate).key("rate_hz"),
        Row::new("edge_clock", "s", (0.0, 0.01), |s| &mut s.edge_clock).key("edge_clock_s"),
        Row::new("gyro_sigma", "rad/s", (0.0, 10.0), |s| &mut s.gyro_sigma)
            .key_in_degrees("gyro_sigma_deg_per_s"),
        Row::new("gyro_bias", "rad/s", (0.0, 10.0), |s| &mut s.gyro_bias)
            .key_in_degrees("gyro_bias_deg_per_s"),
        Row::new("accelerometer_sigma", "m/s^2", (0.0, 100.0), |s| {
            &mut s.accelerometer_sigma
        })
        .key("accelerometer_sigma_m_per_s2"),
        Row::new("joint_sigma", "rad", (0.0, 1.0), |s| &mut s.joint_sigma)
            .key_in_degrees("joint_sigma_deg"),
        Row::new("current_sigma", "1", (0.0, 1.0), |s| &mut s.current_sigma).key("current_sigma"),
        Row::new("camera_rate", "Hz", (0.0, 200.0), |s| &mut s.camera_rate).key("camera_rate_hz"),
        Row::new("camera_sigma", "m", (0.0, 10.0), |s| &mut s.camera_sigma).key("camera_sigma_m"),
        Row::new("camera_latency", "s", (0.0, 2.0), |s| &mut s.camera_latency)
            .key("camera_latency_s"),
        Row::new("gnss_rate", "Hz", (0.0, 100.0), |s| &mut s.gnss_rate).key("gnss_rate_hz"),
        Row::new("gnss_sigma", "m", (0.0, 100.0), |s| &mut s.gnss_sigma).key("gnss_sigma_m"),
        Row::new("gnss_latency", "s", (0.0, 2.0), |s| &mut s.gnss_latency).key("gnss_latency_s"),
        Row::new("sinkage_rate", "Hz", (0.0, 1000.0), |s| &mut s.sinkage_rate)
            .key("sinkage_rate_hz"),
        Row::new("sinkage_sigma", "m", (0.0, 1.0), |s| &mut s.sinkage_sigma).key("sinkage_sigma_m"),
        Row::new("sinkage_bias", "m", (0.0, 1.0), |s| &mut s.sinkage_bias).key("sinkage_bias_m"),
        Row::new("entry_angle_rate", "Hz", (0.0, 1000.0), |s| {
            &mut s.entry_angle_rate
        })
        .key("entry_angle_rate_hz"),
        Row::new("entry_angle_sigma", "rad", (0.0, 1.0), |s| {
            &mut s.entry_angle_sigma
        })
        .key_in_degrees("entry_angle_sigma_deg"),
        Row::new("entry_angle_bias", "rad", (0.0, 1.0), |s| {
            &mut s.entry_angle_bias
        })
        .key_in_degrees("entry_angle_bias_deg"),
    ];

    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::Estimator`](crate::Error::Estimator) that names the field.
    pub fn check(&self) -> Result<()> {
        Ok(check_fields("sensors", self, Self::FIELDS)?)
    }
}

type Row = Field<SensorSettings>;
