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

#[cfg(test)]
mod tests {
    use super::*;

    /// s = 0.05 + 0.02 T + 0.01 T |T| at symmetric torques, which leave its first part independent of the others.
    const TORQUES_N_M: [f64; 5] = [-2.0, -1.0, 0.0, 1.0, 2.0];
    const RADIUS_EXCESS_SHARE: f64 = 0.05;

    fn after(variance: f64) -> RadiusCheck {
        let mut check = RadiusCheck::default();
        for torque in TORQUES_N_M {
            // a mean of three, or one
            let offs = if torque < 0.0 {
                &[-0.5, 0.75, -0.25][..]
            } else {
                &[0.0]
            };
            for off in offs {
                check.push(torque + off);
            }
            let value = RADIUS_EXCESS_SHARE + 0.02 * torque + 0.01 * torque * torque.abs();
            check.update(Some(Measured { value, variance }));
        }
        check
    }

    #[test]
    fn the_slip_at_no_torque_is_the_excess_of_the_radius() {
        const SLIP_VARIANCE: f64 = 1e-5;
        const SKID_VARIANCE: f64 = 2e-4;
        // one of six slips is independent; 0.03 about the law
        let expected = 6.0 * (SLIP_VARIANCE + 0.0009) / 5.0;
        let mut check = after(SLIP_VARIANCE);
        for reference in [0.0, SKID_VARIANCE] {
            let found = check.excess(reference).unwrap();
            assert!((found.value - RADIUS_EXCESS_SHARE).abs() < 1e-9);
            assert!((found.variance - expected - reference).abs() < 1e-9);
        }
        // not known to 0.04
        assert!(check.excess(1.58e-3 - expected).is_some());
        assert_eq!(check.excess(1.62e-3 - expected), None);
        assert_eq!(RadiusCheck::default().excess(0.0), None);
        // without a torque, without a slip, and with one that is too large; the torques until then are gone
        let found = check.excess(0.0);
        let slip = |value: f64| {
            Some(Measured {
                value,
                variance: SLIP_VARIANCE,
            })
        };
        check.update(slip(0.2));
        check.push(2.0);
        check.update(None);
        check.push(2.0);
        check.update(slip(0.26));
        check.push(-2.0);
        check.update(slip(-0.26));
        check.update(slip(0.2));
        assert_eq!(check.excess(0.0), found);
        check.push(2.0);
        check.update(slip(0.25));
        assert!(check.excess(0.0).unwrap().value > RADIUS_EXCESS_SHARE);
    }
}
