//! A robot on one soil and one slope: the slip that holds it, the energy per metre, and the reserve of pull.

use grouser_real::Real;
use grouser_real::{Dual, Scalar};
use grouser_terra::slope::{HeldSlip, greatest_surplus, held_slip};
use grouser_terra::{Kinematics, Slip, WheelOnSoil};

use crate::quantity::{Inputs, NoValue};

/// Wheels that are alike and carry alike.
pub(super) struct Axle<'a, R> {
    pub(super) inputs: Inputs<R>,
    /// What the inputs describe, without derivatives.
    pub(super) wheel_on_soil: &'a WheelOnSoil,
    /// What each of them carries, N.
    pub(super) load: R,
    /// How many there are.
    pub(super) count: f64,
    /// The friction of the bearing of a free wheel, N m; `None`: powered.
    pub(super) bearing: Option<f64>,
}

/// A robot on its slope.
pub(super) struct Station<'a, R> {
    pub(super) axles: &'a [Axle<'a, R>],
    /// W sin α, N.
    pub(super) required: R,
    pub(super) max_slip: f64,
}

/// What a station gives.
#[derive(Clone, Copy, Debug)]
pub(super) struct StationState<R> {
    /// The slip that holds the slope; where none does, that of the greatest pull.
    pub(super) slip: R,
    /// Energy at the wheels per metre, J/m.
    pub(super) energy: R,
    /// The greatest pull up to the greatest slip, less what the slope takes, N.
    pub(super) reserve: R,
    /// The greatest sinkage of a wheel, m.
    pub(super) sinkage: f64,
    pub(super) is_held: bool,
}

impl<R: Scalar> Axle<'_, R> {
    /// The skid of a free wheel with derivatives: torque = −bearing friction.
    fn skid(&self, bearing: f64) -> Result<R, NoValue> {
        let load = self.load.value();
        let Some(skid) = self.wheel_on_soil.free_slip(load, bearing)? else {
            // a wheel that cannot turn is dragged, locked
            return Ok(R::from_f64(-1.0));
        };
        let skid = skid.value();
        let torque = self
            .inputs
            .loaded_on(self.wheel_on_soil, R::from_f64(skid), self.load)?
            .forces
            .torque;
        let rising = self
            .inputs
            .plain()
            .lifted::<Dual<1>>()
            .loaded_on(
                self.wheel_on_soil,
                Dual::variable(skid, 0),
                Dual::constant(load),
            )?
            .forces
            .torque
            .gradient[0];
        let off = torque - R::from_f64(torque.value());
        Ok(R::from_f64(skid) - off / R::from_f64(rising))
    }

    /// The pull of one wheel in plain numbers; `None` where it is not carried.
    fn plain_pull(&self, slip: f64) -> Result<Option<f64>, NoValue> {
        let motion = Kinematics::straight(Slip::new(slip)?);
        let solved = self.wheel_on_soil.under_load(self.load.value(), &motion)?;
        Ok(solved.point().map(|point| point.forces.drawbar_pull))
    }
}

/// Pull and energy of all wheels.
struct Sum<R> {
    pull: R,
    energy: R,
    sinkage: f64,
}

impl<R: Scalar> Station<'_, R> {
    pub(super) fn state(&self) -> Result<StationState<R>, NoValue> {
        // Wheels that have left the ground neither pull nor resist.
        let grounded = || self.axles.iter().filter(|axle| axle.load.value() > 0.0);
        let mut free = Vec::new();
        for axle in grounded() {
            if let Some(bearing) = axle.bearing {
                free.push((axle, axle.skid(bearing)?));
            }
        }
        let powered: Vec<&Axle<'_, R>> = grounded().filter(|axle| axle.bearing.is_none()).collect();
        let mut dragged = 0.0;
        for (axle, skid) in &free {
            let Some(pull) = axle.plain_pull(skid.value())? else {
                return Err(NoValue::NotCarried(axle.load.value()));
            };
            dragged += axle.count * pull;
        }
        let required = self.required.value() - dragged;
        let surplus = |slip: f64| -> Result<Option<f64>, NoValue> {
            let mut sum = -required;
            for axle in &powered {
                match axle.plain_pull(slip)? {
                    Some(pull) => sum += axle.count * pull,
                    None => return Ok(None),
                }
            }
            Ok(Some(sum))
        };
        let Some((best_slip, _)) = greatest_surplus(self.max_slip, surplus)? else {
            return Err(NoValue::Undefined("a wheel is not carried at any slip"));
        };
        let sum_at = |slip: R| -> Result<Sum<R>, NoValue> {
            let mut sum = Sum {
                pull: R::ZERO,
                energy: R::ZERO,
                sinkage: 0.0,
            };
            let own = powered.iter().map(|axle| (*axle, slip));
            for (axle, slip) in own.chain(free.iter().copied()) {
                let point = axle.inputs.loaded_on(axle.wheel_on_soil, slip, axle.load)?;
                let count = R::from_f64(axle.count);
                sum.pull += count * point.forces.drawbar_pull;
                let depth = point.radius.value() * (1.0 - Real::cos(point.theta_1.value()));
                sum.sinkage = sum.sinkage.max(depth);
                if axle.bearing.is_none() {
                    let q = point.speed_ratio();
                    sum.energy += count * point.forces.torque / (q * point.radius);
                }
            }
            Ok(sum)
        };
        let best = sum_at(R::from_f64(best_slip))?;
        let reserve = best.pull - self.required;
        let HeldSlip::Holds(demand) = held_slip(self.max_slip, surplus)? else {
            return Ok(StationState {
                slip: R::from_f64(best_slip),
                energy: best.energy,
                reserve,
                sinkage: best.sinkage,
                is_held: false,
            });
        };
        // pull(s, p) = required(p): the slip's derivatives follow from those of the pull.
        let mut slip = R::from_f64(demand);
        let off = sum_at(slip)?.pull - self.required;
        let mut rising = 0.0;
        for axle in &powered {
            let single = axle.inputs.plain().lifted::<Dual<1>>();
            let load = Dual::constant(axle.load.value());
            let point = single.loaded_on(axle.wheel_on_soil, Dual::variable(demand, 0), load)?;
            rising += axle.count * point.forces.drawbar_pull.gradient[0];
        }
        if !(rising > 0.0) {
            return Err(NoValue::Undefined(
                "the pull does not grow with slip where it holds the slope",
            ));
        }
        slip -= off / R::from_f64(rising);
        let here = sum_at(slip)?;
        Ok(StationState {
            slip,
            energy: here.energy,
            reserve,
            sinkage: here.sinkage,
            is_held: true,
        })
    }
}
