//! The frame of the models in that of measured places, which have no heading: the course shows how it is turned.
//!
//! From the first place on, the models follow wheels and gyro in a frame of their own. Once the robot has gone far enough
//! against the error of a place, the way between two places and the models' way between the same moments differ by the
//! frame's turn. From then on a place is a position like any other, and the models keep the heading.

use grouser_real::Real;

/// The course is taken over at least this way, m, and over this many standard deviations of a place.
const MIN_COURSE_M: f64 = 0.2;
const COURSE_SIGMAS: f64 = 4.0;
/// A way longer than this multiple of the models' is no course but a place that jumped, or a robot that was carried.
const MAX_COURSE_PER_WAY: f64 = 3.0;
/// Course and heading differ by this for other reasons than the places, rad: the robot drifts sideways.
const DRIFT_SIGMA_RAD: f64 = 0.035;

/// Places and their turn.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PlaceFrame {
    /// The first place, m.
    origin: Option<[f64; 2]>,
    /// By how much the places' frame is turned against the models', rad.
    turn: Option<f64>,
}

impl PlaceFrame {
    /// A place in the models' frame; `None` before the course is known.
    pub(super) fn place(&self, place: [f64; 2]) -> Option<[f64; 2]> {
        let origin = self.origin?;
        let (sin, cos) = Real::sin_cos(self.turn?);
        let [x, y] = [place[0] - origin[0], place[1] - origin[1]];
        Some([cos * x + sin * y, cos * y - sin * x])
    }

    /// Has it begun?
    pub(super) const fn has_begun(&self) -> bool {
        self.origin.is_some()
    }

    /// Begins at a place, where the models stand at their origin.
    pub(super) fn begin(&mut self, place: [f64; 2]) {
        *self = Self {
            origin: Some(place),
            turn: None,
        };
    }

    /// Compares a place of standard deviation `sigma` with the models' (m). Returns the standard deviation of the course, rad, once
    /// it is known.
    pub(super) fn compare(&mut self, place: [f64; 2], models: [f64; 2], sigma: f64) -> Option<f64> {
        let origin = self.origin?;
        let [x, y] = [place[0] - origin[0], place[1] - origin[1]];
        let (way, course) = (Real::hypot(models[0], models[1]), Real::hypot(x, y));
        if way.min(course) < MIN_COURSE_M.max(COURSE_SIGMAS * sigma) {
            return None;
        }
        if course > MAX_COURSE_PER_WAY * way {
            self.origin = None;
            return None;
        }
        self.turn = Some(Real::atan2(y, x) - Real::atan2(models[1], models[0]));
        let by_places = core::f64::consts::SQRT_2 * sigma / course;
        Some(Real::hypot(by_places, DRIFT_SIGMA_RAD))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The models went 3 m ahead and 4 m to the left; the places 10 m to the south, half a metre of which is error.
    #[test]
    fn a_course_shows_the_turn_of_the_frame() {
        let mut frame = PlaceFrame::default();
        frame.begin([100.0, -50.0]);
        assert_eq!(frame.place([100.0, -60.0]), None);
        // 0.3 m say nothing where places have an error of 0.1 m
        assert_eq!(frame.compare([100.0, -50.3], [0.3, 0.0], 0.1), None);
        let sigma = frame.compare([100.0, -60.0], [3.0, 4.0], 0.5).unwrap();
        // √2 · 0.5 m over 10 m, and 2° of drift
        assert!((sigma - f64::hypot(0.070_710_678, 0.035)).abs() < 1e-9);
        let [x, y] = frame.place([100.0, -60.0]).unwrap();
        assert!(
            (x - 6.0).abs() < 1e-12 && (y - 8.0).abs() < 1e-12,
            "{x} {y}"
        );
        let [x, y] = frame.place([101.0, -60.0]).unwrap();
        assert!((x - 5.2).abs() < 1e-12 && (y - 8.6).abs() < 1e-12);
        // the shortest course, and the longest beside the models' way
        for (place, models) in [([0.2, 0.0], [0.2, 0.0]), ([0.0, 3.0], [1.0, 0.0])] {
            frame.begin([0.0, 0.0]);
            assert!(frame.compare(place, models, 0.01).is_some() && frame.has_begun());
        }
        // a place that is carried away is no course
        frame.begin([0.0, 0.0]);
        assert_eq!(frame.compare([10.0, 0.0], [1.0, 0.0], 0.01), None);
        assert!(!frame.has_begun());
    }
}
