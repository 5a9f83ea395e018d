//! What the filter has learnt of sensors, soil and wheels, as plain numbers that outlast a restart.

use super::MAX_FILTER_WHEELS;
use super::estimator::Core;
use super::motion_model::{COMMON_SLIP, FORWARD_BIAS, GYRO_BIAS, LEFT_BIAS, own_slip, radius};
use super::settings::SlipPrior;
use crate::error::{Result, check_range};
use crate::speed::Measured;

/// A restored variance is at least this: the robot may have stood for long in between.
const MIN_VARIANCE: f64 = 1e-12;
/// Limits of a bias, rad/s and m/s²: a larger one is a broken sensor, which nothing is learnt of.
const MAX_GYRO_BIAS_RAD_PER_S: f64 = 0.5;
const MAX_ACCELEROMETER_BIAS_M_PER_S2: f64 = 5.0;
/// Limit of the error of a radius, as a share.
const MAX_RADIUS_EXCESS: f64 = 0.2;
const MAX_COMMON_SLIP: f64 = 1.0;
const FREE_SLIP: (f64, f64) = (-0.95, 0.95);
const FREE_SLIP_SIGMA: (f64, f64) = (0.0, 10.0);
const OF: &str = "learnt";
const VARIANCE: (f64, f64) = (0.0, 1e6);

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
/// [`SlipFilter::restore`](super::SlipFilter::restore) restores. What is `None` keeps its prior.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Learnt {
    /// Bias of the gyro, rad/s; `None` where it is beyond what a sound gyro has.
    pub gyro_bias: Option<Measured>,
    /// Bias of the accelerometer forwards and to the left, m/s²; `None` where it is beyond what a sound one has.
    pub accelerometer_bias: [Option<Measured>; 2],
    /// The powered wheels' common slip, which the soil causes.
    pub common_slip: Option<Measured>,
    /// The wheels, in the robot's order.
    pub wheels: [LearntWheel; MAX_FILTER_WHEELS],
}

impl Core {
    /// What has been learnt so far.
    pub(super) fn learnt(&self) -> Learnt {
        let known = |i: usize, most: f64| {
            let known = Measured {
                value: self.state.mean(i),
                variance: self.state.covariance(i, i),
            };
            within(known, most)
        };
        let mut wheels = [LearntWheel::default(); MAX_FILTER_WHEELS];
        for (index, (wheel, slot)) in self.wheels.iter().zip(&mut wheels).enumerate() {
            let excess = self.output.checks[index].radius_excess;
            slot.radius_excess = excess.and_then(|excess| within(excess, MAX_RADIUS_EXCESS));
            let slip = own_slip(index);
            let skid = SlipPrior {
                mean: self.state.mean(slip),
                sigma: self.state.sigma(slip),
            }
            .by_faster();
            let is_legal = check_skid(skid).is_ok();
            slot.free_slip = (wheel.free && is_legal).then_some(skid);
        }
        Learnt {
            gyro_bias: known(GYRO_BIAS, MAX_GYRO_BIAS_RAD_PER_S),
            accelerometer_bias: [FORWARD_BIAS, LEFT_BIAS]
                .map(|i| known(i, MAX_ACCELEROMETER_BIAS_M_PER_S2)),
            common_slip: known(COMMON_SLIP, MAX_COMMON_SLIP),
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
            let Some(known) = known else { continue };
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
                let skid = skid.by_wheel();
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

/// What may be restored; `None` for the rest.
fn within(known: Measured, most: f64) -> Option<Measured> {
    check("", known, most, "").is_ok().then_some(known)
}

fn check(field: &'static str, known: Measured, most: f64, unit: &'static str) -> Result<()> {
    check_range(OF, field, known.value, (-most, most), unit)?;
    check_range(OF, "variance", known.variance, VARIANCE, "1")
}

fn check_skid(skid: SlipPrior) -> Result<()> {
    check_range(OF, "free_slip mean", skid.mean, FREE_SLIP, "1")?;
    check_range(OF, "free_slip sigma", skid.sigma, FREE_SLIP_SIGMA, "1")
}

impl Learnt {
    fn check(&self) -> Result<()> {
        if let Some(bias) = self.gyro_bias {
            check("gyro_bias", bias, MAX_GYRO_BIAS_RAD_PER_S, "rad/s")?;
        }
        for bias in self.accelerometer_bias.into_iter().flatten() {
            let most = MAX_ACCELEROMETER_BIAS_M_PER_S2;
            check("accelerometer_bias", bias, most, "m/s²")?;
        }
        if let Some(slip) = self.common_slip {
            check("common_slip", slip, MAX_COMMON_SLIP, "1")?;
        }
        for wheel in &self.wheels {
            if let Some(skid) = wheel.free_slip {
                check_skid(skid)?;
            }
            if let Some(excess) = wheel.radius_excess {
                check("radius_excess", excess, MAX_RADIUS_EXCESS, "1")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
