//! Laws of pressure against sinkage.

mod bekker;
mod reece;
mod slip_sinkage;
mod soil_transport;

use core::convert::Infallible;

use grouser_real::Real;

use crate::kernel::Kernel;

pub use bekker::Bekker;
pub use reece::Reece;
pub use slip_sinkage::{SinkageExponent, SlipSinkage, level_off};
pub use soil_transport::transport_depth_reece;

/// The pressure-sinkage law of a soil.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pressure<R = f64> {
    /// Bekker's, in moduli whose unit depends on n.
    Bekker(Bekker<R>),
    /// Reece's, in pure numbers; needs the soil's unit weight.
    Reece(Reece<R>),
}

impl<R> Pressure<R> {
    /// Its name.
    #[must_use]
    pub const fn key(&self) -> &'static str {
        match self {
            Self::Bekker(_) => "bekker",
            Self::Reece(_) => "reece",
        }
    }

    /// The kernels that compute it.
    #[must_use]
    pub const fn kernels(&self) -> &'static [Kernel] {
        match self {
            Self::Bekker(_) | Self::Reece(_) => Kernel::ALL,
        }
    }

    /// The same law with each modulus, by its name, put through `map`.
    pub(crate) fn each<S, E>(
        self,
        map: impl Fn(&'static str, R) -> Result<S, E>,
    ) -> Result<Pressure<S>, E> {
        Ok(match self {
            Self::Bekker(law) => Pressure::Bekker(Bekker {
                k_c: map("k_c", law.k_c)?,
                k_phi: map("k_phi", law.k_phi)?,
            }),
            Self::Reece(law) => Pressure::Reece(Reece {
                k_c_prime: map("k_c_prime", law.k_c_prime)?,
                k_phi_prime: map("k_phi_prime", law.k_phi_prime)?,
            }),
        })
    }
}

impl Pressure {
    /// The same law with all moduli multiplied by `factor`.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        let Ok(scaled) = self.each(|_, modulus| Ok::<_, Infallible>(factor * modulus));
        scaled
    }

    /// The same law in numbers of any kind.
    #[must_use]
    pub fn lifted<R: Real>(self) -> Pressure<R> {
        let Ok(lifted) = self.each(|_, modulus| Ok::<_, Infallible>(R::from_f64(modulus)));
        lifted
    }
}
