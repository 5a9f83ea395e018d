//! What is believed of the strength of the ground, tile by tile.

use grouser_terra::OutOfRange;

use super::family::StrengthFamily;
use crate::demand::Demand;
use crate::error::{Error, Result};

/// A robot that does not come on is as one that would need this slip.
const BLOCKED_SLIP: f64 = 1.0;
/// No reading is taken for less likely than one this many sigma away: soil has surprises that no family holds.
const MAX_SIGMA: f64 = 3.0;
/// Half of the probability beside an interval of 90 %.
const TAIL_PROBABILITY: f64 = 0.05;
/// Energy per metre below which a share of it says nothing, as a share of the robot's weight.
const MIN_WORK_SHARE: f64 = 0.02;
const MAX_TILES: f64 = 1e6;
/// What was believed before anything was learnt counts as much as this many visited tiles.
const PRIOR_TILES: f32 = 3.0;

/// How soil is learnt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnSettings {
    /// Side of a tile, m: soils that lie closer together are not distinguished.
    pub tile: f64,
    /// Standard deviations of the logarithms of strength and stiffness before anything is known of a place: half of the
    /// strengths within 0.8 to 1.25, half of the stiffnesses within 0.45 to 2.2 of the known soil's.
    pub prior_sigma_ln: [f64; 2],
    /// The model's own error in slip: an absolute part, and a share of the slip. Slips of one wheel and soil differ between
    /// the laws of shear by about a sixth.
    pub slip_error: [f64; 2],
    /// The model's own error in energy per metre, as a share.
    pub work_error: f64,
    /// How far a metre of driving counts towards the tiles beside its own, as a share of the reading's weight.
    pub spread: f64,
    /// Share of the prior that returns with every reading: the way back from a belief that has become wrong.
    pub forget: f64,
    /// Planning uses a new belief once it differs from the one in use by this probability.
    pub hysteresis: f64,
}

impl Default for LearnSettings {
    fn default() -> Self {
        Self {
            tile: 4.0,
            prior_sigma_ln: [0.33, 1.2],
            slip_error: [0.03, 0.2],
            work_error: 0.3,
            spread: 0.3,
            forget: 0.01,
            hysteresis: 0.15,
        }
    }
}

impl LearnSettings {
    /// Checks every number.
    ///
    /// # Errors
    /// [`Error::OutOfRange`].
    pub fn check(&self) -> Result<()> {
        for (field, value, limits, unit) in [
            ("tile", self.tile, (0.1, 1e4), "m"),
            (
                "strength_sigma_ln",
                self.prior_sigma_ln[0],
                (0.01, 2.0),
                "1",
            ),
            (
                "stiffness_sigma_ln",
                self.prior_sigma_ln[1],
                (0.01, 5.0),
                "1",
            ),
            ("slip_error", self.slip_error[0], (1e-3, 1.0), "1"),
            ("slip_error_share", self.slip_error[1], (0.0, 1.0), "1"),
            ("work_error", self.work_error, (0.01, 10.0), "1"),
            ("spread", self.spread, (0.0, 1.0), "1"),
            ("forget", self.forget, (0.0, 0.5), "1"),
            ("hysteresis", self.hysteresis, (0.0, 1.0), "1"),
        ] {
            OutOfRange::check(field, value, limits, unit).map_err(|range| Error::OutOfRange {
                of: "[learn]".to_owned(),
                range,
            })?;
        }
        Ok(())
    }
}

/// What driving took at a place, as the robot's own computer knows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoilObservation {
    /// Where, m.
    pub place: (f64, f64),
    /// Nose up positive, rad.
    pub pitch: f64,
    /// Left side up positive, rad.
    pub roll: f64,
    /// Mean slip of the powered wheels; 1 for a robot that does not come on.
    pub slip: f64,
    /// Its standard deviation.
    pub slip_sigma: f64,
    /// Work of the motors at the wheels per metre of travel, J/m; `None` where torque is not measured.
    pub work_per_metre: Option<f64>,
}

