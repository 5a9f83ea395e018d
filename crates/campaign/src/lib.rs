//! The two campaigns of the project: what of Ani et al. (2012) can be reproduced ([`paper`]), and every
//! measured data set against the model ([`validate`]); and the figure of the stress under a wheel ([`stress`]).
//!
//! The verbs `paper`, `validate` and `wheel` of the command call this crate; it has no other consumer.
#![forbid(unsafe_code)]

mod error;
pub mod paper;
pub mod stress;
pub mod validate;

pub use error::{Error, Result};
