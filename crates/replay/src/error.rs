//! Why a log gives no slip.

/// The result of a replay.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a log gives no slip.
///
/// ```
/// let error = grouser_replay::Error::NoTicks { wheel: "left".into() };
/// assert!(error.to_string().contains("`ticks_per_turn`"));
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The log cannot be read.
    #[error(transparent)]
    Log(#[from] grouser_log::Error),
    /// A file beside it cannot be read.
    #[error(transparent)]
    File(#[from] grouser_files::Error),
    /// The settings cannot be used.
    #[error(transparent)]
    Settings(#[from] grouser_slip::Error),
    /// The column map names a wheel that the robot does not have.
    #[error("the column map names wheel `{wheel}`, which robot `{robot}` does not have")]
    UnknownWheel {
        /// The wheel.
        wheel: String,
        /// The robot.
        robot: String,
        /// The wheel that was probably meant.
        meant: Option<String>,
    },
    /// The log measures none of the robot's powered wheels.
    #[error("the log measures no powered wheel of robot `{robot}`")]
    NoWheels {
        /// The robot.
        robot: String,
        /// Is the log of tables alone?
        is_of_tables: bool,
    },
    /// A powered wheel of the robot is not measured.
    #[error("the log does not measure wheel `{wheel}` by {sensor}")]
    WheelNotMeasured {
        /// The wheel.
        wheel: String,
        /// The sensor that was chosen for all wheels.
        sensor: &'static str,
    },
    /// The chosen reference is not in the log.
    #[error("reference `{reference}` needs {needs}, which the log does not hold")]
    NoReference {
        /// The reference.
        reference: &'static str,
        /// What it needs.
        needs: &'static str,
    },
    /// A key of the robot file that changes nothing of this log.
    #[error("`{key}` of the robot file has no effect on reference `{reference}` of this log")]
    NoEffect {
        /// The key.
        key: &'static str,
        /// The reference.
        reference: &'static str,
    },
    /// Counts without a number of ticks per turn.
    #[error("wheel `{wheel}` is measured by counts, but its description has no `ticks_per_turn`")]
    NoTicks {
        /// The wheel.
        wheel: String,
    },
    /// The soil model needs the wheel's size and load.
    #[error("wheel `{wheel}` has no `{key}` in the robot file, which the soil model needs")]
    NoWheelSize {
        /// The wheel.
        wheel: String,
        /// The key that is missing.
        key: &'static str,
    },
    /// The soil model refuses the wheel or the soil.
    #[error(transparent)]
    Soil(#[from] grouser_terra::Error),
    /// Two ways that give no radius.
    #[error(
        "{travel_reference} m by the reference over {travel_wheels} m by the wheels gives no \
             effective radius: the ratio must lie in (0.2, 5)"
    )]
    NoCalibration {
        /// Way by the reference, m.
        travel_reference: f64,
        /// Way by the wheels, m.
        travel_wheels: f64,
    },
    /// Too few runs to calibrate intervals.
    #[error(
        "{runs} runs with slips and a reference: at least {needed} are needed to calibrate intervals"
    )]
    TooFewRuns {
        /// How many there are.
        runs: usize,
        /// How many are needed.
        needed: usize,
    },
    /// A source of true slips that holds none.
    #[error("{source_name}: holds no slip of a wheel of the robot")]
    NoTruth {
        /// The table or the topic.
        source_name: String,
    },
    /// Whoever takes the rows cannot.
    #[error(transparent)]
    Sink(#[from] std::io::Error),
}

impl Error {
    /// What to do about it, where that is known.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::Log(error) => error.hint(),
            Self::File(error) => error.hint(),
            Self::NoTruth { .. } => Some(
                "a table has `time_s` and `NAME_slip` of each wheel; a topic is grouser_msgs/WheelSlip"
                    .into(),
            ),
            Self::NoEffect { .. } => Some(
                "`reference_x_m`, `reference_y_m` and `pose_yaw_offset_deg` are of poses, displacements and speeds, whose position \
                 needs a yaw rate or a turn and whose yaw needs a direction; `reference_z_m` needs `[chassis]` and all axes of an \
                 inertial unit; positions without a heading have `antenna_x_m` and `antenna_y_m` in `[topics]`"
                    .into(),
            ),
            Self::NoReference {
                reference: "any", ..
            } => Some(
                "log a pose, a speed over ground or a free wheel as well; a gyro alone shows how the wheels differ"
                    .into(),
            ),
            Self::NoWheels {
                is_of_tables: true, ..
            } => Some(
                "`meaning` and `wheel` of a column in the column map make it a wheel's: `wheel_count`, `wheel_angle`, \
                 `wheel_distance` (an odometer), `wheel_rate` or `wheel_speed`; `grouser log info LOG --suggest-robot` proposes \
                 them"
                    .into(),
            ),
            Self::NoWheels { .. } => Some(
                "wheels are the joints of a sensor_msgs/JointState or grouser_msgs/WheelTicks (`joint` of a `[[wheel]]` names \
                 its joint), numbers of other messages that `[[topics.field]]` names, or columns that the column map names"
                    .into(),
            ),
            Self::UnknownWheel {
                meant: Some(meant), ..
            } => Some(format!("did you mean `{meant}`?")),
            _ => None,
        }
    }
}
