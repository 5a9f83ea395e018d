//! What a loaded wheel can pull, at which slip, and which slope it holds.

use crate::angle::Angle;
use crate::error::{Error, Result};
use crate::followed::Followed;
use crate::forces::Forces;
use crate::kinematics::Kinematics;
use crate::operating_point::tractive_efficiency;
use crate::settings::Accuracy;
use crate::slip::Slip;
use crate::slip_search::{BestSearch, ROOT_PRECISION, SAMPLES, root, root_near};
use crate::slope::{HeldSlip, SlopeSearch, held_slip};
use crate::wheel_on_soil::WheelOnSoil;

/// Samples of the torque of a free wheel, which rises with slip on most soils.
const SCAN_STEPS: u32 = 8;

/// Slips between which a turn of the torque is not told.
const SKID_RESOLUTION: f64 = 1e-3;

/// Precision of a root of forces to 1e-6, and how far beside it the root of exact forces is looked for.
const ROUGH_SLIP: f64 = 1e-7;
const ROUGH_REACHES: [f64; 3] = [1e-6, 1e-5, 1e-3];

/// How far from a slip that is nearly right the root is looked for.
const NEAR_REACHES: [f64; 3] = [0.02, 0.06, 0.2];

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
pub enum SlopeOutcome {
    /// This slip holds it, and none of smaller magnitude.
    Holds {
        /// The slip demand; negative on a downhill slope or where the wheel is held by its brake.
        slip: Slip,
    },
    /// No slip up to the greatest ([`Settings::max_slip`](crate::Settings)) holds it.
    Immobilised {
        /// The greatest drawbar pull up to that slip, N; `None` if the load is carried at none.
        max_pull: Option<f64>,
        /// The drawbar pull that the slope requires, N.
        required_pull: f64,
    },
    /// Downhill no braking slip up to the greatest holds it.
    Slides {
        /// The drawbar pull that the slope requires, N; negative.
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

    /// The slip of smallest magnitude at which a wheel of `weight` (N) holds the slope `slope`: W cos α is carried and
    /// the drawbar pull is W sin α, at a slip of at most that of the settings ([`held_slip`]).
    ///
    /// # Errors
    /// As [`WheelOnSoil::under_load`]; [`Error::OutOfRange`] unless |α| < 90°.
    pub fn slip_demand(&self, weight: f64, slope: Angle) -> Result<SlopeOutcome> {
        let (load, required) = on_slope(weight, slope)?;
        let surplus = |slip| self.forces_under(load, slip, |f| f.drawbar_pull - required);
        let required_pull = required;
        Ok(match held_slip(self.settings().max_slip, surplus)? {
            HeldSlip::Holds(slip) => return holds(slip),
            HeldSlip::Immobilised(most) => SlopeOutcome::Immobilised {
                max_pull: most.map(|most| most + required),
                required_pull,
            },
            HeldSlip::Slides => SlopeOutcome::Slides { required_pull },
        })
    }

    /// The skid of a free wheel: the slip at which the soil turns a wheel under `load` (N) against the
    /// friction `bearing_torque` (N m, not negative) of its bearing, torque = −bearing_torque. `None` where
    /// the soil cannot: the wheel locks, or is not carried.
    ///
    /// Of several it is the first from −1 on, where a wheel that was locked ends: at all lower slips the soil turns it faster, or
    /// nothing carries it. Where the sinkage jumps with slip the torque may jump over that value; the skid is there. The torque is
    /// followed as the force of [`WheelOnSoil::under_load`] is; what rises and falls again
    /// within 0.002 of slip is missed.
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
        // to 1e-6 the first rise is found, then the root beside it
        let quick = self.with_accuracy(Accuracy::Simulation);
        let surplus_of = |on_soil: &Self, slip: f64| {
            on_soil.forces_under(load, slip, |f| f.torque + bearing_torque)
        };
        // where nothing carries the wheel it counts as turned
        let below = |surplus: Option<f64>| surplus.unwrap_or(f64::NEG_INFINITY);
        for steps in [SCAN_STEPS, SAMPLES] {
            let mut followed = Followed::new(SKID_RESOLUTION);
            for i in 0..=steps {
                let slip = f64::from(i) / f64::from(steps) - 1.0;
                followed.add(slip, below(surplus_of(&quick, slip)?));
            }
            if steps == SCAN_STEPS && !followed.only_rises() {
                continue;
            }
            while let Some(slip) = followed.next_place() {
                followed.add(slip, below(surplus_of(&quick, slip)?));
            }
            let Some([low, high]) = followed.first_rise() else {
                return Ok(None);
            };
            let low = (low.0, low.1.max(-high.1));
            let near = root(low, high, ROUGH_SLIP, |slip| surplus_of(&quick, slip))?;
            if let Some(slip) = root_near(near, &ROUGH_REACHES, |slip| surplus_of(self, slip))? {
                return Slip::new(slip).map(Some);
            }
            if steps == SAMPLES {
                // a jump of the torque, or a gap in which nothing carries the wheel
                let slip = root(low, high, ROOT_PRECISION, |slip| surplus_of(self, slip))?;
                return Slip::new(slip).map(Some);
            }
        }
        Ok(None)
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
    /// let SlopeOutcome::Holds { slip } = at(4.0)? else { panic!("4° are held") };
    /// let SlopeOutcome::Holds { slip: whole } = at(4.5)? else { panic!("4.5° are held") };
    /// let near = wheel.slip_demand_near(80.0, Angle::from_deg(4.5), slip)?;
    /// let SlopeOutcome::Holds { slip: near } = near else { panic!("4.5° are held") };
    /// assert!((near.value() - whole.value()).abs() < 1e-11);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    pub fn slip_demand_near(&self, weight: f64, slope: Angle, near: Slip) -> Result<SlopeOutcome> {
        let (load, required) = on_slope(weight, slope)?;
        let surplus = |slip| self.forces_under(load, slip, |f| f.drawbar_pull - required);
        match root_near(near.value(), &NEAR_REACHES, surplus)? {
            Some(slip) if slip.abs() <= self.settings().max_slip => holds(slip),
            _ => self.slip_demand(weight, slope),
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

    /// The steepest slope that a wheel of `weight` (N) holds at a slip of at most that of the settings; `None` where it cannot
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

    /// [`WheelOnSoil::gradeability`] with the slip that holds that slope.
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
    /// // the pull of dry sand rises up to the greatest slip that counts
    /// assert_eq!(steepest.slip.value(), 0.6);
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
        let search = SlopeSearch {
            weight,
            slopes: (0.0, MAX_GRADE_RAD),
            max_slip: self.settings().max_slip,
            near: None,
        };
        let found = search.steepest(
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
