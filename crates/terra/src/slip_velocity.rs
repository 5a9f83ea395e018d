//! The slip velocity of a wheel that may drift, as two numbers of the order of a slip.

use grouser_real::{Real, Scalar};

use crate::contact::Motion;
use crate::kernel::laws;
use crate::pressure::level_off;

/// The velocity of the lowest point of the rim over the ground, over a speed m: s_x = (rω − v_x)/m and
/// s_y = |v_y|/m, with m = max(rω, V) or hypot(rω, V) ([`SlipNorm`]) and V = hypot(v_x, v_y).
///
/// Straight ahead and with max(rω, V), s_x is the slip itself, driving and braking, and s_y is 0. A wheel that is dragged
/// sideways without turning has s_x = 0 and s_y = 1.
///
/// Source: ours; the norm is the one in which the test beds that tow a wheel at a fixed speed state slip.
/// Sign: s_x positive where the rim runs ahead of the ground (driving).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SlipVelocity<R = f64> {
    /// s_x, in [−1, 1].
    pub along: R,
    /// s_y, in [0, 1].
    pub across: R,
    /// s_t = (V − rω cos β)/m, in [−1, 1]: the part along the way that the wheel travels, positive
    /// where the rim ploughs, that is, is dragged along. Straight ahead it is −s.
    pub ploughing: R,
}

/// By which speed a slip velocity is divided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SlipNorm {
    /// max(rω, V). The default: straight ahead s_x is the slip itself. A drifting wheel has an edge at rω = V.
    #[default]
    Greater,
    /// hypot(V, rω): smooth wherever the wheel moves. Straight ahead s_x = s/√(1 + (1 − |s|)²).
    ///
    /// Source: ours; the trials show no edge at rω = V.
    Root,
}

laws!(SlipNorm {
    Greater: "greater" => [General, Quick, Lanes, Tape, Remainder],
    Root: "root" => [General, Quick, Lanes, Tape, Remainder],
});

/// Which slip of a wheel that drives straight ahead a law takes: by it, kernels for such wheels need not know the law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrivingSlip {
    /// s/√(1 + (1 − s)²) in place of s.
    pub over_root: bool,
    /// f(x) = x (1 − x/2) of it ([`level_off`]).
    pub levels_off: bool,
}

impl DrivingSlip {
    /// The slip itself.
    pub(crate) const PLAIN: Self = Self {
        over_root: false,
        levels_off: false,
    };

    /// The same, levelling off.
    pub(crate) const fn levelling_off(self) -> Self {
        Self {
            levels_off: true,
            ..self
        }
    }

    /// What is taken of a slip of 0 or above.
    #[inline(always)]
    pub(crate) fn of<R: Real>(self, slip: R) -> R {
        let taken = if self.over_root {
            let forward = R::ONE - slip;
            slip / (R::ONE + forward * forward).sqrt()
        } else {
            slip
        };
        if self.levels_off {
            level_off(taken)
        } else {
            taken
        }
    }
}

impl SlipNorm {
    /// The slip velocity of a wheel that drives straight ahead.
    #[must_use]
    pub const fn driving(self) -> DrivingSlip {
        DrivingSlip {
            over_root: match self {
                Self::Greater => false,
                Self::Root => true,
            },
            ..DrivingSlip::PLAIN
        }
    }
}

/// The speeds of a wheel over the greater of rim and forward speed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Speeds<R> {
    /// rω.
    pub(crate) rim: R,
    /// v_x.
    pub(crate) forward: R,
    /// |v_y|.
    pub(crate) sideways: R,
    /// V = hypot(v_x, v_y).
    pub(crate) travel: R,
}

impl<R: Scalar> Speeds<R> {
    /// m, by which slip velocities are divided.
    fn scale(&self, norm: SlipNorm) -> R {
        match norm {
            SlipNorm::Greater => self.rim.max(self.travel),
            SlipNorm::Root => self.rim.hypot(self.travel),
        }
    }
}

impl<R: Scalar> Motion<R> {
    /// Rim, forward, sideways and travel speed, scaled so that a locked wheel needs no case of its own.
    pub(crate) fn speeds(&self) -> Speeds<R> {
        let driving = R::ZERO.le(self.slip);
        let rim = R::select(driving, R::ONE, R::ONE + self.slip);
        let forward = R::select(driving, R::ONE - self.slip, R::ONE);
        let locked = self.slip.le(-R::ONE);
        let sideways = self.q_y.abs() * R::select(locked, R::ONE, rim);
        Speeds {
            rim,
            forward,
            sideways,
            travel: forward.hypot(sideways),
        }
    }

