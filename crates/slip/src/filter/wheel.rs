//! One wheel in the filter: its readings, windows and state.

use grouser_real::Real;

use crate::history::seconds_between;
use crate::robot::{Robot, WheelRole};
use crate::speed::Measured;
use crate::state::Health;
use crate::wheel_estimate::WheelEstimate;
use crate::wheel_track::{TrackSettings, WheelTrack};

use super::carrier::Carrier;
use super::free_wheel::Rolling;
use super::pulses::Pulses;
use super::radius::Radius;
use super::settings::FilterSettings;
use super::watch::Watch;

/// Fewer ticks than this do not end a window before its time.
const FEW_TICKS: f64 = 4.0;
/// A window ends after this long however few ticks it has, in windows.
pub(super) const LONGEST: f64 = 4.0;
/// Share of a new window in the smoothed rim speed.
const SMOOTHING: f64 = 0.3;

/// What is kept of a wheel.
#[derive(Clone, Debug)]
pub(super) struct Tracked {
    pub(super) row: [f64; 3],
    /// Where it stands (m), and the direction in which it drives when it does not steer (rad).
    place: [f64; 2],
    heading: f64,
    pub(super) carrier: Carrier,
    pub(super) free: bool,
    pub(super) track: WheelTrack,
    pub(super) tick: f64,
    /// Where the open window began.
    from_ns: Option<i64>,
    /// Which of the two remainders is that of the open window's beginning; `None` where it is not known.
    pub(super) remainder: Option<bool>,
    /// The last whole window's rim speed and end.
    pub(super) rim: Option<(Measured, i64)>,
    /// Its rim speed smoothed over a few windows, the last one left out; and that one.
    usual: f64,
    last_rim: f64,
    /// The rim has not moved since.
    pub(super) still_since_ns: Option<i64>,
    /// It has turned against the robot's way since.
    pub(super) against_since_ns: Option<i64>,
    /// Its last reading was far from what was expected.
    pub(super) was_off: bool,
    pub(super) torque: Option<(i64, f64)>,
    pub(super) watch: Watch,
    /// Mean of its residuals, in sigma.
    pub(super) pull: f64,
    pub(super) rolling: Rolling,
    pub(super) pulses: Pulses,
    pub(super) radius: Radius,
    /// How many of its readings wait for earlier samples.
    pub(super) waiting: u16,
    /// Silent for longer than this, it says nothing, s.
    dropout: f64,
    /// How much more its slip wanders than was told, as a share of that variance.
    pub(super) unrest: f64,
    pub(super) estimate: WheelEstimate,
}

impl Tracked {
    /// The wheels of `robot`.
    pub(super) fn all(robot: &Robot, settings: &FilterSettings) -> impl Iterator<Item = Self> {
        let windows = TrackSettings {
            window: LONGEST * settings.wheel_window,
            max_speed: settings.max_speed,
            dropout: settings.dropout,
            history: 64,
        };
        robot
            .wheels()
            .iter()
            .enumerate()
            .map(move |(index, wheel)| Self {
                row: wheel.speed_row(),
                place: [wheel.x, wheel.y],
                heading: wheel.heading.rad(),
                carrier: Carrier::new(wheel.radius, settings.dropout),
                free: wheel.role == WheelRole::Free,
                track: WheelTrack::new(index, wheel, windows),
                tick: wheel.travel_per_tick().map_or(0.0, f64::abs),
                from_ns: None,
                remainder: None,
                rim: None,
                usual: 0.0,
                last_rim: 0.0,
                still_since_ns: None,
                against_since_ns: None,
                was_off: false,
                torque: None,
                watch: Watch::default(),
                pull: 0.0,
                rolling: Rolling::default(),
                pulses: Pulses::new(
                    wheel.travel_per_tick().map_or(1.0, f64::abs),
                    wheel.encoder.ticks_per_turn.unwrap_or(0.0),
                ),
                radius: Radius::default(),
                waiting: 0,
                dropout: settings.dropout,
                unrest: 1.0,
                estimate: WheelEstimate::NOTHING,
            })
    }

