//! What a loaded wheel can pull, at which slip, and which slope it holds.

use crate::angle::Angle;
use crate::error::{Error, Result};
use crate::forces::Forces;
use crate::kinematics::Kinematics;
use crate::operating_point::tractive_efficiency;
use crate::settings::Accuracy;
use crate::slip::Slip;
use crate::slip_search::{BestSearch, ROOT_PRECISION, SAMPLES, maximum, root, root_near};
use crate::wheel_on_soil::WheelOnSoil;

/// Samples of the pull over slip before the steepest slope is sought, less one: the pull has one maximum, or rises to slip 1.
const SCAN_STEPS: u32 = 8;
const SCAN_STEP: f64 = 1.0 / 8.0;

/// The first round of the search for the steepest slope, and all others: reach and precision of the slip, precision of the
/// slope (rad). What the slip lacks counts in the slope by its square, and forces at standard accuracy tell no more.
const FIRST_ROUND: (f64, f64, f64) = (SCAN_STEP, 3e-3, 1e-4);
const LAST_ROUND: (f64, f64, f64) = (0.02, 1e-5, ROOT_PRECISION);

/// What a slope of the first round may lack beside its precision: ten times what forces to 1e-6 tell, rad.
const ROUGH_RAD: f64 = 1e-5;

/// Precision of a root of forces to 1e-6, and how far beside it the root of exact forces is looked for.
const ROUGH_SLIP: f64 = 1e-7;
const ROUGH_REACHES: [f64; 3] = [1e-6, 1e-5, 1e-3];

/// How far beside a slip that is nearly right the root is looked for.
const NEAR_REACHES: [f64; 3] = [0.02, 0.06, 0.2];

/// Slope and slip are found in turn at most so often; two rounds are enough.
const SLOPE_ROUNDS: u32 = 12;

/// No slope is steeper than this, rad (85°).
const MAX_GRADE_RAD: f64 = 85.0 * core::f64::consts::PI / 180.0;

/// The slip at which a quantity is greatest.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BestSlip {
    /// Where.
    pub slip: Slip,
    /// How great: N for a pull, a pure number for an efficiency.
    pub value: f64,
}

/// The steepest slope that a wheel holds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SteepestSlope {
    /// The slope.
    pub slope: Angle,
    /// The slip that holds it, and no other.
    pub slip: Slip,
}

/// What a slope requires of a wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SlopeOutcome {
    /// This slip holds it, and none smaller (below it the wheel slides back).
    Holds {
        /// The slip demand; negative on a downhill slope or where the wheel is held by its brake.
        slip: Slip,
    },
    /// No slip holds it.
    Immobilised {
        /// The greatest drawbar pull there is, N; `None` if the load is carried at no slip.
        max_pull: Option<f64>,
        /// The drawbar pull that the slope requires, N.
        required_pull: f64,
    },
}

impl WheelOnSoil {
    /// The slip in [0, 1] of the greatest drawbar pull under `load` (N); `None` where no slip carries it.
    ///
    /// # Errors
    /// As [`WheelOnSoil::under_load`].
    ///
    /// ```
    /// use grouser_terra::{RigidWheel, Settings, WheelOnSoil, catalogue};
    ///
    /// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
    /// let contact = WheelOnSoil::new(RigidWheel::new(0.125, 0.1)?, soil, Settings::default())?;
    /// let best = contact.slip_of_maximum_pull(80.0)?.expect("80 N are carried");
    /// assert!(best.value > 0.0 && best.slip.value() > 0.3); // N; dry sand pulls most at high slip
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    pub fn slip_of_maximum_pull(&self, load: f64) -> Result<Option<BestSlip>> {
        best_slip(|slip| self.forces_under(load, slip, |forces| forces.drawbar_pull))
    }

    /// The slip in [0, 1] of the greatest tractive efficiency under `load` (N); `None` where no slip
    /// gives any pull.
    ///
    /// # Errors
    /// As [`WheelOnSoil::under_load`].
    pub fn slip_of_maximum_efficiency(&self, load: f64) -> Result<Option<BestSlip>> {
        let radius = self.wheel().radius();
        best_slip(|slip| {
            let found = self.forces_under(load, slip, |f| {
                tractive_efficiency(1.0 - slip, radius, f.drawbar_pull, f.torque)
            })?;
            Ok(found.flatten())
        })
    }

