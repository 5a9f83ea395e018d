//! Is a wheel's radius what was told? Slip rises from zero with torque: what is left of it at no torque is the radius's error.

use crate::body::Observations;
use crate::speed::Measured;

/// Slips beyond this are left out: there they rise otherwise than these laws.
const MOST_SLIP: f64 = 0.25;
/// How far a slip scatters about its law.
const SCATTER: f64 = 0.03;
/// One reading in so many is independent.
const LASTING: f64 = 6.0;
/// An error less certain than this is not known.
const KNOWN: f64 = 0.04;

/// Slip over torque of one wheel: s = e + a T + b T |T|.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Radius {
    seen: Observations,
    torque: f64,
    readings: f64,
}

impl Radius {
    /// Takes a torque, N m.
    pub(super) fn push(&mut self, torque: f64) {
        self.torque += torque;
        self.readings += 1.0;
    }

    /// Takes a slip with its sigma over the time of the torques since the last one; `None` where there is none worth it.
    pub(super) fn take(&mut self, slip: Option<Measured>) {
        let (sum, count) = (self.torque, self.readings);
        (self.torque, self.readings) = (0.0, 0.0);
        let Some(slip) = slip.filter(|slip| slip.value.abs() <= MOST_SLIP) else {
            return;
        };
        if count == 0.0 {
            return;
        }
        let torque = sum / count;
        let variance = LASTING * (slip.variance + SCATTER * SCATTER);
        let row = [1.0, torque, torque * torque.abs()];
        self.seen.add(row, Measured { variance, ..slip });
    }

    /// By what share the radius is told too large, with what is not known of the free wheel's skid, `reference`, in it; `None`
    /// where torque has not changed enough to tell.
    pub(super) fn excess(&self, reference: f64) -> Option<Measured> {
        let found = self.seen.solve()?;
        let known = Measured {
            value: found.velocity[0],
            variance: found.covariance[0][0] + reference,
        };
        (known.sigma() <= KNOWN).then_some(known)
    }
}
