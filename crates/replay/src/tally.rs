//! The counters of one wheel.

use std::f64::consts::PI;

use grouser_slip::Wheel;

use crate::gaps::Gaps;
use crate::quantiles::Quantiles;
use crate::sink::Row;
use crate::summary::{Shares, Spread, WheelSummary};

/// What is counted of one wheel over the span.
#[derive(Clone, Debug)]
pub(crate) struct Tally {
    slips: Quantiles,
    angles: Quantiles,
    shares: Shares,
    gaps: Gaps,
}

impl Tally {
    pub(crate) fn new() -> Self {
        Self {
            slips: Quantiles::new(-1.0, 1.0),
            angles: Quantiles::new(-PI, PI),
            shares: Shares::new(),
            gaps: Gaps::default(),
        }
    }

    /// The wheel is read at `now_ns`; returns the seconds since it was read last. A gap in the log is no time in a state.
    pub(crate) fn read(&mut self, now_ns: i64) -> f64 {
        self.gaps.passed(now_ns).map_or(0.0, |(passed, _)| passed)
    }

    /// Counts a row.
    pub(crate) fn add(&mut self, row: &Row<'_>) {
        if let Some(slip) = row.slip {
            self.slips.add(slip);
        }
        if let Some(angle) = row.side_slip_angle {
            self.angles.add(angle);
        }
        self.shares.add(row.motion, row.health, row.lasts_s);
    }

    pub(crate) const fn has_slip(&self) -> bool {
        self.slips.count() > 0
    }

    pub(crate) fn summary(&self, wheel: &Wheel, is_reference: bool) -> WheelSummary {
        WheelSummary {
            name: wheel.name.clone(),
            is_reference,
            slip: Spread::from(&self.slips),
            side_slip_angle: Spread::from(&self.angles),
            states: self.shares.motions(),
            healths: self.shares.healths(),
        }
    }
}
