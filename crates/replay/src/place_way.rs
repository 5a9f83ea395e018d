//! The robot's way by places that have no heading.

use std::collections::VecDeque;

use grouser_real::Real;
use grouser_slip::window::WindowSettings;

use crate::checks::WayCheck;
use crate::moment::seconds;

/// A span is at least this long by the rims, m, and this many standard deviations of a place: then noise adds less than
/// 2 % even to the way of a robot that is stuck.
const MIN_SPAN_M: f64 = 1.0;
const SPAN_SIGMAS: f64 = 40.0;
/// A span that ends early counts where the way between its places is this many standard deviations long.
const CLEAR_SIGMAS: f64 = 5.0;
/// The whole way is known where its standard deviation is at most this share of the rims' way: less than half of the difference of slips
/// that is a doubt.
const MAX_NOISE_SHARE: f64 = 0.02;
/// Over a longer time between two places neither the course nor the way is known, s.
const MAX_OUTAGE_S: f64 = 5.0;

/// The path of the powered wheels, in a frame that the robot's start fixes: where the robot would be without slip.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RimPath {
    /// Along the axes of the frame, m.
    pub(crate) x: f64,
    pub(crate) y: f64,
    /// Along the wheels' own direction, m.
    pub(crate) way: f64,
}

/// The way along the direction in which the rims run, by places alone.
///
/// Rims and gyro show in which direction u the rims ran from one place to the next, but for a rotation that all steps of a
/// span share. Each step Δp between places is turned back by it, and the steps of a span add up:
///
/// ```text
/// way² = |Σ Δp ū|² − V,   V = 2 σ² (2 + Σ |Δu|²)
/// ```
///
/// V is what the noise σ of places adds to the square. The sign is that of the filter's way, because places without a heading do not
/// show whether a robot drives backwards.
/// Assumes: the rotation hardly changes in a span.
#[derive(Clone, Debug)]
pub(crate) struct PlaceWay {
    min_span: f64,
    variance: f64,
    low_speed: f64,
    latency_ns: i64,
    has_places: bool,
    /// Places that are later than the rims.
    places: VecDeque<(i64, [f64; 2])>,
    moved: Option<Moved>,
    last: Option<([f64; 2], Moved)>,
    span: Span,
    total: Total,
}

/// The sums of all spans that are over.
#[derive(Clone, Copy, Debug, Default)]
struct Total {
    ways: WayCheck,
    /// Variance of the way by places, m².
    variance: f64,
}

/// The ways up to a time since the start, m.
#[derive(Clone, Copy, Debug)]
struct Moved {
    time_ns: i64,
    path: RimPath,
    wheels: f64,
    filter: f64,
}

impl Moved {
    /// Between two times.
    fn at(&self, next: &Self, time_ns: i64) -> Self {
        let share = seconds(self.time_ns, time_ns) / seconds(self.time_ns, next.time_ns);
        let between = |from: f64, to: f64| from + share * (to - from);
        let mut path = self.path;
        path.x = between(path.x, next.path.x);
        path.y = between(path.y, next.path.y);
        Self {
            time_ns,
            path,
            wheels: between(self.wheels, next.wheels),
            filter: between(self.filter, next.filter),
        }
    }
}

/// The sums of a span.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    /// Σ Δp ū, m, and the last u.
    sum: [f64; 2],
    direction: Option<[f64; 2]>,
    /// Σ |Δu|².
    turned: f64,
    wheels: f64,
    filter: f64,
}

