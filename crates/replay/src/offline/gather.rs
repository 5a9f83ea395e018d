//! Samples as steps of time.

use grouser_files::robot::{RobotFile, WheelSensor};
use grouser_real::Real;
use grouser_slip::motion::{Reading, Step, Value, WheelStep};
use grouser_slip::{Measurement, Reference, Sample, Steering, Wheel, WheelRole};

use super::track::Track;
use crate::choice::Inputs;

/// A step is at least this long, s: the slip of wheels does not change within it.
const MIN_STEP_S: f64 = 0.05;
/// A sensor is not measured over a time of this many periods without a reading, if that is longer than the robot's dropout time.
const GAP_PERIODS: f64 = 3.0;
/// Noise of a wheel's rate where the robot file states none, rad/s.
const RATE_SIGMA: f64 = 0.01;
/// Resolution of an angle without a number of ticks, m.
const ANGLE_STEP_M: f64 = 1e-4;
/// Headings of wheels that differ by more than this make an omnidirectional robot: the sine.
const PARALLEL_SINE: f64 = 0.02;
/// Sigma of a free wheel's skid on ground that nobody knows, besides that of the robot file: published laws of soft soil differ by a
/// few hundredths in it.
const SKID_SIGMA: f64 = 0.03;
/// What no ground robot reaches: speed (m/s), turn rate (rad/s), acceleration (m/s²), place (m). Beyond, a reading is none.
const MAX_SPEED: f64 = 100.0;
const MAX_TURN_RATE: f64 = 100.0;
const MAX_ACCELERATION: f64 = 1000.0;
const MAX_PLACE: f64 = 1e8;

/// The samples of a log since a time.
#[derive(Debug)]
pub(super) struct Gathered {
    wheels: Vec<Wheel>,
    sensor: WheelSensor,
    reference: Reference,
    latency: f64,
    /// Mean and sigma of a free wheel's skid 1 − v/u.
    skid: [f64; 2],
    dropout: f64,
    is_omni: bool,
    begin_ns: Option<i64>,
    tracks: Vec<Track>,
    counts: Vec<Option<u64>>,
    steered: Vec<Track>,
    turn: Track,
    force: [Track; 2],
    readings: Vec<(f64, Value)>,
    /// The sum of the displacements; `None` where places come as well, of which the displacements are made.
    summed: Option<[f64; 3]>,
    /// From when on which wheels contradict the others, bit by bit.
    contradicting: Vec<(f64, u64)>,
}

impl Gathered {
    pub(super) fn new(file: &RobotFile, inputs: &Inputs) -> Self {
        let wheels = file.robot.wheels().to_vec();
        let free = file.filter.free_slip.by_wheel();
        let first = wheels[0].heading.rad();
        let differs = |of: &Wheel| Real::sin(of.heading.rad() - first).abs() > PARALLEL_SINE;
        Self {
            sensor: inputs.wheel_sensor,
            reference: inputs.reference,
            latency: file.filter.reference_latency,
            skid: [free.mean, Real::hypot(free.sigma, SKID_SIGMA)],
            dropout: file.filter.dropout,
            is_omni: wheels.iter().any(differs),
            begin_ns: None,
            tracks: wheels.iter().map(|_| Track::default()).collect(),
            counts: vec![None; wheels.len()],
            steered: wheels.iter().map(|_| Track::default()).collect(),
            turn: Track::default(),
            force: [Track::default(), Track::default()],
            readings: Vec::new(),
            summed: Some([0.0; 3]),
            contradicting: Vec::new(),
            wheels,
        }
    }

    /// Sigma of the scale of all speeds: where a free wheel alone shows the speed over ground, that of its skid.
    pub(super) fn scale_sigma(&self) -> f64 {
        if self.reference == Reference::FreeWheel {
            self.skid[1]
        } else {
            0.0
        }
    }

    /// Seconds since the first sample.
    pub(super) fn seconds(&self, time_ns: i64) -> f64 {
        time_ns.saturating_sub(self.begin_ns.unwrap_or(time_ns)) as f64 * 1e-9
    }