    /// The smallest slip at which a wheel of `weight` (N) holds the slope `slope`: W cos α is carried and
    /// the drawbar pull is W sin α.
    ///
    /// # Errors
    /// As [`WheelOnSoil::under_load`]; [`Error::OutOfRange`] unless |α| < 90°.
    pub fn slip_demand(&self, weight: f64, slope: Angle) -> Result<SlopeOutcome> {
        let (load, required) = on_slope(weight, slope)?;
        let pull = |slip: f64| self.forces_under(load, slip, |forces| forces.drawbar_pull);
        least_slip(required, pull)
    }

    /// The skid of a free wheel: the slip at which the soil turns a wheel under `load` (N) against the
    /// friction `bearing_torque` (N m, not negative) of its bearing, torque = −bearing_torque. `None` where
    /// the soil cannot: the wheel locks, or is not carried.
    ///
    /// A free wheel does not roll without slip, as a fifth wheel that measures speed is assumed to:
    /// v = r ω/(1 + s).
    ///
    /// # Errors
    /// As [`WheelOnSoil::under_load`]; [`Error::OutOfRange`] for a negative or non-finite friction.
    ///
    /// ```
    /// use grouser_terra::{RigidWheel, Settings, WheelOnSoil, catalogue};
    /// let sand = catalogue::find("dry-sand").expect("it is in the catalogue").soil()?;
    /// let wheel = WheelOnSoil::new(RigidWheel::new(0.05, 0.03)?, sand, Settings::default())?;
    /// let skid = wheel.free_slip(5.0, 0.0)?.expect("5 N are carried and turn the wheel");
    /// assert!((skid.value() + 0.095).abs() < 5e-4); // it lags by nearly a tenth
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    pub fn free_slip(&self, load: f64, bearing_torque: f64) -> Result<Option<Slip>> {
        Error::check_range("bearing_torque", bearing_torque, 0.0, 1e9, "N m")?;
        let surplus = |slip| self.forces_under(load, slip, |f| f.torque + bearing_torque);
        if let Some(slip) = self.free_slip_where_torque_rises(load, bearing_torque)? {
            return Slip::new(slip).map(Some);
        }
        // From the first sample at which the torque suffices, look back.
        let mut before: Option<(f64, f64)> = None;
        for i in 0..=SAMPLES {
            let slip = f64::from(i) / f64::from(SAMPLES) - 1.0;
            let Some(now) = surplus(slip)? else { continue };
            if now >= 0.0 {
                return match before {
                    Some(low) => Ok(Some(Slip::new(root(
                        low,
                        (slip, now),
                        ROOT_PRECISION,
                        surplus,
                    )?)?)),
                    None => Ok(None),
                };
            }
            before = Some((slip, now));
        }
        Ok(None)
    }

    /// The skid where the torque rises with slip, as it does on most soils: a few samples and a root of the forces to 1e-6, then
    /// the root beside it. `None` where the samples do not rise from below the root to above it.
    fn free_slip_where_torque_rises(&self, load: f64, bearing_torque: f64) -> Result<Option<f64>> {
        let quick = self.with_accuracy(Accuracy::Simulation);
        let surplus_of = |on_soil: &Self, slip: f64| {
            on_soil.forces_under(load, slip, |f| f.torque + bearing_torque)
        };
        let mut before: Option<(f64, f64)> = None;
        let mut bracket = None;
        for i in 0..=SCAN_STEPS {
            let slip = f64::from(i) * SCAN_STEP - 1.0;
            let Some(now) = surplus_of(&quick, slip)? else {
                return Ok(None);
            };
            if let Some(low) = before {
                if now <= low.1 {
                    return Ok(None);
                }
                if low.1 < 0.0 && now >= 0.0 {
                    bracket = Some((low, (slip, now)));
                }
            }
            before = Some((slip, now));
        }
        let Some((low, high)) = bracket else {
            return Ok(None);
        };
        let near = root(low, high, ROUGH_SLIP, |slip| surplus_of(&quick, slip))?;
        root_near(near, &ROUGH_REACHES, |slip| surplus_of(self, slip))
    }

