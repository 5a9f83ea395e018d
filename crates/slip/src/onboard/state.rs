//! What the robot's computer has learnt, as plain numbers that outlast a restart.

use super::learn::SoilBelief;
use crate::filter::Learnt;

/// What [`OnBoard::state`](super::OnBoard::state) saves and [`OnBoard::restore`](super::OnBoard::restore) takes back.
///
/// ```
/// # use grouser_slip::onboard::{OnBoard, OnBoardSettings};
/// # fn restart(mut before: OnBoard, mut after: OnBoard) -> grouser_slip::Result<()> {
/// let state = before.state();
/// // … the computer is switched off and on …
/// after.restore(&state)?;
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct OnBoardState {
    /// Biases and soil that the filter has learnt.
    pub learnt: Learnt,
    /// Heading, rad.
    pub heading: f64,
    /// What is believed of the soil, where it is learnt.
    pub soil: Option<SoilBelief>,
}
