//! The cells of a map.

use std::ops::Range;

use grouser_rover::ground::Georeference;

use super::bands::{Band, Quantity, State};
use super::layout::MapSettings;
use super::tip_over::TipOverTable;
use crate::demand::{Demand, DemandSolver, Driving};
use crate::error::{Error, Result};
use crate::headings::Headings;
use crate::pose::{Footprint, SurfacePose};
use crate::raster::Window;
use crate::soil_map::SoilMap;
use crate::table::{Lookup, SlipTable, TableError};

/// Share of the soil draws that [`Quantity::SlipHigh`] covers.
const HIGH_SHARE: f64 = 0.95;

/// One soil: exact solver and table.
type SoilTable = (DemandSolver, SlipTable);

/// A soil of a map: itself, and the soils drawn from its intervals.
#[derive(Clone, Debug)]
pub struct MapSoil {
    own: SoilTable,
    /// The strongest first.
    draws: Vec<SoilTable>,
}

impl MapSoil {
    /// A soil with its draws, which are ordered by the slope that they let the robot climb.
    #[must_use]
    pub fn new(own: SoilTable, mut draws: Vec<SoilTable>) -> Self {
        draws.sort_by(|a, b| b.1.steepest().total_cmp(&a.1.steepest()));
        Self { own, draws }
    }

    fn tables(&self) -> impl Iterator<Item = &SoilTable> {
        std::iter::once(&self.own).chain(&self.draws)
    }

    /// The slopes that the robot climbs straight on: on the soil itself, on the weakest and on the strongest draw, rad.
    #[must_use]
    pub fn steepest(&self) -> [f64; 3] {
        let own = self.own.1.steepest();
        let of = |draw: Option<&SoilTable>| draw.map_or(own, |(_, table)| table.steepest());
        [own, of(self.draws.last()), of(self.draws.first())]
    }
}

/// Computes the cells of a map.
///
/// ```
/// use grouser_rover::robot::RobotModel;
/// use grouser_terra::catalogue;
/// use grouser_terrain::raster::Window;
/// use grouser_terrain::{Band, DemandSolver, Envelope, Headings, MapMaker, MapSettings, SlipTable};
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/skid-steer.toml");
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil().expect("complete");
/// let solver = DemandSolver::new(RobotModel::read(file.as_ref())?, soil)?;
/// let envelope = Envelope::within(solver.model(), 0.3, 0.2)?;
/// let table = SlipTable::new(&solver, envelope)?;
/// let headings = Headings::new(4)?;
/// let maker = MapMaker::new(MapSettings::new(headings, envelope), (solver, table), Vec::new(), 1.0);
/// // five by five cells of 1 m, all level: one value a band for each cell
/// let level = Window::new(5, &[0.0; 25]);
/// assert_eq!(maker.rows(&level, 2..3)?.len(), 5 * Band::count(headings));
/// # Ok::<(), grouser_terrain::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct MapMaker {
    headings: Headings,
    settings: MapSettings,
    /// The map's own soil, then those of the soil map.
    soils: Vec<MapSoil>,
    /// The soils by strength, the weakest first.
    by_strength: Vec<usize>,
    place: Option<(SoilMap, Georeference)>,
    footprints: Vec<Footprint>,
    tip_over: TipOverTable,
}

impl MapMaker {
    /// A map's maker, for cells of `cell` (m): the soil itself, and the soils drawn from its intervals, which it orders by the
    /// slope that they let the robot climb.
    #[must_use]
    pub fn new(settings: MapSettings, soil: SoilTable, draws: Vec<SoilTable>, cell: f64) -> Self {
        let headings = settings.headings;
        let model = soil.0.model();
        Self {
            headings,
            settings,
            footprints: Footprint::all(model, headings, cell),
            tip_over: TipOverTable::new(model, settings.envelope),
            soils: vec![MapSoil::new(soil, draws)],
            by_strength: vec![0],
            place: None,
        }
    }

