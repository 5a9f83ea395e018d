//! Files that are compressed with Zstandard as a whole, as rosbag2 compresses them, read as what they hold.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use grouser_files::regular;
use zrip_decode::streaming::FrameDecoder;

use crate::error::Result;
use crate::source::{Input, unfolded_limit};

pub(crate) const MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
const SKIPPED_BYTES: usize = 1 << 16;

/// An expanded file: read from front to back, and from the front again where an earlier place is wanted.
pub(crate) struct ZstdFile {
    path: PathBuf,
    decoder: FrameDecoder<BufReader<File>>,
    position: u64,
    length: u64,
    /// What it may unfold to, bytes.
    limit: u64,
}

impl ZstdFile {
    /// `None` of another kind of file.
    pub(crate) fn open(path: &Path) -> Result<Option<Self>> {
        let mut file = regular::open(path)?;
        let unreadable = |source| grouser_files::Error::Unreadable {
            file: path.display().to_string(),
            source,
        };
        let mut head = [0; 18];
        let mut known = 0;
        while known < head.len() {
            match file.read(&mut head[known..]) {
                Ok(0) | Err(_) => break,
                Ok(more) => known += more,
            }
        }
        if !head[..known].starts_with(&MAGIC) {
            return Ok(None);
        }
        let limit = unfolded_limit(file.metadata().map_or(0, |file| file.len()));
        file.seek(SeekFrom::Start(0)).map_err(unreadable)?;
        let mut expanded = Self {
            path: path.to_owned(),
            decoder: decoder(file, limit),
            position: 0,
            length: 0,
            limit,
        };
        expanded.length = match content_size(&head) {
            Some(size) => size.min(limit),
            None => expanded.count().map_err(unreadable)?,
        };
        Ok(Some(expanded))
    }

    /// The bytes that can be expanded, of a file that does not declare them.
    fn count(&mut self) -> io::Result<u64> {
        let mut rest = vec![0; SKIPPED_BYTES];
        // a truncated file holds what comes before
        while let Ok(more @ 1..) = self.decoder.read(&mut rest) {
            self.position += more as u64;
        }
        let length = self.position;
        self.rewind()?;
        Ok(length)
    }

    fn rewind(&mut self) -> io::Result<()> {
        let file = regular::open(&self.path).map_err(io::Error::other)?;
        self.decoder = decoder(file, self.limit);
        self.position = 0;
        Ok(())
    }
}

fn decoder(file: File, limit: u64) -> FrameDecoder<BufReader<File>> {
    let limit = usize::try_from(limit).unwrap_or(usize::MAX);
    FrameDecoder::with_limit(BufReader::new(file), limit)
}

/// The size of the content that the header of the first frame declares (RFC 8878, section 3.1.1.1).
pub(crate) fn content_size(head: &[u8; 18]) -> Option<u64> {
    let descriptor = head[4];
    let is_single = descriptor & 0x20 != 0;
    let of_dictionary = [0, 1, 2, 4][usize::from(descriptor & 3)];
    let at = 5 + usize::from(!is_single) + of_dictionary;
    let bytes = match descriptor >> 6 {
        0 if is_single => 1,
        0 => return None,
        1 => 2,
        2 => 4,
        _ => 8,
    };
    let mut size = [0; 8];
    size[..bytes].copy_from_slice(&head[at..at + bytes]);
    let size = u64::from_le_bytes(size);
    Some(if bytes == 2 { size + 256 } else { size })
}

impl Input for ZstdFile {
    fn length(&mut self) -> io::Result<u64> {
        Ok(self.length)
    }

    fn read_at(&mut self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        if offset < self.position {
            self.rewind()?;
        }
        let mut skipped = [0; SKIPPED_BYTES / 8];
        while self.position < offset {
            let wanted = usize::try_from(offset - self.position).unwrap_or(usize::MAX);
            let wanted = wanted.min(skipped.len());
            match self.decoder.read(&mut skipped[..wanted])? {
                0 => return Ok(0),
                more => self.position += more as u64,
            }
        }
        let length = self.decoder.read(buffer)?;
        self.position += length as u64;
        Ok(length)
    }
}
