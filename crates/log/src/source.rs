//! What a log is read from: a file, or anything that can be read from any place.

mod nmea;
pub(crate) mod zstd_file;

use std::fs;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use flate2::bufread::MultiGzDecoder;
use grouser_files::regular;

use crate::error::{Cell, Error, Result};
use crate::foreign;
use nmea::NmeaTable;
use zstd_file::ZstdFile;

/// How many bytes compressed data may unfold to in all for each of its own bytes, beyond the first 64 MiB: a file of many small bombs
/// would take minutes. Logs unfold to less than a hundred.
const UNFOLDING: u64 = 256;

/// What compressed data of `packed` bytes may unfold to, bytes.
pub(crate) const fn unfolded_limit(packed: u64) -> u64 {
    (64 << 20) + UNFOLDING.saturating_mul(packed)
}

const BUFFER_BYTES: usize = 1 << 16;
const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// What can be read from any place.
pub(crate) trait Input: Send {
    /// How many bytes it has.
    fn length(&mut self) -> io::Result<u64>;

    /// Reads at `offset`, as much as comes at once.
    fn read_at(&mut self, offset: u64, buffer: &mut [u8]) -> io::Result<usize>;

    /// The writer has completed the file that ends at `offset`: does nothing follow it?
    fn ends_at(&mut self, _offset: u64) -> bool {
        true
    }

    /// Why the writer writes no more into it although it did not complete it; `None` while it may.
    fn abandoned(&mut self) -> Option<&'static str> {
        None
    }
}

impl<T: Read + Seek + Send> Input for T {
    fn length(&mut self) -> io::Result<u64> {
        self.seek(SeekFrom::End(0))
    }

    fn read_at(&mut self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        self.seek(SeekFrom::Start(offset))?;
        loop {
            match self.read(buffer) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                done => return done,
            }
        }
    }
}

/// An input that is still written, for all of its readers.
#[derive(Clone)]
struct Growth {
    /// Called where a reader needs more than the input has; it pauses.
    wait: Arc<dyn Fn() + Send + Sync>,
    has_ended: Arc<AtomicBool>,
    /// Up to here the writer has completed what it wrote; 0 where nothing is.
    completed: Arc<AtomicU64>,
    /// Why it ended before it was completed.
    abandoned: Arc<OnceLock<&'static str>>,
}

impl Growth {
    fn abandon(&self, why: &'static str) {
        // the first reason counts
        let _ = self.abandoned.set(why);
        self.has_ended.store(true, Ordering::Relaxed);
    }
}

const TRUNCATED: &str =
    "it was truncated while it was followed: what was written since is not read";

/// One input under several readers, each of which has its own position.
#[derive(Clone)]
pub(crate) struct Shared {
    input: Arc<Mutex<Box<dyn Input>>>,
    growth: Option<Growth>,
}

impl Shared {
    pub(crate) fn new(source: impl Input + 'static) -> Self {
        Self {
            input: Arc::new(Mutex::new(Box::new(source))),
            growth: None,
        }
    }

    fn input(&self) -> MutexGuard<'_, Box<dyn Input>> {
        // a reader that panicked left no position behind: each read has its own
        self.input.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// How many bytes it holds.
    pub(crate) fn length(&self) -> io::Result<u64> {
        self.input().length()
    }

    /// May it have more bytes later?
    pub(crate) fn is_growing(&self) -> bool {
        let growth = self.growth.as_ref();
        growth.is_some_and(|growth| !growth.has_ended.load(Ordering::Relaxed))
    }

    /// The writer has completed what stands before `offset`: nobody waits for more, unless another file follows.
    pub(crate) fn complete(&self, offset: u64) {
        if let Some(growth) = &self.growth {
            growth.completed.fetch_max(offset, Ordering::Relaxed);
            self.end_growth(growth, offset);
        }
    }

    /// Ends the waiting if nothing follows what was completed.
    fn end_growth(&self, growth: &Growth, offset: u64) {
        if self.input().ends_at(offset) {
            growth.has_ended.store(true, Ordering::Relaxed);
        }
    }

    /// Waits until it has more than `known` bytes; how many it has then. An input that was truncated, or whose name now is
    /// that of another, ends.
    pub(crate) fn grown(&self, known: u64) -> io::Result<u64> {
        loop {
            let length = self.length()?;
            let Some(growth) = self.growth.as_ref().filter(|_| self.is_growing()) else {
                return Ok(length);
            };
            let completed = growth.completed.load(Ordering::Relaxed);
            if length < known {
                growth.abandon(TRUNCATED);
            } else if length > known {
                return Ok(length);
            } else if completed > 0 && length <= completed {
                self.end_growth(growth, completed);
            } else if let Some(why) = self.abandoned_at(length) {
                growth.abandon(why);
            }
            if self.is_growing() {
                (growth.wait)();
            }
        }
    }

    /// Why the writer writes no more behind `length`; what it wrote before is still read.
    fn abandoned_at(&self, length: u64) -> Option<&'static str> {
        let mut input = self.input();
        let why = input.abandoned();
        why.filter(|_| input.length().is_ok_and(|now| now == length))
    }

    /// The same input, as if what it has now were all.
    fn as_it_is(&self) -> Self {
        Self {
            growth: None,
            ..self.clone()
        }
    }

    /// Reads at `offset`, as much as comes at once.
    pub(crate) fn read_at(&self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        self.input().read_at(offset, buffer)
    }
}

