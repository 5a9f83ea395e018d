//! How far a search has come, and what it foresees of its time.

use std::time::Instant;

/// What a box of the batch before still counts where the time of the next ones is foreseen: batches with and without bounds of
/// second order alternate, and one delay of the machine is forgotten.
const KEPT_BOX_SHARE: f64 = 0.9;

/// How far the search has come.
pub(super) struct Reach {
    pub(super) began: Instant,
    pub(super) boxes: u64,
    /// Of the longest box, those of earlier batches counting less and less; s.
    box_s: f64,
    /// Of the boxes together, and of the batches: several are examined at once.
    busy_s: f64,
    batches_s: f64,
    /// Of what is entered into a log; s.
    entered_s: f64,
    /// Of one bound, with which an open box ends in the log, the mean; s. Not the longest: one delay of the machine would
    /// count for every open box.
    bound_s: f64,
    /// Bounds in this mean.
    bounds: u32,
    /// Bytes of the log that the longest batch took.
    pub(super) batch_bytes: u64,
}

impl Reach {
    pub(super) fn new(began: Instant) -> Self {
        Self {
            began,
            boxes: 0,
            box_s: 0.0,
            busy_s: 0.0,
            batches_s: 0.0,
            entered_s: 0.0,
            bound_s: 0.0,
            bounds: 0,
            batch_bytes: 0,
        }
    }

    /// The boxes of a batch took so long, each, and the batch.
    pub(super) fn examined(&mut self, boxes_s: &[f64], batch_s: f64) {
        if let Some(longest) = boxes_s.iter().copied().reduce(f64::max) {
            self.box_s = longest.max(KEPT_BOX_SHARE * self.box_s);
            self.busy_s += boxes_s.iter().sum::<f64>();
            self.batches_s += batch_s;
        }
        self.boxes += boxes_s.len() as u64;
    }

    /// To enter a batch into the log took so long.
    pub(super) fn entered(&mut self, seconds: f64) {
        self.entered_s += seconds;
    }

    /// What the end of the log takes where so many boxes are open; s.
    fn end_s(&self, open: usize) -> f64 {
        if self.bounds == 0 || self.busy_s <= 0.0 {
            return 0.0;
        }
        let bound_s = self.bound_s * self.batches_s / self.busy_s;
        open as f64 * (bound_s + self.entered_s / self.boxes as f64)
    }

    /// When the last box may begin that ends within the limit, and the log with it; s after the beginning.
    pub(super) fn last_begin_s(&self, limit_s: Option<f64>, open: usize) -> f64 {
        limit_s.map_or(f64::INFINITY, |limit| limit - self.box_s - self.end_s(open))
    }

    /// A bound took so long.
    pub(super) fn bounded(&mut self, seconds: f64) {
        self.bounds += 1;
        self.bound_s += (seconds - self.bound_s) / f64::from(self.bounds);
    }

    pub(super) fn seconds(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }
}

#[cfg(test)]
#[path = "reach_tests.rs"]
mod tests;
