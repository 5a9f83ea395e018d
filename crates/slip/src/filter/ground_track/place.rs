//! Places and headings in the models' frame, by poses, displacements and places without a heading.

use grouser_real::Real;

use super::SUMMED_HEADING_SIGMA_RAD;
use super::{GroundTrack, MAX_HEADING_SIGMA_RAD, MAX_PREDICTION_S, MEASURED_HEADING_SIGMA_RAD};
use crate::filter::settings::FilterSettings;
use crate::history::seconds_between;
use crate::sample::Measurement;

/// A measured heading that has changed by this much is one, rad; poses without a heading repeat a number.
const HEADING_CHANGE_RAD: f64 = 0.05;

impl GroundTrack {
    /// The place (m), heading (rad) and its standard deviation in the models' frame by a measurement; `None` of one that has none, or
    /// none so far.
    pub(super) fn place_by(
        &mut self,
        measurement: &Measurement,
        times_ns: (i64, i64),
        (now, since): ([f64; 4], [f64; 4]),
        settings: &FilterSettings,
    ) -> Option<([f64; 2], Option<f64>, f64)> {
        match *measurement {
            Measurement::Position { x, y } => {
                self.orient_places([x, y], times_ns, since, settings);
                let place = self.places.place([x, y])?;
                Some((place, None, MEASURED_HEADING_SIGMA_RAD))
            }
            // the same places, as displacements
            _ if self.places.has_begun() => None,
            Measurement::Pose { x, y, yaw } => {
                let first = *self.first_heading.get_or_insert(yaw);
                self.has_heading |= (yaw - first).abs() > HEADING_CHANGE_RAD;
                let heading = yaw + self.heading_offset;
                Some(([x, y], Some(heading), MEASURED_HEADING_SIGMA_RAD))
            }
            Measurement::Displacement {
                forward,
                left,
                turn,
            } => {
                let turn = turn.unwrap_or_else(|| now[2] - since[2] - self.summed[2]);
                let (sin, cos) = Real::sin_cos(self.summed[2] + 0.5 * turn);
                self.summed[0] += cos * forward - sin * left;
                self.summed[1] += sin * forward + cos * left;
                self.summed[2] += turn;
                let [x, y, heading] = self.summed;
                Some(([x, y], Some(heading), SUMMED_HEADING_SIGMA_RAD))
            }
            _ => None,
        }
    }

    /// Orients the models' frame in that of places without a heading: at the first one, and after an outage in which the heading was
    /// lost, the models start anew, and go by wheels and gyro until the course is known.
    fn orient_places(
        &mut self,
        place: [f64; 2],
        (taken_ns, now_ns): (i64, i64),
        since: [f64; 4],
        settings: &FilterSettings,
    ) {
        let outage = self
            .used_ns
            .map_or(0.0, |used| seconds_between(used, taken_ns));
        let is_lost =
            outage > MAX_PREDICTION_S && self.models.heading_sigma() > MAX_HEADING_SIGMA_RAD;
        if !self.places.has_begun() || !self.models.has_started() || is_lost {
            self.places.begin(place);
            self.models.restart();
            let sigma = SUMMED_HEADING_SIGMA_RAD;
            self.models
                .start([0.0; 2], 0.0, settings.position_sigma, sigma);
            self.accepted_ns = None;
            self.used_ns = None;
            return;
        }
        if self.places.place(place).is_some() {
            return;
        }
        let there = self.models.place(since);
        let Some(sigma) = self.places.compare(place, there, settings.position_sigma) else {
            return;
        };
        let heading = self.models.motion().map_or(0.0, |motion| motion.heading);
        if let Some(place) = self.places.place(place) {
            let readmitted = self.started_ns.is_some();
            self.start(now_ns, place, (heading, sigma), settings);
            self.used_ns = Some(taken_ns);
            if readmitted {
                self.readmitted_ns = Some(now_ns);
            }
        }
    }
}
