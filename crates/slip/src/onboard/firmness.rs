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
        let known_before = own.usual_time >= MIN_USUAL_TIME_S;
        let multiple = match compared {
            Compared::Soil(multiple) => multiple,
            Compared::Before if known_before => own.usual.min(1.0),
            Compared::Before => 1.0,
        };
        let now = own.ratio_now(torque, slip, multiple);
        if let Some(now) = now {
            own.usual_time = (own.usual_time + step).min(USUAL_TIME_S);
            if own.usual_time > 0.0 {
                own.usual += step / own.usual_time * (now - own.usual);
            }
        }
        let now = now.filter(|_| known_before || compared != Compared::Before);
        let now = now.map(|now| now / multiple).filter(|now| now.is_finite());
        let ratio = now.map(|now| {
            let before = own.ratio.unwrap_or(1.0);
            before + step / (TIME_CONSTANT_S + step) * (now - before)
        });
        own.ratio = ratio;
        ratio
    }
}

impl Wheel {
    /// Torque over that of the known soil, where a soil that takes `multiple` times as much shows in it.
    fn ratio_now(&self, torque: Option<f64>, slip: Option<f64>, multiple: f64) -> Option<f64> {
        let (torque, slip) = (torque.filter(|torque| torque.is_finite())?, slip?);
        let expected = self.expected_at(slip);
        let is_informative =
            slip >= MIN_SLIP && multiple * expected >= MIN_TORQUE_SHARE * self.max_torque;
        is_informative.then(|| torque.abs() / expected)
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
