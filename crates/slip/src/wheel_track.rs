//! From one wheel's sensor to the travel of its rim.

use core::f64::consts::TAU;

use crate::clock::{Clock, Step};
use crate::counter::CounterWidth;
use crate::fault::Fault;
use crate::history::{History, seconds_between, whole};
use crate::period::{GAP_PERIODS, Period};
use crate::robot::Wheel;
use crate::sample::Measurement;
use crate::speed::{Measured, MixedSpeed, PeriodSpeed};

/// Fewer pulses than this in a window: the period law speaks, which is newer.
const FEW_PULSES: f64 = 4.0;
/// A gap of more than this many windows restarts a sensor, where it is also more than `GAP_PERIODS` of its periods.
const GAP_WINDOWS: f64 = 2.0;
/// A time between two readings that is longer than the gap belongs to the period where it is at most this multiple of the one before:
/// a pause of the recording is not.
const PERIOD_SCATTER: f64 = 1.5;

/// How the readings of one wheel are used.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrackSettings {
    /// The longest window over which a speed is taken, s.
    pub(crate) window: f64,
    /// A faster rim is a jump of the sensor, m/s.
    pub(crate) max_speed: f64,
    /// A sensor silent for longer has dropped out, s.
    pub(crate) dropout: f64,
}

impl TrackSettings {
    /// A longer gap restarts a sensor, s.
    pub(crate) fn gap(&self) -> f64 {
        GAP_WINDOWS * self.window.max(self.dropout)
    }
}

/// The running rim travel of one wheel.
#[derive(Clone, Debug)]
pub(crate) struct WheelTrack {
    index: usize,
    per_radian: f64,
    per_tick: Option<f64>,
    rate_step: f64,
    ticks_per_turn: f64,
    max_speed: f64,
    gap: f64,
    clock: Clock,
    period: Period,
    last_ns: Option<i64>,
    last_passed: f64,
    width: CounterWidth,
    /// Last accepted reading and its time.
    last: Option<(i64, Reading)>,
    /// A reading that jumped and its time: if the next one follows it, the sensor was reset.
    suspect: Option<(i64, Reading)>,
    /// Rim travel (m) and the variance that rates add to it (m²), summed, at the times of the readings.
    travel: History<2>,
    totals: [f64; 2],
    /// Mean rim speed of the last step, m/s, to foresee a counter's wraps.
    speed: f64,
    edges: Option<Edges>,
    /// Variance of the travel between two readings, m².
    resolution: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Reading {
    Count(u64),
    Angle(f64),
}

#[derive(Clone, Copy, Debug)]
struct Edges {
    period: PeriodSpeed,
    mixed: MixedSpeed,
}

impl WheelTrack {
    /// A wheel at rest, with no `travel` so far.
    pub(crate) fn new(
        index: usize,
        wheel: &Wheel,
        settings: TrackSettings,
        travel: History<2>,
    ) -> Self {
        Self {
            index,
            per_radian: wheel.travel_per_radian(),
            per_tick: wheel.travel_per_tick(),
            rate_step: wheel.encoder.rate_step,
            ticks_per_turn: wheel.encoder.ticks_per_turn.unwrap_or(1.0),
            max_speed: settings.max_speed,
            gap: settings.gap(),
            clock: Clock::default(),
            period: Period::default(),
            last_ns: None,
            last_passed: 0.0,
            width: wheel.encoder.counter,
            last: None,
            suspect: None,
            travel,
            totals: [0.0; 2],
            speed: 0.0,
            edges: None,
            resolution: 0.0,
        }
    }

    /// The time of its last reading.
    pub(crate) fn newest_time(&self) -> Option<i64> {
        self.travel.newest().map(|(time_ns, _)| time_ns)
    }

    /// The latest time up to which its speed is known, if it is now `now_ns`: an encoder that reports
    /// edges says something by its silence as well.
    pub(crate) fn known_until(&self, now_ns: i64) -> Option<i64> {
        if self.edges.is_some() {
            Some(now_ns)
        } else {
            self.newest_time()
        }
    }

    /// How far its circumference has run in all, m, where it counts whole ticks at the times of its readings.
    pub(crate) fn counted(&self) -> Option<f64> {
        (self.edges.is_none() && self.resolution > 0.0).then_some(self.totals[0])
    }

