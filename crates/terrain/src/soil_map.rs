//! Several soils on one map: a raster of classes with a legend.

use std::path::{Path, PathBuf};

use grouser_files::soil::names_file;
use grouser_files::{Document, Section};
use grouser_rover::ground::Georeference;
use grouser_terra::Soil;
use grouser_terra::catalogue::{self, Completion};

use crate::error::{Error, Result};
use crate::raster::Dem;
use crate::soil_draws::SoilIntervals;

/// Greatest number of soils of a legend.
const MAX_SOILS: usize = 254;
/// Classes are whole numbers in this range.
const CLASS_LIMITS: (f64, f64) = (0.0, 65_535.0);
/// Greatest number of cells of a raster of classes, one byte each.
const MAX_CELLS: f64 = 33_554_432.0;

/// A soil of a legend.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LegendSoil {
    /// Its number in the raster.
    pub class: u32,
    /// Its name.
    pub name: String,
    /// The soil.
    pub soil: Soil,
    /// Its 95 % intervals; `None`: exactly known.
    pub intervals: Option<SoilIntervals>,
}

/// Which soil lies where: a raster of classes and a legend. The legend is a file:
///
/// ```toml
/// format = 1
/// raster = "soils.asc"        # beside this file: ASCII grid or GeoTIFF of whole numbers
///
/// [[soil]]
/// class = 1
/// name = "crust"
/// soil = "sandy-loam"         # a key of the catalogue, or a soil file (a name with `/` or `.`)
/// intervals = "crust.toml"    # optional
/// ```
///
/// Ground without a class, or outside the raster, has the soil that the map is made for.
#[derive(Clone, Debug)]
pub struct SoilMap {
    soils: Vec<LegendSoil>,
    files: Vec<PathBuf>,
    classes: Vec<u8>,
    columns: usize,
    rows: usize,
    cell: f64,
    /// The outer corner of the upper left cell, m.
    upper_left: [f64; 2],
}

/// What stands in the legend, before files that it names are read.
struct Entry {
    class: u32,
    name: String,
    soil: String,
    intervals: Option<String>,
}

impl SoilMap {
    /// Reads a legend and the raster that it names.
    ///
    /// # Errors
    /// What the legend lacks or has wrong, [`Error::NoClass`] for a raster value that it does not list,
    /// [`Error::Terrain`] for a raster that cannot be used.
    pub fn read(path: &Path) -> Result<Self> {
        let document = Document::read(path)?;
        let (raster, entries) = document.parse(read_legend)?;
        let mut files = vec![path.to_owned()];
        let mut soils = Vec::with_capacity(entries.len());
        for entry in entries {
            soils.push(legend_soil(entry, &document, &mut files)?);
        }
        let raster = document.beside(raster);
        files.push(raster.clone());
        Self::of_raster(&raster, soils, files)
    }

    fn of_raster(path: &Path, soils: Vec<LegendSoil>, files: Vec<PathBuf>) -> Result<Self> {
        let mut raster = Dem::open(path, None, 1.0)?;
        let (columns, rows) = raster.size();
        let cells = f64::from(columns) * f64::from(rows);
        Error::check("soil raster", "cells", cells, (4.0, MAX_CELLS), "1")?;
        let (cell, first) = (raster.cell(), raster.georeference().centre(0, 0));
        let first = first.unwrap_or([0.5 * cell, -0.5 * cell]);
        let window = raster.window(0..rows)?;
        let mut classes = Vec::with_capacity(columns as usize * rows as usize);
        for row in 0..rows {
            for column in 0..columns {
                let Some(value) = window.height(row.into(), column.into()) else {
                    classes.push(0);
                    continue;
                };
                let soil = soils
                    .iter()
                    .position(|soil| f64::from(soil.class) == f64::from(value))
                    .ok_or_else(|| Error::NoClass {
                        file: path.to_owned(),
                        value,
                        row,
                        column,
                    })?;
                classes.push(u8::try_from(soil + 1).unwrap_or(0));
            }
        }
        Ok(Self {
            soils,
            files,
            classes,
            columns: columns as usize,
            rows: rows as usize,
            cell,
            upper_left: [first[0] - 0.5 * cell, first[1] + 0.5 * cell],
        })
    }

