//! Recordings that a recorder splits into numbered files: `run_0.mcap`, `run_1.mcap` and so on.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use grouser_files::regular;

use crate::error::{Error, Result};
use crate::find::run_files;
use crate::source::Input;

/// A recorder opens its next file when it closes one. One that has not after this time has ended.
const NEXT_FILE_TIME: Duration = Duration::from_secs(10);
/// `ros2 bag record` writes this file when it ends.
const END_OF_RECORDING: &str = "metadata.yaml";
const REPLACED: &str =
    "it was renamed, replaced or removed while it was followed: what was written since is not read";
/// How the names of recordings end, by their format; ROS 1 renames a bag when it is closed.
const ENDINGS: [(&str, bool); 3] = [(".mcap", false), (".bag", true), (".bag.active", true)];

/// A file name of a split recording.
struct Numbered<'a> {
    /// What stands before the number.
    stem: &'a str,
    number: u64,
    is_bag: bool,
}

impl<'a> Numbered<'a> {
    fn parse(name: &'a str) -> Option<Self> {
        let mut endings = ENDINGS.iter();
        let (name, is_bag) =
            endings.find_map(|(ending, is_bag)| Some((name.strip_suffix(ending)?, *is_bag)))?;
        let (stem, number) = name.rsplit_once('_')?;
        let is_number = number.bytes().all(|byte| byte.is_ascii_digit());
        Some(Self {
            stem,
            number: number.parse().ok().filter(|_| is_number)?,
            is_bag,
        })
    }

    /// Are both of one recording? The stems of ROS 1 differ in the time at which each file was begun.
    fn belongs_to(&self, other: &Self) -> bool {
        let mask = |stem: &str| stem.replace(|c: char| c.is_ascii_digit(), "0");
        self.is_bag == other.is_bag && mask(self.stem) == mask(other.stem)
    }
}

fn name(path: &Path) -> &str {
    path.file_name()
        .and_then(|name| name.to_str())
        .unwrap_or_default()
}

/// The file of a recording that follows `path`, if it has begun.
fn next_file(path: &Path) -> Option<PathBuf> {
    let own = Numbered::parse(name(path))?;
    let mut found: Vec<PathBuf> = files_beside(path)
        .filter(|other| {
            Numbered::parse(name(other)).is_some_and(|next| {
                Some(next.number) == own.number.checked_add(1)
                    && next.belongs_to(&own)
                    && next.stem >= own.stem
            })
        })
        .collect();
    // where two recordings have names alike, that which began next
    found.sort();
    found.into_iter().next()
}

fn files_beside(path: &Path) -> impl Iterator<Item = PathBuf> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|entry| entry.path())
}

/// The first file of the one recording in a folder; a path to a file is that file.
pub(crate) fn first_file(path: &Path) -> Result<PathBuf> {
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    let mut found: Vec<PathBuf> = run_files(path)?
        .into_iter()
        .filter(|file| ENDINGS.iter().any(|(end, _)| name(file).ends_with(end)))
        .collect();
    // run_10 follows run_9
    found.sort_by_key(|file| Numbered::parse(name(file)).map(|own| own.number));
    let Some(first) = found.first() else {
        return Err(Error::NoRecording {
            folder: path.display().to_string(),
        });
    };
    let own = Numbered::parse(name(first));
    let is_other = |file: &&PathBuf| {
        let other = Numbered::parse(name(file));
        !matches!((&own, other), (Some(own), Some(other)) if own.number != other.number && own.belongs_to(&other))
    };
    match found.iter().skip(1).find(is_other) {
        Some(second) => Err(Error::TwoRecordings {
            first: first.display().to_string(),
            second: second.display().to_string(),
        }),
        None => Ok(first.clone()),
    }
}

struct Part {
    path: PathBuf,
    file: File,
    /// Where it stands in the whole.
    begin: u64,
}

/// The files of a recording that is still written, as one input: each stands behind the one before. A file is followed by
/// the next once it was completed.
pub(crate) struct SplitRecording {
    /// Those that have begun, at least one.
    before: Vec<Part>,
    last: Part,
    /// Up to here the recorder has completed what it wrote.
    completed: u64,
}

impl SplitRecording {
    pub(crate) fn open(path: &Path) -> Result<Self> {
        Ok(Self {
            before: Vec::new(),
            last: Part {
                path: path.to_owned(),
                file: regular::open(path)?,
                begin: 0,
            },
            completed: 0,
        })
    }

    fn end(&self) -> io::Result<u64> {
        Ok(self.last.begin + self.last.file.metadata()?.len())
    }
}

impl Input for SplitRecording {
    fn length(&mut self) -> io::Result<u64> {
        let end = self.end()?;
        if end > self.completed {
            return Ok(end);
        }
        // one without content may be begun anew by its writer
        let next = next_file(&self.last.path);
        let Some(path) = next.filter(|path| fs::metadata(path).is_ok_and(|file| file.len() > 0))
        else {
            return Ok(end);
        };
        let file = regular::open(&path).map_err(io::Error::other)?;
        let begin = end;
        let next = Part { path, file, begin };
        self.before.push(std::mem::replace(&mut self.last, next));
        self.end()
    }

