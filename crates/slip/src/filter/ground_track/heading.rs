//! Measured headings, and what they show of the turn rate.

use super::GroundTrack;
use crate::filter::multiple_model::reference_noise::Errors;
use crate::filter::settings::FilterSettings;

/// Standard deviation of the error of a displacement's turn until it is learnt, rad.
const DISPLACEMENT_TURN_SIGMA_RAD: f64 = 2e-3;

/// This number of headings in a row that agree with the turn rate confirm it: as many as make a steady contradiction.
const CONFIRMING_HEADINGS: u32 = 6;

impl GroundTrack {
    /// Updates the models by a heading, `turned` (rad) ago. A steady series of headings that contradict the models is right: a gyro
    /// with another bias or scale than estimated leads away from the heading, and no single reading corrects that.
    pub(super) fn update_heading(
        &mut self,
        (yaw, turned): (f64, f64),
        sigma: f64,
        settings: &FilterSettings,
    ) {
        if self.refused_headings.is_steady() {
            self.refused_headings.end();
        }
        let inlier = self.models.heading_agreement(yaw, turned, sigma);
        let is_accepted = self.refused_headings.accepts(inlier);
        self.agreed_headings = if is_accepted {
            self.agreed_headings.saturating_add(1)
        } else {
            0
        };
        if self.has_wrong_turn() {
            self.models
                .restart_heading(yaw, turned, sigma, settings.gyro_bias);
        } else {
            self.models.update_heading(yaw, turned, sigma);
        }
    }

    /// Do measured headings agree with the turn rate, one after the other?
    pub(in crate::filter) const fn confirms_turn(&self) -> bool {
        self.has_heading && self.agreed_headings >= CONFIRMING_HEADINGS
    }

    /// Learns the noise of headings from one less the turn by gyro or wheels, and returns the standard deviation of this one.
    pub(super) fn heading_sigma(
        &mut self,
        (beside_turn, sigma): (f64, f64),
        errors: Errors,
    ) -> f64 {
        self.heading_noise.push([beside_turn]);
        if errors == Errors::Independent {
            return self.heading_noise.sigma(sigma).max(sigma);
        }
        let noise = self
            .heading_noise
            .noise(errors, DISPLACEMENT_TURN_SIGMA_RAD);
        self.models.inflate_heading(noise.wander);
        noise.reading.max(sigma)
    }
}
