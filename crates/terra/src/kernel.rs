//! Which kernel serves which law.
//!
//! A law lists the kernels that compute it, next to its name in files; a kernel that a law does not list passes the point
//! on to the general contact, or refuses the law by its name. A new law is thus computed by the general contact alone
//! until it is written for another kernel and listed there.

use crate::soil::{LawChoice, SoilParams};

/// What computes the forces on a wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// [`Contact`](crate::Contact): every law, every motion, every kind of number.
    General,
    /// One point to 1e-6, for steps in time ([`Accuracy::Simulation`](crate::Accuracy)).
    Quick,
    /// Eight points at a time, of wheels that drive straight ahead ([`BatchKernel`](crate::BatchKernel)).
    Lanes,
    /// The operations of a proof, for wheels that drive straight ahead (crate `grouser-design`).
    Tape,
    /// The proved bound of what the tape's rule of integration leaves out (crate `grouser-design`).
    Remainder,
}

/// A law in use: what it is a law of, its name, and the kernels that serve it.
type InUse = (&'static str, &'static str, &'static [Kernel]);

/// One list per law, from which [`ALL`](ShearLaw::ALL), the names in files and the kernels are made: a variant that it
/// lacks does not compile.
macro_rules! laws {
    ($law:ident { $($variant:ident: $key:literal => [$($kernel:ident),+],)+ }) => {
        impl $law {
            /// Every law.
            pub const ALL: [Self; [$($key),+].len()] = [$(Self::$variant),+];

            /// Its name in files.
            #[must_use]
            pub const fn key(self) -> &'static str {
                match self {
                    $(Self::$variant => $key,)+
                }
            }

            /// The kernels that compute it.
            #[must_use]
            pub const fn kernels(self) -> &'static [$crate::Kernel] {
                match self {
                    $(Self::$variant => &[$($crate::Kernel::$kernel),+],)+
                }
            }
        }
    };
}
pub(crate) use laws;

impl Kernel {
    /// Every kernel.
    pub(crate) const ALL: &[Self] = &[
        Self::General,
        Self::Quick,
        Self::Lanes,
        Self::Tape,
        Self::Remainder,
    ];
    /// All but the lanes.
    pub(crate) const BUT_LANES: &[Self] =
        &[Self::General, Self::Quick, Self::Tape, Self::Remainder];

    /// The first law in use that this kernel does not serve: what it is a law of, and its name.
    fn first_unserved<const N: usize>(
        self,
        in_use: [InUse; N],
    ) -> Option<(&'static str, &'static str)> {
        let unserved = |(.., kernels): &InUse| !kernels.contains(&self);
        in_use
            .into_iter()
            .find(unserved)
            .map(|(of, key, _)| (of, key))
    }
}

impl LawChoice {
    /// The first of these laws that a kernel does not serve: what it is a law of, and its name in files.
    ///
    /// ```
    /// use grouser_terra::{Kernel, LawChoice, ShearLaw};
    /// let laws = LawChoice { shear: Some(ShearLaw::SlipVelocityRegular), ..LawChoice::default() };
    /// assert_eq!(laws.unserved_by(Kernel::General), None);
    /// assert_eq!(laws.unserved_by(Kernel::Lanes), Some(("shear law", "slip-velocity-regular")));
    /// ```
    #[must_use]
    pub fn unserved_by(&self, kernel: Kernel) -> Option<(&'static str, &'static str)> {
        let Self {
            slip_norm,
            slip_sinkage,
            stress_position,
            shear,
            bulldozing,
        } = *self;
        let (shear, bulldozing) = (shear.unwrap_or_default(), bulldozing.unwrap_or_default());
        kernel.first_unserved([
            ("slip norm", slip_norm.key(), slip_norm.kernels()),
            (
                "slip-sinkage law",
                slip_sinkage.key(),
                slip_sinkage.kernels(),
            ),
            (
                "stress position",
                stress_position.key(),
                stress_position.kernels(),
            ),
            ("shear law", shear.key(), shear.kernels()),
            ("bulldozing law", bulldozing.key(), bulldozing.kernels()),
        ])
    }
}

impl SoilParams {
    /// The first law of this soil that a kernel does not serve, a number that changes a law included: what it is a law of,
    /// and its name.
    #[must_use]
    pub fn unserved_by(&self, kernel: Kernel) -> Option<(&'static str, &'static str)> {
        let Self {
            pressure,
            n_1,
            n_2,
            rear_driving,
            transport_layer,
            laws,
            // in every kernel
            n: _,
            cohesion: _,
            phi: _,
            k_shear: _,
            c_1: _,
            c_2: _,
            rebound: _,
            unit_weight: _,
            fitted: _,
            // without effect straight ahead
            k_shear_1: _,
            k_shear_side: _,
            k_shear_side_1: _,
            rear_drift: _,
            sideways_support: _,
        } = self;
        let unless = |number: f64| {
            if number == 0.0 {
                Kernel::ALL
            } else {
                Kernel::BUT_LANES
            }
        };
        kernel
            .first_unserved([
                ("pressure law", pressure.key(), pressure.kernels()),
                ("growth of n", "n_1", unless(*n_1)),
                ("growth of n", "n_2", unless(*n_2)),
                ("rear contact", "rear_driving", unless(*rear_driving)),
                ("carried soil", "transport_layer", unless(*transport_layer)),
            ])
            .or_else(|| laws.unserved_by(kernel))
    }
}
