//! Slip-sinkage: a slipping wheel digs, which Ding expresses by the sinkage exponent.

use grouser_real::{Real, Scalar};

use crate::kernel::laws;
use crate::slip_velocity::{DrivingSlip, SlipNorm, SlipVelocity};

/// Which slip the sinkage exponent grows with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SlipSinkage {
    /// The slip in the wheel's plane, as \[Ding11\] has it. The default.
    #[default]
    InPlane,
    /// The whole slip velocity, drift included ([`SinkageExponent::at_whole`]).
    Whole,
    /// As `Whole`, levelling off towards full slip ([`SinkageExponent::at_saturating`]).
    Saturating,
    /// Driving levels off, braking and ploughing do not, and soil is ploughed over the way that the wheel travels
    /// ([`SinkageExponent::at_ploughing`]).
    Ploughing,
}

impl SlipSinkage {
    /// The slip that the exponent of a wheel that drives straight ahead grows with.
    #[must_use]
    pub const fn driving(self, norm: SlipNorm) -> DrivingSlip {
        match self {
            Self::InPlane => DrivingSlip::PLAIN,
            Self::Whole => norm.driving(),
            Self::Saturating | Self::Ploughing => norm.driving().levelling_off(),
        }
    }

    /// Does the exponent fall where n_1 is negative, as against grow with its size?
    #[must_use]
    pub const fn is_signed(self) -> bool {
        match self {
            Self::InPlane => true,
            Self::Whole | Self::Saturating | Self::Ploughing => false,
        }
    }
}

// lanes have soils without slip-sinkage, of which all these laws are one
laws!(SlipSinkage {
    InPlane: "in-plane" => [General, Quick, Lanes, Tape, Remainder],
    Whole: "whole" => [General, Quick, Lanes, Tape, Remainder],
    Saturating: "saturating" => [General, Quick, Lanes, Tape, Remainder],
    Ploughing: "ploughing" => [General, Quick, Lanes, Tape, Remainder],
});

/// f(x) = x (1 − x/2): x where it is small, with no slope at full slip, x = 1.
///
/// ```
/// assert_eq!(grouser_terra::level_off(0.5_f64), 0.375);
/// ```
#[inline(always)]
pub fn level_off<R: Real>(x: R) -> R {
    x * (R::ONE - R::from_f64(0.5) * x)
}

/// The sinkage exponent as a function of slip by Ding: n = n_0 + n_1 s for s ≥ 0, n_0 − n_2 s for s < 0.
///
/// The moduli are held fixed in metres and pascals. n_1 = n_2 = 0 switches it off.
///
/// Source: Ding et al., J. Terramechanics 48 (2011) \[Ding11\].
/// Valid range: where n stays within the pressure law's own range. Sign: n_1, n_2 > 0 dig with
/// driving and braking slip.
///
/// ```
/// use grouser_terra::SinkageExponent;
/// let n = SinkageExponent { n_0: 0.92, n_1: 0.5, n_2: 0.0 }; // Mars simulation sand of Zhou et al. 2023
/// assert_eq!(n.at(0.2_f64), 0.92 + 0.5 * 0.2);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SinkageExponent<R = f64> {
    /// The exponent without slip.
    pub n_0: R,
    /// Its growth with driving slip.
    pub n_1: R,
    /// Its growth with braking slip.
    pub n_2: R,
}

impl<R: Real> SinkageExponent<R> {
    /// The exponent at `slip`.
    pub fn at(&self, slip: R) -> R {
        let driving = R::ZERO.le(slip);
        self.n_0 + R::select(driving, self.n_1, -self.n_2) * slip
    }
}