    pub(super) fn take(&mut self, sample: &Sample) {
        self.begin_ns.get_or_insert(sample.time_ns);
        let time = self.seconds(sample.time_ns);
        let read = time - self.latency;
        let within = |value: f64, limit: f64| value.abs() <= limit;
        match sample.measurement {
            Measurement::WheelCount { wheel, raw } if self.sensor == WheelSensor::Count => {
                let of = &self.wheels[wheel];
                let last = self.counts[wheel].replace(raw).unwrap_or(raw);
                let ticks = of.encoder.counter.step(last, raw) as f64;
                let distance =
                    self.tracks[wheel].last() + ticks * of.travel_per_tick().unwrap_or(0.0);
                self.tracks[wheel].push(time, distance);
            }
            Measurement::WheelAngle { wheel, angle } if self.sensor == WheelSensor::Angle => {
                let distance = angle * self.wheels[wheel].travel_per_radian();
                if within(distance, MAX_PLACE) {
                    self.tracks[wheel].push(time, distance);
                }
            }
            Measurement::WheelRate { wheel, rate } if self.sensor == WheelSensor::Rate => {
                let speed = rate * self.wheels[wheel].travel_per_radian();
                if within(speed, MAX_SPEED) {
                    self.tracks[wheel].integrate(time, speed, true);
                }
            }
            Measurement::YawRate { rate } if within(rate, MAX_TURN_RATE) => {
                self.turn.integrate(time, rate, false);
            }
            Measurement::Acceleration { forward, left }
                if within(forward, MAX_ACCELERATION) && within(left, MAX_ACCELERATION) =>
            {
                for (track, force) in self.force.iter_mut().zip([forward, left]) {
                    track.integrate(time, force, false);
                }
            }
            Measurement::SteeringAngle { wheel, angle } if angle.is_finite() => {
                self.steered[wheel].push(time, angle);
            }
            Measurement::Pose { x, y, yaw } if self.reference == Reference::Pose => {
                self.place(read, [x, y]);
                if yaw.is_finite() {
                    self.readings.push((read, Value::Heading(yaw)));
                }
            }
            Measurement::Position { x, y } if self.reference == Reference::Displacement => {
                if self.summed.take().is_some() {
                    self.readings.clear();
                }
                self.place(read, [x, y]);
            }
            Measurement::Speed { forward, .. }
                if self.reference == Reference::Speed && within(forward, MAX_SPEED) =>
            {
                self.readings.push((read, Value::Speed(forward)));
            }
            Measurement::Displacement {
                forward,
                left,
                turn,
            } if self.reference == Reference::Displacement => {
                let turn = turn.unwrap_or(0.0);
                let is_usable =
                    within(forward, MAX_PLACE) && within(left, MAX_PLACE) && turn.is_finite();
                if let Some(summed) = self.summed.as_mut().filter(|_| is_usable) {
                    let (sin, cos) = Real::sin_cos(summed[2] + 0.5 * turn);
                    summed[0] += cos * forward - sin * left;
                    summed[1] += sin * forward + cos * left;
                    summed[2] += turn;
                    let [x, y, yaw] = *summed;
                    self.place(read, [x, y]);
                    self.readings.push((read, Value::Heading(yaw)));
                }
            }
            _ => {}
        }
    }

    fn place(&mut self, read: f64, place: [f64; 2]) {
        if place.iter().all(|part| part.abs() <= MAX_PLACE) {
            self.readings.push((read, Value::Place(place)));
        }
    }

    /// Which wheels contradict the others from a time on, bit by bit.
    pub(super) fn contradict(&mut self, time: f64, wheels: u64) {
        let last = self.contradicting.last().map_or(0, |of| of.1);
        if wheels != last {
            self.contradicting.push((time, wheels));
        }
    }

