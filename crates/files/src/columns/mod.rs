//! Column maps: what the columns of a CSV log mean.
//!
//! ```toml
//! format = 1
//!
//! [[table]]
//! file = "*joint_states*"      # which of several files; absent: every file
//! separator = ","              # one character, or "tab"
//! header_lines = 1             # lines before the data; 0: the columns are named by their numbers, "1" for the first
//! names_line = 1               # which of them names the columns
//! decimal = "."                # or ","
//! missing = ["nan"]            # what stands for "no value", besides an empty field
//! time = { column = "stamp", unit = "ns" }   # s, ms, us, ns, or "date" for 2026-03-02T09:15:30.25Z
//! # time = { column = "sec", unit = "s", nanoseconds = "nanosec" }  # and a column of the nanoseconds beyond it
//! columns = [
//!     { column = "left",  meaning = "wheel_angle", wheel = "left",  unit = "rad" },
//!     { column = "right", meaning = "wheel_angle", wheel = "right", unit = "rad" },
//! ]
//! ```

mod check;
mod write;

use std::path::Path;

use grouser_slip::Reference;

use crate::document::Document;
use crate::error::{Error, Result};
use crate::section::Section;
use crate::unit::Quantity;

use check::check_columns;
pub(crate) use check::check_together;
pub use write::to_toml;
pub(crate) use write::{meaning, write_table};

/// The maximum number of lines before the data.
const MAX_HEADER_LINES: i64 = 1000;

/// What a column means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Meaning {
    /// A wheel's tick counter.
    WheelCount,
    /// The angle of a wheel's sensor shaft.
    WheelAngle,
    /// The way of a wheel's rim since some start, as odometers count it; [`Self::WheelAngle`] by the wheel's radius.
    WheelDistance,
    /// The rate of a wheel's sensor shaft.
    WheelRate,
    /// The speed of a wheel's rim; [`Self::WheelRate`] by the wheel's radius.
    WheelSpeed,
    /// Torque on a wheel, positive when it drives forwards.
    WheelTorque,
    /// Current of a wheel's motor, positive when it drives forwards; [`Self::WheelTorque`] by `torque_per_ampere_nm` of the
    /// robot file.
    MotorCurrent,
    /// How deep the lowest point of a wheel lies below the ground in front of it.
    Sinkage,
    /// The angle at which the ground in front of a wheel meets its rim, from the lowest point forwards.
    EntryAngle,
    /// Angle by which a wheel is steered, to the left.
    WheelSteering,
    /// Angle of the robot's steering as a whole, to the left: see `[steering]` of the robot file.
    SteeringAngle,
    /// The robot's yaw rate.
    YawRate,
    /// What an accelerometer feels forwards, gravity's share on a slope included.
    AccelerationForward,
    /// What it feels to the left.
    AccelerationLeft,
    /// Way forwards since the row before, in the robot's frame; [`Column::frame`] has which.
    DisplacementForward,
    /// Way to the left since the row before.
    DisplacementLeft,
    /// Turn to the left since the row before.
    DisplacementTurn,
    /// Position in a fixed frame.
    PoseX,
    /// Position in a fixed frame.
    PoseY,
    /// Yaw angle in a fixed frame.
    PoseYaw,
    /// Part x of the quaternion that turns the robot's frame to the fixed one; 0 where it is not there.
    OrientationX,
    /// Part y of it; 0 where it is not there.
    OrientationY,
    /// Part z of it.
    OrientationZ,
    /// Its real part.
    OrientationW,
    /// Speed over ground forwards.
    SpeedForward,
    /// Speed over ground to the left.
    SpeedLeft,
    /// Size of the speed over ground, as satellite receivers state it: its sign is that of the wheels.
    SpeedSize,
    /// Commanded speed forwards.
    CommandForward,
    /// Commanded speed to the left.
    CommandLeft,
    /// Latitude of a satellite receiver's fix, to the north (WGS 84).
    Latitude,
    /// Its longitude, to the east.
    Longitude,
    /// Its altitude.
    Altitude,
    /// The kind of its solution: 0 or less without a position.
    FixType,
    /// Its status as in `sensor_msgs/NavSatFix`: below 0 without a position, 1 with augmentation, 2 with a ground station.
    FixStatus,
    /// The horizontal standard deviation of its position; 0: not known.
    FixSigma,
}

