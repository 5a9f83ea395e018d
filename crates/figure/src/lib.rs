#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! The primary type is [`Figure`]: [`Panel`]s of one size, each a [`Chart`] (axes and data) or a [`Scene`]
//! (a drawing to scale). Text is marked up: `*italic*`, `_{subscript}`, `^{superscript}`; [`plain`] takes
//! the meaning away from a name that came from a user. Labels stand at their curve and touch nothing:
//! their place is searched for against every line, marker and other label.
//!
//! Letters are drawn as outlines of a font that is part of the program (STIX Two Text), so a figure looks
//! the same on every machine, and widths are known where labels are placed. The words stay readable for
//! machines in `aria-label`.
#![forbid(unsafe_code)]

mod chart;
mod choose;
mod colour_scale;
mod draw_chart;
mod draw_scene;
mod error;
mod figure;
mod geometry;
mod labels;
mod layout;
mod map;
mod page;
mod page_text;
mod panel;
mod path;
mod picture;
mod place;
#[cfg(feature = "png")]
mod png;
mod scale;
mod scene;
mod sizes;
mod style;
mod svg;
mod text;
mod thin;
mod ticks;
mod typeface;

pub use chart::{Area, Axis, Chart, Curve, Mark, Measured, Points, Rule};
pub use colour_scale::ColourScale;
pub use error::Error;
pub use figure::Figure;
pub use map::MapFrame;
pub use page_text::{escaped, png_address};
pub use panel::Panel;
pub use picture::Picture;
pub use scene::{Scene, Shape};
pub use style::{Colour, Dash, Marker, Style};
pub use text::plain;
pub use ticks::even_ticks;
