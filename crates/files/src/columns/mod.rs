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
//! # time = { column = "Date", unit = "date", time_of_day = "Time" }  # a date, and the time of day in another column
//! columns = [
//!     { column = "left",  meaning = "wheel_angle", wheel = "left",  unit = "rad" },
//!     { column = "right", meaning = "wheel_angle", wheel = "right", unit = "rad" },
//! ]
//! ```

mod check;
mod write;

use std::path::Path;

use grouser_slip::{MeasurementKind, Reference};

use crate::document::Document;
use crate::error::{Error, Result};
use crate::section::Section;
use crate::suggestion::nearest;
use crate::suspension::SuspensionJoint;
use crate::unit::Quantity;

use check::check_columns;
pub(crate) use check::check_together;
pub use write::to_toml;
pub(crate) use write::{meaning, write_table};

/// The maximum number of lines before the data.
const MAX_HEADER_LINES: i64 = 1000;

/// Declares the meanings: name in files, quantity, the measurement that it is a part of, and what it needs beside it.
macro_rules! meanings {
    ($($(#[doc = $doc:literal])+ $meaning:ident = $name:literal, $quantity:ident => $kind:ident $([$($needs:ident)+])?;)+) => {
        /// What a column means.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Meaning {
            $($(#[doc = $doc])+ $meaning,)+
        }

        impl Meaning {
            /// Every meaning: its name in files, and what it measures.
            pub const ALL: &[(&str, Self, Quantity)] = &[$(($name, Self::$meaning, Quantity::$quantity)),+];

            /// Its name in files.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$meaning => $name,)+ }
            }

            /// The measurement that it is, or is a part of, once radius and motor of the wheel are known.
            #[must_use]
            pub const fn kind(self) -> MeasurementKind {
                match self { $(Self::$meaning => MeasurementKind::$kind,)+ }
            }

            /// The meanings without which this one says nothing.
            #[must_use]
            pub const fn needs(self) -> &'static [Self] {
                match self { $(Self::$meaning => &[$($(Self::$needs),+)?],)+ }
            }
        }
    };
}

meanings! {
    /// A wheel's tick counter.
    WheelCount = "wheel_count", Ticks => WheelCount;
    /// An edge of a wheel's encoder at the time of its row: above 0 forwards, below 0 backwards.
    WheelEdge = "wheel_edge", Number => WheelEdge;
    /// The angle of a wheel's sensor shaft.
    WheelAngle = "wheel_angle", Angle => WheelAngle;
    /// The way of a wheel's rim since some start, as odometers count it; [`Self::WheelAngle`] by the wheel's radius.
    WheelDistance = "wheel_distance", Length => WheelAngle;
    /// The rate of a wheel's sensor shaft.
    WheelRate = "wheel_rate", AngularRate => WheelRate;
    /// The speed of a wheel's rim; [`Self::WheelRate`] by the wheel's radius.
    WheelSpeed = "wheel_speed", Speed => WheelRate;
    /// Torque on a wheel, positive when it drives forwards.
    WheelTorque = "wheel_torque", Torque => WheelTorque;
    /// Current of a wheel's motor, positive when it drives forwards; [`Self::WheelTorque`] by `torque_per_ampere_nm` of the
    /// robot file.
    MotorCurrent = "motor_current", Current => WheelTorque;
    /// How deep the lowest point of a wheel lies below the ground in front of it.
    Sinkage = "sinkage", Length => Sinkage;
    /// The angle at which the ground in front of a wheel meets its rim, from the lowest point forwards.
    EntryAngle = "entry_angle", Angle => EntryAngle;
    /// Angle by which a wheel is steered, to the left.
    WheelSteering = "wheel_steering", Angle => SteeringAngle;
    /// Angle of the robot's steering as a whole, to the left: see `[steering]` of the robot file.
    SteeringAngle = "steering_angle", Angle => Steering;
    /// Angle of a joint of the suspension from its rest, by the link that it turns ([`Column::joint`]), nose down positive.
    JointAngle = "joint_angle", Angle => JointAngle;
    /// The robot's yaw rate.
    YawRate = "yaw_rate", AngularRate => YawRate;
    /// What an accelerometer feels forwards, gravity's share on a slope included.
    AccelerationForward = "acceleration_forward", Acceleration => Acceleration;
    /// What it feels to the left.
    AccelerationLeft = "acceleration_left", Acceleration => Acceleration [AccelerationForward];
    /// What it feels upwards: with the roll and pitch rates it shows how the robot is inclined.
    AccelerationUp = "acceleration_up", Acceleration => Inertial [AccelerationForward AccelerationLeft RollRate PitchRate YawRate];
    /// The robot's roll rate, right side down positive.
    RollRate = "roll_rate", AngularRate => Inertial [AccelerationUp];
    /// Its pitch rate, nose down positive.
    PitchRate = "pitch_rate", AngularRate => Inertial [AccelerationUp];
    /// Way forwards since the row before, in the robot's frame; [`Column::frame`] has which.
    DisplacementForward = "displacement_forward", Length => Displacement [DisplacementLeft];
    /// Way to the left since the row before.
    DisplacementLeft = "displacement_left", Length => Displacement [DisplacementForward];
    /// Turn to the left since the row before.
    DisplacementTurn = "displacement_turn", Angle => Displacement [DisplacementForward];
    /// Position in a fixed frame.
    PoseX = "pose_x", Length => Pose [PoseY];
    /// Position in a fixed frame.
    PoseY = "pose_y", Length => Pose [PoseX];
    /// Yaw angle in a fixed frame.
    PoseYaw = "pose_yaw", Angle => Pose [PoseX];
    /// Part x of the quaternion that turns the robot's frame to the fixed one; 0 where it is not there.
    OrientationX = "orientation_x", Number => Pose [OrientationZ];
    /// Part y of it; 0 where it is not there.
    OrientationY = "orientation_y", Number => Pose [OrientationZ];
    /// Part z of it.
    OrientationZ = "orientation_z", Number => Pose [PoseX OrientationW];
    /// Its real part.
    OrientationW = "orientation_w", Number => Pose [OrientationZ];
    /// Speed over ground forwards.
    SpeedForward = "speed_forward", Speed => Speed;
    /// Speed over ground to the left.
    SpeedLeft = "speed_left", Speed => Speed [SpeedForward];
    /// Size of the speed over ground, as satellite receivers state it: its sign is that of the wheels.
    SpeedSize = "speed_size", Speed => Speed;
    /// Commanded speed forwards.
    CommandForward = "command_forward", Speed => Command;
    /// Commanded speed to the left.
    CommandLeft = "command_left", Speed => Command [CommandForward];
    /// Latitude of a satellite receiver's fix, to the north (WGS 84).
    Latitude = "latitude", Angle => Position [Longitude];
    /// Its longitude, to the east.
    Longitude = "longitude", Angle => Position [Latitude];
    /// Its altitude.
    Altitude = "altitude", Length => Position [Latitude];
    /// The kind of its solution: 0 or less without a position.
    FixType = "fix_type", Number => Position [Latitude];
    /// Its status as in `sensor_msgs/NavSatFix`: below 0 without a position, 1 with augmentation, 2 with a ground station.
    FixStatus = "fix_status", Number => Position [Latitude];
    /// The horizontal standard deviation of its position; 0: not known.
    FixSigma = "fix_sigma", Length => Position [Latitude];
}

impl Meaning {
    /// Does it belong to one wheel?
    #[must_use]
    pub const fn is_of_a_wheel(self) -> bool {
        self.kind().is_of_a_wheel()
    }

    /// Is it the same reading as another of the same wheel or robot?
    pub(crate) fn is_same_reading(self, other: Self) -> bool {
        self == other || (self.is_of_a_wheel() && self.kind() == other.kind())
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

    /// Is it a yaw angle, or the part of a quaternion that has it?
    #[must_use]
    pub const fn is_heading(self) -> bool {
        matches!(self, Self::PoseYaw | Self::OrientationZ)
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
    /// The joint whose angle it is.
    pub joint: Option<SuspensionJoint>,
    /// What one of it is in SI.
    pub factor: f64,
    /// What is added in SI: a sinkage by a sensor that measures its distance from the ground.
    pub offset: f64,
    /// The frame in which a displacement is stated; [`Frame::Halfway`] of all other columns.
    pub frame: Frame,
    /// May a table lack it? Of what no slip needs.
    pub is_optional: bool,
}

impl Meaning {
    /// May a table lack a column of this meaning?
    const fn may_be_missing(self) -> bool {
        matches!(
            self.kind(),
            MeasurementKind::Sinkage
                | MeasurementKind::WheelEdge
                | MeasurementKind::EntryAngle
                | MeasurementKind::JointAngle
                | MeasurementKind::Inertial
        )
    }
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
    /// The column of the nanoseconds that are added to it, as ROS 2 divides a time; of a date, that of the time of day.
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
    /// The key of a second column.
    pub(crate) const fn second_key(self) -> &'static str {
        match self {
            Self::Date => "time_of_day",
            Self::Nanoseconds(_) => "nanoseconds",
        }
    }

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
        let mut map = ColumnMap { tables };
        for table in &mut map.tables {
            // links are described by robot files
            resolve_links(&mut table.columns, &[]).map_err(|message| Error::Contradiction {
                at: root.place_of("table"),
                message,
            })?;
        }
        Ok(map)
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
            nanoseconds: time
                .optional_text(time.choice("unit", &TimeUnit::NAMES)?.second_key())?
                .map(Into::into),
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
    if column.is_optional && !column.meaning.may_be_missing() {
        return Err(Error::Contradiction {
            at: section.place_of("optional"),
            message: format!(
                "`optional` belongs to what no slip needs (`sinkage`, `joint_angle`), not to `{}`",
                column.meaning.name()
            ),
        });
    }
    Ok(column)
}

/// What a column or a field of that name means.
pub(crate) fn read_meaning(section: &Section<'_>, column: String) -> Result<Column> {
    let all = Meaning::ALL.iter();
    let names: Vec<_> = all
        .map(|(name, meaning, quantity)| (*name, (*meaning, *quantity)))
        .collect();
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
    let link = section.optional_text("link")?;
    check_owner(section, "link", (Meaning::JointAngle, meaning))?;
    if meaning == Meaning::JointAngle && link.is_none() {
        return Err(Error::Contradiction {
            at: section.place(),
            message: "`joint_angle` needs the `link` that the joint turns".into(),
        });
    }
    let frame = section.optional_choice("frame", &Frame::NAMES)?;
    check_owner(section, "frame", (Meaning::DisplacementForward, meaning))?;
    Ok(Column {
        column,
        meaning,
        wheel: wheel.map(Into::into),
        joint: link.map(SuspensionJoint::of_link),
        factor: unit * scale.unwrap_or(1.0),
        offset: offset.unwrap_or(0.0),
        frame: frame.unwrap_or_default(),
        is_optional: false,
    })
}

/// Finds the joints of columns among those of the robot.
pub(crate) fn resolve_links(
    columns: &mut [Column],
    links: &[SuspensionJoint],
) -> std::result::Result<(), String> {
    for joint in columns
        .iter_mut()
        .filter_map(|column| column.joint.as_mut())
    {
        let known = links.iter().find(|known| known.link == joint.link);
        *joint = known.cloned().ok_or_else(|| {
            let link = &joint.link;
            let meant = nearest(link, links.iter().map(|known| known.link.as_str()));
            let hint = meant.map_or_else(
                || "the robot file that has the `[[table]]` describes it".to_owned(),
                |meant| format!("did you mean \"{meant}\"?"),
            );
            format!("no [[link]] is named \"{link}\": {hint}")
        })?;
    }
    Ok(())
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
