//! Ways, turns and the mean motion of the robot over windows of time.

use alloc::{boxed::Box, vec, vec::Vec};

use grouser_real::Real;

use super::output::WindowBody;
use super::reference_track::ReferenceTrack;
use super::settings::WindowSettings;
use crate::body::{BodyMotion, Observations, dot};
use crate::error::Result;
use crate::fault::{Fault, Rejected};
use crate::history::{History, nanoseconds, seconds_between};
use crate::measured_slip::MeasuredSlip;
use crate::reference::Reference;
use crate::robot::{Robot, WheelRole};
use crate::sample::{Measurement, Sample};
use crate::speed::Measured;
use crate::state::Motion;
use crate::wheel_steering::Steering;
use crate::wheel_track::WheelTrack;

/// Wheels whose headings differ by less than this (sine) drive one way only.
const PARALLEL_SINE: f64 = 0.02;
/// Wheels that lie less far from one another along the robot are on one axle, m.
const MIN_LEVER_M: f64 = 1e-3;
/// A robot without any knowledge of a speed may move at up to about this, m/s and rad/s.
const UNKNOWN_SPEED_SIGMA: f64 = 10.0;
/// And at least this multiple of the sigma of a speed by two places of a reference, which the prior would draw towards 0.
const UNKNOWN_SIGMAS: f64 = 100.0;
/// Distances grow in steps of this share of the window: in shorter ones the sensors' resolution would
/// weigh too little against the priors.
const TRAVEL_STEP: f64 = 0.25;
/// Steering angles kept of each wheel, and over how many windows: the older end of a window lags behind by a dropout.
const SWINGS: usize = 64;
const SWING_WINDOWS: f64 = 4.0;
/// Steered wheels roll along their headings to this share of what a rim's speed is known to: slips of rims differ by far more.
const STEERED_SIGMA_SHARE: f64 = 0.1;
/// Yaw rate of a robot that is taken to drive straight, rad/s.
const STRAIGHT_YAW_RATE_RAD_PER_S: f64 = 0.05;

/// The robot's ways by its wheels and by the reference, and its mean motion over a window by both.
///
/// [`WindowEstimator`](super::WindowEstimator) adds the slip of every wheel; beside a
/// [`SlipFilter`](crate::filter::SlipFilter) these means alone are wanted, and cost a few per cent of it.
#[derive(Clone, Debug)]
pub struct WindowMeans {
    settings: WindowSettings,
    wheels: Box<[Tracked]>,
    /// Powered wheels that are left out of the motion by the wheels, bit by bit.
    left_out: u64,
    /// Do all powered wheels drive one way, so that the robot cannot move sideways? Not once they are steered.
    one_way: bool,
    /// Has any wheel been steered?
    is_steered: bool,
    reference: ReferenceTrack,
    /// The window that was measured last, ns, and every wheel's rim speed over it.
    measured: (i64, i64),
    speeds: Box<[Option<Measured>]>,
    /// The same over the window that the body's means are of.
    rims: Box<[Option<Measured>]>,
    /// Up to when the reference is known, unless it is lost.
    reference_until: Option<i64>,
    body: WindowBody,
    travel_until_ns: Option<i64>,
    now_ns: Option<i64>,
    rejected: Rejected,
}

#[derive(Clone, Debug)]
pub(super) struct Tracked {
    pub(super) role: WheelRole,
    pub(super) track: WheelTrack,
    steering: Steering,
    /// The way of its centre along its heading by steering alone, m.
    swings: History<1>,
}

impl Tracked {
    /// The row of its centre's speed along its heading.
    pub(super) const fn row(&self) -> [f64; 3] {
        self.steering.along()
    }

    fn steer(&mut self, time_ns: i64, angle: f64) -> core::result::Result<(), Fault> {
        Fault::check_range("steering angle", angle, -7.0, 7.0, "rad")?;
        if self.swings.newest().is_some_and(|(last, _)| last > time_ns) {
            // the clock was set back
            self.swings.clear();
        }
        self.steering.turn(angle);
        self.swings.push(time_ns, [self.steering.swung_in_all()]);
        Ok(())
    }

