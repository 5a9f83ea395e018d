//! Where the lines of a completed table go: a CSV file, standard output, or a Parquet file where the build has it.

use std::io::{self, IsTerminal as _, Stdout, Write as _};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::input::STANDARD;
use crate::output::OutputFile;
use crate::terminal::printable;

/// Bytes of a file after which the disk is waited for. Rows are solved meanwhile, and the end has less to wait for:
/// 8 MiB take 4 ms, a hundredth of the time in which a million rows are solved, and their 100 MB 38 ms.
const SYNC_BYTES: usize = 8 << 20;

/// A table being written.
pub(super) struct TableSink {
    path: PathBuf,
    kind: Kind,
}

enum Kind {
    Csv {
        file: OutputFile,
        /// Bytes that the disk may not have yet.
        unsynced: usize,
    },
    Standard(io::BufWriter<Stdout>),
    #[cfg(feature = "parquet")]
    Parquet(Box<crate::parquet_table::ParquetSink<OutputFile>>),
}

impl TableSink {
    /// Begins the table `path`.
    pub(super) fn create(path: &Path) -> Result<Self> {
        if path == Path::new(STANDARD) {
            return Ok(Self {
                path: path.to_owned(),
                kind: Kind::Standard(io::BufWriter::new(io::stdout())),
            });
        }
        #[cfg(not(feature = "parquet"))]
        crate::input::refuse_parquet(path)?;
        let file = OutputFile::create(path)?;
        let target = file.path().to_owned();
        #[cfg(feature = "parquet")]
        if crate::parquet_table::is_parquet(path) {
            let sink = crate::parquet_table::ParquetSink::new(file);
            return Ok(Self {
                path: target,
                kind: Kind::Parquet(Box::new(sink)),
            });
        }
        Ok(Self {
            path: target,
            kind: Kind::Csv { file, unsynced: 0 },
        })
    }

    /// Where the table will stand.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Lines with their ends, the header first.
    pub(super) fn lines(&mut self, text: &str) -> Result<()> {
        match &mut self.kind {
            Kind::Csv { file, unsynced } => file.write_all(text.as_bytes()).and_then(|()| {
                *unsynced += text.len();
                if *unsynced < SYNC_BYTES {
                    return Ok(());
                }
                *unsynced = 0;
                file.sync()
            }),
            Kind::Standard(out) if out.get_ref().is_terminal() => {
                out.write_all(printable(text).as_bytes())
            }
            Kind::Standard(out) => out.write_all(text.as_bytes()),
            #[cfg(feature = "parquet")]
            Kind::Parquet(sink) => text
                .split_inclusive('\n')
                .try_for_each(|line| sink.line(line)),
        }
        .map_err(|error| Error::file("write", &self.path, &error))
    }

    /// Completes the table and puts it in its place.
    pub(super) fn finish(self) -> Result<()> {
        match self.kind {
            Kind::Csv { file, .. } => file.finish(),
            Kind::Standard(mut out) => out
                .flush()
                .map_err(|error| Error::file("write", &self.path, &error)),
            #[cfg(feature = "parquet")]
            Kind::Parquet(sink) => {
                let file = sink
                    .finish()
                    .map_err(|error| Error::file("write", &self.path, &error))?;
                file.map_or(Ok(()), OutputFile::finish)
            }
        }
    }
}
