//! Problem files: from TOML to a [`Design`].

mod objectives;
mod read;
mod soils;
mod variables;

pub use read::{parse, read};
