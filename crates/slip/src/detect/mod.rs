//! Events that an operator must know: high slip, digging in, immobilisation, a wheel stalled or off the ground.
//!
//! | event | what begins it | delay from its beginning |
//! |---|---|---|
//! | high slip | s − 2σ > 0.5 | 0.3 s and the filter's 0.1 s |
//! | dig-in | mean of the powered wheels' s − 2σ > 0.6 | 1.0 s and the filter's |
//! | immobilised | rims turn, way below 0.15 of theirs by 2σ | 0.5 s and the filter's |
//! | stall | rim stands, torque at its limit | 0.05 s and the ticks' |
//! | lift-off | rim turns, torque a quarter of its usual, slip as usual or more, other wheels not so | 0.1 s |
//!
//! Each ends with hysteresis. False alarms: none in 24 simulated hours of straight drive with quantisation
//! (RESULTS.md).

mod settings;
mod switch;

use alloc::{boxed::Box, vec};

use crate::error::Result;
use crate::history::seconds_between;
use crate::robot::{Robot, WheelRole};
use crate::state::{Degraded, Health, Motion};
use crate::wheel_estimate::WheelEstimate;
pub use settings::DetectSettings;
use switch::Switch;

/// The usual torque is a mean over this long, s.
const TORQUE_MEMORY_S: f64 = 2.0;
/// It is known after this long, s.
const TORQUE_KNOWN_TIME_S: f64 = 1.0;

/// What can happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Event {
    /// A powered wheel slips much.
    HighSlip {
        /// Which.
        wheel: usize,
    },
    /// The powered wheels together slip so much that they dig.
    DigIn,
    /// The rims turn and the robot stays where it is.
    Immobilised,
    /// A wheel stands under full torque.
    Stall {
        /// Which.
        wheel: usize,
    },
    /// A wheel turns without load.
    LiftOff {
        /// Which.
        wheel: usize,
    },
}

/// An event begins or ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Change {
    /// Which.
    pub event: Event,
    /// Does it begin?
    pub begins: bool,
    /// Since when its condition has held, ns.
    pub since_ns: i64,
    /// When it was called, ns.
    pub time_ns: i64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Watched {
    powered: bool,
    high: Switch,
    stall: Switch,
    lift: Switch,
    usual_torque: f64,
    usual_slip: f64,
    received_s: f64,
}

/// Watches the wheels' estimates. Allocates at construction only, never panics, costs the same every time.
///
/// ```
/// use grouser_slip::detect::{DetectSettings, Detector, Event};
/// use grouser_slip::filter::{FilterSettings, SlipFilter};
/// use grouser_slip::{Measurement, Robot, Sample, Wheel};
///
/// let wheels = vec![
///     Wheel::powered("drive").at(0.3, 0.0).radius(0.1).ticks_per_turn(1000),
///     Wheel::free("fifth").at(-0.3, 0.0).radius(0.1).ticks_per_turn(1000),
/// ];
/// let robot = Robot::new("bicycle".into(), wheels)?;
/// let mut filter = SlipFilter::new(&robot, FilterSettings::default())?;
/// let mut detector = Detector::new(&robot, DetectSettings::default())?;
/// let mut seen = Vec::new();
/// for step in 0..400_u64 {
///     let time_ns = step as i64 * 10_000_000;
///     // after two seconds the free wheel, and with it the robot, stops
///     for (wheel, raw) in [(0, 10 * step), (1, 8 * step.min(200))] {
///         filter.update(Sample { time_ns, measurement: Measurement::WheelCount { wheel, raw } })?;
///     }
///     let latest = filter.latest();
///     seen.extend(detector.update(time_ns, latest.wheels, &[]).filter(|c| c.begins).map(|c| c.event));
/// }
/// assert!(seen.contains(&Event::Immobilised) && seen.contains(&Event::HighSlip { wheel: 0 }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Detector {
    settings: DetectSettings,
    wheels: Box<[Watched]>,
    dig_in: Switch,
    immobilised: Switch,
    changes: Box<[Option<Change>]>,
    last_ns: Option<i64>,
    /// Most torques have fallen away.
    alike: bool,
}

impl Detector {
    /// A detector for `robot`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for a setting outside its limits.
    pub fn new(robot: &Robot, settings: DetectSettings) -> Result<Self> {
        settings.check()?;
        let mut wheels = vec![Watched::default(); robot.wheels().len()].into_boxed_slice();
        for (watched, wheel) in wheels.iter_mut().zip(robot.wheels()) {
            watched.powered = wheel.role == WheelRole::Powered;
        }
        Ok(Self {
            changes: vec![None; 3 * wheels.len() + 2].into_boxed_slice(),
            wheels,
            dig_in: Switch::default(),
            immobilised: Switch::default(),
            last_ns: None,
            alike: false,
            settings,
        })
    }

