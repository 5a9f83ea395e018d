//! Angles of wheels that a driver wraps to one turn, put together again.

use std::f64::consts::TAU;

use grouser_slip::{Measurement, Sample};

/// A wrapped angle may exceed its turn by this, rad: it is rounded, or sent with single precision.
const ROUNDING_RAD: f64 = 0.01;
/// Between −π and π a jump shows a wrap if the wheel would else turn by less than this, rad. No wheel that counts on from 0
/// jumps so far in there.
const SMALL_STEP_RAD: f64 = 0.5;
/// Between 0 and a turn by less than this, rad: a wheel that counts on may go nearly once round in its first step.
const TINY_STEP_RAD: f64 = 0.05;

/// The angle of one joint.
///
/// A jump of more than half a turn is a wrap if all angles so far are within one turn (−π to π, or 0 to 2π) and the step
/// without it continues the one before. After the first wrap every such jump is one, until an angle leaves the turn. So is
/// a jump of several turns from one end of them to the other (−2π to 2π, say).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Angle {
    last: Option<f64>,
    /// The last step that was none of 0, rad.
    step: f64,
    least: f64,
    most: f64,
    /// What is added, rad.
    turns: f64,
    /// The whole turns within which it is kept, rad; 0 before its first wrap.
    period: f64,
}

impl Angle {
    /// One that no angle of whole turns wraps: the way of a rim, m.
    const WAY: Self = Self {
        last: None,
        step: 0.0,
        least: f64::NEG_INFINITY,
        most: f64::INFINITY,
        turns: 0.0,
        period: 0.0,
    };

    /// Takes an angle, rad, and returns the one that counts on.
    pub(crate) fn unwrapped(&mut self, angle: f64) -> f64 {
        if !angle.is_finite() {
            return angle;
        }
        // 0 is within every turn
        (self.least, self.most) = (self.least.min(angle), self.most.max(angle));
        let step = angle - self.last.replace(angle).unwrap_or(angle);
        let jump = (step.abs() / TAU).round().max(1.0) * TAU;
        let period = if self.period > 0.0 { self.period } else { jump };
        let is_about_zero = self.most.max(-self.least) <= 0.5 * period + ROUNDING_RAD;
        let is_within = is_about_zero || self.most - self.least <= period + ROUNDING_RAD;
        if is_within && step.abs() > 0.5 * period {
            let short = step - period.copysign(step);
            if self.period > 0.0 || self.is_wrap(short, period, is_about_zero, angle - step) {
                self.period = period;
                self.turns += short - step;
                self.step = short;
            }
        } else if step != 0.0 {
            self.step = step;
        }
        angle + self.turns
    }

    /// Is a first jump from `last` a wrap, which leaves a step of `short`? Of several turns it must cross the end of them.
    fn is_wrap(&self, short: f64, period: f64, is_about_zero: bool, last: f64) -> bool {
        let continues =
            short * self.step > 0.0 && short.abs() < 2.0 * self.step.abs() + SMALL_STEP_RAD;
        if period > TAU {
            let middle = if is_about_zero {
                0.0
            } else {
                (0.5 * period).copysign(self.most + self.least)
            };
            let is_crossed = (last + short - middle).abs() >= 0.5 * period - ROUNDING_RAD;
            return continues && is_crossed;
        }
        continues
            || short.abs()
                < if is_about_zero {
                    SMALL_STEP_RAD
                } else {
                    TINY_STEP_RAD
                }
    }

    /// Did it ever wrap?
    pub(crate) const fn wraps(&self) -> bool {
        self.period > 0.0
    }
}

/// The angles of all wheels.
#[derive(Clone, Debug, Default)]
pub(crate) struct Angles(Vec<Angle>);

impl Angles {
    /// Of all wheels of a log, of which it is known whether they are read as ways.
    pub(crate) fn new(are_ways: impl Iterator<Item = bool>) -> Self {
        let of = |is_way| if is_way { Angle::WAY } else { Angle::default() };
        Self(are_ways.map(of).collect())
    }

