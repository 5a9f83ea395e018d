//! Figures of publication quality from plain data, as SVG and PNG.
//!
//! ```
//! use grouser_figure::{Axis, Chart, Curve, Figure, Style};
//!
//! let pull = |load: f64| (0..=50).map(move |i| {
//!     let s = f64::from(i) / 50.0;
//!     [s, 0.3 * load * (1.0 - (-8.0 * s).exp()) - 0.05 * load]
//! });
//! let chart = Chart::new(Axis::new("Slip ratio *s*"), Axis::new("Drawbar pull *F*_{DP} (N)"))
//!     .curve(Curve::new(pull(40.0)).style(Style::numbered(0)).label("*W* = 40 N"))
//!     .curve(Curve::new(pull(90.0)).style(Style::numbered(1)).label("*W* = 90 N"));
//! let figure = Figure::new("Drawbar pull against slip").panel(chart);
//! assert!(figure.svg().starts_with("<svg"));
//! # #[cfg(feature = "png")]
//! # let png = figure.png(96.0).ok_or("no picture")?;
//! # #[cfg(feature = "png")]
//! # assert!(png.starts_with(b"\x89PNG"));
//! # Ok::<(), &str>(())
//! ```
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
mod draw_chart;
mod draw_scene;
mod geometry;
mod labels;
mod layout;
mod page;
mod page_text;
mod path;
mod place;
#[cfg(feature = "png")]
mod png;
mod scale;
mod scene;
mod style;
mod svg;
mod text;
mod thin;
mod ticks;
mod typeface;

pub use chart::{Area, Axis, Chart, Curve, Mark, Measured, Points, Rule};
pub use page_text::{escaped, png_address};
pub use scene::{Scene, Shape};
pub use style::{Colour, Dash, Marker, Style};
pub use text::plain;

/// Ticks for a scale from `low` to `high` in at most `most` intervals: value and label of each.
#[must_use]
pub fn even_ticks(low: f64, high: f64, most: u8) -> Vec<(f64, String)> {
    ticks::ticks([low, high], ticks::Widen::No, most).marks
}

/// One picture: panels of equal size in rows, lettered (a), (b), … when there are several.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    description: String,
    columns: usize,
    panels: Vec<Panel>,
}

/// One part of a figure.
#[derive(Clone, Debug, PartialEq)]
pub enum Panel {
    /// Axes and data.
    Chart(Chart),
    /// A drawing to scale.
    Scene(Scene),
}

impl From<Chart> for Panel {
    fn from(chart: Chart) -> Self {
        Self::Chart(chart)
    }
}

impl From<Scene> for Panel {
    fn from(scene: Scene) -> Self {
        Self::Scene(scene)
    }
}

impl Figure {
    /// An empty figure; `description` says what it shows to those who cannot see it.
    #[must_use]
    pub fn new(description: impl Into<String>) -> Self {
        Self {
            description: description.into(),
            columns: 2,
            panels: Vec::new(),
        }
    }

    /// One more panel.
    #[must_use]
    pub fn panel(mut self, panel: impl Into<Panel>) -> Self {
        self.panels.push(panel.into());
        self
    }

    /// Panels side by side; 2 unless told.
    #[must_use]
    pub fn columns(mut self, columns: usize) -> Self {
        self.columns = columns.max(1);
        self
    }

    /// The figure as SVG.
    #[must_use]
    pub fn svg(&self) -> String {
        svg::write(&layout::page(self))
    }

    /// The figure as PNG at `dots_per_inch` (300 for print); `None` when that picture would have no pixel
    /// or too many for memory.
    #[cfg(feature = "png")]
    #[must_use]
    pub fn png(&self, dots_per_inch: f64) -> Option<Vec<u8>> {
        png::write(&layout::page(self), dots_per_inch)
    }
}