impl PlaceWay {
    /// Of places whose stamps are late by `latency_s`.
    #[allow(
        clippy::cast_possible_truncation,
        reason = "a latency is at most a second"
    )]
    pub(crate) fn new(settings: &WindowSettings, latency_s: f64) -> Self {
        let sigma = settings.position_sigma;
        Self {
            min_span: MIN_SPAN_M.max(SPAN_SIGMAS * sigma),
            variance: sigma * sigma,
            low_speed: settings.low_speed,
            latency_ns: (latency_s * 1e9).round() as i64,
            has_places: false,
            places: VecDeque::new(),
            moved: None,
            last: None,
            span: Span::default(),
            total: Total::default(),
        }
    }

    /// Takes a place, m, with its stamp.
    pub(crate) fn take(&mut self, stamp_ns: i64, place: [f64; 2]) {
        if place.iter().all(|part| part.is_finite()) {
            self.has_places = true;
            let taken_ns = stamp_ns.saturating_sub(self.latency_ns);
            self.places.push_back((taken_ns, place));
        }
    }

    /// Takes the path of the rims up to a time, where it is known, and the filter's way since the last step along the direction of
    /// the rims, m.
    pub(crate) fn step(&mut self, time_ns: i64, path: Option<RimPath>, filter: f64) {
        let Some(path) = path else {
            self.places.clear();
            (self.moved, self.last) = (None, None);
            self.end_span();
            return;
        };
        let before = self.moved;
        let now = Moved {
            time_ns,
            path,
            wheels: before.map_or(0.0, |last| last.wheels + (path.way - last.path.way).abs()),
            filter: before.map_or(0.0, |last| last.filter + filter),
        };
        self.moved = Some(now);
        while let Some((taken_ns, place)) = self.places.pop_front_if(|next| next.0 <= time_ns) {
            if let Some(before) = before.filter(|before| taken_ns > before.time_ns) {
                self.reach(place, before.at(&now, taken_ns));
            }
        }
    }

    /// Were there places?
    pub(crate) const fn has_places(&self) -> bool {
        self.has_places
    }

    /// The ways so far, of 0 m where places do not show them; `None` without places.
    pub(crate) fn ways(&self) -> Option<WayCheck> {
        if !self.has_places {
            return None;
        }
        let mut total = self.total;
        self.span.add_to(&mut total, self.min_span, self.variance);
        let is_shown = total.variance.sqrt() <= MAX_NOISE_SHARE * total.ways.wheels;
        Some(if is_shown {
            total.ways
        } else {
            WayCheck::default()
        })
    }

    fn reach(&mut self, place: [f64; 2], now: Moved) {
        let Some((last_place, last)) = self.last.replace((place, now)) else {
            return;
        };
        let passed = seconds(last.time_ns, now.time_ns);
        if passed > MAX_OUTAGE_S {
            self.end_span();
            return;
        }
        let rims = [now.path.x - last.path.x, now.path.y - last.path.y];
        let size = Real::hypot(rims[0], rims[1]);
        let span = &mut self.span;
        if size > self.low_speed * passed {
            let direction = rims.map(|part| part / size);
            if let Some(before) = span.direction.replace(direction) {
                span.turned += Real::powi(direction[0] - before[0], 2)
                    + Real::powi(direction[1] - before[1], 2);
            }
        }
        let Some([u_x, u_y]) = span.direction else {
            return;
        };
        let [x, y] = [place[0] - last_place[0], place[1] - last_place[1]];
        span.sum[0] += x * u_x + y * u_y;
        span.sum[1] += y * u_x - x * u_y;
        span.wheels += now.wheels - last.wheels;
        span.filter += now.filter - last.filter;
        if span.wheels >= self.min_span {
            self.end_span();
        }
    }

    fn end_span(&mut self) {
        let span = std::mem::take(&mut self.span);
        span.add_to(&mut self.total, self.min_span, self.variance);
    }
}

