//! What a map shows as a whole, gathered from its strips as they are written.

use grouser_terrain::{Band, MapLayout, Quantity, State};

/// Maximum side of the picture of a map, cells.
const MAX_SIDE: u32 = 800;
/// Bins of a slip from −1 to 1, for its quantiles.
const SLIP_BINS: usize = 2000;

/// The worst of a cell's headings, and of the cells that share a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::verbs) struct Worst {
    /// The slip of maximum magnitude; NaN where none drives.
    pub(super) slip: f32,
    /// Headings that cannot be driven, and headings.
    pub(super) blocked: u32,
    pub(super) headings: u32,
    /// The maximum probability of immobilisation.
    pub(super) risk: f32,
}

impl Worst {
    const NOTHING: Self = Self {
        slip: f32::NAN,
        blocked: 0,
        headings: 0,
        risk: 0.0,
    };

    /// Is nothing known of it?
    pub(super) const fn is_unknown(&self) -> bool {
        self.headings == 0
    }

    fn add(&mut self, other: Self) {
        if !(other.slip.abs() <= self.slip.abs()) && !other.slip.is_nan() {
            self.slip = other.slip;
        }
        self.blocked += other.blocked;
        self.headings += other.headings;
        self.risk = self.risk.max(other.risk);
    }
}

/// The pixels of a map's picture.
pub(in crate::verbs) struct Shades {
    columns: u32,
    /// Cells of the map that share a pixel, along each side.
    zoom: u32,
    pub(super) pixels: Vec<Worst>,
    pub(super) size: [u32; 2],
}

impl Shades {
    pub(in crate::verbs) fn new(layout: &MapLayout) -> Self {
        let zoom = layout.columns.max(layout.rows).div_ceil(MAX_SIDE).max(1);
        let size = [layout.columns, layout.rows].map(|side| side.div_ceil(zoom));
        Self {
            columns: layout.columns,
            zoom,
            pixels: vec![Worst::NOTHING; size[0] as usize * size[1] as usize],
            size,
        }
    }

    /// Slip and risk of the headings of a cell whose ground is known; gives the worst of them.
    pub(in crate::verbs) fn add(
        &mut self,
        cell: usize,
        headings: impl Iterator<Item = (f32, f32)>,
    ) -> Worst {
        let mut worst = Worst::NOTHING;
        for (slip, risk) in headings {
            worst.add(Worst {
                slip,
                blocked: u32::from(slip.is_nan()),
                headings: 1,
                risk,
            });
        }
        let [zoom, columns] = [self.zoom, self.columns].map(|side| side as usize);
        let (row, column) = (cell / columns / zoom, cell % columns / zoom);
        if let Some(pixel) = self.pixels.get_mut(row * self.size[0] as usize + column) {
            pixel.add(worst);
        }
        worst
    }
}

/// A map as a whole.
pub(super) struct Summary {
    layout: MapLayout,
    pub(super) shades: Shades,
    /// The costs of all cells, where a costmap is wanted: 0 to 100, and 255 where nothing is known.
    pub(super) costs: Option<Vec<u8>>,
    pub(super) cells: u64,
    pub(super) known: u64,
    /// Known cells that no heading can drive, and those that every heading can.
    pub(super) closed: u64,
    pub(super) open: u64,
    /// Cells and headings by state.
    pub(super) states: [u64; State::ALL.len()],
    slips: Vec<u64>,
    pub(super) energy_sum: f64,
    pub(super) energy_max: f64,
    pub(super) sinkage_max: f64,
    /// Cells and headings that drive with a wheel sunk too deep for the laws.
    pub(super) deep: u64,
    pub(super) tip_over_min: f64,
    pub(super) risk_sum: f64,
}

