//! What a loaded wheel can pull, at which slip, and which slope it holds.

use grouser_real::Real;

use crate::angle::Angle;
use crate::error::{Error, Result};
use crate::forces::Forces;
use crate::kinematics::Kinematics;
use crate::operating_point::OperatingPoint;
use crate::slip::Slip;
use crate::wheel_on_soil::WheelOnSoil;

/// Slips at which a curve is sampled before its optimum or its root is refined.
const SAMPLES: u32 = 33;

/// Relative precision of a refined slip: an optimum is flat, so that its place is known to about the root
/// of the precision of its height.
const SLIP_PRECISION: f64 = 1e-9;

/// How closely a root is found: far below what forces at standard accuracy can tell.
const ROOT_PRECISION: f64 = 1e-13;

/// The slip at which a quantity is greatest.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BestSlip {
    /// Where.
    pub slip: Slip,
    /// How great: N for a pull, a pure number for an efficiency.
    pub value: f64,
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
        self.best_slip(load, |point| Some(point.forces.drawbar_pull))
    }

    /// The slip in [0, 1] of the greatest tractive efficiency under `load` (N); `None` where no slip
    /// gives any pull.
    ///
    /// # Errors
    /// As [`WheelOnSoil::under_load`].
    pub fn slip_of_maximum_efficiency(&self, load: f64) -> Result<Option<BestSlip>> {
        self.best_slip(load, OperatingPoint::tractive_efficiency)
    }

    /// The smallest slip at which a wheel of `weight` (N) holds the slope `slope`: W cos α is carried and
    /// the drawbar pull is W sin α.
    ///
    /// # Errors
    /// As [`WheelOnSoil::under_load`]; [`Error::OutOfRange`] unless |α| < 90°.
    pub fn slip_demand(&self, weight: f64, slope: Angle) -> Result<SlopeOutcome> {
        let steep = 89.9_f64.to_radians();
        Error::check_range("slope", slope.rad(), -steep, steep, "rad")?;
        Error::check_range("weight", weight, 0.0, 1e12, "N")?;
        let load = weight * slope.cos();
        let required = weight * slope.sin();
        let pull = |slip: f64| self.forces_under(load, slip, |forces| forces.drawbar_pull);
        let mut before: Option<(f64, f64)> = None;
        let mut max_pull: Option<f64> = None;
        for i in 0..=2 * SAMPLES {
            let slip = f64::from(i) / f64::from(SAMPLES) - 1.0;
            let Some(now) = pull(slip)? else {
                before = None;
                continue;
            };
            max_pull = Some(max_pull.map_or(now, |m| m.max(now)));
            if now >= required {
                let slip = match before {
                    Some((low, at_low)) => {
                        root((low, at_low - required), (slip, now - required), |s| {
                            Ok(pull(s)?.map(|pull| pull - required))
                        })?
                    }
                    None => slip,
                };
                return Ok(SlopeOutcome::Holds {
                    slip: Slip::new(slip)?,
                });
            }
            before = Some((slip, now));
        }
        // Between two samples the pull may still reach the required pull.
        if let Some(best) = self.slip_of_maximum_pull(load)? {
            if best.value >= required {
                let low = (best.slip.value() - 1.0 / f64::from(SAMPLES)).max(-1.0);
                if let Some(at_low) = pull(low)? {
                    let high = (best.slip.value(), best.value - required);
                    let slip = root((low, at_low - required), high, |s| {
                        Ok(pull(s)?.map(|pull| pull - required))
                    })?;
                    return Ok(SlopeOutcome::Holds {
                        slip: Slip::new(slip)?,
                    });
                }
            }
            max_pull = Some(max_pull.map_or(best.value, |m| m.max(best.value)));
        }
        Ok(SlopeOutcome::Immobilised {
            max_pull,
            required_pull: required,
        })
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
        // Torque rises with slip: from the first sample at which it suffices, look back.
        let mut before: Option<(f64, f64)> = None;
        for i in 0..=SAMPLES {
            let slip = f64::from(i) / f64::from(SAMPLES) - 1.0;
            let Some(now) = surplus(slip)? else { continue };
            if now >= 0.0 {
                return match before {
                    Some(low) => Ok(Some(Slip::new(root(low, (slip, now), surplus)?)?)),
                    None => Ok(None),
                };
            }
            before = Some((slip, now));
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
    /// let SlopeOutcome::Holds { slip } = at(8.0)? else { panic!("8° are held") };
    /// let SlopeOutcome::Holds { slip: whole } = at(8.5)? else { panic!("8.5° are held") };
    /// let near = wheel.slip_demand_near(80.0, Angle::from_deg(8.5), slip)?;
    /// let SlopeOutcome::Holds { slip: near } = near else { panic!("8.5° are held") };
    /// assert!((near.value() - whole.value()).abs() < 1e-11);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    pub fn slip_demand_near(&self, weight: f64, slope: Angle, near: Slip) -> Result<SlopeOutcome> {
        let (load, required) = (weight * slope.cos(), weight * slope.sin());
        if load >= 0.0 && required.is_finite() {
            let surplus = |slip| self.forces_under(load, slip, |f| f.drawbar_pull - required);
            if let Some(slip) = root_near(near.value(), surplus)? {
                return Ok(SlopeOutcome::Holds {
                    slip: Slip::new(slip)?,
                });
            }
        }
        self.slip_demand(weight, slope)
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
        match root_near(near.value(), surplus)? {
            Some(slip) => Slip::new(slip).map(Some),
            None => self.free_slip(load, bearing_torque),
        }
    }

    /// A number of the forces straight ahead under a load; `None` where nothing carries it.
    fn forces_under(
        &self,
        load: f64,
        slip: f64,
        of: impl Fn(&Forces) -> f64,
    ) -> Result<Option<f64>> {
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
        let surplus = |alpha: f64| -> Result<Option<f64>> {
            let angle = Angle::from_rad(alpha);
            let best = self.slip_of_maximum_pull(weight * angle.cos())?;
            Ok(best.map(|best| best.value - weight * angle.sin()))
        };
        let Some(level) = surplus(0.0)? else {
            return Ok(None);
        };
        if level < 0.0 {
            return Ok(None);
        }
        // The load falls and the demand grows with the slope: one root, well below the vertical.
        let (mut low, mut high) = (0.0, 85_f64.to_radians());
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if surplus(middle)?.is_some_and(|s| s >= 0.0) {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(Some(Angle::from_rad(low)))
    }

    /// The greatest of `quantity` over slip in [0, 1] by samples and golden section.
    fn best_slip(
        &self,
        load: f64,
        quantity: impl Fn(&OperatingPoint) -> Option<f64>,
    ) -> Result<Option<BestSlip>> {
        let at = |slip: f64| -> Result<f64> {
            let solution = self.under_load(load, &Kinematics::straight(Slip::new(slip)?))?;
            Ok(solution
                .point()
                .as_ref()
                .and_then(&quantity)
                .unwrap_or(f64::NEG_INFINITY))
        };
        let step = 1.0 / f64::from(SAMPLES - 1);
        let mut best = (0.0, f64::NEG_INFINITY);
        for i in 0..SAMPLES {
            let slip = f64::from(i) * step;
            let value = at(slip)?;
            if value > best.1 {
                best = (slip, value);
            }
        }
        if best.1 == f64::NEG_INFINITY {
            return Ok(None);
        }
        let (mut a, mut b) = ((best.0 - step).max(0.0), (best.0 + step).min(1.0));
        let golden = 0.5 * (Real::sqrt(5.0_f64) - 1.0);
        let mut c = b - golden * (b - a);
        let mut d = a + golden * (b - a);
        let (mut f_c, mut f_d) = (at(c)?, at(d)?);
        while b - a > SLIP_PRECISION {
            if f_c > f_d {
                (b, d, f_d) = (d, c, f_c);
                c = b - golden * (b - a);
                f_c = at(c)?;
            } else {
                (a, c, f_c) = (c, d, f_d);
                d = a + golden * (b - a);
                f_d = at(d)?;
            }
        }
        let refined = if f_c > f_d { (c, f_c) } else { (d, f_d) };
        let (slip, value) = if refined.1 > best.1 { refined } else { best };
        Ok(Some(BestSlip {
            slip: Slip::new(slip)?,
            value,
        }))
    }
}

/// The root of `f` between two points of opposite sign, to [`ROOT_PRECISION`], where it is not negative: the secant with
/// Illinois' weight, which moves both ends, and a bisection now and then; a point where `f` has no value counts as below.
fn root(low: (f64, f64), high: (f64, f64), f: impl Fn(f64) -> Result<Option<f64>>) -> Result<f64> {
    let ((mut a, mut f_a), (mut b, mut f_b)) = (low, high);
    let mut moved_b = None;
    for i in 1..200 {
        if b - a <= ROOT_PRECISION || f_b == 0.0 {
            break;
        }
        let secant = b - f_b * (b - a) / (f_b - f_a);
        // past the root by less than the precision, so that the last step moves the other end
        let past = if moved_b == Some(true) { -1.0 } else { 1.0 };
        let secant = secant + past * 0.4 * ROOT_PRECISION;
        let c = if i % 6 > 0 && secant > a && secant < b {
            secant
        } else {
            0.5 * (a + b)
        };
        match f(c)? {
            Some(f_c) if f_c >= 0.0 => {
                if moved_b == Some(true) {
                    f_a *= 0.5;
                }
                moved_b = Some(true);
                (b, f_b) = (c, f_c);
            }
            Some(f_c) => {
                if moved_b == Some(false) {
                    f_b *= 0.5;
                }
                moved_b = Some(false);
                (a, f_a) = (c, f_c);
            }
            None => {
                moved_b = None;
                a = c;
            }
        }
    }
    Ok(b)
}

/// The root of a growing `f` beside a slip that is nearly right; `None` where there is none within a few tenths.
fn root_near(near: f64, f: impl Fn(f64) -> Result<Option<f64>>) -> Result<Option<f64>> {
    for reach in [0.02, 0.06, 0.2] {
        let (low, high) = ((near - reach).max(-1.0), (near + reach).min(1.0));
        if let (Some(at_low), Some(at_high)) = (f(low)?, f(high)?)
            && at_low < 0.0
            && at_high >= 0.0
        {
            return root((low, at_low), (high, at_high), f).map(Some);
        }
    }
    Ok(None)
}
