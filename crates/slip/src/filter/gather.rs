//! Samples as steps of time: how far each wheel, the gyro and the accelerometer went over each step.

use alloc::{boxed::Box, vec::Vec};

use grouser_real::Real;

use super::checks::Checks;
use super::gyro::GyroMonitor;
use super::rates::Rates;
use super::settings::{FilterSettings, SlipPrior};
use crate::fault::Fault;
use crate::history::{History, nanoseconds, seconds_between};
use crate::motion::{MIN_SPEED, Step, WheelStep, turn_by_parallel_wheels};
use crate::period::GAP_PERIODS;
use crate::robot::{Robot, Wheel, WheelRole};
use crate::sample::{Measurement, Sample};
use crate::wheel_steering::Steering;
use crate::wheel_track::{TrackSettings, WheelTrack};

/// A step is at least this long, s: the slip of wheels does not change within it.
pub(super) const MIN_STEP_S: f64 = 0.05;
/// Maximum step length, s: one step spans a silence of all sensors.
const MAX_STEP_S: f64 = 60.0;
/// Silence of all sensors beyond which a single step spans the gap, s, where it is also more than [`GAP_PERIODS`] steps. A prior: a
/// robot stops and starts again within a second.
const SILENCE_S: f64 = 1.0;
/// The step length changes when it differs from the slowest wheel's period by more than this share: stamps scatter by less.
const PERIOD_SHARE: f64 = 0.05;
/// A step lasts until this share of its distance is noise of the encoders, but no longer than the time below: the slip, a ratio of
/// distances, is biased by the square of that share. Derived: 0.0025, a tenth of the noise of the best camera's slip.
const NOISE_SHARE: f64 = 0.05;
/// Longest step for coarse encoders, s. A prior: the slip of soft ground changes within half a second.
const MAX_COARSE_STEP_S: f64 = 0.3;
/// Noise of a wheel's rate, rad/s, and resolution of an angle without ticks, m, where the robot's description states none.
const RATE_SIGMA: f64 = 0.01;
const ANGLE_STEP_M: f64 = 1e-4;
/// Headings of wheels that differ by more than this make an omnidirectional robot: the sine.
const PARALLEL_SINE: f64 = 0.02;
/// What no ground robot reaches: turn rate (rad/s), acceleration (m/s²), rate (rad/s) and speed (m/s) of a carrier.
const MAX_TURN_RATE: f64 = 100.0;
const MAX_ACCELERATION: f64 = 1000.0;
const MAX_CARRIER: f64 = 20.0;
const MAX_TORQUE: f64 = 1e6;
/// Specific force beyond which an accelerometer is saturated or measures an impact on its case, m/s²: ten g.
const MAX_FORCE: f64 = 100.0;
/// Readings that are kept of a sensor, and over which time, s: two steps at the usual rates.
const KEPT: usize = 40;
const KEPT_S: f64 = 0.5;
/// And over this number of steps. Derived: a step closes up to one of its lengths after its end, and the next is open.
const KEPT_STEPS: f64 = 3.0;

/// One wheel's sensors.
#[derive(Clone, Debug)]
struct WheelInput {
    track: WheelTrack,
    steering: Steering,
    /// Rotation of its carrier, rad, and displacement of its centre by the carrier, forwards and upwards, m.
    carrier: Rates<3>,
    radius: f64,
    /// Travel for a radian of the sensor's shaft, m.
    per_radian: f64,
    is_free: bool,
    is_rate: bool,
    has_ticks: bool,
}

/// Samples since the last step.
#[derive(Clone, Debug)]
pub(super) struct Gather {
    wheels: Box<[WheelInput]>,
    turn: Rates<1>,
    force: Rates<2>,
    pub(super) gyro: GyroMonitor,
    pub(super) checks: Checks,
    force_before: Option<[f64; 2]>,
    is_omni: bool,
    dropout: f64,
    skid: SlipPrior,
    /// Where the open step begins, its length, and the period of the slowest wheel.
    from_ns: Option<i64>,
    dt: f64,
    period: f64,
    /// The longest that the open step may become.
    longest: f64,
    origin_ns: i64,
    step: Step,
}

