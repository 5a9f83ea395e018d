//! How the models start, and how they restart where a steady series of positions contradicts them.

use grouser_real::{Real, wrap_angle};

use super::{GroundTrack, MAX_HEADING_SIGMA_RAD, MEASURED_HEADING_SIGMA_RAD};
use crate::filter::settings::FilterSettings;

/// Standard deviation of the slip by way or speed of a refused series over that of the rims. The reference is not yet settled then.
pub(super) const SHOWN_SLIP_SIGMA: f64 = 0.1;
/// A shorter course may be a step back or a rocking: it overrules no measured heading, m.
const MIN_COURSE_M: f64 = 0.3;
/// Within this many of its standard deviations a course says nothing against a measured heading.
const COURSE_SIGMAS: f64 = 3.0;
/// One longer than this multiple of the rims' way is no course but a position that jumped; braking wheels run slower than the robot.
const MAX_COURSE_PER_WAY: f64 = 1.5;

impl GroundTrack {
    pub(super) fn start(
        &mut self,
        now_ns: i64,
        place: [f64; 2],
        (heading, heading_sigma): (f64, f64),
        settings: &FilterSettings,
    ) {
        self.models
            .set_slip_prior([settings.slip.mean, settings.slip.sigma]);
        self.models
            .start(place, heading, settings.position_sigma, heading_sigma);
        self.accepted_ns = Some(now_ns);
        self.started_ns = Some(now_ns);
    }

    /// Restarts the models at a position, with the heading of the course since the first refused one where that is long
    /// enough: the frame, its heading or the motion are not what the models hold. From the accepted ones to that, the position
    /// may have jumped, which is no course.
    pub(super) fn restart_along_course(
        &mut self,
        (taken_ns, now_ns): (i64, i64),
        place: [f64; 2],
        yaw: Option<f64>,
        settings: &FilterSettings,
    ) {
        let (dx, dy) = (
            place[0] - self.refused_position[0],
            place[1] - self.refused_position[1],
        );
        let course = Real::hypot(dx, dy);
        let known = self.models.motion().map(|motion| motion.heading);
        let sigma = self
            .models
            .position_sigma()
            .unwrap_or(settings.position_sigma);
        self.refused.end();
        self.restarts += 1;
        self.readmitted_ns = Some(now_ns);
        let rim_way = self.models.totals()[3] - self.refused_way;
        self.models.restart();
        let uncertain = core::f64::consts::SQRT_2 * sigma / course.max(sigma);
        // a position that jumps is no course
        let is_driven = course < MAX_COURSE_PER_WAY * rim_way.abs();
        let overrules = is_driven && (!self.has_heading || course > MIN_COURSE_M);
        let back = if self.rim_speed < 0.0 { -1.0 } else { 1.0 };
        let by_course = Real::atan2(back * dy, back * dx) - self.direction;
        let contradicts = |yaw: f64| {
            !self.has_heading || wrap_angle(by_course - yaw).abs() > COURSE_SIGMAS * uncertain
        };
        let overrules = overrules && yaw.is_none_or(contradicts);
        let (heading, heading_sigma) = if overrules && uncertain < 0.2 {
            (by_course, uncertain.max(MEASURED_HEADING_SIGMA_RAD))
        } else {
            match (yaw, known) {
                (Some(yaw), _) => (yaw, MEASURED_HEADING_SIGMA_RAD),
                (None, known) => (known.unwrap_or(0.0), MAX_HEADING_SIGMA_RAD),
            }
        };
        self.heading_offset += heading - yaw.unwrap_or(heading);
        let along =
            dx * Real::cos(heading + self.direction) + dy * Real::sin(heading + self.direction);
        // the rims' way beside that course shows the slip
        let prior = [settings.slip.mean, settings.slip.sigma];
        let shown = slip_between(along, rim_way).filter(|_| uncertain < 0.2);
        self.models
            .set_slip_prior(shown.map_or(prior, |slip| [slip, SHOWN_SLIP_SIGMA.min(prior[1])]));
        self.models.start(place, heading, sigma, heading_sigma);
        self.models.set_slip_prior(prior);
        self.show_slide(place, (taken_ns, now_ns), settings);
    }
}

/// The slip of a robot that goes one way or speed while its rims go another; `None` where they go apart or nowhere.
pub(super) fn slip_between(robot: f64, rim: f64) -> Option<f64> {
    if robot * rim <= 0.0 {
        return None;
    }
    let share = robot / rim;
    Some(if share <= 1.0 {
        1.0 - share
    } else {
        1.0 / share - 1.0
    })
}

#[cfg(test)]
mod tests;
