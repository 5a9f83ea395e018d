//! From paths and inputs to the tables and recordings of a log.

use std::io::{Read, Seek};
use std::path::{Path, PathBuf};

use grouser_files::columns::{Column, ColumnMap, Meaning};
use grouser_files::topics::Topics;

use super::Log;
use crate::container::Container;
use crate::csv::{Counts, CsvReader, TABLE_LOOK_AHEAD};
use crate::error::{Error, Result};
use crate::find::expand;
use crate::recording::Recording;
use crate::recording::navigation::{FixColumns, place_sigma};
use crate::slots::Slots;
use crate::source::Source;
use crate::split::{SplitRecording, first_file};

/// A file's first bytes, which show its kind.
const MAGIC_BYTES: u64 = 16;

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
        found.iter().try_for_each(Source::refuse_foreign)?;
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
        Self::from_files(&log.join(", "), (tables, recordings), map, topics)
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
        Self::from_files(&names, files, map, topics)
    }

    fn from_files(
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
            unused.iter().try_for_each(Source::refuse_foreign)?;
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
        let (places, fixes) = places((&files, &map), (&recording, &wheels), topics, &mut notes);
        let of_pose = |column: &Column| column.meaning == Meaning::PoseYaw;
        let has_pose = recording
            .as_ref()
            .is_some_and(|all| all.choice.measures(Meaning::PoseYaw))
            || files
                .iter()
                .any(|(_, table)| map.tables[*table].columns.iter().any(of_pose));
        if topics.antenna != [0.0; 2] && places.is_none() && has_pose {
            return Err(Error::NoPlaces {
                log: log.to_owned(),
            });
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
}

/// Which of the tables of `files` tells places without a heading that are used, with their standard deviation (m), and how its fixes
/// are read. What is chosen and what is left out goes to the notes.
fn places(
    (files, map): (&[(Source, usize)], &ColumnMap),
    (recording, wheels): (&Option<Recording>, &[String]),
    topics: &Topics,
    notes: &mut Vec<String>,
) -> (Option<(usize, f64)>, FixColumns) {
    let columns = |index: usize| &map.tables[files[index].1].columns;
    let gives_places = |index: &usize| Slots::new(columns(*index), wheels).gives_places();
    let with_places: Vec<usize> = (0..files.len()).filter(gives_places).collect();
    // a pose, or a way that is measured, says more
    let others = [
        Meaning::PoseYaw,
        Meaning::OrientationZ,
        Meaning::DisplacementForward,
    ];
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
            let (sigma, note) = if Slots::new(&table.columns, wheels).gives_fixes() {
                let counts = Counts::default();
                let reader = CsvReader::open(&source.as_it_is(), table, (wheels, 0, &counts));
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
    (places, fixes)
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