impl WheelInput {
    fn new(index: usize, wheel: &Wheel, settings: &FilterSettings) -> Self {
        let track = TrackSettings {
            window: MIN_STEP_S,
            max_speed: settings.max_speed,
            dropout: settings.dropout.max(0.5 * SILENCE_S),
        };
        let history = History::new(KEPT, nanoseconds(KEPT_S));
        Self {
            track: WheelTrack::new(index, wheel, track, history),
            steering: Steering::new(wheel),
            carrier: Rates::new(KEPT / 2, nanoseconds(KEPT_S)),
            radius: wheel.radius,
            per_radian: wheel.travel_per_radian(),
            is_free: wheel.role == WheelRole::Free,
            is_rate: false,
            has_ticks: wheel.travel_per_tick().is_some(),
        }
    }

    fn step(&mut self, from_ns: i64, to_ns: i64, skid: SlipPrior, is_omni: bool) -> WheelStep {
        let dt = seconds_between(from_ns, to_ns);
        let [rocked, ahead, up] = self.carrier.between(from_ns, to_ns).unwrap_or([0.0; 3]);
        let swing = self.steering.swung() + ahead * Real::cos(self.steering.heading);
        self.steering.mark();
        let speed = self.track.speed(from_ns, to_ns);
        let floor = if self.is_rate {
            let sigma = RATE_SIGMA * self.per_radian;
            sigma * sigma * dt * self.track.period().max(1e-3)
        } else if self.has_ticks {
            0.0
        } else {
            ANGLE_STEP_M * ANGLE_STEP_M / 6.0
        };
        let rolled = speed.map(|of| of.value * dt + self.radius * rocked);
        // a wheel that moves up or down relative to the robot rolls along a slope, or is lifted off: the difference is its own sigma
        let along = |rolled: f64| Real::sqrt((rolled * rolled - up * up).max(0.0));
        let distance = rolled.map(|rolled| along(rolled).copysign(rolled));
        let lifted = rolled.map_or(0.0, |rolled| rolled.abs() - along(rolled));
        let variance = speed.map_or(0.0, |of| of.variance * dt * dt) + floor + lifted * lifted;
        let distance = distance.filter(|of| of.abs() <= 1e3);
        let [skid, sigma] = if self.is_free {
            [skid.mean, skid.sigma]
        } else {
            [0.0; 2]
        };
        let of_skid = sigma * distance.unwrap_or(0.0);
        WheelStep {
            distance: distance.map(|distance| distance * (1.0 - skid)),
            variance: (variance + of_skid * of_skid).max(1e-14),
            row: self.steering.along(),
            across: self.steering.across(),
            swing,
            is_free: self.is_free,
            is_omni,
        }
    }
}

impl Gather {
    pub(super) fn new(robot: &Robot, settings: &FilterSettings) -> Self {
        let wheels = robot.wheels();
        let first = wheels[0].heading.rad();
        let differs = |of: &Wheel| Real::sin(of.heading.rad() - first).abs() > PARALLEL_SINE;
        let inputs = wheels.iter().enumerate();
        let inputs = inputs.map(|(index, wheel)| WheelInput::new(index, wheel, settings));
        Self {
            wheels: inputs.collect(),
            turn: Rates::new(KEPT, nanoseconds(KEPT_S)),
            force: Rates::new(KEPT, nanoseconds(KEPT_S)),
            gyro: GyroMonitor::default(),
            checks: Checks::new(robot),
            force_before: None,
            is_omni: wheels.iter().any(differs),
            dropout: settings.dropout,
            skid: settings.skid(),
            from_ns: None,
            dt: MIN_STEP_S,
            period: MIN_STEP_S,
            longest: MIN_STEP_S,
            origin_ns: 0,
            step: Step {
                wheels: Vec::with_capacity(wheels.len()),
                ..Step::default()
            },
        }
    }

