//! A log: the files of one run, merged.

mod open;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use grouser_files::columns::{Column, ColumnMap, Meaning};

use crate::csv::{Counts, CsvReader};
use crate::error::Result;
use crate::measures::Measures;
use crate::merge::{Poses, Samples};
use crate::messages::LeftOut;
use crate::recording::navigation::{FixColumns, Track};
use crate::recording::{Recording, RecordingReader, UsedTopic};
use crate::slots::{Slots, measured};
use crate::source::Source;
use crate::wrapped_angles::Angles;

/// The files of one run with what their columns or topics mean.
///
/// ```
/// use grouser_files::columns;
/// use grouser_log::Log;
///
/// let example = std::path::Path::new("../../examples/five-wheel");
/// let map = columns::read(&example.join("columns.toml"))?;
/// let log = Log::find(&[example.join("log.csv")], map)?;
/// assert_eq!((log.wheels().len(), log.clocks()), (5, 1));
/// assert!(log.measures(columns::Meaning::YawRate));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Log {
    map: ColumnMap,
    /// Tables, each with the table of the map that describes it.
    files: Vec<(Source, usize)>,
    /// Bags and MCAP files.
    recording: Option<Recording>,
    unused: Vec<PathBuf>,
    /// Which of the files has the places without a heading that are used, and their standard deviation, m.
    places: Option<(usize, f64)>,
    /// How its fixes are read.
    fixes: FixColumns,
    /// The position of their antenna in the robot's frame, m.
    antenna: [f64; 2],
    notes: Vec<String>,
    wheels: Vec<String>,
    /// How many rows a row of a table may be from its place in time.
    look_ahead: usize,
    /// What all readers read of the files.
    counts: Counts,
}

