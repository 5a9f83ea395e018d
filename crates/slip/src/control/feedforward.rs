//! The feedforward of speed: rims run faster by what slip takes, so that the robot travels as requested.

use super::command::MotionCommand;
use super::settings::ControlSettings;

/// The share x by which rims run faster than the robot is to travel.
///
/// It follows x = s/(1 − s) without an integral: one that was wound up on a climb would let the robot race down behind it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Feedforward {
    share: f64,
}

impl Feedforward {
    pub(super) const fn share(self) -> f64 {
        self.share
    }

    pub(super) fn update(
        &mut self,
        settings: &ControlSettings,
        motion: &MotionCommand,
        slip: Option<f64>,
        step: f64,
    ) {
        // a robot that stops, rests or turns on the spot limits no slip
        let setpoint = if !motion.limits_slip {
            0.0
        } else if let Some(slip) = slip {
            let max_slip = settings.max_feedforward / (1.0 + settings.max_feedforward);
            let slip = slip.clamp(0.0, max_slip);
            slip / (1.0 - slip)
        } else {
            return;
        };
        let follow = (step * settings.feedforward_gain).min(1.0);
        self.share =
            (self.share + follow * (setpoint - self.share)).clamp(0.0, settings.max_feedforward);
    }
}
