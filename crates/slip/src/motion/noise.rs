//! The kinds of noise, each with one level.

/// A kind of noise: of a process, or of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Noise {
    /// Random walk of the common logarithmic slip in motion, 1/s.
    Slip,
    /// Random walk of the drift in motion, 1/s.
    Drift,
    /// Random walk of the speed next to the accelerometer, (m/s)²/s.
    Speed,
    /// White noise of the turn rate, rad²/s.
    Turn,
    /// Random walk of the turn rate's bias, (rad/s)²/s.
    TurnBias,
    /// Random walk of the accelerometer's bias, (m/s²)²/s.
    ForceBias,
    /// Random walk of the reference's own place, m²/s.
    Wander,
    /// Readings of a place, m².
    Place,
    /// Readings of a heading, rad².
    Heading,
    /// Readings of a speed, (m/s)².
    SpeedReading,
    /// Wheels, as a multiple of the described variance.
    Wheel,
}

/// How many kinds there are.
pub const KINDS: usize = Noise::ALL.len();

impl Noise {
    /// All kinds, in the order of their numbers.
    pub const ALL: [Self; 11] = [
        Self::Slip,
        Self::Drift,
        Self::Speed,
        Self::Turn,
        Self::TurnBias,
        Self::ForceBias,
        Self::Wander,
        Self::Place,
        Self::Heading,
        Self::SpeedReading,
        Self::Wheel,
    ];

    /// Is it the noise of a process? Else that of a measurement.
    #[must_use]
    pub const fn is_process(self) -> bool {
        match self {
            Self::Slip
            | Self::Drift
            | Self::Speed
            | Self::Turn
            | Self::TurnBias
            | Self::ForceBias
            | Self::Wander => true,
            Self::Place | Self::Heading | Self::SpeedReading | Self::Wheel => false,
        }
    }
}

/// The level of each kind of noise, in the unit of its kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels(pub [f64; KINDS]);

impl Levels {
    /// The level of one kind.
    #[must_use]
    pub const fn of(&self, noise: Noise) -> f64 {
        self.0[noise as usize]
    }
}