    fn abandoned(&mut self) -> Option<&'static str> {
        // ROS 1 renames a bag when it is closed
        let path = self.last.path.to_string_lossy();
        let closed = path.strip_suffix(".active").map(PathBuf::from);
        let names = std::iter::once(&self.last.path).chain(&closed);
        let mut found = names.filter_map(|name| fs::metadata(name).ok());
        let own = self.last.file.metadata().ok()?;
        (!found.any(|named| is_same(&own, &named))).then_some(REPLACED)
    }

    fn read_at(&mut self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        let (part, end) = if offset >= self.last.begin {
            (&mut self.last, u64::MAX)
        } else {
            // the first begins at 0
            let next = self.before.partition_point(|part| part.begin <= offset);
            let end = self.before.get(next).unwrap_or(&self.last).begin;
            (&mut self.before[next - 1], end)
        };
        let room = usize::try_from(end - offset).unwrap_or(usize::MAX);
        let length = buffer.len().min(room);
        Input::read_at(&mut part.file, offset - part.begin, &mut buffer[..length])
    }

    fn ends_at(&mut self, offset: u64) -> bool {
        if Numbered::parse(name(&self.last.path)).is_none() {
            return true;
        }
        self.completed = self.completed.max(offset);
        if self.end().is_ok_and(|end| offset < end) {
            return false;
        }
        // looked at before the next file: a recorder that ends writes it last
        let has_ended = self.last.path.with_file_name(END_OF_RECORDING).is_file()
            || self.last.file.metadata().is_ok_and(|file| {
                let age = file.modified().map(|at| at.elapsed().unwrap_or_default());
                age.is_ok_and(|age| age > NEXT_FILE_TIME)
            });
        has_ended && next_file(&self.last.path).is_none()
    }
}

#[cfg(unix)]
fn is_same(one: &fs::Metadata, other: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

/// Elsewhere a file that is open is neither renamed nor replaced.
#[cfg(not(unix))]
fn is_same(_: &fs::Metadata, _: &fs::Metadata) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_one_recording_have_numbers_that_follow_each_other() {
        let folder = std::env::temp_dir().join(format!("grouser-split-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let names = [
            "run_9.mcap",
            "run_10.mcap",
            "run_10.bag",
            "other_10.mcap",
            "run_x.mcap",
            "tour_2026-11-23-07-41-07_0.bag",
            "tour_2026-11-23-07-51-07_1.bag",
            "tour_2026-11-23-08-01-07_2.bag.active",
            "tour_2026-11-22-07-00-00_1.bag",
        ];
        for name in names {
            fs::write(folder.join(name), "content").unwrap();
        }
        let next = |own: &str| next_file(&folder.join(own)).map(|next| name(&next).to_owned());
        assert_eq!(next(names[0]).as_deref(), Some(names[1]));
        assert_eq!(next(names[1]), None);
        assert_eq!(next(names[4]), None);
        assert_eq!(next(names[5]).as_deref(), Some(names[6]));
        assert_eq!(next(names[6]).as_deref(), Some(names[7]));
        // two recordings in one folder
        assert!(matches!(
            first_file(&folder),
            Err(Error::TwoRecordings { .. })
        ));
        for name in &names[2..] {
            fs::remove_file(folder.join(name)).unwrap();
        }
        assert_eq!(first_file(&folder).unwrap(), folder.join(names[0]));
        for name in &names[..2] {
            fs::remove_file(folder.join(name)).unwrap();
        }
        assert!(matches!(
            first_file(&folder),
            Err(Error::NoRecording { .. })
        ));
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_bare_name_has_its_files_beside_it() {
        // tests run in the crate's folder
        let mut beside = files_beside("run_0.mcap".as_ref());
        assert!(beside.any(|file| name(&file) == "Cargo.toml"));
    }

    #[test]
    fn bytes_come_from_the_file_that_has_them() {
        let folder = std::env::temp_dir().join(format!("grouser-parts-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = |number: u32| folder.join(format!("run_{number}.mcap"));
        fs::write(path(0), "abc").unwrap();
        let mut input = SplitRecording::open(&path(0)).unwrap();
        fs::write(path(1), "").unwrap();
        assert!(!input.ends_at(3));
        assert_eq!(input.length().unwrap(), 3, "not before it has begun");
        // its writer begins it anew
        fs::remove_file(path(1)).unwrap();
        fs::write(folder.join("held"), "another file in its place").unwrap();
        fs::write(path(1), "defgh").unwrap();
        assert_eq!(input.length().unwrap(), 8);
        fs::remove_file(path(1)).unwrap();
        let mut input = SplitRecording::open(&path(0)).unwrap();
        fs::write(path(1), "defgh").unwrap();
        fs::write(path(2), "ijk").unwrap();
        assert_eq!(input.length().unwrap(), 3, "not before it is completed");
        assert!(!input.ends_at(3));
        assert_eq!(input.length().unwrap(), 8);
        assert!(!input.ends_at(8));
        assert_eq!(input.length().unwrap(), 11);
        let mut all = Vec::new();
        let mut buffer = [0; 4];
        loop {
            let count = input.read_at(all.len() as u64, &mut buffer).unwrap();
            if count == 0 {
                break;
            }
            all.extend_from_slice(&buffer[..count]);
        }
        assert_eq!(all, b"abcdefghijk");
        // a recorder that wrote its last file says so, or writes no other for a while
        assert!(!input.ends_at(11));
        fs::write(folder.join(END_OF_RECORDING), "").unwrap();
        assert!(input.ends_at(11));
        assert!(!input.ends_at(10), "a byte follows");
        fs::remove_file(folder.join(END_OF_RECORDING)).unwrap();
        assert!(!input.ends_at(11));
        let before = std::time::SystemTime::now() - 2 * NEXT_FILE_TIME;
        let last = fs::OpenOptions::new().append(true).open(path(2)).unwrap();
        last.set_modified(before).unwrap();
        assert!(input.ends_at(11));
        fs::remove_dir_all(folder).unwrap();
    }
}