impl Meaning {
    /// Every meaning: its name in files, and what it measures.
    pub const ALL: [(&'static str, Self, Quantity); 35] = [
        ("wheel_count", Self::WheelCount, Quantity::Ticks),
        ("wheel_angle", Self::WheelAngle, Quantity::Angle),
        ("wheel_distance", Self::WheelDistance, Quantity::Length),
        ("wheel_rate", Self::WheelRate, Quantity::AngularRate),
        ("wheel_speed", Self::WheelSpeed, Quantity::Speed),
        ("wheel_torque", Self::WheelTorque, Quantity::Torque),
        ("motor_current", Self::MotorCurrent, Quantity::Current),
        ("sinkage", Self::Sinkage, Quantity::Length),
        ("entry_angle", Self::EntryAngle, Quantity::Angle),
        ("wheel_steering", Self::WheelSteering, Quantity::Angle),
        ("steering_angle", Self::SteeringAngle, Quantity::Angle),
        ("yaw_rate", Self::YawRate, Quantity::AngularRate),
        (
            "acceleration_forward",
            Self::AccelerationForward,
            Quantity::Acceleration,
        ),
        (
            "acceleration_left",
            Self::AccelerationLeft,
            Quantity::Acceleration,
        ),
        (
            "displacement_forward",
            Self::DisplacementForward,
            Quantity::Length,
        ),
        (
            "displacement_left",
            Self::DisplacementLeft,
            Quantity::Length,
        ),
        ("displacement_turn", Self::DisplacementTurn, Quantity::Angle),
        ("pose_x", Self::PoseX, Quantity::Length),
        ("pose_y", Self::PoseY, Quantity::Length),
        ("pose_yaw", Self::PoseYaw, Quantity::Angle),
        ("orientation_x", Self::OrientationX, Quantity::Number),
        ("orientation_y", Self::OrientationY, Quantity::Number),
        ("orientation_z", Self::OrientationZ, Quantity::Number),
        ("orientation_w", Self::OrientationW, Quantity::Number),
        ("speed_forward", Self::SpeedForward, Quantity::Speed),
        ("speed_left", Self::SpeedLeft, Quantity::Speed),
        ("speed_size", Self::SpeedSize, Quantity::Speed),
        ("command_forward", Self::CommandForward, Quantity::Speed),
        ("command_left", Self::CommandLeft, Quantity::Speed),
        ("latitude", Self::Latitude, Quantity::Angle),
        ("longitude", Self::Longitude, Quantity::Angle),
        ("altitude", Self::Altitude, Quantity::Length),
        ("fix_type", Self::FixType, Quantity::Number),
        ("fix_status", Self::FixStatus, Quantity::Number),
        ("fix_sigma", Self::FixSigma, Quantity::Length),
    ];

    /// Does it belong to one wheel?
    #[must_use]
    pub const fn is_of_a_wheel(self) -> bool {
        matches!(
            self,
            Self::WheelCount
                | Self::WheelAngle
                | Self::WheelDistance
                | Self::WheelRate
                | Self::WheelSpeed
                | Self::WheelTorque
                | Self::MotorCurrent
                | Self::Sinkage
                | Self::EntryAngle
                | Self::WheelSteering
        )
    }

    /// The meaning that readings have once radius and motor of the wheel are known.
    const fn reading(self) -> Self {
        match self {
            Self::WheelDistance => Self::WheelAngle,
            Self::WheelSpeed => Self::WheelRate,
            Self::MotorCurrent => Self::WheelTorque,
            other => other,
        }
    }

    /// The reference that it is, with those that it needs.
    #[must_use]
    pub const fn reference(self) -> Option<Reference> {
        match self {
            Self::DisplacementForward => Some(Reference::Displacement),
            Self::PoseX => Some(Reference::Pose),
            Self::SpeedForward | Self::SpeedSize => Some(Reference::Speed),
            _ => None,
        }
    }

    /// The meanings without which this one says nothing.
    #[must_use]
    pub const fn needs(self) -> &'static [Self] {
        match self {
            Self::DisplacementLeft | Self::DisplacementTurn => &[Self::DisplacementForward],
            Self::PoseY | Self::PoseYaw => &[Self::PoseX],
            Self::OrientationX | Self::OrientationY | Self::OrientationW => &[Self::OrientationZ],
            Self::OrientationZ => &[Self::PoseX, Self::OrientationW],
            Self::SpeedLeft => &[Self::SpeedForward],
            Self::CommandLeft => &[Self::CommandForward],
            Self::AccelerationLeft => &[Self::AccelerationForward],
            Self::DisplacementForward => &[Self::DisplacementLeft],
            Self::PoseX => &[Self::PoseY],
            Self::Latitude => &[Self::Longitude],
            Self::Longitude | Self::Altitude | Self::FixType | Self::FixStatus | Self::FixSigma => {
                &[Self::Latitude]
            }
            _ => &[],
        }
    }

