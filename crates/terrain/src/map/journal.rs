//! Finished strips on disk, so that an interrupted job goes on where it ended, and several computers share one.
//!
//! The file: 8 bytes of magic, the job's 64 hexadecimal digits, then a record for each strip in any order: index (u32), length
//! (u32), CRC-32 of the bytes (u32), all little-endian, and the bytes. A record that is cut short or damaged ends the file.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::strip::Strip;
use crate::error::{Error, Result};

const MAGIC: &[u8; 8] = b"GRSRMAP1";
const DIGITS: usize = 64;
const HEADER_BYTES: u64 = (MAGIC.len() + DIGITS) as u64;
/// A longer strip is none of ours: a packed strip is hardly longer than 4 MiB of cells, or one row of 65536 of them.
const MAX_STRIP_BYTES: u32 = 1 << 27;

/// The finished strips of a job.
#[derive(Debug)]
pub struct Journal {
    file: File,
    path: PathBuf,
    /// Where the bytes of each strip begin, and how many they are.
    places: BTreeMap<u32, (u64, u32)>,
    end: u64,
}

impl Journal {
    /// Opens the journal of a job, with the strips that it has already; a journal of another job is begun anew.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn open(path: &Path, job: &str) -> Result<Self> {
        let refuse = refused("write", path);
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .map_err(&refuse)?;
        if !file.metadata().map_err(&refuse)?.is_file() {
            return Err(refuse(io::Error::other("it is no regular file")));
        }
        let mut journal = Self {
            file,
            path: path.to_owned(),
            places: BTreeMap::new(),
            end: 0,
        };
        if !journal.is_journal().map_err(&refuse)? {
            return Err(refuse(io::Error::other(
                "it is there already and holds no strips: it would be overwritten",
            )));
        }
        if journal.read(job).map_err(&refuse)? {
            // what follows the last whole record was being written when the job ended
            journal.file.set_len(journal.end).map_err(&refuse)?;
        } else {
            journal.file.set_len(0).map_err(&refuse)?;
            journal
                .write_at(0, &[MAGIC, job.as_bytes()])
                .map_err(&refuse)?;
            (journal.places, journal.end) = (BTreeMap::new(), HEADER_BYTES);
        }
        Ok(journal)
    }

    /// Opens the journal of a shard to read it.
    ///
    /// # Errors
    /// [`Error::File`]; [`Error::NotAMap`] for another job's.
    pub fn of_shard(path: &Path, job: &str) -> Result<Self> {
        let refuse = refused("read", path);
        let mut journal = Self {
            file: File::open(path).map_err(&refuse)?,
            path: path.to_owned(),
            places: BTreeMap::new(),
            end: 0,
        };
        if journal.read(job).map_err(&refuse)? {
            return Ok(journal);
        }
        Err(Error::NotAMap {
            file: path.to_owned(),
            reason: "it holds no strips of this job: terrain, robot, soil and settings must be the same for all shards"
                .to_owned(),
        })
    }

    /// Is it empty, or the journal of some job?
    fn is_journal(&self) -> io::Result<bool> {
        let mut magic = Vec::new();
        let mut reader = &self.file;
        reader.seek(SeekFrom::Start(0))?;
        reader.take(MAGIC.len() as u64).read_to_end(&mut magic)?;
        Ok(MAGIC.starts_with(&magic))
    }

    /// Reads all whole records; `false` where it is not this job's.
    fn read(&mut self, job: &str) -> io::Result<bool> {
        let length = self.file.metadata()?.len();
        let mut reader = BufReader::new(&self.file);
        reader.seek(SeekFrom::Start(0))?;
        let mut header = [0; MAGIC.len() + DIGITS];
        if length < HEADER_BYTES {
            return Ok(false);
        }
        reader.read_exact(&mut header)?;
        if &header[..MAGIC.len()] != MAGIC || &header[MAGIC.len()..] != job.as_bytes() {
            return Ok(false);
        }
        let mut at = HEADER_BYTES;
        let mut bytes = Vec::new();
        while at + 12 <= length {
            let mut words = [[0; 4]; 3];
            for word in &mut words {
                reader.read_exact(word)?;
            }
            let [index, count, crc] = words.map(u32::from_le_bytes);
            let end = at + 12 + u64::from(count);
            if count > MAX_STRIP_BYTES || end > length {
                break;
            }
            bytes.resize(count as usize, 0);
            reader.read_exact(&mut bytes)?;
            if crc32fast::hash(&bytes) != crc {
                break;
            }
            self.places.insert(index, (at + 12, count));
            at = end;
        }
        self.end = at;
        Ok(true)
    }

    fn write_at(&mut self, at: u64, parts: &[&[u8]]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(at))?;
        for part in parts {
            self.file.write_all(part)?;
        }
        Ok(())
    }

    /// Does it have a strip?
    #[must_use]
    pub fn holds(&self, strip: u32) -> bool {
        self.places.contains_key(&strip)
    }

    /// Bytes of all its strips.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.places
            .values()
            .map(|(_, count)| u64::from(*count))
            .sum()
    }

    /// Adds a strip.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn add(&mut self, strip: &Strip) -> Result<()> {
        let count = u32::try_from(strip.bytes.len()).unwrap_or(u32::MAX);
        let head = [strip.index, count, crc32fast::hash(&strip.bytes)].map(u32::to_le_bytes);
        let at = self.end;
        self.write_at(at, &[head.as_flattened(), &strip.bytes])
            .map_err(refused("write", &self.path))?;
        self.places.insert(strip.index, (at + 12, count));
        self.end = at + 12 + u64::from(count);
        Ok(())
    }

    /// Reads a strip that it has.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn strip(&mut self, index: u32) -> Result<Option<Strip>> {
        let Some((at, count)) = self.places.get(&index).copied() else {
            return Ok(None);
        };
        let mut bytes = vec![0; count as usize];
        self.file
            .seek(SeekFrom::Start(at))
            .and_then(|_| self.file.read_exact(&mut bytes))
            .map_err(refused("read", &self.path))?;
        Ok(Some(Strip { index, bytes }))
    }
}

fn refused(action: &'static str, path: &Path) -> impl Fn(io::Error) -> Error {
    move |source| Error::File {
        action,
        file: path.to_owned(),
        source,
    }
}
