//! How the controller works: one value per line, each with its default.

use crate::error::{Result, check_range};

/// How the controller works.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ControlSettings {
    /// The slip to run at, s_opt: from the running-slip problem of the optimiser.
    pub optimum: f64,
    /// Gain of the slip error, k_p.
    pub gain: f64,
    /// Gain of its integral, k_i, 1/s.
    pub integral_gain: f64,
    /// A slip whose sigma is this counts half.
    pub sigma_half: f64,
    /// How fast a rim's order may change, m/s².
    pub max_acceleration: f64,
    /// Rims run at least at this share of the asked speed while the drive goes on.
    pub creep: f64,
    /// The same on level ground and backwards, where a wheel that waits for the robot does not dig.
    pub crawl: f64,
    /// How fast the cruise share follows, 1/s.
    pub feedforward_gain: f64,
    /// Greatest cruise share.
    pub max_feedforward: f64,
    /// Greatest torque over load and radius of a wheel: the traction that the ground may give.
    pub max_traction: f64,
    /// Does the slip limit the rims' speed? Without, it holds speed and heading only.
    pub limits_slip: bool,
    /// May it change direction and end the drive by itself?
    pub decides: bool,
    /// Slip above which a change of direction is considered ...
    pub high_slip: f64,
    /// ... once it has lasted this long, s.
    pub high_slip_time: f64,
    /// Slip above which the robot digs in ...
    pub dig_slip: f64,
    /// ... once it has lasted this long, s.
    pub dig_time: f64,
    /// Slip above what the known soil demands, and above three sigma of it, from which the ground counts as softer ...
    pub soft_slip: f64,
    /// Firmness below which it does as well ...
    pub soft_firmness: f64,
    /// ... once it has lasted this long, s.
    pub soft_time: f64,
    /// How far to go back from soft ground, m.
    pub soft_back: f64,
    /// How far to go across before it is passed, m: further with every try.
    pub soft_across: f64,
    /// A robot slower than this share of its rims' speed and of the asked speed is stuck.
    pub stuck_share: f64,
    /// Slope from which traversing can help, rad.
    pub steep: f64,
    /// Slope below which a traverse ends, rad: the hysteresis against `steep`.
    pub level: f64,
    /// First angle of a traverse against the asked heading, rad; each further try adds half of it.
    pub traverse_angle: f64,
    /// Length of one board of a traverse, m.
    pub traverse_length: f64,
    /// How far to back out, m.
    pub back_length: f64,
    /// Speed of backing out over the asked one.
    pub back_speed: f64,
    /// After this many times of backing out without progress the drive ends.
    pub max_attempts: u32,
    /// Progress that wipes out former attempts, m.
    pub progress: f64,
    /// Tilt at which the drive ends, rad.
    pub max_tilt: f64,
    /// Without slip or speed for longer than this the robot stops, s.
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
            creep: 0.6,
            crawl: 0.15,
            feedforward_gain: 2.0,
            max_feedforward: 4.0,
            max_traction: 0.8,
            limits_slip: true,
            decides: true,
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
    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) that names the field.
    pub fn check(&self) -> Result<()> {
        let of = "controller";
        let share = (0.0, 1.0);
        let gain = (0.0, 100.0);
        let angle = (0.0, core::f64::consts::FRAC_PI_2);
        let time = (0.0, 1e3);
        check_range(of, "optimum", self.optimum, (0.01, 0.95), "1")?;
        check_range(of, "gain", self.gain, gain, "1")?;
        check_range(of, "integral_gain", self.integral_gain, gain, "1/s")?;
        check_range(of, "sigma_half", self.sigma_half, (1e-6, 10.0), "1")?;
        let acceleration = self.max_acceleration;
        check_range(of, "max_acceleration", acceleration, (1e-3, 100.0), "m/s^2")?;
        check_range(of, "creep", self.creep, share, "1")?;
        check_range(of, "crawl", self.crawl, share, "1")?;
        check_range(of, "feedforward_gain", self.feedforward_gain, gain, "1/s")?;
        check_range(of, "max_feedforward", self.max_feedforward, gain, "1")?;
        check_range(of, "max_traction", self.max_traction, (0.01, 10.0), "1")?;
        check_range(of, "high_slip", self.high_slip, share, "1")?;
        check_range(of, "high_slip_time", self.high_slip_time, time, "s")?;
        check_range(of, "dig_slip", self.dig_slip, share, "1")?;
        check_range(of, "dig_time", self.dig_time, time, "s")?;
        check_range(of, "soft_slip", self.soft_slip, share, "1")?;
        check_range(of, "soft_firmness", self.soft_firmness, share, "1")?;
        check_range(of, "soft_time", self.soft_time, time, "s")?;
        check_range(of, "soft_back", self.soft_back, (1e-3, 1e4), "m")?;
        check_range(of, "soft_across", self.soft_across, (1e-3, 1e4), "m")?;
        check_range(of, "stuck_share", self.stuck_share, share, "1")?;
        check_range(of, "steep", self.steep, angle, "rad")?;
        check_range(of, "level", self.level, (0.0, self.steep), "rad")?;
        check_range(of, "traverse_angle", self.traverse_angle, angle, "rad")?;
        let length = (1e-3, 1e4);
        check_range(of, "traverse_length", self.traverse_length, length, "m")?;
        check_range(of, "back_length", self.back_length, length, "m")?;
        check_range(of, "back_speed", self.back_speed, (0.01, 10.0), "1")?;
        check_range(of, "progress", self.progress, length, "m")?;
        check_range(of, "max_tilt", self.max_tilt, angle, "rad")?;
        check_range(of, "blind_time", self.blind_time, (1e-3, 1e3), "s")?;
        check_range(of, "turn_gain", self.turn_gain, gain, "1/s")?;
        check_range(of, "max_turn", self.max_turn, (1e-3, 100.0), "rad/s")
    }
}
