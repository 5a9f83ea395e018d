//! The files of a map.

use std::path::{Path, PathBuf};

use grouser_rover::ground::Georeference;
use grouser_terrain::{Journal, MapLayout, write_map};

use super::costmap;
use super::picture;
use super::summary::Summary;
use super::work::Shard;
use crate::error::{Error, Result, shown};
use crate::figure_file::ending;
use crate::output::OutputFile;

/// The outputs of `map`, by format.
pub(super) struct Outputs {
    map: PathBuf,
    shard: Option<Shard>,
    figures: Vec<PathBuf>,
    costmaps: Vec<PathBuf>,
}

impl Outputs {
    /// Sorts the names by their endings, and refuses paths that cannot be written before the work.
    pub(super) fn begin(paths: &[PathBuf], shard: Option<Shard>) -> Result<Self> {
        let mut maps = Vec::new();
        let (mut figures, mut costmaps) = (Vec::new(), Vec::new());
        // all at once, so that no name is there twice
        let mut begun = Vec::new();
        for path in paths {
            match ending(path).as_deref() {
                Some("tif" | "tiff") => maps.push(path.clone()),
                Some("svg" | "png") => figures.push(path.clone()),
                Some("yaml" | "yml") => costmaps.push(path.clone()),
                _ => {
                    return Err(Error::usage(
                        format!(
                            "{} does not end in `.tif`, `.svg`, `.png` or `.yaml`",
                            shown(path)
                        ),
                        "the ending of the output's name chooses its format",
                    ));
                }
            }
            begun.push(OutputFile::create(path)?);
        }
        drop(begun);
        let (Some(map), true) = (maps.pop(), maps.is_empty()) else {
            return Err(Error::usage(
                "a map needs exactly one output that ends in `.tif`",
                "`-o map.tif` is the map; figures and costmaps are made from it",
            ));
        };
        if shard.is_some() && paths.len() > 1 {
            return Err(Error::usage(
                "a shard has no figure and no costmap",
                "give them to the command with `--join`",
            ));
        }
        Ok(Self {
            map,
            shard,
            figures,
            costmaps,
        })
    }

    /// The file of finished strips: beside the map, of its name.
    pub(super) fn journal(&self) -> PathBuf {
        match self.shard {
            Some(shard) => self.shard(shard.index, shard.of),
            None => self.beside("strips"),
        }
    }

    /// The file of a shard.
    pub(super) fn shard(&self, index: u16, of: u16) -> PathBuf {
        self.beside(&format!("{index}-of-{of}.strips"))
    }

    fn beside(&self, ending: &str) -> PathBuf {
        let mut name = self.map.clone().into_os_string();
        name.push(".");
        name.push(ending);
        name.into()
    }

    /// Writes everything; gives the summary, and lines that say what was written.
    pub(super) fn write(
        &self,
        layout: &MapLayout,
        mut journals: Vec<Journal>,
        georeference: &Georeference,
    ) -> Result<(Summary, String)> {
        let mut summary = Summary::new(layout, !self.costmaps.is_empty());
        let mut file = OutputFile::create(&self.map)?;
        write_map(
            &mut file,
            &self.map,
            layout,
            &mut journals,
            |index, cells| {
                summary.see(index, cells);
            },
        )?;
        file.finish()?;
        let mut text = format!("wrote {}\n", shown(&self.map));
        for path in &self.figures {
            text.push_str(&picture::write(path, layout, &summary.shades)?);
        }
        for path in &self.costmaps {
            text.push_str(&costmap::write(path, layout, georeference, &summary)?);
        }
        drop(journals);
        if self.journal().exists() {
            remove(&self.journal())?;
        }
        Ok((summary, text))
    }
}

fn remove(path: &Path) -> Result<()> {
    std::fs::remove_file(path).map_err(|error| Error::file("remove", path, &error))
}
