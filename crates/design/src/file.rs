//! Problem files: from TOML to a [`Design`].

mod read;
mod soils;
mod variables;

pub use read::{parse, read};