    /// [`WheelOnSoil::slip_demand`] where a slip is known that is nearly right, of a neighbouring soil or slope: the root
    /// next to it is found with a tenth of the work. Without one nearby the whole search answers.
    ///
    /// # Errors
    /// As [`WheelOnSoil::slip_demand`].
    ///
    /// ```
    /// use grouser_terra::{Angle, RigidWheel, Settings, SlopeOutcome, WheelOnSoil, catalogue};
    /// let sand = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
    /// let wheel = WheelOnSoil::new(RigidWheel::new(0.125, 0.1)?, sand, Settings::default())?;
    /// let at = |deg| wheel.slip_demand(80.0, Angle::from_deg(deg));
    /// let SlopeOutcome::Holds { slip } = at(8.0)? else { panic!("8° are held") };
    /// let SlopeOutcome::Holds { slip: whole } = at(8.5)? else { panic!("8.5° are held") };
    /// let near = wheel.slip_demand_near(80.0, Angle::from_deg(8.5), slip)?;
    /// let SlopeOutcome::Holds { slip: near } = near else { panic!("8.5° are held") };
    /// assert!((near.value() - whole.value()).abs() < 1e-11);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    pub fn slip_demand_near(&self, weight: f64, slope: Angle, near: Slip) -> Result<SlopeOutcome> {
        let (load, required) = on_slope(weight, slope)?;
        let surplus = |slip| self.forces_under(load, slip, |f| f.drawbar_pull - required);
        match root_near(near.value(), &NEAR_REACHES, surplus)? {
            Some(slip) => holds(slip),
            None => self.slip_demand(weight, slope),
        }
    }

    /// [`WheelOnSoil::free_slip`] where a slip is known that is nearly right, as [`WheelOnSoil::slip_demand_near`].
    ///
    /// # Errors
    /// As [`WheelOnSoil::free_slip`].
    ///
    /// ```
    /// use grouser_terra::{RigidWheel, Settings, WheelOnSoil, catalogue};
    /// let sand = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
    /// let wheel = WheelOnSoil::new(RigidWheel::new(0.05, 0.03)?, sand, Settings::default())?;
    /// let light = wheel.free_slip(5.0, 0.0)?.expect("5 N turn the wheel");
    /// let whole = wheel.free_slip(5.5, 0.0)?.expect("5.5 N turn the wheel");
    /// let near = wheel.free_slip_near(5.5, 0.0, light)?.expect("5.5 N turn the wheel");
    /// assert!((near.value() - whole.value()).abs() < 1e-11);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    pub fn free_slip_near(
        &self,
        load: f64,
        bearing_torque: f64,
        near: Slip,
    ) -> Result<Option<Slip>> {
        Error::check_range("bearing_torque", bearing_torque, 0.0, 1e9, "N m")?;
        let surplus = |slip| self.forces_under(load, slip, |f| f.torque + bearing_torque);
        match root_near(near.value(), &NEAR_REACHES, surplus)? {
            Some(slip) => Slip::new(slip).map(Some),
            None => self.free_slip(load, bearing_torque),
        }
    }

    /// What `of` makes of the forces straight ahead under a load; `None` where nothing carries it.
    fn forces_under<T>(
        &self,
        load: f64,
        slip: f64,
        of: impl Fn(&Forces) -> T,
    ) -> Result<Option<T>> {
        let motion = Kinematics::straight(Slip::new(slip)?);
        let Some(found) = self.sinkage_under(load, &motion)?.outcome.solved() else {
            return Ok(None);
        };
        let contact = self.contact(found.theta_1, &motion);
        Ok(Some(of(&contact.forces_by(self.tables(), self.order()))))
    }

    /// The steepest slope that a wheel of `weight` (N) holds at any slip in [0, 1]; `None` where it cannot
    /// even be carried on the level, or cannot pull itself.
    ///
    /// # Errors
    /// As [`WheelOnSoil::under_load`].
    ///
    /// ```
    /// use grouser_terra::{RigidWheel, Settings, WheelOnSoil, catalogue};
    ///
    /// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
    /// let contact = WheelOnSoil::new(RigidWheel::new(0.125, 0.1)?, soil, Settings::default())?;
    /// let slope = contact.gradeability(80.0)?.expect("it pulls on the level");
    /// assert!(slope.deg() > 0.0 && slope.rad() < soil.params().phi.rad());
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    pub fn gradeability(&self, weight: f64) -> Result<Option<Angle>> {
        Ok(self.steepest_slope(weight)?.map(|steepest| steepest.slope))
    }

    /// [`WheelOnSoil::gradeability`] with the slip of the greatest pull on that slope.
    ///
    /// Slope and slip are found in turn: at a fixed slip the pull that is left falls with the slope, and at a fixed slope
    /// the slip of the greatest pull is sought beside the last one. Since the pull is flat there, what the slip lacks
    /// counts in the slope by its square.
    ///
    /// # Errors
    /// As [`WheelOnSoil::under_load`].
    ///
    /// ```
    /// use grouser_terra::{RigidWheel, Settings, WheelOnSoil, catalogue};
    ///
    /// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
    /// let contact = WheelOnSoil::new(RigidWheel::new(0.125, 0.1)?, soil, Settings::default())?;
    /// let steepest = contact.steepest_slope(80.0)?.expect("it pulls on the level");
    /// let best = contact.slip_of_maximum_pull(80.0 * steepest.slope.cos())?.expect("it is carried");
    /// assert!((best.value - 80.0 * steepest.slope.sin()).abs() < 1e-8);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    pub fn steepest_slope(&self, weight: f64) -> Result<Option<SteepestSlope>> {
        let surplus_of = |on_soil: &Self, alpha: f64, slip: f64| -> Result<Option<f64>> {
            let angle = Angle::from_rad(alpha);
            let pull = on_soil.forces_under(weight * angle.cos(), slip, |f| f.drawbar_pull)?;
            Ok(pull.map(|pull| pull - weight * angle.sin()))
        };
        // the scan and the first round need no more than 1e-6
        let quick = self.with_accuracy(Accuracy::Simulation);
        let found = steepest(
            weight,
            |alpha, slip| surplus_of(&quick, alpha, slip),
            |alpha, slip| surplus_of(self, alpha, slip),
        )?;
        let Some((slope, slip)) = found else {
            return Ok(None);
        };
        Ok(Some(SteepestSlope {
            slope: Angle::from_rad(slope),
            slip: Slip::new(slip)?,
        }))
    }
}