impl<R: Scalar> SinkageExponent<R> {
    /// The exponent at a slip velocity, drift included: n = n_0 + hypot(n_1 s_x⁺, n_2 s_x⁻, n_2 s_y).
    ///
    /// A wheel that slides sideways digs like one that slides forwards without turning. Straight ahead it is
    /// [`SinkageExponent::at`] for n_1, n_2 ≥ 0.
    ///
    /// Source: ours. Assumes: soil yields to the rim's sliding whatever its direction; driving, which
    /// carries soil backwards, and sliding, which pushes it, add as perpendicular things do.
    /// Valid range: tried on dry sand at slip angles of 0-60°; at 90° the wheel digs itself in to the hub.
    ///
    /// ```
    /// use grouser_terra::{Kinematics, SinkageExponent};
    /// let n = SinkageExponent { n_0: 1.4, n_1: 0.2, n_2: 0.3 };
    /// // at 1 m/s, the rim 0.4 m/s slower than the ground beneath it: s_x = −0.4, s_y = 0.3
    /// let forward = (1.0_f64 - 0.3 * 0.3).sqrt();
    /// let dragged = Kinematics::from_speeds(forward, 0.3, forward - 0.4)?.motion().slip_velocity();
    /// let exponent: f64 = n.at_whole(&dragged);
    /// assert!((exponent - (1.4 + 0.3 * 0.5)).abs() < 1e-12);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    pub fn at_whole(&self, slip: &SlipVelocity<R>) -> R {
        let dug = self.n_1 * slip.driving();
        let pushed = self.n_2 * slip.braking().hypot(slip.across);
        self.n_0 + dug.hypot(pushed)
    }

    /// The exponent at a slip velocity, levelling off: n = n_0 + hypot(n_1 f(s_x⁺), n_2 f(hypot(s_x⁻, s_y))) with
    /// f(x) = x (1 − x/2), whose slope is 1 at no slip and 0 at full slip.
    ///
    /// Source: ours, on measured wheels that stand as deep at s = 0.9 as at 0.75 and that are not buried when they
    /// are locked; no further number. Assumes and valid range: as [`SinkageExponent::at_whole`].
    ///
    /// ```
    /// use grouser_terra::{Kinematics, SinkageExponent};
    /// let n = SinkageExponent { n_0: 1.4, n_1: 0.2, n_2: 0.3 };
    /// let locked = Kinematics::from_speeds(0.8, 0.6, 0.0)?.motion().slip_velocity();
    /// let exponent: f64 = n.at_saturating(&locked);
    /// assert!((exponent - (1.4 + 0.3 * 0.5)).abs() < 1e-12);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    pub fn at_saturating(&self, slip: &SlipVelocity<R>) -> R {
        let dug = self.n_1 * level_off(slip.driving());
        let pushed = self.n_2 * level_off(slip.braking().hypot(slip.across));
        self.n_0 + dug.hypot(pushed)
    }

    /// The exponent of a wheel that digs, pushes and ploughs: n = n_0 + hypot(n_1 f(s_x⁺), n_2 g(s_x⁻), n_2 a) with
    /// f(x) = x (1 − x/2), g(x) = x (1 + x²/4) and `sideways` a = |v_y|/∛(V² m), m the speed that slip velocities are
    /// divided by ([`Motion::sideways_ploughing`](crate::Motion::sideways_ploughing)).
    ///
    /// Source: ours, on measured wheels. Driving, the sinkage levels off; pushed forwards without turning, a wheel sinks
    /// faster and faster until it is locked; and a wheel that drifts ploughs over each metre that it travels however fast its
    /// rim turns, where |v_y|/m would vanish. The cube root lies between both (|v_y|/m and |v_y|/V); it and g were chosen with
    /// the trials at 0, 15, 30 and 60° in view, locked wheels among them, so that these angles are no test of them. No
    /// further number.
    /// Assumes: as [`SinkageExponent::at_whole`]. Valid range: dry sand, slip angles of 0-60°; at 90° see
    /// [`Bulldozing::Disc`](crate::Bulldozing::Disc).
    ///
    /// ```
    /// use grouser_terra::{Kinematics, SinkageExponent, SlipNorm};
    /// let n = SinkageExponent { n_0: 1.4, n_1: 0.2, n_2: 0.3 };
    /// let locked = Kinematics::from_speeds(0.8, 0.6, 0.0)?.motion();
    /// let slip = locked.slip_velocity_by(SlipNorm::Root);
    /// let exponent: f64 = n.at_ploughing(&slip, locked.sideways_ploughing(SlipNorm::Root));
    /// assert!((exponent - (1.4 + 0.3 * (0.8 * 1.16_f64).hypot(0.6))).abs() < 1e-12);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    pub fn at_ploughing(&self, slip: &SlipVelocity<R>, sideways: R) -> R {
        let braking = slip.braking();
        let growing = braking * (R::ONE + R::from_f64(0.25) * braking * braking);
        let dug = self.n_1 * level_off(slip.driving());
        let pushed = self.n_2 * growing.hypot(sideways);
        self.n_0 + dug.hypot(pushed)
    }
}