    /// Is it a yaw angle, or the part of a quaternion that has it?
    #[must_use]
    pub const fn is_heading(self) -> bool {
        matches!(self, Self::PoseYaw | Self::OrientationZ)
    }

    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|(_, meaning, _)| *meaning == self)
            .map_or("", |(name, _, _)| name)
    }
}

/// One column that is read.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name in the file.
    pub column: String,
    /// What it means.
    pub meaning: Meaning,
    /// The wheel it belongs to.
    pub wheel: Option<String>,
    /// What one of it is in SI.
    pub factor: f64,
    /// What is added in SI: a sinkage by a sensor that measures its distance from the ground.
    pub offset: f64,
    /// The frame in which a displacement is stated; [`Frame::Halfway`] of all other columns.
    pub frame: Frame,
    /// May a table lack it? Of sinkages and entry angles, which no slip needs.
    pub is_optional: bool,
}

/// The robot's frame in which a displacement is stated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Frame {
    /// That of halfway between the row before and this one.
    #[default]
    Halfway,
    /// That of the row before, as in the pose of this row relative to that one.
    Previous,
}

impl Frame {
    /// Every frame with its name in files.
    pub const NAMES: [(&'static str, Self); 2] =
        [("halfway", Self::Halfway), ("previous", Self::Previous)];
}

/// The column of time.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeColumn {
    /// Its name in the file.
    pub column: String,
    /// Its unit.
    pub unit: TimeUnit,
    /// The column of the nanoseconds that are added to it, as ROS 2 divides a time.
    pub nanoseconds: Option<String>,
    /// What is added to its times, ns: a table that counts from its own start beside a bag.
    pub offset_ns: i64,
}

/// The unit of a column of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeUnit {
    /// A number, in units of this many nanoseconds.
    Nanoseconds(i64),
    /// A date with a time of day, such as `2026-03-02T09:15:30.25Z` (ISO 8601); UTC without a zone.
    Date,
}

impl TimeUnit {
    /// Every unit with its name in files.
    pub const NAMES: [(&'static str, Self); 5] = [
        ("s", Self::Nanoseconds(1_000_000_000)),
        ("ms", Self::Nanoseconds(1_000_000)),
        ("us", Self::Nanoseconds(1_000)),
        ("ns", Self::Nanoseconds(1)),
        ("date", Self::Date),
    ];
}

/// One kind of table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Which files it describes: a name with `*` for any run of characters; `None`: every file.
    pub file: Option<String>,
    /// The separator, one byte.
    pub separator: u8,
    /// Lines before the data; without any, columns are named by their numbers from 1.
    pub header_lines: usize,
    /// Which of them names the columns, counted from 1; 0 where there is none.
    pub names_line: usize,
    /// The decimal mark, one byte.
    pub decimal: u8,
    /// What stands for "no value", besides an empty field.
    pub missing: Vec<String>,
    /// Does its clock differ from the others' by an unknown constant, to be estimated?
    pub align_clock: bool,
    /// The column of time.
    pub time: TimeColumn,
    /// The columns that are read.
    pub columns: Vec<Column>,
}

