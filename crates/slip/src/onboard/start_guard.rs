//! The check of the sensors before the first command and over the first metres.

use grouser_terra::Angle;

use super::settings::StartPolicy;
use crate::fault::Fault;
use crate::filter::FilterOutput;
use crate::sample::Sample;
use crate::start::{Progress, StartCheck, check_gravity};
use grouser_terra::EARTH_GRAVITY_M_PER_S2;

/// Watches the start of a drive.
#[derive(Clone, Debug)]
pub(super) struct StartGuard {
    policy: StartPolicy,
    check: StartCheck,
    steepest: Angle,
    /// Factor from the local to standard gravity, which the check expects.
    gravity_scale: f64,
    /// Sum of the specific forces during warm-up, and their number.
    force: [f64; 3],
    count: f64,
    is_upright: bool,
    is_done: bool,
    fault: Option<Fault>,
}

impl StartGuard {
    pub(super) fn new(policy: StartPolicy, check: StartCheck, max_tilt: f64, gravity: f64) -> Self {
        Self {
            policy,
            check,
            steepest: Angle::from_rad(max_tilt),
            gravity_scale: EARTH_GRAVITY_M_PER_S2 / gravity,
            force: [0.0; 3],
            count: 0.0,
            is_upright: false,
            is_done: matches!(policy, StartPolicy::Off),
            fault: None,
        }
    }

    /// A specific force of the warm-up, m/s².
    pub(super) fn add_force(&mut self, force: [f64; 3]) {
        if force.iter().all(|part| part.is_finite()) {
            for (sum, part) in self.force.iter_mut().zip(force) {
                *sum += self.gravity_scale * part;
            }
            self.count += 1.0;
        }
    }

    /// The warm-up is over: gravity is where it should be, or not. Without an inertial unit there is nothing to check.
    pub(super) fn end_warm_up(&mut self) {
        if self.is_done || self.is_upright {
            return;
        }
        self.is_upright = true;
        if self.count > 0.0 {
            let mean = self.force.map(|sum| sum / self.count);
            self.fault = check_gravity(mean, self.steepest).err();
        }
    }

    /// Is it not decided yet whether the sensors are plausible?
    pub(super) const fn is_looking(&self) -> bool {
        !self.is_done && self.fault.is_none()
    }

    /// A sample, and the filter's output after it.
    pub(super) fn update(&mut self, sample: &Sample, output: &FilterOutput<'_>) {
        if !self.is_looking() {
            return;
        }
        match self.check.take(sample, output) {
            Ok(Progress::Plausible) => self.is_done = true,
            Ok(Progress::Looking) => {}
            Err(fault) => self.fault = Some(fault),
        }
    }

    pub(super) const fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// May the robot drive?
    pub(super) fn allows_driving(&self) -> bool {
        let is_refused = self.fault.is_some() || !self.is_upright;
        !(is_refused && self.policy == StartPolicy::Refuse)
    }
}
