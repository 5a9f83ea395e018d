//! What the rows of each wheel show beyond the summary.

use std::io;

use grouser_replay::{Quantiles, Row, Sink};
use grouser_slip::{Health, Invalid, Motion};

use super::request::Request;

/// The longest time between two readings that the median resolves, s.
const MAX_PERIOD_S: f64 = 10.0;

/// The rows of all wheels.
#[derive(Clone, Debug)]
pub(super) struct RowWatch {
    /// Of each wheel, in the robot's order.
    pub(super) rows: Vec<WheelRows>,
    /// A longer time without a row is a gap of the log, s.
    gap_s: f64,
}

impl RowWatch {
    pub(super) fn new(request: &Request) -> Self {
        let window_s = request.options.window_s;
        Self {
            rows: vec![WheelRows::new(); request.robot.robot.wheels().len()],
            gap_s: window_s.unwrap_or(request.robot.settings.window),
        }
    }
}

impl Sink for RowWatch {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        if let Some(rows) = self.rows.get_mut(row.wheel) {
            rows.take(row, self.gap_s);
        }
        Ok(())
    }
}

/// The rows of one wheel.
#[derive(Clone, Debug)]
pub(super) struct WheelRows {
    last_s: Option<f64>,
    periods_s: Quantiles,
    /// The time in each health while it moves, s.
    healths: Vec<(Health, f64)>,
    /// Spans in which it contradicts the others: the one that goes on, and the longest, s.
    inconsistent: [Option<[f64; 2]>; 2],
}

impl WheelRows {
    fn new() -> Self {
        Self {
            last_s: None,
            periods_s: Quantiles::new(0.0, MAX_PERIOD_S),
            healths: Vec::new(),
            inconsistent: [None; 2],
        }
    }

    /// Takes a row; a longer time than `gap_s` since the last is a gap in the log, and no time in a health.
    fn take(&mut self, row: &Row<'_>, gap_s: f64) {
        if let Some(last) = self.last_s.replace(row.time_s) {
            let since = row.time_s - last;
            self.periods_s.add(since);
            if row.motion != Some(Motion::Standstill) && row.health != Health::Uninitialised {
                self.add(row.health, since.min(gap_s));
            }
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
