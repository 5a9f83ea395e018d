//! A slip map as a planner holds it.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use grouser_files::regular;
use grouser_rover::ground::GeoTiff;

use crate::error::{Error, Result};
use crate::map::{Band, MapLayout, Quantity};

/// Greatest number of cells times headings: seven numbers, a flag and a soil of each are held.
const MAX_POSES: u64 = 1 << 26;
/// GDAL's metadata.
const METADATA_TAG: u16 = 42112;

/// The quantities that a planner needs, by cell and heading.
///
/// ```
/// use grouser_terrain::plan::PlanMap;
/// use grouser_terrain::{Headings, MapLayout};
///
/// let map = PlanMap::unknown(MapLayout::plain(5, 3, 2.0, Headings::new(8)?));
/// assert!(map.cells() == 15 && map.energy.iter().all(|energy| energy.is_nan()));
/// # Ok::<(), grouser_terrain::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlanMap {
    /// Its size and place, and the robot.
    pub layout: MapLayout,
    /// Energy per metre of travel, J/m; NaN where the robot does not drive.
    pub energy: Vec<f32>,
    /// CVaR of the energy per metre over the soil draws, J/m.
    pub energy_cvar: Vec<f32>,
    /// Slip.
    pub slip: Vec<f32>,
    /// The slip that 95 % of the soil draws do not exceed.
    pub slip_high: Vec<f32>,
    /// Probability of immobilisation, at most.
    pub risk: Vec<f32>,
    /// Tip-over margin, deg.
    pub tip_over: Vec<f32>,
    /// Pitch, deg.
    pub pitch: Vec<f32>,
    /// Does a wheel sink by more than a sixth of its diameter, where the laws lose their grip?
    pub deep: Vec<bool>,
    /// Which soils are known independently of each other: the risks of one number belong to one unknown soil.
    pub soil: Vec<u8>,
}

/// A map's file, being read.
struct MapFile<'a> {
    path: &'a Path,
    tiff: GeoTiff<BufReader<File>>,
    layout: MapLayout,
}

impl<'a> MapFile<'a> {
    fn open(path: &'a Path) -> Result<Self> {
        let no_map = |reason: String| Error::NotAMap {
            file: path.to_owned(),
            reason,
        };
        let file = regular::open(path)?;
        let mut tiff = GeoTiff::open(BufReader::new(file)).map_err(|fault| Error::Terrain {
            file: path.to_owned(),
            fault,
        })?;
        let metadata = tiff
            .text(METADATA_TAG)
            .ok_or_else(|| no_map("it has no metadata (tag 42112)".to_owned()))?;
        let georeference = tiff.georeference().clone();
        let layout = MapLayout::parse(&metadata, tiff.size(), georeference).map_err(no_map)?;
        if usize::from(tiff.bands()) != layout.bands() {
            return Err(no_map(format!(
                "it has {} bands, but {} headings require {}",
                tiff.bands(),
                layout.headings.count(),
                layout.bands()
            )));
        }
        check_poses(&layout)?;
        Ok(Self { path, tiff, layout })
    }

    /// Hands every cell and its bands to `see`, in the order of the file.
    fn cells(&mut self, mut see: impl FnMut(usize, &[f32])) -> Result<()> {
        let bands = self.layout.bands();
        let mut cell = vec![0.0_f32; bands];
        for index in 0..self.tiff.pieces() {
            let place = self.tiff.place(index);
            let mut seen = 0_usize;
            let columns = self.layout.columns as usize;
            let read = self.tiff.read_piece(index, |value| {
                cell[seen % bands] = value;
                seen += 1;
                if seen.is_multiple_of(bands) {
                    let done = seen / bands - 1;
                    let (row, column) = (done / place.wide as usize, done % place.wide as usize);
                    let column = place.left as usize + column;
                    let row = place.top as usize + row;
                    see(row * columns + column, &cell);
                }
            });
            read.map_err(|fault| Error::Terrain {
                file: self.path.to_owned(),
                fault,
            })?;
        }
        Ok(())
    }
}

fn check_poses(layout: &MapLayout) -> Result<()> {
    let cells = u64::from(layout.columns) * u64::from(layout.rows);
    let poses = cells * layout.headings.count() as u64;
    let limits = (4.0, MAX_POSES as f64);
    Error::check("map", "cells times headings", poses as f64, limits, "1")
}

/// Reads all bands of the file that `map` wrote: row by row, for each cell band by band.
///
/// # Errors
/// As [`PlanMap::read`].
pub fn read_map(path: &Path) -> Result<(MapLayout, Vec<f32>)> {
    let mut file = MapFile::open(path)?;
    let (layout, bands) = (file.layout.clone(), file.layout.bands());
    let cells = layout.columns as usize * layout.rows as usize;
    let mut out = vec![f32::NAN; cells * bands];
    file.cells(|cell, values| {
        if let Some(place) = out.chunks_exact_mut(bands).nth(cell) {
            place.copy_from_slice(values);
        }
    })?;
    Ok((layout, out))
}

