//! What a user chooses about the computation.

use crate::bulldozing::Bulldozing;
use crate::shear::ShearLaw;
use crate::slope::MAX_SLIP;

/// How a wheel on soil is computed.
///
/// ```
/// use grouser_terra::{Accuracy, Settings};
///
/// let settings = Settings { accuracy: Accuracy::Reference, ..Settings::default() };
/// assert_eq!(settings.shear.key(), "coupled");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// How exactly the integrals are taken.
    pub accuracy: Accuracy,
    /// How displacement makes shear stress.
    pub shear: ShearLaw,
    /// How ploughed soil enters the side force.
    pub bulldozing: Bulldozing,
    /// A slope is held at a slip of at most this, driving or braking: [`MAX_SLIP`] by default.
    pub max_slip: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            accuracy: Accuracy::default(),
            shear: ShearLaw::default(),
            bulldozing: Bulldozing::default(),
            max_slip: MAX_SLIP,
        }
    }
}

/// How exactly the integrals are taken, relative to max(|W|, |DP|, |T|/r).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Accuracy {
    /// To 1e-6, for steps in time: with the coupled shear law and a sinkage up to half the radius several times as fast as
    /// `Standard`, which serves everywhere else.
    Simulation,
    /// To 1e-9, as fast as that can be had.
    #[default]
    Standard,
    /// To rounding, 1e-13.
    Reference,
}
