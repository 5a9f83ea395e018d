//! One part of a figure.

use crate::chart::Chart;
use crate::scene::Scene;

/// One part of a figure.
///
/// ```
/// use grouser_figure::{Axis, Chart, Panel};
///
/// let panel = Panel::from(Chart::new(Axis::new("*x* (m)"), Axis::new("*y* (m)")));
/// assert!(matches!(panel, Panel::Chart(_)));
/// ```
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
