//! A file as a stream of bytes, decompressed where it is compressed.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;
use grouser_files::regular;

use crate::error::{Cell, Error, Result};

const BUFFER: usize = 1 << 16;
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// Opens a regular file; gzip is known by its first bytes, whatever the name.
pub(crate) fn open(path: &Path) -> Result<Box<dyn BufRead + Send>> {
    let mut file = BufReader::with_capacity(BUFFER, regular::open(path)?);
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

fn first_bytes(file: &mut BufReader<File>) -> std::io::Result<[u8; 2]> {
    let buffer = file.fill_buf()?;
    Ok(match buffer {
        [a, b, ..] => [*a, *b],
        _ => [0; 2],
    })
}