    /// The soils of the legend.
    #[must_use]
    pub fn soils(&self) -> &[LegendSoil] {
        &self.soils
    }

    /// The legend, the raster and the files that the legend names.
    #[must_use]
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// The soil at a place (m): 0 for none of the legend's, else its index plus one.
    #[must_use]
    pub fn soil_at(&self, [x, y]: [f64; 2]) -> usize {
        let place = |off: f64, count: usize| {
            let cell = (off / self.cell).floor();
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "within the raster, as just checked"
            )]
            let index = (cell >= 0.0 && cell < count as f64).then_some(cell as usize);
            index
        };
        let column = place(x - self.upper_left[0], self.columns);
        let row = place(self.upper_left[1] - y, self.rows);
        match (column, row) {
            (Some(column), Some(row)) => self.classes[row * self.columns + column].into(),
            _ => 0,
        }
    }

    /// Refuses a raster that does not overlap a map of this place and size; `file` is named in the error.
    ///
    /// # Errors
    /// [`Error::NotAMap`].
    pub fn check_overlap(
        &self,
        file: &Path,
        georeference: &Georeference,
        (columns, rows): (u32, u32),
    ) -> Result<()> {
        let first = georeference.centre(0, 0);
        let last = georeference.centre(columns.saturating_sub(1), rows.saturating_sub(1));
        let far = |count: usize| count as f64 * self.cell;
        let [x, y] = self.upper_left;
        let overlaps = first
            .zip(last)
            .is_some_and(|([left, top], [right, bottom])| {
                left < x + far(self.columns) && right > x && bottom < y && top > y - far(self.rows)
            });
        if overlaps {
            return Ok(());
        }
        Err(Error::NotAMap {
            file: file.to_owned(),
            reason: "its raster does not overlap the elevation model".to_owned(),
        })
    }
}

fn read_legend(root: &Section<'_>) -> Result<(String, Vec<Entry>)> {
    let raster = root.text("raster")?.to_owned();
    let entries = root.sections("soil", |s| {
        let class = s.integer("class")?;
        let class = u16::try_from(class)
            .map_err(|_| s.out_of_range("class", class as f64, CLASS_LIMITS))?;
        Ok(Entry {
            class: class.into(),
            name: s.text("name")?.to_owned(),
            soil: s.text("soil")?.to_owned(),
            intervals: s.optional_text("intervals")?.map(str::to_owned),
        })
    })?;
    let count = entries.len() as f64;
    Error::check("soil map", "[[soil]]", count, (1.0, MAX_SOILS as f64), "1")?;
    for (index, entry) in entries.iter().enumerate() {
        if let Some(before) = entries[..index].iter().find(|e| e.class == entry.class) {
            return Err(Error::TwoSoils {
                class: entry.class,
                names: [before.name.clone(), entry.name.clone()],
            });
        }
    }
    Ok((raster, entries))
}

fn legend_soil(entry: Entry, legend: &Document, files: &mut Vec<PathBuf>) -> Result<LegendSoil> {
    let of_law = |source| Error::Law {
        of: format!("soil \"{}\"", entry.name),
        source,
    };
    let none = Completion::default();
    let soil = if names_file(entry.soil.as_ref()) {
        let path = legend.beside(&entry.soil);
        let file = grouser_files::soil::read(&path)?;
        files.push(path);
        file.completed(&none).map_err(of_law)?
    } else {
        let found = catalogue::find(&entry.soil).ok_or_else(|| {
            let keys = catalogue::entries().iter().map(|entry| entry.key);
            grouser_rover::Error::Unknown {
                of: format!("soil map, class {}", entry.class),
                name: entry.soil.clone(),
                meant: grouser_files::nearest(&entry.soil, keys).map(Into::into),
            }
        })?;
        found.completed(&none).map_err(of_law)?
    };
    let intervals = match &entry.intervals {
        Some(name) => {
            let path = legend.beside(name);
            let intervals = SoilIntervals::parse(&Document::read(&path)?)?;
            files.push(path);
            Some(intervals)
        }
        None => None,
    };
    Ok(LegendSoil {
        class: entry.class,
        name: entry.name,
        soil,
        intervals,
    })
}
