//! Is what was identified, and what was measured for it, of the size that soils and tests have?

use core::fmt;

use grouser_real::Real;
use grouser_terra::RigidWheel;

use crate::plate::PlateFit;
use crate::readings::Readings;
use crate::shear::ShearFit;

/// Moduli of different exponents are compared by the pressure that they give at this depth, m.
const REFERENCE_DEPTH_M: f64 = 0.01;

/// What soils and tests have, in the unit of each.
///
/// Of soils: the catalogue (`grouser_terra::catalogue`, 30 published soils and snows) with a factor of 1.6 or more on both
/// sides; there n is 0.11 to 1.6, the pressure at 10 mm under a wheel of 0.1 m 0.18 to 995 kPa, φ 6 to 38°, the cohesion at
/// most 69 kPa, and K 10 to 40 mm. Of tests: from hand-held penetrometers to bevameters on vehicles, and from model wheels to
/// tyres of trucks.
mod limits {
    pub(super) const EXPONENT: (f64, f64) = (0.07, 2.6);
    pub(super) const PRESSURE_KPA: (f64, f64) = (0.1, 2000.0);
    pub(super) const MAX_PRESSURE_KPA: (f64, f64) = (1.0, 5000.0);
    pub(super) const MAX_DEPTH_MM: (f64, f64) = (5.0, 600.0);
    pub(super) const DIAMETER_MM: (f64, f64) = (10.0, 1000.0);
    pub(super) const COHESION_KPA: (f64, f64) = (0.0, 120.0);
    pub(super) const PHI_DEG: (f64, f64) = (3.0, 60.0);
    pub(super) const MODULUS_MM: (f64, f64) = (0.5, 200.0);
    pub(super) const MAX_DISPLACEMENT_MM: (f64, f64) = (2.0, 2000.0);
    pub(super) const MAX_NORMAL_KPA: (f64, f64) = (0.3, 2000.0);
    /// Shear stress over normal stress: strength of cohesive soils under small loads is many times these.
    pub(super) const SHEAR_RATIO: (f64, f64) = (0.05, 30.0);
    pub(super) const RADIUS_MM: (f64, f64) = (10.0, 2000.0);
    pub(super) const WIDTH_MM: (f64, f64) = (5.0, 2000.0);
}

/// A number that was identified, or that tests show, beside what soils and tests have.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Plausibility {
    /// What it is.
    pub what: String,
    /// Its value, in its unit.
    pub value: f64,
    /// What it usually is.
    pub limits: (f64, f64),
    /// Its unit.
    pub unit: &'static str,
}

impl fmt::Display for Plausibility {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (low, high) = self.limits;
        let (value, unit) = (shown(self.value), self.unit);
        write!(
            f,
            "{} {value}{unit} (usually {low} to {high}{unit})",
            self.what
        )
    }
}

/// Three digits.
fn shown(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-3..1e6).contains(&size) {
        let digits = if size >= 100.0 {
            0
        } else if size >= 1.0 {
            2
        } else {
            5
        };
        format!("{value:.digits$}")
    } else {
        format!("{value:.2e}")
    }
}

impl Plausibility {
    /// Factors of ten between it and its limits; 0 between them.
    #[must_use]
    pub fn decades_outside(&self) -> f64 {
        /// Where no factor leads into the limits.
        const NO_FACTOR: f64 = 3.0;
        let (low, high) = self.limits;
        if self.value > high {
            Real::log10(self.value / high)
        } else if self.value >= low {
            0.0
        } else if self.value > 0.0 {
            Real::log10(low / self.value)
        } else {
            NO_FACTOR
        }
    }

    /// Its distance from the middle of its limits, squared, the limits being at 1; 0 without a lower limit.
    pub(crate) fn square_from_middle(&self) -> f64 {
        let (low, high) = self.limits;
        if !(low > 0.0 && self.value > 0.0) {
            return 0.0;
        }
        let half = 0.5 * Real::log10(high / low);
        let off = Real::log10(self.value / (low * high).sqrt());
        (off / half) * (off / half)
    }
}

fn number(what: &str, value: f64, limits: (f64, f64), unit: &'static str) -> Plausibility {
    let what = what.to_owned();
    Plausibility {
        what,
        value,
        limits,
        unit,
    }
}

fn max(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// Every number of what plates and shear tests gave, and the sizes of the `readings` behind it.
pub(crate) fn all(
    plates: Option<&PlateFit>,
    shear: Option<&ShearFit>,
    readings: &Readings,
) -> Vec<Plausibility> {
    let mut list = Vec::new();
    if let Some(fit) = plates {
        list.push(number("the exponent n", fit.n, limits::EXPONENT, ""));
        let moduli = fit.numbers().into_iter();
        for k in moduli.filter(|number| number.name.starts_with("k_")) {
            let pressure = 1e-3 * k.value * Real::powf(REFERENCE_DEPTH_M, fit.n);
            let what = format!("the pressure at a depth of 10 mm by {}", k.name);
            list.push(number(&what, pressure, limits::PRESSURE_KPA, " kPa"));
        }
        let tests = readings.plates.iter();
        let pressures = tests.clone().flat_map(|test| {
            let forces = test.force.iter();
            forces.map(|force| 1e-3 * force / test.plate.area)
        });
        let depths = tests.clone().flat_map(|test| &test.depth);
        let diameters = tests.map(|test| 2e3 * test.plate.width);
        let least = diameters.clone().fold(f64::INFINITY, f64::min);
        list.extend([
            number(
                "the largest pressure under a plate",
                max(pressures),
                limits::MAX_PRESSURE_KPA,
                " kPa",
            ),
            number(
                "the largest depth of a plate",
                1e3 * max(depths.copied()),
                limits::MAX_DEPTH_MM,
                " mm",
            ),
            number(
                "the diameter of the smallest plate",
                least,
                limits::DIAMETER_MM,
                " mm",
            ),
            number(
                "the diameter of the largest plate",
                max(diameters),
                limits::DIAMETER_MM,
                " mm",
            ),
        ]);
    }
    if let (Some(fit), Some(readings)) = (shear, &readings.shear) {
        let [cohesion, phi, k_shear] = fit.values;
        let ratios = readings.iter().map(|r| r.shear / r.normal);
        let ratios = ratios.filter(|ratio| ratio.is_finite());
        list.extend([
            number("cohesion", 1e-3 * cohesion, limits::COHESION_KPA, " kPa"),
            number("K", 1e3 * k_shear, limits::MODULUS_MM, " mm"),
            number(
                "the largest displacement",
                1e3 * max(readings.iter().map(|r| r.displacement)),
                limits::MAX_DISPLACEMENT_MM,
                " mm",
            ),
            number(
                "the largest normal stress",
                1e-3 * max(readings.iter().map(|r| r.normal)),
                limits::MAX_NORMAL_KPA,
                " kPa",
            ),
            number(
                "the largest shear stress over normal stress",
                max(ratios),
                limits::SHEAR_RATIO,
                "",
            ),
        ]);
        // saturated clay has no friction at all
        if phi > 0.0 {
            list.push(number("φ", phi.to_degrees(), limits::PHI_DEG, "°"));
        }
    }
    if let Some((job, _)) = &readings.wheel {
        let size = |of: fn(&RigidWheel) -> f64| 1e3 * of(&job.wheel);
        let radius = size(RigidWheel::radius);
        list.push(number(
            "the radius of the wheel",
            radius,
            limits::RADIUS_MM,
            " mm",
        ));
        let width = size(RigidWheel::width);
        list.push(number(
            "the width of the wheel",
            width,
            limits::WIDTH_MM,
            " mm",
        ));
    }
    list
}
