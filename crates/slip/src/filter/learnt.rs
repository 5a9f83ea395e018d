//! What the filter has learnt of sensors and soil, as plain numbers that outlast a restart.

use super::steps::{Core, reset};
use crate::error::{Result, check_range};
use crate::motion::{FORCE_BIAS, MAX_LOG_SLIP, SLIP, TURN_BIAS};
use crate::speed::Measured;

/// A restored variance is at least this: the robot may have stood for long in between.
const MIN_VARIANCE: f64 = 1e-12;
/// Limits of a bias, rad/s and m/s²: a larger one is a broken sensor, which nothing is learnt of.
const MAX_GYRO_BIAS_RAD_PER_S: f64 = 0.5;
const MAX_ACCELEROMETER_BIAS_M_PER_S2: f64 = 5.0;
const OF: &str = "learnt";
const VARIANCE: (f64, f64) = (0.0, 1e6);

/// What [`SlipFilter::learnt`](super::SlipFilter::learnt) saves and
/// [`SlipFilter::restore`](super::SlipFilter::restore) restores. What is `None` keeps its prior.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Learnt {
    /// Bias of the gyro, rad/s; `None` where it is beyond what a sound gyro has.
    pub gyro_bias: Option<Measured>,
    /// Bias of the accelerometer forwards, m/s²; `None` where it is beyond what a sound one has.
    pub accelerometer_bias: Option<Measured>,
    /// The powered wheels' common logarithmic slip −ln(1 − s), which the soil causes.
    pub log_slip: Option<Measured>,
}

/// Number of the state, name, limit and unit of each of them.
const NUMBERS: [(usize, &str, f64, &str); 3] = [
    (TURN_BIAS, "gyro_bias", MAX_GYRO_BIAS_RAD_PER_S, "rad/s"),
    (
        FORCE_BIAS,
        "accelerometer_bias",
        MAX_ACCELEROMETER_BIAS_M_PER_S2,
        "m/s²",
    ),
    (SLIP, "log_slip", MAX_LOG_SLIP, "1"),
];

impl Learnt {
    const fn numbers(&self) -> [Option<Measured>; 3] {
        [self.gyro_bias, self.accelerometer_bias, self.log_slip]
    }
}

impl Core {
    /// What has been learnt so far.
    pub(super) fn learnt(&self) -> Learnt {
        let belief = self.filter().belief();
        let [gyro_bias, accelerometer_bias, log_slip] = NUMBERS.map(|(index, _, limit, _)| {
            let known = Measured {
                value: belief.mean[index],
                variance: belief.covariance[index][index],
            };
            (known.value.abs() <= limit).then_some(known)
        });
        Learnt {
            gyro_bias,
            accelerometer_bias,
            log_slip,
        }
    }

    /// Sets the belief to what was learnt before a restart.
    pub(super) fn restore(&mut self, learnt: &Learnt) -> Result<()> {
        for ((_, field, limit, unit), known) in NUMBERS.iter().zip(learnt.numbers()) {
            let Some(known) = known else { continue };
            check_range(OF, field, known.value, (-limit, *limit), unit)?;
            check_range(OF, "variance", known.variance, VARIANCE, "1")?;
        }
        for ((index, ..), known) in NUMBERS.iter().zip(learnt.numbers()) {
            if let Some(known) = known {
                let variance = known.variance.max(MIN_VARIANCE);
                self.change(|belief| reset(belief, *index, known.value, variance));
            }
        }
        Ok(())
    }
}
