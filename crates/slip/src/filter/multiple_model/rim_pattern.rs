//! Rims that begin to run against one another, as in a turn on the spot, slip anew.

/// Rims slower than this do not turn, m/s.
pub(in crate::filter) const TURNING_SPEED_M_PER_S: f64 = 0.01;
/// Rims run apart where their slip together may reach this: one of them runs against their mean at a third of it. That a skid-steered
/// robot does on a slope, at 0.9 of it (`just random-drives 69 1`), and one in a bend does not.
const MIN_APART_SLIP: f64 = 1.3;
/// Just below the greatest slip that is allowed to rims that run apart: at that the mean hardly runs, and its slip means
/// nothing. Without this errors of a robot that stops in a bend are 0.05 in place of 0.005 (`just random-logs 731 1`).
const MAX_APART_SLIP: f64 = 4.9;
/// Rims that run apart for longer than this turn the robot on the spot, s. Where it stops in a bend they run apart for a
/// moment only: for two readings of that log.
const MIN_TURN_S: f64 = 0.5;

/// What a step of the rims changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Change {
    /// They begin or end to run apart.
    pub(super) parts: bool,
    /// A turn on the spot begins or ends.
    pub(super) turns: bool,
}

/// How the rims run together.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RimPattern {
    apart: bool,
    /// How long they have run apart, s.
    apart_s: f64,
    turns: bool,
}

impl RimPattern {
    /// One step of `dt` (s) of rims whose mean runs at `speed` (m/s) and may slip by `max_slip`.
    pub(super) fn update(&mut self, speed: f64, max_slip: f64, dt: f64) -> Change {
        let apart = max_slip > MIN_APART_SLIP && max_slip < MAX_APART_SLIP;
        self.apart_s = if apart { self.apart_s + dt } else { 0.0 };
        if speed.abs() <= TURNING_SPEED_M_PER_S {
            return Change::default();
        }
        let turns = self.apart_s > MIN_TURN_S;
        Change {
            parts: core::mem::replace(&mut self.apart, apart) != apart,
            turns: core::mem::replace(&mut self.turns, turns) != turns,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Change, MAX_APART_SLIP, MIN_APART_SLIP, RimPattern};

    #[test]
    fn rims_that_part_slip_anew_and_turn_the_robot_after_half_a_second() {
        let mut pattern = RimPattern::default();
        let mut step = |speed, max_slip| {
            let Change { parts, turns } = pattern.update(speed, max_slip, 0.25);
            (parts, turns)
        };
        assert_eq!(step(0.3, 1.0), (false, false));
        assert_eq!(step(0.3, MIN_APART_SLIP), (false, false));
        // rims that stand show nothing
        assert_eq!(step(0.01, 2.0), (false, false));
        assert_eq!(step(0.3, 1.0), (false, false));
        assert_eq!(step(-0.3, 1.31), (true, false));
        assert_eq!(step(-0.3, 2.0), (false, false));
        assert_eq!(step(-0.3, 4.89), (false, true));
        assert_eq!(step(-0.3, 2.0), (false, false));
        // a mean that vanishes among them has no slip
        assert_eq!(step(-0.02, MAX_APART_SLIP), (true, true));
        // the time apart begins anew
        assert_eq!(step(-0.3, 2.0), (true, false));
        assert_eq!(step(-0.3, 2.0), (false, false));
        assert_eq!(step(-0.3, 2.0), (false, true));
    }
}