impl Table {
    /// Does this table describe a file of that name?
    #[must_use]
    pub fn describes(&self, file_name: &str) -> bool {
        self.file
            .as_ref()
            .is_none_or(|pattern| matches_pattern(pattern, file_name))
    }
}

/// What a column map says.
///
/// ```
/// use grouser_files::{Document, columns};
///
/// let map = columns::read("../../examples/five-wheel/columns.toml".as_ref())?;
/// let text = columns::to_toml(&map);
/// assert_eq!(columns::parse(&Document::from_text("again.toml", text)?)?, map);
/// # Ok::<(), grouser_files::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnMap {
    /// Its tables.
    pub tables: Vec<Table>,
}

/// Reads a column map.
///
/// # Errors
/// What the file lacks or says wrong, with its place.
///
/// ```
/// let map = grouser_files::columns::read("../../examples/five-wheel/columns.toml".as_ref())?;
/// assert!(map.tables.iter().any(|table| table.describes("log.csv")));
/// # Ok::<(), grouser_files::Error>(())
/// ```
pub fn read(path: &Path) -> Result<ColumnMap> {
    parse(&Document::read(path)?)
}

/// Reads a column map out of a document.
///
/// # Errors
/// As [`read`].
pub fn parse(document: &Document) -> Result<ColumnMap> {
    document.parse(|root| {
        let tables = root.sections("table", read_table)?;
        if tables.is_empty() {
            return Err(Error::MissingKey {
                at: root.place(),
                section: "the file".into(),
                key: "table",
            });
        }
        Ok(ColumnMap { tables })
    })
}

pub(crate) fn read_table(section: &Section<'_>) -> Result<Table> {
    let separator = match section.optional_text("separator")?.unwrap_or(",") {
        "tab" => b'\t',
        text => single_byte(section, "separator", text)?,
    };
    let decimal = section.optional_choice("decimal", &[(".", b'.'), (",", b',')])?;
    let decimal = decimal.unwrap_or(b'.');
    if decimal == separator {
        return Err(Error::Contradiction {
            at: section.place_of("decimal"),
            message: "the decimal mark is the separator as well".into(),
        });
    }
    let header_lines = section.optional_whole("header_lines", (0, MAX_HEADER_LINES))?;
    let header_lines = header_lines.unwrap_or(1);
    let names_line = section.optional_whole("names_line", (1, MAX_HEADER_LINES))?;
    let names_line = names_line.unwrap_or(header_lines);
    if names_line > header_lines {
        return Err(Error::Contradiction {
            at: section.place_of("names_line"),
            message: format!(
                "`names_line` is {names_line}, but there are {header_lines} header lines"
            ),
        });
    }
    let time = section.section("time", |time| {
        Ok(TimeColumn {
            column: time.text("column")?.into(),
            unit: time.choice("unit", &TimeUnit::NAMES)?,
            nanoseconds: time.optional_text("nanoseconds")?.map(Into::into),
            #[allow(
                clippy::cast_possible_truncation,
                reason = "within the limits of the key"
            )]
            offset_ns: (time
                .optional_number("offset_s", (-9e9, 9e9))?
                .unwrap_or(0.0)
                * 1e9)
                .round() as i64,
        })
    })?;
    let Some(time) = time else {
        return Err(Error::MissingKey {
            at: section.place(),
            section: "[[table]]".into(),
            key: "time",
        });
    };
    let columns = section.sections("columns", read_column)?;
    check_columns(section, &columns)?;
    Ok(Table {
        file: section.optional_text("file")?.map(Into::into),
        separator,
        header_lines,
        names_line,
        decimal,
        missing: section
            .texts("missing")?
            .into_iter()
            .map(Into::into)
            .collect(),
        align_clock: section.flag("align_clock")?,
        time,
        columns,
    })
}

fn single_byte(section: &Section<'_>, key: &'static str, text: &str) -> Result<u8> {
    match text.as_bytes() {
        [byte] if byte.is_ascii_graphic() && !byte.is_ascii_alphanumeric() && *byte != b'"' => {
            Ok(*byte)
        }
        [b' '] => Ok(b' '),
        _ => Err(Error::BadChoice {
            at: section.place_of(key),
            key: key.into(),
            value: text.chars().take(16).collect(),
            allowed: "one punctuation mark such as \",\" or \";\", or \"tab\"".into(),
            meant: None,
        }),
    }
}

