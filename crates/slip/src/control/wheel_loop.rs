//! One wheel's loop: its rim's speed and its share of the torque.

use super::decision::{Action, Pending, Reason};
use super::finite;
use super::input::{WheelOrder, WheelSeen};
use super::settings::ControlSettings;
use crate::state::{Health, Motion};

/// A motor that pushes with more than this share of its torque ...
const STALL_TORQUE: f64 = 0.8;
/// ... while its rim runs slower than this, m/s ...
const STALL_SPEED: f64 = 0.004;
/// ... for this long has stalled, s.
const STALL_TIME: f64 = 0.03;
/// A rim that runs against its order faster than this, m/s ...
const AGAINST_SPEED: f64 = 0.03;
/// ... for this long is measured by a reversed encoder, s.
const AGAINST_TIME: f64 = 0.2;
/// What is left of a shed torque.
const SHED: f64 = 0.1;
/// A shed torque comes back within this, s.
const RETURN_TIME: f64 = 2.0;
/// The integral of the slip error moves the set point by at most this.
const MOST_INTEGRAL: f64 = 0.25;
/// A reduction of torque is told once it has lasted this long, s, and taken back likewise.
const TELL_TIME: f64 = 0.5;

/// What the course asks of the wheel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked {
    /// Speed of its centre along its heading, m/s.
    pub(crate) speed: f64,
    /// The cruise control's share.
    pub(crate) cruise: f64,
    /// Does the wheel's slip limit it? Not while the robot turns on the spot.
    pub(crate) slip_matters: bool,
    pub(crate) stopped: bool,
    /// The slip to run at.
    pub(crate) target: f64,
    /// The share of its speed that it runs at least.
    pub(crate) creep: f64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct WheelLoop {
    pub(crate) powered: bool,
    rim: f64,
    integral: f64,
    stall: f64,
    against: f64,
    /// Share of the torque that is let through.
    through: f64,
    /// Seconds that the slip has limited it (positive) or not (negative).
    limited: f64,
    told: bool,
}

impl WheelLoop {
    pub(crate) const fn new(powered: bool) -> Self {
        Self {
            powered,
            rim: 0.0,
            integral: 0.0,
            stall: 0.0,
            against: 0.0,
            through: 1.0,
            limited: 0.0,
            told: false,
        }
    }

    /// Is a part of its torque cut off?
    pub(crate) fn is_shed(&self) -> bool {
        self.through < 1.0
    }

    pub(crate) fn order(
        &mut self,
        settings: &ControlSettings,
        seen: &WheelSeen,
        asked: &Asked,
        step: f64,
        (index, pending): (usize, &mut Pending),
    ) -> WheelOrder {
        if !self.powered {
            return WheelOrder::default();
        }
        let cruising = asked.speed * (1.0 + asked.cruise);
        let limit = if settings.limits_slip && asked.slip_matters && !asked.stopped {
            self.slip_limit(settings, seen, asked, cruising, step)
        } else {
            None
        };
        let wanted = if asked.stopped {
            0.0
        } else {
            limit.unwrap_or(cruising)
        };
        let most = settings.most_acceleration * step;
        // a stop is twice as fast as anything else
        let most = if asked.stopped { 2.0 * most } else { most };
        self.rim += (wanted - self.rim).clamp(-most, most);
        self.tell(limit.is_some(), seen, asked.target, step, (index, pending));
        self.guard(seen, step, (index, pending));
        WheelOrder {
            rim_speed: self.rim,
            traction: settings.most_traction * self.through,
            steer: 0.0,
        }
    }

