//! A robot on one soil and one slope: the slip that holds it, the energy per metre, and the reserve of pull.

use grouser_real::Real;
use grouser_real::{Dual, Scalar};
use grouser_terra::{Kinematics, Slip, WheelOnSoil};

use crate::quantity::{Inputs, NoValue};

/// Slips between 0 and the greatest at which the pull is sampled.
const SAMPLES: u32 = 12;

/// Slips are found to this.
const SLIP_PRECISION: f64 = 1e-13;

/// The slip of the greatest pull is found to this: the pull is flat there, so that it is exact to the square.
const BEST_SLIP_PRECISION: f64 = 1e-7;

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
    /// The least slip that holds the slope; where none does, that of the greatest pull.
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
            return Err(NoValue::Undefined("the soil does not turn a free wheel"));
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
        let pull = |slip: f64| -> Result<Option<f64>, NoValue> {
            let mut sum = 0.0;
            for axle in &powered {
                match axle.plain_pull(slip)? {
                    Some(pull) => sum += axle.count * pull,
                    None => return Ok(None),
                }
            }
            Ok(Some(sum))
        };
        let found = search(pull, required, self.max_slip)?;
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
        let best = sum_at(R::from_f64(found.best_slip))?;
        let reserve = best.pull - self.required;
        let Some(demand) = found.demand else {
            return Ok(StationState {
                slip: R::from_f64(found.best_slip),
                energy: best.energy,
                reserve,
                sinkage: best.sinkage,
                is_held: false,
            });
        };
        let mut slip = R::from_f64(demand);
        if demand > 0.0 {
            // pull(s, p) = required(p): the slip's derivatives follow from those of the pull.
            let off = sum_at(slip)?.pull - self.required;
            let mut rising = 0.0;
            for axle in &powered {
                let single = axle.inputs.plain().lifted::<Dual<1>>();
                let load = Dual::constant(axle.load.value());
                let point =
                    single.loaded_on(axle.wheel_on_soil, Dual::variable(demand, 0), load)?;
                rising += axle.count * point.forces.drawbar_pull.gradient[0];
            }
            if !(rising > 0.0) {
                return Err(NoValue::Undefined(
                    "the pull does not grow with slip where it holds the slope",
                ));
            }
            slip -= off / R::from_f64(rising);
        }
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

/// Where a curve of pull reaches a level, and where it is greatest.
struct Found {
    demand: Option<f64>,
    best_slip: f64,
}

/// The least slip in [0, `max_slip`] at which `pull` is `required`, and the slip of its greatest value.
fn search(
    pull: impl Fn(f64) -> Result<Option<f64>, NoValue>,
    required: f64,
    max_slip: f64,
) -> Result<Found, NoValue> {
    let step = max_slip / f64::from(SAMPLES);
    let mut samples: Vec<(f64, f64)> = Vec::new();
    for sample in 0..=SAMPLES {
        let slip = step * f64::from(sample);
        if let Some(now) = pull(slip)? {
            samples.push((slip, now));
        }
    }
    let Some(&(mut best_slip, mut best)) = samples.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return Err(NoValue::Undefined("a wheel is not carried at any slip"));
    };
    let value = |slip: f64| Ok::<f64, NoValue>(pull(slip)?.unwrap_or(f64::NEG_INFINITY));
    // A pull that still rises at the greatest slip has its maximum there.
    let at_end = best_slip >= max_slip - 0.5 * step;
    if !(at_end && value(max_slip - 1e-4 * step)? <= best) {
        let low = (best_slip - step).max(0.0);
        let high = (best_slip + step).min(max_slip);
        let (slip, greatest) = golden(&value, low, high)?;
        if greatest > best {
            (best_slip, best) = (slip, greatest);
        }
    }
    if samples.iter().all(|sample| sample.1 < required) && best >= required {
        let place = samples.partition_point(|sample| sample.0 < best_slip);
        samples.insert(place, (best_slip, best));
    }
    let demand = match samples.iter().position(|sample| sample.1 >= required) {
        None => None,
        Some(0) => Some(samples[0].0),
        Some(at) => {
            let (low, high) = (samples[at - 1], samples[at]);
            Some(crossing(&value, low, high, required)?)
        }
    };
    Ok(Found { demand, best_slip })
}

/// Golden-section search for a maximum.
fn golden(
    value: &impl Fn(f64) -> Result<f64, NoValue>,
    mut low: f64,
    mut high: f64,
) -> Result<(f64, f64), NoValue> {
    // (√5 − 1)/2
    const GOLDEN_SHARE: f64 = 0.618_033_988_749_894_8;
    let (mut a, mut b) = (
        high - GOLDEN_SHARE * (high - low),
        low + GOLDEN_SHARE * (high - low),
    );
    let (mut at_a, mut at_b) = (value(a)?, value(b)?);
    while high - low > BEST_SLIP_PRECISION {
        if at_a > at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - GOLDEN_SHARE * (high - low);
            at_a = value(a)?;
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + GOLDEN_SHARE * (high - low);
            at_b = value(b)?;
        }
    }
    Ok(if at_a > at_b { (a, at_a) } else { (b, at_b) })
}

/// The slip between two samples at which the pull is `required`, by the Illinois method.
fn crossing(
    value: &impl Fn(f64) -> Result<f64, NoValue>,
    low: (f64, f64),
    high: (f64, f64),
    required: f64,
) -> Result<f64, NoValue> {
    let (mut a, mut at_a) = (low.0, low.1 - required);
    let (mut b, mut at_b) = (high.0, high.1 - required);
    let mut side = 0;
    for _ in 0..100 {
        if b - a <= SLIP_PRECISION || at_b == 0.0 {
            break;
        }
        let secant = b - at_b * (b - a) / (at_b - at_a);
        let middle = if secant > a && secant < b {
            secant
        } else {
            0.5 * (a + b)
        };
        let now = value(middle)? - required;
        if now == 0.0 {
            return Ok(middle);
        }
        if now > 0.0 {
            if b - middle <= SLIP_PRECISION && side == 1 {
                return Ok(middle);
            }
            (b, at_b) = (middle, now);
            if side == 1 {
                at_a *= 0.5;
            }
            side = 1;
        } else {
            if middle - a <= SLIP_PRECISION && side == -1 {
                return Ok(middle);
            }
            (a, at_a) = (middle, now);
            if side == -1 {
                at_b *= 0.5;
            }
            side = -1;
        }
    }
    Ok(b)
}
