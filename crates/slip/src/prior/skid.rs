//! The skid of a free wheel on soft ground, over its load.

use grouser_real::{OutOfRange, Real};
use grouser_terra::{Result, RigidWheel, Settings, ShearLaw, Slip, Soil, SoilParams, WheelOnSoil};

use super::doubt::{Family, SoilDoubt};
use super::table::Table;
use crate::filter::SlipPrior;

/// Points of the table.
const POINTS: u32 = 9;

/// The published laws of shear between which no measurement of a free wheel has decided.
const LAWS: [ShearLaw; 3] = [
    ShearLaw::Coupled,
    ShearLaw::SlipVelocity,
    ShearLaw::TowedRestart,
];

/// The slip s_f < 0 at which the soil turns a free wheel against its bearing: torque + bearing torque = 0.
///
/// A free wheel that is taken to roll reads slips too high by −s_f (1 − s): .08 to .19 on dry sand.
///
/// Source: the wheel without torque by the laws of \[WR67\]. Valid range: loads between those given. Assumes: straight ahead, steady.
///
/// ```
/// use grouser_slip::prior::{FreeWheelSkid, SoilDoubt};
/// use grouser_terra::{RigidWheel, catalogue};
/// let sand = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let skid = FreeWheelSkid::new(RigidWheel::new(0.05, 0.03)?, &sand, 0.0, (2.0, 20.0), SoilDoubt::default())?;
/// let at_5_newton = skid.at(5.0).expect("in the table");
/// // solved by an independent quadrature: −.095
/// assert!((at_5_newton.mean + 0.095).abs() < 2e-3 && at_5_newton.sigma > 0.01);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct FreeWheelSkid {
    /// Over √load: the skid is all but linear in it.
    table: Table,
}

impl FreeWheelSkid {
    /// The table for `wheel` on `soil` with a bearing that holds it back by `bearing_torque` (N m), for loads from
    /// `loads.0` to `loads.1` (N).
    ///
    /// # Errors
    /// [`OutOfRange`] for loads outside [1e-3, 1e6] N or a negative bearing torque; what [`WheelOnSoil`] refuses.
    pub fn new(
        wheel: RigidWheel,
        soil: &Soil,
        bearing_torque: f64,
        loads: (f64, f64),
        doubt: SoilDoubt,
    ) -> Result<Self> {
        for (field, load, low) in [
            ("minimum load", loads.0, 1e-3),
            ("maximum load", loads.1, loads.0),
        ] {
            OutOfRange::check(field, load, (low, 1e6), "N")?;
        }
        let family = Family::new(wheel, soil, &doubt)?;
        // what is wrong with the bearing or the load shows at once
        let first = family.own().free_slip(loads.0, bearing_torque)?;
        let slip = |pair: &WheelOnSoil, load: f64, near: Option<f64>| {
            let found = match near.and_then(|near| Slip::new(near).ok()) {
                Some(near) => pair.free_slip_near(load, bearing_torque, near),
                None => pair.free_slip(load, bearing_torque),
            };
            Some(found.ok()??.value())
        };
        let mut traced = family.traced(first.map(Slip::value));
        let (from, to) = (Real::sqrt(loads.0), Real::sqrt(loads.1));
        // one load is one point
        let last = if from < to { POINTS - 1 } else { 0 };
        let places = (0..=last).map(|i| from + (to - from) * f64::from(i) / f64::from(last.max(1)));
        Ok(Self {
            table: Table::new(places.map(|place| {
                let prior = family.spread(&mut traced, (-1.0, false), |pair, near| {
                    slip(pair, place * place, near)
                });
                (place, prior)
            })),
        })
    }

