//! Derivatives: exact by dual numbers, by finite differences, and the check of one against the other.

mod check;
mod difference;
mod dual;
mod trace;

pub use check::{DerivativeCheck, WrongEntry, check_derivatives};
pub use difference::Differences;
pub use dual::{Exact, Functions};