/// A file of a log: opened whenever it is read, or held open by the caller.
#[derive(Clone)]
pub(crate) struct Source {
    path: PathBuf,
    held: Option<Shared>,
}

impl std::fmt::Debug for Source {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Source").field(&self.path).finish()
    }
}

impl Source {
    pub(crate) const fn file(path: PathBuf) -> Self {
        Self { path, held: None }
    }

    pub(crate) fn over(name: &Path, source: impl Input + 'static) -> Self {
        Self {
            path: name.to_owned(),
            held: Some(Shared::new(source)),
        }
    }

    /// An input that is still written; `wait` is called where a reader needs more than it has.
    pub(crate) fn growing(
        name: &Path,
        source: impl Input + 'static,
        wait: impl Fn() + Send + Sync + 'static,
    ) -> Self {
        let growth = Some(Growth {
            wait: Arc::new(wait),
            has_ended: Arc::default(),
            completed: Arc::default(),
            abandoned: Arc::default(),
        });
        Self {
            path: name.to_owned(),
            held: Some(Shared {
                growth,
                ..Shared::new(source)
            }),
        }
    }

    /// May it have more bytes later?
    pub(crate) fn is_growing(&self) -> bool {
        self.held.as_ref().is_some_and(Shared::is_growing)
    }

    /// Why its writer abandoned it before it was complete.
    pub(crate) fn abandoned(&self) -> Option<&'static str> {
        let growth = self.held.as_ref().and_then(|held| held.growth.as_ref());
        growth.and_then(|growth| growth.abandoned.get().copied())
    }

    /// Waits until it has more than `known` bytes; how many it has then.
    pub(crate) fn grown(&self, known: u64) -> Result<u64> {
        let grown = self.open()?.grown(known);
        grown.map_err(|source| {
            let file = self.name();
            grouser_files::Error::Unreadable { file, source }.into()
        })
    }

    /// The same input, as if what it has now were all.
    pub(crate) fn as_it_is(&self) -> Self {
        Self {
            path: self.path.clone(),
            held: self.held.as_ref().map(Shared::as_it_is),
        }
    }

    /// Its path, or the name that the caller gave it.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Opens it for reading at any place.
    pub(crate) fn open(&self) -> Result<Shared> {
        Ok(match &self.held {
            Some(held) => held.clone(),
            None => match ZstdFile::open(&self.path)? {
                Some(expanded) => Shared::new(expanded),
                None => Shared::new(regular::open(&self.path)?),
            },
        })
    }

    /// How many bytes it holds, compressed or not.
    pub(crate) fn bytes(&self) -> u64 {
        match &self.held {
            Some(held) => held.length().unwrap_or(0),
            None => fs::metadata(&self.path).map_or(0, |file| file.len()),
        }
    }

    /// Refuses files of other programs. What cannot be opened is left to the reader that opens the file.
    pub(crate) fn refuse_foreign(&self) -> Result<()> {
        let mut start = [0; foreign::LOOKED_BYTES];
        let read = self.open().map(|shared| shared.read_at(0, &mut start));
        match read {
            Ok(Ok(length)) => foreign::refuse(&self.name(), &start[..length]),
            _ => Ok(()),
        }
    }

    /// Opens it as text; gzip is known by its first bytes, whatever the name. Bytes that are read are added to `count`.
    pub(crate) fn text(&self, count: &Arc<AtomicU64>) -> Result<Box<dyn BufRead + Send>> {
        self.refuse_foreign()?;
        let counted = Counted {
            source: self.open()?,
            offset: 0,
            count: Arc::clone(count),
        };
        let mut file = BufReader::with_capacity(BUFFER_BYTES, counted);
        let start = first_bytes(&mut file).map_err(|source| unreadable(self.name(), source))?;
        if start == GZIP_MAGIC {
            let decoder = MultiGzDecoder::new(file);
            let mut text = BufReader::with_capacity(BUFFER_BYTES, decoder);
            // what cannot be expanded is reported where it is read
            if let Ok(start) = text.fill_buf() {
                foreign::refuse_packed(&self.name(), start)?;
            }
            Ok(Box::new(text))
        } else if nmea::begins(&start) {
            let table = NmeaTable::new(file).map_err(|source| unreadable(self.name(), source))?;
            Ok(Box::new(BufReader::new(table)))
        } else {
            Ok(Box::new(file))
        }
    }
}

fn unreadable(file: String, source: io::Error) -> Error {
    let at = Cell {
        file,
        line: 1,
        column: None,
        name: None,
    };
    Error::Unreadable { at, source }
}

/// A source from its beginning, whose bytes are counted as they are read.
struct Counted {
    source: Shared,
    offset: u64,
    count: Arc<AtomicU64>,
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut length = self.source.read_at(self.offset, buffer)?;
        while length == 0 && !buffer.is_empty() && self.source.grown(self.offset)? > self.offset {
            length = self.source.read_at(self.offset, buffer)?;
        }
        self.offset += length as u64;
        self.count.fetch_add(length as u64, Ordering::Relaxed);
        Ok(length)
    }
}

fn first_bytes(file: &mut impl BufRead) -> io::Result<[u8; 2]> {
    let buffer = file.fill_buf()?;
    Ok(match buffer {
        [a, b, ..] => [*a, *b],
        _ => [0; 2],
    })
}
