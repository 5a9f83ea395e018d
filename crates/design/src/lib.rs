#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! The primary type is [`Design`]. Derivatives are exact: formulas and wheel alike run on dual numbers, and
//! the sinkage that carries a load is differentiated through its equation. The crate writes no files.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod builder;
mod certificate;
mod design;
mod error;
mod file;
mod force_remainder;
mod formula;
mod front;
pub mod mission;
mod quantity;
mod scope;
mod slope_proof;
mod solve;
mod worst_objectives;

pub use builder::{DesignBuilder, ObjectiveParams, State};
pub use design::{Design, Objective, Task};
pub use error::{Error, Result};
pub use file::{parse, read, to_toml};
pub use force_remainder::ForceRemainder;
pub use formula::{DEPTH_LIMIT, Formula, FormulaError, Names, Relation, VariableNames};
pub use front::FrontProof;
pub use quantity::{Parameter, Place, Quantity};
pub use slope_proof::{SlopeProof, prove_no_slip_holds};
pub use solve::{Answer, Compromise, Optimum, Start, Trade};
