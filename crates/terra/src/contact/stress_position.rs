//! Where the normal stress is greatest: which slip moves it.

use grouser_real::Scalar;

use super::Motion;
use crate::kernel::laws;
use crate::pressure::level_off;
use crate::slip_velocity::{DrivingSlip, SlipNorm};

/// Which slip enters θ_m = (c_1 + c_2 s) θ_1 \[WR67\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
    /// f(hypot(s_x, s_y)) with f(x) = x (1 − x/2): as `Sliding`, levelling off towards full sliding
    /// ([`level_off`](crate::level_off)).
    ///
    /// Source: ours, on measured wheels that stand where `Sliding` buries them: locked, and at s = 0.9. No further number.
    Saturating,
}

laws!(StressPosition {
    InPlane: "in-plane" => [General, Quick, Lanes, Tape, Remainder],
    Magnitude: "magnitude" => [General, Quick, Lanes, Tape, Remainder],
    Whole: "whole" => [General, Quick, Lanes, Tape, Remainder],
    Sliding: "sliding" => [General, Quick, Lanes, Tape, Remainder],
    Saturating: "saturating" => [General, Quick, Lanes, Tape, Remainder],
});

impl StressPosition {
    /// The slip that enters of a wheel that drives straight ahead.
    #[must_use]
    pub const fn driving(self, norm: SlipNorm) -> DrivingSlip {
        match self {
            Self::InPlane | Self::Magnitude => DrivingSlip::PLAIN,
            Self::Whole | Self::Sliding => norm.driving(),
            Self::Saturating => norm.driving().levelling_off(),
        }
    }

    /// The slip that enters.
    pub(crate) fn slip_of<R: Scalar>(self, motion: &Motion<R>, norm: SlipNorm) -> R {
        match self {
            Self::InPlane => motion.slip,
            Self::Magnitude => motion.slip.abs(),
            Self::Whole => motion.slip_velocity_by(norm).working(),
            Self::Sliding => motion.slip_velocity_by(norm).sliding(),
            Self::Saturating => level_off(motion.slip_velocity_by(norm).sliding()),
        }
    }
}
