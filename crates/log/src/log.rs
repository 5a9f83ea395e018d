//! A log: the files of one run, merged.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use grouser_files::columns::{ColumnMap, Meaning};
use grouser_files::topics::Topics;

use crate::container::Container;
use crate::csv::CsvReader;
use crate::error::{Error, Result};
use crate::messages::LeftOut;
use crate::record::Record;
use crate::recording::{Recording, RecordingReader, UsedTopic};
use crate::source;

/// The files of one run with what their columns or topics mean.
#[derive(Clone, Debug)]
pub struct Log {
    map: ColumnMap,
    /// Tables, each with the table of the map that describes it.
    files: Vec<(PathBuf, usize)>,
    /// Bags and MCAP files.
    recording: Option<Recording>,
    unused: Vec<PathBuf>,
    wheels: Vec<String>,
    /// Bytes read of the files, by all readers together.
    read: Arc<AtomicU64>,
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
    pub fn find(paths: &[PathBuf], map: ColumnMap) -> Result<Self> {
        Self::find_any(paths, Some(map), &Topics::default())
    }

    /// Does one of the paths hold a table, which is read through a column map?
    ///
    /// # Errors
    /// What the system refuses.
    pub fn needs_columns(paths: &[PathBuf]) -> Result<bool> {
        let mut found = Vec::new();
        for path in paths {
            expand(path, &mut found)?;
        }
        if found.iter().any(|path| is_recording(path)) {
            return Ok(false);
        }
        for path in &found {
            source::refuse_database(path)?;
        }
        Ok(true)
    }

    /// As [`Log::find`]; the files may be bags and MCAP files as well, whose topics are chosen by
    /// `topics` and, where that says nothing, by type and name.
    ///
    /// # Errors
    /// As [`Log::find`]; [`Error::NoNamedTopic`], [`Error::UnfitTopic`], [`Error::NoJoints`] where
    /// `topics` does not fit what the files hold.
    pub fn find_any(paths: &[PathBuf], map: Option<ColumnMap>, topics: &Topics) -> Result<Self> {
        let map = map.unwrap_or(ColumnMap { tables: Vec::new() });
        let (mut found, mut recordings) = (Vec::new(), Vec::new());
        for path in paths {
            let mut here = Vec::new();
            expand(path, &mut here)?;
            let (bags, others): (Vec<PathBuf>, Vec<PathBuf>) =
                here.into_iter().partition(|path| is_recording(path));
            let is_table = |path: &PathBuf| {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                map.tables.iter().any(|table| table.describes(&name))
            };
            // A run that was written in two formats would count twice.
            if !bags.is_empty() && others.iter().any(is_table) {
                return Err(Error::Mixed {
                    path: path.display().to_string(),
                });
            }
            recordings.extend(bags);
            found.extend(others);
        }
        let recording = if recordings.is_empty() {
            None
        } else {
            Some(Recording::open(recordings, topics)?)
        };
        let mut files: Vec<(PathBuf, usize)> = Vec::new();
        let mut unused = Vec::new();
        for path in found {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let Some(table) = map.tables.iter().position(|table| table.describes(&name)) else {
                unused.push(path);
                continue;
            };
            if let Some((first, _)) = files.iter().find(|(_, other)| *other == table) {
                return Err(Error::TwoFiles {
                    first: first.display().to_string(),
                    second: path.display().to_string(),
                    pattern: pattern(&map, table),
                });
            }
            files.push((path, table));
        }
        if files.is_empty() && recording.is_none() {
            for file in &unused {
                source::refuse_database(file)?;
            }
            let log: Vec<String> = paths.iter().map(|p| p.display().to_string()).collect();
            let patterns: Vec<String> = (0..map.tables.len()).map(|t| pattern(&map, t)).collect();
            return Err(Error::NoTable {
                log: log.join(", "),
                patterns: patterns.join(", "),
            });
        }
        let mut wheels = recording
            .as_ref()
            .map_or_else(Vec::new, |recording| recording.wheels.clone());
        for column in files
            .iter()
            .flat_map(|(_, table)| &map.tables[*table].columns)
        {
            if let Some(wheel) = &column.wheel
                && !wheels.contains(wheel)
            {
                wheels.push(wheel.clone());
            }
        }
        Ok(Self {
            map,
            files,
            recording,
            unused,
            wheels,
            read: Arc::default(),
        })
    }

