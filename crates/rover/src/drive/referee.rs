//! The referee: knows the truth, counts the progress, and ends a drive that goes nowhere.

use grouser_real::Real;

use super::outcome::Outcome;
use super::scenario::Leg;
use crate::vector::Vector;

/// A robot that travels less than this share of the requested way in `STUCK_TIME_S` is immobilised.
const STUCK_TIME_S: f64 = 15.0;
const STUCK_SHARE: f64 = 0.02;
/// Tilt at which a robot has fallen over, rad: 69°.
const MAX_TILT_RAD: f64 = 1.2;

/// Where on its way the robot is.
#[derive(Clone, Debug)]
pub(super) struct Referee {
    legs: Vec<Leg>,
    leg: usize,
    /// Time and place at the beginning of the leg.
    since: (f64, Vector),
    /// Progress of the legs that are done, m.
    done: f64,
    /// Where the robot was when it was last seen to move.
    anchor: (f64, Vector),
    way: f64,
    last: Vector,
    progress: f64,
}

impl Referee {
    pub(super) fn new(legs: Vec<Leg>, place: Vector) -> Self {
        Self {
            legs,
            leg: 0,
            since: (0.0, place),
            done: 0.0,
            anchor: (0.0, place),
            way: 0.0,
            last: place,
            progress: 0.0,
        }
    }

    pub(super) fn leg(&self) -> Option<&Leg> {
        self.legs.get(self.leg)
    }

    /// Progress along all legs, m.
    pub(super) const fn distance(&self) -> f64 {
        self.done + self.progress
    }

    /// Length of the way, m.
    pub(super) const fn way(&self) -> f64 {
        self.way
    }

    /// Observes the drive; returns its end if this is it.
    pub(super) fn look(&mut self, time: f64, place: Vector, tilt: f64) -> Option<Outcome> {
        self.way += (place - self.last).length();
        self.last = place;
        if tilt > MAX_TILT_RAD {
            return Some(Outcome::Tipped);
        }
        let Some(leg) = self.legs.get(self.leg) else {
            return Some(Outcome::Arrived);
        };
        let (sin, cos) = Real::sin_cos(leg.heading);
        let sense = if leg.speed < 0.0 { -1.0 } else { 1.0 };
        let from = place - self.since.1;
        // along the ground: a slope's metres are longer than the map's
        let flat = sense * (cos * from.x + sin * from.y);
        self.progress = if flat > 0.0 {
            Real::hypot(flat, from.z)
        } else {
            flat
        };
        let over = leg.distance.is_some_and(|d| self.progress >= d)
            || leg.duration.is_some_and(|t| time - self.since.0 >= t);
        if over {
            self.done += self.progress;
            self.progress = 0.0;
            self.leg += 1;
            self.since = (time, place);
            self.anchor = (time, place);
            return (self.leg == self.legs.len()).then_some(Outcome::Arrived);
        }
        let requested = leg.speed.abs();
        let moved = (place - self.anchor.1).length();
        if requested == 0.0 || moved > STUCK_SHARE * STUCK_TIME_S * requested {
            self.anchor = (time, place);
        } else if time - self.anchor.0 > STUCK_TIME_S {
            return Some(Outcome::Immobilised);
        }
        None
    }
}
