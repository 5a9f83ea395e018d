//! An angle whose unit is visible at the call.

/// A plane angle. It exists because an angle of friction given in degrees where radians are meant
/// produces plausible nonsense.
///
/// ```
/// use grouser_terra::Angle;
/// assert!((Angle::from_deg(30.0).sin() - 0.5).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Angle(f64);

impl Angle {
    /// The angle of `degrees` degrees.
    ///
    /// ```
    /// # use grouser_terra::Angle;
    /// assert_eq!(Angle::from_deg(180.0).rad(), core::f64::consts::PI);
    /// ```
    #[must_use]
    pub fn from_deg(degrees: f64) -> Self {
        Self(degrees.to_radians())
    }

    /// The angle of `radians` radians.
    #[must_use]
    pub const fn from_rad(radians: f64) -> Self {
        Self(radians)
    }

    /// In radians.
    #[must_use]
    pub const fn rad(self) -> f64 {
        self.0
    }

    /// In degrees.
    ///
    /// ```
    /// # use grouser_terra::Angle;
    /// assert!((Angle::from_rad(0.5).deg() - 28.647_889_756_541_16).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn deg(self) -> f64 {
        self.0.to_degrees()
    }

    /// Its sine.
    #[must_use]
    pub fn sin(self) -> f64 {
        grouser_real::Real::sin(self.0)
    }

    /// Its cosine.
    #[must_use]
    pub fn cos(self) -> f64 {
        grouser_real::Real::cos(self.0)
    }

    /// Its tangent.
    #[must_use]
    pub fn tan(self) -> f64 {
        grouser_real::Real::tan(self.0)
    }
}
