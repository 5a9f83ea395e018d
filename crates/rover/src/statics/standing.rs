//! Everything about a robot at rest on a slope: loads, margins, the pose of its links, and the posture that stands best.

use super::loads::{WheelLoads, wheel_loads};
use super::margins::{StabilityMargins, stability_margins};
use super::posture::{Posture, PostureLimits, adjusted_posture};
use super::stance::{Footing, Stance, stance};
use crate::error::{Error, Result};
use crate::robot::RobotModel;

/// Slopes on which a robot's rest is computed, rad either way: 60°.
const MAX_SLOPE_RAD: f64 = 1.05;

/// A robot at rest.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Standing {
    /// What each wheel carries.
    pub loads: WheelLoads,
    /// How far it is from tipping over.
    pub margins: StabilityMargins,
    /// The chassis adjusted for the slope, within the limits.
    pub posture: Posture,
    /// On level ground whose height differs from wheel to wheel: how links and chassis lie.
    pub stance: Option<Stance>,
}

impl Standing {
    /// The rest of `model` on a plane tilted by `pitch` (nose up) and `roll` (left side up), in rad; with a `footing` also on
    /// level ground of these heights.
    ///
    /// ```
    /// use grouser_rover::robot::RobotModel;
    /// use grouser_rover::statics::{PostureLimits, Standing};
    /// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/skid-steer.toml");
    /// let model = RobotModel::read(file.as_ref())?;
    /// let standing = Standing::new(&model, (0.2, 0.0), &PostureLimits::default(), None)?;
    /// // uphill the rear wheels carry more
    /// assert!(standing.loads.loads[2] > standing.loads.loads[0]);
    /// assert!(standing.margins.tip_over > 0.3);
    /// # Ok::<(), grouser_rover::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a slope beyond 60°, and what [`stance`] refuses.
    pub fn new(
        model: &RobotModel,
        (pitch, roll): (f64, f64),
        limits: &PostureLimits,
        footing: Option<&Footing<'_>>,
    ) -> Result<Self> {
        let slopes = (-MAX_SLOPE_RAD, MAX_SLOPE_RAD);
        Error::check("slope", "pitch", pitch, slopes, "rad")?;
        Error::check("slope", "roll", roll, slopes, "rad")?;
        Ok(Self {
            loads: wheel_loads(model, pitch, roll),
            margins: stability_margins(model, pitch, roll),
            posture: adjusted_posture(model, (pitch, roll), limits),
            stance: footing.map(|footing| stance(model, footing)).transpose()?,
        })
    }
}
