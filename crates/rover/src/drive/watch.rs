//! The estimator in the loop, behind what the loop needs of it.

use grouser_slip::control::WheelSeen;
use grouser_slip::{Drive, Estimator, Health, MeasuredSlip, Reference, Robot, Sample};
use grouser_terra::{Settings, Soil, WheelOnSoil};

use crate::error::{Error, Result};
use crate::robot::RobotModel;

/// The estimator of a robot.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    estimator: Estimator,
    robot: Robot,
    window: f64,
    faults: u64,
}

impl Watch {
    /// An estimator that knows the soil on which its free wheel rolls: with the skid s_f of a free wheel
    /// under its load, v = r ω/(1 + s_f) (section 7 of the model), so that its radius counts as r/(1 + s_f).
    pub(super) fn new(model: &RobotModel, loads: &[f64], soil: &Soil) -> Result<Self> {
        let mut wheels = model.robot.wheels().to_vec();
        if model.settings.reference == Reference::FreeWheel {
            for (index, wheel) in wheels.iter_mut().enumerate() {
                if wheel.drive != Drive::Free {
                    continue;
                }
                let of = |source| Error::Law {
                    of: format!("wheel \"{}\"", wheel.name),
                    source,
                };
                let mount = &model.wheels[index];
                let pair = WheelOnSoil::new(mount.wheel, *soil, Settings::default()).map_err(of)?;
                let skid = pair
                    .free_slip(loads[index].max(0.0), mount.bearing)
                    .map_err(of)?;
                if let Some(skid) = skid.filter(|s| s.value() > -0.5) {
                    wheel.radius /= 1.0 + skid.value();
                }
            }
        }
        let robot = Robot::new(model.robot.name().to_owned(), wheels)?;
        Ok(Self {
            estimator: Estimator::new(&robot, model.settings)?,
            robot,
            window: model.settings.window,
            faults: 0,
        })
    }

    /// Length of the window that estimates are means of, s.
    pub(super) const fn window(&self) -> f64 {
        self.window
    }

    pub(super) fn take(&mut self, sample: Sample) {
        if self.estimator.update(sample).is_err() {
            self.faults += 1;
        }
    }

    /// Samples that it refused.
    pub(super) const fn refused(&self) -> u64 {
        self.faults
    }

    /// Forward speed of the robot, m/s.
    pub(super) fn speed(&self) -> Option<f64> {
        let estimate = self.estimator.latest()?;
        let fresh = estimate.wheels.iter().any(|wheel| {
            !matches!(wheel.health, Health::Invalid(_) | Health::Uninitialised)
                && wheel.forward_speed.is_some()
        });
        let motion = estimate.body.motion?;
        fresh.then_some(motion.velocity[0])
    }

    /// Fills in what it knows of the wheels. A steered wheel's slip is along its heading now: its centre's speed comes
    /// from the robot's motion, its rim's from its own encoder.
    pub(super) fn look(&self, steers: impl Iterator<Item = f64>, seen: &mut [WheelSeen]) {
        let Some(estimate) = self.estimator.latest() else {
            return;
        };
        let described = self.robot.wheels();
        for (((wheel, seen), steer), own) in
            estimate.wheels.iter().zip(seen).zip(steers).zip(described)
        {
            seen.slip = wheel.slip.map(grouser_slip::Slip::value);
            seen.sigma = wheel.sigma;
            seen.health = wheel.health;
            seen.motion = wheel.motion;
            seen.forward_speed = wheel.forward_speed.map(|speed| speed.value);
            seen.rim_speed = wheel.rim_speed.map(|speed| speed.value);
            if let (Some(motion), Some(rim), true) = (
                estimate.body.motion,
                wheel.rim_speed,
                steer != 0.0 && wheel.slip.is_some(),
            ) {
                let (sin, cos) = (own.heading.rad() + steer).sin_cos();
                let row = [cos, sin, sin * own.x - cos * own.y];
                let forward = motion.along(row);
                let measured = MeasuredSlip::from_speeds(forward, rim, self.estimator.settings());
                seen.slip = measured.slip.map(grouser_slip::Slip::value);
                seen.sigma = measured.sigma;
                seen.motion = Some(measured.motion);
                seen.forward_speed = Some(forward.value);
            }
        }
    }
}
