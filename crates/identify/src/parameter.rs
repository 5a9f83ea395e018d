//! The numbers that wheel tests can determine.

use grouser_real::Dual;
use grouser_terra::{Angle, Pressure, SoilLaws, SoilParams};

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
    /// Sinkage exponent n.
    Exponent,
    /// Growth of n with driving slip.
    ExponentDriving,
    /// Growth of n with braking slip (and drift).
    ExponentBraking,
    /// Frictional modulus k_phi.
    KPhi,
    /// Cohesion.
    Cohesion,
    /// Angle of internal friction.
    Phi,
    /// Shear deformation modulus K.
    KShear,
    /// Growth of K with the slip angle.
    KShearAngle,
    /// c_1 of θ_m = (c_1 + c_2 s) θ_1.
    C1,
    /// c_2 of it.
    C2,
    /// Rebound ratio λ.
    Rebound,
    /// Loss of the rear contact with driving slip.
    RearDriving,
    /// Loss of the rear contact with drift.
    RearDrift,
    /// Layer that a driving rim carries backwards.
    TransportLayer,
    /// What must be taken from a measured sinkage: the height of the datum. A nuisance.
    SinkageDatum,
    /// What must be taken from a measured side force. A nuisance.
    SideDatum,
    /// What must be taken from a measured pull. A nuisance.
    PullDatum,
}