    /// The same with several soils: `soils` are those of the map's legend, in its order; the elevation model lies at
    /// `georeference`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless there is one soil for each of the legend's.
    pub fn with_soil_map(
        mut self,
        place: SoilMap,
        soils: Vec<MapSoil>,
        georeference: Georeference,
    ) -> Result<Self> {
        let count = place.soils().len() as f64;
        Error::check("soil map", "soils", soils.len() as f64, (count, count), "1")?;
        self.soils.truncate(1);
        self.soils.extend(soils);
        self.by_strength = (0..self.soils.len()).collect();
        let weakest = |index: &usize| self.soils[*index].steepest()[0];
        self.by_strength
            .sort_by(|a, b| weakest(a).total_cmp(&weakest(b)));
        self.place = Some((place, georeference));
        Ok(self)
    }

    /// The weakest soil under a wheel of a robot in a cell.
    fn soil_of(&self, footprint: &Footprint, (row, column): (i64, i64)) -> usize {
        let Some((map, georeference)) = &self.place else {
            return 0;
        };
        let under = footprint.cells().filter_map(|[down, right]| {
            let row = u32::try_from(row + down).ok()?;
            let column = u32::try_from(column + right).ok()?;
            Some(map.soil_at(georeference.centre(column, row)?))
        });
        let rank = |soil: &usize| self.by_strength.iter().position(|other| other == soil);
        under.min_by_key(rank).unwrap_or(0)
    }

    /// Rows above and below a cell that its numbers depend on.
    #[must_use]
    pub fn reach(&self) -> u32 {
        let reach = self.footprints.iter().map(Footprint::reach).max();
        reach
            .and_then(|reach| u32::try_from(reach).ok())
            .unwrap_or(0)
    }

    /// How well the tables agree with the exact solver, the worst of all soils.
    #[must_use]
    pub fn table_error(&self) -> TableError {
        let tables = self.soils.iter().flat_map(MapSoil::tables);
        tables
            .map(|(_, table)| *table.error())
            .fold(TableError::default(), TableError::worst)
    }

    /// How well the tip-over margins agree with the exact ones, rad.
    #[must_use]
    pub fn tip_over_error(&self) -> f64 {
        self.tip_over.error
    }

    /// The soils: the map's own, then those of the legend.
    #[must_use]
    pub fn soils(&self) -> &[MapSoil] {
        &self.soils
    }

    /// All bands of the cells of `rows`, row by row, for each cell band by band.
    ///
    /// # Errors
    /// As [`DemandSolver::demand`].
    pub fn rows(&self, window: &Window<'_>, rows: Range<u32>) -> Result<Vec<f32>> {
        let bands = Band::count(self.headings);
        let columns = window.columns() as usize;
        let mut out = vec![f32::NAN; rows.len() * columns * bands];
        let mut scratch = DrawScratch::default();
        let cells = rows.flat_map(|row| {
            (0..window.columns()).map(move |column| (i64::from(row), i64::from(column)))
        });
        for ((row, column), cell) in cells.zip(out.chunks_exact_mut(bands)) {
            for (heading, footprint) in self.footprints.iter().enumerate() {
                let height = |down: i64, right: i64| window.height(row + down, column + right);
                if let Some(pose) = footprint.pose(height) {
                    let soil = self.soil_of(footprint, (row, column));
                    self.fill(pose, (heading, soil), cell, &mut scratch)?;
                }
            }
        }
        Ok(out)
    }

