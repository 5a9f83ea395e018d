//! Named sets of laws, and what they are worth.

use crate::bulldozing::Bulldozing;
use crate::contact::StressPosition;
use crate::kinematics::Kinematics;
use crate::pressure::SlipSinkage;
use crate::shear::ShearLaw;
use crate::slip_velocity::SlipNorm;
use crate::soil::LawChoice;

/// A named set of laws, with the two numbers of a soil that belong to them: the key `laws` of a soil file.
///
/// ```
/// use grouser_terra::{LawChoice, LawPreset};
/// assert_eq!(LawPreset::named("drift"), Some(LawPreset::DRIFT));
/// assert_eq!(LawPreset::from_laws(&LawChoice::default()), LawPreset::CLASSICAL);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawPreset {
    /// Its name.
    pub key: &'static str,
    /// The laws.
    pub laws: LawChoice,
    /// [`SoilParams::rear_drift`](crate::SoilParams::rear_drift).
    pub rear_drift: f64,
    /// [`SoilParams::sideways_support`](crate::SoilParams::sideways_support).
    pub sideways_support: f64,
    /// By class of motion, without and with lugs ([`LawPreset::model_error`]).
    errors: Errors,
    /// Slip angle beyond which readings have a class of their own, rad.
    drift_class_rad: f64,
}

/// Half of each interval that holds 90 % of measured readings which the laws were not fitted to.
///
/// ```
/// use grouser_terra::{Kinematics, LawPreset, Slip};
/// let error = LawPreset::DRIFT.model_error(&Kinematics::straight(Slip::new(0.2)?), false);
/// assert_eq!(error.pull_per_load, 0.06);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ModelError {
    /// Of the drawbar pull, over the load.
    pub pull_per_load: f64,
    /// Of the side force, over the load.
    pub side_per_load: f64,
    /// Of the sinkage, over the radius.
    pub sinkage_per_radius: f64,
}

/// Slip beyond which readings have a class of their own.
const HIGH_SLIP: f64 = 0.75;

/// [`ModelError`]s by class.
type Errors = [[[f64; 3]; 2]; 3];

/// Pull and side force over the load, sinkage over the radius, of smooth wheels and of lugged ones: at slips beyond [`HIGH_SLIP`],
/// at slip angles beyond [`LawPreset::drift_class_rad`], and otherwise. 90 % quantiles of a fit on slip angle 0 alone, on the wheels at 15 to
/// 60° and with lugs (`cargo test -p grouser-campaign --test all held_out`); the pull of lugs is that of two further laboratories.
const DRIFT_ERRORS: Errors = [
    [[0.10, 0.10, 0.11], [0.22, 0.12, 0.11]],
    [[0.11, 0.15, 0.04], [0.12, 0.15, 0.04]],
    [[0.06, 0.055, 0.033], [0.12, 0.11, 0.033]],
];

/// The same of the classical laws, beyond a slip angle of 0: of Wong and Reece's laws fitted on slip angle 0, and at published numbers of the
/// soil in two further laboratories, which are all that is known of smooth wheels straight ahead (six readings).
const CLASSICAL_ERRORS: Errors = [
    [[0.37, 0.38, 0.27], [0.59, 0.21, 0.26]],
    [[0.52, 0.69, 0.31], [0.36, 0.32, 0.20]],
    [[0.12, 0.05, 0.04], [0.10, 0.05, 0.094]],
];

impl LawPreset {
    /// The laws of a soil that names none.
    pub const CLASSICAL: Self = Self {
        key: "classical",
        laws: LawChoice {
            slip_norm: SlipNorm::Greater,
            slip_sinkage: SlipSinkage::InPlane,
            stress_position: StressPosition::InPlane,
            shear: None,
            bulldozing: None,
        },
        rear_drift: 0.0,
        sideways_support: 1.0,
        errors: CLASSICAL_ERRORS,
        drift_class_rad: 1e-9,
    };

    /// Laws of wheels that slip and drift. Their forms were chosen on one wheel in one sand (docs/validate.md); a wheel that only
    /// slides sideways has no rear contact. `sideways_support` was chosen there at a slip angle of 90°: with 0.12 sinkage is off by
    /// 14 and 11 mm in place of 8 and 5, with 0.2 the side force by 14 and 11 N in place of 9 and 7; up to 60° no error changes by
    /// more than 0.02 of its unit.
    pub const DRIFT: Self = Self {
        key: "drift",
        laws: LawChoice {
            slip_norm: SlipNorm::Root,
            slip_sinkage: SlipSinkage::Ploughing,
            stress_position: StressPosition::Saturating,
            shear: Some(ShearLaw::SlipVelocityRegular),
            bulldozing: Some(Bulldozing::Disc),
        },
        rear_drift: 1.0,
        sideways_support: 0.16,
        errors: DRIFT_ERRORS,
        drift_class_rad: core::f64::consts::FRAC_PI_6 + 1e-9,
    };

    /// Every preset.
    pub const ALL: [Self; 2] = [Self::CLASSICAL, Self::DRIFT];

    /// What these laws miss of measurements in this motion.
    #[must_use]
    pub fn model_error(&self, motion: &Kinematics, has_lugs: bool) -> ModelError {
        let class = if motion.slip().value().abs() > HIGH_SLIP {
            0
        } else if motion.slip_angle().rad().abs() > self.drift_class_rad {
            1
        } else {
            2
        };
        let [pull_per_load, side_per_load, sinkage_per_radius] =
            self.errors[class][usize::from(has_lugs)];
        ModelError {
            pull_per_load,
            side_per_load,
            sinkage_per_radius,
        }
    }

    /// The preset of a name.
    #[must_use]
    pub fn named(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.key == key)
    }

    /// The preset of these laws; the classical one where no other has them.
    #[must_use]
    pub fn from_laws(laws: &LawChoice) -> Self {
        let own = Self::ALL.into_iter().find(|preset| preset.laws == *laws);
        own.unwrap_or(Self::CLASSICAL)
    }

    /// The preset whose comparison with measurements holds for these laws: they are its own, but for the edge that the shear along
    /// the slip velocity has and the regular law has not. `None` of a mix that was not compared.
    ///
    /// ```
    /// use grouser_terra::{LawChoice, LawPreset, ShearLaw, StressPosition};
    /// let edged = LawChoice { shear: Some(ShearLaw::SlipVelocity), ..LawPreset::DRIFT.laws };
    /// assert_eq!(LawPreset::compared(&edged), Some(LawPreset::DRIFT));
    /// let mix = LawChoice { stress_position: StressPosition::Sliding, ..edged };
    /// assert_eq!(LawPreset::compared(&mix), None);
    /// ```
    #[must_use]
    pub fn compared(laws: &LawChoice) -> Option<Self> {
        let named = |laws: &LawChoice| {
            let shear = laws.shear.unwrap_or_default();
            let shear = if shear.is_regular() {
                ShearLaw::SlipVelocity
            } else {
                shear
            };
            let bulldozing = laws.bulldozing.unwrap_or_default();
            LawChoice {
                shear: Some(shear),
                bulldozing: Some(bulldozing),
                ..*laws
            }
        };
        Self::ALL
            .into_iter()
            .find(|preset| named(&preset.laws) == named(laws))
    }
}
