//! The command line.

use std::path::PathBuf;
use std::time::Duration;

use crate::command::CommandLimits;
use crate::error::{Error, Result};
use crate::transport::Kind;

/// Slip of each wheel of a running ROS 2 robot, with odometry that knows of it; no ROS installation is needed.
///
/// The node listens to the robot's topics, chooses those that measure wheels and motion as `grouser estimate` does for a
/// bag, and publishes /grouser/slip (grouser_msgs/WheelSlip), /grouser/odom (nav_msgs/Odometry), /grouser/twist
/// (geometry_msgs/TwistWithCovarianceStamped), /grouser/events (grouser_msgs/SlipEvent) and /diagnostics.
#[derive(clap::Parser, Debug)]
#[command(
    name = "grouser live",
    bin_name = "grouser live",
    version,
    allow_negative_numbers = true,
    after_help = "Environment: RMW_IMPLEMENTATION selects the transport, ROS_DOMAIN_ID the domain, \
        ZENOH_SESSION_CONFIG_URI the file of Zenoh's session.\n\n\
        Examples:\n  grouser live --robot robot.toml\n  \
        RMW_IMPLEMENTATION=rmw_zenoh_cpp grouser live --robot robot.toml --state learnt.toml --record drive.mcap\n\n\
        Exit codes: 0 done, 1 no slip, 2 bad usage or input, 3 a result with doubts"
)]
pub struct Arguments {
    /// The robot: geometry, sensors, and optionally its topics
    #[arg(long, value_name = "R.toml")]
    pub robot: PathBuf,
    /// The transport [default: by RMW_IMPLEMENTATION]
    #[arg(long, value_enum)]
    pub transport: Option<Kind>,
    /// Namespace of the node and its topics
    #[arg(long, value_name = "NAME", default_value = "/")]
    pub namespace: String,
    /// Frame of the robot in odometry and slip
    #[arg(long, value_name = "FRAME", default_value = "base_link")]
    pub base_frame: String,
    /// Frame in which the odometry begins
    #[arg(long, value_name = "FRAME", default_value = "odom")]
    pub odom_frame: String,
    /// Publish the transform from the odometry's frame to the robot's on /tf
    #[arg(long)]
    pub publish_tf: bool,
    /// Listen for so long before the topics are chosen, s
    #[arg(long, value_name = "SECONDS", default_value_t = 3.0)]
    pub look_s: f64,
    /// Hold messages back for so long to put them in order, ms [default: by the first messages]
    #[arg(long, value_name = "MILLISECONDS")]
    pub hold_ms: Option<f64>,
    /// Keep what is learnt of the sensors in this file: it is read at the start and written at the end
    #[arg(long, value_name = "STATE.toml")]
    pub state: Option<PathBuf>,
    /// Record the messages that are used and published into a new MCAP file
    #[arg(long, value_name = "F.mcap")]
    pub record: Option<PathBuf>,
    /// Limit the commands of this topic (Twist or TwistStamped) by slip, and publish them as --command-out
    #[arg(long, value_name = "TOPIC")]
    pub command: Option<String>,
    /// Where the limited commands are published
    #[arg(
        long,
        value_name = "TOPIC",
        default_value = "grouser/cmd_vel",
        requires = "command"
    )]
    pub command_out: String,
    /// Greatest forward speed of a limited command, m/s
    #[arg(
        long,
        value_name = "SPEED",
        default_value_t = 1.0,
        requires = "command"
    )]
    pub max_speed_m_per_s: f64,
    /// Greatest yaw rate of a limited command, rad/s
    #[arg(long, value_name = "RATE", default_value_t = 1.0, requires = "command")]
    pub max_yaw_rate_rad_per_s: f64,
    /// Greatest acceleration of a rim by limited commands, m/s²
    #[arg(
        long,
        value_name = "ACCELERATION",
        default_value_t = 1.0,
        requires = "command"
    )]
    pub max_acceleration_m_per_s2: f64,
    /// The slip to which commands are limited
    #[arg(long, value_name = "SLIP", default_value_t = 0.3, requires = "command")]
    pub running_slip: f64,
    /// Commands or sensors that are silent for so long stop the robot, s
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 0.5,
        requires = "command"
    )]
    pub command_timeout_s: f64,
    /// End after so long, s [default: at Ctrl-C]
    #[arg(long, value_name = "SECONDS")]
    pub duration_s: Option<f64>,
    /// Show wheels, events and latencies on the terminal; `q` ends the node
    #[arg(long, conflicts_with = "quiet")]
    pub screen: bool,
    /// Print nothing but warnings
    #[arg(long, short)]
    pub quiet: bool,
}

