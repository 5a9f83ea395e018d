//! The slip that holds a slope, over the slope.

use grouser_real::OutOfRange;
use grouser_terra::{Angle, Kinematics, Result, RigidWheel, Slip, SlopeOutcome, Soil, WheelOnSoil};

use super::doubt::{Family, SoilDoubt};
use super::table::Table;
use crate::filter::SlipPrior;

/// Points of the table.
const POINTS: u32 = 17;
/// No table reaches steeper, rad: the limit of [`WheelOnSoil::slip_demand`].
const MAX_SLOPE_RAD: f64 = 89.9 * core::f64::consts::PI / 180.0;

/// The slip that a powered wheel needs on a slope: what the filter may believe before it has measured.
///
/// Source: the balance of pull and slope (`grouser climb`). Valid range: slopes between those given, up to the one that no slip holds. Assumes:
/// all powered wheels share the pull by their load.
///
/// ```
/// use grouser_slip::prior::{SlipDemand, SoilDoubt};
/// use grouser_terra::{Angle, RigidWheel, catalogue};
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let slopes = (Angle::from_deg(-10.0), Angle::from_deg(10.0));
/// let demand = SlipDemand::new(RigidWheel::new(0.125, 0.1)?, &soil, 80.0, slopes, SoilDoubt::default())?;
/// let (level, uphill) = (demand.at(Angle::from_deg(0.0)), demand.at(Angle::from_deg(5.0)));
/// assert!(uphill.expect("it is held").mean > level.expect("it is held").mean);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct SlipDemand {
    table: Table,
}

impl SlipDemand {
    /// The table for `wheel` under `weight` (N) on `soil`, from one slope to another.
    ///
    /// # Errors
    /// [`OutOfRange`] for a weight or slopes outside the model's limits; what [`WheelOnSoil`] refuses.
    pub fn new(
        wheel: RigidWheel,
        soil: &Soil,
        weight: f64,
        slopes: (Angle, Angle),
        doubt: SoilDoubt,
    ) -> Result<Self> {
        let (from, to) = (slopes.0.rad(), slopes.1.rad());
        OutOfRange::check(
            "maximum slope",
            to,
            (from, core::f64::consts::FRAC_PI_2),
            "rad",
        )?;
        let family = Family::new(wheel, soil, &doubt)?;
        // what is wrong with weight, slopes or the exponent n(s) shows at once
        let first = match family.own().slip_demand(weight, slopes.0)? {
            SlopeOutcome::Holds { slip } => Some(slip.value()),
            _ => None,
        };
        OutOfRange::check("slope", to, (-MAX_SLOPE_RAD, MAX_SLOPE_RAD), "rad")?;
        let spinning = Kinematics::straight(Slip::new(1.0)?);
        family.own().sinkage_under(0.0, &spinning)?;
        let slip = |pair: &WheelOnSoil, slope: f64, near: Option<f64>| {
            let slope = Angle::from_rad(slope);
            let found = match near.and_then(|near| Slip::new(near).ok()) {
                Some(near) => pair.slip_demand_near(weight, slope, near),
                None => pair.slip_demand(weight, slope),
            };
            match found.ok()? {
                SlopeOutcome::Holds { slip } => Some(slip.value()),
                _ => None,
            }
        };
        let mut traced = family.traced(first);
        let places = (0..POINTS).map(|i| from + (to - from) * f64::from(i) / f64::from(POINTS - 1));
        Ok(Self {
            table: Table::new(places.map(|place| {
                let end = if place < 0.0 { -1.0 } else { 1.0 };
                // uphill, what holds no slope holds no steeper one: the load falls and the pull that is needed grows
                let prior = family.spread(&mut traced, (end, place >= 0.0), |pair, near| {
                    slip(pair, place, near)
                });
                (place, prior)
            })),
        })
    }

    /// A table that is ready-made: priors at rising slopes (rad), for a computer that cannot solve for them.
    ///
    /// ```
    /// use grouser_slip::filter::SlipPrior;
    /// use grouser_slip::prior::SlipDemand;
    /// use grouser_terra::Angle;
    /// let prior = |mean| SlipPrior { mean, sigma: 0.1 };
    /// let demand = SlipDemand::from_points(&[(-0.1, prior(0.02)), (0.1, prior(0.22))])?;
    /// assert!((demand.at(Angle::from_rad(0.0)).unwrap().mean - 0.12).abs() < 1e-12);
    /// assert!(SlipDemand::from_points(&[(0.1, prior(0.2)), (-0.1, prior(0.0))]).is_err());
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`OutOfRange`] for slopes that do not rise, slips outside [−1, 1] and sigmas that are not positive.
    pub fn from_points(points: &[(f64, SlipPrior)]) -> Result<Self> {
        let mut low = -core::f64::consts::FRAC_PI_2;
        for (slope, prior) in points {
            check("slope", *slope, (low, core::f64::consts::FRAC_PI_2), "rad")?;
            check("slip", prior.mean, (-1.0, 1.0), "1")?;
            check("sigma", prior.sigma, (1e-6, 2.0), "1")?;
            low = *slope;
        }
        let points = points.iter().map(|(slope, prior)| (*slope, Some(*prior)));
        Ok(Self {
            table: Table::new(points),
        })
    }

    /// The table's points: slopes (rad), each with its prior.
    #[must_use]
    pub fn points(&self) -> &[(f64, SlipPrior)] {
        self.table.points()
    }

    /// The slip demand on `slope`; `None` outside the table, or where no slip holds it.
    #[must_use]
    pub fn at(&self, slope: Angle) -> Option<SlipPrior> {
        self.table.at(slope.rad())
    }
}

fn check(field: &'static str, value: f64, limits: (f64, f64), unit: &'static str) -> Result<()> {
    Ok(OutOfRange::check(field, value, limits, unit)?)
}
