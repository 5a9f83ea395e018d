//! Soil learnt by place: how strong the ground is beside a known soil, from the slip and the torque that driving takes.
//!
//! A [`StrengthFamily`] is the known soil at several strengths and stiffnesses. Each tile of [`SoilTiles`] holds one weight for each of
//! them, so that memory is bounded and an update is a dozen look-ups.

mod family;
mod tiles;

pub use family::{Level, StrengthFamily};
pub use tiles::{LearnSettings, SoilObservation, SoilTiles, TileSummary};