/// Longest times that are accepted, s.
const MAX_TIME_S: f64 = 1e9;
const MAX_LOOK_S: f64 = 600.0;
const MAX_HOLD_S: f64 = 2.0;
/// Limits of the limits of commands. The controller's rims run at most at 20 m/s; an estimate may be 0.1 s old.
const SPEED_LIMITS_M_PER_S: (f64, f64) = (0.01, 10.0);
const YAW_RATE_LIMITS_RAD_PER_S: (f64, f64) = (0.01, 10.0);
const ACCELERATION_LIMITS_M_PER_S2: (f64, f64) = (0.01, 100.0);
const SLIP_LIMITS: (f64, f64) = (0.01, 0.95);
const TIMEOUT_LIMITS_S: (f64, f64) = (0.15, 10.0);

impl Arguments {
    /// How long the node listens before it chooses the topics.
    ///
    /// # Errors
    /// [`Error::Option`].
    pub fn look(&self) -> Result<Duration> {
        seconds("--look-s", self.look_s, 1.0, MAX_LOOK_S, "s")
    }

    /// How long messages are held back, where that is chosen.
    ///
    /// # Errors
    /// [`Error::Option`].
    pub fn hold(&self) -> Result<Option<Duration>> {
        let hold = self
            .hold_ms
            .map(|ms| seconds("--hold-ms", ms, 1e-3, MAX_HOLD_S, "ms"));
        hold.transpose()
    }

    /// The full name of a topic that an option names: with a slash it is one already.
    ///
    /// # Errors
    /// [`Error::Option`] for another character than letters, digits, `_` and `/`.
    pub(crate) fn topic(&self, option: &'static str, name: &str) -> Result<String> {
        let bare = name.strip_prefix('/').unwrap_or(name);
        if bare.is_empty() || bare.ends_with('/') || !is_name(bare) {
            return Err(Error::Option {
                name: option,
                value: name.to_owned(),
                wanted: "letters, digits, `_` and `/`".to_owned(),
            });
        }
        if name.starts_with('/') {
            Ok(name.to_owned())
        } else {
            self.full_name(name)
        }
    }

    /// What commands are limited to.
    ///
    /// # Errors
    /// [`Error::Option`].
    pub(crate) fn command_limits(&self) -> Result<CommandLimits> {
        let range = |name, value: f64, (low, high): (f64, f64), unit: &str| {
            if (low..=high).contains(&value) {
                Ok(value)
            } else {
                Err(Error::Option {
                    name,
                    value: value.to_string(),
                    wanted: format!("from {low} to {high} {unit}"),
                })
            }
        };
        let timeout_s = range(
            "--command-timeout-s",
            self.command_timeout_s,
            TIMEOUT_LIMITS_S,
            "s",
        )?;
        Ok(CommandLimits {
            max_speed: range(
                "--max-speed-m-per-s",
                self.max_speed_m_per_s,
                SPEED_LIMITS_M_PER_S,
                "m/s",
            )?,
            max_yaw_rate: range(
                "--max-yaw-rate-rad-per-s",
                self.max_yaw_rate_rad_per_s,
                YAW_RATE_LIMITS_RAD_PER_S,
                "rad/s",
            )?,
            max_acceleration: range(
                "--max-acceleration-m-per-s2",
                self.max_acceleration_m_per_s2,
                ACCELERATION_LIMITS_M_PER_S2,
                "m/s²",
            )?,
            slip: range("--running-slip", self.running_slip, SLIP_LIMITS, "")?,
            timeout: Duration::from_secs_f64(timeout_s),
        })
    }

    /// When the node ends, where that is chosen.
    ///
    /// # Errors
    /// [`Error::Option`].
    pub fn duration(&self) -> Result<Option<Duration>> {
        let duration = self
            .duration_s
            .map(|s| seconds("--duration-s", s, 1.0, MAX_TIME_S, "s"));
        duration.transpose()
    }

    /// A name below the namespace, with its slash.
    ///
    /// # Errors
    /// [`Error::Option`] for a namespace with other characters than letters, digits, `_` and `/`.
    pub fn full_name(&self, name: &str) -> Result<String> {
        let namespace = self.namespace.trim_matches('/');
        if !is_name(namespace) {
            return Err(Error::Option {
                name: "--namespace",
                value: self.namespace.clone(),
                wanted: "letters, digits, `_` and `/`".to_owned(),
            });
        }
        Ok(if namespace.is_empty() {
            format!("/{name}")
        } else {
            format!("/{namespace}/{name}")
        })
    }
}

/// Parts of letters, digits and `_` between single slashes, or nothing.
fn is_name(name: &str) -> bool {
    let is_legal = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '/';
    name.chars().all(is_legal) && !name.contains("//")
}

fn seconds(
    name: &'static str,
    value: f64,
    scale: f64,
    limit_s: f64,
    unit: &str,
) -> Result<Duration> {
    let time_s = value * scale;
    if !(0.0..=limit_s).contains(&time_s) {
        return Err(Error::Option {
            name,
            value: value.to_string(),
            wanted: format!("from 0 to {} {unit}", limit_s / scale),
        });
    }
    Ok(Duration::from_secs_f64(time_s))
}
