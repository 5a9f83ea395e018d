//! Distances, slip along the track and turns, step by step.

use grouser_doctor::{KnownStep, Pairing};
use grouser_real::Real;
use grouser_slip::SensorSettings;
use grouser_slip::motion::{HEADING, X, Y, common_motion};

use crate::checks::WayCheck;
use crate::quantiles::{Quantiles, SIGMAS_90};
use crate::summary::{AlongSummary, Spread, YawSummary, overall};

/// Slip along the track and turns are compared over this time, s.
const WINDOW_S: f64 = 0.5;

/// Time, s, distances by wheels and estimate, m, and the turn by the wheels beyond that by the gyro, rad.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    seconds: f64,
    wheels: f64,
    estimate: f64,
    turn: f64,
}

/// The counters of one span of a log.
#[derive(Clone, Debug)]
pub(crate) struct Ways {
    low_speed: f64,
    along: Quantiles,
    yaw: Quantiles,
    pairing: Pairing,
    check: WayCheck,
    /// Distances in the direction in which the wheels ran, by them and by the estimate, m.
    travel: [f64; 2],
    /// The place at the end of the last step, m.
    place: Option<[f64; 2]>,
    window: Window,
    scratch: Vec<f64>,
}

impl Ways {
    pub(crate) fn new(settings: &SensorSettings, wheels: usize) -> Self {
        Self {
            low_speed: settings.low_speed,
            along: Quantiles::new(-1.0, 1.0),
            yaw: Quantiles::new(0.0, 1.0),
            pairing: Pairing::new(settings.reference),
            check: WayCheck::default(),
            travel: [0.0; 2],
            place: None,
            window: Window::default(),
            scratch: vec![0.0; wheels],
        }
    }

    /// Takes a step, which counts where it `is_wanted`.
    pub(crate) fn take(&mut self, known: &KnownStep<'_>, is_wanted: bool) {
        let passed = self.pairing.take(known);
        let moved = self.moved(known);
        if !is_wanted {
            return;
        }
        if let Some(passed) = passed
            && let Some(reference) = passed.distance_by_reference()
        {
            self.check.wheels += passed.length;
            self.check.filter += passed.estimate;
            self.check.reference += reference;
        }
        if !known.step.has_wheels() {
            self.window = Window::default();
            return;
        }
        let distance = known.common.distance.abs();
        self.travel[0] += distance;
        self.travel[1] += moved;
        let wheels = &known.step.wheels;
        let by_wheels = common_motion(wheels, None, 1.0, 0.0, &mut self.scratch);
        let turn = by_wheels.and_then(|of| of.turn).zip(known.step.turn);
        let window = &mut self.window;
        window.seconds += known.step.dt;
        window.wheels += distance;
        window.estimate += known.distance();
        window.turn += turn.map_or(f64::NAN, |(by_wheels, by_gyro)| by_wheels - by_gyro);
        if window.seconds >= WINDOW_S {
            self.end_window();
        }
    }

    /// Counts what passed in the window. Beside wheels at rest the noise of a reference would look like a skid, or like a turn.
    fn end_window(&mut self) {
        let window = std::mem::take(&mut self.window);
        if window.wheels <= self.low_speed * window.seconds {
            return;
        }
        if let Some(slip) = overall(window.estimate, window.wheels) {
            self.along.add(slip);
        }
        if window.turn.is_finite() {
            self.yaw.add(window.turn.abs());
        }
    }

    /// How far the place moved in the direction in which the wheels ran, m: what a late reading corrects of the place it corrects
    /// of the distance.
    fn moved(&mut self, known: &KnownStep<'_>) -> f64 {
        let place = [X, Y].map(|i| known.belief.mean[i]);
        let last = self.place.replace(place);
        let Some(last) = last.filter(|_| known.step.frame.is_none()) else {
            return known.distance();
        };
        let heading = known.belief.mean[HEADING] - 0.5 * known.turn();
        let (sin, cos) = Real::sin_cos(heading + known.common.direction);
        let moved = cos * (place[0] - last[0]) + sin * (place[1] - last[1]);
        moved * 1.0_f64.copysign(known.common.distance)
    }

    /// Distances in the direction in which the wheels ran so far, by them and by the estimate, m.
    pub(crate) const fn travel(&self) -> [f64; 2] {
        self.travel
    }

    /// The distances of wheels, estimate and reference between the readings of the reference.
    pub(crate) const fn check(&self) -> WayCheck {
        self.check
    }

    /// The robot along its track: of a whole log by the estimate, whose distance has this `variance` (m²), online by the reference
    /// alone, between its readings. Without an absolute reference a slip common to all wheels is not observable: then there is no
    /// distance but the wheels', and no slip.
    pub(crate) fn along(&self, is_observable: bool, variance: Option<f64>) -> AlongSummary {
        let [wheels, estimate] = match variance {
            None if is_observable => [self.check.wheels, self.check.reference],
            _ => self.travel,
        };
        if !is_observable {
            return AlongSummary {
                travel_wheels: wheels,
                ..AlongSummary::default()
            };
        }
        let half = variance.map(|variance| SIGMAS_90 * Real::sqrt(variance));
        let slip = |distance: f64| overall(distance, wheels);
        AlongSummary {
            slip: Spread::from(&self.along),
            overall: slip(estimate),
            overall_90: half.and_then(|half| {
                let [low, high] = [slip(estimate + half), slip((estimate - half).max(0.0))];
                Some([low?, high?])
            }),
            travel_wheels: wheels,
            travel_reference: Some(estimate),
            travel_reference_90: half.map(|half| [estimate - half, estimate + half]),
        }
    }

    pub(crate) fn yaw(&self) -> Option<YawSummary> {
        (self.yaw.count() > 0).then(|| YawSummary {
            residual: Spread::from(&self.yaw),
            window: WINDOW_S,
        })
    }
}
