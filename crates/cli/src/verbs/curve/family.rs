//! One curve of several.

use grouser_terra::BestSlip;

use crate::operation::{Answer, Prescribed};

/// One curve: its load, and its points.
pub(super) struct Family {
    pub(super) prescribed: Prescribed,
    pub(super) points: Vec<(f64, Answer)>,
    pub(super) most_pull: Option<BestSlip>,
    pub(super) most_efficient: Option<BestSlip>,
}
