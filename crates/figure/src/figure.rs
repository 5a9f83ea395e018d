//! Panels on one page.

use crate::page::Page;
use crate::panel::Panel;
use crate::{layout, svg};

/// One picture: panels of equal size in rows, lettered (a), (b), … when there are several.
///
/// ```
/// use grouser_figure::{Axis, Chart, Curve, Figure};
///
/// let line = Curve::new([[0.0, 0.0], [1.0, 2.0]]).label("load");
/// let chart = Chart::new(Axis::new("Slip *s*"), Axis::new("Load (N)")).curve(line);
/// let svg = Figure::new("Load against slip").panel(chart.clone()).panel(chart).columns(2).svg();
/// assert!(svg.contains("aria-label=\"load\""));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    description: String,
    columns: usize,
    panels: Vec<Panel>,
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

    /// Panels side by side; 2 by default.
    #[must_use]
    pub fn columns(mut self, columns: usize) -> Self {
        self.columns = columns.max(1);
        self
    }

    /// The figure as SVG.
    #[must_use]
    pub fn svg(&self) -> String {
        svg::write(&self.page())
    }

    /// The figure as PNG at `dots_per_inch` (300 for print).
    ///
    /// # Errors
    /// [`Error::PictureSize`](crate::Error::PictureSize) where that picture would have no pixel or too many for memory.
    #[cfg(feature = "png")]
    pub fn png(&self, dots_per_inch: f64) -> Result<Vec<u8>, crate::Error> {
        crate::png::write(&self.page(), dots_per_inch)
    }

    fn page(&self) -> Page {
        layout::page(&self.description, self.columns, &self.panels)
    }
}
