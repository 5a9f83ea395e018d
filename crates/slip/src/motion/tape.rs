//! What a pass over the steps did to the belief, for the pass back.

use alloc::vec::Vec;

use super::belief::{Belief, Correction, Row};
use super::noise::Noise;

/// One operation on the belief.
#[derive(Clone, Debug)]
pub enum Entry {
    /// Process noise of a kind was added to a number.
    Noise {
        /// Its kind.
        noise: Noise,
        /// The number.
        index: usize,
        /// Time (or distance) that the level is multiplied by.
        exposure: f64,
    },
    /// One row of the transition.
    Propagate {
        /// The number.
        index: usize,
        /// The row.
        row: Row,
    },
    /// A scalar measurement.
    Update {
        /// The kind of its noise.
        noise: Noise,
        /// What it did.
        correction: Correction,
        /// Variance of its noise.
        variance: f64,
        /// Which reading of the step; `None` of wheels.
        reading: Option<usize>,
    },
    /// The end of a step.
    End,
}

/// The operations in their order, and the belief at each step's end.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    /// The operations.
    pub entries: Vec<Entry>,
    /// The beliefs.
    pub ends: Vec<Belief>,
}

impl Tape {
    /// Empties it and keeps its memory.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.ends.clear();
    }
}