impl Summary {
    pub(super) fn new(layout: &MapLayout, with_costs: bool) -> Self {
        Self {
            layout: layout.clone(),
            shades: Shades::new(layout),
            costs: with_costs.then(Vec::new),
            cells: 0,
            known: 0,
            closed: 0,
            open: 0,
            states: [0; State::ALL.len()],
            slips: vec![0; SLIP_BINS],
            energy_sum: 0.0,
            energy_max: 0.0,
            sinkage_max: 0.0,
            deep: 0,
            tip_over_min: f64::INFINITY,
            risk_sum: 0.0,
        }
    }

    /// The next strip.
    pub(super) fn see(&mut self, strip: u32, cells: &[f32]) {
        let first = self.layout.rows_of(strip).start as usize * self.layout.columns as usize;
        for (index, cell) in cells.chunks_exact(self.layout.bands()).enumerate() {
            let worst = self.cell(first + index, cell);
            if let Some(costs) = &mut self.costs {
                costs.push(cost(&worst));
            }
        }
    }

    fn cell(&mut self, index: usize, cell: &[f32]) -> Worst {
        let headings = self.layout.headings;
        let value = |quantity, heading| cell[Band { quantity, heading }.index(headings)];
        let known = |heading: &usize| !value(Quantity::State, *heading).is_nan();
        let pairs = (0..headings.count()).filter(known).map(|heading| {
            (
                value(Quantity::Slip, heading),
                value(Quantity::Immobilisation, heading),
            )
        });
        let worst = self.shades.add(index, pairs);
        for heading in 0..headings.count() {
            let value = |quantity| value(quantity, heading);
            let Some(state) = State::from_code(value(Quantity::State)) else {
                continue;
            };
            self.states[state as usize] += 1;
            let slip = value(Quantity::Slip);
            self.risk_sum += f64::from(value(Quantity::Immobilisation));
            if slip.is_nan() {
                continue;
            }
            let [energy, sinkage, tip_over] =
                [Quantity::Energy, Quantity::Sinkage, Quantity::TipOver]
                    .map(|quantity| f64::from(value(quantity)));
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a bin of the histogram; the cast saturates"
            )]
            let bin = (0.5 * (f64::from(slip) + 1.0) * SLIP_BINS as f64) as usize;
            self.slips[bin.min(SLIP_BINS - 1)] += 1;
            self.energy_sum += energy;
            self.energy_max = self.energy_max.max(energy);
            self.sinkage_max = self.sinkage_max.max(sinkage);
            self.deep += u64::from(grouser_terra::is_deep(sinkage, self.layout.wheel_radius));
            self.tip_over_min = self.tip_over_min.min(tip_over);
        }
        self.cells += 1;
        if worst.headings > 0 {
            self.known += 1;
            self.closed += u64::from(worst.blocked == worst.headings);
            self.open += u64::from(worst.blocked == 0);
        }
        worst
    }

    /// Cells and headings that drive.
    pub(super) fn driving(&self) -> u64 {
        self.slips.iter().sum()
    }

    /// Cells and headings of which anything is known.
    pub(super) fn poses(&self) -> u64 {
        self.states.iter().sum()
    }

    /// A quantile of the slip of cells and headings that drive, to 0.001.
    pub(super) fn slip_quantile(&self, share: f64) -> Option<f64> {
        let total = self.driving();
        let mut left = share * total as f64;
        let bin = self.slips.iter().position(|count| {
            left -= *count as f64;
            left <= 0.0
        })?;
        (total > 0).then(|| 2.0 * (bin as f64 + 0.5) / SLIP_BINS as f64 - 1.0)
    }
}

/// The cost of a cell for planners that know no headings, by its worst one: 100 where one cannot be driven, 255 unknown.
fn cost(worst: &Worst) -> u8 {
    const LETHAL_COST: f32 = 100.0;
    const MAX_DRIVEN: f32 = 99.0;
    if worst.is_unknown() {
        return u8::MAX;
    }
    let slip = worst.slip.abs();
    let cost = if worst.blocked > 0 {
        LETHAL_COST
    } else {
        (MAX_DRIVEN * slip.max(worst.risk)).clamp(0.0, MAX_DRIVEN)
    };
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and 100, as just clamped"
    )]
    let cost = cost.round() as u8;
    cost
}