    fn fill(
        &self,
        pose: SurfacePose,
        (heading, soil): (usize, usize),
        cell: &mut [f32],
        scratch: &mut DrawScratch,
    ) -> Result<()> {
        let mut set = |quantity: Quantity, value: f64| {
            #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
            let value = value as f32;
            cell[Band { quantity, heading }.index(self.headings)] = value;
        };
        let SurfacePose { pitch, roll } = pose;
        set(Quantity::Soil, soil as f64);
        let MapSoil { own, draws } = &self.soils[soil];
        set(Quantity::Pitch, pitch.to_degrees());
        if !self.settings.envelope.holds(pitch, roll) {
            set(Quantity::State, f64::from(State::Steep.code()));
            set(Quantity::Immobilisation, 1.0);
            return Ok(());
        }
        set(
            Quantity::TipOver,
            self.tip_over.margin(pitch, roll).to_degrees(),
        );
        let (state, driving) = on_soil(own, pitch, roll)?;
        set(Quantity::State, f64::from(state.code()));
        if let Some(driving) = driving {
            set(Quantity::Slip, driving.slip);
            set(Quantity::Sinkage, driving.sinkage);
            set(Quantity::Energy, driving.energy_per_metre());
        }
        if draws.is_empty() {
            set(
                Quantity::Immobilisation,
                if driving.is_some() { 0.0 } else { 1.0 },
            );
            if let Some(driving) = driving {
                set(Quantity::SlipHigh, driving.slip);
                set(Quantity::EnergyCvar, driving.energy_per_metre());
            }
            return Ok(());
        }
        let failing = scratch.read(draws, pitch, roll)?;
        let count = draws.len();
        set(
            Quantity::Immobilisation,
            (count - failing) as f64 / count as f64,
        );
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 0 and the number of draws"
        )]
        let rank = ((HIGH_SHARE * count as f64).ceil() as usize).clamp(1, count) - 1;
        let (_, high, _) = scratch.slips.select_nth_unstable_by(rank, f32::total_cmp);
        if high.is_finite() {
            set(Quantity::SlipHigh, f64::from(*high));
        }
        if driving.is_some() {
            let energy = cvar(&mut scratch.energies, self.settings.cvar_level);
            set(Quantity::EnergyCvar, energy);
        }
        Ok(())
    }
}

/// The state on the soil itself.
fn on_soil((solver, table): &SoilTable, pitch: f64, roll: f64) -> Result<(State, Option<Driving>)> {
    Ok(match table.look_up(pitch, table.across(roll)) {
        Lookup::Drives(spot) => (State::Drives, Some(table.driving(&spot))),
        Lookup::Immobilised => (State::Immobilised, None),
        Lookup::Slides => (State::Slides, None),
        Lookup::Marginal => match solver.demand(pitch, roll)? {
            Demand::Drives(driving) => (State::Marginal, Some(driving)),
            Demand::Slides => (State::Slides, None),
            Demand::Immobilised | Demand::Lifts => (State::Immobilised, None),
        },
    })
}

/// What the draws of a soil take in one pose.
#[derive(Clone, Debug, Default)]
struct DrawScratch {
    /// Infinite where a draw is immobilised or slides.
    slips: Vec<f32>,
    /// J/m; the greatest of the draw where it is immobilised or slides.
    energies: Vec<f64>,
}

impl DrawScratch {
    /// Reads all draws; gives the index of the strongest one that is immobilised or slides, or their number
    /// where all drive.
    fn read(&mut self, draws: &[SoilTable], pitch: f64, roll: f64) -> Result<usize> {
        self.slips.clear();
        self.energies.clear();
        let mut failing = draws.len();
        let mut across = None;
        for (index, (solver, table)) in draws.iter().enumerate() {
            let nodes = table.nodes()[0];
            let stencil = match across {
                Some((count, stencil)) if count == nodes => stencil,
                _ => {
                    let stencil = table.across(roll);
                    across = Some((nodes, stencil));
                    stencil
                }
            };
            let driving = match table.look_up(pitch, stencil) {
                Lookup::Drives(spot) => Some((spot.slip, table.energy_per_metre(&spot))),
                Lookup::Immobilised | Lookup::Slides => None,
                Lookup::Marginal => match solver.demand(pitch, roll)? {
                    Demand::Drives(driving) => Some((driving.slip, driving.energy_per_metre())),
                    _ => None,
                },
            };
            if driving.is_none() && failing > index {
                failing = index;
            }
            let (slip, energy) = driving.unwrap_or_else(|| (f64::INFINITY, table.max_energy()));
            #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
            self.slips.push(slip as f32);
            self.energies.push(energy);
        }
        Ok(failing)
    }
}

/// The mean of the greatest 1 − `level` of the values; one of them counts in part where that is no whole
/// number.
///
/// Source: Rockafellar and Uryasev (2002), section 3, for a discrete distribution.
fn cvar(values: &mut [f64], level: f64) -> f64 {
    let count = values.len() as f64;
    // at least the greatest value
    let tail = ((1.0 - level) * count).max(1.0);
    values.sort_unstable_by(|a, b| b.total_cmp(a));
    let mut left = tail;
    let mut sum = 0.0;
    for value in values {
        let weight = left.clamp(0.0, 1.0);
        if weight <= 0.0 {
            break;
        }
        sum += weight * *value;
        left -= 1.0;
    }
    sum / tail
}
