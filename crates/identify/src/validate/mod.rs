//! The model held against measured data.

pub mod cmu;
pub mod ding;
