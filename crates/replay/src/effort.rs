//! What the motors draw.

/// The unit of what the motors draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffortUnit {
    /// Currents whose torque is not known, A.
    Ampere,
    /// Torques on the wheels, N m.
    NewtonMetre,
}

impl EffortUnit {
    /// Its symbol.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Ampere => "A",
            Self::NewtonMetre => "N m",
        }
    }
}