    /// v̂/(1 − s*), where that is less than the cruise control would run.
    fn slip_limit(
        &mut self,
        settings: &ControlSettings,
        seen: &WheelSeen,
        asked: &Asked,
        cruising: f64,
        step: f64,
    ) -> Option<f64> {
        if matches!(seen.health, Health::Invalid(_) | Health::Uninitialised)
            || seen.motion == Some(Motion::LiftOff)
        {
            return None;
        }
        let forward = finite(seen.forward_speed)?;
        // along the direction that is asked for
        let sense = if cruising < 0.0 { -1.0 } else { 1.0 };
        let travel = (sense * forward).max(0.0);
        let slip = match seen.motion {
            Some(Motion::RollBack) => Some(1.0),
            _ => finite(seen.slip),
        };
        let mut target = asked.target + self.integral;
        if let Some(slip) = slip {
            let sigma = finite(seen.sigma).unwrap_or(settings.sigma_half);
            let ratio = sigma / settings.sigma_half;
            let trust = 1.0 / (1.0 + ratio * ratio);
            let error = (asked.target - slip.clamp(-1.0, 1.0)) * trust;
            target += settings.gain * error;
            let limit = travel / (1.0 - target.clamp(0.02, 0.95));
            // Anti-windup: only while the slip is what limits the wheel.
            if limit < sense * cruising {
                self.integral = (self.integral + step * settings.integral_gain * error)
                    .clamp(-MOST_INTEGRAL, MOST_INTEGRAL);
            } else {
                self.integral -= self.integral * step.min(1.0);
            }
        }
        let limit = travel / (1.0 - target.clamp(0.02, 0.95));
        let floor = asked.creep * (sense * asked.speed).max(0.0);
        let limit = limit.max(floor);
        (limit < sense * cruising).then_some(sense * limit)
    }

    /// Tells of a reduction that lasts, and of its end.
    fn tell(
        &mut self,
        limited: bool,
        seen: &WheelSeen,
        target: f64,
        step: f64,
        (index, pending): (usize, &mut Pending),
    ) {
        let slip = finite(seen.slip).unwrap_or(1.0);
        let limited = limited && slip > target;
        self.limited = if limited {
            self.limited.max(0.0) + step
        } else {
            self.limited.min(0.0) - step
        };
        if !self.told && self.limited > TELL_TIME {
            self.told = true;
            let values = (slip, target);
            pending.push(Action::ReduceTorque, Reason::SlipHigh, Some(index), values);
        } else if self.told && self.limited < -TELL_TIME && slip <= target {
            self.told = false;
            let values = (slip, target);
            pending.push(
                Action::RaiseTorque,
                Reason::SlipRegained,
                Some(index),
                values,
            );
        }
    }

    /// A stalled wheel sheds its torque at once; one that turns against its order may not run away.
    fn guard(&mut self, seen: &WheelSeen, step: f64, (index, pending): (usize, &mut Pending)) {
        let torque = finite(seen.torque_share).unwrap_or(0.0);
        let rim = finite(seen.rim_speed);
        let stalls = seen.motion == Some(Motion::Stall)
            || (torque.abs() > STALL_TORQUE
                && self.rim.abs() > 2.0 * STALL_SPEED
                && rim.is_some_and(|rim| rim.abs() < STALL_SPEED));
        self.stall = if stalls { self.stall + step } else { 0.0 };
        let against = rim.is_some_and(|rim| {
            // a wheel that rolls back with its robot is measured rightly
            let rolls_back = finite(seen.forward_speed).is_some_and(|v| v * rim > 0.0);
            rim.abs() > AGAINST_SPEED && rim * self.rim < 0.0 && torque * rim < 0.0 && !rolls_back
        });
        self.against = if against { self.against + step } else { 0.0 };
        let reason = if self.stall >= STALL_TIME {
            Some((Reason::Stall, (torque.abs(), STALL_TORQUE)))
        } else if self.against >= AGAINST_TIME {
            Some((Reason::EncoderReversed, (rim.unwrap_or(0.0), AGAINST_SPEED)))
        } else {
            None
        };
        match reason {
            Some((reason, values)) => {
                if self.through > 0.5 {
                    pending.push(Action::ShedTorque, reason, Some(index), values);
                }
                self.through = SHED;
            }
            None => self.through = (self.through + step / RETURN_TIME).min(1.0),
        }
    }
}
