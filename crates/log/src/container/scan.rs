//! A file read from front to back with its offsets, never trusting a declared length.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use grouser_files::regular;

use crate::error::Result;

const WINDOW: usize = 1 << 16;

/// Where the reading stands, how far the file goes, and the CRC of what went by.
pub(super) struct Scan {
    file: BufReader<File>,
    offset: u64,
    length: u64,
    /// `None` once bytes were skipped.
    crc: Option<crc32fast::Hasher>,
}

impl Scan {
    pub(super) fn open(path: &Path) -> Result<Self> {
        let file = regular::open(path)?;
        let length = file.metadata().map(|found| found.len()).map_err(|source| {
            grouser_files::Error::Unreadable {
                file: path.display().to_string(),
                source,
            }
        })?;
        Ok(Self {
            file: BufReader::with_capacity(WINDOW, file),
            offset: 0,
            length,
            crc: None,
        })
    }

    pub(super) fn offset(&self) -> u64 {
        self.offset
    }

    /// Bytes of the file.
    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// Bytes from here to the end.
    pub(super) fn left(&self) -> u64 {
        self.length.saturating_sub(self.offset)
    }

    pub(super) fn begin_crc(&mut self, start: &[u8]) {
        self.crc = Some(crc32fast::Hasher::new_with_initial(crc32fast::hash(start)));
    }

    pub(super) fn crc(&self) -> Option<u32> {
        self.crc.clone().map(crc32fast::Hasher::finalize)
    }

    /// Reads `count` bytes into `buffer`, which it clears, or as many as there are. Memory grows with
    /// what the file holds, not with `count`.
    pub(super) fn read(&mut self, count: u64, buffer: &mut Vec<u8>) -> io::Result<bool> {
        buffer.clear();
        let before = buffer.len();
        let read = (&mut self.file).take(count).read_to_end(buffer);
        let got = buffer.len() - before;
        self.offset += got as u64;
        if let Some(crc) = &mut self.crc {
            crc.update(buffer);
        }
        read?;
        Ok(got as u64 == count)
    }

    /// Passes over `count` bytes.
    pub(super) fn skip(&mut self, count: u64) -> io::Result<bool> {
        let mut rest = count;
        let mut buffer = Vec::new();
        while rest > 0 {
            let step = rest.min(WINDOW as u64);
            if !self.read(step, &mut buffer)? {
                return Ok(false);
            }
            rest -= step;
        }
        Ok(true)
    }

    /// Goes to `offset`; the CRC of the whole is lost.
    pub(super) fn go_to(&mut self, offset: u64) -> io::Result<()> {
        self.crc = None;
        self.file.seek(SeekFrom::Start(offset))?;
        self.offset = offset;
        Ok(())
    }

    /// The first place at or after `from` where `fits` finds a record, given what stands there and how
    /// many bytes the file has from there. The scan stands there, or at the end.
    pub(super) fn find(
        &mut self,
        from: u64,
        reach: usize,
        fits: impl Fn(&[u8], u64) -> bool,
    ) -> io::Result<Option<u64>> {
        let mut at = from;
        let mut window = Vec::new();
        while at < self.length {
            self.go_to(at)?;
            self.read((WINDOW + reach) as u64, &mut window)?;
            if window.is_empty() {
                break;
            }
            let starts = window.len().min(WINDOW);
            for start in 0..starts {
                let place = at + start as u64;
                if fits(&window[start..], self.length - place) {
                    self.go_to(place)?;
                    return Ok(Some(place));
                }
            }
            at += starts as u64;
        }
        self.go_to(self.length)?;
        Ok(None)
    }
}
