//! A quantity over time, between whose points is interpolated.

/// Points of a quantity in the order of time.
#[derive(Debug, Default)]
pub(super) struct Track {
    points: Vec<(f64, f64)>,
    /// Its last rate, where it is the integral of one.
    rate: f64,
}

impl Track {
    pub(super) fn push(&mut self, time: f64, value: f64) {
        self.points.push((time, value));
    }

    /// The value of the last point; 0 before the first one.
    pub(super) fn last(&self) -> f64 {
        self.points.last().map_or(0.0, |point| point.1)
    }

    /// Adds the integral of a rate, which changes linearly or `holds` since the reading before.
    pub(super) fn integrate(&mut self, time: f64, rate: f64, holds: bool) {
        let (before, sum) = self.points.last().copied().unwrap_or((time, 0.0));
        let mean = if holds || self.points.is_empty() {
            rate
        } else {
            0.5 * (self.rate + rate)
        };
        self.points.push((time, sum + mean * (time - before)));
        self.rate = rate;
    }

    /// Its value at a time, that of the nearest point before the first and after the last one; `None` without points.
    pub(super) fn at(&self, time: f64) -> Option<f64> {
        let next = self.points.partition_point(|point| point.0 < time);
        let after = self.points.get(next);
        let before = next.checked_sub(1).map(|last| &self.points[last]);
        match (before, after) {
            (Some(a), Some(b)) => Some(a.1 + (b.1 - a.1) * (time - a.0) / (b.0 - a.0)),
            (one, other) => one.or(other).map(|point| point.1),
        }
    }

    /// Number of points from a time on, and the time that they span.
    pub(super) fn spans(&self, from: f64) -> (usize, f64) {
        let first = self.points.partition_point(|point| point.0 < from);
        let points = &self.points[first..];
        match (points.first(), points.last()) {
            (Some(first), Some(last)) => (points.len(), last.0 - first.0),
            _ => (0, 0.0),
        }
    }

    /// How much it changes between two times; `None` where a gap between its points is longer than `max_gap`.
    pub(super) fn change(&self, from: f64, to: f64, max_gap: f64) -> Option<f64> {
        let first = self.points.partition_point(|point| point.0 <= from);
        let first = first.checked_sub(1)?;
        let last = self.points.partition_point(|point| point.0 < to);
        let used = self.points.get(first..=last)?;
        let has_gap = used.windows(2).any(|pair| pair[1].0 - pair[0].0 > max_gap);
        let at = |time: f64, (a, b): ((f64, f64), (f64, f64))| {
            if b.0 > a.0 {
                a.1 + (b.1 - a.1) * (time - a.0) / (b.0 - a.0)
            } else {
                a.1
            }
        };
        let count = used.len();
        (count >= 2 && !has_gap)
            .then(|| at(to, (used[count - 2], used[count - 1])) - at(from, (used[0], used[1])))
    }

    /// The points before a time are no longer needed, but for the last of them.
    pub(super) fn forget(&mut self, time: f64) {
        let first = self.points.partition_point(|point| point.0 < time);
        self.points.drain(..first.saturating_sub(1));
    }
}
