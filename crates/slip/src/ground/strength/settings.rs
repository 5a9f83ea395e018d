//! What is believed of a soil beforehand, and how the identifier works.

use core::f64::consts::LN_10;

use grouser_real::Real;
use grouser_terra::Soil;

use super::super::entry::Uncertain;
use super::covariance::Belief;
use crate::error::{Result, check_range};

/// The strengths that soils have: c in Pa, φ in rad, ln K with K in m (1 to 200 mm).
const LIMITS: [(f64, f64); 3] = [(0.0, 1e5), (0.02, 1.1), (-3.0 * LN_10, -1.609)];

/// What is believed of the soil's strength before any reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoilPrior {
    /// Cohesion, Pa.
    pub cohesion: Uncertain,
    /// Angle of internal friction, rad.
    pub phi: Uncertain,
    /// Shear deformation modulus, m; its sigma is taken relative to it.
    pub k_shear: Uncertain,
}

impl SoilPrior {
    /// Any soil of the catalogue's kind, centred on `soil`: sigma of c its value plus 500 Pa, of φ 6°, of K half of it.
    ///
    /// ```
    /// use grouser_slip::ground::SoilPrior;
    /// use grouser_terra::catalogue;
    ///
    /// let sand = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
    /// let prior = SoilPrior::around(&sand);
    /// assert_eq!(prior.cohesion.sigma, sand.params().cohesion + 500.0); // Pa
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    #[must_use]
    pub fn around(soil: &Soil) -> Self {
        let p = soil.params();
        Self {
            cohesion: Uncertain {
                value: p.cohesion,
                sigma: p.cohesion + 500.0,
            },
            phi: Uncertain {
                value: p.phi.rad(),
                sigma: 6_f64.to_radians(),
            },
            k_shear: Uncertain {
                value: p.k_shear,
                sigma: 0.5 * p.k_shear,
            },
        }
    }

    pub(crate) fn check(&self) -> Result<()> {
        let of = "soil prior";
        let [c, phi, _] = LIMITS;
        check_range(of, "cohesion", self.cohesion.value, c, "Pa")?;
        check_range(
            of,
            "sigma of cohesion",
            self.cohesion.sigma,
            (1e-3, 1e6),
            "Pa",
        )?;
        check_range(of, "phi", self.phi.value, phi, "rad")?;
        check_range(of, "sigma of phi", self.phi.sigma, (1e-6, 1.0), "rad")?;
        check_range(of, "k_shear", self.k_shear.value, (1e-3, 0.2), "m")?;
        check_range(of, "sigma of k_shear", self.k_shear.sigma, (1e-9, 1.0), "m")
    }

    pub(crate) fn belief(&self) -> Belief {
        let relative = self.k_shear.sigma / self.k_shear.value;
        Belief::apart(
            [
                self.cohesion.value,
                self.phi.value,
                Real::ln(self.k_shear.value),
            ],
            [self.cohesion.sigma, self.phi.sigma, relative],
        )
    }
}

/// Keeps a strength among those that soils have.
pub(crate) fn hold(mean: &mut [f64; 3]) {
    for (value, (low, high)) in mean.iter_mut().zip(LIMITS) {
        *value = value.clamp(low, high);
    }
}

/// How the identifier works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundSettings {
    /// Knowledge fades towards the prior with this time constant, s.
    pub memory: f64,
    /// Readings at one operating point are gathered into one mean for at most this long, s.
    pub stretch: f64,
    /// The stress model's own error, as a share of the torque.
    pub model_error: f64,
}

impl Default for GroundSettings {
    fn default() -> Self {
        Self {
            memory: 120.0,
            stretch: 2.0,
            model_error: 0.03,
        }
    }
}

impl GroundSettings {
    pub(crate) fn check(&self) -> Result<()> {
        check_range("ground settings", "memory", self.memory, (0.1, 1e9), "s")?;
        check_range(
            "ground settings",
            "model_error",
            self.model_error,
            (0.0, 1.0),
            "1",
        )
    }
}
