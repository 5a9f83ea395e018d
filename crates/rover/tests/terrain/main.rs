//! Terrain files: made in the test, broken in every way, read or refused with a type.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod damage;
mod geotiff;
mod grids;
mod made;
mod paths;