    /// Its rim speed over a window by which its centre moves with the robot: what it rolls by steering alone is left out.
    fn speed(&self, from: i64, until: i64) -> Option<Measured> {
        let rim = self.track.speed(from, until)?;
        let swung = self.swings.at(until).zip(self.swings.at(from));
        let swung = swung.map_or(0.0, |([to], [from])| to - from);
        Some(Measured {
            value: rim.value - swung / seconds_between(from, until),
            ..rim
        })
    }
}

impl WindowMeans {
    /// The means of `robot`. This is the only place that allocates.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for a setting outside its limits.
    pub fn new(robot: &Robot, settings: WindowSettings) -> Result<Self> {
        settings.check()?;
        let track = settings.track();
        let travel = History::new(settings.history, nanoseconds(track.gap()));
        let wheels: Vec<Tracked> = robot
            .wheels()
            .iter()
            .enumerate()
            .map(|(index, wheel)| Tracked {
                role: wheel.role,
                track: WheelTrack::new(index, wheel, track, travel.clone()),
                steering: Steering::new(wheel),
                swings: History::new(SWINGS, nanoseconds(SWING_WINDOWS * settings.window)),
            })
            .collect();
        let mut powered = wheels.iter().filter(|w| w.role == WheelRole::Powered);
        let one_way = powered.next().is_none_or(|first| {
            let [x, y, _] = first.row();
            powered.all(|w| (x * w.row()[1] - y * w.row()[0]).abs() < PARALLEL_SINE)
        });
        Ok(Self {
            speeds: vec![None; wheels.len()].into_boxed_slice(),
            rims: vec![None; wheels.len()].into_boxed_slice(),
            reference_until: None,
            wheels: wheels.into_boxed_slice(),
            left_out: 0,
            one_way,
            is_steered: false,
            reference: ReferenceTrack::new(&settings),
            measured: (0, 0),
            body: WindowBody::default(),
            travel_until_ns: None,
            now_ns: None,
            rejected: Rejected::default(),
            settings,
        })
    }

    /// Takes one sample and returns the means after it.
    ///
    /// # Errors
    /// A [`Fault`] refuses the sample: it is counted and enters no mean.
    pub fn update(&mut self, sample: Sample) -> core::result::Result<&WindowBody, Fault> {
        let now = self.accept(sample)?;
        let reference_until = self.reference_until(now);
        self.reference_until = reference_until.filter(|until| !self.is_silent(*until, now));
        self.evaluate_body(now, self.reference_until);
        Ok(&self.body)
    }

    /// The means after the last sample; `None` before the first.
    #[must_use]
    pub fn latest(&self) -> Option<&WindowBody> {
        self.now_ns.map(|_| &self.body)
    }

