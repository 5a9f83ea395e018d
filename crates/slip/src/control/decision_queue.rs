//! Decisions that wait to be reported, one a step.

use super::decision::Decision;

/// Decisions of one step at most; four wheels that all report and a change of mode need five.
const CAPACITY: usize = 16;

/// Decisions that have not been reported yet; a full queue drops the newest.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DecisionQueue {
    list: [Option<Decision>; CAPACITY],
}

impl DecisionQueue {
    pub(super) fn push(&mut self, decision: Decision) {
        if let Some(free) = self.list.iter_mut().find(|entry| entry.is_none()) {
            *free = Some(decision);
        }
    }

    /// The oldest one, stamped with now.
    pub(super) fn pop(&mut self, time_ns: i64) -> Option<Decision> {
        let first = self.list[0].take()?;
        self.list.rotate_left(1);
        Some(Decision { time_ns, ..first })
    }
}
