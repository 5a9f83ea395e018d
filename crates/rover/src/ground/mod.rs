//! The ground: its height, the soil of each place, and the ruts that wheels leave.

mod craters;
mod file;
mod height_map;
mod noise;
mod passes;
mod shape;

pub use craters::{Crater, Craters};
pub use file::{
    GeoTiff, Georeference, HeightFile, HeightTiff, PiecePlace, Raster, UndeclaredNoData,
    check_side_files, parse_heights, read_heights, read_raster,
};
pub use height_map::HeightMap;
pub(crate) use height_map::{CELL_LIMITS_M, max_width, side_limits};
pub use noise::Noise;
pub use passes::Track;
pub use shape::{Rocks, Shape};

use grouser_real::Real;
use grouser_terra::{MultiPass, Soil};

use self::height_map::{Corner, Surface};
use self::passes::Passes;
use crate::error::{Error, Result};
pub use crate::terrain_fault::{NoCell, TerrainFault};

/// A wheel that comes back to a cell after this many cells of its way has passed it anew: the strips that it presses in
/// one pass touch each other.
const PASS_WAY_CELLS: f64 = 4.0;
/// The depth of packing, m.
pub(crate) const PACKING_DEPTH_LIMITS_M: (f64, f64) = (1e-4, 10.0);
/// The length over which soil scatters, m.
pub(crate) const SCATTER_LENGTH_LIMITS_M: (f64, f64) = (1e-3, 1e4);

/// Where a soil lies.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Place {
    /// A disc.
    Disc {
        /// Centre, m.
        x: f64,
        /// Centre, m.
        y: f64,
        /// m.
        radius: f64,
    },
    /// A rectangle along the axes.
    Box {
        /// Centre, m.
        x: f64,
        /// Centre, m.
        y: f64,
        /// Extent along x, m.
        length: f64,
        /// Extent along y, m.
        width: f64,
    },
}

impl Place {
    /// The same place, moved by (x, y) m.
    ///
    /// ```
    /// use grouser_rover::ground::Place;
    ///
    /// let disc = Place::Disc { x: 1.0, y: 0.0, radius: 0.5 };
    /// assert_eq!(disc.moved(2.0, 1.0), Place::Disc { x: 3.0, y: 1.0, radius: 0.5 });
    /// ```
    #[must_use]
    pub fn moved(mut self, right: f64, up: f64) -> Self {
        match &mut self {
            Self::Disc { x, y, .. } | Self::Box { x, y, .. } => {
                *x += right;
                *y += up;
            }
        }
        self
    }

    /// Does a point lie in it?
    ///
    /// ```
    /// use grouser_rover::ground::Place;
    ///
    /// let disc = Place::Disc { x: 1.0, y: 0.0, radius: 0.5 };
    /// assert!(disc.holds(1.4, 0.0) && !disc.holds(1.4, 0.4));
    /// ```
    #[must_use]
    pub fn holds(&self, at_x: f64, at_y: f64) -> bool {
        match *self {
            Self::Disc { x, y, radius } => Real::hypot(at_x - x, at_y - y) <= radius,
            Self::Box {
                x,
                y,
                length,
                width,
            } => (at_x - x).abs() <= 0.5 * length && (at_y - y).abs() <= 0.5 * width,
        }
    }
}

/// How a soil changes where a wheel has passed, and from place to place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Packing {
    /// Modulus and cohesion of packed soil grow by up to this share ...
    pub gain: f64,
    /// ... as 1 − e^(−rut/depth), m.
    pub depth: f64,
    /// Standard deviation of the logarithm of modulus and cohesion from place to place.
    pub scatter: f64,
    /// Over this length, m.
    pub scatter_length: f64,
    /// What each pass of a wheel changes, in place of `gain`; `None`: passes leave a rut only.
    pub multi_pass: Option<MultiPass>,
    /// Way over which slip-sinkage follows a change of slip, m; 0: at once, with the shear.
    pub settling_way: f64,
}

/// Standard deviations of the logarithm of strength that the strongest place lies above the mean.
const STRONGEST_PLACE_SIGMAS: f64 = 3.0;
/// Passes after which the strongest rut is taken: two of a robot with five wheels a side.
const STRONGEST_RUT_PASSES: u32 = 10;

impl Packing {
    /// Stresses of the strongest soil that it makes, over those of the soil as it is described.
    pub(crate) fn greatest_strength(&self) -> f64 {
        let passed = self.multi_pass.map_or(1.0, |law| {
            law.change(1.0, STRONGEST_RUT_PASSES).strength_factor
        });
        (1.0 + self.gain) * passed * Real::exp(STRONGEST_PLACE_SIGMAS * self.scatter)
    }
}

impl Default for Packing {
    fn default() -> Self {
        Self {
            gain: 0.0,
            depth: 0.02,
            scatter: 0.0,
            scatter_length: 1.0,
            multi_pass: None,
            settling_way: 0.0,
        }
    }
}

