//! Problem files: from TOML to a [`Design`], and from a builder to TOML.

mod read;
mod soils;
mod variables;
mod write;

pub use read::{parse, read};
pub use write::to_toml;