/// What is known of a tile that was visited.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TileSummary {
    /// The tile's middle, m.
    pub place: (f64, f64),
    /// The slope that the soil lets the robot climb: median, rad.
    pub steepest: f64,
    /// The lower end of its 90 % interval, rad.
    pub low: f64,
    /// The upper end, rad.
    pub high: f64,
    /// Readings on the tile itself.
    pub readings: u32,
}

/// One tile.
#[derive(Clone, Debug)]
struct Tile {
    weights: Box<[f32]>,
    /// The belief that planning uses.
    in_use: Box<[f32]>,
    readings: u32,
}

/// What the tiles with readings have in common: what is believed of ground that was not visited.
#[derive(Clone, Debug)]
struct Common {
    /// Before anything was learnt.
    prior: Box<[f32]>,
    /// The belief of unvisited ground that planning uses.
    in_use: Box<[f32]>,
}

/// Beliefs over a rectangle, one tile at a time; a tile that nothing is known of uses no memory and is
/// believed to be as the visited ones are, as far as there are any.
#[derive(Clone, Debug)]
pub struct SoilTiles {
    settings: LearnSettings,
    common: Common,
    /// The slope that each level lets the robot climb, rad.
    steepest: Box<[f64]>,
    weight_n: f64,
    origin: (f64, f64),
    columns: usize,
    rows: usize,
    tiles: Vec<Option<Tile>>,
    /// Tiles with readings of their own.
    visited: Vec<usize>,
    changed: Vec<usize>,
    /// The belief of all unvisited ground has changed.
    all_changed: bool,
}

