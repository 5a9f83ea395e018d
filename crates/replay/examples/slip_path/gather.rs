//! Samples as steps of time.

use grouser_files::robot::{RobotFile, WheelSensor};
use grouser_replay::Inputs;
use grouser_slip::motion::{Reading, Step, Value, WheelStep};
use grouser_slip::{Measurement, Reference, Sample, Wheel, WheelRole};
use grouser_terra::Angle;

/// A step is at least this long, s: the slip of wheels does not change within it.
const MIN_STEP_S: f64 = 0.05;
/// Noise of a wheel's rate where the robot file states none, rad/s.
const RATE_SIGMA: f64 = 0.01;
/// Resolution of an angle without a number of ticks, m.
const ANGLE_STEP_M: f64 = 1e-4;
/// Headings of wheels that differ by more than this make an omnidirectional robot: the sine.
const PARALLEL_SINE: f64 = 0.02;

/// A quantity over time, between whose points is interpolated.
#[derive(Default)]
struct Track {
    points: Vec<(f64, f64)>,
    /// Its last rate, where it is the integral of one.
    rate: f64,
}

impl Track {
    fn last(&self) -> f64 {
        self.points.last().map_or(0.0, |point| point.1)
    }

    fn push(&mut self, time: f64, value: f64) {
        self.points.push((time, value));
    }

    /// Adds the integral of a rate, which changes linearly or holds since the reading before.
    fn integrate(&mut self, time: f64, rate: f64, holds: bool) {
        let (before, sum) = self.points.last().copied().unwrap_or((time, 0.0));
        let mean = if holds || self.points.is_empty() {
            rate
        } else {
            0.5 * (self.rate + rate)
        };
        self.points.push((time, sum + mean * (time - before)));
        self.rate = rate;
    }

    fn at(&self, time: f64) -> f64 {
        let next = self
            .points
            .partition_point(|point| point.0 < time)
            .clamp(1, self.points.len() - 1);
        let (a, b) = (self.points[next - 1], self.points[next]);
        if b.0 > a.0 {
            a.1 + (b.1 - a.1) * (time - a.0) / (b.0 - a.0)
        } else {
            a.1
        }
    }

    fn is_measured(&self) -> bool {
        self.points.len() > 2
    }
}

/// All samples of a log.
pub(crate) struct Gathered<'a> {
    wheels: &'a [Wheel],
    sensor: WheelSensor,
    reference: Reference,
    latency: f64,
    begin_ns: Option<i64>,
    tracks: Vec<Track>,
    counts: Vec<Option<u64>>,
    steered: Vec<Vec<(f64, f64)>>,
    turn: Track,
    force: [Track; 2],
    readings: Vec<(f64, Value)>,
    summed: [f64; 3],
}

impl<'a> Gathered<'a> {
    pub(crate) fn new(file: &'a RobotFile, inputs: &Inputs) -> Self {
        let wheels = file.robot.wheels();
        Self {
            wheels,
            sensor: inputs.wheel_sensor,
            reference: inputs.reference,
            latency: file.filter.reference_latency,
            begin_ns: None,
            tracks: wheels.iter().map(|_| Track::default()).collect(),
            counts: vec![None; wheels.len()],
            steered: vec![Vec::new(); wheels.len()],
            turn: Track::default(),
            force: [Track::default(), Track::default()],
            readings: Vec::new(),
            summed: [0.0; 3],
        }
    }

