//! Laws of shear: strength, mobilisation, displacement, and what a slip angle makes of them.

mod displacement;
mod janosi;
mod law;
mod strength;
mod towed;

pub(crate) use displacement::Displacement;
pub use janosi::mobilised_janosi;
pub use law::ShearLaw;
pub(crate) use law::{Restart, ShearState};
pub use strength::MohrCoulomb;
pub use towed::transition_angle_wong_reece;
