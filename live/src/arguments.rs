//! The command line.

use std::path::PathBuf;
use std::time::Duration;

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
    /// End after so long, s [default: at Ctrl-C]
    #[arg(long, value_name = "SECONDS")]
    pub duration_s: Option<f64>,
    /// Print nothing but warnings
    #[arg(long, short)]
    pub quiet: bool,
}

/// Longest times that are accepted, s.
const MAX_TIME_S: f64 = 1e9;
const MAX_LOOK_S: f64 = 600.0;
const MAX_HOLD_S: f64 = 2.0;

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
        let is_legal = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '/';
        if !namespace.chars().all(is_legal) || namespace.contains("//") {
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
