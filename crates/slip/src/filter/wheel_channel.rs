//! One wheel in the filter: its readings, its windows, and what is learnt of it.

use grouser_real::Real;

use crate::history::{nanoseconds, seconds_between};
use crate::robot::{Robot, Wheel, WheelRole};
use crate::speed::Measured;
use crate::state::Health;
use crate::wheel_estimate::WheelEstimate;
use crate::wheel_steering::Steering;
use crate::wheel_track::{MarkedTravel, TrackSettings, WheelTrack};

use super::carrier::Carrier;
use super::monitor::Monitor;
use super::motion_model::{COMMON_SLIP, own_slip};
use super::pulse_check::PulseCheck;
use super::radius_check::RadiusCheck;
use super::repeated_rate::RepeatedRate;
use super::rolling_history::RollingHistory;
use super::settings::FilterSettings;
use super::stamp_scatter::StampScatter;

/// A window is extended until it has this many ticks: fewer say little of the speed.
const MIN_WINDOW_TICKS: f64 = 4.0;
/// And until its way is this multiple of the standard deviation of what stamps move: 4 ticks are 14 times that of a tick's remainder. As
/// much here lets noisy rates, which are no ticks, lag behind (`intervals_hold_in_runs_that_they_were_not_calibrated_on`).
const MIN_WINDOW_DEVIATIONS: f64 = 10.4;
/// A window ends after this many times its length, however few ticks it has.
pub(super) const MAX_WINDOW_FACTOR: f64 = 4.0;
/// A high rim speed is remembered for this long, s.
const TOP_RIM_MEMORY_S: f64 = 60.0;
/// A rim speed has changed where two windows are apart by more than this many sigma.
const CHANGE_SIGMA: f64 = 3.0;
/// Weight of a new window in the smoothed rim speed.
const RIM_SMOOTHING: f64 = 0.3;

/// The state of one wheel beside the numbers in the Kalman filter.
#[derive(Clone, Debug)]
pub(super) struct WheelChannel {
    pub(super) row: [f64; 3],
    pub(super) steering: Steering,
    pub(super) carrier: Carrier,
    pub(super) free: bool,
    pub(super) track: WheelTrack<MarkedTravel>,
    /// Rim travel of one tick, m; 0 without ticks.
    pub(super) tick: f64,
    /// The beginning of the open window.
    from_ns: Option<i64>,
    /// Which of the two tick remainders belongs to the beginning of the open window; `None` where neither does.
    pub(super) remainder: Option<bool>,
    /// The last whole window's rim speed and end.
    pub(super) rim: Option<(Measured, i64)>,
    /// Has that window ended at the present moment, and the state not been updated by it so far?
    pub(super) has_ended: bool,
    /// The time of the reading before the last, or `i64::MIN`.
    pub(super) read_before_ns: i64,
    /// Length of the last whole window, s.
    pub(super) rim_window: f64,
    /// By how much its rim speed changed from the window before to the last, beyond their noise, m/s.
    change: f64,
    /// The rim speed smoothed over the windows before the last, m/s; and that of the last.
    smoothed_rim: f64,
    last_rim: f64,
    /// The highest rim speed of the last minute or so, m/s.
    top_rim: f64,
    /// The time since which the rim has not moved.
    pub(super) still_since_ns: Option<i64>,
    /// The time since which it turns against the robot's travel.
    pub(super) against_since_ns: Option<i64>,
    /// Was its last window beyond the gate?
    pub(super) was_off: bool,
    /// Trust in a free wheel.
    pub(super) monitor: Monitor,
    /// Mean of its innovations, in sigma.
    pub(super) mean_innovation: f64,
    pub(super) rolling: RollingHistory,
    pub(super) pulses: PulseCheck,
    pub(super) radius: RadiusCheck,
    pub(super) repeated: RepeatedRate,
    /// `None` beside a free wheel, whose faults it would hide.
    stamps: Option<StampScatter>,
    dropout: f64,
    /// Variance of its own slip as a multiple of the configured one.
    pub(super) noise_scale: f64,
    pub(super) estimate: WheelEstimate,
}

