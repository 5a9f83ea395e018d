//! Ways, slip along the track and yaw rates over windows, whatever finds the wheels' slips.

use grouser_slip::window::WindowBody;

use crate::quantiles::Quantiles;
use crate::summary::{AlongSummary, Spread, YawSummary, overall};

/// The counters of one span of a log.
#[derive(Clone, Debug)]
pub(crate) struct Ways {
    low_speed: f64,
    window: f64,
    along: Quantiles,
    yaw: Quantiles,
    until_ns: Option<i64>,
    /// Ways by the wheels and by the reference, m, at the beginning of the span and at its end.
    before: (f64, f64),
    after: (f64, f64),
}

impl Ways {
    pub(crate) fn new(low_speed: f64, window: f64) -> Self {
        Self {
            low_speed,
            window,
            along: Quantiles::new(-1.0, 1.0),
            yaw: Quantiles::new(0.0, 1.0),
            until_ns: None,
            before: (0.0, 0.0),
            after: (0.0, 0.0),
        }
    }

    /// The span has not begun.
    pub(crate) const fn wait(&mut self, body: &WindowBody) {
        self.before = (body.travel_wheels, body.travel_reference);
    }

    /// Counts the window that ended at `body.until_ns`, once; `rims` are the powered wheels' rim speeds over it, m/s.
    pub(crate) fn count(&mut self, body: &WindowBody, rims: impl Iterator<Item = f64>) {
        self.after = (body.travel_wheels, body.travel_reference);
        if body.until_ns == self.until_ns || body.until_ns.is_none() {
            return;
        }
        self.until_ns = body.until_ns;
        // beside rims at rest the noise of a reference would look like a skid, or like a turn
        let (sum, count) = rims.fold((0.0, 0.0), |(sum, count), rim| {
            (sum + rim.abs(), count + 1.0)
        });
        if sum <= count * self.low_speed {
            return;
        }
        if let Some(slip) = body.along {
            self.along.add(slip.value());
        }
        if let (Some(wheels), Some(gyro)) = (body.wheels_yaw_rate, body.yaw_rate) {
            let residual = (wheels.value - gyro.value).abs() * self.window;
            self.yaw.add(residual);
        }
    }

    /// The robot along its track. Without an absolute reference a slip common to all wheels is not observable: then there
    /// is no way but the wheels', and no slip.
    pub(crate) fn along(&self, is_observable: bool) -> AlongSummary {
        let travel_wheels = self.after.0 - self.before.0;
        if !is_observable {
            return AlongSummary {
                travel_wheels,
                ..AlongSummary::default()
            };
        }
        let travel_reference = self.after.1 - self.before.1;
        AlongSummary {
            slip: Spread::from(&self.along),
            overall: overall(travel_reference, travel_wheels),
            travel_wheels,
            travel_reference: Some(travel_reference),
        }
    }

    pub(crate) fn yaw(&self) -> Option<YawSummary> {
        (self.yaw.count() > 0).then(|| YawSummary {
            residual: Spread::from(&self.yaw),
            window: self.window,
        })
    }
}