impl Log {
    /// The same log without the topics that measure no wheel: their messages are passed over undecoded. Tables are read
    /// as they are. What is read of it counts apart ([`Log::bytes_read`], [`Log::left_out`]).
    ///
    /// ```
    /// use grouser_files::robot;
    /// use grouser_log::Log;
    ///
    /// let robot = robot::read("../../examples/five-wheel/robot.toml".as_ref())?;
    /// let log = Log::find_any(&["../../examples/five-wheel/log.mcap".into()], None, &robot.topics)?;
    /// let wheels = log.of_wheels().samples(&[])?.count();
    /// assert_eq!(wheels, 5 * 2001); // the inertial unit's messages are not among them
    /// assert!(log.samples(&[])?.count() > wheels);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn of_wheels(&self) -> Self {
        Self {
            recording: self.recording.as_ref().map(Recording::of_wheels),
            counts: Counts::default(),
            ..self.clone()
        }
    }

    /// The same log, whose tables are read with fewer rows held back: a table that is still written gives its newest
    /// row after `rows` later ones, and a row that is farther from its place in time is an error. Without this they are
    /// 1024.
    ///
    /// ```
    /// use grouser_files::columns;
    /// use grouser_log::Log;
    ///
    /// let map = columns::read("../../examples/five-wheel/columns.toml".as_ref())?;
    /// let log = Log::find(&["../../examples/five-wheel/log.csv".into()], map)?;
    /// assert_eq!(log.with_look_ahead(0).samples(&[])?.count(), 6 * 2001);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_look_ahead(self, rows: usize) -> Self {
        Self {
            look_ahead: rows,
            ..self
        }
    }

    fn all_files(&self) -> impl Iterator<Item = &Source> {
        let tables = self.files.iter().map(|(file, _)| file);
        tables.chain(self.recording.iter().flat_map(|all| &all.files))
    }

    /// The files that are read.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.all_files().map(Source::path)
    }

    /// How many clocks the log has: every table has one, and every topic that is used.
    #[must_use]
    pub fn clocks(&self) -> usize {
        let topics = self.recording.as_ref();
        self.files.len() + topics.map_or(0, |all| all.choice.topics.len())
    }

    /// The topics that are used of bags and MCAP files.
    pub fn topics(&self) -> impl Iterator<Item = UsedTopic> {
        self.recording.iter().flat_map(|all| all.choice.used())
    }

    /// What is to be known of how topics were chosen.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The standard deviation of a place by the reference, m, where the log states it.
    #[must_use]
    pub fn position_sigma(&self) -> Option<f64> {
        let recording = self.recording.as_ref();
        let places = self.places.map(|(_, sigma)| sigma);
        places.or_else(|| recording?.choice.position_sigma)
    }

    /// What was left out when the log was last read to its end: damage, messages that cannot be decoded
    /// or came too late, of tables the last line where that is cut off, and poses of zeros.
    #[must_use]
    pub fn left_out(&self) -> LeftOut {
        let recording = self.recording.as_ref();
        let mut left_out = recording.map_or_else(LeftOut::default, Recording::left_out);
        left_out.add(&self.counts.excluded());
        left_out.cut_off.clone_from(&self.counts.cut_off());
        let read = |count: &AtomicU64| count.load(Ordering::Relaxed);
        left_out.zero_poses = read(&self.counts.zero_poses);
        left_out.same_time = read(&self.counts.same_time);
        left_out.rows = read(&self.counts.rows);
        left_out
    }

    /// Why a log that is still written ended before its writer completed it: a file was truncated, renamed or replaced.
    #[must_use]
    pub fn abandoned(&self) -> Option<String> {
        let mut files = self.all_files();
        files.find_map(|file| Some(format!("{}: {}", file.name(), file.abandoned()?)))
    }

    /// How many bytes the files hold, as they stand (compressed or not).
    ///
    /// ```
    /// use grouser_files::columns;
    /// use grouser_log::Log;
    ///
    /// let map = columns::read("../../examples/five-wheel/columns.toml".as_ref())?;
    /// let log = Log::find(&["../../examples/five-wheel/log.csv".into()], map)?;
    /// assert_eq!(log.bytes(), std::fs::metadata("../../examples/five-wheel/log.csv")?.len());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.all_files().map(Source::bytes).sum()
    }

    /// How many of them have been read since the log was found, twice if it was read twice.
    #[must_use]
    pub fn bytes_read(&self) -> u64 {
        self.counts.read.load(Ordering::Relaxed)
    }

    /// The files that fit no table of the column map.
    #[must_use]
    pub fn unused(&self) -> &[PathBuf] {
        &self.unused
    }

    /// The wheels that the log measures; samples name them by their index here.
    #[must_use]
    pub fn wheels(&self) -> &[String] {
        &self.wheels
    }

    fn columns(&self) -> impl Iterator<Item = &Column> {
        let tables = self.files.iter().map(|(_, table)| &self.map.tables[*table]);
        tables.flat_map(|table| &table.columns)
    }

    /// Does the log measure a quantity of that meaning?
    #[must_use]
    pub fn measures(&self, meaning: Meaning) -> bool {
        let recording = self.recording.as_ref();
        recording.is_some_and(|all| all.choice.measures(meaning))
            || self.files.iter().enumerate().any(|(index, (_, table))| {
                let columns = &self.map.tables[*table].columns;
                let is_used = self.places.is_some_and(|(used, _)| used == index);
                columns.iter().any(|column| {
                    let own = measured(columns, column);
                    own == meaning && (own == column.meaning || is_used)
                })
            })
    }

    /// Does the log measure a quantity of that meaning for that wheel?
    #[must_use]
    pub fn measures_wheel(&self, meaning: Meaning, wheel: &str) -> bool {
        let recording = self.recording.as_ref();
        let of_wheel = |column: &Column| column.wheel.as_deref() == Some(wheel);
        recording.is_some_and(|all| all.choice.measures_wheel(meaning, wheel))
            || self
                .columns()
                .any(|column| column.meaning == meaning && of_wheel(column))
    }

    /// The clocks (of [`Log::clocks`]) that differ from the others by an unknown constant.
    #[must_use]
    pub fn unaligned_clocks(&self) -> Vec<usize> {
        let tables = self
            .files
            .iter()
            .map(|(_, table)| self.map.tables[*table].align_clock);
        let topics = self.recording.iter().flat_map(|all| &all.choice.topics);
        let unaligned = tables.chain(topics.map(|topic| topic.align)).enumerate();
        unaligned
            .filter_map(|(clock, unaligned)| unaligned.then_some(clock))
            .collect()
    }

    /// Opens the files and returns their samples in the order of time. `shift_ns` is added to the times of each clock
    /// (of [`Log::clocks`]).
    ///
    /// # Errors
    /// What is wrong with a file's header.
    pub fn samples(&self, shift_ns: &[i64]) -> Result<Samples> {
        let track = |(_, sigma)| (Track::new(self.antenna), sigma);
        let wheels = self.wheels.iter();
        let are_ways = wheels.map(|wheel| self.measures_wheel(Meaning::WheelDistance, wheel));
        let mut samples = Samples::new(self.places.map(track), Angles::new(are_ways));
        self.counts.begin();
        for (clock, (file, table)) in self.files.iter().enumerate() {
            let table = &self.map.tables[*table];
            let is_used = self.places.is_some_and(|(used, _)| used == clock);
            let poses = if is_used {
                Poses::Places
            } else if Slots::new(&table.columns, &self.wheels).gives_places() {
                Poses::UnusedPlaces
            } else {
                Poses::WithHeading
            };
            let reader =
                CsvReader::open(file, table, (&self.wheels, self.look_ahead, &self.counts))?
                    .with_fixes(is_used.then(|| self.fixes.clone()));
            let shift = shift_ns.get(clock).copied().unwrap_or(0);
            samples.add(
                reader,
                shift.saturating_add(table.time.offset_ns),
                (clock, file, poses),
            );
        }
        if let Some(recording) = &self.recording {
            recording.begin();
            let of_topics = shift_ns.get(self.files.len()..).unwrap_or_default();
            for file in &recording.files {
                let reader = RecordingReader::open(file, recording, of_topics, &self.counts.read)?;
                // A recorder splits a run into files that follow each other on one clock.
                samples.add(reader, 0, (self.files.len(), file, Poses::WithHeading));
            }
        }
        Ok(samples)
    }
}

impl Measures for Log {
    fn wheels(&self) -> &[String] {
        self.wheels()
    }

    fn measures(&self, meaning: Meaning) -> bool {
        self.measures(meaning)
    }

    fn measures_wheel(&self, meaning: Meaning, wheel: &str) -> bool {
        self.measures_wheel(meaning, wheel)
    }

    fn is_of_tables(&self) -> bool {
        self.recording.is_none()
    }

    fn position_sigma(&self) -> Option<f64> {
        self.position_sigma()
    }

    fn speed_place(&self) -> [f64; 2] {
        let recording = self.recording.as_ref();
        recording.map_or([0.0; 2], |all| all.choice.speed_place)
    }
}