    /// Puts a wheel's angle together; other samples stay as they are.
    pub(crate) fn unwrap(&mut self, sample: &mut Sample) {
        if let Measurement::WheelAngle { wheel, angle } = &mut sample.measurement
            && let Some(own) = self.0.get_mut(*wheel)
        {
            *angle = own.unwrapped(*angle);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// The greatest error of angles that a driver sends by `wrap`, against those that it wraps, less whole turns at the
    /// start.
    fn error(angles: &[f64], wrap: impl Fn(f64) -> f64) -> f64 {
        let mut own = Angle::default();
        let mut offset = None;
        let mut worst: f64 = 0.0;
        for angle in angles {
            let found = own.unwrapped(wrap(*angle)) - angle;
            worst = worst.max((found - *offset.get_or_insert(found)).abs());
        }
        worst
    }

    fn drive(step: f64) -> Vec<f64> {
        let mut angle = 0.4;
        let mut all = vec![angle; 3];
        for (share, rows) in [(0.3, 4), (1.0, 60), (0.0, 5), (-1.0, 130), (0.2, 20)] {
            for _ in 0..rows {
                angle += share * step;
                all.push(angle);
            }
        }
        all
    }

    #[test]
    fn wrapped_angles_count_on() {
        for step in [0.003, 0.1, 1.0, 1.2] {
            let angles = drive(step);
            assert!(
                error(&angles, |a| (a + PI).rem_euclid(TAU) - PI) < 1e-9,
                "{step}"
            );
            assert!(error(&angles, |a| a.rem_euclid(TAU)) < 1e-9, "{step}");
        }
        for turns in [2.0, 3.0, 10.0] {
            let period = turns * TAU;
            for step in [0.1, 1.0, 2.5] {
                let of = |angles: &[f64]| {
                    let half = error(angles, |a| {
                        (a + 0.5 * period).rem_euclid(period) - 0.5 * period
                    });
                    half.max(error(angles, |a| a.rem_euclid(period)))
                };
                let many: Vec<f64> = (0..2000).map(|row| 0.4 + step * f64::from(row)).collect();
                let back: Vec<f64> = many.iter().rev().map(|angle| angle - 2.8).collect();
                assert!(of(&many) < 1e-9 && of(&back) < 1e-9, "{turns} {step}");
            }
        }
        // at rest where it wraps
        let shaking: Vec<f64> = (0..20).map(|k| PI + 0.001 * f64::from(k % 3 - 1)).collect();
        assert!(error(&shaking, |a| (a + PI).rem_euclid(TAU) - PI) < 1e-9);
        let shaking: Vec<f64> = shaking.iter().map(|a| a - PI).collect();
        assert!(error(&shaking, |a| a.rem_euclid(TAU)) < 1e-9);
    }

    #[test]
    fn angles_that_count_on_stay_as_they_are() {
        // from slow to a whole turn and more a row, forwards and backwards, from 0 or elsewhere
        for step in [0.01, 1.0, 3.0, 3.5, 4.0, 5.0, 6.0, 6.2, 6.4, 9.0] {
            for start in [0.0, 1.0, 2.9, 17.0] {
                for sign in [1.0, -1.0] {
                    let angles = drive(sign * step);
                    assert!(
                        error(&angles, |a| a - 0.4 + start) < 1e-9,
                        "{step} {start} {sign}"
                    );
                }
            }
        }
        let mut own = Angle::default();
        own.unwrapped(1.0);
        assert!(own.unwrapped(f64::NAN).is_nan());
        assert_eq!(own.unwrapped(1.5), 1.5);
        assert!(!own.wraps());
    }

    /// The last of angles as it is put together, and what a driver sent.
    fn last(angles: &[f64]) -> (f64, f64) {
        let mut own = Angle::default();
        let all = angles.iter().map(|angle| own.unwrapped(*angle));
        (all.last().unwrap(), *angles.last().unwrap())
    }

    fn is_wrapped(angles: &[f64]) -> bool {
        let (found, sent) = last(angles);
        let turns = (found - sent) / TAU;
        assert!(turns.abs() < 1e-12 || (turns.abs() - 1.0).abs() < 1e-12);
        turns.abs() > 0.5
    }

    #[test]
    fn a_jump_shows_a_wrap_within_its_limits() {
        // of −π to π and a hundredth more, by less than half a radian
        let (most, jump) = (PI + ROUNDING_RAD, TAU - 0.3);
        let beyond = most.next_up();
        assert!(is_wrapped(&[most, most - jump]) && is_wrapped(&[-most, jump - most]));
        assert!(!is_wrapped(&[beyond, beyond - jump]) && !is_wrapped(&[-beyond, jump - beyond]));
        assert!(!is_wrapped(&[3.0, 3.0 + SMALL_STEP_RAD - TAU]));
        assert!(is_wrapped(&[3.0, 3.0 + SMALL_STEP_RAD - TAU - 1e-12]));
        // of 0 to a turn and a hundredth more
        let most = TAU + ROUNDING_RAD;
        assert!(is_wrapped(&[0.0, most]) && is_wrapped(&[most, 0.0]));
        assert!(!is_wrapped(&[0.0, most.next_up()]));
        // half a turn is as well one backwards
        assert!(!is_wrapped(&[2.0, 0.0, PI]));
        assert!(is_wrapped(&[2.0, 0.0, PI.next_up()]));
    }

    #[test]
    fn a_jump_that_continues_the_step_before_is_a_wrap() {
        let jump = |before: f64, short: f64| is_wrapped(&[6.0 - before, 6.0, 6.0 + short - TAU]);
        // up to twice the step, and half a radian
        assert!(jump(0.25, 0.9) && !jump(0.25, 1.0) && jump(0.3, 1.0));
        // not backwards, nor without a step before
        assert!(!jump(-0.25, 0.9) && !jump(0.0, 0.3));
        assert!(!is_wrapped(&[6.0, 6.3 - TAU]));
    }
}