    /// The slip velocity of this motion over the greater of rim and travel speed.
    ///
    /// ```
    /// use grouser_terra::{Angle, Kinematics, Slip};
    /// // 30° of drift, the rim turning as fast as the wheel travels: s_x = 1 − cos 30°, s_y = sin 30°
    /// let (v_x, v_y) = (30_f64.to_radians().cos(), 0.5);
    /// let slip = Kinematics::from_speeds(v_x, v_y, 1.0)?.motion::<f64>().slip_velocity();
    /// assert!((slip.along - (1.0 - v_x)).abs() < 1e-12 && (slip.across - 0.5).abs() < 1e-12);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    #[must_use]
    pub fn slip_velocity(&self) -> SlipVelocity<R> {
        self.slip_velocity_by(SlipNorm::Greater)
    }

    /// |v_y|/∛(V² m), between s_y = |v_y|/m and |sin β| = |v_y|/V, in [0, 1]: how much the wheel ploughs sideways over
    /// its way. 0 straight ahead.
    ///
    /// ```
    /// use grouser_terra::{Kinematics, SlipNorm};
    /// // across a wheel whose rim turns eight times as fast as it travels: ∛(1/8)
    /// let motion = Kinematics::from_speeds(0.0, 1.0, 8.0)?.motion::<f64>();
    /// assert!((motion.sideways_ploughing(SlipNorm::Greater) - 0.5).abs() < 1e-15);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    #[must_use]
    pub fn sideways_ploughing(&self, norm: SlipNorm) -> R {
        let speeds = self.speeds();
        if !(speeds.sideways.value() > 0.0) {
            return R::ZERO;
        }
        let third = R::from_f64(1.0 / 3.0);
        let share = speeds.travel / speeds.scale(norm); // in (0, 1]
        speeds.sideways / speeds.travel * share.powf(third)
    }

    /// The slip velocity of this motion in a norm.
    #[must_use]
    pub fn slip_velocity_by(&self, norm: SlipNorm) -> SlipVelocity<R> {
        let speeds = self.speeds();
        let scale = speeds.scale(norm);
        let Speeds {
            rim,
            forward,
            sideways,
            travel,
        } = speeds;
        let moves = R::ZERO.lt(travel);
        let cosine = R::select(moves, forward / R::select(moves, travel, R::ONE), R::ONE);
        SlipVelocity {
            ploughing: (travel - rim * cosine) / scale,
            along: (rim - forward) / scale,
            across: sideways / scale,
        }
    }
}

impl<R: Scalar> SlipVelocity<R> {
    /// s_x where the wheel drives, else 0.
    pub fn driving(&self) -> R {
        self.along.max(R::ZERO)
    }

    /// |s_x| where the wheel brakes, else 0.
    pub fn braking(&self) -> R {
        (-self.along).max(R::ZERO)
    }

    /// hypot(s_x, s_y): all of it, in [0, 1].
    pub fn sliding(&self) -> R {
        self.along.abs().hypot(self.across)
    }

    /// hypot(s_x⁺, s_t⁺), driving and ploughing together: straight ahead |s|.
    pub fn working(&self) -> R {
        self.driving().hypot(self.ploughing.max(R::ZERO))
    }
}

#[cfg(test)]
mod tests {
    use crate::{Kinematics, Slip};

    #[test]
    fn straight_ahead_it_is_the_slip() {
        for s in [-1.0, -0.7, 0.0, 0.3, 1.0] {
            let motion = Kinematics::straight(Slip::new(s).unwrap()).motion::<f64>();
            let slip = motion.slip_velocity();
            assert!((slip.along - s).abs() < 1e-15 && slip.across == 0.0, "{s}");
            assert!((slip.working() - s.abs()).abs() < 1e-15 && (slip.ploughing + s).abs() < 1e-15);
        }
    }

    #[test]
    fn it_is_continuous_where_the_wheel_locks() {
        let at = |rim| {
            let motion = Kinematics::from_speeds(0.8, 0.6, rim).unwrap();
            motion.motion::<f64>().slip_velocity()
        };
        let (locked, nearly) = (at(0.0), at(1e-9));
        assert!((locked.along + 0.8).abs() < 1e-12 && (locked.across - 0.6).abs() < 1e-12);
        assert!((locked.along - nearly.along).abs() < 1e-8);
        assert!((locked.across - nearly.across).abs() < 1e-8);
    }

    #[test]
    fn a_wheel_that_only_drifts_has_a_finite_one() {
        let motion = Kinematics::from_speeds(0.0, 0.5, 1.0).unwrap();
        let slip = motion.motion::<f64>().slip_velocity();
        assert_eq!((slip.along, slip.across), (1.0, 0.5));
    }
}