/// (parameter, its key in files, SI units of one of the key's unit, lower bound, start, upper bound)
type Row = (Parameter, &'static str, f64, f64, f64, f64);

/// Bounds as wide as published soils go, in the key's unit.
const ROWS: [Row; 17] = [
    (Parameter::Exponent, "n", 1.0, 0.3, 1.1, 2.5),
    (Parameter::ExponentDriving, "n_1", 1.0, 0.0, 0.2, 1.5),
    (Parameter::ExponentBraking, "n_2", 1.0, 0.0, 0.3, 1.5),
    (Parameter::KPhi, "k_phi_kn_per_m_n2", 1e3, 10.0, 1500.0, 1e6),
    (Parameter::Cohesion, "cohesion_kpa", 1e3, 0.0, 0.5, 20.0),
    (
        Parameter::Phi,
        "phi_deg",
        std::f64::consts::PI / 180.0,
        10.0,
        30.0,
        50.0,
    ),
    (Parameter::KShear, "k_shear_m", 1.0, 5e-4, 0.015, 0.1),
    (
        Parameter::KShearAngle,
        "k_shear_1_m_per_rad",
        1.0,
        0.0,
        0.01,
        0.2,
    ),
    (Parameter::C1, "c_1", 1.0, -0.5, 0.3, 1.0),
    (Parameter::C2, "c_2", 1.0, -1.0, 0.3, 1.5),
    (Parameter::Rebound, "rebound", 1.0, 1e-4, 0.2, 1.0),
    (Parameter::RearDriving, "rear_driving", 1.0, 0.0, 1.0, 6.0),
    (Parameter::RearDrift, "rear_drift", 1.0, 0.0, 1.0, 3.0),
    (
        Parameter::TransportLayer,
        "transport_layer_m",
        1.0,
        1e-6,
        0.003,
        0.05,
    ),
    (
        Parameter::SinkageDatum,
        "sinkage_datum_m",
        1.0,
        -0.05,
        0.0,
        0.05,
    ),
    (Parameter::SideDatum, "side_datum_n", 1.0, -20.0, 0.0, 20.0),
    (Parameter::PullDatum, "pull_datum_n", 1.0, -20.0, 0.0, 20.0),
];

impl Parameter {
    /// Every parameter.
    pub const ALL: [Self; 17] = {
        let mut all = [Self::Exponent; 17];
        let mut i = 0;
        while i < 17 {
            all[i] = ROWS[i].0;
            i += 1;
        }
        all
    };

    fn row(self) -> &'static Row {
        &ROWS[self as usize]
    }

    /// Its key in files, with its unit.
    #[must_use]
    pub fn key(self) -> &'static str {
        self.row().1
    }

    /// The parameter of a key.
    #[must_use]
    pub fn named(key: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|parameter| parameter.key() == key)
    }

    /// An SI value in the unit of its key.
    #[must_use]
    pub fn to_key_unit(self, value: f64) -> f64 {
        value / self.row().2
    }

    /// Is it a property of how the tests were measured, not of the soil?
    #[must_use]
    pub const fn is_nuisance(self) -> bool {
        matches!(self, Self::SinkageDatum | Self::SideDatum | Self::PullDatum)
    }

    /// Do plates or shear tests measure it, so that a wheel test that finds it overrules a measurement?
    #[must_use]
    pub const fn is_measured(self) -> bool {
        matches!(
            self,
            Self::Exponent | Self::KPhi | Self::Cohesion | Self::Phi | Self::KShear
        )
    }

    /// Its bounds, SI, and where a search begins: at what `soil` has, where that lies inside.
    #[must_use]
    pub fn bounded(self, soil: &SoilParams) -> Bounded {
        let (_, _, unit, lower, start, upper) = *self.row();
        let own = self.of(soil);
        let (lower, upper) = (lower * unit, upper * unit);
        let inside = own > lower && own < upper;
        Bounded {
            start: if inside { own } else { start * unit },
            lower,
            upper,
        }
    }

    /// What `soil` has for it, SI; NaN where it is no number of a soil.
    #[must_use]
    pub fn of(self, soil: &SoilParams) -> f64 {
        match self {
            Self::Exponent => soil.n,
            Self::ExponentDriving => soil.n_1,
            Self::ExponentBraking => soil.n_2,
            Self::KPhi => match soil.pressure {
                Pressure::Bekker(law) => law.k_phi,
                _ => f64::NAN,
            },
            Self::Cohesion => soil.cohesion,
            Self::Phi => soil.phi.rad(),
            Self::KShear => soil.k_shear,
            Self::KShearAngle => soil.k_shear_1,
            Self::C1 => soil.c_1,
            Self::C2 => soil.c_2,
            Self::Rebound => soil.rebound,
            Self::RearDriving => soil.rear_driving,
            Self::RearDrift => soil.rear_drift,
            Self::TransportLayer => soil.transport_layer,
            Self::SinkageDatum | Self::SideDatum | Self::PullDatum => f64::NAN,
        }
    }

    /// Puts `value` (SI) into a soil; a nuisance changes nothing.
    pub fn put(self, soil: &mut SoilParams, value: f64) {
        match self {
            Self::Exponent => soil.n = value,
            Self::ExponentDriving => soil.n_1 = value,
            Self::ExponentBraking => soil.n_2 = value,
            Self::KPhi => {
                if let Pressure::Bekker(law) = &mut soil.pressure {
                    law.k_phi = value;
                }
            }
            Self::Cohesion => soil.cohesion = value,
            Self::Phi => soil.phi = Angle::from_rad(value),
            Self::KShear => soil.k_shear = value,
            Self::KShearAngle => soil.k_shear_1 = value,
            Self::C1 => soil.c_1 = value,
            Self::C2 => soil.c_2 = value,
            Self::Rebound => soil.rebound = value,
            Self::RearDriving => soil.rear_driving = value,
            Self::RearDrift => soil.rear_drift = value,
            Self::TransportLayer => soil.transport_layer = value,
            Self::SinkageDatum | Self::SideDatum | Self::PullDatum => {}
        }
    }

    /// Puts a dual number into the laws.
    pub(crate) fn put_dual<const N: usize>(self, laws: &mut SoilLaws<Dual<N>>, value: Dual<N>) {
        match self {
            Self::Exponent => laws.exponent.n_0 = value,
            Self::ExponentDriving => laws.exponent.n_1 = value,
            Self::ExponentBraking => laws.exponent.n_2 = value,
            Self::KPhi => {
                if let Pressure::Bekker(law) = &mut laws.pressure {
                    law.k_phi = value;
                }
            }
            Self::Cohesion => laws.strength.cohesion = value,
            Self::Phi => laws.strength.phi = value,
            Self::KShear => {
                laws.k_shear = value;
                laws.k_shear_side = value;
            }
            Self::KShearAngle => {
                laws.k_shear_1 = value;
                laws.k_shear_side_1 = value;
            }
            Self::C1 => laws.c_1 = value,
            Self::C2 => laws.c_2 = value,
            Self::Rebound => laws.rebound = value,
            Self::RearDriving => laws.rear_driving = value,
            Self::RearDrift => laws.rear_drift = value,
            Self::TransportLayer => laws.transport_layer = value,
            Self::SinkageDatum | Self::SideDatum | Self::PullDatum => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_in_the_order_of_the_parameters() {
        for (index, parameter) in Parameter::ALL.into_iter().enumerate() {
            assert_eq!(parameter as usize, index);
            assert_eq!(Parameter::named(parameter.key()), Some(parameter));
        }
    }

    #[test]
    fn what_is_put_is_there() {
        let mut soil = SoilParams::bekker(0.0, 1e6, 1.0);
        for (index, parameter) in Parameter::ALL.into_iter().enumerate() {
            let value = 0.1 + 0.01 * index as f64;
            parameter.put(&mut soil, value);
            let there = parameter.of(&soil);
            assert!(parameter.is_nuisance() == there.is_nan());
            assert!(parameter.is_nuisance() || there == value);
        }
    }
}
