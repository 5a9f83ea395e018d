//! What is wrong with a log, and where.

use std::fmt;
use std::io;

/// The result of reading a log.
pub type Result<T> = std::result::Result<T, Error>;

/// A place in a table, counted from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The file as it was named.
    pub file: String,
    /// Line, header included.
    pub line: u64,
    /// Column of the table; `None` for a whole line.
    pub column: Option<usize>,
    /// That column's name, where it has one.
    pub name: Option<String>,
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: line {}", self.file, self.line)?;
        if let Some(column) = self.column {
            write!(f, ", column {column}")?;
        }
        if let Some(name) = &self.name {
            write!(f, " `{name}`")?;
        }
        Ok(())
    }
}

/// Why a log cannot be read.
///
/// ```
/// use grouser_log::csv::Lines;
///
/// let error = Lines::open("no-such-table.csv".as_ref()).err().unwrap();
/// assert!(error.to_string().contains("no-such-table.csv"));
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be opened, or the column map does not fit.
    #[error(transparent)]
    File(#[from] grouser_files::Error),
    /// The system, or the decompressor, gives no more.
    #[error("{at}: {source}")]
    Unreadable {
        /// Where.
        at: Cell,
        /// What it says.
        source: io::Error,
    },
    /// A file without data.
    #[error("{file}: holds {what}")]
    Empty {
        /// The file.
        file: String,
        /// What it does hold.
        what: &'static str,
    },
    /// A line longer than the limit.
    #[error("{at}: is longer than {limit} bytes, the limit for a line")]
    LongLine {
        /// Where.
        at: Cell,
        /// The limit, bytes.
        limit: usize,
    },
    /// Text that a table cannot hold.
    #[error("{at}: {what}")]
    Malformed {
        /// Where.
        at: Cell,
        /// What is wrong.
        what: &'static str,
    },
    /// A line with another number of fields than its header.
    #[error("{at}: has {found} fields, but the header has {expected}")]
    Ragged {
        /// Where.
        at: Cell,
        /// Fields of the line.
        found: usize,
        /// Fields of the header.
        expected: usize,
    },
    /// A column that the map names is not there.
    #[error("{at}: there is no column `{column}`, which the column map names")]
    NoColumn {
        /// The header.
        at: Cell,
        /// The column.
        column: String,
        /// The column that was probably meant.
        meant: Option<String>,
    },
    /// A column that the map names is there twice.
    #[error("{at}: there are two columns of this name, which the column map names")]
    TwoColumns {
        /// The second of them.
        at: Cell,
    },
    /// A field that is no number, or no finite one.
    #[error("{at}: is \"{found}\", but must be {expected}")]
    NotANumber {
        /// Where.
        at: Cell,
        /// What was found.
        found: String,
        /// What it must be.
        expected: &'static str,
        /// What to do about it, where that is known.
        hint: Option<&'static str>,
    },
    /// A row that is older than what was already given out.
    #[error("{at}: is {by_s} s older than rows {look_ahead} rows before it")]
    OutOfOrder {
        /// Where.
        at: Cell,
        /// How much older, s.
        by_s: f64,
        /// How far rows may stand from their place.
        look_ahead: usize,
    },
    /// A clock that is set back in a table.
    #[error("{at}: is {by_s} s older than the row before it: the clock was set back")]
    SetBack {
        /// Where.
        at: Cell,
        /// How much older, s.
        by_s: f64,
    },
    /// Two files of one run that are not on one clock.
    #[error(
        "{second}: begins {by_s} s after {first} ends: the files of one run must be on one clock"
    )]
    Apart {
        /// The file that ends.
        first: String,
        /// The file that begins.
        second: String,
        /// The time between, s.
        by_s: f64,
    },
    /// No file of the log fits the column map.
    #[error("{log}: no file fits the column map ({patterns})")]
    NoTable {
        /// The log as it was named.
        log: String,
        /// The patterns of the map's tables.
        patterns: String,
    },
    /// A folder that is to be followed and has no recording.
    #[error("{folder}: holds no MCAP file and no ROS 1 bag that could be followed")]
    NoRecording {
        /// The folder.
        folder: String,
    },
    /// A folder that is to be followed and has two recordings.
    #[error(
        "{first} and {second} are no files of one recording (`name_0.mcap`, `name_1.mcap`): name the one to follow"
    )]
    TwoRecordings {
        /// A file.
        first: String,
        /// Another.
        second: String,
    },
    /// A log in another version of its format.
    #[error("{file}: is {format} version {found:?}; known is {known:?}")]
    Version {
        /// The file.
        file: String,
        /// The format.
        format: &'static str,
        /// The version that it declares.
        found: String,
        /// The version that is read.
        known: String,
    },
    /// Neither an MCAP file nor a ROS 1 bag.
    #[error("{file}: is neither an MCAP file nor a ROS 1 bag")]
    NotALog {
        /// The file.
        file: String,
    },
    /// A topic that was requested is not there, or has no messages.
    #[error("{file}: there are no messages of topic `{topic}`")]
    NoTopic {
        /// The file.
        file: String,
        /// The topic.
        topic: String,
        /// The topic that was probably meant.
        meant: Option<String>,
    },
    /// A field that was requested is not in the messages of its topic.
    #[error("{file}: messages of `{topic}` have no number at `{field}`")]
    NoField {
        /// The file.
        file: String,
        /// The topic.
        topic: String,
        /// The path of the field.
        field: String,
    },
    /// The robot file names a topic that is not there.
    #[error(
        "{file}: there are no messages of topic `{topic}`, which the robot file names as `{key}`"
    )]
    NoNamedTopic {
        /// The files.
        file: String,
        /// The key in `[topics]`.
        key: &'static str,
        /// The topic.
        topic: String,
        /// The topic that was probably meant.
        meant: Option<String>,
    },
    /// The robot file names a topic for what its messages do not say.
    #[error(
        "{file}: topic `{topic}` is {type_name}, but the robot file names it as `{key}`, which is {wanted}"
    )]
    UnfitTopic {
        /// The files.
        file: String,
        /// The key in `[topics]`.
        key: &'static str,
        /// The topic.
        topic: String,
        /// Its type.
        type_name: String,
        /// What it should be.
        wanted: &'static str,
    },
    /// The topic that the robot file names for the wheels has none of their joints.
    #[error("{file}: topic `{topic}` has none of the wheels' joints: it has {joints}")]
    NoJoints {
        /// The files.
        file: String,
        /// The topic.
        topic: String,
        /// The joints that it has.
        joints: String,
    },
    /// The robot file names a topic of transforms as the pose, and they lead to none, or to several.
    #[error(
        "{file}: the transforms of topic `{topic}`, which the robot file names as `pose`, hold {poses}"
    )]
    NoFramePose {
        /// The files.
        file: String,
        /// The topic.
        topic: String,
        /// The poses that they hold, in words.
        poses: String,
    },
    /// The robot file places an antenna, and the log has a pose with its heading.
    #[error(
        "{log}: `antenna_x_m` and `antenna_y_m` of the robot file have no effect on a pose with its heading"
    )]
    NoPlaces {
        /// The log as it was named.
        log: String,
    },
    /// A file of another program.
    #[error("{file}: is {kind}, which is not read")]
    Foreign {
        /// The file.
        file: String,
        /// Its kind.
        kind: &'static str,
        /// The command that converts it.
        advice: &'static str,
    },
    /// One path for tables and for bags or MCAP files.
    #[error("{path}: means both tables and bags or MCAP files")]
    Mixed {
        /// The path.
        path: String,
    },
    /// The file that is written cannot be.
    #[error("{0}")]
    Output(#[source] io::Error),
    /// What was written is not what was read: a fault of the disk, or of this program.
    #[error("the file that was written, read again, differs: {what}")]
    Differs {
        /// How.
        what: String,
    },
    /// Two files for one table.
    #[error("{first} and {second} both fit the table \"{pattern}\" of the column map")]
    TwoFiles {
        /// One file.
        first: String,
        /// Another.
        second: String,
        /// The table's pattern.
        pattern: String,
    },
}

