//! What a map holds for a cell and a heading.

use crate::headings::Headings;

/// A quantity of a map; each has one band a heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Quantity {
    /// The slip that driving takes on the soil itself.
    Slip,
    /// The slip that 95 % of the soil draws do not exceed.
    SlipHigh,
    /// The greatest sinkage of a wheel, m.
    Sinkage,
    /// Energy at the wheels per metre of travel, J/m.
    Energy,
    /// The mean of [`Quantity::Energy`] over the worst soil draws, J/m: its conditional value at risk (CVaR)
    /// at the map's level. A draw on which the robot does not drive here counts with the greatest energy that
    /// it takes anywhere it drives.
    EnergyCvar,
    /// How much further the ground may tilt until the robot tips over, deg.
    TipOver,
    /// Probability of immobilisation, an upper bound: the share of soil draws that are no stronger than the strongest one
    /// that is immobilised here. Draws are ordered by the slope that they let the robot climb, the same everywhere, so that
    /// the greatest value along a way bounds the share of draws that are immobilised anywhere on it.
    Immobilisation,
    /// Pitch of the robot on the relief, nose up positive, deg.
    Pitch,
    /// A [`State`].
    State,
    /// The weakest soil under a wheel: 0 for the soil that the map is made for, else the index in the soil map's legend
    /// plus one. The other quantities are those of the robot with all wheels on it.
    Soil,
}

impl Quantity {
    /// In the order of the bands.
    pub const ALL: [Self; 10] = [
        Self::Slip,
        Self::SlipHigh,
        Self::Sinkage,
        Self::Energy,
        Self::EnergyCvar,
        Self::TipOver,
        Self::Immobilisation,
        Self::Pitch,
        Self::State,
        Self::Soil,
    ];

    /// Its name in files.
    ///
    /// ```
    /// assert_eq!(grouser_terrain::Quantity::Energy.key(), "energy_j_per_m");
    /// ```
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Slip => "slip",
            Self::SlipHigh => "slip_95",
            Self::Sinkage => "sinkage_m",
            Self::Energy => "energy_j_per_m",
            Self::EnergyCvar => "energy_cvar_j_per_m",
            Self::TipOver => "tip_over_deg",
            Self::Immobilisation => "immobilisation",
            Self::Pitch => "pitch_deg",
            Self::State => "state",
            Self::Soil => "soil",
        }
    }

    const fn index(self) -> usize {
        self as usize
    }
}

/// A quantity at a heading.
///
/// ```
/// use grouser_terrain::{Band, Headings, Quantity};
///
/// let headings = Headings::new(8)?;
/// let band = Band { quantity: Quantity::Energy, heading: 2 };
/// assert_eq!((band.index(headings), Band::count(headings)), (26, 80));
/// assert_eq!(band.name(headings), "energy_j_per_m, heading 90 deg");
/// # Ok::<(), grouser_terrain::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Band {
    /// What.
    pub quantity: Quantity,
    /// Which heading.
    pub heading: usize,
}

impl Band {
    /// Its index among the bands of a file, from 0.
    #[must_use]
    pub const fn index(self, headings: Headings) -> usize {
        self.quantity.index() * headings.count() + self.heading
    }

    /// Bands of a file.
    #[must_use]
    pub const fn count(headings: Headings) -> usize {
        Quantity::ALL.len() * headings.count()
    }

    /// Its description in a file.
    #[must_use]
    pub fn name(self, headings: Headings) -> String {
        let angle = headings.angle(self.heading).to_degrees();
        let angle = (100.0 * angle).round() / 100.0;
        format!("{}, heading {angle} deg", self.quantity.key())
    }
}

/// How a robot fares in a cell at a heading. Unknown ground has no state: every band is NaN.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum State {
    /// It drives; read from the table.
    Drives,
    /// It drives or not, solved exactly: the table's error could have decided.
    Marginal,
    /// No slip gives the pull.
    Immobilised,
    /// It slides downhill.
    Slides,
    /// Steeper than the map's envelope.
    Steep,
}

impl State {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Drives,
        Self::Marginal,
        Self::Immobilised,
        Self::Slides,
        Self::Steep,
    ];

    /// Its number in a file.
    #[must_use]
    pub const fn code(self) -> f32 {
        self as u8 as f32
    }

    /// Of a file's number; `None` for unknown ground.
    ///
    /// ```
    /// use grouser_terrain::State;
    ///
    /// assert_eq!(State::from_code(2.0), Some(State::Immobilised));
    /// assert_eq!(State::from_code(f32::NAN), None);
    /// ```
    #[must_use]
    pub fn from_code(code: f32) -> Option<Self> {
        Self::ALL.into_iter().find(|state| state.code() == code)
    }
}
