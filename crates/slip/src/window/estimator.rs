//! The estimator: one sample in, the slip of every wheel out.

use alloc::{boxed::Box, vec, vec::Vec};

use grouser_real::Real;

use super::output::{WindowBody, WindowOutput};
use super::reference_track::ReferenceTrack;
use super::settings::WindowSettings;
use crate::body::{BodyMotion, Observations, dot};
use crate::error::Result;
use crate::fault::{Fault, Rejected};
use crate::history::{nanoseconds, seconds_between};
use crate::measured_slip::MeasuredSlip;
use crate::reference::Reference;
use crate::robot::{Robot, WheelRole};
use crate::sample::{Measurement, Sample};
use crate::speed::Measured;
use crate::state::{Degraded, Health, Invalid, Motion};
use crate::wheel_estimate::WheelEstimate;
use crate::wheel_track::WheelTrack;

/// Wheels whose headings differ by less than this (sine) drive one way only.
const PARALLEL: f64 = 0.02;
/// A robot without any knowledge of a speed may move at up to about this, m/s and rad/s.
const UNKNOWN: f64 = 10.0;
/// Distances grow in steps of this share of the window: in shorter ones the sensors' resolution would
/// weigh too little against the priors.
const TRAVEL_STEP: f64 = 0.25;
/// Yaw rate of a robot that is taken to drive straight, rad/s.
const STRAIGHT: f64 = 0.05;

/// Slip per wheel from a stream of samples.
///
/// Over a window T it compares how far each rim ran with how far the wheel's centre went along its
/// heading by the [`Reference`]: v_i = e_i · (v_body + Ω × p_i), s_i from v_i and r ω_i.
///
/// [`WindowEstimator::update`] takes one sample of one sensor. It never panics, allocates, blocks or reads a
/// clock; its cost is bounded by the number of wheels; a refused sample is counted and enters no estimate.
#[derive(Clone, Debug)]
pub struct WindowEstimator {
    settings: WindowSettings,
    wheels: Box<[Tracked]>,
    /// Do all powered wheels drive one way, so that the robot cannot move sideways?
    one_way: bool,
    reference: ReferenceTrack,
    estimates: Box<[WheelEstimate]>,
    body: WindowBody,
    travel_until_ns: Option<i64>,
    now_ns: Option<i64>,
    rejected: Rejected,
}

#[derive(Clone, Debug)]
struct Tracked {
    row: [f64; 3],
    role: WheelRole,
    track: WheelTrack,
    last_good_ns: Option<i64>,
}

impl WindowEstimator {
    /// An estimator for `robot`. This is the only place that allocates.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for a setting outside its limits.
    pub fn new(robot: &Robot, settings: WindowSettings) -> Result<Self> {
        settings.check()?;
        let wheels: Vec<Tracked> = robot
            .wheels()
            .iter()
            .enumerate()
            .map(|(index, wheel)| Tracked {
                row: wheel.speed_row(),
                role: wheel.role,
                track: WheelTrack::new(index, wheel, settings.track()),
                last_good_ns: None,
            })
            .collect();
        let mut powered = wheels.iter().filter(|w| w.role == WheelRole::Powered);
        let one_way = powered.next().is_none_or(|first| {
            powered.all(|w| (first.row[0] * w.row[1] - first.row[1] * w.row[0]).abs() < PARALLEL)
        });
        Ok(Self {
            estimates: vec![WheelEstimate::NOTHING; wheels.len()].into_boxed_slice(),
            wheels: wheels.into_boxed_slice(),
            one_way,
            reference: ReferenceTrack::new(&settings),
            body: WindowBody::default(),
            travel_until_ns: None,
            now_ns: None,
            rejected: Rejected::default(),
            settings,
        })
    }