/// The ground under a point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Spot {
    /// Height of the surface now, ruts included, m.
    pub height: f64,
    /// Slope of the undisturbed surface along x and y.
    pub slope: [f64; 2],
    /// Index of its soil.
    pub soil: usize,
    /// Factor of modulus and cohesion.
    pub strength: f64,
    /// Factor of the shear deformation modulus.
    pub k_shear: f64,
    /// Depth of the rut that is already there, m.
    pub rut: f64,
    /// Is it on the map, and known there?
    pub known: bool,
}

/// The ground.
///
/// ```
/// use grouser_rover::ground::{Ground, HeightMap, Track};
/// use grouser_terra::catalogue;
///
/// let sand = catalogue::find("dry-sand").expect("in the catalogue").soil().expect("complete");
/// let mut ground = Ground::new(HeightMap::from_shape((4.0, 2.0), 0.1, |_, _| 0.0)?, vec![sand])?;
/// // a wheel 0.2 m wide has passed, 0.03 m deep
/// ground.pass((1.0, 0.0), (2.0, 0.0), (0.2, 0.03), &Track::new(0, 1.0, 0.0));
/// assert!((ground.at(1.5, 0.0).height + 0.03).abs() < 1e-6);
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Ground {
    map: HeightMap,
    soils: Vec<Soil>,
    soil_of: Vec<u8>,
    scatter: Vec<f32>,
    rut: Vec<f32>,
    packing: Packing,
    passes: Option<Passes>,
}

impl Ground {
    /// Ground of `soils[0]` with the shape of `map`.
    ///
    /// # Errors
    /// [`Error::Missing`] without a soil, [`Error::TooMany`] for more than 255.
    pub fn new(map: HeightMap, soils: Vec<Soil>) -> Result<Self> {
        if soils.is_empty() {
            return Err(Error::Missing {
                of: "the ground".into(),
                what: "a soil".into(),
            });
        }
        if soils.len() > 255 {
            return Err(Error::TooMany {
                what: "soils",
                count: soils.len(),
                limit: 255,
            });
        }
        let cells = map.cells();
        Ok(Self {
            map,
            soils,
            soil_of: vec![0; cells],
            scatter: Vec::new(),
            rut: vec![0.0; cells],
            packing: Packing::default(),
            passes: None,
        })
    }

    /// Puts `soils[soil]` where `place` is.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a soil that is not there.
    ///
    /// ```
    /// use grouser_rover::ground::{Ground, HeightMap, Place};
    /// use grouser_terra::catalogue;
    ///
    /// let soil = |key| catalogue::find(key).expect("in the catalogue").soil().expect("complete");
    /// let map = HeightMap::from_shape((4.0, 2.0), 0.1, |_, _| 0.0)?;
    /// let mut ground = Ground::new(map, vec![soil("dry-sand"), soil("lunar")])?;
    /// ground.lay(1, &Place::Disc { x: 2.0, y: 0.0, radius: 0.5 })?;
    /// assert_eq!((ground.at(2.0, 0.0).soil, ground.at(0.5, 0.0).soil), (1, 0));
    /// # Ok::<(), grouser_rover::Error>(())
    /// ```
    pub fn lay(&mut self, soil: usize, place: &Place) -> Result<()> {
        let last = self.soils.len() - 1;
        Error::check("region", "soil", soil as f64, (0.0, last as f64), "1")?;
        for index in 0..self.soil_of.len() {
            let (x, y) = self.map.centre_of(index);
            if place.holds(x, y) {
                self.soil_of[index] = u8::try_from(soil).unwrap_or(0);
            }
        }
        Ok(())
    }

    /// How soil is packed and scatters, the latter by `seed`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`].
    pub fn pack(&mut self, packing: Packing, seed: u64) -> Result<()> {
        Error::check("ground", "packing", packing.gain, (0.0, 10.0), "1")?;
        Error::check(
            "ground",
            "packing_depth",
            packing.depth,
            PACKING_DEPTH_LIMITS_M,
            "m",
        )?;
        Error::check("ground", "scatter", packing.scatter, (0.0, 1.0), "1")?;
        let length = packing.scatter_length;
        Error::check(
            "ground",
            "scatter_length",
            length,
            SCATTER_LENGTH_LIMITS_M,
            "m",
        )?;
        let way = packing.settling_way;
        Error::check("ground", "settling_way", way, (0.0, 10.0), "m")?;
        if packing.multi_pass.is_some() && packing.gain > 0.0 {
            return Err(Error::Missing {
                of: "the ground".into(),
                what:
                    "a choice between `packing` and `multi_pass`: both strengthen the soil of a rut"
                        .into(),
            });
        }
        self.packing = packing;
        self.passes = packing
            .multi_pass
            .map(|law| Passes::new(law, self.map.cells()));
        if packing.scatter > 0.0 {
            let noise = shape::Lattice::new(seed);
            self.scatter = Vec::with_capacity(self.map.cells());
            let (rows, columns) = self.map.lines();
            for y in rows {
                let mut line = noise.along(y / length);
                self.scatter.extend(columns.clone().map(|x| {
                    #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
                    let factor = Real::exp(packing.scatter * line.normal(x / length)) as f32;
                    factor
                }));
            }
        }
        Ok(())
    }