impl WheelChannel {
    /// The wheels of `robot`.
    pub(super) fn all(robot: &Robot, settings: &FilterSettings) -> impl Iterator<Item = Self> {
        let windows = TrackSettings {
            window: MAX_WINDOW_FACTOR * settings.wheel_window,
            max_speed: settings.max_speed,
            dropout: settings.dropout,
        };
        let is_free = |wheel: &Wheel| wheel.role == WheelRole::Free;
        let has_free = robot.wheels().iter().any(is_free);
        robot
            .wheels()
            .iter()
            .enumerate()
            .map(move |(index, wheel)| Self {
                row: wheel.speed_row(),
                steering: Steering::new(wheel),
                carrier: Carrier::new(wheel.radius, settings.dropout),
                free: is_free(wheel),
                track: WheelTrack::new(index, wheel, windows, MarkedTravel::default()),
                tick: wheel.travel_per_tick().map_or(0.0, f64::abs),
                from_ns: None,
                remainder: None,
                rim: None,
                has_ended: false,
                read_before_ns: i64::MIN,
                rim_window: 0.0,
                change: 0.0,
                smoothed_rim: 0.0,
                last_rim: 0.0,
                top_rim: 0.0,
                still_since_ns: None,
                against_since_ns: None,
                was_off: false,
                monitor: Monitor::default(),
                mean_innovation: 0.0,
                rolling: RollingHistory::default(),
                pulses: PulseCheck::new(
                    wheel.travel_per_tick().map_or(1.0, f64::abs),
                    wheel.encoder.ticks_per_turn.unwrap_or(0.0),
                ),
                radius: RadiusCheck::default(),
                repeated: RepeatedRate::default(),
                stamps: (!has_free).then(StampScatter::default),
                dropout: settings.dropout,
                noise_scale: 1.0,
                estimate: WheelEstimate::NOTHING,
            })
    }

    /// Sets the steering angle, rad; false where it is the last one.
    pub(super) fn steer(&mut self, angle: f64) -> bool {
        let has_changed = self.steering.turn(angle);
        self.row = self.steering.along();
        has_changed
    }

    /// Its slip, as a row of the state: the wheel at `index` shares the common slip unless it is free.
    pub(super) fn slip_row(&self, index: usize) -> [(usize, f64); 2] {
        let common = if self.free { 0.0 } else { 1.0 };
        [(COMMON_SLIP, common), (own_slip(index), 1.0)]
    }

    /// Ends the window at the reading of `now_ns` if it is long enough; returns its rim speed and its beginning.
    pub(super) fn window(&mut self, now_ns: i64, window: f64) -> Option<(Measured, i64)> {
        if self.from_ns.is_none() {
            self.mark();
        }
        let from = *self.from_ns.get_or_insert(now_ns);
        let age = seconds_between(from, now_ns);
        if age < 0.0 {
            self.restart_window(now_ns);
            return None;
        }
        if age < window {
            return None;
        }
        let Some(rim) = self.track.speed(from, now_ns) else {
            // the sensor was reset, or has been silent
            self.restart_window(now_ns);
            return None;
        };
        // what a stamp moves into the window before, or a driver's division of ticks by times, m
        let stamps = self.stamps.map_or(0.0, |stamps| stamps.variance());
        let moved = rim.value.abs() * Real::sqrt(stamps);
        let least = (MIN_WINDOW_TICKS * self.tick).max(MIN_WINDOW_DEVIATIONS * moved);
        let few = (rim.value * age).abs() < least;
        if few && age < MAX_WINDOW_FACTOR * window {
            return None;
        }
        self.from_ns = Some(now_ns);
        let by_edges = self.track.has_edges();
        if let Some(stamps) = self.stamps.as_mut().filter(|_| !by_edges) {
            let is_way = self.track.measures_way();
            stamps.push(rim.value, age, if is_way { self.tick } else { 0.0 });
        }
        let stands = rim.value == 0.0;
        let turned = if stands {
            0.0
        } else {
            (self.carrier.rolled() - self.steering.swung()) / age
        };
        self.mark();
        let rim = Measured {
            value: rim.value + turned,
            ..rim
        };
        self.change = self.rim.map_or(0.0, |(before, until_ns)| {
            let change = rim.value - before.value;
            let noise = CHANGE_SIGMA * Real::sqrt(rim.variance + before.variance);
            let is_next = until_ns == from;
            if is_next && change.abs() > noise {
                change
            } else {
                0.0
            }
        });
        self.rim = Some((rim, now_ns));
        self.rim_window = age;
        self.top_rim -= self.top_rim * (age / TOP_RIM_MEMORY_S).min(1.0);
        self.top_rim = self.top_rim.max(rim.value.abs());
        if stands {
            self.still_since_ns.get_or_insert(from);
        } else {
            self.still_since_ns = None;
            self.rolling.runs(rim.value);
        }
        Some((rim, from))
    }

