//! Sizes that charts and pages share, in points.

/// Size of an axis title.
pub(crate) const TITLE_SIZE_PT: f64 = 10.5;
/// Size of a tick label.
pub(crate) const TICK_SIZE_PT: f64 = 9.5;
/// Between a frame and its tick labels.
pub(crate) const TICK_GAP_PT: f64 = 5.0;
/// Between tick labels and the axis title.
pub(crate) const TITLE_GAP_PT: f64 = 6.0;