    /// It is steered by `angle` (rad) now.
    pub(super) fn steer(&mut self, angle: f64) {
        let (sin, cos) = Real::sin_cos(self.heading + angle);
        self.row = [cos, sin, sin * self.place[0] - cos * self.place[1]];
    }

    /// The row of its centre's speed to the left of its heading, n · (v + Ω × p), as the row of its speed along it.
    pub(super) fn across(&self) -> [f64; 3] {
        let [cos, sin, _] = self.row;
        [-sin, cos, cos * self.place[0] + sin * self.place[1]]
    }

    /// Ends the window at the reading of `now_ns` if it is long enough; gives its rim speed and its beginning.
    pub(super) fn window(&mut self, now_ns: i64, window: f64) -> Option<(Measured, i64)> {
        if self.from_ns.is_none() {
            self.carrier.mark();
        }
        let from = *self.from_ns.get_or_insert(now_ns);
        let age = seconds_between(from, now_ns);
        if age < 0.0 {
            self.from_ns = Some(now_ns);
            self.carrier.mark();
            self.remainder = None;
            return None;
        }
        if age < window {
            return None;
        }
        let Some(rim) = self.track.speed(from, now_ns) else {
            // a sensor that began anew, or fell silent
            self.from_ns = Some(now_ns);
            self.carrier.mark();
            self.remainder = None;
            return None;
        };
        let few = (rim.value * age).abs() < FEW_TICKS * self.tick;
        if few && age < LONGEST * window {
            return None;
        }
        self.from_ns = Some(now_ns);
        let stands = rim.value == 0.0;
        let turned = if stands {
            0.0
        } else {
            self.carrier.rolled() / age
        };
        self.carrier.mark();
        let rim = Measured {
            value: rim.value + turned,
            ..rim
        };
        self.rim = Some((rim, now_ns));
        if stands {
            self.still_since_ns.get_or_insert(from);
        } else {
            self.still_since_ns = None;
            self.rolling.runs(rim.value);
        }
        Some((rim, from))
    }

    /// The rim speed as it was before the last window, m/s: the last one shares a tick with the present one.
    pub(super) const fn usual_rim(&self) -> f64 {
        self.usual
    }

    /// One more window's rim speed, m/s.
    pub(super) fn remember(&mut self, rim: f64) {
        self.usual += SMOOTHING * (self.last_rim - self.usual);
        self.last_rim = rim;
    }

    /// Seconds since its last reading.
    pub(super) fn silence(&self, now_ns: i64) -> Option<f64> {
        self.track
            .newest_time()
            .map(|last| seconds_between(last, now_ns))
    }

    /// Has a window just ended, or is nothing said of it so far?
    pub(super) fn has_news(&self, now_ns: i64) -> bool {
        let ended = self.rim.is_some_and(|(_, to)| to == now_ns);
        let said = !matches!(
            self.estimate.health,
            Health::Uninitialised | Health::Invalid(_)
        );
        ended || !said
    }

    /// Did its rim move in the last window?
    pub(super) fn turns(&self) -> bool {
        self.still_since_ns.is_none() && self.rim.is_some()
    }

    /// Seconds since its rim last moved; 0 where it moves, and where it is silent: that is not standing.
    pub(super) fn stillness(&self, now_ns: i64) -> f64 {
        let heard = self
            .silence(now_ns)
            .is_some_and(|silence| silence <= self.dropout);
        match self.still_since_ns {
            Some(since) if heard => seconds_between(since, now_ns).max(0.0),
            _ => 0.0,
        }
    }

    /// Time begins anew: what was counted in it is forgotten, what was learnt is not.
    pub(super) fn restart_clock(&mut self) {
        self.track.restart_clock();
        self.carrier.restart_clock();
        self.pulses.restart();
        self.from_ns = None;
        self.remainder = None;
        self.rim = None;
        self.still_since_ns = None;
        self.against_since_ns = None;
        self.torque = None;
        self.pull = 0.0;
        self.waiting = 0;
        self.rolling = Rolling::default();
        self.watch = Watch::default();
        self.estimate = WheelEstimate::NOTHING;
    }
}
