//! A file as a stream of bytes, decompressed where it is compressed.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use flate2::bufread::MultiGzDecoder;
use grouser_files::regular;

use crate::error::{Cell, Error, Result};

const BUFFER: usize = 1 << 16;
const GZIP: [u8; 2] = [0x1f, 0x8b];
const DATABASE: &[u8] = b"SQLite format 3\0";

/// A file whose bytes are counted as they are read.
struct Counted {
    file: File,
    count: Arc<AtomicU64>,
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let length = self.file.read(buffer)?;
        self.count.fetch_add(length as u64, Ordering::Relaxed);
        Ok(length)
    }
}

/// Refuses what ROS 2 recorded before MCAP: a database, neither text nor messages in a row. What cannot
/// be opened is left to whoever opens it.
pub(crate) fn refuse_database(path: &Path) -> Result<()> {
    let mut start = Vec::new();
    if let Ok(file) = regular::open(path)
        && file
            .take(DATABASE.len() as u64)
            .read_to_end(&mut start)
            .is_ok()
        && start == DATABASE
    {
        return Err(Error::Database {
            file: path.display().to_string(),
        });
    }
    Ok(())
}

/// Opens a regular file; gzip is known by its first bytes, whatever the name. What is read of it is
/// added to `count`.
pub(crate) fn open(path: &Path, count: &Arc<AtomicU64>) -> Result<Box<dyn BufRead + Send>> {
    refuse_database(path)?;
    let file = Counted {
        file: regular::open(path)?,
        count: Arc::clone(count),
    };
    let mut file = BufReader::with_capacity(BUFFER, file);
    let start = first_bytes(&mut file).map_err(|source| Error::Unreadable {
        at: Cell {
            file: path.display().to_string(),
            line: 1,
            column: None,
            name: None,
        },
        source,
    })?;
    if start == GZIP {
        let decoder = MultiGzDecoder::new(file);
        Ok(Box::new(BufReader::with_capacity(BUFFER, decoder)))
    } else {
        Ok(Box::new(file))
    }
}

fn first_bytes(file: &mut impl BufRead) -> io::Result<[u8; 2]> {
    let buffer = file.fill_buf()?;
    Ok(match buffer {
        [a, b, ..] => [*a, *b],
        _ => [0; 2],
    })
}
