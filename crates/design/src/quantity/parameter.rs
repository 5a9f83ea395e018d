//! The numbers that a wheel, its soil and its state are described by.

/// A number of `[wheel]`, `[soil]` or `[state]`; a variable of the same name replaces it.
///
/// ```
/// use grouser_design::{Parameter, Place};
///
/// let slope = Parameter::named("slope_deg").expect("a parameter");
/// assert_eq!((slope.place(), slope.default()), (Place::State, Some(0.0)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Parameter {
    /// Wheel radius, m.
    Radius,
    /// Wheel width, m.
    Width,
    /// Height of the grousers, m. Without their number they are a solid drum: every law uses r + h.
    GrouserHeight,
    /// How many grousers there are: they carry soil backwards and add thrust, and r is the rim's.
    GrouserCount,
    /// Their thickness along the rim, m.
    GrouserThickness,
    /// Sinkage exponent n.
    Exponent,
    /// Growth of n with driving slip.
    ExponentDriving,
    /// Growth of n with braking slip.
    ExponentBraking,
    /// k_c, kN/m^(n+1).
    KC,
    /// k_phi, kN/m^(n+2).
    KPhi,
    /// Cohesion, kPa.
    Cohesion,
    /// Angle of internal friction, degrees.
    Phi,
    /// Shear deformation modulus K, m.
    KShear,
    /// θ_m = (c_1 + c_2 s) θ_1.
    C1,
    /// θ_m = (c_1 + c_2 s) θ_1.
    C2,
    /// Rebound ratio λ.
    Rebound,
    /// Load on the wheel, N; on a slope its weight, of which W cos α is carried.
    Load,
    /// Sinkage, m, where it is given instead of a load.
    Sinkage,
    /// Slip s.
    Slip,
    /// Slope, degrees.
    Slope,
    /// An angle on the rim, degrees.
    Theta,
    /// Mobilised share x of the soil's strength.
    Mobilised,
}

/// Where a parameter is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// `[wheel]`.
    Wheel,
    /// `[soil]`.
    Soil,
    /// `[state]`.
    State,
}

impl Parameter {
    /// Every parameter with its name in files and formulas, its section and its default.
    pub const ALL: [(Self, &'static str, Place, Option<f64>); 22] = [
        (Self::Radius, "radius_m", Place::Wheel, None),
        (Self::Width, "width_m", Place::Wheel, None),
        (
            Self::GrouserHeight,
            "grouser_height_m",
            Place::Wheel,
            Some(0.0),
        ),
        (Self::GrouserCount, "grouser_count", Place::Wheel, Some(0.0)),
        (
            Self::GrouserThickness,
            "grouser_thickness_m",
            Place::Wheel,
            Some(0.0),
        ),
        (Self::Exponent, "n", Place::Soil, None),
        (Self::ExponentDriving, "n_1", Place::Soil, Some(0.0)),
        (Self::ExponentBraking, "n_2", Place::Soil, Some(0.0)),
        (Self::KC, "k_c_kn_per_m_n1", Place::Soil, None),
        (Self::KPhi, "k_phi_kn_per_m_n2", Place::Soil, None),
        (Self::Cohesion, "cohesion_kpa", Place::Soil, None),
        (Self::Phi, "phi_deg", Place::Soil, None),
        (Self::KShear, "k_shear_m", Place::Soil, None),
        (Self::C1, "c_1", Place::Soil, None),
        (Self::C2, "c_2", Place::Soil, None),
        (Self::Rebound, "rebound", Place::Soil, Some(0.0)),
        (Self::Load, "load_n", Place::State, None),
        (Self::Sinkage, "sinkage_m", Place::State, None),
        (Self::Slip, "slip", Place::State, None),
        (Self::Slope, "slope_deg", Place::State, Some(0.0)),
        (Self::Theta, "theta_deg", Place::State, None),
        (Self::Mobilised, "mobilised", Place::State, Some(0.0)),
    ];

    /// How many there are.
    pub const COUNT: usize = Self::ALL.len();

    /// The parameter of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL
            .iter()
            .find(|(_, known, ..)| *known == name)
            .map(|(parameter, ..)| *parameter)
    }

    fn entry(self) -> (Self, &'static str, Place, Option<f64>) {
        Self::ALL[self as usize]
    }

    /// Its name in files and formulas.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.entry().1
    }

    /// The section it is written in.
    #[must_use]
    pub fn place(self) -> Place {
        self.entry().2
    }

    /// Its value where nothing gives one.
    #[must_use]
    pub fn default(self) -> Option<f64> {
        self.entry().3
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_parameters() {
        for (index, (parameter, name, ..)) in Parameter::ALL.iter().enumerate() {
            assert_eq!(*parameter as usize, index);
            assert_eq!(Parameter::named(name), Some(*parameter));
        }
    }
}
