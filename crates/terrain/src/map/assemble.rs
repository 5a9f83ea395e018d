//! Strips become a file.

use std::io::{Seek, Write};
use std::path::{Path, PathBuf};

use super::journal::Journal;
use super::layout::MapLayout;
use super::strip::Strip;
use crate::error::{Error, Result};
use crate::raster::write_raster;

/// What stops the writing of a map.
enum Stop {
    Tiff(tiff::TiffError),
    Own(Error),
}

impl From<tiff::TiffError> for Stop {
    fn from(error: tiff::TiffError) -> Self {
        Self::Tiff(error)
    }
}

/// Writes the file of a map from the journals that hold its strips together; `see` gets the cells of every strip as the
/// file has them. The bytes depend on the map alone, not on how its strips came to be.
///
/// # Errors
/// [`Error::NotAMap`] where a strip is missing or damaged, [`Error::File`].
pub fn write_map<W: Write + Seek>(
    target: W,
    path: &Path,
    layout: &MapLayout,
    journals: &mut [Journal],
    mut see: impl FnMut(u32, &[f32]),
) -> Result<()> {
    let packed = journals.iter().map(Journal::bytes).sum();
    let strips = (0..layout.strips()).map(|index| -> Result<Vec<u8>, Stop> {
        let (strip, cells) = read_strip(path, layout, journals, index).map_err(Stop::Own)?;
        see(index, &cells);
        Ok(strip.bytes)
    });
    write_raster(target, &layout.raster(), packed, strips).map_err(|stop| match stop {
        Stop::Own(error) => error,
        Stop::Tiff(error) => Error::File {
            action: "write",
            file: PathBuf::from(path),
            source: std::io::Error::other(error),
        },
    })
}

/// A strip of the map `path` with its cells, from the journals that hold its strips together.
///
/// # Errors
/// [`Error::NotAMap`] where it is missing or damaged, [`Error::File`].
pub fn read_strip(
    path: &Path,
    layout: &MapLayout,
    journals: &mut [Journal],
    index: u32,
) -> Result<(Strip, Vec<f32>)> {
    let missing = |reason: &str| Error::NotAMap {
        file: path.to_owned(),
        reason: format!("strip {} of {} {reason}", index + 1, layout.strips()),
    };
    let nowhere = || missing("is in none of the shards");
    let journal = journals.iter_mut().find(|journal| journal.holds(index));
    let strip = journal
        .ok_or_else(nowhere)?
        .strip(index)?
        .ok_or_else(nowhere)?;
    let cells = strip
        .unpack(layout)
        .ok_or_else(|| missing("does not fit the map"))?;
    Ok((strip, cells))
}