impl PlanMap {
    /// A map in which nothing is known yet.
    #[must_use]
    pub fn unknown(layout: MapLayout) -> Self {
        let poses = layout.columns as usize * layout.rows as usize * layout.headings.count();
        let nothing = vec![f32::NAN; poses];
        Self {
            layout,
            energy: nothing.clone(),
            energy_cvar: nothing.clone(),
            slip: nothing.clone(),
            slip_high: nothing.clone(),
            risk: nothing.clone(),
            tip_over: nothing.clone(),
            pitch: nothing,
            deep: vec![false; poses],
            soil: vec![0; poses],
        }
    }

    /// Reads the file that `map` wrote.
    ///
    /// # Errors
    /// [`Error::Terrain`] for a damaged file, [`Error::NotAMap`] for another GeoTIFF.
    pub fn read(path: &Path) -> Result<Self> {
        let mut file = MapFile::open(path)?;
        let mut map = Self::unknown(file.layout.clone());
        file.cells(|cell, values| map.set_cell(cell, values))?;
        Ok(map)
    }

    /// A map of all bands of its cells, row by row and for each cell band by band, as
    /// [`MapMaker::rows`](crate::MapMaker::rows) gives them.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for more poses than a planner holds, or another number of values.
    pub fn of_cells(layout: MapLayout, cells: &[f32]) -> Result<Self> {
        check_poses(&layout)?;
        let count = (layout.columns as usize * layout.rows as usize * layout.bands()) as f64;
        Error::check("map", "values", cells.len() as f64, (count, count), "1")?;
        let bands = layout.bands();
        let mut map = Self::unknown(layout);
        for (cell, values) in cells.chunks_exact(bands).enumerate() {
            map.set_cell(cell, values);
        }
        Ok(map)
    }

    /// The bands of a cell.
    fn set_cell(&mut self, cell: usize, values: &[f32]) {
        let headings = self.layout.headings;
        for heading in 0..headings.count() {
            let value = |quantity| values[Band { quantity, heading }.index(headings)];
            let pose = cell * headings.count() + heading;
            self.energy[pose] = value(Quantity::Energy);
            self.energy_cvar[pose] = value(Quantity::EnergyCvar);
            self.slip[pose] = value(Quantity::Slip);
            self.slip_high[pose] = value(Quantity::SlipHigh);
            self.risk[pose] = value(Quantity::Immobilisation);
            self.tip_over[pose] = value(Quantity::TipOver);
            self.pitch[pose] = value(Quantity::Pitch);
            let sinkage = f64::from(value(Quantity::Sinkage));
            self.deep[pose] = grouser_terra::is_deep(sinkage, self.layout.wheel_radius);
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a float that is no soil's number saturates; the file was written with whole ones"
            )]
            let soil = value(Quantity::Soil) as u8;
            self.soil[pose] = soil;
        }
    }

    /// Number of cells.
    #[must_use]
    pub const fn cells(&self) -> usize {
        self.layout.columns as usize * self.layout.rows as usize
    }

    /// The cell at a place of the map's coordinates, m. The map is closed: its edges belong to it.
    ///
    /// # Errors
    /// [`Error::Place`] outside the map.
    pub fn cell_at(&self, of: &'static str, (x, y): (f64, f64)) -> Result<usize> {
        let layout = &self.layout;
        let [first_x, first_y] = layout.place_of(0, 0);
        let [last_x, last_y] = layout.place_of(layout.columns - 1, layout.rows - 1);
        let half = 0.5 * layout.cell;
        // the ends of an axis
        let span = |a: f64, b: f64| (a.min(b) - half, a.max(b) + half);
        let ((left, right), (bottom, top)) = (span(first_x, last_x), span(first_y, last_y));
        if !((left..=right).contains(&x) && (bottom..=top).contains(&y)) {
            return Err(Error::Place {
                of,
                x,
                y,
                why: format!(
                    "lies outside the map, which spans x from {left} to {right} m and y from {bottom} to {top} m"
                ),
            });
        }
        // a place on the far edge is one of the last cell
        let index = |value: f64, first: f64, last: f64, count: u32| {
            let way = if last < first {
                first - value
            } else {
                value - first
            };
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "within the map, as just checked"
            )]
            let cell = (way / layout.cell + 0.5).max(0.0) as usize;
            cell.min(count as usize - 1)
        };
        let column = index(x, first_x, last_x, layout.columns);
        let row = index(y, first_y, last_y, layout.rows);
        Ok(row * layout.columns as usize + column)
    }

    /// The place of a cell's centre, m.
    #[must_use]
    pub fn place_of(&self, cell: usize) -> (f64, f64) {
        let columns = self.layout.columns as usize;
        let (row, column) = (cell / columns, cell % columns);
        let at = |value: usize| u32::try_from(value).unwrap_or(u32::MAX);
        let [x, y] = self.layout.place_of(at(column), at(row));
        (x, y)
    }
}
