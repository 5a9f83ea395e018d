//! How firm the ground under a wheel is beside the known soil: by the torque that it takes at its slip.
//!
//! While a robot has not learnt its soil yet, the ground that it has driven on stands for it: the known soil may be a wrong
//! one, but ground that suddenly takes much less torque than before is softer.

use alloc::{boxed::Box, vec::Vec};

use super::soil_tables::{TORQUE_POINTS, TorqueTable};

/// Below this slip the torque hardly depends on the soil.
const MIN_SLIP: f64 = 0.08;
/// Where the known soil would take less than this share of the motor's greatest torque, the current's noise hides it.
const MIN_TORQUE_SHARE: f64 = 0.02;
/// Firmness is smoothed over this time, s: half of the time in which soft ground is called.
const TIME_CONSTANT_S: f64 = 0.15;

/// The torque that the ground has taken is a mean over this time, s: ten times that in which soft ground is called.
const USUAL_TIME_S: f64 = 3.0;
/// It is compared with once it was measured for so long, s.
const MIN_USUAL_TIME_S: f64 = 1.0;

/// What the torque of a wheel is compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Compared {
    /// A soil that takes this multiple of the known one's torque.
    Soil(f64),
    /// The ground before.
    Before,
}

#[derive(Clone, Copy, Debug)]
struct Wheel {
    expected: TorqueTable,
    max_torque: f64,
    /// Torque over the expected one, smoothed.
    ratio: Option<f64>,
    /// Mean of torque over that of the known soil, and for how long it was measured, s.
    usual: f64,
    usual_time: f64,
}

/// Every wheel's firmness.
#[derive(Clone, Debug)]
pub(super) struct Firmness {
    wheels: Box<[Option<Wheel>]>,
}

impl Firmness {
    /// For wheels with these torque tables and greatest torques (N m).
    pub(super) fn new(tables: &[Option<TorqueTable>], max_torques: &[Option<f64>]) -> Self {
        let wheels = max_torques.iter().enumerate().map(|(index, max_torque)| {
            Some(Wheel {
                expected: tables.get(index).copied().flatten()?,
                max_torque: (*max_torque)?,
                ratio: None,
                usual: 1.0,
                usual_time: 0.0,
            })
        });
        Self {
            wheels: wheels.collect::<Vec<_>>().into_boxed_slice(),
        }
    }

    /// Firmness of the ground under a wheel that takes `torque` (N m) at `slip`, `step` (s) after the last one.
    pub(super) fn update(
        &mut self,
        wheel: usize,
        (torque, slip): (Option<f64>, Option<f64>),
        compared: Compared,
        step: f64,
    ) -> Option<f64> {
        let own = self.wheels.get_mut(wheel)?.as_mut()?;
        let measured = own.over_known(torque, slip);
        let multiple = match compared {
            Compared::Soil(multiple) => Some(multiple),
            Compared::Before => own.usual(measured.map(|(now, _)| now), step),
        };
        let now = measured
            .zip(multiple)
            .and_then(|((now, expected), multiple)| {
                let is_informative = multiple * expected >= MIN_TORQUE_SHARE * own.max_torque;
                let now = is_informative.then_some(now / multiple);
                now.filter(|now| now.is_finite())
            });
        own.ratio = now.map(|now| {
            let before = own.ratio.unwrap_or(1.0);
            before + step / (TIME_CONSTANT_S + step) * (now - before)
        });
        own.ratio
    }
}

impl Wheel {
    /// Torque over that of the known soil, and the latter (N m), where the soil shows in it.
    fn over_known(&self, torque: Option<f64>, slip: Option<f64>) -> Option<(f64, f64)> {
        let (torque, slip) = (torque?, slip?);
        let expected = self.expected_at(slip);
        let now = torque.abs() / expected;
        let is_informative =
            slip >= MIN_SLIP && expected >= MIN_TORQUE_SHARE * self.max_torque && now.is_finite();
        is_informative.then_some((now, expected))
    }

