//! The numbers that wheel tests can determine.

use grouser_files::soil::SoilNumber;
use grouser_real::Dual;
use grouser_terra::{OpenSoil, Pressure, SoilLaws};

use crate::least_squares::Bounded;

/// A number to be identified from wheel tests: of the soil, or of how the tests were measured.
///
/// ```
/// use grouser_identify::Parameter;
///
/// let phi = Parameter::named("phi_deg").expect("a parameter");
/// assert!((phi.to_key_unit(0.5) - 28.647_89).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Parameter {
    /// A number of the soil.
    Soil(SoilNumber),
    /// What must be taken from a measured sinkage: the height of the datum. A nuisance.
    SinkageDatum,
    /// What must be taken from a measured side force. A nuisance.
    SideDatum,
    /// What must be taken from a measured pull. A nuisance.
    PullDatum,
}

/// (parameter, lower bound, start, upper bound), in the unit of its key.
type Row = (Parameter, f64, f64, f64);

/// Bounds as wide as published soils go.
const ROWS: [Row; 18] = [
    (Parameter::Soil(SoilNumber::Exponent), 0.3, 1.1, 2.5),
    (Parameter::Soil(SoilNumber::ExponentDriving), 0.0, 0.2, 1.5),
    (Parameter::Soil(SoilNumber::ExponentBraking), 0.0, 0.3, 1.5),
    (Parameter::Soil(SoilNumber::KPhi), 10.0, 1500.0, 1e6),
    (Parameter::Soil(SoilNumber::Cohesion), 0.0, 0.5, 20.0),
    (Parameter::Soil(SoilNumber::Phi), 10.0, 30.0, 50.0),
    (Parameter::Soil(SoilNumber::KShear), 5e-4, 0.015, 0.1),
    (Parameter::Soil(SoilNumber::KShearAngle), 0.0, 0.01, 0.2),
    (Parameter::Soil(SoilNumber::C1), -0.5, 0.3, 1.0),
    (Parameter::Soil(SoilNumber::C2), -1.0, 0.3, 1.5),
    (Parameter::Soil(SoilNumber::Rebound), 1e-4, 0.2, 1.0),
    (Parameter::Soil(SoilNumber::RearDriving), 0.0, 1.0, 6.0),
    (Parameter::Soil(SoilNumber::RearDrift), 0.0, 1.0, 3.0),
    (
        Parameter::Soil(SoilNumber::TransportLayer),
        1e-6,
        0.003,
        0.05,
    ),
    (Parameter::Soil(SoilNumber::SidewaysSupport), 0.01, 0.3, 1.0),
    (Parameter::SinkageDatum, -0.05, 0.0, 0.05),
    (Parameter::SideDatum, -20.0, 0.0, 20.0),
    (Parameter::PullDatum, -20.0, 0.0, 20.0),
];

impl Parameter {
    /// Every parameter.
    pub fn all() -> impl Iterator<Item = Self> {
        ROWS.into_iter().map(|(parameter, ..)| parameter)
    }

    /// Its key in files, with its unit.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Soil(number) => number.key(),
            Self::SinkageDatum => "sinkage_datum_m",
            Self::SideDatum => "side_datum_n",
            Self::PullDatum => "pull_datum_n",
        }
    }

    /// The parameter of a key.
    #[must_use]
    pub fn named(key: &str) -> Option<Self> {
        Self::all().find(|parameter| parameter.key() == key)
    }

    /// An SI value in the unit of its key.
    #[must_use]
    pub fn to_key_unit(self, value: f64) -> f64 {
        value / self.key_unit()
    }

    pub(crate) const fn key_unit(self) -> f64 {
        match self {
            Self::Soil(number) => number.key_unit(),
            Self::SinkageDatum | Self::SideDatum | Self::PullDatum => 1.0,
        }
    }

    /// Do plates or shear tests measure it, so that a wheel test that finds it overrules a measurement?
    #[must_use]
    pub const fn is_measured(self) -> bool {
        use SoilNumber::{Cohesion, Exponent, KPhi, KShear, Phi};
        matches!(self, Self::Soil(Exponent | KPhi | Cohesion | Phi | KShear))
    }

    /// Its bounds, SI, and where a search begins: at what `soil` has, where that lies inside.
    #[must_use]
    pub fn bounded(self, soil: &OpenSoil) -> Bounded {
        let row = ROWS.into_iter().find(|(parameter, ..)| *parameter == self);
        let (_, lower, start, upper) = row.unwrap_or((self, f64::NAN, f64::NAN, f64::NAN));
        let unit = self.key_unit();
        let (lower, upper) = (lower * unit, upper * unit);
        let own = self.of(soil).filter(|own| *own > lower && *own < upper);
        Bounded {
            start: own.unwrap_or(start * unit),
            lower,
            upper,
        }
    }

    /// What `soil` has for it, SI; `None` where that is open, and where it is no number of a soil.
    #[must_use]
    pub fn of(self, soil: &OpenSoil) -> Option<f64> {
        match self {
            Self::Soil(number) => number.of(soil),
            Self::SinkageDatum | Self::SideDatum | Self::PullDatum => None,
        }
    }

    /// Puts `value` (SI) into a soil; a nuisance changes nothing.
    pub fn put(self, soil: &mut OpenSoil, value: f64) {
        if let Self::Soil(number) = self {
            number.put(soil, value);
        }
    }

    /// Puts a dual number into the laws of a soil, whose `k_shear_side` may be stated apart.
    pub(crate) fn put_dual<const N: usize>(
        self,
        laws: &mut SoilLaws<Dual<N>>,
        k_shear_side: Option<f64>,
        value: Dual<N>,
    ) {
        let Self::Soil(number) = self else { return };
        match number {
            SoilNumber::Exponent => laws.exponent.n_0 = value,
            SoilNumber::ExponentDriving => laws.exponent.n_1 = value,
            SoilNumber::ExponentBraking => laws.exponent.n_2 = value,
            SoilNumber::KPhi => {
                if let Pressure::Bekker(law) = &mut laws.pressure {
                    law.k_phi = value;
                }
            }
            SoilNumber::Cohesion => laws.strength.cohesion = value,
            SoilNumber::Phi => laws.strength.phi = value,
            SoilNumber::KShear => {
                laws.k_shear = value;
                if k_shear_side.is_none() {
                    laws.k_shear_side = value;
                }
            }
            SoilNumber::KShearAngle => {
                laws.k_shear_1 = value;
                if k_shear_side.is_none() {
                    laws.k_shear_side_1 = value;
                }
            }
            SoilNumber::C1 => laws.c_1 = value,
            SoilNumber::C2 => laws.c_2 = value,
            SoilNumber::Rebound => laws.rebound = value,
            SoilNumber::RearDriving => laws.rear_driving = value,
            SoilNumber::RearDrift => laws.rear_drift = value,
            SoilNumber::TransportLayer => laws.transport_layer = value,
            SoilNumber::SidewaysSupport => laws.sideways_support = value,
            // no parameter: plates find it
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_found_by_their_keys_and_put_into_a_soil() {
        let mut soil = grouser_terra::Soil::bekker(0.0, 1e6, 1.0);
        for (index, parameter) in Parameter::all().enumerate() {
            assert_eq!(Parameter::named(parameter.key()), Some(parameter));
            let value = 0.1 + 0.01 * index as f64;
            parameter.put(&mut soil, value);
            let there = parameter.of(&soil);
            let is_of_the_soil = matches!(parameter, Parameter::Soil(_));
            assert_eq!(there, is_of_the_soil.then_some(value));
        }
    }
}
