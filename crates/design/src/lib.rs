//! Problem files for wheel design: variables, objectives and constraints as formulas over each other and over
//! what a wheel on soil does, solved by `grouser-opt`.
//!
//! ```
//! use grouser_design::{Answer, parse};
//! use grouser_files::Document;
//!
//! let text = r#"
//! format = 1
//! method = "minimax"
//! [variables]
//! x1 = { start = 2.0 }
//! x2 = { start = 2.0 }
//! [objectives]
//! f1 = "x1^2 + x2^4"
//! f2 = "(2 - x1)^2 + (2 - x2)^2"
//! f3 = "2*exp(x2 - x1)"
//! "#;
//! let design = parse(&Document::from_text("cb2.toml", text.into())?)?;
//! let Answer::Optimum(optimum) = design.solve()? else {
//!     unreachable!("minimax gives one point");
//! };
//! // CB2 of Charalambous & Conn 1978
//! assert!((optimum.maximum - 1.952_224_5).abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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
mod formula;
mod front;
pub mod mission;
mod quantity;
mod scope;
mod slope_proof;
mod solve;

pub use builder::{DesignBuilder, ObjectiveParams, State};
pub use design::{Design, Objective, Task};
pub use error::{Error, Result};
pub use file::{parse, read, to_toml};
pub use formula::{DEPTH_LIMIT, Formula, FormulaError, Names, Relation, VariableNames};
pub use front::FrontProof;
pub use quantity::{Parameter, Place, Quantity};
pub use slope_proof::{SlopeProof, prove_no_slip_holds};
pub use solve::{Answer, Compromise, Optimum, Start, Trade};