impl Error {
    /// What to do about it, where that is known.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::File(error) => error.hint(),
            Self::NoColumn {
                meant: Some(meant), ..
            }
            | Self::NoTopic {
                meant: Some(meant), ..
            }
            | Self::NoNamedTopic {
                meant: Some(meant), ..
            } => Some(format!("did you mean `{meant}`?")),
            Self::NoNamedTopic { .. } | Self::NoTopic { .. } => {
                Some("`grouser log info` lists the topics of a file".into())
            }
            Self::NoFramePose { .. } => Some(
                "`pose_frame` and `pose_child_frame` in `[topics]` name the fixed frame and the robot's".into(),
            ),
            Self::UnfitTopic { .. } => {
                Some("any number of a message can be named under `[[topics.field]]`".into())
            }
            Self::NoPlaces { .. } => Some(
                "`reference_x_m` and `reference_y_m` in `[estimator]` are of what measures a pose or a speed".into(),
            ),
            Self::Foreign { advice, .. } => Some((*advice).into()),
            Self::Mixed { .. } => Some("name the files that are meant".into()),
            Self::NoJoints { .. } => Some("`joint` of a `[[wheel]]` names its joint".into()),
            Self::NotANumber { hint, .. } => hint.map(Into::into),
            Self::Ragged { .. } => Some(
                "if the line is no row (a comment, the end of one log before another), remove it or split the log there".into(),
            ),
            Self::TwoFiles { .. } => {
                Some("name the files of one run, or the beginning that their names share".into())
            }
            Self::SetBack { .. } => Some("split the log where its clock was set".into()),
            Self::Apart { .. } => {
                Some("`offset_s` in `time` of the column map is added to a table's times".into())
            }
            Self::OutOfOrder { .. } => Some(
                "sort the log by time, or split it; a column of the nanoseconds within a second is named with that of the seconds: \
                 `time = { column = \"sec\", unit = \"s\", nanoseconds = \"nanosec\" }`"
                    .into(),
            ),
            _ => None,
        }
    }
}

/// Why a field is no number.
///
/// ```
/// let error = grouser_log::csv::finite("fast", b'.').unwrap_err();
/// assert!(!error.expected.is_empty());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotANumber {
    /// What the field must be.
    pub expected: &'static str,
    /// How to correct it, where that is known.
    pub hint: Option<&'static str>,
}

/// What is wrong with one field of a row.
#[derive(Clone, Copy)]
pub(crate) struct BadField {
    pub(crate) field: usize,
    pub(crate) problem: NotANumber,
}
