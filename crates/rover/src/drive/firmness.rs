//! How firm the ground under a wheel is beside the soil that is known: by the torque that it takes at its slip.

use grouser_terra::{Kinematics, Settings, Slip, Soil, WheelOnSoil};

use crate::error::{Error, Result};
use crate::robot::RobotModel;

/// Points of a table, over slips from 0 to 1.
const POINTS: usize = 21;
/// Below this slip a wheel takes hardly any torque that would tell.
const LEAST_SLIP: f64 = 0.08;
/// A torque that soil of this name would not even take this share of the greatest one tells nothing.
const LEAST_TORQUE: f64 = 0.02;
/// Torques are smoothed over this, s.
const SMOOTHING: f64 = 0.15;

/// One wheel's torque on the known soil under its load, over its slip; and what it takes.
#[derive(Clone, Debug)]
struct Wheel {
    expected: [f64; POINTS],
    most: f64,
    ratio: Option<f64>,
}

/// Every wheel's firmness.
#[derive(Clone, Debug)]
pub(super) struct Firmness {
    wheels: Vec<Option<Wheel>>,
}

impl Firmness {
    /// For the wheels of a robot under `loads` (N) on `soil`.
    pub(super) fn new(model: &RobotModel, loads: &[f64], soil: &Soil) -> Result<Self> {
        let mut wheels = Vec::new();
        for (mount, load) in model.wheels.iter().zip(loads) {
            let Some(motor) = &mount.motor else {
                wheels.push(None);
                continue;
            };
            let of = |source| Error::Law {
                of: format!("wheel \"{}\"", mount.name),
                source,
            };
            let pair = WheelOnSoil::new(mount.wheel, *soil, Settings::default()).map_err(of)?;
            let mut expected = [0.0; POINTS];
            for (index, slot) in expected.iter_mut().enumerate() {
                let slip = index as f64 / (POINTS - 1) as f64;
                let found = Slip::new(slip)
                    .and_then(|slip| pair.under_load(load.max(0.1), &Kinematics::straight(slip)))
                    .map_err(of)?;
                *slot = found.point().map_or(0.0, |point| point.forces.torque);
            }
            wheels.push(Some(Wheel {
                expected,
                most: motor.most_torque(),
                ratio: None,
            }));
        }
        Ok(Self { wheels })
    }

    /// `step` s later a wheel takes `torque` (N m) at `slip`.
    pub(super) fn take(
        &mut self,
        wheel: usize,
        torque: Option<f64>,
        slip: Option<f64>,
        step: f64,
    ) -> Option<f64> {
        let own = self.wheels.get_mut(wheel)?.as_mut()?;
        let (Some(torque), Some(slip)) = (torque.filter(|t| t.is_finite()), slip) else {
            own.ratio = None;
            return None;
        };
        let expected = own.at(slip);
        if slip < LEAST_SLIP || expected < LEAST_TORQUE * own.most {
            own.ratio = None;
            return None;
        }
        let now = torque.abs() / expected;
        let share = step / (SMOOTHING + step);
        let before = own.ratio.unwrap_or(1.0);
        own.ratio = Some(before + share * (now - before));
        own.ratio
    }
}

impl Wheel {
    fn at(&self, slip: f64) -> f64 {
        let place = slip.clamp(0.0, 1.0) * (POINTS - 1) as f64;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the slip was held in [0, 1]"
        )]
        let low = (place as usize).min(POINTS - 2);
        let share = place - low as f64;
        self.expected[low] + share * (self.expected[low + 1] - self.expected[low])
    }
}
