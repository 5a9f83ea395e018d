//! Boxes that are not closed, in the order of their bounds.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use grouser_real::Interval;

use super::bound::Weights;

/// The greatest number of divisions between two attempts at a bound of second order.
const MAX_WAIT: u8 = 6;

/// A box that is still open.
pub(super) struct Open {
    pub(super) id: u64,
    pub(super) bound: f64,
    pub(super) weights: Weights,
    pub(super) x: Vec<Interval>,
    pub(super) backoff: Backoff,
}

/// Bounds of second order are expensive: the more of them failed on the way to a box, the fewer are tried.
#[derive(Clone, Copy, Default)]
pub(super) struct Backoff {
    pub(super) failed: u8,
    /// Divisions until the next attempt.
    pub(super) wait: u8,
}

impl Backoff {
    /// After the division of a box, for which such a bound was tried or not.
    pub(super) fn after(self, tried: bool) -> Self {
        if !tried {
            return Self {
                wait: self.wait.saturating_sub(1),
                ..self
            };
        }
        let failed = (self.failed + 1).min(MAX_WAIT);
        Self {
            failed,
            wait: failed,
        }
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Open {}
impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Open {
    /// The lowest bound first, then the oldest.
    fn cmp(&self, other: &Self) -> Ordering {
        other
            .bound
            .total_cmp(&self.bound)
            .then(other.id.cmp(&self.id))
    }
}

/// What an allocation takes beside its bytes.
const ALLOCATION_BYTES: usize = 16;

impl Open {
    /// The memory that it takes.
    fn bytes(&self) -> u64 {
        let lists = [
            size_of_val(&self.x[..]),
            size_of_val(&self.weights.rows[..]),
            self.weights
                .tangent
                .as_ref()
                .map_or(0, |tangent| size_of_val(&tangent.at[..])),
        ];
        let all: usize = lists.iter().map(|bytes| bytes + ALLOCATION_BYTES).sum();
        (size_of::<Self>() + all) as u64
    }
}

/// The boxes that are not closed, and the memory that they take.
#[derive(Default)]
pub(super) struct OpenBoxes {
    pub(super) heap: BinaryHeap<Open>,
    pub(super) stuck: Vec<Open>,
    pub(super) bytes: u64,
}

impl OpenBoxes {
    pub(super) fn push(&mut self, open: Open) {
        self.bytes += open.bytes();
        self.heap.push(open);
    }

    pub(super) fn pop(&mut self) -> Option<Open> {
        let open = self.heap.pop()?;
        self.bytes -= open.bytes();
        Some(open)
    }

    pub(super) fn hold(&mut self, stuck: Open) {
        self.bytes += stuck.bytes();
        self.stuck.push(stuck);
    }

    pub(super) fn count(&self) -> usize {
        self.heap.len() + self.stuck.len()
    }
}