    /// The multiple of the known soil's torque that the ground has taken before, at most 1, which then goes on with what
    /// it takes `now`. Ground that takes hardly any torque enters too, so that it does not stay the usual one for ever.
    fn usual(&mut self, now: Option<f64>, step: f64) -> Option<f64> {
        let before = (self.usual_time >= MIN_USUAL_TIME_S).then(|| self.usual.min(1.0));
        if let Some(now) = now {
            self.usual_time = (self.usual_time + step).min(USUAL_TIME_S);
            if self.usual_time > 0.0 {
                self.usual += step / self.usual_time * (now - self.usual);
            }
        }
        before
    }

    fn expected_at(&self, slip: f64) -> f64 {
        let place = slip.clamp(0.0, 1.0) * (TORQUE_POINTS - 1) as f64;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the slip is held in [0, 1]"
        )]
        let low = (place as usize).min(TORQUE_POINTS - 2);
        let share = place - low as f64;
        self.expected[low] + share * (self.expected[low + 1] - self.expected[low])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps whose sums are exact.
    const STEP_S: f64 = 1.0 / 128.0;

    /// 1 N m at slip 0 and 5 N m at 1, steeper at first; the motor has 60 N m.
    fn expected(slip: f64) -> f64 {
        1.0 + 4.0 * slip.sqrt()
    }

    fn wheel() -> Firmness {
        let table = core::array::from_fn(|i| expected(i as f64 / (TORQUE_POINTS - 1) as f64));
        Firmness::new(&[None, Some(table)], &[Some(60.0), Some(60.0)])
    }

    #[test]
    fn torque_over_the_expected_one_is_smoothed() {
        let mut firmness = wheel();
        let soil = |multiple| Compared::Soil(multiple);
        for (multiple, slip) in [(1.0, 0.25), (0.8, 0.65), (1.0, 1.0), (1.0, 3.0)] {
            let mut firmness = wheel();
            let torque = Some(-0.5 * expected(f64::min(slip, 1.0)));
            for count in 1..40 {
                let found = firmness.update(1, (torque, Some(slip)), soil(multiple), STEP_S);
                let kept = (TIME_CONSTANT_S / (TIME_CONSTANT_S + STEP_S)).powi(count);
                let now = 0.5 / multiple;
                assert!((found.unwrap() - (now + kept * (1.0 - now))).abs() < 1e-12);
            }
        }
        // between two points of the table the torque is linear
        let between = 0.5 * (expected(0.30) + expected(0.35));
        let found = firmness.update(1, (Some(between), Some(0.325)), soil(1.0), STEP_S);
        assert!((found.unwrap() - 1.0).abs() < 1e-12);
        // the smoothed ratio begins again at 1 where a reading says nothing
        for (torque, slip, multiple) in [
            (None, Some(0.3), 1.0),
            (Some(f64::NAN), Some(0.3), 1.0),
            (Some(1.0), None, 1.0),
            (Some(1.0), Some(0.079), 1.0),
            // 0.02 of 60 N m is 1.2 N m
            (Some(1.0), Some(0.25), 0.39),
        ] {
            assert_eq!(
                firmness.update(1, (torque, slip), soil(multiple), STEP_S),
                None
            );
        }
        let found = firmness.update(1, (Some(0.0), Some(0.25)), soil(0.41), STEP_S);
        let kept = TIME_CONSTANT_S / (TIME_CONSTANT_S + STEP_S);
        assert!((found.unwrap() - kept).abs() < 1e-12);
        let at_least = firmness.update(1, (Some(1.0), Some(MIN_SLIP)), soil(1.0), STEP_S);
        assert!(at_least.is_some());
        // 0.02 of 60 N m itself
        let mut at_limit = Firmness::new(&[Some([1.2; TORQUE_POINTS])], &[Some(60.0)]);
        let found = at_limit.update(0, (Some(1.0), Some(0.25)), soil(1.0), STEP_S);
        assert!(found.is_some());
        for without in [0, 2] {
            let found = firmness.update(without, (Some(1.0), Some(0.3)), soil(1.0), STEP_S);
            assert_eq!(found, None);
        }
    }

    #[test]
    fn before_a_soil_is_learnt_the_ground_before_is_what_it_is_compared_with() {
        for usual in [0.5, 1.5] {
            let mut firmness = wheel();
            let slip = Some(1.0);
            // a first tick has no length
            let torque = (Some(9.0), slip);
            assert_eq!(firmness.update(1, torque, Compared::Before, 0.0), None);
            let mut update = |ratio: f64| {
                let torque = Some(ratio * expected(1.0));
                firmness.update(1, (torque, slip), Compared::Before, STEP_S)
            };
            for _ in 0..128 {
                assert_eq!(update(usual), None, "a second is not long enough");
            }
            // where the ground took more than the known soil, that is the measure
            let mut smoothed = 1.0;
            let mut mean = usual;
            for count in 128..1200 {
                let ratio = if count < 512 { usual } else { 0.3 };
                let now = ratio / f64::min(mean, 1.0);
                smoothed += STEP_S / (TIME_CONSTANT_S + STEP_S) * (now - smoothed);
                let found = update(ratio).unwrap();
                assert!(
                    (found - smoothed).abs() < 1e-9,
                    "{count}: {found} {smoothed}"
                );
                let measured = f64::min(STEP_S * f64::from(count + 1), USUAL_TIME_S);
                mean += STEP_S / measured * (ratio - mean);
            }
            assert!(
                mean < 0.5 || usual > 1.0 && mean < 0.8,
                "soft ground becomes the usual one: {mean}"
            );
        }
    }

    #[test]
    fn a_first_second_without_torque_is_forgotten() {
        for ratio in [0.0, 0.1] {
            let mut firmness = wheel();
            let mut update = |ratio: f64| {
                let load = (Some(ratio * expected(1.0)), Some(1.0));
                firmness.update(1, load, Compared::Before, STEP_S)
            };
            // 0.02 of 60 N m over 5 N m: below, what the ground took before is hidden by the current's noise
            let least = 0.24;
            let (mut mean, mut found) = (ratio, None);
            for count in 1..=160 {
                assert_eq!(update(ratio), None, "{count}");
            }
            for count in 161..=2000 {
                found = update(1.0);
                assert_eq!(found.is_some(), mean >= least, "{count}: {mean}");
                let measured = f64::min(STEP_S * f64::from(count), USUAL_TIME_S);
                mean += STEP_S / measured * (1.0 - mean);
            }
            assert!((found.unwrap() - 1.0).abs() < 0.01, "{found:?}");
            // soft ground, for as long as it takes to be called
            for _ in 0..40 {
                found = update(0.3);
            }
            assert!(found.unwrap() < 0.5, "{found:?}");
        }
    }

    #[test]
    fn torque_that_the_noise_hides_is_no_usual_one() {
        // the known soil takes 0.9 N m at slip 0.1, less than 0.02 of 60 N m, and 9 N m at slip 1
        let table = core::array::from_fn(|i| 9.0 * i as f64 / (TORQUE_POINTS - 1) as f64);
        let mut firmness = Firmness::new(&[Some(table)], &[Some(60.0)]);
        let mut update = |torque: f64, slip: f64| {
            firmness.update(0, (Some(torque), Some(slip)), Compared::Before, STEP_S)
        };
        assert!((0..500).all(|_| update(0.1, 0.1).is_none()));
        assert!((0..128).all(|_| update(9.0, 1.0).is_none()));
        let found = update(9.0, 1.0).unwrap();
        assert!((found - 1.0).abs() < 1e-12, "{found}");
    }
}
