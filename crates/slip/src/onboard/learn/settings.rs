//! How soil is learnt.

use crate::error::{Result, check_range};

/// How soil is learnt while driving.
///
/// ```
/// use grouser_slip::onboard::SoilLearnSettings;
///
/// let mut settings = SoilLearnSettings::default();
/// settings.check()?;
/// settings.forget = 2.0;
/// assert_eq!(settings.check().unwrap_err().to_string(), "soil learning: forget is 2, but must lie in [0, 0.5]");
/// # Ok::<(), grouser_slip::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SoilLearnSettings {
    /// Standard deviations of the logarithms of strength and stiffness before anything is learnt: half of the strengths
    /// within 0.8 to 1.25, half of the stiffnesses within 0.45 to 2.2 of the known soil's.
    pub prior_sigma_ln: [f64; 2],
    /// The model's own error in pull and in torque, as a part of the load, and as a share of the value. Slips of one wheel
    /// and soil differ between the laws of shear by about a sixth.
    pub model_error: [f64; 2],
    /// The model's own error in the sinkage of a leading wheel, as a part of its radius and as a share of the value: lugs and
    /// crumbling walls; loads that move on slopes, and exponents n of another soil.
    pub sinkage_error: [f64; 2],
    /// Standard deviation of a sinkage, m: of its sensor's lasting error and of its noise over half a turn of the wheel.
    pub sinkage_sigma: f64,
    /// The same of an entry angle, rad.
    pub entry_angle_sigma: f64,
    /// Weight of a reading, below 1 because the model's errors of successive readings are the same ones.
    pub weight: f64,
    /// Share of the prior that returns with every reading: the way back from a belief that has become wrong.
    pub forget: f64,
    /// A new belief is used once it differs from the one in use by this probability.
    pub hysteresis: f64,
}

impl Default for SoilLearnSettings {
    fn default() -> Self {
        Self {
            prior_sigma_ln: [0.33, 1.2],
            model_error: [0.02, 0.15],
            sinkage_error: [0.02, 0.25],
            sinkage_sigma: 0.003,
            entry_angle_sigma: 0.05,
            weight: 0.3,
            forget: 0.02,
            hysteresis: 0.3,
        }
    }
}

impl SoilLearnSettings {
    /// Checks every number.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) that names the field.
    pub fn check(&self) -> Result<()> {
        let [strength, stiffness] = self.prior_sigma_ln;
        let [part, share] = self.model_error;
        let [depth, depth_share] = self.sinkage_error;
        let (sinkage, angle) = (self.sinkage_sigma, self.entry_angle_sigma);
        check_range("soil learning", "sinkage_sigma", sinkage, (1e-6, 1.0), "m")?;
        check_range(
            "soil learning",
            "entry_angle_sigma",
            angle,
            (1e-6, 1.0),
            "rad",
        )?;
        for (field, value, limits) in [
            ("strength_sigma_ln", strength, (0.01, 2.0)),
            ("stiffness_sigma_ln", stiffness, (0.01, 5.0)),
            ("model_error", part, (1e-3, 1.0)),
            ("model_error_share", share, (0.0, 1.0)),
            ("sinkage_error", depth, (1e-3, 1.0)),
            ("sinkage_error_share", depth_share, (0.0, 1.0)),
            ("weight", self.weight, (0.0, 1.0)),
            ("forget", self.forget, (0.0, 0.5)),
            ("hysteresis", self.hysteresis, (0.0, 1.0)),
        ] {
            check_range("soil learning", field, value, limits, "1")?;
        }
        Ok(())
    }
}
