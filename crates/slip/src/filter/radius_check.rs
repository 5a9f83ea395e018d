//! The error of a wheel's radius: slip rises from zero with torque, so that the slip left at no torque is the radius's error.

use crate::body::Observations;
use crate::speed::Measured;

/// Larger slips are left out: they rise more steeply with torque than s = e + a T + b T |T|.
const MAX_SLIP: f64 = 0.25;
/// Standard deviation of a slip about that law.
const LAW_SIGMA: f64 = 0.03;
/// One slip in this many is independent of the ones before: the filter's slips change slowly against 10 Hz.
const CORRELATED_READINGS: f64 = 6.0;
/// An error with a larger standard deviation is not reported.
const MAX_ERROR_SIGMA: f64 = 0.04;

/// Slip over torque of one wheel: s = e + a T + b T |T|.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RadiusCheck {
    observations: Observations,
    torque: f64,
    readings: f64,
}

impl RadiusCheck {
    /// Adds a torque, N m.
    pub(super) fn push(&mut self, torque: f64) {
        self.torque += torque;
        self.readings += 1.0;
    }

    /// Adds a slip over the time of the torques since the last one; `None` where there is none that counts.
    pub(super) fn update(&mut self, slip: Option<Measured>) {
        let (sum, count) = (self.torque, self.readings);
        (self.torque, self.readings) = (0.0, 0.0);
        let Some(slip) = slip.filter(|slip| slip.value.abs() <= MAX_SLIP) else {
            return;
        };
        if count == 0.0 {
            return;
        }
        let torque = sum / count;
        let variance = CORRELATED_READINGS * (slip.variance + LAW_SIGMA * LAW_SIGMA);
        let row = [1.0, torque, torque * torque.abs()];
        self.observations.add(row, Measured { variance, ..slip });
    }

    /// The share by which the described radius is too large, with the variance `reference` of the free wheel's skid in it;
    /// `None` where torque has not changed enough.
    pub(super) fn excess(&self, reference: f64) -> Option<Measured> {
        let found = self.observations.solve()?;
        let known = Measured {
            value: found.velocity[0],
            variance: found.covariance[0][0] + reference,
        };
        (known.sigma() <= MAX_ERROR_SIGMA).then_some(known)
    }
}
