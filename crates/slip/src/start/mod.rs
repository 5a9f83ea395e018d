//! Compares the sensors with the robot's description at the start: units, signs, axes, the direction of gravity.
//!
//! For some time a filter cannot distinguish a gyro that sends degrees per second from a robot that spins. These checks
//! name the wrong field before the robot drives on. [`check_gravity`] compares three axes at rest. [`StartCheck`] runs beside
//! a [`SlipFilter`](crate::filter::SlipFilter) over the first metres and compares quantities that must be proportional, with a
//! factor near 1.
//!
//! Not observable: the scale of a camera that is the only reference (an error looks like soft ground), the sign of the yaw
//! rate before the first bend, and the sign of an accelerometer before the first acceleration.

mod gravity;
mod pair;

use alloc::{boxed::Box, vec};
use grouser_terra::EARTH_GRAVITY_M_PER_S2;

use crate::body::Observations;
use crate::error::Result;
use crate::fault::Fault;
use crate::filter::FilterOutput;
use crate::history::seconds_between;
use crate::robot::{Robot, WheelRole};
use crate::sample::{Measurement, Sample};
use crate::speed::Measured;
use crate::wheel_estimate::WheelEstimate;
pub use gravity::check_gravity;
use pair::{Pair, Verdict};

/// Means are taken over this long, s.
const WINDOW_S: f64 = 0.2;
/// All wheels slower than this: the robot rests, m/s.
const REST_SPEED_M_PER_S: f64 = 1e-3;
/// At rest no planar accelerometer shows more: no robot stands on 45°, m/s².
const MAX_REST_FORCE_M_PER_S2: f64 = 6.9;
/// At rest no gyro shows more, rad/s.
const MAX_BIAS_RAD_PER_S: f64 = 0.5;
/// Slower turns (rad/s), speeds (m/s) and accelerations (m/s²) say nothing.
const MIN_TURN_RAD_PER_S: f64 = 0.03;
const MIN_SPEED_M_PER_S: f64 = 0.03;
const MIN_ACCELERATION_M_PER_S2: f64 = 0.05;

/// How far the look has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// A sensor that sends has not yet been checked: the robot has not rested, driven, turned or sped up enough.
    Looking,
    /// All sensors that send are plausible.
    Plausible,
}

/// Means over the open window, and their counts.
#[derive(Clone, Copy, Debug, Default)]
struct Means {
    gyro: (f64, f64),
    force: [(f64, f64); 2],
    reference: [(f64, f64); 2],
}

/// Listens to the start of a drive.
#[derive(Clone, Debug)]
pub struct StartCheck {
    rows: Box<[([f64; 3], bool)]>,
    begun_ns: Option<i64>,
    last_reference_ns: Option<i64>,
    means: Means,
    /// Mean speed of the free rims, or of all, in the window before.
    before: Option<f64>,
    gyro: Pair,
    reference: Pair,
    sideways: Pair,
    forward_force: Pair,
    left_force: Pair,
    wheels: Box<[Pair]>,
    received: [bool; 3],
    found: Option<Fault>,
}

impl StartCheck {
    /// A check for `robot`.
    ///
    /// # Errors
    /// None for a robot that exists.
    pub fn new(robot: &Robot) -> Result<Self> {
        let rows = robot
            .wheels()
            .iter()
            .map(|wheel| (wheel.speed_row(), wheel.role == WheelRole::Free));
        let rows: alloc::vec::Vec<_> = rows.collect();
        Ok(Self {
            wheels: vec![Pair::default(); rows.len()].into_boxed_slice(),
            rows: rows.into_boxed_slice(),
            begun_ns: None,
            last_reference_ns: None,
            means: Means::default(),
            before: None,
            gyro: Pair::default(),
            reference: Pair::default(),
            sideways: Pair::default(),
            forward_force: Pair::default(),
            left_force: Pair::default(),
            received: [false; 3],
            found: None,
        })
    }

    /// Takes a sample and what the filter knows after it.
    ///
    /// # Errors
    /// [`Fault::Implausible`] with the field, how many times too large it is, and what that looks like: from then on, every time.
    pub fn take(
        &mut self,
        sample: &Sample,
        known: &FilterOutput<'_>,
    ) -> core::result::Result<Progress, Fault> {
        self.step(sample, known.wheels)
    }