    /// The soils.
    #[must_use]
    pub fn soils(&self) -> &[Soil] {
        &self.soils
    }

    /// Its shape without ruts.
    #[must_use]
    pub const fn map(&self) -> &HeightMap {
        &self.map
    }

    /// The ground under a wheel at (x, y) that drives along (cos, sin): height and slope of the plane through the
    /// undisturbed surface `reach` (m) before and behind it and half its `width` (m) to either side, so that
    /// an edge of the ground passes under the wheel gradually. Ruts lower the plane and do not tilt it.
    #[must_use]
    #[inline]
    pub fn under(
        &self,
        (x, y): (f64, f64),
        (cos, sin): (f64, f64),
        reach: f64,
        width: f64,
    ) -> Spot {
        let (x, y) = self.map.in_cells(x, y);
        let per_cell = 1.0 / self.map.cell();
        let (ahead, aside) = (reach * per_cell, 0.5 * width * per_cell);
        let height = |along: f64, across: f64| self.map.height_in_cells(x + along, y + across);
        let fore = height(ahead * cos, ahead * sin);
        let aft = height(-ahead * cos, -ahead * sin);
        let left = height(-aside * sin, aside * cos);
        let right = height(aside * sin, -aside * cos);
        let along = (fore - aft) / (2.0 * reach);
        let across = (left - right) / width;
        let plane = Surface {
            height: 0.25 * (fore + aft + left + right),
            slope: [along * cos - across * sin, along * sin + across * cos],
        };
        self.spot(&self.map.corner_in_cells(x, y), plane)
    }

    /// The ground under (x, y).
    #[must_use]
    pub fn at(&self, x: f64, y: f64) -> Spot {
        let corner = self.map.corner(x, y);
        self.spot(&corner, self.map.surface(&corner))
    }

    /// The ground in a cell whose undisturbed surface is `surface`.
    fn spot(&self, corner: &Corner, surface: Surface) -> Spot {
        let rut = corner.mix(&self.rut);
        let scatter = if self.scatter.is_empty() {
            1.0
        } else {
            corner.mix(&self.scatter)
        };
        let packed = if self.packing.gain > 0.0 && rut > 0.0 {
            1.0 + self.packing.gain * (1.0 - Real::exp(-rut / self.packing.depth))
        } else {
            1.0
        };
        let nearest = corner.nearest();
        let passed = self.passes.as_ref().map(|passes| passes.change(nearest));
        Spot {
            height: surface.height - rut,
            slope: surface.slope,
            soil: usize::from(self.soil_of[nearest]),
            strength: scatter * packed * passed.map_or(1.0, |change| change.strength_factor),
            k_shear: passed.map_or(1.0, |change| change.k_shear_factor),
            rut,
            known: self.map.is_known(corner),
        }
    }

    /// Way over which slip-sinkage follows a change of slip, m.
    #[must_use]
    pub const fn settling_way(&self) -> f64 {
        self.packing.settling_way
    }

    /// A wheel has pressed the strip from `from` to `to`, `width` wide, to `depth` (m) below the undisturbed
    /// surface. What is deeper already stays; passes count where a [`MultiPass`] law holds.
    pub fn pass(
        &mut self,
        from: (f64, f64),
        to: (f64, f64),
        (width, depth): (f64, f64),
        track: &Track,
    ) {
        let (length_x, length_y) = (to.0 - from.0, to.1 - from.1);
        let length = Real::hypot(length_x, length_y);
        if !(length > 0.0 && depth > 0.0) {
            return;
        }
        let cell = self.map.cell();
        let (along_x, along_y) = (length_x / length, length_y / length);
        // a strip narrower than a cell still leaves one
        let half = 0.5 * width.max(cell);
        let reach = half.max(cell) + cell;
        let low = (from.0.min(to.0) - reach, from.1.min(to.1) - reach);
        let high = (from.0.max(to.0) + reach, from.1.max(to.1) + reach);
        #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
        let depth = depth as f32;
        for index in self.map.indices_between(low, high) {
            let (x, y) = self.map.centre_of(index);
            let (d_x, d_y) = (x - from.0, y - from.1);
            let along = d_x * along_x + d_y * along_y;
            let across = (d_y * along_x - d_x * along_y).abs();
            if across <= half && along >= -1e-9 && along <= length {
                self.rut[index] = self.rut[index].max(depth);
                if let Some(passes) = &mut self.passes {
                    passes.leave(index, track, PASS_WAY_CELLS * cell);
                }
            }
        }
    }
}