    /// How much its rim speed changes, as a process noise density, m/s per √s; negative where it becomes slower.
    pub(super) fn pace(&self) -> f64 {
        if self.rim_window > 0.0 {
            self.change / Real::sqrt(self.rim_window)
        } else {
            0.0
        }
    }

    /// By how much the middle of the last whole window lies before `now_ns`, s.
    pub(super) fn rim_lag(&self, now_ns: i64) -> f64 {
        self.rim.map_or(0.0, |(_, to_ns)| {
            seconds_between(to_ns, now_ns).max(0.0) + 0.5 * self.rim_window
        })
    }

    /// The last whole window: beginning and end.
    pub(super) fn rim_span(&self) -> Option<(i64, i64)> {
        self.rim
            .map(|(_, to_ns)| (to_ns.saturating_sub(nanoseconds(self.rim_window)), to_ns))
    }

    /// Begins a window that does not continue the last.
    fn restart_window(&mut self, now_ns: i64) {
        self.from_ns = Some(now_ns);
        self.mark();
        self.remainder = None;
        if let Some(stamps) = &mut self.stamps {
            stamps.interrupt();
        }
    }

    /// The variance of the way that a reading shows, by its tick and its stamp, m².
    pub(super) fn remainder_variance(&self) -> f64 {
        let tick = if self.track.counts() { self.tick } else { 0.0 };
        let speed = self.rim.map_or(0.0, |(rim, _)| rim.value);
        tick * tick / 12.0 + speed * speed * self.stamps.map_or(0.0, |stamps| stamps.variance())
    }

    /// Marks the beginning of a window.
    fn mark(&mut self) {
        self.track.mark();
        self.carrier.mark();
        self.steering.mark();
    }

    /// The smoothed rim speed before the last window, m/s: the last one shares a tick with the present one.
    pub(super) const fn smoothed_rim(&self) -> f64 {
        self.smoothed_rim
    }

    /// The highest rim speed of the last minute or so, m/s.
    pub(super) const fn top_rim(&self) -> f64 {
        self.top_rim
    }

    /// Adds a window's rim speed (m/s) to the smoothed one.
    pub(super) fn smooth(&mut self, rim: f64) {
        self.smoothed_rim += RIM_SMOOTHING * (self.last_rim - self.smoothed_rim);
        self.last_rim = rim;
    }

    /// Seconds since its last reading.
    pub(super) fn silence(&self, now_ns: i64) -> Option<f64> {
        self.track
            .newest_time()
            .map(|last| seconds_between(last, now_ns))
    }

    /// Is it received: has it read within the dropout time?
    pub(super) fn is_received(&self, now_ns: i64, dropout_s: f64) -> bool {
        self.silence(now_ns)
            .is_some_and(|silence| silence <= dropout_s)
    }

    /// Will its next reading show the way since the last one? Beyond the dropout time it has no estimate, and its rim is led on.
    pub(super) fn is_led_on(&self, now_ns: i64) -> bool {
        self.is_received(now_ns, self.track.gap())
    }

    /// Has a window just ended, or does it have no estimate so far?
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

    /// Seconds since its rim last moved; 0 where it moves, and where it is silent: silence is not standing.
    pub(super) fn stillness(&self, now_ns: i64) -> f64 {
        match self.still_since_ns {
            Some(since) if self.is_received(now_ns, self.dropout) => {
                seconds_between(since, now_ns).max(0.0)
            }
            _ => 0.0,
        }
    }

    /// The clock was set: what was counted is forgotten, what was learnt is not.
    pub(super) fn restart_clock(&mut self) {
        self.track.restart_clock();
        self.carrier.restart_clock();
        self.pulses.restart_clock();
        self.from_ns = None;
        self.remainder = None;
        self.rim = None;
        self.has_ended = false;
        self.read_before_ns = i64::MIN;
        self.still_since_ns = None;
        self.against_since_ns = None;
        self.mean_innovation = 0.0;
        self.rolling = RollingHistory::default();
        self.monitor = Monitor::default();
        self.estimate = WheelEstimate::NOTHING;
    }
}

#[cfg(test)]
mod tests;
