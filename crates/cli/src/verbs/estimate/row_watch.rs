//! What the rows of each wheel show beyond the summary.

use std::io;

use grouser_replay::{Quantiles, Row, Sink};
use grouser_slip::{Health, Invalid, Motion};

/// The longest time between two readings that the median resolves, s.
const MAX_PERIOD_S: f64 = 10.0;

/// The rows of all wheels.
#[derive(Clone, Debug)]
pub(super) struct RowWatch {
    /// Of each wheel, in the robot's order.
    pub(super) rows: Vec<WheelRows>,
}

impl RowWatch {
    pub(super) fn new(wheels: usize) -> Self {
        Self {
            rows: vec![WheelRows::new(); wheels],
        }
    }
}

impl Sink for RowWatch {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        if let Some(rows) = self.rows.get_mut(row.wheel) {
            rows.take(row);
        }
        Ok(())
    }
}

/// The rows of one wheel.
#[derive(Clone, Debug)]
pub(super) struct WheelRows {
    periods_s: Quantiles,
    /// The time in each health while it moves, s.
    healths: Vec<(Health, f64)>,
    /// Spans in which it contradicts the others: the one that goes on, and the longest, s.
    inconsistent: [Option<[f64; 2]>; 2],
}

impl WheelRows {
    fn new() -> Self {
        Self {
            periods_s: Quantiles::new(0.0, MAX_PERIOD_S),
            healths: Vec::new(),
            inconsistent: [None; 2],
        }
    }

    fn take(&mut self, row: &Row<'_>) {
        if row.lasts_s > 0.0 {
            self.periods_s.add(row.lasts_s);
        }
        if row.motion != Some(Motion::Standstill) && row.health != Health::Uninitialised {
            self.add(row.health, row.lasts_s);
        }
        let [now, longest] = &mut self.inconsistent;
        if row.health == Health::Invalid(Invalid::Inconsistent) {
            let since = now.map_or(row.time_s, |[since, _]| since);
            *now = Some([since, row.time_s]);
            let length = |span: Option<[f64; 2]>| span.map_or(-1.0, |[from, to]| to - from);
            if length(*now) > length(*longest) {
                *longest = *now;
            }
        } else {
            *now = None;
        }
    }

    fn add(&mut self, health: Health, seconds: f64) {
        match self.healths.iter_mut().find(|(known, _)| *known == health) {
            Some((_, sum)) => *sum += seconds,
            None => self.healths.push((health, seconds)),
        }
    }

    /// Share of the time in which it moves in each health.
    pub(super) fn healths_moving(&self) -> impl Iterator<Item = (Health, f64)> {
        let total: f64 = self.healths.iter().map(|(_, seconds)| seconds).sum();
        let share = move |(health, seconds): &(Health, f64)| (*health, seconds / total);
        self.healths.iter().filter(|(_, s)| *s > 0.0).map(share)
    }

    /// The longest span in which it contradicts the others, s.
    pub(super) const fn inconsistent_s(&self) -> Option<[f64; 2]> {
        self.inconsistent[1]
    }
    /// The median time between its readings, s.
    pub(super) fn period_s(&self) -> Option<f64> {
        self.periods_s.at(0.5)
    }
}