    fn step(
        &mut self,
        sample: &Sample,
        wheels: &[WheelEstimate],
    ) -> core::result::Result<Progress, Fault> {
        self.listen(sample);
        let begun = *self.begun_ns.get_or_insert(sample.time_ns);
        let passed = seconds_between(begun, sample.time_ns);
        if !(0.0..=2.0 * WINDOW_S).contains(&passed) {
            self.restart(sample.time_ns);
        } else if passed >= WINDOW_S {
            self.end_window(wheels, passed);
            self.restart(sample.time_ns);
        }
        match self.found {
            Some(fault) => Err(fault),
            None => Ok(self.progress()),
        }
    }

    fn progress(&self) -> Progress {
        let [gyro, force, reference] = self.received;
        let open = gyro && !self.gyro.is_settled()
            || force && !self.forward_force.is_settled()
            || reference && !self.reference.is_settled() && self.rows.iter().any(|row| row.1);
        if open {
            Progress::Looking
        } else {
            Progress::Plausible
        }
    }

    fn restart(&mut self, time_ns: i64) {
        self.begun_ns = Some(time_ns);
        self.means = Means::default();
    }

    fn listen(&mut self, sample: &Sample) {
        let add = |slot: &mut (f64, f64), value: f64| {
            if value.is_finite() {
                *slot = (slot.0 + value, slot.1 + 1.0);
            }
        };
        match sample.measurement {
            Measurement::YawRate { rate } => {
                self.received[0] = true;
                add(&mut self.means.gyro, rate);
            }
            Measurement::Acceleration { forward, left } => {
                self.received[1] = true;
                add(&mut self.means.force[0], forward);
                add(&mut self.means.force[1], left);
            }
            Measurement::Speed { forward, left } => {
                self.received[2] = true;
                add(&mut self.means.reference[0], forward);
                add(&mut self.means.reference[1], left.unwrap_or(0.0));
            }
            Measurement::Displacement { forward, left, .. } => {
                self.received[2] = true;
                let last = self.last_reference_ns.replace(sample.time_ns);
                let passed = last.map_or(0.0, |last| seconds_between(last, sample.time_ns));
                if passed > 0.0 && passed <= 1.0 {
                    add(&mut self.means.reference[0], forward / passed);
                    add(&mut self.means.reference[1], left / passed);
                }
            }
            _ => {}
        }
    }

    fn end_window(&mut self, wheels: &[WheelEstimate], passed: f64) {
        let mut rims = [None; crate::robot::MAX_WHEELS];
        for (rim, wheel) in rims.iter_mut().zip(wheels) {
            *rim = wheel.rim_speed.map(|rim| rim.value);
        }
        let count = self.rows.len();
        let rims = &rims[..count.min(rims.len())];
        if rims.iter().any(Option::is_none) {
            return;
        }
        let mean_of = |free: Option<bool>| {
            let chosen = || {
                let rows = self.rows.iter().zip(rims);
                rows.filter(move |(row, _)| free.is_none_or(|free| row.1 == free))
            };
            let n = chosen().count() as f64;
            (n > 0.0).then(|| chosen().filter_map(|(_, rim)| *rim).sum::<f64>() / n)
        };
        let mean = |(sum, n): (f64, f64)| (n > 0.0).then(|| sum / n);
        let gyro = mean(self.means.gyro);
        let force = self.means.force.map(mean);
        let [ahead, aside] = self.means.reference.map(mean);
        let (free, all) = (mean_of(Some(true)), mean_of(None));
        if rims
            .iter()
            .flatten()
            .all(|rim| rim.abs() < REST_SPEED_M_PER_S)
        {
            self.look_at_rest(gyro, force);
        }
        let others = free.or(ahead);
        // one that stays where it is does not turn by its wheels either
        let moves = others.is_none_or(|speed| speed.abs() >= MIN_SPEED_M_PER_S);
        if let (Some(gyro), Some(turn), true) = (gyro, self.turn_of(rims), moves) {
            self.gyro
                .take_unbiased(gyro, turn, MIN_TURN_RAD_PER_S, passed);
        }
        if let (Some(ahead), Some(aside)) = (ahead, aside)
            && let Some(speed) = free
        {
            self.reference.take(ahead, speed, MIN_SPEED_M_PER_S, passed);
            self.sideways.take(aside, speed, MIN_SPEED_M_PER_S, passed);
        }
        if let Some(speed) = others {
            for ((pair, (_, free)), rim) in self.wheels.iter_mut().zip(&self.rows).zip(rims) {
                if let (false, Some(rim)) = (free, rim) {
                    pair.take(*rim, speed, MIN_SPEED_M_PER_S, passed);
                }
            }
        }
        // the robot's own speed where a free wheel measures it
        let speed = free.or(all);
        if let (Some(now), Some(before)) = (speed, self.before)
            && let [Some(forward), Some(left)] = force
        {
            let rise = (now - before) / passed;
            self.forward_force
                .take_unbiased(forward, rise, MIN_ACCELERATION_M_PER_S2, passed);
            self.left_force
                .take_unbiased(left, rise, MIN_ACCELERATION_M_PER_S2, passed);
        }
        self.before = speed;
        self.conclude();
    }

