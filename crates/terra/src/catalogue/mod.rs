//! Published soils, each with its source and what is missing in it.
//!
//! Moduli keep the units in which such tables print them. A number that its source does not give is
//! `None` and never a default in silence: [`Entry::missing`] names what has to be completed.

mod table;

use crate::angle::Angle;
use crate::error::Result;
use crate::fitted_range::FittedRange;
use crate::law_preset::LawPreset;
use crate::open_soil::OpenSoil;
use crate::soil::Soil;

/// One published soil.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Entry {
    /// Its key, as `--soil` takes it.
    pub key: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Sinkage exponent n.
    pub n: f64,
    /// Growth of n with driving slip; 0 unless the source gives one.
    pub n_1: f64,
    /// k_c, kN/m^(n+1).
    pub k_c_kn: f64,
    /// k_phi, kN/m^(n+2).
    pub k_phi_kn: f64,
    /// Cohesion, kPa.
    pub cohesion_kpa: f64,
    /// Angle of internal friction, degrees.
    pub phi_deg: f64,
    /// Shear deformation modulus K, m.
    pub k_shear: Option<f64>,
    /// θ_m = (c_1 + c_2 s) θ_1.
    pub c_1: Option<f64>,
    /// θ_m = (c_1 + c_2 s) θ_1.
    pub c_2: Option<f64>,
    /// What else wheel tests determined; `None` for soils of the literature, whose laws are the classical ones.
    pub identified: Option<Identified>,
    /// Where the numbers come from.
    pub source: &'static str,
    /// What is second-hand, doubtful or worth knowing.
    pub note: &'static str,
}

/// Numbers that were identified from wheel tests, and the laws that they hold for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Identified {
    /// The laws.
    pub preset: LawPreset,
    /// Growth of n with braking slip.
    pub n_2: f64,
    /// Rebound ratio.
    pub rebound: f64,
    /// Unit weight, N/m³.
    pub unit_weight: f64,
    /// The tests.
    pub fitted: FittedRange,
}

/// Values that complete or override an entry.
///
/// ```
/// use grouser_terra::catalogue::{Completion, find};
///
/// // The source gives no K, c_1 and c_2 for this clay.
/// let clay = find("heavy-clay-25-wes").expect("in the catalogue");
/// assert!(clay.soil().is_err());
/// let completion = Completion { k_shear: Some(0.02), c_1: Some(0.4), c_2: Some(0.2), ..Completion::default() };
/// assert_eq!(clay.completed(&completion)?.params().k_shear, 0.02);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Completion {
    /// Shear deformation modulus K, m.
    pub k_shear: Option<f64>,
    /// θ_m = (c_1 + c_2 s) θ_1.
    pub c_1: Option<f64>,
    /// θ_m = (c_1 + c_2 s) θ_1.
    pub c_2: Option<f64>,
    /// Unit weight, N/m³.
    pub unit_weight: Option<f64>,
}

/// Every soil of the catalogue.
///
/// ```
/// let named = grouser_terra::catalogue::entries();
/// assert!(named.iter().any(|entry| entry.key == "lunar"));
/// ```
#[must_use]
pub fn entries() -> &'static [Entry] {
    table::ENTRIES
}

/// The soil of a key.
///
/// ```
/// let lunar = grouser_terra::catalogue::find("lunar").expect("in the catalogue");
/// assert_eq!(lunar.soil()?.params().n, lunar.n);
/// assert!(grouser_terra::catalogue::find("cheese").is_none());
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[must_use]
pub fn find(key: &str) -> Option<&'static Entry> {
    entries().iter().find(|entry| entry.key == key)
}

impl Completion {
    /// The soil of `open`, with what this completion gives in place of its numbers.
    ///
    /// # Errors
    /// [`Error::Missing`](crate::Error::Missing) with the first number that neither gives;
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for a bad one.
    pub fn complete(&self, open: &OpenSoil) -> Result<Soil> {
        OpenSoil {
            k_shear: self.k_shear.or(open.k_shear),
            c_1: self.c_1.or(open.c_1),
            c_2: self.c_2.or(open.c_2),
            unit_weight: self.unit_weight.or(open.unit_weight),
            ..*open
        }
        .soil()
    }
}

impl Entry {
    /// Its numbers; those that the source does not give are open.
    #[must_use]
    pub fn open(&self) -> OpenSoil {
        let open = self.literature();
        self.identified.map_or(open, |own| OpenSoil {
            n_2: own.n_2,
            rebound: own.rebound,
            unit_weight: Some(own.unit_weight),
            rear_drift: own.preset.rear_drift,
            sideways_support: own.preset.sideways_support,
            laws: own.preset.laws,
            fitted: Some(own.fitted),
            ..open
        })
    }

    fn literature(&self) -> OpenSoil {
        OpenSoil {
            n_1: self.n_1,
            k_shear: self.k_shear,
            c_1: self.c_1,
            c_2: self.c_2,
            ..Soil::bekker(1e3 * self.k_c_kn, 1e3 * self.k_phi_kn, self.n)
                .cohesion(1e3 * self.cohesion_kpa)
                .phi(Angle::from_deg(self.phi_deg))
        }
    }

    /// The soil, if the entry is complete.
    ///
    /// # Errors
    /// [`Error::Missing`](crate::Error::Missing) with the first of K, c_1 and c_2 that the source does not give.
    pub fn soil(&self) -> Result<Soil> {
        self.open().soil()
    }

    /// The soil with what `completion` gives in place of the entry's own or missing numbers.
    ///
    /// # Errors
    /// As [`Completion::complete`].
    pub fn completed(&self, completion: &Completion) -> Result<Soil> {
        completion.complete(&self.open())
    }

    /// The names of the numbers that the source does not give.
    ///
    /// ```
    /// let lunar = grouser_terra::catalogue::find("lunar").expect("in the catalogue");
    /// assert_eq!(lunar.missing().count(), 0);
    /// ```
    pub fn missing(&self) -> impl Iterator<Item = &'static str> + use<> {
        self.open().missing()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::find;
    use crate::{Soil, SoilParams};

    /// Dry sand with some numbers changed.
    pub(crate) fn dry_sand_with(change: impl Fn(&mut SoilParams)) -> Soil {
        let mut params = *find("dry-sand").unwrap().soil().unwrap().params();
        change(&mut params);
        Soil::new(params).unwrap()
    }
}