    /// Takes one sample and gives what is known after it.
    ///
    /// # Errors
    /// A [`Fault`] refuses the sample: it is counted and enters no estimate.
    pub fn update(&mut self, sample: Sample) -> core::result::Result<WindowOutput<'_>, Fault> {
        let taken = match sample.measurement {
            Measurement::WheelCount { wheel, .. }
            | Measurement::WheelEdge { wheel, .. }
            | Measurement::WheelAngle { wheel, .. }
            | Measurement::WheelRate { wheel, .. } => {
                let wheels = self.wheels.len();
                match self.wheels.get_mut(wheel) {
                    Some(tracked) => tracked.track.take(sample.time_ns, &sample.measurement),
                    None => Err(Fault::UnknownWheel {
                        index: wheel,
                        wheels,
                    }),
                }
            }
            _ => self.reference.take(sample.time_ns, &sample.measurement),
        };
        if let Err(fault) = taken {
            self.rejected.count(&fault);
            return Err(fault);
        }
        // A clock that was set back takes now with it.
        let newest = self.newest_of_all().unwrap_or(sample.time_ns);
        let now = newest.max(sample.time_ns);
        self.now_ns = Some(now);
        self.evaluate(now);
        Ok(self.estimate(now))
    }

    /// What is known now; `None` before the first sample.
    #[must_use]
    pub fn latest(&self) -> Option<WindowOutput<'_>> {
        self.now_ns.map(|now| self.estimate(now))
    }

    /// The settings that it works by.
    #[must_use]
    pub const fn settings(&self) -> &WindowSettings {
        &self.settings
    }

    /// Samples refused so far.
    #[must_use]
    pub const fn rejected(&self) -> Rejected {
        self.rejected
    }

    fn estimate(&self, now: i64) -> WindowOutput<'_> {
        WindowOutput {
            time_ns: now,
            wheels: &self.estimates,
            body: self.body,
            rejected: self.rejected,
        }
    }

    fn newest_of_all(&self) -> Option<i64> {
        let wheels = self.wheels.iter().filter_map(|w| w.track.newest_time());
        wheels.chain(self.reference.displacement_time()).max()
    }

    /// The latest time up to which the reference is known if it is now `now`.
    fn reference_until(&self, now: i64) -> Option<i64> {
        let mut until = self.reference.known_until()?.min(now);
        match self.settings.reference {
            Reference::FreeWheel => {
                let mut any = false;
                for wheel in self.wheels.iter().filter(|w| w.role == WheelRole::Free) {
                    until = until.min(wheel.track.known_until(now)?);
                    any = true;
                }
                any.then_some(until)
            }
            Reference::Grip => {
                for wheel in self.wheels.iter().filter(|w| w.role == WheelRole::Powered) {
                    until = until.min(wheel.track.known_until(now)?);
                }
                Some(until)
            }
            _ => Some(until),
        }
    }

    fn evaluate(&mut self, now: i64) {
        let window_ns = nanoseconds(self.settings.window);
        let reference_until = self.reference_until(now);
        let silent = |time: i64| seconds_between(time, now) > self.settings.dropout;
        let reference_lost = reference_until.is_some_and(silent);
        // Wheels that are read together share their window.
        let mut last: Option<(i64, Option<BodyMotion>)> = None;
        for index in 0..self.wheels.len() {
            let wheel = &self.wheels[index];
            let mut estimate = WheelEstimate::NOTHING;
            let own = wheel.track.known_until(now);
            if own.is_some_and(silent) {
                estimate.health = Health::Invalid(Invalid::Dropout);
            } else if reference_lost {
                estimate.health = Health::Degraded(Degraded::ReferenceLost);
            } else if self.lacks_reference() {
                estimate.health = Health::Invalid(Invalid::NoReference);
            } else if let (Some(own), Some(reference)) = (own, reference_until) {
                let until = own.min(reference);
                let from = until.saturating_sub(window_ns);
                let body = match last {
                    Some((same, body)) if same == until => body,
                    _ => self.reference_motion(from, until),
                };
                last = Some((until, body));
                let found = body.and_then(|body| self.evaluate_wheel(wheel, &body, from, until));
                estimate = found.unwrap_or(estimate);
            }
            if estimate.health == Health::Ok {
                self.wheels[index].last_good_ns = Some(now);
            }
            estimate.last_good_age = self.wheels[index]
                .last_good_ns
                .map(|good| seconds_between(good, now));
            self.estimates[index] = estimate;
        }
        self.evaluate_body(now, reference_until.filter(|_| !reference_lost));
    }

    /// Is the reference one that this robot can never have?
    fn lacks_reference(&self) -> bool {
        let needed = match self.settings.reference {
            Reference::FreeWheel => WheelRole::Free,
            Reference::Grip => WheelRole::Powered,
            _ => return false,
        };
        self.wheels.iter().all(|w| w.role != needed)
    }

    fn evaluate_wheel(
        &self,
        wheel: &Tracked,
        body: &BodyMotion,
        from: i64,
        until: i64,
    ) -> Option<WheelEstimate> {
        let rim = wheel.track.speed(from, until)?;
        let forward = body.along(wheel.row);
        let measured = MeasuredSlip::from_speeds(forward, rim, &self.settings.limits());
        let mut estimate = WheelEstimate {
            slip: measured.slip,
            sigma: measured.sigma,
            forward_speed: Some(forward),
            rim_speed: Some(rim),
            motion: Some(measured.motion),
            health: measured.health,
            until_ns: Some(until),
            last_good_age: None,
        };
        if estimate.health == Health::Ok && measured.slip.is_some() {
            if self.settings.reference == Reference::Grip {
                estimate.health = Health::Degraded(Degraded::Relative);
            } else if self.reference.yaw_rate(from, until).is_none() {
                estimate.health = Health::Degraded(Degraded::YawAssumed);
            }
        }
        if wheel.role == WheelRole::Free && self.settings.reference == Reference::FreeWheel {
            // It is what the others are measured against: by assumption it rolls without slip.
            estimate.slip = None;
            estimate.sigma = None;
            if estimate.motion != Some(Motion::Standstill) {
                estimate.motion = Some(Motion::Driving);
            }
        }
        Some(estimate)
    }

    /// The robot's mean motion over a window by the reference.
    fn reference_motion(&self, from: i64, until: i64) -> Option<BodyMotion> {
        let mut seen = Observations::default();
        // What is measured needs no assumption.
        let lateral = if self.one_way && !self.reference.measures_displacement() {
            self.settings.lateral_sigma
        } else {
            UNKNOWN
        };
        seen.add([1.0, 0.0, 0.0], prior(UNKNOWN));
        seen.add(self.sideways(), prior(lateral));
        let yaw = self.reference.yaw_rate(from, until);
        seen.add([0.0, 0.0, 1.0], yaw.unwrap_or(prior(STRAIGHT)));
        self.reference.observe(from, until, &mut seen)?;
        match self.settings.reference {
            Reference::FreeWheel => {
                for wheel in self.wheels.iter().filter(|w| w.role == WheelRole::Free) {
                    seen.add(wheel.row, wheel.track.speed(from, until)?);
                }
            }
            Reference::Grip => {
                let (row, speed) = self.gripping(from, until, yaw.unwrap_or_default())?;
                seen.add(row, speed);
            }
            _ => {}
        }
        seen.solve()
    }

    /// The direction in which a robot whose wheels all point one way cannot move.
    fn sideways(&self) -> [f64; 3] {
        let heading = self
            .wheels
            .iter()
            .find(|w| w.role == WheelRole::Powered)
            .map_or([1.0, 0.0, 0.0], |w| w.row);
        if self.one_way {
            [-heading[1], heading[0], 0.0]
        } else {
            [0.0, 1.0, 0.0]
        }
    }

    /// The powered wheel whose rim, freed of the yaw rate, runs slowest: the one that grips if any does
    /// (Ojeda and Borenstein's assumption for a driving robot).
    fn gripping(&self, from: i64, until: i64, yaw: Measured) -> Option<([f64; 3], Measured)> {
        let mut slowest: Option<([f64; 3], Measured, f64)> = None;
        for wheel in self.wheels.iter().filter(|w| w.role == WheelRole::Powered) {
            let rim = wheel.track.speed(from, until)?;
            let straight = (rim.value - wheel.row[2] * yaw.value).abs();
            if slowest.is_none_or(|(_, _, least)| straight < least) {
                slowest = Some((wheel.row, rim, straight));
            }
        }
        slowest.map(|(row, rim, _)| (row, rim))
    }

    /// The motion that the powered wheels would give the robot over a window without slip.
    fn wheels_motion(&self, from: i64, until: i64) -> Option<BodyMotion> {
        let mut seen = Observations::default();
        let lateral = if self.one_way {
            self.settings.lateral_sigma
        } else {
            UNKNOWN
        };
        seen.add([1.0, 0.0, 0.0], prior(UNKNOWN));
        seen.add(self.sideways(), prior(lateral));
        seen.add([0.0, 0.0, 1.0], prior(UNKNOWN));
        // All wheels weigh the same, as the least resolved of them: what differs is their slip.
        let powered = || self.wheels.iter().filter(|w| w.role == WheelRole::Powered);
        let mut variance = 1e-8_f64;
        for wheel in powered() {
            variance = variance.max(wheel.track.speed(from, until)?.variance);
        }
        for wheel in powered() {
            let rim = wheel.track.speed(from, until)?;
            seen.add(wheel.row, Measured { variance, ..rim });
        }
        seen.solve()
    }

    fn evaluate_body(&mut self, now: i64, reference_until: Option<i64>) {
        let mut powered = self.wheels.iter().filter(|w| w.role == WheelRole::Powered);
        let wheels_until = powered.try_fold(i64::MAX, |least, wheel| {
            Some(least.min(wheel.track.known_until(now)?))
        });
        let until = match (wheels_until, reference_until) {
            (Some(wheels), Some(reference)) => wheels.min(reference),
            _ => return self.forget_body(),
        };
        if self.body.until_ns == Some(until) {
            return;
        }
        let from = until.saturating_sub(nanoseconds(self.settings.window));
        let (Some(reference), Some(wheels)) = (
            self.reference_motion(from, until),
            self.wheels_motion(from, until),
        ) else {
            return self.forget_body();
        };
        let direction = self.direction(&wheels);
        let measured = MeasuredSlip::from_speeds(
            reference.along(direction),
            wheels.along(direction),
            &self.settings.limits(),
        );
        self.add_travel(until, measured.motion, direction);
        self.body = WindowBody {
            motion: Some(reference),
            wheels_motion: Some(wheels),
            along: measured.slip,
            along_sigma: measured.sigma,
            along_motion: Some(measured.motion),
            yaw_rate: self.reference.yaw_rate(from, until),
            wheels_yaw_rate: Some(wheels.along([0.0, 0.0, 1.0])),
            until_ns: Some(until),
            ..self.body
        };
    }

    fn forget_body(&mut self) {
        self.travel_until_ns = None;
        self.body = WindowBody {
            travel_wheels: self.body.travel_wheels,
            travel_reference: self.body.travel_reference,
            ..WindowBody::default()
        };
    }

    /// The direction along which the robot's slip is counted: of the command, else of the wheels'
    /// motion.
    fn direction(&self, wheels: &BodyMotion) -> [f64; 3] {
        if let Some([x, y]) = self.reference.command {
            return [x, y, 0.0];
        }
        let [x, y, _] = wheels.velocity;
        let size = Real::hypot(x, y);
        if self.one_way || !(size > 0.0) {
            let [side_x, side_y, _] = self.sideways();
            [side_y, -side_x, 0.0]
        } else {
            [x / size, y / size, 0.0]
        }
    }

    /// Adds what passed since the last evaluation to the distances, while the robot moves.
    fn add_travel(&mut self, until: i64, motion: Motion, direction: [f64; 3]) {
        let last = self.travel_until_ns.unwrap_or(until);
        let seconds = seconds_between(last, until);
        if seconds < TRAVEL_STEP * self.settings.window && last < until {
            return;
        }
        self.travel_until_ns = Some(until);
        if motion == Motion::Standstill || last >= until {
            return;
        }
        if let (Some(reference), Some(wheels)) = (
            self.reference_motion(last, until),
            self.wheels_motion(last, until),
        ) {
            self.body.travel_reference += dot(reference.velocity, direction) * seconds;
            self.body.travel_wheels += dot(wheels.velocity, direction) * seconds;
        }
    }
}

const fn prior(sigma: f64) -> Measured {
    Measured {
        value: 0.0,
        variance: sigma * sigma,
    }
}