    /// Steps between two times.
    pub(super) fn steps(&self, from: f64, to: f64) -> Vec<Step> {
        let spans = (self.tracks.iter())
            .map(|track| track.spans(from))
            .filter(|(count, _)| *count > 2);
        let period = spans
            .map(|(count, span)| span / (count - 1) as f64)
            .fold(0.0, f64::max);
        let dt = period.max(MIN_STEP_S);
        let max_gap = self.dropout.max(GAP_PERIODS * period);
        let mut steps = Vec::new();
        let mut force_before = None;
        let mut next = self.readings.partition_point(|of| of.0 <= from);
        let mut time = from + dt;
        while time <= to {
            let since = |track: &Track| track.change(time - dt, time, max_gap);
            // from the middle of the last step to the middle of this one
            let force = (since(&self.force[0]).zip(since(&self.force[1])))
                .map(|(forward, left)| [forward / dt, left / dt]);
            let last = core::mem::replace(&mut force_before, force);
            let force = force.map(|now| {
                let last = last.unwrap_or(now);
                [0.5 * (now[0] + last[0]), 0.5 * (now[1] + last[1])]
            });
            let mut readings = Vec::new();
            while let Some(&(read, value)) = self.readings.get(next).filter(|of| of.0 <= time) {
                readings.push(Reading {
                    value,
                    since: time - read,
                    scale: 1.0,
                });
                next += 1;
            }
            let contradicting = &self.contradicting[..];
            let now = contradicting.partition_point(|of| of.0 <= time);
            let left_out = now.checked_sub(1).map_or(0, |last| contradicting[last].1);
            let wheels = (0..self.wheels.len()).map(|wheel| {
                let is_usable =
                    |distance: &f64| left_out >> wheel & 1 == 0 && distance.abs() <= MAX_SPEED * dt;
                let distance = since(&self.tracks[wheel]).filter(is_usable);
                self.wheel_step(wheel, (time, dt, period), distance)
            });
            steps.push(Step {
                time,
                dt,
                wheels: wheels.collect(),
                turn: since(&self.turn),
                force,
                readings,
            });
            time += dt;
        }
        steps
    }

    fn wheel_step(
        &self,
        index: usize,
        (time, dt, period): (f64, f64, f64),
        distance: Option<f64>,
    ) -> WheelStep {
        let wheel = &self.wheels[index];
        let angle_at = |time: f64| self.steered[index].at(time).unwrap_or(0.0);
        let mut steering = Steering::new(wheel);
        steering.turn(angle_at(time - 0.5 * dt));
        let swing = steering.swing() * (angle_at(time) - angle_at(time - dt));
        let variance = if self.sensor == WheelSensor::Rate {
            let step = wheel.travel_per_radian();
            let quantum = wheel.encoder.rate_step;
            let sigma = quantum * quantum / 12.0 + RATE_SIGMA * RATE_SIGMA;
            sigma * step * step * dt * period
        } else {
            // two whole ticks, each uniform
            let tick = wheel.travel_per_tick().unwrap_or(ANGLE_STEP_M);
            tick * tick / 6.0
        };
        let is_free = wheel.role == WheelRole::Free;
        let [skid, sigma] = if is_free { self.skid } else { [0.0; 2] };
        let of_skid = sigma * distance.unwrap_or(0.0);
        WheelStep {
            distance: distance.map(|distance| distance * (1.0 - skid)),
            variance: variance + of_skid * of_skid,
            row: steering.along(),
            across: steering.across(),
            swing,
            is_free,
            is_omni: self.is_omni,
        }
    }

    /// What lies before a time is no longer needed.
    pub(super) fn forget(&mut self, time: f64) {
        let own = (self.tracks.iter_mut())
            .chain(&mut self.force)
            .chain(&mut self.steered);
        own.chain([&mut self.turn])
            .for_each(|track| track.forget(time));
        self.readings.retain(|of| of.0 > time);
        let first = self.contradicting.partition_point(|of| of.0 < time);
        self.contradicting.drain(..first.saturating_sub(1));
    }
}
