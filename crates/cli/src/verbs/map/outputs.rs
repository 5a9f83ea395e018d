//! The files of a map.

use std::path::{Path, PathBuf};

use grouser_rover::robot::RobotModel;
use grouser_terrain::raster::Dem;
use grouser_terrain::{Journal, MapLayout, MapMaker, read_strip, write_map};

use super::gazebo::SlipPicture;
use super::grid_map::{self, GridMap};
use super::summary::Summary;
use super::work::Shard;
use super::{costmap, picture};
use crate::error::{Error, Result, shown};
use crate::figure_file::ending;
use crate::output::OutputFile;

/// A file that is made of the cells of a map.
pub(super) trait CellFile {
    /// The next strip.
    fn see(&mut self, strip: u32, cells: &[f32]) -> Result<()>;
    /// Puts the file in its place; gives lines that say so.
    fn finish(self: Box<Self>) -> Result<String>;
}

/// The formats beside the map, by the endings of their names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Figure,
    Costmap,
    GridMap,
    Gazebo,
    #[cfg(feature = "parquet")]
    Table,
}

/// The outputs of `map`.
pub(super) struct Outputs {
    map: PathBuf,
    shard: Option<Shard>,
    others: Vec<(Format, PathBuf)>,
}

impl Outputs {
    /// Sorts the names by their endings, and refuses paths that cannot be written before the work.
    pub(super) fn begin(paths: &[PathBuf], shard: Option<Shard>) -> Result<Self> {
        let (mut maps, mut others) = (Vec::new(), Vec::new());
        // all at once, so that no name is there twice
        let mut begun = Vec::new();
        for path in paths {
            let format = match ending(path).as_deref() {
                Some("tif" | "tiff") => {
                    maps.push(path.clone());
                    begun.push(OutputFile::create(path)?);
                    continue;
                }
                Some("svg" | "png") => Format::Figure,
                Some("yaml" | "yml") => Format::Costmap,
                Some("mcap") => Format::GridMap,
                Some("sdf") => Format::Gazebo,
                #[cfg(feature = "parquet")]
                Some("parquet") => Format::Table,
                _ => {
                    return Err(Error::usage(
                        format!(
                            "{} does not end in `.tif`, `.svg`, `.png`, `.yaml`, `.mcap`, `.sdf` or `.parquet`",
                            shown(path)
                        ),
                        "the ending of the output's name chooses its format; `.parquet` needs a build with `--features parquet`",
                    ));
                }
            };
            begun.push(OutputFile::create(path)?);
            let beside = match format {
                Format::Costmap => Some("pgm"),
                Format::Gazebo => Some("png"),
                _ => None,
            };
            if let Some(ending) = beside {
                begun.push(OutputFile::create(&path.with_extension(ending))?);
            }
            others.push((format, path.clone()));
        }
        drop(begun);
        let (Some(map), true) = (maps.pop(), maps.is_empty()) else {
            return Err(Error::usage(
                "a map needs exactly one output that ends in `.tif`",
                "`-o map.tif` is the map; all other outputs are made from it",
            ));
        };
        if shard.is_some() && paths.len() > 1 {
            return Err(Error::usage(
                "a shard has no figure, no costmap and no table",
                "give them to the command with `--join`",
            ));
        }
        Ok(Self { map, shard, others })
    }

    /// Refuses a map that does not fit one of its outputs.
    pub(super) fn check(&self, layout: &MapLayout) -> Result<()> {
        if self
            .others
            .iter()
            .any(|(format, _)| *format == Format::GridMap)
        {
            grid_map::check(layout)?;
        }
        Ok(())
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
        (maker, model): (&MapMaker, &RobotModel),
        dem: &mut Dem,
    ) -> Result<(Summary, String)> {
        let has_costs = self
            .others
            .iter()
            .any(|(format, _)| *format == Format::Costmap);
        let mut summary = Summary::new(layout, has_costs);
        let mut file = OutputFile::create(&self.map)?;
        write_map(
            &mut file,
            &self.map,
            layout,
            &mut journals,
            |index, cells| summary.see(index, cells),
        )?;
        file.finish()?;
        let mut text = format!("wrote {}\n", shown(&self.map));
        for (format, path) in &self.others {
            let mut other: Box<dyn CellFile + '_> = match format {
                Format::Figure => {
                    text.push_str(&picture::write(path, layout, &summary.shades)?);
                    continue;
                }
                Format::Costmap => {
                    text.push_str(&costmap::write(path, layout, &summary)?);
                    continue;
                }
                Format::GridMap => Box::new(GridMap::new(OutputFile::create(path)?, layout, dem)),
                Format::Gazebo => Box::new(SlipPicture::new(
                    OutputFile::create(path)?,
                    layout,
                    (maker, model),
                )),
                #[cfg(feature = "parquet")]
                Format::Table => Box::new(super::cell_table::CellTable::new(
                    OutputFile::create(path)?,
                    layout,
                )?),
            };
            for strip in 0..layout.strips() {
                let (_, cells) = read_strip(&self.map, layout, &mut journals, strip)?;
                other.see(strip, &cells)?;
            }
            text.push_str(&other.finish()?);
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
