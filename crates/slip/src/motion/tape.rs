//! What a pass over the steps did to the belief, for the pass back.

use alloc::boxed::Box;
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
    /// The end of a step, with the belief there.
    End(Box<Belief>),
}

/// The operations in their order.
#[derive(Clone, Debug, Default)]
pub struct Tape(pub Vec<Entry>);

impl Tape {
    pub(super) fn push(&mut self, entry: Entry) {
        self.0.push(entry);
    }
}
