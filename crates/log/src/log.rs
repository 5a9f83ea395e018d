//! A log: the files of one run, merged.

use std::io::{Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use grouser_files::columns::{Column, ColumnMap, Meaning};
use grouser_files::topics::Topics;

use crate::container::Container;
use crate::csv::{Counts, CsvReader, TABLE_LOOK_AHEAD};
use crate::error::{Error, Result};
use crate::find::expand;
use crate::measures::Measures;
use crate::merge::{Poses, Samples};
use crate::messages::LeftOut;
use crate::recording::navigation::{FixColumns, Track, place_sigma};
use crate::recording::{Recording, RecordingReader, UsedTopic};
use crate::slots::{Slots, measured};
use crate::source::Source;
use crate::split::{SplitRecording, first_file};

/// A file's first bytes, which show its kind.
const MAGIC_BYTES: u64 = 16;

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
    /// Finds the files of a run. Each path is a file; or a folder, for the files in it; or the
    /// beginning that the names of several files share (`data/run7` for `data/run7_imu.csv` and
    /// `data/run7_wheels.csv`).
    ///
    /// A file goes to the first table of the column map whose pattern its name fits; one that fits none
    /// is left unused. At most one file may go to a table: the files of one run.
    ///
    /// # Errors
    /// [`Error::NoTable`] when no file fits a table, [`Error::TwoFiles`], and what the system refuses.
    ///
    /// ```
    /// use grouser_files::columns;
    /// use grouser_log::{Error, Log};
    ///
    /// let map = columns::read("../../examples/five-wheel/columns.toml".as_ref())?;
    /// let nothing = Log::find(&["../../examples/five-wheel/robot.toml".into()], map);
    /// assert!(matches!(nothing, Err(Error::NoTable { .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn find(paths: &[PathBuf], map: ColumnMap) -> Result<Self> {
        Self::find_any(paths, Some(map), &Topics::default())
    }

    /// Does one of the paths hold a table, which is read through a column map?
    ///
    /// # Errors
    /// What the system refuses.
    ///
    /// ```
    /// use grouser_log::Log;
    ///
    /// assert!(Log::needs_columns(&["../../examples/five-wheel/log.csv".into()])?);
    /// # Ok::<(), grouser_log::Error>(())
    /// ```
    pub fn needs_columns(paths: &[PathBuf]) -> Result<bool> {
        let mut found = Vec::new();
        for path in paths {
            expand(path, &mut found)?;
        }
        let found: Vec<Source> = found.into_iter().map(Source::file).collect();
        if found.iter().any(is_recording) {
            return Ok(false);
        }
        found.iter().try_for_each(Source::refuse_database)?;
        Ok(true)
    }

    /// As [`Log::find`]; the files may be bags and MCAP files as well, whose topics are chosen by
    /// `topics` and, where that says nothing, by type and name.
    ///
    /// # Errors
    /// As [`Log::find`]; [`Error::NoNamedTopic`], [`Error::UnfitTopic`], [`Error::NoJoints`] where
    /// `topics` does not fit what the files hold.
    pub fn find_any(paths: &[PathBuf], map: Option<ColumnMap>, topics: &Topics) -> Result<Self> {
        let map = map.unwrap_or_default();
        let (mut tables, mut recordings) = (Vec::new(), Vec::new());
        for path in paths {
            let mut here = Vec::new();
            expand(path, &mut here)?;
            let here = here.into_iter().map(Source::file).collect();
            let (others, bags) = sort(&path.display().to_string(), here, &map)?;
            recordings.extend(bags);
            tables.extend(others);
        }
        let log: Vec<String> = paths.iter().map(|p| p.display().to_string()).collect();
        Self::of(&log.join(", "), (tables, recordings), map, topics)
    }

    /// A log of one input that can be read from any place, such as bytes in memory: an MCAP file, a bag, or a table
    /// that fits the column map by `name`. Errors call it `name`.
    ///
    /// ```
    /// use grouser_files::{columns, topics::Topics};
    /// use grouser_log::Log;
    ///
    /// let map = columns::read(std::path::Path::new("../../examples/five-wheel/columns.toml"))?;
    /// let table = "time_ms,front_left_ticks,front_right_ticks,rear_left_ticks,rear_right_ticks,fifth_ticks,\
    ///     gyro_z_rad_per_s\n0,0,0,0,0,0,0.1\n20,1,1,1,1,1,0.2\n";
    /// let bytes = std::io::Cursor::new(table.as_bytes());
    /// let log = Log::over("log.csv".as_ref(), bytes, Some(map), &Topics::default())?;
    /// assert_eq!(log.samples(&[])?.count(), 12);
    /// # Ok::<(), grouser_log::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Log::find_any`].
    pub fn over(
        name: &Path,
        source: impl Read + Seek + Send + 'static,
        map: Option<ColumnMap>,
        topics: &Topics,
    ) -> Result<Self> {
        Self::over_all([(name.to_owned(), source)], map, topics)
    }

    /// As [`Log::over`], of all inputs of a run, each with its name: the files of a split recording, say.
    ///
    /// ```
    /// use grouser_files::robot;
    /// use grouser_log::Log;
    ///
    /// let robot = robot::read("../../examples/five-wheel/robot.toml".as_ref())?;
    /// let bytes = std::fs::read("../../examples/five-wheel/log.mcap")?;
    /// let files = [("run_0.mcap".into(), std::io::Cursor::new(bytes))];
    /// let log = Log::over_all(files, None, &robot.topics)?;
    /// assert_eq!(log.samples(&[])?.count(), 6 * 2001);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Log::find_any`].
    pub fn over_all(
        files: impl IntoIterator<Item = (PathBuf, impl Read + Seek + Send + 'static)>,
        map: Option<ColumnMap>,
        topics: &Topics,
    ) -> Result<Self> {
        let sources = files
            .into_iter()
            .map(|(name, source)| Source::over(&name, source));
        Self::of_sources(sources.collect(), map, topics)
    }

    /// As [`Log::over`], of an input that is still written: it is read as it grows. `wait` is called where more is needed
    /// than is there, and pauses; the log is given once its topics are known. It ends with the footer of an MCAP file, with
    /// the index of a bag, and where the input has become shorter. Samples of topics are held back by half a second.
    ///
    /// ```
    /// use grouser_files::robot;
    /// use grouser_log::Log;
    ///
    /// let robot = robot::read("../../examples/five-wheel/robot.toml".as_ref())?;
    /// let path = "../../examples/five-wheel/log.mcap";
    /// let wait = || std::thread::sleep(std::time::Duration::from_millis(50));
    /// let log = Log::growing(path.as_ref(), std::fs::File::open(path)?, wait, None, &robot.topics)?;
    /// assert_eq!(log.samples(&[])?.count(), 6 * 2001); // the file has its footer: nothing is waited for
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Log::find_any`].
    pub fn growing(
        name: &Path,
        source: impl Read + Seek + Send + 'static,
        wait: impl Fn() + Send + Sync + 'static,
        map: Option<ColumnMap>,
        topics: &Topics,
    ) -> Result<Self> {
        Self::of_growing(Source::growing(name, source, wait), map, topics)
    }

    /// As [`Log::growing`], of the file at `path`. Of a recording in numbered files (`run_0.mcap`, `run_1.mcap`, …), as
    /// `ros2 bag record` and `rosbag record --split` write it, the next file is read on once one is completed; `path` may
    /// be the folder of one such recording. It ends where `metadata.yaml` is in the folder, or where no other file was
    /// begun for 10 s after the last byte.
    ///
    /// ```
    /// use grouser_files::robot;
    /// use grouser_log::Log;
    ///
    /// let robot = robot::read("../../examples/five-wheel/robot.toml".as_ref())?;
    /// let path = "../../examples/five-wheel/log.mcap";
    /// let wait = || std::thread::sleep(std::time::Duration::from_millis(50));
    /// let log = Log::following(path.as_ref(), wait, None, &robot.topics)?;
    /// assert_eq!(log.samples(&[])?.count(), 6 * 2001);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Log::find_any`]; [`Error::NoRecording`] and [`Error::TwoRecordings`] of a folder.
    pub fn following(
        path: &Path,
        wait: impl Fn() + Send + Sync + 'static,
        map: Option<ColumnMap>,
        topics: &Topics,
    ) -> Result<Self> {
        let first = first_file(path)?;
        let input = SplitRecording::open(&first)?;
        Self::of_growing(Source::growing(&first, input, wait), map, topics)
    }

    fn of_growing(source: Source, map: Option<ColumnMap>, topics: &Topics) -> Result<Self> {
        // a kind of file is known by its first bytes
        let mut known = 0;
        while known < MAGIC_BYTES && source.is_growing() {
            known = source.grown(known)?;
        }
        Self::of_sources(vec![source], map, topics)
    }

    fn of_sources(sources: Vec<Source>, map: Option<ColumnMap>, topics: &Topics) -> Result<Self> {
        let map = map.unwrap_or_default();
        let names: Vec<String> = sources.iter().map(Source::name).collect();
        let names = names.join(", ");
        let files = sort(&names, sources, &map)?;
        Self::of(&names, files, map, topics)
    }

    fn of(
        log: &str,
        (tables, recordings): (Vec<Source>, Vec<Source>),
        map: ColumnMap,
        topics: &Topics,
    ) -> Result<Self> {
        let recording = if recordings.is_empty() {
            None
        } else {
            Some(Recording::open(recordings, topics)?)
        };
        let mut files: Vec<(Source, usize)> = Vec::new();
        let mut unused = Vec::new();
        for file in tables {
            let Some(table) = table_of(&map, &file) else {
                unused.push(file);
                continue;
            };
            if let Some((first, _)) = files.iter().find(|(_, other)| *other == table) {
                return Err(Error::TwoFiles {
                    first: first.name(),
                    second: file.name(),
                    pattern: pattern(&map, table),
                });
            }
            files.push((file, table));
        }
        if files.is_empty() && recording.is_none() {
            unused.iter().try_for_each(Source::refuse_database)?;
            let patterns: Vec<String> = (0..map.tables.len()).map(|t| pattern(&map, t)).collect();
            return Err(Error::NoTable {
                log: log.to_owned(),
                patterns: patterns.join(", "),
            });
        }
        let mut wheels = recording
            .as_ref()
            .map_or_else(Vec::new, |recording| recording.choice.wheels.clone());
        let columns = files
            .iter()
            .flat_map(|(_, table)| &map.tables[*table].columns);
        for wheel in columns.filter_map(|column| column.wheel.as_ref()) {
            if !wheels.contains(wheel) {
                wheels.push(wheel.clone());
            }
        }
        let mut notes = recording
            .as_ref()
            .map_or_else(Vec::new, |recording| recording.choice.notes.clone());
        let columns = |index: usize| &map.tables[files[index].1].columns;
        let gives_places = |index: &usize| Slots::new(columns(*index), &wheels).gives_places();
        let with_places: Vec<usize> = (0..files.len()).filter(gives_places).collect();
        // a pose, or a way that is measured, says more
        let others = [Meaning::PoseYaw, Meaning::DisplacementForward];
        let measures_motion = |meaning: &Meaning| {
            let all = (0..files.len()).flat_map(columns);
            let recording = recording.as_ref();
            all.into_iter().any(|column| column.meaning == *meaning)
                || recording.is_some_and(|all| all.choice.measures(*meaning))
        };
        let mut places = None;
        let mut fixes = FixColumns::new(topics.position_sigma);
        for index in with_places {
            let (source, table) = (&files[index].0, &map.tables[files[index].1]);
            let name = source.name();
            if places.is_none() && !others.iter().any(measures_motion) {
                let (sigma, note) = if Slots::new(&table.columns, &wheels).gives_fixes() {
                    let counts = Counts::default();
                    let reader = CsvReader::open(&source.as_it_is(), table, (&wheels, 0, &counts));
                    // what is wrong with the table is said where it is read
                    let first = reader.map(|reader| reader.first_fixes(fixes.clone()));
                    let (found, note) = first.unwrap_or_default().choose(&name);
                    fixes = found.map_or(fixes.clone(), |(_, limit)| fixes.with_limit(limit));
                    (found.map(|(sigma, _)| sigma), note)
                } else {
                    let (sigma, note) = place_sigma(&name, topics);
                    (Some(sigma), note)
                };
                notes.extend(note);
                places = sigma.map(|sigma| (index, sigma));
            } else {
                notes.push(format!(
                    "`{name}`: its places without a heading are not used, since the log has another reference"
                ));
            }
        }
        Ok(Self {
            places,
            fixes,
            antenna: topics.antenna,
            notes,
            map,
            files,
            recording,
            unused: unused.iter().map(|file| file.path().to_owned()).collect(),
            wheels,
            look_ahead: TABLE_LOOK_AHEAD,
            counts: Counts::default(),
        })
    }

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
        let mut samples = Samples::new(self.places.map(track));
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

/// Tables, and bags and MCAP files, of the files of one run at `path`.
fn sort(path: &str, files: Vec<Source>, map: &ColumnMap) -> Result<(Vec<Source>, Vec<Source>)> {
    let (bags, tables): (Vec<Source>, Vec<Source>) = files.into_iter().partition(is_recording);
    // A run that was written in two formats would count twice.
    if !bags.is_empty() && tables.iter().any(|file| table_of(map, file).is_some()) {
        return Err(Error::Mixed {
            path: path.to_owned(),
        });
    }
    Ok((tables, bags))
}

/// Is it an MCAP file or a bag? An error of the system is left to the reader that opens the file.
fn is_recording(file: &Source) -> bool {
    matches!(Container::kind_of(file), Ok(Some(_)))
}

/// The table of the map that describes a file.
fn table_of(map: &ColumnMap, file: &Source) -> Option<usize> {
    let name = file
        .path()
        .file_name()
        .unwrap_or_default()
        .to_string_lossy();
    map.tables.iter().position(|table| table.describes(&name))
}

fn pattern(map: &ColumnMap, table: usize) -> String {
    map.tables[table].file.clone().unwrap_or_else(|| "*".into())
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

    fn position_sigma(&self) -> Option<f64> {
        self.position_sigma()
    }
}