    /// The mean time between its readings, s; 0 while it is not known.
    pub(crate) fn period(&self) -> f64 {
        self.period.mean()
    }

    /// Silent for longer than this it has dropped out, s.
    pub(crate) fn silence_limit(&self, dropout: f64) -> f64 {
        dropout.max(GAP_PERIODS * self.period())
    }

    /// A longer time between two readings restarts it, s.
    fn gap(&self) -> f64 {
        self.silence_limit(self.gap)
    }

    /// Takes a reading of this wheel's sensor.
    pub(crate) fn take(&mut self, time_ns: i64, measurement: &Measurement) -> Result<(), Fault> {
        self.take_measured(time_ns, measurement)?;
        // the edges of an encoder come as the wheel turns
        if let (Some(last_ns), None) = (self.last_ns.replace(time_ns), &self.edges) {
            let passed = seconds_between(last_ns, time_ns);
            if passed <= self.gap().max(PERIOD_SCATTER * self.last_passed) {
                self.period.push(passed.max(0.0));
            }
            self.last_passed = passed;
        }
        Ok(())
    }

    fn take_measured(&mut self, time_ns: i64, measurement: &Measurement) -> Result<(), Fault> {
        match *measurement {
            Measurement::WheelCount { raw, .. } => {
                let per_tick = self.per_tick.ok_or(Fault::NoTicks { wheel: self.index })?;
                self.resolution = per_tick * per_tick / 6.0;
                self.take_reading(time_ns, Reading::Count(raw))
            }
            Measurement::WheelAngle { angle, .. } => {
                Fault::check_range("angle", angle, -1e9, 1e9, "rad")?;
                self.resolution = self.per_tick.map_or(0.0, |tick| tick * tick / 6.0);
                self.take_reading(time_ns, Reading::Angle(angle))
            }
            Measurement::WheelRate { rate, .. } => self.take_rate(time_ns, rate),
            Measurement::WheelEdge { forward, .. } => self.take_edge(time_ns, forward),
            _ => Ok(()),
        }
    }

    /// The clock was set: the next reading begins anew.
    pub(crate) fn restart_clock(&mut self) {
        self.clock = Clock::default();
        self.last_ns = None;
        self.travel.clear();
        self.last = None;
        self.suspect = None;
        self.edges = None;
    }

    fn start(&mut self, time_ns: i64, reading: Option<Reading>) {
        self.travel.clear();
        self.travel.push(time_ns, self.totals);
        self.speed = 0.0;
        self.suspect = None;
        self.last = reading.map(|reading| (time_ns, reading));
    }

    fn take_reading(&mut self, time_ns: i64, reading: Reading) -> Result<(), Fault> {
        let step = self.clock.accept(time_ns, self.gap())?;
        let (Step::After(_), Some((last_ns, last))) = (step, self.last) else {
            self.start(time_ns, Some(reading));
            return Ok(());
        };
        let elapsed = seconds_between(last_ns, time_ns);
        let travel = self.travel_between(last, reading, elapsed);
        if travel.abs() <= self.max_speed * elapsed {
            self.last = Some((time_ns, reading));
            self.suspect = None;
            self.add(time_ns, travel, 0.0, elapsed);
            return Ok(());
        }
        // Faster than the robot can be: an outlier, unless the next reading follows this one.
        if let Some((suspect_ns, suspect)) = self.suspect {
            let since = seconds_between(suspect_ns, time_ns);
            if self.travel_between(suspect, reading, since).abs() <= self.max_speed * since {
                self.start(time_ns, Some(reading));
                return Ok(());
            }
        }
        self.suspect = Some((time_ns, reading));
        Err(Fault::Jump {
            field: "wheel speed",
            value: travel / elapsed,
            limit: self.max_speed,
            unit: "m/s",
        })
    }

    /// How many ticks the counter should have gone, where it may have gone round unseen; else 0, which
    /// means the shortest way.
    fn expected(&self, per_tick: f64, elapsed: f64) -> i64 {
        let half_range = 0.5 * grouser_real::Real::powi(2.0_f64, self.width.bits().cast_signed());
        if self.max_speed * elapsed >= half_range * per_tick.abs() {
            whole(self.speed * elapsed / per_tick)
        } else {
            0
        }
    }

