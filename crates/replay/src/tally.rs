//! The counters of one wheel.

use std::f64::consts::PI;

use grouser_slip::Wheel;

use crate::quantiles::Quantiles;
use crate::sink::Row;
use crate::summary::{Shares, Spread, WheelSummary};

/// What is counted of one wheel over the span.
#[derive(Clone, Debug)]
pub(crate) struct Tally {
    slips: Quantiles,
    angles: Quantiles,
    shares: Shares,
    last_ns: Option<i64>,
}

impl Tally {
    pub(crate) fn new() -> Self {
        Self {
            slips: Quantiles::new(-1.0, 1.0),
            angles: Quantiles::new(-PI, PI),
            shares: Shares::new(),
            last_ns: None,
        }
    }

    /// The wheel is read at `now_ns`; returns the seconds since it was read last.
    pub(crate) fn read(&mut self, now_ns: i64) -> f64 {
        let last = self.last_ns.replace(now_ns);
        last.map_or(0.0, |last| now_ns.saturating_sub(last) as f64 * 1e-9)
    }

    /// Counts a row that stands for `seconds`.
    pub(crate) fn add(&mut self, row: &Row<'_>, seconds: f64) {
        if let Some(slip) = row.slip {
            self.slips.add(slip);
        }
        if let Some(angle) = row.side_slip_angle {
            self.angles.add(angle);
        }
        self.shares.add(row.motion, row.health, seconds);
    }

    pub(crate) const fn has_slip(&self) -> bool {
        self.slips.count() > 0
    }

    pub(crate) fn summary(&self, wheel: &Wheel, is_reference: bool) -> WheelSummary {
        WheelSummary {
            name: wheel.name.clone(),
            is_reference,
            slip: Spread::from(&self.slips),
            window_slip: None,
            side_slip_angle: Spread::from(&self.angles),
            states: self.shares.motions(),
            healths: self.shares.healths(),
        }
    }
}
