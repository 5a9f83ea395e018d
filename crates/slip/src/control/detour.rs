//! Ground that is softer than the soil that is known: found by its slip, left backwards, passed on one side.

use super::helm::Seen;
use super::settings::ControlSettings;
use crate::filter::SlipPrior;

/// Slip is smoothed over this before it is held against what is demanded, s.
const SMOOTHING: f64 = 0.2;
/// How far a slip must stand above what is demanded, in sigma of that.
const SURE: f64 = 2.0;
/// Left and right wheels' slips that differ by more than this tell on which side the ground is softer.
const LEAN: f64 = 0.015;
/// A slip above this share of that room tells that it has been entered.
const ENTERED: f64 = 0.4;
/// No ground that takes less slip than this share of the optimum is soft.
const LEAST: f64 = 0.5;
/// It is no further into soft ground than this, m.
const MOST_INTO: f64 = 3.0;
/// Heading of a detour beside the asked one, what each try adds, and its end, rad.
const ROUND: f64 = 1.2;
const MORE: f64 = 0.3;
const MOST_ROUND: f64 = 2.1;

/// What is known of soft ground ahead.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Detour {
    slip: f64,
    lean: f64,
    /// How long the slip has stood above what is demanded, s, and by how much.
    over_time: f64,
    /// How long a wheel has taken much less torque than it would on the known soil, s; and how much.
    soft_time: f64,
    firmness: f64,
    over: f64,
    /// How far it has gone since the slip was last what is demanded, m.
    into: f64,
    /// +1 to the left, −1 to the right, 0 not chosen yet.
    side: f64,
    tries: u32,
    /// How far aside it has gone, m.
    aside: f64,
}

impl Detour {
    /// Looks at the slip; `counts` where it says something of the ground.
    pub(super) fn watch(
        &mut self,
        settings: &ControlSettings,
        seen: &Seen,
        counts: bool,
        step: f64,
    ) {
        let share = step / (SMOOTHING + step);
        if let Some(slip) = seen.slip {
            self.slip += share * (slip - self.slip);
            self.lean += share * (seen.lean - self.lean);
        }
        let beyond = |demanded: SlipPrior, share: f64| {
            let room = (SURE * demanded.sigma).max(settings.soft_slip);
            let least = LEAST * settings.optimum;
            self.slip - (demanded.mean + share * room).max(least)
        };
        self.over = seen.demanded.map_or(0.0, |demanded| beyond(demanded, 1.0));
        let entered = seen
            .demanded
            .is_some_and(|demanded| beyond(demanded, ENTERED) > 0.0);
        if counts {
            let moved = step * seen.speed.unwrap_or(0.0).abs();
            self.into = if entered { self.into + moved } else { 0.0 };
        }
        self.soft_time = if counts && seen.firmness < settings.soft_firmness {
            self.soft_time + step
        } else {
            (self.soft_time - step).max(0.0)
        };
        self.firmness = seen.firmness;
        self.over_time = if counts && self.over > 0.0 {
            self.over_time + step
        } else {
            0.0
        };
    }

    /// Is the ground soft?
    pub(super) fn is_soft(&self, settings: &ControlSettings) -> bool {
        self.over_time >= settings.soft_time || self.soft_time >= settings.soft_time
    }

    /// How far to go back until all wheels stand on the ground that is known, m.
    pub(super) fn back(&mut self, settings: &ControlSettings) -> f64 {
        let into = core::mem::take(&mut self.into);
        settings.soft_back + into.min(MOST_INTO)
    }

    /// Heading beside the asked one, rad: away more and more with every try.
    pub(super) fn angle(&self) -> f64 {
        self.side * (ROUND + MORE * f64::from(self.tries.max(1) - 1)).min(MOST_ROUND)
    }

    /// The slip that told it and what it stood above, or the firmness and what it fell below.
    pub(super) fn values(&self, settings: &ControlSettings) -> (f64, f64) {
        if self.soft_time >= settings.soft_time {
            (self.firmness, settings.soft_firmness)
        } else {
            (self.slip, self.slip - self.over)
        }
    }

    /// One more try: chooses a side; gives how many there were.
    pub(super) fn choose(&mut self) -> u32 {
        self.tries += 1;
        self.over_time = 0.0;
        self.soft_time = 0.0;
        self.aside = 0.0;
        if self.side == 0.0 {
            // away from the wheels that slip more
            self.side = if self.lean > LEAN { -1.0 } else { 1.0 };
        }
        self.tries
    }

    /// How far it is to go aside, m: further with every try.
    pub(super) fn across(&self, settings: &ControlSettings) -> f64 {
        settings.soft_across * (0.5 + 0.5 * f64::from(self.tries.max(1)))
    }

    /// Moves aside at that speed (m/s) for `step` s; gives how far it has come.
    pub(super) fn go(&mut self, speed: f64, step: f64) -> f64 {
        self.aside += self.side * speed * step;
        self.aside
    }

    /// The soft ground lies behind.
    pub(super) fn forget(&mut self) {
        self.tries = 0;
        self.side = 0.0;
    }
}