impl Span {
    /// Adds the span's ways where its places show them.
    fn add_to(&self, total: &mut Total, min_span: f64, variance: f64) {
        let noise = 2.0 * variance * (2.0 + self.turned);
        let square = Real::powi(self.sum[0], 2) + Real::powi(self.sum[1], 2);
        if self.wheels < min_span && !(square > CLEAR_SIGMAS * CLEAR_SIGMAS * noise) {
            return;
        }
        let way = (square - noise).max(0.0).sqrt();
        // half of it is along the way
        total.variance += 0.5 * noise;
        let ways = &mut total.ways;
        ways.wheels += self.wheels;
        ways.filter += self.filter;
        ways.reference += if self.filter < 0.0 { -way } else { way };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks::{Doubt, doubts};

    const SIGMA_M: f64 = 0.02;

    /// Ways of rims that run at 0.5 m/s for 100 s in a frame that is turned by 2 rad and by ten more in that time, along
    /// `direction` (rad) in it; the robot follows by the share `follows`, the filter believes the share `believes`, and places come
    /// at 5 Hz with errors that no generator draws.
    fn ways(direction: impl Fn(f64) -> f64, follows: f64, believes: f64) -> WayCheck {
        let settings = WindowSettings {
            position_sigma: SIGMA_M,
            ..WindowSettings::default()
        };
        let mut by_places = PlaceWay::new(&settings, 0.0);
        let (mut path, mut place) = (RimPath::default(), [0.0, 0.0]);
        for row in 0..5000_i64 {
            let (time_ns, time_s) = (row * 20_000_000, row as f64 * 0.02);
            let rims = 0.01;
            let (sin, cos) = direction(time_s).sin_cos();
            (path.x, path.y, path.way) =
                (path.x + rims * cos, path.y + rims * sin, path.way + rims);
            let (sin, cos) = (direction(time_s) + 2.0 + 1e-3 * time_s).sin_cos();
            place = [
                place[0] + follows * rims * cos,
                place[1] + follows * rims * sin,
            ];
            if row % 10 == 0 {
                let error =
                    |phase: f64| SIGMA_M * f64::sqrt(2.0) * (row as f64 * row as f64 * phase).sin();
                by_places.take(time_ns, [place[0] + error(0.7), place[1] + error(0.31)]);
            }
            by_places.step(time_ns, Some(path), believes * rims);
        }
        by_places.ways().unwrap()
    }

    #[test]
    fn places_show_the_way_in_bends_in_every_direction_and_of_a_robot_that_is_stuck() {
        let bend = |time_s: f64| 0.3 * time_s;
        // forwards, to the left, back and to the right
        let omni = |time_s: f64| (time_s / 7.0).floor() * 0.5 * std::f64::consts::PI;
        for follows in [1.1, 0.7, 0.02] {
            for found in [ways(bend, follows, follows), ways(omni, follows, follows)] {
                println!("{follows}: {found:?}");
                assert!(found.wheels > 48.0, "{found:?}");
                assert!(
                    (found.reference / found.wheels - follows).abs() < 0.02,
                    "{found:?}"
                );
                assert!(doubts(None, &found).is_empty());
            }
        }
        // against the rims, as the filter knows
        let back = ways(bend, -0.4, -0.4);
        assert!(
            (back.reference / back.wheels + 0.4).abs() < 0.02,
            "{back:?}"
        );
    }

    #[test]
    fn a_filter_that_places_contradict_is_a_doubt() {
        for (follows, believes) in [(0.7, 0.9), (1.0, 0.8), (0.05, 0.9)] {
            let found = ways(|time_s| 0.3 * time_s, follows, believes);
            let doubts = doubts(None, &found);
            assert!(
                matches!(doubts[..], [Doubt::WaysDiffer { .. }]),
                "{doubts:?}"
            );
        }
    }

    #[test]
    fn few_places_or_noisy_ones_show_no_way() {
        // no span of 100 m, one whose places are 3.5 % of it apart by noise, and many
        for (sigma, is_shown) in [(2.5, false), (0.7, false), (0.02, true)] {
            let settings = WindowSettings {
                position_sigma: sigma,
                ..WindowSettings::default()
            };
            let mut by_places = PlaceWay::new(&settings, 0.0);
            assert_eq!(by_places.ways(), None);
            for second in 0..60_i64 {
                let way = second as f64 * 0.5;
                let path = RimPath {
                    x: way,
                    way,
                    ..RimPath::default()
                };
                let place = [0.4 * way + sigma * (way * way).sin(), 0.0];
                by_places.take(second * 1_000_000_000, place);
                by_places.step(second * 1_000_000_000, Some(path), 0.2);
            }
            let found = by_places.ways().unwrap().slip_by_reference();
            assert_eq!(found.is_some(), is_shown, "{sigma}: {found:?}");
        }
    }
}
