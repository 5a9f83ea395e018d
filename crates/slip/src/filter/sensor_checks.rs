//! The checks of each wheel's encoder and radius.

use super::estimator::Core;
use super::output::WheelCheck;
use crate::history::seconds_between;
use crate::speed::Measured;
use crate::state::Health;

/// Pulses and radii are checked this often, s: their statistics change over seconds.
const CHECK_PERIOD_S: f64 = 0.1;

impl Core {
    /// Checks each wheel's pulses and radius, where the last check is old enough.
    pub(super) fn check_sensors(&mut self, now_ns: i64) {
        let due = self
            .output
            .checked_ns
            .is_none_or(|then| seconds_between(then, now_ns) >= CHECK_PERIOD_S);
        if !due {
            return;
        }
        self.output.checked_ns = Some(now_ns);
        let skid_variance = self.settings.free_slip.sigma * self.settings.free_slip.sigma;
        for index in 0..self.wheels.channels.len() {
            let others = self.wheels.usual_missed_share(index);
            let wheel = &mut self.wheels.channels[index];
            let ok = wheel.estimate.health == Health::Ok && !wheel.free;
            let slip = wheel.estimate.slip.filter(|_| ok);
            wheel.radius.update(
                slip.zip(wheel.estimate.sigma)
                    .map(|(slip, sigma)| Measured {
                        value: slip.value(),
                        variance: sigma * sigma,
                    }),
            );
            self.output.checks[index] = WheelCheck {
                pulses_missed: wheel.pulses.share(),
                misses_pulses: wheel.pulses.misses(others),
                broken_slot: wheel.pulses.has_broken_slot(),
                radius_excess: wheel.radius.excess(skid_variance),
            };
        }
    }
}

#[cfg(test)]
mod tests;