fn read_column(section: &Section<'_>) -> Result<Column> {
    let column = section.text("column")?.into();
    let mut column = read_meaning(section, column)?;
    column.is_optional = section.flag("optional")?;
    if column.is_optional && !matches!(column.meaning, Meaning::Sinkage | Meaning::EntryAngle) {
        return Err(Error::Contradiction {
            at: section.place_of("optional"),
            message: format!(
                "`optional` belongs to `sinkage` and `entry_angle`, not to `{}`",
                column.meaning.name()
            ),
        });
    }
    Ok(column)
}

/// What a column or a field of that name means.
pub(crate) fn read_meaning(section: &Section<'_>, column: String) -> Result<Column> {
    let names = Meaning::ALL.map(|(name, meaning, quantity)| (name, (meaning, quantity)));
    let (meaning, quantity) = section.choice("meaning", &names)?;
    let unit = section.choice("unit", &quantity.units())?;
    let scale = section.optional_number("scale", (-1e12, 1e12))?;
    if scale.is_some() && quantity == Quantity::Ticks {
        return Err(Error::Contradiction {
            at: section.place_of("scale"),
            message: "ticks are whole numbers and cannot be scaled; \
                      see `ticks_per_turn` and `reversed` in the robot file"
                .into(),
        });
    }
    let wheel = section.optional_text("wheel")?;
    if wheel.is_some() != meaning.is_of_a_wheel() {
        return Err(Error::Contradiction {
            at: section.place(),
            message: if meaning.is_of_a_wheel() {
                format!("`{}` needs a `wheel`", meaning.name())
            } else {
                format!("`{}` belongs to no wheel", meaning.name())
            },
        });
    }
    let offset = section.optional_number("offset_m", (-1e3, 1e3))?;
    check_owner(section, "offset_m", (Meaning::Sinkage, meaning))?;
    let frame = section.optional_choice("frame", &Frame::NAMES)?;
    check_owner(section, "frame", (Meaning::DisplacementForward, meaning))?;
    Ok(Column {
        column,
        meaning,
        wheel: wheel.map(Into::into),
        factor: unit * scale.unwrap_or(1.0),
        offset: offset.unwrap_or(0.0),
        frame: frame.unwrap_or_default(),
        is_optional: false,
    })
}

/// Refuses a key that belongs to columns of another meaning (`owner`) than this one's.
fn check_owner(section: &Section<'_>, key: &str, (owner, own): (Meaning, Meaning)) -> Result<()> {
    if owner == own || !section.has(key) {
        return Ok(());
    }
    Err(Error::Contradiction {
        at: section.place_of(key),
        message: format!(
            "`{key}` belongs to `{}`, not to `{}`",
            owner.name(),
            own.name()
        ),
    })
}

/// Does `text` match `pattern`, in which `*` stands for any run of characters?
fn matches_pattern(pattern: &str, text: &str) -> bool {
    let mut parts = pattern.split('*');
    let first = parts.next().unwrap_or("");
    let Some(mut rest) = text.strip_prefix(first) else {
        return false;
    };
    let mut parts: Vec<&str> = parts.collect();
    let Some(last) = parts.pop() else {
        return rest.is_empty();
    };
    for part in parts {
        match rest.find(part) {
            Some(start) => rest = &rest[start + part.len()..],
            None => return false,
        }
    }
    rest.ends_with(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_stands_for_any_run_of_characters() {
        assert!(matches_pattern("*joint*.csv*", "run__joint_states.csv.gz"));
        assert!(matches_pattern("*.csv", "a.csv"));
        assert!(!matches_pattern("*.csv", "a.csv.gz"));
        assert!(!matches_pattern("ab*ba", "aba"));
        assert!(matches_pattern("log.csv", "log.csv"));
        assert!(!matches_pattern("log.csv", "log.csv2"));
    }
}
