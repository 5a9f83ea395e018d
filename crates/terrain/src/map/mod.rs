//! Slip maps: for every cell of an elevation model and every heading, what a robot needs there.

mod assemble;
mod bands;
mod journal;
mod layout;
mod maker;
mod strip;
mod tip_over;

pub use assemble::{read_strip, write_map};
pub use bands::{Band, Quantity, State};
pub use journal::Journal;
pub(crate) use layout::turning_radius;
pub use layout::{MapLayout, MapSettings};
pub use maker::{MapMaker, MapSoil};
pub use strip::Strip;
pub(crate) use tip_over::TipOverTable;