    /// Takes a reading of a wheel, the gyro, the accelerometer, a carrier or the steering.
    pub(super) fn take(&mut self, sample: &Sample) -> Result<(), Fault> {
        let time_ns = sample.time_ns;
        let wheels = self.wheels.len();
        let gap = self.dropout.max(SILENCE_S);
        let wheel = match sample.measurement.wheel() {
            Some(index) => self
                .wheels
                .get_mut(index)
                .map(Some)
                .ok_or(Fault::UnknownWheel { index, wheels })?,
            None => None,
        };
        let range = Fault::check_range;
        match (sample.measurement, wheel) {
            (Measurement::YawRate { rate }, _) => {
                range("yaw rate", rate, -MAX_TURN_RATE, MAX_TURN_RATE, "rad/s")?;
                self.turn.take(time_ns, [rate], gap)?;
            }
            (Measurement::Acceleration { forward, left }, _) => {
                for force in [forward, left] {
                    range(
                        "acceleration",
                        force,
                        -MAX_ACCELERATION,
                        MAX_ACCELERATION,
                        "m/s²",
                    )?;
                }
                if forward.abs().max(left.abs()) <= MAX_FORCE {
                    self.force.take(time_ns, [forward, left], gap)?;
                } else {
                    self.force.interrupt();
                }
            }
            (
                Measurement::Carrier {
                    turn, forward, up, ..
                },
                Some(wheel),
            ) => {
                for (field, value, unit) in [
                    ("carrier turn", turn, "rad/s"),
                    ("carrier forward", forward, "m/s"),
                    ("carrier up", up, "m/s"),
                ] {
                    range(field, value, -MAX_CARRIER, MAX_CARRIER, unit)?;
                }
                wheel.carrier.take(time_ns, [turn, forward, up], gap)?;
            }
            (Measurement::SteeringAngle { angle, .. }, Some(wheel)) => {
                range("steering angle", angle, -7.0, 7.0, "rad")?;
                wheel.steering.turn(angle);
            }
            (measurement, Some(wheel)) if measurement.is_rotation() => {
                wheel.track.take(time_ns, &measurement)?;
                wheel.is_rate = matches!(measurement, Measurement::WheelRate { .. });
                if let (Some(travel), Some(index)) = (wheel.track.counted(), measurement.wheel()) {
                    self.checks.count(index, time_ns, travel);
                }
            }
            (Measurement::WheelTorque { wheel, torque }, _) => {
                range("torque", torque, -MAX_TORQUE, MAX_TORQUE, "N m")?;
                self.checks.torque(wheel, torque);
            }
            _ => {}
        }
        if self.from_ns.is_none() && sample.measurement.is_rotation() {
            self.from_ns = Some(time_ns);
            self.origin_ns = time_ns;
        }
        Ok(())
    }

    /// Steers a wheel; false where there is no such wheel.
    pub(super) fn steer(&mut self, wheel: usize, angle: f64) -> bool {
        let found = self.wheels.get_mut(wheel);
        found.map(|wheel| wheel.steering.turn(angle)).is_some()
    }

    /// The clock was set: forgets all readings.
    pub(super) fn restart_clock(&mut self) {
        for wheel in &mut self.wheels {
            wheel.track.restart_clock();
            wheel.carrier.interrupt();
        }
        self.checks.restart_clock();
        self.turn.interrupt();
        self.force.interrupt();
        self.force_before = None;
        self.from_ns = None;
    }

    /// The step that is complete at `now_ns`, and its end; `None` while a sensor may still tell of it.
    pub(super) fn close(&mut self, now_ns: i64, is_confirmed: bool) -> Option<(&Step, i64)> {
        let from_ns = self.from_ns?;
        let open = seconds_between(from_ns, now_ns);
        if open < self.dt {
            return None;
        }
        let mut dt = self.dt;
        let mut to_ns = from_ns.saturating_add(nanoseconds(dt));
        let is_complete = |known: Option<i64>, limit: f64| {
            known.is_none_or(|known| known >= to_ns || seconds_between(known, now_ns) > limit)
        };
        let wheels = self.wheels.iter().all(|wheel| {
            is_complete(
                wheel.track.known_until(now_ns),
                wheel.track.silence_limit(self.dropout),
            )
        });
        let others = [self.turn.newest_ns(), self.force.newest_ns()];
        if !wheels
            || !others
                .into_iter()
                .all(|known| is_complete(known, self.dropout))
        {
            return None;
        }
        let share = self.noise_share(from_ns, to_ns);
        if open > SILENCE_S.max(GAP_PERIODS * dt) {
            to_ns = now_ns;
            dt = open.min(MAX_STEP_S);
        } else if share > NOISE_SHARE && dt + self.period <= self.longest {
            self.dt += self.period;
            return self.close(now_ns, is_confirmed);
        }
        let (skid, is_omni) = (self.skid, self.is_omni);
        self.step.wheels.clear();
        let wheels = self.wheels.iter_mut();
        (self.step.wheels).extend(wheels.map(|wheel| wheel.step(from_ns, to_ns, skid, is_omni)));
        // from the middle of the last step to the middle of this one
        let force = self
            .force
            .between(from_ns, to_ns)
            .map(|of| of.map(|sum| sum / dt));
        let last = core::mem::replace(&mut self.force_before, force);
        self.step.force = force.map(|now| {
            let last = last.unwrap_or(now);
            [0.5 * (now[0] + last[0]), 0.5 * (now[1] + last[1])]
        });
        self.step.turn = self.turn.between(from_ns, to_ns).map(|[turned]| turned);
        self.judge_sensors(dt, is_confirmed);
        self.step.time = seconds_between(self.origin_ns, to_ns);
        self.step.dt = dt;
        self.from_ns = Some(to_ns);
        self.follow_periods(now_ns, share);
        Some((&self.step, to_ns))
    }

