#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! The primary types are [`SlipTable`] (what a robot needs on a soil, over pitch and roll), [`MapMaker`]
//! (the same over an elevation model) and [`plan::PlanMap`] (a map on which [`plan::plan`] finds ways). The
//! crate does not drive, estimate or learn: the soil is given, with intervals where they are known.
#![forbid(unsafe_code)]

mod climb;
mod demand;
mod error;
mod headings;
pub mod learn;
mod map;
pub mod mission;
pub mod plan;
mod pose;
pub mod raster;
mod soil_draws;
mod soil_map;
mod table;

pub use climb::{ClimbStep, climb};
pub use demand::{Demand, DemandSolver, Driving, MAX_SLOPE_RAD};
pub use error::{Error, Result};
pub use grouser_terra::slope::MAX_SLIP;
pub use headings::Headings;
pub use map::{
    Band, Journal, MapLayout, MapMaker, MapSettings, MapSoil, Quantity, State, Strip, read_strip,
    write_map,
};
pub use pose::SurfacePose;
pub use soil_draws::SoilIntervals;
pub use soil_map::{LegendSoil, SoilMap};
pub use table::{Envelope, SLIP_BOUND, SlipTable, TableError};