impl SoilTiles {
    /// Tiles over the rectangle from `low` to `high` (m), of which nothing is known yet.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a setting, or for more than a million tiles.
    pub fn new(
        family: &StrengthFamily,
        settings: LearnSettings,
        (low, high): ((f64, f64), (f64, f64)),
    ) -> Result<Self> {
        settings.check()?;
        let count = |from: f64, to: f64| ((to - from) / settings.tile).ceil().max(1.0);
        let (columns, rows) = (count(low.0, high.0), count(low.1, high.1));
        Error::check("[learn]", "tiles", columns * rows, (1.0, MAX_TILES), "1")?;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive, and limited just above"
        )]
        let (columns, rows) = (columns as usize, rows as usize);
        let levels = family.levels();
        let steepest: Vec<f64> = levels.iter().map(|level| level.table.steepest()).collect();
        let [strength, stiffness] = settings.prior_sigma_ln;
        let density = levels.iter().map(|level| {
            let z = (level.strength.ln() / strength).hypot(level.stiffness.ln() / stiffness);
            (-0.5 * z * z).exp()
        });
        let mut prior: Vec<f32> = density.map(to_f32).collect();
        normalise(&mut prior);
        let weight_n = levels
            .first()
            .map_or(0.0, |level| level.solver.model().weight());
        Ok(Self {
            settings,
            common: Common {
                in_use: prior.clone().into(),
                prior: prior.into(),
            },
            steepest: steepest.into(),
            weight_n,
            origin: low,
            columns,
            rows,
            tiles: vec![None; columns * rows],
            visited: Vec::new(),
            changed: Vec::new(),
            all_changed: false,
        })
    }

    /// The tile of a place; `None` outside.
    #[must_use]
    pub fn tile_at(&self, (x, y): (f64, f64)) -> Option<usize> {
        let place = |off: f64, count: usize| {
            let share = (off / self.settings.tile).floor();
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "within the tiles, as just checked"
            )]
            let index = (share >= 0.0 && share < count as f64).then_some(share as usize);
            index
        };
        let column = place(x - self.origin.0, self.columns)?;
        let row = place(y - self.origin.1, self.rows)?;
        Some(row * self.columns + column)
    }

    /// The belief that planning uses, a weight for each level.
    #[must_use]
    pub fn belief(&self, tile: usize) -> &[f32] {
        let tile = self.tiles.get(tile).and_then(Option::as_ref);
        tile.map_or(&self.common.in_use, |tile| &tile.in_use)
    }

    /// Has a belief in use changed since [`SoilTiles::take_changed`]?
    #[must_use]
    pub const fn has_changed(&self) -> bool {
        !self.changed.is_empty() || self.all_changed
    }

    /// Tiles whose belief in use has changed since the last call.
    pub fn take_changed(&mut self) -> Vec<usize> {
        let mut changed = std::mem::take(&mut self.changed);
        if std::mem::take(&mut self.all_changed) {
            let tiles = self.tiles.iter().enumerate();
            changed.extend(tiles.filter_map(|(index, tile)| tile.is_none().then_some(index)));
        }
        changed.sort_unstable();
        changed.dedup();
        changed
    }

    /// Learns from one reading; `weight` is how much it counts, 1 for ground without an earlier reading.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number that is not finite, [`Error::Law`].
    pub fn observe(
        &mut self,
        family: &StrengthFamily,
        reading: &SoilObservation,
        weight: f64,
    ) -> Result<()> {
        const ANGLE_RAD: (f64, f64) = (-1.05, 1.05);
        let of = "soil reading";
        Error::check(of, "pitch", reading.pitch, ANGLE_RAD, "rad")?;
        Error::check(of, "roll", reading.roll, ANGLE_RAD, "rad")?;
        Error::check(of, "slip", reading.slip, (-1.0, 1.0), "1")?;
        Error::check(of, "sigma of the slip", reading.slip_sigma, (0.0, 1.0), "1")?;
        Error::check(of, "weight", weight, (0.0, 100.0), "1")?;
        let Some(own) = self.tile_at(reading.place) else {
            return Ok(());
        };
        let likelihoods = self.log_likelihoods(family, reading)?;
        let (row, column) = (own / self.columns, own % self.columns);
        for r in row.saturating_sub(1)..(row + 2).min(self.rows) {
            for c in column.saturating_sub(1)..(column + 2).min(self.columns) {
                let tile = r * self.columns + c;
                let share = if tile == own {
                    1.0
                } else {
                    self.settings.spread
                };
                self.update(tile, &likelihoods, weight * share, tile == own);
            }
        }
        self.update_common();
        Ok(())
    }

    fn log_likelihoods(
        &self,
        family: &StrengthFamily,
        reading: &SoilObservation,
    ) -> Result<Vec<f64>> {
        let [absolute, share] = self.settings.slip_error;
        let levels = family.levels().iter();
        levels
            .map(|level| {
                let demand = level
                    .table
                    .demand(&level.solver, reading.pitch, reading.roll)?;
                let (slip, work) = match demand {
                    Demand::Drives(driving) => (driving.slip, Some(driving.energy_per_metre())),
                    Demand::Slides => (-BLOCKED_SLIP, None),
                    Demand::Immobilised | Demand::Lifts => (BLOCKED_SLIP, None),
                };
                let sigma = (share * slip).hypot(absolute).hypot(reading.slip_sigma);
                let mut square = ((reading.slip - slip) / sigma).powi(2);
                if let (Some(expected), Some(found)) = (work, reading.work_per_metre) {
                    let least = MIN_WORK_SHARE * self.weight_n;
                    let sigma = self.settings.work_error * expected.max(least);
                    square += ((found - expected) / sigma).powi(2);
                }
                Ok(-0.5 * square.min(MAX_SIGMA * MAX_SIGMA))
            })
            .collect()
    }

    fn update(&mut self, index: usize, likelihoods: &[f64], weight: f64, is_own: bool) {
        let common = &self.common;
        let tile = self.tiles[index].get_or_insert_with(|| Tile {
            weights: common.in_use.clone(),
            in_use: common.in_use.clone(),
            readings: 0,
        });
        if is_own {
            if tile.readings == 0 {
                self.visited.push(index);
            }
            tile.readings = tile.readings.saturating_add(1);
        }
        let greatest = likelihoods
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        let forget = self.settings.forget * weight.min(1.0);
        let priors = common.prior.iter();
        for ((w, prior), likelihood) in tile.weights.iter_mut().zip(priors).zip(likelihoods) {
            let held = (1.0 - forget) * f64::from(*w) + forget * f64::from(*prior);
            *w = to_f32(held * (weight * (likelihood - greatest)).exp());
        }
        normalise(&mut tile.weights);
        if difference(&tile.weights, &tile.in_use) > self.settings.hysteresis {
            tile.in_use.copy_from_slice(&tile.weights);
            self.changed.push(index);
        }
    }

    /// Takes up what the visited tiles have in common.
    fn update_common(&mut self) {
        let common = &mut self.common;
        let mut now: Vec<f32> = common.prior.iter().map(|w| PRIOR_TILES * w).collect();
        for tile in self
            .visited
            .iter()
            .filter_map(|index| self.tiles[*index].as_ref())
        {
            add(&mut now, &tile.weights);
        }
        normalise(&mut now);
        if difference(&now, &common.in_use) > self.settings.hysteresis {
            common.in_use.copy_from_slice(&now);
            self.all_changed = true;
        }
    }

    /// What is known of every tile with its own readings.
    #[must_use]
    pub fn learnt(&self) -> Vec<TileSummary> {
        let tiles = self.tiles.iter().enumerate();
        tiles
            .filter_map(|(index, tile)| {
                let tile = tile.as_ref().filter(|tile| tile.readings > 0)?;
                let (row, column) = (index / self.columns, index % self.columns);
                let middle = |from: f64, at: usize| from + (at as f64 + 0.5) * self.settings.tile;
                Some(TileSummary {
                    place: (middle(self.origin.0, column), middle(self.origin.1, row)),
                    steepest: quantile(&tile.weights, &self.steepest, 0.5),
                    low: quantile(&tile.weights, &self.steepest, TAIL_PROBABILITY),
                    high: quantile(&tile.weights, &self.steepest, 1.0 - TAIL_PROBABILITY),
                    readings: tile.readings,
                })
            })
            .collect()
    }
}