/// What a wheel of `weight` carries on `slope`, and the drawbar pull that it requires there, N.
fn on_slope(weight: f64, slope: Angle) -> Result<(f64, f64)> {
    let steep = 89.9_f64.to_radians();
    Error::check_range("slope", slope.rad(), -steep, steep, "rad")?;
    Error::check_range("weight", weight, 0.0, 1e12, "N")?;
    Ok((weight * slope.cos(), weight * slope.sin()))
}

fn holds(slip: f64) -> Result<SlopeOutcome> {
    let slip = Slip::new(slip)?;
    Ok(SlopeOutcome::Holds { slip })
}

/// The least slip at which `pull` (N) is what is `required`: where the first of some samples in [−1, 1] reaches it, or else at or
/// below the greatest pull.
fn least_slip(required: f64, pull: impl Fn(f64) -> Result<Option<f64>>) -> Result<SlopeOutcome> {
    let surplus = |slip| Ok(pull(slip)?.map(|pull| pull - required));
    let mut before: Option<(f64, f64)> = None;
    let mut most = f64::NEG_INFINITY;
    for i in 0..=2 * SAMPLES {
        let slip = f64::from(i) / f64::from(SAMPLES) - 1.0;
        let Some(now) = surplus(slip)? else {
            before = None;
            continue;
        };
        if now >= 0.0 {
            return holds(match before {
                Some(low) => root(low, (slip, now), ROOT_PRECISION, surplus)?,
                None => slip,
            });
        }
        most = most.max(now);
        before = Some((slip, now));
    }
    // between two samples the pull may still suffice
    if let Some(best) = best_slip(surplus)? {
        let slip = best.slip.value();
        if best.value >= 0.0 {
            let low = slip - 1.0 / f64::from(SAMPLES);
            let at_low = surplus(low)?.unwrap_or(f64::NEG_INFINITY);
            return holds(root(
                (low, at_low),
                (slip, best.value),
                ROOT_PRECISION,
                surplus,
            )?);
        }
        most = most.max(best.value);
    }
    Ok(SlopeOutcome::Immobilised {
        max_pull: most.is_finite().then_some(most + required),
        required_pull: required,
    })
}