    /// The files that are read.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let tables = self.files.iter().map(|(path, _)| path);
        let recordings = self.recording.iter().flat_map(|all| &all.files);
        tables.chain(recordings).map(PathBuf::as_path)
    }

    /// How many sources records may come from ([`Record::source`]): every table is one, and every topic
    /// that is used.
    #[must_use]
    pub fn sources(&self) -> usize {
        self.files.len() + self.recording.as_ref().map_or(0, Recording::sources)
    }

    /// The topics that are used of bags and MCAP files.
    pub fn topics(&self) -> impl Iterator<Item = UsedTopic> {
        self.recording.iter().flat_map(Recording::used)
    }

    /// What is to be known of how topics were chosen.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        self.recording.as_ref().map_or(&[], |all| &all.notes)
    }

    /// What was left out when the log was last read to its end: damage, messages that cannot be decoded
    /// or came too late. Tables leave nothing out.
    #[must_use]
    pub fn left_out(&self) -> LeftOut {
        let recording = self.recording.as_ref();
        recording.map_or_else(LeftOut::default, Recording::left_out)
    }

    /// How many bytes the files hold, as they stand (compressed or not).
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let sizes = self.files().filter_map(|path| fs::metadata(path).ok());
        sizes.map(|file| file.len()).sum()
    }

    /// How many of them have been read since the log was found, twice if it was read twice.
    #[must_use]
    pub fn bytes_read(&self) -> u64 {
        self.read.load(Ordering::Relaxed)
    }

    /// The files that fit no table of the column map.
    #[must_use]
    pub fn unused(&self) -> &[PathBuf] {
        &self.unused
    }

    /// The wheels that the log measures; records name them by their index here.
    #[must_use]
    pub fn wheels(&self) -> &[String] {
        &self.wheels
    }

    /// Does any column of the log have that meaning?
    #[must_use]
    pub fn measures(&self, meaning: Meaning) -> bool {
        let recording = self.recording.as_ref();
        recording.is_some_and(|all| all.measures(meaning))
            || self.files.iter().any(|(_, table)| {
                self.map.tables[*table]
                    .columns
                    .iter()
                    .any(|c| c.meaning == meaning)
            })
    }

    /// Does any column of the log have that meaning for that wheel?
    #[must_use]
    pub fn measures_wheel(&self, meaning: Meaning, wheel: &str) -> bool {
        let mut columns = self
            .files
            .iter()
            .flat_map(|(_, table)| &self.map.tables[*table].columns);
        let recording = self.recording.as_ref();
        recording.is_some_and(|all| all.measures_wheel(meaning, wheel))
            || columns.any(|c| c.meaning == meaning && c.wheel.as_deref() == Some(wheel))
    }

    /// The sources ([`Record::source`]) whose clock is to be aligned with the others'.
    #[must_use]
    pub fn unaligned_sources(&self) -> Vec<usize> {
        let tables = self.files.len();
        let recording = self.recording.iter().flat_map(Recording::unaligned);
        (0..tables)
            .filter(|&source| self.map.tables[self.files[source].1].align_clock)
            .chain(recording.map(|topic| tables + topic))
            .collect()
    }

    /// Opens the files and gives their records in the order of time. `shift_ns` is added to the times
    /// of each source.
    ///
    /// # Errors
    /// What is wrong with a file's header.
    pub fn records(&self, shift_ns: &[i64]) -> Result<Records> {
        let mut readers = Vec::new();
        for (source, (path, table)) in self.files.iter().enumerate() {
            let reader = CsvReader::open(
                path,
                &self.map.tables[*table],
                source,
                (&self.wheels, &self.read),
            )?;
            readers.push(Shifted {
                reader: Box::new(reader),
                shift_ns: shift_ns.get(source).copied().unwrap_or(0),
                next: None,
            });
        }
        if let Some(recording) = &self.recording {
            recording.begin();
            let first_source = self.files.len();
            for path in &recording.files {
                let reader =
                    RecordingReader::open(path, recording, first_source, (shift_ns, &self.read))?;
                readers.push(Shifted {
                    reader: Box::new(reader),
                    // Its topics have clocks of their own: it shifts them itself.
                    shift_ns: 0,
                    next: None,
                });
            }
        }
        Ok(Records {
            readers,
            failed: false,
        })
    }
}

/// Is it an MCAP file or a bag? What cannot be opened is left to whoever opens it.
fn is_recording(path: &Path) -> bool {
    matches!(Container::kind(path), Ok(Some(_)))
}

fn pattern(map: &ColumnMap, table: usize) -> String {
    map.tables[table].file.clone().unwrap_or_else(|| "*".into())
}

/// The files that a path of the command line means, by name.
fn expand(path: &Path, found: &mut Vec<PathBuf>) -> Result<()> {
    let file = || path.display().to_string();
    let unreadable = |source| grouser_files::Error::Unreadable {
        file: file(),
        source,
    };
    let mut inside = Vec::new();
    match fs::metadata(path) {
        Ok(kind) if kind.is_dir() => {
            for entry in fs::read_dir(path).map_err(unreadable)? {
                let entry = entry.map_err(unreadable)?.path();
                if entry.is_file() {
                    inside.push(entry);
                }
            }
        }
        Ok(_) => inside.push(path.to_path_buf()),
        Err(error) => {
            // Not there: perhaps the beginning of several names.
            let folder = match path.parent() {
                Some(parent) if parent.as_os_str().is_empty() => Path::new("."),
                Some(parent) => parent,
                None => return Err(unreadable(error).into()),
            };
            let start = path.file_name().unwrap_or_default().to_string_lossy();
            for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
                let name = entry.file_name();
                let own = name.to_string_lossy();
                if !start.is_empty() && own.starts_with(&*start) && entry.path().is_file() {
                    inside.push(entry.path());
                }
            }
            if inside.is_empty() {
                return Err(unreadable(error).into());
            }
        }
    }
    inside.sort();
    found.extend(inside);
    Ok(())
}

/// The records of a log in the order of time. The first error ends it.
pub struct Records {
    readers: Vec<Shifted>,
    failed: bool,
}

struct Shifted {
    reader: Box<dyn Iterator<Item = Result<Record>> + Send>,
    shift_ns: i64,
    next: Option<Record>,
}

impl Iterator for Records {
    type Item = Result<Record>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        for source in &mut self.readers {
            if source.next.is_none() {
                match source.reader.next() {
                    Some(Ok(mut record)) => {
                        record.time_ns = record.time_ns.saturating_add(source.shift_ns);
                        source.next = Some(record);
                    }
                    Some(Err(error)) => {
                        self.failed = true;
                        return Some(Err(error));
                    }
                    None => {}
                }
            }
        }
        let earliest = self
            .readers
            .iter_mut()
            .filter(|source| source.next.is_some())
            .min_by_key(|source| source.next.as_ref().map(|record| record.time_ns))?;
        earliest.next.take().map(Ok)
    }
}
