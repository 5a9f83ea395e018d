#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! | for | there is |
//! |---|---|
//! | samples of a robot's sensors | [`Log::find_any`], which chooses columns and topics; [`Log::over`] for anything readable |
//! | samples of a live source | [`Preview`], then [`Intake`] |
//! | tables of text | [`csv`] |
//! | decoded messages in the order of time | [`Messages`] |
//! | one number over time | [`series()`] |
//! | messages as the file has them, and its damage | [`container::Container`] |
//! | what a file holds | [`Survey`], [`Sheet`] |
//! | writing | [`write`](mod@write) |
//!
//! Messages are decoded by the definitions that their file holds ([`message::Decoder`]).
//!
//! The primary types are [`Log`] and [`Intake`]. The crate estimates nothing: it does not know the robot.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod container;
pub mod csv;
mod error;
mod find;
mod foreign;
mod log;
mod measures;
mod merge;
pub mod message;
mod messages;
mod order;
mod orientation;
mod recording;
mod series;
mod sheet;
mod slots;
mod source;
mod split;
mod suggest;
mod survey;
mod wrapped_angles;
pub mod write;

pub use error::{Cell, Error, Result};
pub use find::run_files;
pub use log::Log;
pub use measures::Measures;
pub use merge::Samples;
pub use messages::{Clock, LOOK_AHEAD, LeftOut, Messages, Stamped};
pub use recording::{Intake, Preview, UsedTopic};
pub use series::{Series, series};
pub use sheet::{Guess, Sheet, SheetColumn, SheetTime};
pub use suggest::{suggest_for_sheets, suggest_for_survey, suggest_robot};
pub use survey::{Survey, Topic, Use};
