//! Speeds over ground beside the rims of their time.

use grouser_real::Real;

use super::restart::{SHOWN_SLIP_SIGMA, slip_between};
use super::{GroundTrack, Outcome, SUMMED_HEADING_SIGMA_RAD};
use crate::filter::settings::FilterSettings;
use crate::history::{nanoseconds, seconds_between};

impl GroundTrack {
    /// Uses a speed (m/s) that was taken at `taken_ns`: at once where the models have a speed, and beside the rims of its time.
    pub(super) fn update_speed(
        &mut self,
        (taken_ns, forward): (i64, f64),
        now_ns: i64,
        settings: &FilterSettings,
    ) -> Outcome {
        if !self.models.has_started() {
            self.start(now_ns, [0.0; 2], (0.0, SUMMED_HEADING_SIGMA_RAD), settings);
        }
        self.use_awaited_speed(true, settings);
        let speed = forward * Real::cos(self.direction);
        let sigma = self.speed_sigma(settings);
        self.models.update_speed(speed, sigma);
        self.awaited_speed = Some((taken_ns, forward));
        self.use_awaited_speed(false, settings);
        self.accepted_ns = Some(now_ns);
        Outcome::Accepted
    }

    /// Updates the models by the speed that waits, once the rims are known around its time, or `at_once`: a rim speed that lags
    /// behind turned each braking into slip.
    pub(super) fn use_awaited_speed(&mut self, at_once: bool, settings: &FilterSettings) {
        let (Some((taken_ns, forward)), Some(stepped_ns)) = (self.awaited_speed, self.stepped_ns)
        else {
            return;
        };
        let half = nanoseconds(self.rim_lag);
        let to_ns = taken_ns.saturating_add(half);
        if to_ns > stepped_ns && !at_once {
            return;
        }
        self.awaited_speed = None;
        let (from_ns, to_ns) = (taken_ns.saturating_sub(half), to_ns.min(stepped_ns));
        let rim = self
            .history
            .between(from_ns, to_ns)
            .filter(|_| to_ns > from_ns)
            .map_or(self.rim_speed, |ways| {
                ways[3] / seconds_between(from_ns, to_ns)
            });
        let speed = forward * Real::cos(self.direction);
        let share = self.models.motion().map_or(1.0, |motion| motion.rim_share);
        self.speed_noise.push([speed - rim * share]);
        let sigma = self.speed_sigma(settings);
        let inlier = self.models.speed_agreement(speed, rim, sigma);
        self.slide = None;
        self.refused_speeds.accepts(inlier);
        if !self.refused_speeds.is_steady() {
            self.models.update_share(speed, rim, sigma);
            return;
        }
        if self.rims_stand() {
            self.slide = Some((forward, stepped_ns));
        } else if let Some(slip) = slip_between(speed, rim) {
            self.refused_speeds.end();
            self.models
                .restart_slip(slip, SHOWN_SLIP_SIGMA, speed, sigma);
        }
    }

    /// Standard deviation of a speed, m/s: as learnt, and at least as stated.
    fn speed_sigma(&self, settings: &FilterSettings) -> f64 {
        let stated = settings.speed_sigma;
        self.speed_noise.sigma(stated).max(stated)
    }
}

#[cfg(test)]
mod tests;
