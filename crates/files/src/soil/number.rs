//! The numbers of a soil: key, unit, and place in the parameters.

use grouser_terra::{Angle, BatchInput, Bekker, OpenSoil, Pressure, SoilColumns};

/// A number of a soil that files, intervals and identification name by its key.
///
/// ```
/// use grouser_files::soil::SoilNumber;
/// use grouser_terra::Soil;
///
/// let phi = SoilNumber::named("phi_deg").expect("a number");
/// let mut soil = Soil::bekker(0.0, 1e6, 1.0);
/// assert_eq!(phi.of(&soil), None);
/// phi.put(&mut soil, 0.5); // rad
/// assert!((phi.of(&soil).expect("just put") / phi.key_unit() - 28.647_89).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum SoilNumber {
    /// Sinkage exponent n.
    Exponent,
    /// Growth of n with driving slip.
    ExponentDriving,
    /// Growth of n with braking slip (and drift).
    ExponentBraking,
    /// Cohesive modulus k_c.
    KC,
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
    /// Share of the pressure that is left where the wheel moves sideways.
    SidewaysSupport,
}

/// Number, key, SI units of one of the key's unit.
const ROWS: [(SoilNumber, &str, f64); 16] = [
    (SoilNumber::Exponent, "n", 1.0),
    (SoilNumber::ExponentDriving, "n_1", 1.0),
    (SoilNumber::ExponentBraking, "n_2", 1.0),
    (SoilNumber::KC, "k_c_kn_per_m_n1", 1e3),
    (SoilNumber::KPhi, "k_phi_kn_per_m_n2", 1e3),
    (SoilNumber::Cohesion, "cohesion_kpa", 1e3),
    (SoilNumber::Phi, "phi_deg", std::f64::consts::PI / 180.0),
    (SoilNumber::KShear, "k_shear_m", 1.0),
    (SoilNumber::KShearAngle, "k_shear_1_m_per_rad", 1.0),
    (SoilNumber::C1, "c_1", 1.0),
    (SoilNumber::C2, "c_2", 1.0),
    (SoilNumber::Rebound, "rebound", 1.0),
    (SoilNumber::RearDriving, "rear_driving", 1.0),
    (SoilNumber::RearDrift, "rear_drift", 1.0),
    (SoilNumber::TransportLayer, "transport_layer_m", 1.0),
    (SoilNumber::SidewaysSupport, "sideways_support", 1.0),
];

impl SoilNumber {
    /// Every number, in the order of soil files.
    pub fn all() -> impl Iterator<Item = Self> {
        ROWS.into_iter().map(|(number, ..)| number)
    }

    /// Its key in files, with its unit.
    #[must_use]
    pub const fn key(self) -> &'static str {
        ROWS[self as usize].1
    }

    /// One of the key's unit, in SI: 1000 for `cohesion_kpa`.
    #[must_use]
    pub const fn key_unit(self) -> f64 {
        ROWS[self as usize].2
    }

    /// The number of a key.
    #[must_use]
    pub fn named(key: &str) -> Option<Self> {
        Self::all().find(|number| number.key() == key)
    }

    /// What a soil has for it, SI; `None` where it is open, and for a modulus that the pressure law does not have.
    #[must_use]
    pub fn of(self, soil: &OpenSoil) -> Option<f64> {
        match self {
            Self::Exponent => soil.n,
            Self::ExponentDriving => Some(soil.n_1),
            Self::ExponentBraking => Some(soil.n_2),
            Self::KC | Self::KPhi => match soil.pressure {
                Pressure::Bekker(Bekker { k_c, .. }) if matches!(self, Self::KC) => k_c,
                Pressure::Bekker(Bekker { k_phi, .. }) => k_phi,
                Pressure::Reece(_) => None,
            },
            Self::Cohesion => soil.cohesion,
            Self::Phi => soil.phi.map(Angle::rad),
            Self::KShear => soil.k_shear,
            Self::KShearAngle => Some(soil.k_shear_1),
            Self::C1 => soil.c_1,
            Self::C2 => soil.c_2,
            Self::Rebound => Some(soil.rebound),
            Self::RearDriving => Some(soil.rear_driving),
            Self::RearDrift => Some(soil.rear_drift),
            Self::TransportLayer => Some(soil.transport_layer),
            Self::SidewaysSupport => Some(soil.sideways_support),
        }
    }

    /// Its column in a batch with a soil for each point; `None` where a batch has none.
    pub const fn column<'a, 'b>(
        self,
        columns: &'b mut SoilColumns<'a>,
    ) -> Option<&'b mut BatchInput<'a>> {
        Some(match self {
            Self::KC => &mut columns.k_c,
            Self::KPhi => &mut columns.k_phi,
            Self::Exponent => &mut columns.n,
            Self::Cohesion => &mut columns.cohesion,
            Self::Phi => &mut columns.phi,
            Self::KShear => &mut columns.k_shear,
            Self::C1 => &mut columns.c_1,
            Self::C2 => &mut columns.c_2,
            _ => return None,
        })
    }

    /// Puts `value` (SI) into a soil; a modulus that the soil's pressure law does not have changes nothing.
    pub const fn put(self, soil: &mut OpenSoil, value: f64) {
        match self {
            Self::Exponent => soil.n = Some(value),
            Self::ExponentDriving => soil.n_1 = value,
            Self::ExponentBraking => soil.n_2 = value,
            Self::KC => {
                if let Pressure::Bekker(law) = &mut soil.pressure {
                    law.k_c = Some(value);
                }
            }
            Self::KPhi => {
                if let Pressure::Bekker(law) = &mut soil.pressure {
                    law.k_phi = Some(value);
                }
            }
            Self::Cohesion => soil.cohesion = Some(value),
            Self::Phi => soil.phi = Some(Angle::from_rad(value)),
            Self::KShear => soil.k_shear = Some(value),
            Self::KShearAngle => soil.k_shear_1 = value,
            Self::C1 => soil.c_1 = Some(value),
            Self::C2 => soil.c_2 = Some(value),
            Self::Rebound => soil.rebound = value,
            Self::RearDriving => soil.rear_driving = value,
            Self::RearDrift => soil.rear_drift = value,
            Self::TransportLayer => soil.transport_layer = value,
            Self::SidewaysSupport => soil.sideways_support = value,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grouser_terra::Soil;

    #[test]
    fn rows_stand_in_the_order_of_the_numbers_and_what_is_put_is_there() {
        let mut soil = Soil::bekker(0.0, 1e6, 1.0);
        for (index, number) in SoilNumber::all().enumerate() {
            assert_eq!(number as usize, index);
            assert_eq!(SoilNumber::named(number.key()), Some(number));
            let value = 0.1 + 0.01 * index as f64;
            number.put(&mut soil, value);
        }
        for (index, number) in SoilNumber::all().enumerate() {
            assert_eq!(number.of(&soil), Some(0.1 + 0.01 * index as f64));
        }
    }
}