    /// Takes the wheels' estimates at `time_ns` and their torques (N m; fewer than wheels, or none, if unknown); gives
    /// what begins and ends.
    pub fn update<'a>(
        &'a mut self,
        time_ns: i64,
        wheels: &[WheelEstimate],
        torques: &[Option<f64>],
    ) -> impl Iterator<Item = Change> + 'a {
        self.changes.fill(None);
        let mut slot = 0;
        let dt = self
            .last_ns
            .replace(time_ns)
            .map_or(0.0, |last| seconds_between(last, time_ns).clamp(0.0, 1.0));
        self.alike = self.fall_alike(torques);
        for (index, estimate) in wheels.iter().enumerate().take(self.wheels.len()) {
            let torque = torques.get(index).copied().flatten();
            for found in self.watch(index, time_ns, dt, estimate, torque) {
                self.changes[slot] = found;
                slot += 1;
            }
        }
        for found in self.watch_robot(time_ns, wheels) {
            self.changes[slot] = found;
            slot += 1;
        }
        self.changes.iter().flatten().copied()
    }

    /// Have the torques of most powered wheels fallen away? Then a sensor has, or the motors are off, but no wheel from the ground.
    fn fall_alike(&self, torques: &[Option<f64>]) -> bool {
        let (mut powered, mut light) = (0_usize, 0_usize);
        for (index, watched) in self.wheels.iter().enumerate().filter(|(_, w)| w.powered) {
            let torque = torques.get(index).copied().flatten();
            powered += 1;
            light += usize::from(torque.is_some_and(|torque| {
                torque.abs() < self.settings.lift_off * watched.usual_torque
            }));
        }
        powered > 1 && 2 * light > powered
    }

    /// Is an event going on?
    ///
    /// ```
    /// use grouser_slip::detect::{DetectSettings, Detector, Event};
    /// use grouser_slip::{Robot, Wheel};
    ///
    /// let robot = Robot::new("cart".into(), vec![Wheel::powered("left").ticks_per_turn(100)])?;
    /// let detector = Detector::new(&robot, DetectSettings::default())?;
    /// assert!(!detector.is_on(Event::DigIn));
    /// # Ok::<(), grouser_slip::Error>(())
    /// ```
    #[must_use]
    pub fn is_on(&self, event: Event) -> bool {
        let wheel = |index: usize| self.wheels.get(index);
        match event {
            Event::HighSlip { wheel: i } => wheel(i).is_some_and(|w| w.high.is_on()),
            Event::Stall { wheel: i } => wheel(i).is_some_and(|w| w.stall.is_on()),
            Event::LiftOff { wheel: i } => wheel(i).is_some_and(|w| w.lift.is_on()),
            Event::DigIn => self.dig_in.is_on(),
            Event::Immobilised => self.immobilised.is_on(),
        }
    }

    /// How a wheel moves, where torque has shown more than the speeds.
    #[must_use]
    pub fn motion(&self, wheel: usize, by_speeds: Option<Motion>) -> Option<Motion> {
        if self.is_on(Event::LiftOff { wheel }) {
            Some(Motion::LiftOff)
        } else if self.is_on(Event::Stall { wheel }) {
            Some(Motion::Stall)
        } else {
            by_speeds
        }
    }

    /// Does this wheel tell anything of the soil now? One off the ground, or that stands, does not: leave its readings out of
    /// soil identification.
    #[must_use]
    pub fn feels_the_ground(&self, wheel: usize) -> bool {
        self.wheels.get(wheel).is_some_and(|watched| {
            watched.powered
                && !watched.lift.is_on()
                && !watched.lift.is_rising()
                && !watched.stall.is_on()
        })
    }

    fn watch(
        &mut self,
        index: usize,
        time_ns: i64,
        dt: f64,
        estimate: &WheelEstimate,
        torque: Option<f64>,
    ) -> [Option<Change>; 3] {
        let s = self.settings;
        let watched = &mut self.wheels[index];
        if !watched.powered {
            return [None; 3];
        }
        let change = |found: Option<(bool, i64)>, event| {
            found.map(|(begins, since_ns)| Change {
                event,
                begins,
                since_ns,
                time_ns,
            })
        };
        let torque = torque.filter(|torque| torque.is_finite()).map(f64::abs);
        let light = torque.is_some_and(|torque| torque < s.lift_off * watched.usual_torque);
        let settled = watched.received_s >= TORQUE_KNOWN_TIME_S;
        // A wheel that leaves loose ground needs less torque as well, but slips less then; one in the air does not.
        let slip = trusted(estimate);
        let eased =
            slip.is_some_and(|(slip, sigma)| slip < watched.usual_slip - s.certainty * sigma);
        let light = light && !eased;
        // a wheel without load slips as much as it likes
        let slip = trusted(estimate).filter(|_| !(watched.lift.is_on() || settled && light));
        let above = slip.is_some_and(|(slip, sigma)| slip - s.certainty * sigma > s.high_slip);
        let below = slip.is_none_or(|(slip, _)| slip < s.release * s.high_slip);
        let high = watched.high.take(
            time_ns,
            (above, below),
            (s.high_slip_time, s.high_slip_time),
        );
        let rim = estimate.rim_speed.map(|rim| rim.value.abs());
        let turns = rim.is_some_and(|rim| rim > s.standstill_speed);
        let full = torque.is_some_and(|torque| torque >= s.stall_torque);
        let stall = watched.stall.take(
            time_ns,
            (full && rim.is_some() && !turns, !full || turns),
            (s.stall_time, s.stall_time),
        );
        let loaded = torque.is_some_and(|torque| torque > 2.0 * s.lift_off * watched.usual_torque);
        let lift = watched.lift.take(
            time_ns,
            (
                settled && turns && light && !self.alike,
                !turns || loaded || torque.is_none(),
            ),
            (s.lift_off_time, s.lift_off_time),
        );
        // what is usual is learned on the ground only
        if let Some(torque) = torque
            && turns
            && !light
        {
            watched.received_s += dt;
            let share = (dt / TORQUE_MEMORY_S).max(dt / watched.received_s).min(1.0);
            watched.usual_torque += share * (torque - watched.usual_torque);
            if let Some((slip, _)) = trusted(estimate) {
                watched.usual_slip += share * (slip - watched.usual_slip);
            }
        }
        [
            change(high, Event::HighSlip { wheel: index }),
            change(stall, Event::Stall { wheel: index }),
            change(lift, Event::LiftOff { wheel: index }),
        ]
    }

    fn watch_robot(&mut self, time_ns: i64, wheels: &[WheelEstimate]) -> [Option<Change>; 2] {
        let s = self.settings;
        let (mut count, mut sure, mut mean) = (0.0, 0.0, 0.0);
        let (mut way, mut rims, mut doubt) = (0.0, 0.0, 0.0);
        for (watched, estimate) in self.wheels.iter().zip(wheels) {
            if !watched.powered || watched.lift.is_on() {
                continue;
            }
            let Some((slip, sigma)) = trusted(estimate) else {
                continue;
            };
            count += 1.0;
            mean += slip;
            sure += slip - s.certainty * sigma;
            if let (Some(forward), Some(rim)) = (estimate.forward_speed, estimate.rim_speed) {
                way += forward.value.abs();
                doubt += s.certainty * forward.sigma();
                rims += rim.value.abs();
            }
        }
        let some = count > 0.0;
        let turning = some && rims > count * s.standstill_speed;
        let dig = self.dig_in.take(
            time_ns,
            (
                some && sure > s.dig_in * count,
                !some || mean < s.release * s.dig_in * count,
            ),
            (s.dig_in_time, s.dig_in_time),
        );
        let stuck = turning
            && way + doubt < s.immobilised * rims + s.certainty * s.standstill_speed * count
            && sure > (1.0 - 2.5 * s.immobilised) * count;
        let free = !turning || way - doubt > s.immobilised / s.release * rims;
        let held = self.immobilised.take(
            time_ns,
            (stuck, free),
            (s.immobilised_time, s.immobilised_time),
        );
        let change = |found: Option<(bool, i64)>, event| {
            found.map(|(begins, since_ns)| Change {
                event,
                begins,
                since_ns,
                time_ns,
            })
        };
        [change(dig, Event::DigIn), change(held, Event::Immobilised)]
    }
}

/// Slip and sigma of a wheel that can be trusted with an alarm: an estimate without a reference of its own can not, one that
/// something contradicts can, for a robot that is stuck contradicts its wheels.
fn trusted(estimate: &WheelEstimate) -> Option<(f64, f64)> {
    let usable = matches!(
        estimate.health,
        Health::Ok | Health::Degraded(Degraded::Quantised | Degraded::Suspect)
    );
    let (slip, sigma) = (estimate.slip?.value(), estimate.sigma?);
    (usable && sigma.is_finite()).then_some((slip, sigma))
}

#[cfg(test)]
mod tests;
