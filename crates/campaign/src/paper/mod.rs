//! Ani et al. (2012), J. Cent. South Univ. 19: what can be reproduced of it.

mod problem;
mod statements;

pub use problem::{PRINTED_SLIP, READINGS, Reading, sinkage_ratio_of_slip};
pub use statements::{STATEMENTS, Statement, Verdict};
