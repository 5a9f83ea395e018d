//! Where the normal stress is greatest: which slip moves it.

use grouser_real::Scalar;

use super::Motion;
use crate::slip_velocity::SlipNorm;

/// Which slip enters θ_m = (c_1 + c_2 s) θ_1 \[WR67\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum StressPosition {
    /// The slip in the wheel's plane, signed. The default.
    #[default]
    InPlane,
    /// |s| of the slip in the wheel's plane: the same place driving and braking.
    ///
    /// Source: unverified. Published models of braking wheels use the magnitude; no equation was seen.
    Magnitude,
    /// hypot(s_x⁺, s_t⁺), what the wheel drives and what it ploughs along its way together: both move the
    /// greatest stress forwards ([`SlipVelocity`](crate::SlipVelocity)). Straight ahead |s|.
    ///
    /// Source: ours. \[WR67\] II has other coefficients for a towed wheel than for a driven one; upstream of
    /// the Carnegie Mellon data gives θ_m a constant of its own while braking. Both say that the signed
    /// slip does not carry over; the size of the slip does so without a further number.
    Whole,
    /// hypot(s_x, s_y), the whole sliding of the rim over the ground whatever its direction
    /// ([`SlipVelocity`](crate::SlipVelocity)). Straight ahead |s| in the norm of the greater speed.
    ///
    /// Source: ours. With [`SlipNorm::Root`](crate::SlipNorm) it is smooth in the rim's speed wherever the wheel
    /// drifts; [`StressPosition::Whole`] has an edge where rω = V and another where rω cos β = V.
    Sliding,
}

impl StressPosition {
    /// Its name in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::InPlane => "in-plane",
            Self::Magnitude => "magnitude",
            Self::Whole => "whole",
            Self::Sliding => "sliding",
        }
    }

    /// The slip that enters.
    pub(crate) fn slip_of<R: Scalar>(self, motion: &Motion<R>, norm: SlipNorm) -> R {
        match self {
            Self::InPlane => motion.slip,
            Self::Magnitude => motion.slip.abs(),
            Self::Whole => motion.slip_velocity_by(norm).working(),
            Self::Sliding => motion.slip_velocity_by(norm).sliding(),
        }
    }
}
