//! How the controller works: one value per line, each with its default.

use grouser_terra::EARTH_GRAVITY_M_PER_S2;

use crate::error::{Result, check_range};
use crate::settings::{Field, check_fields};

/// What the controller decides by itself.
///
/// ```
/// use grouser_slip::control::{ControlSettings, Decides};
///
/// assert_eq!(ControlSettings::default().decides, Decides::Everything);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Decides {
    /// Nothing: it drives as requested.
    Nothing,
    /// It ends the drive where the sensors fall silent or the robot leans too far, and changes no direction.
    Stops,
    /// It also backs out of ground that is softer than the known soil or holds the robot, and goes on as requested: what
    /// requests can plan another way meanwhile, as long as it takes. A robot that cannot back out ends the drive.
    BacksOut,
    /// It also traverses, makes detours, and ends a drive without progress.
    #[default]
    Everything,
}

/// How the controller works.
///
/// ```
/// use grouser_slip::control::ControlSettings;
///
/// let mut settings = ControlSettings::default();
/// settings.check()?;
/// settings.optimum = f64::NAN;
/// assert!(settings.check().is_err());
/// # Ok::<(), grouser_slip::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ControlSettings {
    /// The slip setpoint, s_opt: the slip of greatest tractive efficiency, from the running-slip problem of the
    /// optimiser. It is neither the slip of greatest pull (`curve` prints both) nor the slip that the 2012 paper's
    /// minimax problem optimises, which is no slip setpoint.
    pub optimum: f64,
    /// Gain of the slip error, k_p.
    pub gain: f64,
    /// Gain of its integral, k_i, 1/s.
    pub integral_gain: f64,
    /// A slip whose sigma is this counts half.
    pub sigma_half: f64,
    /// Greatest acceleration of a rim's setpoint, m/s².
    pub max_acceleration: f64,
    /// No rim runs faster than this, m/s, whatever is requested and however much it slips.
    pub max_rim_speed: f64,
    /// Rims run at least at this share of the requested speed while the drive goes on, those too whose slip stays unknown.
    pub creep: f64,
    /// The same on level ground and backwards, where a slow wheel does not dig.
    pub crawl: f64,
    /// How fast the feedforward of slip follows, 1/s.
    pub feedforward_gain: f64,
    /// Greatest feedforward: the share by which rims run faster than the robot is to travel.
    pub max_feedforward: f64,
    /// Greatest torque over load and radius of a wheel: the traction that the ground may give, 1.
    pub max_traction: f64,
    /// Does the slip limit the rims' speed? Otherwise the controller holds speed and heading only.
    pub limits_slip: bool,
    /// What the controller decides by itself.
    pub decides: Decides,
    /// Slip above which a change of direction is considered ...
    pub high_slip: f64,
    /// ... once it has lasted this long, s.
    pub high_slip_time: f64,
    /// Slip above which the robot digs in ...
    pub dig_slip: f64,
    /// ... once it has lasted this long, s.
    pub dig_time: f64,
    /// Slip above what the known soil demands, and above two sigma of it, from which the ground counts as softer ...
    pub soft_slip: f64,
    /// Firmness below which it does as well ...
    pub soft_firmness: f64,
    /// ... once it has lasted this long, s.
    pub soft_time: f64,
    /// How far to back out of soft ground, m.
    pub soft_back: f64,
    /// How far to move aside before it is passed, m: further with every try.
    pub soft_across: f64,
    /// A robot slower than this share of its rims' speed and of the requested speed is stuck.
    pub stuck_share: f64,
    /// Slope from which traversing can help, rad.
    pub steep: f64,
    /// Slope below which a traverse ends, rad: the hysteresis against `steep`.
    pub level: f64,
    /// First angle of a traverse to the requested heading, rad; each further attempt adds a quarter of it.
    pub traverse_angle: f64,
    /// Length of one leg of a traverse, m.
    pub traverse_length: f64,
    /// How far to back out, m.
    pub back_length: f64,
    /// Speed of backing out over the requested one.
    pub back_speed: f64,
    /// The drive ends after this many attempts without progress.
    pub max_attempts: u32,
    /// Progress after which attempts are counted anew, m.
    pub progress: f64,
    /// Tilt at which the drive ends, rad.
    pub max_tilt: f64,
    /// The robot stops once it has had no usable slip or speed for longer than this, s.
    pub blind_time: f64,
    /// Turning rate per heading error, 1/s.
    pub turn_gain: f64,
    /// Greatest turning rate, rad/s.
    pub max_turn: f64,
}

impl Default for ControlSettings {
    fn default() -> Self {
        Self {
            optimum: 0.3,
            gain: 0.3,
            integral_gain: 0.3,
            sigma_half: 0.1,
            max_acceleration: 0.5,
            max_rim_speed: 20.0,
            creep: 0.6,
            crawl: 0.15,
            feedforward_gain: 2.0,
            max_feedforward: 4.0,
            max_traction: 0.8,
            limits_slip: true,
            decides: Decides::Everything,
            high_slip: 0.5,
            high_slip_time: 2.0,
            dig_slip: 0.8,
            dig_time: 1.0,
            soft_slip: 0.12,
            soft_firmness: 0.65,
            soft_time: 0.3,
            soft_back: 1.0,
            soft_across: 2.2,
            stuck_share: 0.1,
            steep: 0.09,
            level: 0.05,
            traverse_angle: 0.8,
            traverse_length: 3.0,
            back_length: 0.8,
            back_speed: 0.7,
            max_attempts: 5,
            progress: 1.5,
            max_tilt: 0.61,
            blind_time: 1.0,
            turn_gain: 0.8,
            max_turn: 0.4,
        }
    }
}