    /// Adds a sample to the tracks; returns the time that it is then.
    pub(super) fn accept(&mut self, sample: Sample) -> core::result::Result<i64, Fault> {
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
            Measurement::SteeringAngle { wheel, angle } => {
                let wheels = self.wheels.len();
                self.is_steered = true;
                self.one_way = false;
                match self.wheels.get_mut(wheel) {
                    Some(tracked) => tracked.steer(sample.time_ns, angle),
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
        Ok(now)
    }

    /// The settings.
    #[must_use]
    pub const fn settings(&self) -> &WindowSettings {
        &self.settings
    }

    /// Leaves wheels (bit by bit) out of the motion and the way by the wheels: their counters stand, or are wrong. Where it leaves out
    /// any, the measured yaw rate counts as one of the wheels.
    pub const fn leave_out(&mut self, wheels: u64) {
        self.left_out = wheels;
    }

    /// Samples refused so far.
    #[must_use]
    pub const fn rejected(&self) -> Rejected {
        self.rejected
    }

    pub(super) const fn now_ns(&self) -> Option<i64> {
        self.now_ns
    }

    pub(super) const fn body(&self) -> WindowBody {
        self.body
    }

    pub(super) const fn wheels(&self) -> &[Tracked] {
        &self.wheels
    }

    /// The mean rim speed of a wheel over the window that ends where it and the reference are both known.
    #[must_use]
    pub fn rim_speed(&self, wheel: usize) -> Option<Measured> {
        let now = self.now_ns?;
        let track = &self.wheels.get(wheel)?.track;
        let own = track
            .known_until(now)
            .filter(|own| !self.is_silent(*own, now))?;
        let until = own.min(self.reference_until?);
        if self.body.until_ns == Some(until) {
            return self.rims[wheel];
        }
        self.wheels[wheel].speed(self.window_start(until), until)
    }

    pub(super) fn window_start(&self, until: i64) -> i64 {
        until.saturating_sub(nanoseconds(self.settings.window))
    }

    /// Is a sensor whose last sample came at `time` lost?
    pub(super) fn is_silent(&self, time: i64, now: i64) -> bool {
        seconds_between(time, now) > self.settings.dropout
    }

    /// The yaw rate over a window, where it is measured.
    pub(super) fn yaw_rate(&self, from: i64, until: i64) -> Option<Measured> {
        self.reference.yaw_rate(from, until)
    }

    fn newest_of_all(&self) -> Option<i64> {
        let wheels = self.wheels.iter().filter_map(|w| w.track.newest_time());
        wheels.chain(self.reference.displacement_time()).max()
    }

    /// The latest time up to which the reference is known if it is now `now`.
    pub(super) fn reference_until(&self, now: i64) -> Option<i64> {
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

    /// Is the reference one that this robot can never have?
    pub(super) fn lacks_reference(&self) -> bool {
        let needed = match self.settings.reference {
            Reference::FreeWheel => WheelRole::Free,
            Reference::Grip => WheelRole::Powered,
            _ => return false,
        };
        self.wheels.iter().all(|w| w.role != needed)
    }

    /// Measures the rims over a window; [`Self::reference_motion`] and [`Self::wheels_motion`] are of that window.
    pub(super) fn measure(&mut self, from: i64, until: i64) {
        for (speed, wheel) in self.speeds.iter_mut().zip(&self.wheels) {
            *speed = wheel.speed(from, until);
        }
        self.measured = (from, until);
    }

    /// The rim speeds of the window that was measured last.
    pub(super) const fn speeds(&self) -> &[Option<Measured>] {
        &self.speeds
    }

    /// The robot's mean motion by the reference.
    pub(super) fn reference_motion(&self) -> Option<BodyMotion> {
        let (from, until) = self.measured;
        let mut seen = Observations::default();
        let poor = UNKNOWN_SIGMAS * self.settings.position_sigma / self.settings.window;
        seen.add([1.0, 0.0, 0.0], prior(UNKNOWN_SPEED_SIGMA.max(poor)));
        // What is measured needs no assumption.
        self.hold_sideways(&mut seen, !self.reference.measures_displacement());
        let yaw = self.reference.yaw_rate(from, until);
        seen.add(
            [0.0, 0.0, 1.0],
            yaw.unwrap_or(prior(STRAIGHT_YAW_RATE_RAD_PER_S)),
        );
        self.reference.observe(from, until, &mut seen)?;
        match self.settings.reference {
            Reference::FreeWheel => {
                for (wheel, speed) in self.of(WheelRole::Free) {
                    seen.add(wheel.row(), speed?);
                }
            }
            Reference::Grip => {
                let (row, speed) = self.gripping(yaw.unwrap_or_default())?;
                seen.add(row, speed);
            }
            _ => {}
        }
        seen.solve()
    }

    /// The wheels of a role that are not left out, with their rim speeds.
    fn of(&self, role: WheelRole) -> impl Iterator<Item = (&Tracked, Option<Measured>)> {
        let all = self.wheels.iter().zip(self.speeds.iter().copied());
        let kept = all.enumerate().filter(move |(index, (wheel, _))| {
            wheel.role == role && self.left_out >> index & 1 == 0
        });
        kept.map(|(_, of)| of)
    }

    /// Assumes no motion to the side where it `is_held`: a robot whose wheels all point one way does not move across it, and
    /// steered wheels roll along their headings, each at its place.
    fn hold_sideways(&self, seen: &mut Observations, is_held: bool) {
        let held = self.settings.lateral_sigma;
        if !self.is_steered {
            let is_held = is_held && self.one_way;
            let sigma = if is_held { held } else { UNKNOWN_SPEED_SIGMA };
            return seen.add(self.sideways(), prior(sigma));
        }
        seen.add([0.0, 1.0, 0.0], prior(UNKNOWN_SPEED_SIGMA));
        if is_held {
            for (wheel, _) in self.of(WheelRole::Powered) {
                seen.add(wheel.steering.across(), prior(held));
            }
        }
    }

    /// The direction in which a robot whose wheels all point one way cannot move.
    fn sideways(&self) -> [f64; 3] {
        let heading = self
            .wheels
            .iter()
            .find(|w| w.role == WheelRole::Powered)
            .map_or([1.0, 0.0, 0.0], Tracked::row);
        if self.one_way {
            [-heading[1], heading[0], 0.0]
        } else {
            [0.0, 1.0, 0.0]
        }
    }

    /// The powered wheel whose rim, freed of the yaw rate, runs slowest: the one that grips if any does
    /// (Ojeda and Borenstein's assumption for a driving robot).
    fn gripping(&self, yaw: Measured) -> Option<([f64; 3], Measured)> {
        let mut slowest: Option<([f64; 3], Measured, f64)> = None;
        for (wheel, speed) in self.of(WheelRole::Powered) {
            let rim = speed?;
            let straight = (rim.value - wheel.row()[2] * yaw.value).abs();
            if slowest.is_none_or(|(_, _, least)| straight < least) {
                slowest = Some((wheel.row(), rim, straight));
            }
        }
        slowest.map(|(row, rim, _)| (row, rim))
    }

    /// Do all powered wheels lie on one line across the robot? Then they do not tell a turn from a sideways motion.
    fn is_one_axle(&self) -> bool {
        let mut ahead = self.of(WheelRole::Powered).map(|(wheel, _)| {
            let ([cos, sin, along], [.., across]) = (wheel.row(), wheel.steering.across());
            sin * along + cos * across
        });
        let first = ahead.next();
        ahead.all(|x| first.is_some_and(|first| (x - first).abs() < MIN_LEVER_M))
    }

    /// The motion that the powered wheels would give the robot without slip.
    fn wheels_motion(&self) -> Option<BodyMotion> {
        let mut seen = Observations::default();
        seen.add([1.0, 0.0, 0.0], prior(UNKNOWN_SPEED_SIGMA));
        seen.add([0.0, 0.0, 1.0], prior(UNKNOWN_SPEED_SIGMA));
        if (self.left_out != 0 || self.is_steered && self.is_one_axle())
            && let Some(yaw_rate) = self.reference.yaw_rate(self.measured.0, self.measured.1)
        {
            seen.add([0.0, 0.0, 1.0], yaw_rate);
        }
        // All wheels weigh the same, as the least resolved of them: what differs is their slip.
        let mut variance = 1e-8_f64;
        for (_, speed) in self.of(WheelRole::Powered) {
            variance = variance.max(speed?.variance);
        }
        if self.is_steered {
            // unequal slips of rims are no motion across them
            let across = prior(STEERED_SIGMA_SHARE * Real::sqrt(variance));
            seen.add([0.0, 1.0, 0.0], prior(UNKNOWN_SPEED_SIGMA));
            for (wheel, _) in self.of(WheelRole::Powered) {
                seen.add(wheel.steering.across(), across);
            }
        } else {
            self.hold_sideways(&mut seen, true);
        }
        for (wheel, speed) in self.of(WheelRole::Powered) {
            seen.add(wheel.row(), Measured { variance, ..speed? });
        }
        seen.solve()
    }

    /// Evaluates the robot's motion over the window that ends where wheels and reference are both known.
    pub(super) fn evaluate_body(&mut self, now: i64, reference_until: Option<i64>) {
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
        self.measure(from, until);
        self.rims.copy_from_slice(&self.speeds);
        let (Some(reference), Some(wheels)) = (self.reference_motion(), self.wheels_motion())
        else {
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
        self.measure(last, until);
        if let (Some(reference), Some(wheels)) = (self.reference_motion(), self.wheels_motion()) {
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

#[cfg(test)]
mod tests;
