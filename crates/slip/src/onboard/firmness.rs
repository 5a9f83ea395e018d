//! How firm the ground under a wheel is beside the known soil: by the torque that it takes at its slip.

use alloc::{boxed::Box, vec::Vec};

use super::soil_tables::{TORQUE_POINTS, TorqueTable};

/// Below this slip the torque hardly depends on the soil.
const MIN_SLIP: f64 = 0.08;
/// Where the known soil would take less than this share of the motor's greatest torque, the current's noise hides it.
const MIN_TORQUE_SHARE: f64 = 0.02;
/// Firmness is smoothed over this time, s: half of the time in which soft ground is called.
const TIME_CONSTANT_S: f64 = 0.15;

#[derive(Clone, Copy, Debug)]
struct Wheel {
    expected: TorqueTable,
    max_torque: f64,
    /// Torque over the expected one, smoothed.
    ratio: Option<f64>,
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
            })
        });
        Self {
            wheels: wheels.collect::<Vec<_>>().into_boxed_slice(),
        }
    }

    /// Firmness of the ground under a wheel that takes `torque` (N m) at `slip`, `step` (s) after the last one, where the soil
    /// takes `torque_ratio` times the torque of the known one.
    pub(super) fn update(
        &mut self,
        wheel: usize,
        torque: Option<f64>,
        (slip, torque_ratio): (Option<f64>, f64),
        step: f64,
    ) -> Option<f64> {
        let own = self.wheels.get_mut(wheel)?.as_mut()?;
        let ratio = own.ratio_now(torque, slip, torque_ratio).map(|now| {
            let before = own.ratio.unwrap_or(1.0);
            before + step / (TIME_CONSTANT_S + step) * (now - before)
        });
        own.ratio = ratio;
        ratio
    }
}

impl Wheel {
    fn ratio_now(&self, torque: Option<f64>, slip: Option<f64>, torque_ratio: f64) -> Option<f64> {
        let (torque, slip) = (torque.filter(|torque| torque.is_finite())?, slip?);
        let expected = torque_ratio * self.expected_at(slip);
        let tells = slip >= MIN_SLIP && expected >= MIN_TORQUE_SHARE * self.max_torque;
        tells.then(|| torque.abs() / expected)
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