    /// Leaves out sensors that are stuck or contradict the others.
    fn judge_sensors(&mut self, dt: f64, is_confirmed: bool) {
        let step = &mut self.step;
        let wheels_turn = step
            .wheels
            .iter()
            .any(|of| of.distance.is_some_and(|of| of.abs() > MIN_SPEED * dt));
        if let (Some(turn), Some(by_wheels)) = (step.turn, turn_by_parallel_wheels(&step.wheels)) {
            let by_wheels = if is_confirmed { turn } else { by_wheels };
            self.gyro.compare(turn / dt, by_wheels / dt, dt);
        }
        if self.gyro.is_wrong() || wheels_turn && self.turn.is_stuck() {
            step.turn = None;
        }
        // messages without an accelerometer hold zeros
        if wheels_turn && self.force.is_constant() {
            step.force = None;
        }
    }

    /// The next step is as long as the period of the slowest wheel, or several of them where the encoders are coarse: how many this
    /// step would have needed. `share` is its noise.
    fn follow_periods(&mut self, now_ns: i64, share: f64) {
        let dropout = self.dropout;
        let alive = (self.wheels.iter().map(|wheel| &wheel.track)).filter(|track| {
            let newest = track.newest_time();
            newest.is_some_and(|last| seconds_between(last, now_ns) <= track.silence_limit(dropout))
        });
        let slowest = alive.map(WheelTrack::period).fold(MIN_STEP_S, f64::max);
        if (slowest - self.period).abs() > PERIOD_SHARE * self.period {
            self.period = slowest;
            // what the other sensors measured is kept until the slowest wheel is read
            let kept_ns = nanoseconds(KEPT_S.max(KEPT_STEPS * slowest));
            self.turn.keep(kept_ns);
            self.force.keep(kept_ns);
            for wheel in &mut self.wheels {
                wheel.carrier.keep(kept_ns);
            }
        }
        let needed = (self.dt * share / NOISE_SHARE).min(MAX_COARSE_STEP_S);
        // wheels that are stationary need nothing
        self.longest = if share.is_finite() { needed } else { 0.0 };
        self.dt = self.period;
    }

    /// The part of the powered wheels' mean distance that is noise of their encoders, one sigma; infinite where none has turned.
    fn noise_share(&self, from_ns: i64, to_ns: i64) -> f64 {
        let powered = self.wheels.iter().filter(|wheel| !wheel.is_free);
        let [speed, variance] = powered
            .filter_map(|wheel| wheel.track.speed(from_ns, to_ns))
            .fold([0.0; 2], |sum, of| {
                [sum[0] + of.value.abs(), sum[1] + of.variance]
            });
        Real::sqrt(variance) / speed
    }

    /// For how long a wheel has been silent, and from which silence on it counts as dropped out, s; `None` before its first reading.
    pub(super) fn silence(&self, wheel: usize, now_ns: i64) -> Option<(f64, f64)> {
        let wheel = &self.wheels[wheel];
        let known = wheel.track.known_until(now_ns)?;
        Some((
            seconds_between(known, now_ns),
            wheel.track.silence_limit(self.dropout),
        ))
    }

    /// The prior of a free wheel's skid by its own speed.
    pub(super) const fn skid(&self) -> SlipPrior {
        self.skid
    }
}
