//! A robot that slides or is carried while its rims stand: positions that move on show it.

use grouser_real::Real;

use super::GroundTrack;
use crate::filter::multiple_model::STANDING_RIM_M_PER_S;
use crate::filter::settings::FilterSettings;
use crate::history::seconds_between;

/// A course of this many standard deviations is a motion: 4 σ are one in 16 000 by chance.
const SLIDING_SIGMAS: f64 = 4.0;
/// A slide ends where this many periods of the reference have not shown it: one of 0.04 m/s by positions of 1 cm at 10 Hz shows itself
/// that often.
const SLIDING_PERIODS: f64 = 15.0;
/// Positions that are refused within this time while the rims stand are of one slide, s: the models accept a few of a slow one after
/// each restart.
const SLOW_SLIDE_S: f64 = 3.0;

impl GroundTrack {
    /// The robot's speed where it slides or is carried while its rims stand, m/s.
    pub(in super::super) fn slide(&self, now_ns: i64) -> Option<f64> {
        let (speed, shown_ns) = self.slide?;
        let lasts = seconds_between(shown_ns, now_ns) <= SLIDING_PERIODS * self.period_s.max(0.1);
        (lasts && self.rims_stand()).then_some(speed)
    }

    pub(super) fn rims_stand(&self) -> bool {
        self.rim_speed.abs() <= STANDING_RIM_M_PER_S
    }

    /// May a position that is refused at `taken_ns` be of the same slide as those before?
    pub(super) fn may_slide_on(&self, taken_ns: i64) -> bool {
        self.rims_stand() && seconds_between(self.refused_ns, taken_ns) < SLOW_SLIDE_S
    }

    /// Shows a slide where the positions have moved far enough against their errors since the first refused one, or since the last
    /// that showed it.
    pub(super) fn show_slide(
        &mut self,
        place: [f64; 2],
        (taken_ns, now_ns): (i64, i64),
        settings: &FilterSettings,
    ) {
        let [dx, dy] = [0, 1].map(|i| place[i] - self.refused_position[i]);
        let sigma = self.models.position_sigma();
        let sigma = sigma.unwrap_or(settings.position_sigma);
        let least = SLIDING_SIGMAS * core::f64::consts::SQRT_2 * sigma;
        let Some(motion) = self.models.motion() else {
            return;
        };
        if !self.rims_stand() || Real::hypot(dx, dy) <= least {
            return;
        }
        let (sin, cos) = Real::sin_cos(motion.heading + self.direction);
        let passed = seconds_between(self.refused_ns, taken_ns);
        self.slide = Some(((cos * dx + sin * dy) / passed, now_ns));
        self.refused_position = place;
        self.refused_ns = taken_ns;
    }
}

#[cfg(test)]
mod tests;
