//! What the filter has learnt of sensors, soil and wheels, as plain numbers that outlast a restart.

use super::MAX_FILTER_WHEELS;
use super::estimator::Core;
use super::motion_model::{COMMON_SLIP, FORWARD_BIAS, GYRO_BIAS, LEFT_BIAS, own_slip, radius};
use super::settings::SlipPrior;
use crate::error::{Result, check_range};
use crate::speed::Measured;

/// A restored variance is at least this: the robot may have stood for long in between.
const MIN_VARIANCE: f64 = 1e-12;
/// Limits of a restored bias, rad/s and m/s²: a larger one is a broken sensor.
const MAX_GYRO_BIAS_RAD_PER_S: f64 = 0.5;
const MAX_ACCELEROMETER_BIAS_M_PER_S2: f64 = 5.0;
/// Limit of a restored error of a radius, as a share.
const MAX_RADIUS_EXCESS: f64 = 0.2;

/// What was learnt of one wheel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct LearntWheel {
    /// Slip of a free wheel: its skid. `None` for a powered one.
    pub free_slip: Option<SlipPrior>,
    /// The share by which the described radius is too large; `None` where torques have not changed enough.
    pub radius_excess: Option<Measured>,
}

/// What [`SlipFilter::learnt`](super::SlipFilter::learnt) saves and
/// [`SlipFilter::restore`](super::SlipFilter::restore) restores.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Learnt {
    /// Bias of the gyro, rad/s.
    pub gyro_bias: Measured,
    /// Bias of the accelerometer forwards and to the left, m/s².
    pub accelerometer_bias: [Measured; 2],
    /// The powered wheels' common slip, which the soil causes.
    pub common_slip: Measured,
    /// The wheels, in the robot's order.
    pub wheels: [LearntWheel; MAX_FILTER_WHEELS],
}

impl Core {
    /// What has been learnt so far.
    pub(super) fn learnt(&self) -> Learnt {
        let known = |i: usize| Measured {
            value: self.state.mean(i),
            variance: self.state.covariance(i, i),
        };
        let mut wheels = [LearntWheel::default(); MAX_FILTER_WHEELS];
        for (index, (wheel, slot)) in self.wheels.iter().zip(&mut wheels).enumerate() {
            slot.radius_excess = self.output.checks[index].radius_excess;
            slot.free_slip = wheel.free.then(|| {
                let slip = own_slip(index);
                SlipPrior {
                    mean: self.state.mean(slip),
                    sigma: self.state.sigma(slip),
                }
                .by_faster()
            });
        }
        Learnt {
            gyro_bias: known(GYRO_BIAS),
            accelerometer_bias: [FORWARD_BIAS, LEFT_BIAS].map(known),
            common_slip: known(COMMON_SLIP),
            wheels,
        }
    }

    /// Sets the state to what was learnt before a restart.
    pub(super) fn restore(&mut self, learnt: &Learnt) -> Result<()> {
        learnt.check()?;
        let states = [
            (GYRO_BIAS, learnt.gyro_bias),
            (FORWARD_BIAS, learnt.accelerometer_bias[0]),
            (LEFT_BIAS, learnt.accelerometer_bias[1]),
            (COMMON_SLIP, learnt.common_slip),
        ];
        for (i, known) in states {
            let variance = known.variance.max(MIN_VARIANCE);
            self.state.reset(i, known.value, variance);
        }
        for (index, wheel) in learnt
            .wheels
            .iter()
            .enumerate()
            .take(self.wheels.channels.len())
        {
            if let Some(skid) = wheel.free_slip.filter(|_| self.wheels.channels[index].free) {
                let skid = skid.by_rim();
                let variance = (skid.sigma * skid.sigma).max(MIN_VARIANCE);
                self.state.reset(own_slip(index), skid.mean, variance);
            }
            if let Some(excess) = wheel.radius_excess {
                let variance = excess.variance.max(MIN_VARIANCE);
                self.state.reset(radius(index), -excess.value, variance);
            }
        }
        Ok(())
    }
}

impl Learnt {
    fn check(&self) -> Result<()> {
        let of = "learnt";
        let within = |field, known: Measured, most: f64, unit| {
            check_range(of, field, known.value, (-most, most), unit)?;
            check_range(of, "variance", known.variance, (0.0, 1e6), "1")
        };
        let gyro = MAX_GYRO_BIAS_RAD_PER_S;
        within("gyro_bias", self.gyro_bias, gyro, "rad/s")?;
        for bias in self.accelerometer_bias {
            let most = MAX_ACCELEROMETER_BIAS_M_PER_S2;
            within("accelerometer_bias", bias, most, "m/s²")?;
        }
        within("common_slip", self.common_slip, 1.0, "1")?;
        for wheel in &self.wheels {
            if let Some(skid) = wheel.free_slip {
                check_range(of, "free_slip mean", skid.mean, (-0.95, 0.95), "1")?;
                check_range(of, "free_slip sigma", skid.sigma, (0.0, 10.0), "1")?;
            }
            if let Some(excess) = wheel.radius_excess {
                within("radius_excess", excess, MAX_RADIUS_EXCESS, "1")?;
            }
        }
        Ok(())
    }
}
