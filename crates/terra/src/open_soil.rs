//! A soil of which numbers may still be open.

use core::convert::Infallible;

use crate::angle::Angle;
use crate::error::{Error, Result};
use crate::pressure::{Bekker, Pressure, Reece};
use crate::soil::{LawChoice, Soil, SoilParams};

/// A soil of which each number that a wheel needs may still be open: `None`, never a value that could pass for one.
///
/// [`Soil::bekker`] and [`Soil::reece`] begin one; what tables, tests and files leave open is filled in later, and
/// [`OpenSoil::soil`] names the first number that is still missing.
///
/// ```
/// use grouser_terra::{Angle, Soil};
///
/// let open = Soil::bekker(990.0, 1.528e6, 1.1) // N/m^(n+1), N/m^(n+2)
///     .cohesion(1040.0) // Pa
///     .phi(Angle::from_deg(28.0))
///     .k_shear(0.018); // m
/// assert_eq!(open.missing().collect::<Vec<_>>(), ["c_1", "c_2"]);
/// assert_eq!(open.soil().unwrap_err().field(), Some("c_1"));
/// let sand = open.stress_position(0.4, 0.2).soil()?;
/// assert_eq!(sand.params().cohesion, 1040.0);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
pub type OpenSoil = SoilParams<Option<f64>, Option<Angle>>;

impl Soil {
    /// Begins a soil with Bekker's moduli (N/m^(n+1), N/m^(n+2)) and exponent; the laws that zero switches off are off.
    #[must_use]
    pub fn bekker(k_c: f64, k_phi: f64, n: f64) -> OpenSoil {
        OpenSoil {
            pressure: Pressure::Bekker(Bekker {
                k_c: Some(k_c),
                k_phi: Some(k_phi),
            }),
            n: Some(n),
            ..OpenSoil::default()
        }
    }

    /// Begins a soil with Reece's moduli (pure numbers), exponent and unit weight (N/m³).
    #[must_use]
    pub fn reece(k_c_prime: f64, k_phi_prime: f64, n: f64, unit_weight: f64) -> OpenSoil {
        OpenSoil {
            pressure: Pressure::Reece(Reece {
                k_c_prime: Some(k_c_prime),
                k_phi_prime: Some(k_phi_prime),
            }),
            n: Some(n),
            unit_weight: Some(unit_weight),
            ..OpenSoil::default()
        }
    }
}

impl Default for OpenSoil {
    /// A soil of Bekker's law of which nothing is known; the laws that zero switches off are off.
    fn default() -> Self {
        Self {
            pressure: Pressure::Bekker(Bekker {
                k_c: None,
                k_phi: None,
            }),
            n: None,
            n_1: 0.0,
            n_2: 0.0,
            cohesion: None,
            phi: None,
            k_shear: None,
            k_shear_1: 0.0,
            k_shear_side: None,
            k_shear_side_1: 0.0,
            c_1: None,
            c_2: None,
            rebound: 0.0,
            unit_weight: None,
            rear_driving: 0.0,
            rear_drift: 0.0,
            transport_layer: 0.0,
            sideways_support: 1.0,
            laws: LawChoice::default(),
            fitted: None,
        }
    }
}

impl OpenSoil {
    /// With the cohesion c, Pa.
    #[must_use]
    pub const fn cohesion(self, pascals: f64) -> Self {
        Self {
            cohesion: Some(pascals),
            ..self
        }
    }

    /// With the angle of internal friction φ.
    #[must_use]
    pub const fn phi(self, angle: Angle) -> Self {
        Self {
            phi: Some(angle),
            ..self
        }
    }

    /// With the shear deformation modulus K, m.
    #[must_use]
    pub const fn k_shear(self, metres: f64) -> Self {
        Self {
            k_shear: Some(metres),
            ..self
        }
    }

    /// With the place of the greatest stress, θ_m = (c_1 + c_2 s) θ_1.
    #[must_use]
    pub const fn stress_position(self, c_1: f64, c_2: f64) -> Self {
        Self {
            c_1: Some(c_1),
            c_2: Some(c_2),
            ..self
        }
    }

    /// The names of the numbers that are still open.
    pub fn missing(&self) -> impl Iterator<Item = &'static str> + use<> {
        let moduli = match self.pressure {
            Pressure::Bekker(law) => [("k_c", law.k_c), ("k_phi", law.k_phi)],
            Pressure::Reece(law) => [
                ("k_c_prime", law.k_c_prime),
                ("k_phi_prime", law.k_phi_prime),
            ],
        };
        let others = [
            ("n", self.n),
            ("cohesion", self.cohesion),
            ("phi", self.phi.map(Angle::rad)),
            ("k_shear", self.k_shear),
            ("c_1", self.c_1),
            ("c_2", self.c_2),
        ];
        let all = moduli.into_iter().chain(others);
        all.filter_map(|(name, value)| value.is_none().then_some(name))
    }

    /// The numbers, none of them open and none of them checked.
    ///
    /// # Errors
    /// [`Error::Missing`] with the first number that is open.
    pub fn params(&self) -> Result<SoilParams> {
        fn need<T>(field: &'static str, value: Option<T>) -> Result<T> {
            value.ok_or(Error::Missing {
                field,
                needed_by: "the stress under a wheel",
            })
        }
        Ok(self.with_needed(Needed {
            pressure: self.pressure.each(need)?,
            n: need("n", self.n)?,
            cohesion: need("cohesion", self.cohesion)?,
            phi: need("phi", self.phi)?,
            k_shear: need("k_shear", self.k_shear)?,
            c_1: need("c_1", self.c_1)?,
            c_2: need("c_2", self.c_2)?,
        }))
    }

    /// The soil, each number checked.
    ///
    /// # Errors
    /// [`Error::Missing`] with the first number that is open; those of [`Soil::new`].
    pub fn soil(&self) -> Result<Soil> {
        Soil::new(self.params()?)
    }
}

impl From<SoilParams> for OpenSoil {
    fn from(p: SoilParams) -> Self {
        let Ok(pressure) = p
            .pressure
            .each(|_, modulus| Ok::<_, Infallible>(Some(modulus)));
        p.with_needed(Needed {
            pressure,
            n: Some(p.n),
            cohesion: Some(p.cohesion),
            phi: Some(p.phi),
            k_shear: Some(p.k_shear),
            c_1: Some(p.c_1),
            c_2: Some(p.c_2),
        })
    }
}

/// What every wheel needs of a soil.
struct Needed<N, A> {
    pressure: Pressure<N>,
    n: N,
    cohesion: N,
    phi: A,
    k_shear: N,
    c_1: N,
    c_2: N,
}

impl<N, A> SoilParams<N, A> {
    /// The same soil but for what every wheel needs.
    fn with_needed<M, B>(&self, needed: Needed<M, B>) -> SoilParams<M, B> {
        SoilParams {
            pressure: needed.pressure,
            n: needed.n,
            n_1: self.n_1,
            n_2: self.n_2,
            cohesion: needed.cohesion,
            phi: needed.phi,
            k_shear: needed.k_shear,
            k_shear_1: self.k_shear_1,
            k_shear_side: self.k_shear_side,
            k_shear_side_1: self.k_shear_side_1,
            c_1: needed.c_1,
            c_2: needed.c_2,
            rebound: self.rebound,
            unit_weight: self.unit_weight,
            rear_driving: self.rear_driving,
            rear_drift: self.rear_drift,
            transport_layer: self.transport_layer,
            sideways_support: self.sideways_support,
            laws: self.laws,
            fitted: self.fitted,
        }
    }
}
