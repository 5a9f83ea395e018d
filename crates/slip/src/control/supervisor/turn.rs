//! A turn onto the course: where it begins and where it has ended.

/// Headings that differ by less than this count as reached, rad: 20°, at which the robot still travels by 94 % along it.
pub(super) const ON_COURSE_RAD: f64 = 0.35;
/// A turn that began further off ends here, rad: 6°. A robot that turns by the speeds of its rims slips for it, and rims
/// that are held for their slip turn it no further.
const TURNED_RAD: f64 = 0.1;
/// A turn may take this long before it is given up, s: 180° at a third of the greatest default rate. What keeps a robot less
/// than 20° off its course for longer is no turn.
pub(super) const MAX_TURN_TIME_S: f64 = 12.0;

/// Does the robot turn onto its course?
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Turn {
    is_on: bool,
    /// Since it was last further off than [`ON_COURSE_RAD`], s.
    end_time: f64,
}

impl Turn {
    pub(super) const fn is_on(&self) -> bool {
        self.is_on
    }

    /// One step with a heading that is `error` (rad) off its setpoint.
    pub(super) fn update(&mut self, error: f64, step: f64) {
        if error.abs() >= ON_COURSE_RAD {
            (self.is_on, self.end_time) = (true, 0.0);
        } else {
            self.end_time += step;
            self.is_on &= error.abs() > TURNED_RAD && self.end_time < MAX_TURN_TIME_S;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_begins_at_20_degrees_and_ends_at_6_or_after_its_time() {
        let mut turn = Turn::default();
        let mut after = |degrees: f64, step: f64| {
            turn.update(degrees.to_radians(), step);
            turn.is_on()
        };
        assert!(!after(19.0, 1.0) && !after(-19.0, 1.0) && !after(7.0, 1.0));
        assert!(after(21.0, 1.0) && after(12.0, 1.0) && after(-6.0, 1.0));
        assert!(!after(5.0, 1.0) && !after(12.0, 1.0));
        assert!(after(-90.0, 60.0) && after(-19.0, 11.9) && !after(-19.0, 0.2));
        // further off it begins anew
        assert!(!after(19.0, 9.0) && after(-21.0, 1.0) && after(12.0, 11.9) && !after(12.0, 0.2));
    }

    #[test]
    fn limits_can_be_met() {
        let mut turn = Turn::default();
        turn.update(ON_COURSE_RAD.next_down(), 0.0);
        assert!(!turn.is_on());
        turn.update(-ON_COURSE_RAD, 0.0);
        turn.update(TURNED_RAD.next_up(), MAX_TURN_TIME_S.next_down());
        assert!(turn.is_on());
        turn.update(TURNED_RAD, 0.0);
        assert!(!turn.is_on());
        turn.update(1.0, 0.0);
        turn.update(0.2, MAX_TURN_TIME_S);
        assert!(!turn.is_on());
    }
}
