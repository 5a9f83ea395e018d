//! Laws of pressure against sinkage.

mod bekker;
mod reece;
mod slip_sinkage;
mod soil_transport;

use grouser_real::Real;

pub use bekker::Bekker;
pub use reece::Reece;
pub use slip_sinkage::{SinkageExponent, SlipSinkage};
pub(crate) use soil_transport::share_left;
pub use soil_transport::transport_depth_reece;

/// The pressure-sinkage law of a soil.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Pressure<R = f64> {
    /// Bekker's, in moduli whose unit depends on n.
    Bekker(Bekker<R>),
    /// Reece's, in pure numbers; needs the soil's unit weight.
    Reece(Reece<R>),
}

impl Pressure {
    /// The same law in numbers of any kind.
    #[must_use]
    pub fn lifted<R: Real>(self) -> Pressure<R> {
        let r = R::from_f64;
        match self {
            Self::Bekker(law) => Pressure::Bekker(Bekker {
                k_c: r(law.k_c),
                k_phi: r(law.k_phi),
            }),
            Self::Reece(law) => Pressure::Reece(Reece {
                k_c_prime: r(law.k_c_prime),
                k_phi_prime: r(law.k_phi_prime),
            }),
        }
    }
}