/// The slope below which this share of the weight lies. Levels are few: each stands for the slopes half-way to its neighbours,
/// over which its weight is spread evenly, so that a belief in one level has an interval, too.
fn quantile(weights: &[f32], slopes: &[f64], share: f64) -> f64 {
    let half_way = |a: usize, b: usize| 0.5 * (slopes[a] + slopes[b]);
    let last = slopes.len().saturating_sub(1);
    let mut sum = 0.0;
    for (level, w) in weights.iter().map(|w| f64::from(*w)).enumerate() {
        if sum + w >= share && w > 0.0 {
            let low = half_way(level.saturating_sub(1), level);
            let high = half_way(level, last.min(level + 1));
            return low + (high - low) * (share - sum) / w;
        }
        sum += w;
    }
    slopes.last().copied().unwrap_or(f64::NAN)
}

#[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
fn to_f32(value: f64) -> f32 {
    value as f32
}

fn add(sum: &mut [f32], weights: &[f32]) {
    for (sum, w) in sum.iter_mut().zip(weights) {
        *sum += w;
    }
}

/// The total variation between two beliefs.
fn difference(a: &[f32], b: &[f32]) -> f64 {
    f64::from(
        a.iter()
            .zip(b)
            .map(|(a, b)| 0.5 * (a - b).abs())
            .sum::<f32>(),
    )
}

fn normalise(weights: &mut [f32]) {
    let sum: f32 = weights.iter().sum();
    for w in weights {
        *w /= sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_lie_in_the_cells_of_the_levels() {
        let slopes = [0.1, 0.2, 0.4, 0.5];
        let of =
            |weights: [f32; 4]| [0.05, 0.5, 0.95].map(|share| quantile(&weights, &slopes, share));
        let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-7);
        // all weight between 0.15 and 0.3
        assert!(near(of([0.0, 1.0, 0.0, 0.0]), [0.1575, 0.225, 0.2925]));
        // half from 0.1 to 0.15, half from 0.45 to 0.5
        assert!(near(of([0.5, 0.0, 0.0, 0.5]), [0.105, 0.15, 0.495]));
        // of 0.96 and 0.04 the mean lies outside, the median does not
        let [low, median, high] = of([0.96, 0.0, 0.0, 0.04]);
        assert!(
            low < median && median < high && high < 0.15,
            "{low} {median} {high}"
        );
    }
}