/// The steepest slope (rad) at which `surplus`, of slope and slip, is not negative at the slip in [0, 1] where it is greatest,
/// and that slip; `rough` is the same to 1e-6 of the weight. `None` where it is negative on the level.
fn steepest(
    weight: f64,
    rough: impl Fn(f64, f64) -> Result<Option<f64>>,
    surplus: impl Fn(f64, f64) -> Result<Option<f64>>,
) -> Result<Option<(f64, f64)>> {
    let Some((mut slip, mut left)) = best_of_scan(|slip| rough(0.0, slip))? else {
        return Ok(None);
    };
    if left < ROUGH_RAD * weight {
        // between two samples the wheel may still pull
        (slip, left) = maximum(slip, (SCAN_STEP, LAST_ROUND.1), |slip| surplus(0.0, slip))?;
        if left < 0.0 {
            return Ok(None);
        }
    }
    let mut slope = slope_held(slip, (0.0, left), (weight, FIRST_ROUND.2), &rough)?;
    (slope, slip) = round((slope, slip), weight, FIRST_ROUND, &rough)?;
    slope = (slope - ROUGH_RAD).max(0.0);
    for _ in 0..SLOPE_ROUNDS {
        let before = slip;
        (slope, slip) = round((slope, slip), weight, LAST_ROUND, &surplus)?;
        if (slip - before).abs() < FIRST_ROUND.1 {
            break;
        }
    }
    Ok(Some((slope, slip)))
}

/// The slip of the greatest surplus beside `slip` on `slope`, and the slope that it holds, first.
fn round(
    (slope, slip): (f64, f64),
    weight: f64,
    (reach, precision, slope_precision): (f64, f64, f64),
    surplus: &impl Fn(f64, f64) -> Result<Option<f64>>,
) -> Result<(f64, f64)> {
    let (slip, left) = maximum(slip, (reach, precision), |slip| surplus(slope, slip))?;
    let from = (slope, left.max(0.0));
    let slope = slope_held(slip, from, (weight, slope_precision), surplus)?;
    Ok((slope, slip))
}

/// The slope (rad) above `from` at which `surplus` at `slip` ends, its value at `from` being known and not negative.
fn slope_held(
    slip: f64,
    from: (f64, f64),
    (weight, precision): (f64, f64),
    surplus: impl Fn(f64, f64) -> Result<Option<f64>>,
) -> Result<f64> {
    // no slope takes less pull than its sine
    let (mut low, mut step) = (from, (from.1 / weight).max(precision).max(1e-9));
    loop {
        let alpha = (low.0 + step).min(MAX_GRADE_RAD);
        let Some(left) = surplus(alpha, slip)? else {
            return Ok(low.0);
        };
        if left < 0.0 {
            let mirrored = |x: f64| surplus(-x, slip);
            return Ok(-root((-alpha, left), (-low.0, low.1), precision, mirrored)?);
        }
        if alpha >= MAX_GRADE_RAD {
            return Ok(alpha);
        }
        (low, step) = ((alpha, left), 2.0 * step);
    }
}

/// The best of some samples in [0, 1], with its slip first; `None` where there is no value at all.
fn best_of_scan(of: impl Fn(f64) -> Result<Option<f64>>) -> Result<Option<(f64, f64)>> {
    let mut best: Option<(f64, f64)> = None;
    for i in 0..=SCAN_STEPS {
        let slip = f64::from(i) * SCAN_STEP;
        if let Some(value) = of(slip)?
            && best.is_none_or(|best| value > best.1)
        {
            best = Some((slip, value));
        }
    }
    Ok(best)
}

/// The greatest of `quantity` over slip in [0, 1].
fn best_slip(quantity: impl Fn(f64) -> Result<Option<f64>>) -> Result<Option<BestSlip>> {
    let mut search = BestSearch::new();
    while let Some(slip) = search.next_slip() {
        search.feed(quantity(slip)?);
    }
    let Some((slip, value)) = search.best() else {
        return Ok(None);
    };
    Ok(Some(BestSlip {
        slip: Slip::new(slip)?,
        value,
    }))
}

#[cfg(test)]
mod tests;