    fn travel_between(&self, from: Reading, to: Reading, elapsed: f64) -> f64 {
        match (from, to, self.per_tick) {
            (Reading::Count(from), Reading::Count(to), Some(tick)) => {
                let expected = self.expected(tick, elapsed);
                self.width.step_near(from, to, expected) as f64 * tick
            }
            (Reading::Angle(from), Reading::Angle(to), _) => (to - from) * self.per_radian,
            // Another kind of reading than before: nothing links the two.
            _ => f64::INFINITY,
        }
    }

    fn take_rate(&mut self, time_ns: i64, rate: f64) -> Result<(), Fault> {
        Fault::check_finite("rate", rate, "rad/s")?;
        let speed = rate * self.per_radian;
        if !(speed.abs() <= self.max_speed) {
            return Err(Fault::Jump {
                field: "wheel speed",
                value: speed,
                limit: self.max_speed,
                unit: "m/s",
            });
        }
        match self.clock.accept(time_ns, self.gap())? {
            Step::Start => self.start(time_ns, None),
            Step::After(elapsed) => {
                let error = self.rate_step * self.per_radian * elapsed;
                self.add(time_ns, speed * elapsed, error * error / 12.0, elapsed);
            }
        }
        Ok(())
    }

    fn take_edge(&mut self, time_ns: i64, forward: bool) -> Result<(), Fault> {
        let per_tick = self.per_tick.ok_or(Fault::NoTicks { wheel: self.index })?;
        let step = self.clock.accept(time_ns, self.gap())?;
        let mut edges = match (self.edges, step) {
            (Some(edges), Step::After(_)) => edges,
            _ => Edges {
                period: PeriodSpeed::new(self.ticks_per_turn, 1e-9)?,
                mixed: MixedSpeed::new(self.ticks_per_turn, 1e-9)?,
            },
        };
        edges.period.edge(time_ns, forward)?;
        self.edges = Some(edges);
        match step {
            Step::Start => self.start(time_ns, None),
            Step::After(elapsed) => {
                let travel = if forward { per_tick } else { -per_tick };
                self.add(time_ns, travel, 0.0, elapsed);
            }
        }
        Ok(())
    }

    fn add(&mut self, time_ns: i64, travel: f64, variance: f64, elapsed: f64) {
        self.totals[0] += travel;
        self.totals[1] += variance;
        self.speed = travel / elapsed;
        self.travel.push(time_ns, self.totals);
    }

    /// The rim's mean speed from `from_ns` to `to_ns`, m/s; `None` where that is not covered.
    pub(crate) fn speed(&self, from_ns: i64, to_ns: i64) -> Option<Measured> {
        if let (Some(edges), Some(tick)) = (&self.edges, self.per_tick) {
            return self.speed_of_edges(edges, tick, from_ns, to_ns);
        }
        let window = seconds_between(from_ns, to_ns);
        let [travel, variance] = self.travel.between(from_ns, to_ns)?;
        Some(Measured {
            value: travel / window,
            variance: (variance + self.resolution) / (window * window),
        })
    }

    /// Many pulses in the window: the mixed law between its first and last edge. Few, or none for half
    /// a window: the period law, which also knows of the pulse that has not come.
    fn speed_of_edges(
        &self,
        edges: &Edges,
        tick: f64,
        from_ns: i64,
        to_ns: i64,
    ) -> Option<Measured> {
        let last_edge = self.travel.newest().map(|(time_ns, _)| time_ns)?;
        let end = last_edge.min(to_ns);
        let [travel, _] = self.travel.between(from_ns.min(end), end)?;
        let silent = seconds_between(last_edge, to_ns);
        let window = seconds_between(from_ns, to_ns);
        let turning = if travel.abs() < FEW_PULSES * tick.abs() || silent > 0.5 * window {
            edges.period.speed_at(to_ns.max(last_edge))?
        } else {
            let pulses = whole(travel / tick);
            let law = edges.mixed.speed(pulses, from_ns, end).ok()?;
            // `between` shares out the pulses that the window cuts, so the count need not be whole.
            Measured {
                value: law.value * travel / (tick * pulses as f64),
                variance: law.variance,
            }
        };
        let per_angle = tick * self.ticks_per_turn / TAU;
        Some(Measured {
            value: turning.value * per_angle,
            variance: turning.variance * per_angle * per_angle,
        })
    }
}

#[cfg(test)]
mod tests;
