//! Ways, slip along the track and yaw rates over windows, whatever finds the wheels' slips.

use grouser_slip::window::WindowBody;

use crate::checks::WayCheck;
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
    /// Ways by the wheels and by the reference up to now, m, backwards counted as negative.
    last: (f64, f64),
    /// The same in the span, in the direction in which the wheels run: forwards and back add up.
    travel: (f64, f64),
}

impl Ways {
    pub(crate) fn new(low_speed: f64, window: f64) -> Self {
        Self {
            low_speed,
            window,
            along: Quantiles::new(-1.0, 1.0),
            yaw: Quantiles::new(0.0, 1.0),
            until_ns: None,
            last: (0.0, 0.0),
            travel: (0.0, 0.0),
        }
    }

    /// The span has not begun.
    pub(crate) const fn wait(&mut self, travel: (f64, f64)) {
        self.last = travel;
    }

    /// Counts the ways up to now by the wheels and by the reference, m.
    pub(crate) fn travel(&mut self, now: (f64, f64)) {
        let (wheels, reference) = along_rims((now.0 - self.last.0, now.1 - self.last.1));
        self.last = now;
        self.travel.0 += wheels;
        self.travel.1 += reference;
    }

    /// Counts the window that ended at `body.until_ns`, once; `rims` are the powered wheels' rim speeds over it, m/s.
    pub(crate) fn count(&mut self, body: &WindowBody, rims: impl Iterator<Item = f64>) {
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
    /// is no way but the wheels', and no slip. Ways `by_places` are those of places without a heading.
    pub(crate) fn along(&self, is_observable: bool, by_places: Option<&WayCheck>) -> AlongSummary {
        let only_wheels = AlongSummary {
            travel_wheels: self.travel.0,
            ..AlongSummary::default()
        };
        let (travel_wheels, travel_reference) = match by_places {
            _ if !is_observable => return only_wheels,
            Some(ways) => (ways.wheels, ways.reference),
            None => self.travel,
        };
        let slip = Spread::from(&self.along);
        if by_places.is_some() && !(travel_wheels > 0.0) {
            return AlongSummary {
                slip,
                ..only_wheels
            };
        }
        AlongSummary {
            slip,
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

/// A short way by the wheels, and one beside it, in the direction in which the wheels ran, m.
pub(crate) const fn along_rims((wheels, beside): (f64, f64)) -> (f64, f64) {
    if wheels < 0.0 {
        (-wheels, -beside)
    } else {
        (wheels, beside)
    }
}