    pub(crate) fn take(&mut self, sample: &Sample) {
        let begin = *self.begin_ns.get_or_insert(sample.time_ns);
        let time = sample.time_ns.saturating_sub(begin) as f64 * 1e-9;
        let read = time - self.latency;
        match sample.measurement {
            Measurement::WheelCount { wheel, raw } if self.sensor == WheelSensor::Count => {
                let of = &self.wheels[wheel];
                let last = self.counts[wheel].replace(raw).unwrap_or(raw);
                let ticks = of.encoder.counter.step(last, raw) as f64;
                let distance =
                    self.tracks[wheel].last() + ticks * of.travel_per_tick().unwrap_or(0.0);
                self.tracks[wheel].push(time, distance);
            }
            Measurement::WheelAngle { wheel, angle }
                if self.sensor == WheelSensor::Angle && angle.is_finite() =>
            {
                self.tracks[wheel].push(time, angle * self.wheels[wheel].travel_per_radian());
            }
            Measurement::WheelRate { wheel, rate }
                if self.sensor == WheelSensor::Rate && rate.is_finite() =>
            {
                self.tracks[wheel].integrate(
                    time,
                    rate * self.wheels[wheel].travel_per_radian(),
                    true,
                );
            }
            Measurement::YawRate { rate } if rate.is_finite() => {
                self.turn.integrate(time, rate, false);
            }
            Measurement::Acceleration { forward, left }
                if forward.is_finite() && left.is_finite() =>
            {
                for (track, force) in self.force.iter_mut().zip([forward, left]) {
                    track.integrate(time, force, false);
                }
            }
            Measurement::SteeringAngle { wheel, angle } => self.steered[wheel].push((time, angle)),
            Measurement::Pose { x, y, yaw } if self.reference == Reference::Pose => {
                self.readings.push((read, Value::Place([x, y])));
                self.readings.push((read, Value::Heading(yaw)));
            }
            Measurement::Position { x, y } => self.readings.push((read, Value::Place([x, y]))),
            Measurement::Speed { forward, .. } if self.reference == Reference::Speed => {
                self.readings.push((read, Value::Speed(forward)));
            }
            Measurement::Displacement {
                forward,
                left,
                turn,
            } if self.reference == Reference::Displacement => {
                let turn = turn.unwrap_or(0.0);
                let (sin, cos) = (self.summed[2] + 0.5 * turn).sin_cos();
                self.summed[0] += cos * forward - sin * left;
                self.summed[1] += sin * forward + cos * left;
                self.summed[2] += turn;
                let [x, y, yaw] = self.summed;
                self.readings.push((read, Value::Place([x, y])));
                self.readings.push((read, Value::Heading(yaw)));
            }
            _ => {}
        }
    }

    /// Steps over the time in which all wheels are measured.
    pub(crate) fn steps(&self) -> Vec<Step> {
        let measured = || {
            self.tracks
                .iter()
                .filter(|track| track.is_measured())
                .map(|track| &track.points)
        };
        let from = measured().map(|points| points[0].0).fold(0.0, f64::max);
        let to = measured()
            .map(|points| points[points.len() - 1].0)
            .fold(f64::MAX, f64::min);
        let period = measured()
            .map(|points| (to - from) / points.len() as f64)
            .fold(0.0, f64::max);
        let dt = period.max(MIN_STEP_S);
        let mut steps = Vec::new();
        let mut force_before = [0.0; 2];
        let mut next = 0;
        let mut time = from + dt;
        while time <= to {
            let since = |track: &Track| {
                track
                    .is_measured()
                    .then(|| track.at(time) - track.at(time - dt))
            };
            let mean =
                [since(&self.force[0]), since(&self.force[1])].map(|of| of.map(|sum| sum / dt));
            let force = match mean {
                // from the middle of the last step to the middle of this one
                [Some(x), Some(y)] => {
                    let [last_x, last_y] = core::mem::replace(&mut force_before, [x, y]);
                    Some([0.5 * (x + last_x), 0.5 * (y + last_y)])
                }
                _ => None,
            };
            let mut readings = Vec::new();
            while let Some(&(read, value)) = self.readings.get(next).filter(|of| of.0 <= time) {
                if read > time - dt {
                    readings.push(Reading {
                        value,
                        since: time - read,
                        scale: 1.0,
                    });
                }
                next += 1;
            }
            let wheels =
                (0..self.wheels.len()).map(|wheel| self.wheel_step(wheel, time, dt, period));
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

    fn wheel_step(&self, index: usize, time: f64, dt: f64, period: f64) -> WheelStep {
        let (wheel, track) = (&self.wheels[index], &self.tracks[index]);
        let first = self.wheels[0].heading.rad();
        let is_omni = self
            .wheels
            .iter()
            .any(|of| (of.heading.rad() - first).sin().abs() > PARALLEL_SINE);
        let steered = &self.steered[index];
        let angle = steered[..steered.partition_point(|of| of.0 <= time)]
            .last()
            .map_or(0.0, |of| of.1);
        let turned = wheel
            .clone()
            .heading(Angle::from_rad(wheel.heading.rad() + angle));
        let [cos, sin, lever] = turned.speed_row();
        let step = wheel.travel_per_radian();
        let variance = if self.sensor == WheelSensor::Rate {
            let sigma = wheel.encoder.rate_step.powi(2) / 12.0 + RATE_SIGMA * RATE_SIGMA;
            sigma * step * step * dt * period
        } else {
            // two whole ticks, each uniform
            wheel.travel_per_tick().unwrap_or(ANGLE_STEP_M).powi(2) / 6.0
        };
        WheelStep {
            distance: track
                .is_measured()
                .then(|| track.at(time) - track.at(time - dt)),
            variance,
            row: [cos, sin, lever],
            across: [-sin, cos, cos * wheel.x + sin * wheel.y],
            swing: 0.0,
            is_free: wheel.role == WheelRole::Free,
            is_omni,
        }
    }
}