impl ControlSettings {
    /// The defaults where gravity is `gravity` (m/s²): a change of speed takes the same share of a wheel's traction everywhere, so
    /// that starts on the Moon do not slip by half.
    ///
    /// ```
    /// use grouser_slip::control::ControlSettings;
    ///
    /// assert!((ControlSettings::under_gravity(1.62).max_acceleration - 0.0826).abs() < 1e-4);
    /// ```
    #[must_use]
    pub fn under_gravity(gravity: f64) -> Self {
        let usual = Self::default();
        Self {
            max_acceleration: usual.max_acceleration * gravity / EARTH_GRAVITY_M_PER_S2,
            ..usual
        }
    }

    /// Every number of the settings, in the order of the struct.
    pub const FIELDS: &[Field<Self>] = &[
        Row::new("optimum", "1", (0.01, 0.95), |s| &mut s.optimum),
        Row::new("gain", "1", GAIN, |s| &mut s.gain).key("gain"),
        Row::new("integral_gain", "1/s", GAIN, |s| &mut s.integral_gain).key("integral_gain"),
        Row::new("sigma_half", "1", (1e-6, 10.0), |s| &mut s.sigma_half).key("sigma_half"),
        Row::new("max_acceleration", "m/s^2", (1e-3, 100.0), |s| {
            &mut s.max_acceleration
        })
        .key("most_acceleration_m_per_s2"),
        Row::new("max_rim_speed", "m/s", (1e-3, 1e3), |s| {
            &mut s.max_rim_speed
        })
        .key("max_rim_speed_m_per_s"),
        Row::new("creep", "1", SHARE, |s| &mut s.creep).key("creep"),
        Row::new("crawl", "1", SHARE, |s| &mut s.crawl),
        Row::new("feedforward_gain", "1/s", GAIN, |s| &mut s.feedforward_gain).key("cruise_gain"),
        Row::new("max_feedforward", "1", GAIN, |s| &mut s.max_feedforward).key("most_cruise"),
        Row::new("max_traction", "1", (0.01, 10.0), |s| &mut s.max_traction).key("most_traction"),
        Row::new("high_slip", "1", SHARE, |s| &mut s.high_slip).key("high_slip"),
        Row::new("high_slip_time", "s", TIME, |s| &mut s.high_slip_time).key("high_slip_time_s"),
        Row::new("dig_slip", "1", SHARE, |s| &mut s.dig_slip).key("dig_slip"),
        Row::new("dig_time", "s", TIME, |s| &mut s.dig_time).key("dig_time_s"),
        Row::new("soft_slip", "1", SHARE, |s| &mut s.soft_slip),
        Row::new("soft_firmness", "1", SHARE, |s| &mut s.soft_firmness),
        Row::new("soft_time", "s", TIME, |s| &mut s.soft_time),
        Row::new("soft_back", "m", LENGTH, |s| &mut s.soft_back),
        Row::new("soft_across", "m", LENGTH, |s| &mut s.soft_across),
        Row::new("stuck_share", "1", SHARE, |s| &mut s.stuck_share),
        Row::new("steep", "rad", ANGLE, |s| &mut s.steep).key_in_degrees("steep_deg"),
        Row::new("level", "rad", ANGLE, |s| &mut s.level).key_in_degrees("level_deg"),
        Row::new("traverse_angle", "rad", ANGLE, |s| &mut s.traverse_angle)
            .key_in_degrees("traverse_angle_deg"),
        Row::new("traverse_length", "m", LENGTH, |s| &mut s.traverse_length)
            .key("traverse_length_m"),
        Row::new("back_length", "m", LENGTH, |s| &mut s.back_length).key("back_length_m"),
        Row::new("back_speed", "1", (0.01, 10.0), |s| &mut s.back_speed),
        Row::new("progress", "m", LENGTH, |s| &mut s.progress).key("progress_m"),
        Row::new("max_tilt", "rad", ANGLE, |s| &mut s.max_tilt).key_in_degrees("most_tilt_deg"),
        Row::new("blind_time", "s", (1e-3, 1e3), |s| &mut s.blind_time).key("blind_time_s"),
        Row::new("turn_gain", "1/s", GAIN, |s| &mut s.turn_gain),
        Row::new("max_turn", "rad/s", (1e-3, 100.0), |s| &mut s.max_turn)
            .key_in_degrees("most_turn_deg_per_s"),
    ];

    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) that names the field.
    pub fn check(&self) -> Result<()> {
        check_fields("controller", self, Self::FIELDS)?;
        check_range("controller", "level", self.level, (0.0, self.steep), "rad")
    }
}

type Row = Field<ControlSettings>;

/// Limits of a share.
const SHARE: (f64, f64) = (0.0, 1.0);
/// Limits of a gain.
const GAIN: (f64, f64) = (0.0, 100.0);
/// Limits of an angle, rad.
const ANGLE: (f64, f64) = (0.0, core::f64::consts::FRAC_PI_2);
/// Limits of a time, s.
const TIME: (f64, f64) = (0.0, 1e3);
/// Limits of a length, m.
const LENGTH: (f64, f64) = (1e-3, 1e4);
