//! What the sensors measured over one step of time: the only input of the model.

use alloc::vec::Vec;

use super::noise::Noise;

/// One wheel over a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelStep {
    /// Distance by the wheel, forwards positive, m; `None` where the wheel was not measured.
    pub distance: Option<f64>,
    /// Variance of that distance, m².
    pub variance: f64,
    /// The speed of its centre along its heading is this row times (v_x, v_y, turn rate).
    pub row: [f64; 3],
    /// The same to the left of its heading.
    pub across: [f64; 3],
    /// Way of its centre along its heading by its steering alone, m: of a wheel that a joint swings about.
    pub swing: f64,
    /// Does it roll freely, without a motor?
    pub is_free: bool,
    /// Does it roll sideways as well (an omnidirectional wheel)?
    pub is_omni: bool,
}

/// One reading of a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// What was read.
    pub value: Value,
    /// How long before the step's end, s.
    pub since: f64,
    /// Variances are those of its kind times this.
    pub scale: f64,
}

/// What a reference reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Place in the reference's frame, m.
    Place([f64; 2]),
    /// Heading in the reference's frame, rad.
    Heading(f64),
    /// Speed over ground forwards, m/s.
    Speed(f64),
}

impl Value {
    /// The kind of its noise.
    #[must_use]
    pub const fn noise(self) -> Noise {
        match self {
            Self::Place(_) => Noise::Place,
            Self::Heading(_) => Noise::Heading,
            Self::Speed(_) => Noise::SpeedReading,
        }
    }
}

/// A frame of the reference that begins: where place and heading lie in it is known by its own readings only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewFrame {
    /// About where the robot is in it, m.
    pub place: [f64; 2],
    /// Its heading in it, rad, to the turn of one step; `None` where the reference measures no heading.
    pub heading: Option<f64>,
}

/// One step of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Step {
    /// The step's end, s.
    pub time: f64,
    /// Its length, s.
    pub dt: f64,
    /// Each wheel.
    pub wheels: Vec<WheelStep>,
    /// Turn by the gyro, rad.
    pub turn: Option<f64>,
    /// Mean specific force forwards and to the left, m/s².
    pub force: Option<[f64; 2]>,
    /// The frame in which the readings from this step on are, where it is a new one.
    pub frame: Option<NewFrame>,
    /// Readings of references in the order of time.
    pub readings: Vec<Reading>,
}

impl Step {
    /// Is any powered wheel measured?
    #[must_use]
    pub fn has_wheels(&self) -> bool {
        let mut wheels = self.wheels.iter();
        wheels.any(|wheel| !wheel.is_free && wheel.distance.is_some())
    }
}