    /// The table over the published laws of shear as well as over the soil: the skid depends on the law more than on the soil
    /// (−.03 to −.13 for one wheel), and no measurement has decided between them.
    ///
    /// The mean is that of the laws, each taken for as likely as the others; its variance is the mean of theirs and the spread
    /// between them. Laws under which the soil does not turn the wheel are left out.
    ///
    /// ```
    /// use grouser_slip::prior::{FreeWheelSkid, SoilDoubt};
    /// use grouser_terra::{RigidWheel, catalogue};
    /// let sand = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
    /// let wheel = RigidWheel::new(0.05, 0.03)?;
    /// let skid = FreeWheelSkid::over_laws(wheel, &sand, 0.0, (4.0, 6.0), SoilDoubt::default())?;
    /// let skid = skid.at(5.0).expect("in the table");
    /// for of_a_law in [-0.027, -0.095] {
    ///     assert!((skid.mean - of_a_law).abs() < 2.0 * skid.sigma);
    /// }
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`FreeWheelSkid::new`], if no law has a skid.
    pub fn over_laws(
        wheel: RigidWheel,
        soil: &Soil,
        bearing_torque: f64,
        loads: (f64, f64),
        doubt: SoilDoubt,
    ) -> Result<Self> {
        let own = Self::new(wheel, soil, bearing_torque, loads, doubt)?;
        let own_law = soil.params().laws.shear;
        let own_law = own_law.unwrap_or(Settings::default().shear);
        let tables = LAWS.map(|law| {
            if law == own_law {
                return Some(own.clone());
            }
            let mut laws = soil.params().laws;
            laws.shear = Some(law);
            let soil = Soil::new(SoilParams {
                laws,
                ..*soil.params()
            });
            Self::new(wheel, &soil.ok()?, bearing_torque, loads, doubt).ok()
        });
        let places = own.table.points().iter().map(|(place, prior)| {
            let known = tables.iter().flatten();
            let known = known.filter_map(|table| table.table.at(*place));
            (*place, Some(mixture(&known).unwrap_or(*prior)))
        });
        Ok(Self {
            table: Table::new(places),
        })
    }

    /// The skid under `load` (N); `None` outside the table, or where the soil does not turn the wheel.
    #[must_use]
    pub fn at(&self, load: f64) -> Option<SlipPrior> {
        self.table.at(Real::sqrt(load))
    }
}

/// Mean and standard deviation of several priors, one as likely as the other; `None` of none.
fn mixture(priors: &(impl Iterator<Item = SlipPrior> + Clone)) -> Option<SlipPrior> {
    let count = priors.clone().count() as f64;
    let average = |of: &dyn Fn(SlipPrior) -> f64| priors.clone().map(of).sum::<f64>() / count;
    let mean = average(&|prior| prior.mean);
    let variance = average(&|prior| {
        let off = prior.mean - mean;
        prior.sigma * prior.sigma + off * off
    });
    (count > 0.0).then(|| SlipPrior {
        mean,
        sigma: Real::sqrt(variance),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use grouser_terra::catalogue;

    #[test]
    fn a_mixture_has_the_mean_of_variances_and_the_spread_between() {
        let prior = |mean, sigma| SlipPrior { mean, sigma };
        let of = |priors: &[SlipPrior]| mixture(&priors.iter().copied());
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[prior(-0.25, 0.5)]), Some(prior(-0.25, 0.5)));
        // variances of 9 and 25, and ±4 about the mean
        let mixed = of(&[prior(0.02, 0.03), prior(0.1, 0.05)]).unwrap();
        assert!((mixed.mean - 0.06).abs() < 1e-15);
        assert!((mixed.sigma - 0.0033_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_table_has_nine_points_and_one_of_one_load() {
        let sand = catalogue::find("dry-sand").unwrap().soil().unwrap();
        let wheel = RigidWheel::new(0.05, 0.03).unwrap();
        for (loads, points) in [((5.0, 5.0), 1), ((5.0, 6.0), 9)] {
            let skid = FreeWheelSkid::new(wheel, &sand, 0.0, loads, SoilDoubt::of(0.1)).unwrap();
            let places: Vec<f64> = skid.table.points().iter().map(|point| point.0).collect();
            assert_eq!(places.len(), points);
            assert_eq!(places[0], loads.0.sqrt());
            assert!((places[points - 1] - loads.1.sqrt()).abs() < 1e-12);
        }
    }
}