    /// The yaw rate that all wheels together would give, rad/s; `None` where they cannot tell one.
    fn turn_of(&self, rims: &[Option<f64>]) -> Option<f64> {
        let mut seen = Observations::default();
        let of = |value: f64, sigma: f64| Measured {
            value,
            variance: sigma * sigma,
        };
        seen.add([0.0, 1.0, 0.0], of(0.0, 0.1));
        let mut arms = (f64::MAX, f64::MIN);
        for ((row, _), rim) in self.rows.iter().zip(rims) {
            seen.add(*row, of((*rim)?, 0.01));
            arms = (arms.0.min(row[2]), arms.1.max(row[2]));
        }
        (arms.1 - arms.0 > 0.01).then_some(())?;
        seen.solve().map(|motion| motion.velocity[2])
    }

    fn look_at_rest(&mut self, gyro: Option<f64>, force: [Option<f64>; 2]) {
        let fields = ["acceleration forward", "acceleration left"];
        for (field, force) in fields.into_iter().zip(force) {
            if let Some(force) = force.filter(|force| force.abs() > MAX_REST_FORCE_M_PER_S2) {
                self.find(
                    field,
                    force / EARTH_GRAVITY_M_PER_S2,
                    "gravity lies along this axis at rest",
                );
            }
        }
        if let Some(rate) = gyro.filter(|rate| rate.abs() > MAX_BIAS_RAD_PER_S) {
            self.find(
                "yaw rate",
                rate / MAX_BIAS_RAD_PER_S,
                "it turns while all wheels are stationary",
            );
        }
    }

    fn find(&mut self, field: &'static str, times: f64, looks_like: &'static str) {
        self.found.get_or_insert(Fault::Implausible {
            field,
            times,
            looks_like,
        });
    }

    fn conclude(&mut self) {
        match self.gyro.verdict((0.05, 3.5), &pair::ROTATIONS) {
            Verdict::Scale(times, _) => {
                // wheels that slip unlike turn otherwise than the robot, though not many times
                let guess = if times.abs() > 20.0 {
                    "degrees given as radians"
                } else if times.abs() > 1.0 {
                    "revolutions a minute given as radians a second"
                } else {
                    "radians given as degrees, or another axis"
                };
                self.find("yaw rate", times, guess);
            }
            Verdict::Sign(times) => self.find("yaw rate", times, "the other sign"),
            Verdict::Open | Verdict::Fits | Verdict::Unrelated => {}
        }
        match self.reference.verdict((0.2, 5.0), &pair::LENGTHS) {
            Verdict::Scale(times, guess) => self.find("displacement forward", times, guess),
            Verdict::Sign(times) => self.find("displacement forward", times, "the other sign"),
            Verdict::Unrelated if self.sideways.is_related() => {
                self.find("displacement left", 0.0, "forward and left exchanged");
            }
            Verdict::Open | Verdict::Fits | Verdict::Unrelated => {}
        }
        match self.forward_force.verdict((0.2, 5.0), &pair::FORCES) {
            Verdict::Scale(times, guess) => self.find("acceleration forward", times, guess),
            Verdict::Sign(times) => self.find("acceleration forward", times, "the other sign"),
            Verdict::Unrelated if self.left_force.is_related() => {
                self.find("acceleration left", 0.0, "forward and left exchanged");
            }
            Verdict::Open | Verdict::Fits | Verdict::Unrelated => {}
        }
        for index in 0..self.wheels.len() {
            // Ten times the others' speed may be a wheel that spins: a unit has its own factor, whatever the wheel does.
            if let Some((times, guess)) = self.wheels[index].unit() {
                self.find("speed of a wheel", times, guess);
            }
        }
    }
}

#[cfg(test)]
mod tests;
