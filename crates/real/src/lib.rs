#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! The primary type is the trait [`Real`]; [`Scalar`] adds what only a single number can do: give its value
//! to an `if`. [`Interval`] encloses all values of a formula over a box. [`OutOfRange`] is the error of a
//! number outside its limits in every crate above, [`SignalPair`] the comparison of two signals by which the robot and the
//! log doctor find wrong units and signs. The crate knows nothing of wheels or of optimisation.
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

/// Whether the feature `deterministic` is on: the same bits on every machine.
///
/// ```
/// // 9/4 − (3/2)² in one rounding is what a fused instruction gives; here both steps round.
/// use grouser_real::Real;
/// assert_eq!(Real::mul_add(1.5, -1.5, 2.25), 0.0);
/// assert_eq!(grouser_real::DETERMINISTIC, cfg!(feature = "deterministic"));
/// ```
pub const DETERMINISTIC: bool = cfg!(feature = "deterministic");

mod dual;
mod float;
mod interval;
mod median;
mod out_of_range;
mod real;
mod result_field;
mod signal_pair;
mod solve;
mod wrap;

pub use dual::Dual;
pub use interval::Interval;
pub use median::median;
pub use out_of_range::OutOfRange;
pub use real::{Real, Scalar};
pub use result_field::{FieldValue, ReadField, ResultField};
pub use signal_pair::{SignalLine, SignalPair, Squares};
pub use solve::solve;
pub use wrap::wrap_angle;
