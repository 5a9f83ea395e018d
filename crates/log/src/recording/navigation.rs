//! GNSS fixes as the robot's motion: a local tangent plane, and the course that the motion itself shows.

use grouser_slip::Measurement;

use crate::message::NavSatFix;

/// Semi-major axis, m, and squared eccentricity of the ellipsoid of WGS 84 (NIMA TR8350.2).
const SEMI_MAJOR_M: f64 = 6_378_137.0;
const ECCENTRICITY_2: f64 = 6.694_379_990_141_317e-3;
/// The course is taken over at least this way, m: ten times the error of an RTK fix.
const MIN_COURSE_M: f64 = 0.2;
/// And over this many standard deviations of a fix.
const COURSE_SIGMAS: f64 = 4.0;
/// A course that turns by more than this between two fixes is a robot that reverses, cos 120°.
const REVERSED_COS: f64 = -0.5;
/// A fix whose horizontal standard deviation is larger than this does not measure slip, m.
const MAX_SIGMA_M: f64 = 0.5;

impl NavSatFix {
    /// Why the fix is not used, if it is not.
    pub(crate) fn fault(&self) -> Option<&'static str> {
        if !self.is_fixed {
            Some("fixes without a position (status below 0)")
        } else if !(self.latitude_deg.abs() <= 90.0 && self.longitude_deg.abs() <= 180.0) {
            Some("fixes whose latitude or longitude is out of range, or missing")
        } else if !(self.sigma() <= MAX_SIGMA_M) {
            Some("fixes with a standard deviation above 0.5 m")
        } else {
            None
        }
    }

    /// The horizontal standard deviation, m: by the covariance, or by the status where that is unknown (GPS alone,
    /// with augmentation, with a ground station).
    pub(crate) fn sigma(&self) -> f64 {
        match (self.variance, self.status) {
            (Some(variance), _) => variance.sqrt(),
            (None, 2) => 0.02,
            (None, 1) => 1.0,
            (None, _) => 2.5,
        }
    }

    /// Place on the earth, m (WGS 84, centred and fixed to the earth). A missing altitude is 0.
    fn place(&self) -> [f64; 3] {
        let (sin, cos) = self.latitude_deg.to_radians().sin_cos();
        let (sin_l, cos_l) = self.longitude_deg.to_radians().sin_cos();
        let altitude = if self.altitude.is_finite() {
            self.altitude
        } else {
            0.0
        };
        let normal = SEMI_MAJOR_M / (1.0 - ECCENTRICITY_2 * sin * sin).sqrt();
        [
            (normal + altitude) * cos * cos_l,
            (normal + altitude) * cos * sin_l,
            (normal * (1.0 - ECCENTRICITY_2) + altitude) * sin,
        ]
    }
}

/// The track of an antenna on the plane that touches the earth at the first fix.
#[derive(Clone, Debug, Default)]
pub(super) struct Track {
    origin: Option<Origin>,
    /// The place of the last fix, east and north, m.
    last: Option<[f64; 2]>,
    /// Where the course was taken last, and the course, a unit vector.
    anchor: Option<[f64; 2]>,
    course: Option<[f64; 2]>,
}

#[derive(Clone, Debug)]
struct Origin {
    place: [f64; 3],
    east: [f64; 3],
    north: [f64; 3],
}

impl Track {
    /// The displacement since the last fix in the robot's frame, once the robot's course is known.
    ///
    /// Assumes: the robot begins forwards, and does not turn on the spot; the antenna stands above the robot's origin, or
    /// the robot drives straight.
    pub(super) fn displacement(&mut self, fix: &NavSatFix) -> Option<Measurement> {
        let place = self.on_plane(fix);
        let last = self.last.replace(place)?;
        let anchor = *self.anchor.get_or_insert(last);
        let way = [place[0] - anchor[0], place[1] - anchor[1]];
        let size = way[0].hypot(way[1]);
        if size >= MIN_COURSE_M.max(COURSE_SIGMAS * fix.sigma()) {
            let mut course = way.map(|part| part / size);
            if let Some(old) = self.course
                && old[0] * course[0] + old[1] * course[1] < REVERSED_COS
            {
                course = course.map(|part| -part);
            }
            (self.course, self.anchor) = (Some(course), Some(place));
        }
        let [east, north] = self.course?;
        let (dx, dy) = (place[0] - last[0], place[1] - last[1]);
        Some(Measurement::Displacement {
            forward: east * dx + north * dy,
            left: east * dy - north * dx,
            turn: None,
        })
    }

    /// East and north of the first fix, m.
    fn on_plane(&mut self, fix: &NavSatFix) -> [f64; 2] {
        let place = fix.place();
        let origin = self.origin.get_or_insert_with(|| {
            let (sin, cos) = fix.latitude_deg.to_radians().sin_cos();
            let (sin_l, cos_l) = fix.longitude_deg.to_radians().sin_cos();
            Origin {
                place,
                east: [-sin_l, cos_l, 0.0],
                north: [-sin * cos_l, -sin * sin_l, cos],
            }
        });
        let from: [f64; 3] = std::array::from_fn(|i| place[i] - origin.place[i]);
        [&origin.east, &origin.north].map(|axis| axis.iter().zip(from).map(|(a, d)| a * d).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fix(latitude_deg: f64, longitude_deg: f64) -> NavSatFix {
        NavSatFix {
            latitude_deg,
            longitude_deg,
            altitude: 100.0,
            is_fixed: true,
            status: 2,
            variance: None,
        }
    }

    #[test]
    fn a_drive_to_the_north_and_back_is_forwards_and_backwards() {
        // one second of arc of the meridian at 45° is 30.87 m
        let step = 0.1 / 30.87 / 3600.0;
        let mut track = Track::default();
        let mut ways = Vec::new();
        for k in (0..50).chain((0..49).rev()) {
            if let Some(Measurement::Displacement { forward, left, .. }) =
                track.displacement(&fix(45.0 + step * f64::from(k), 9.0))
            {
                ways.push(forward);
                assert!(left.abs() < 1e-6, "{left}");
            }
        }
        assert!((ways[0] - 0.1).abs() < 1e-4, "{}", ways[0]);
        assert!((ways.last().unwrap() + 0.1).abs() < 1e-4);
        let sum: f64 = ways.iter().sum();
        assert!(sum.abs() < 0.3, "{sum}");
    }

    #[test]
    fn bad_fixes_are_named() {
        assert_eq!(fix(45.0, 9.0).fault(), None);
        assert!(fix(91.0, 9.0).fault().is_some());
        assert!(fix(f64::NAN, 9.0).fault().is_some());
        let none = NavSatFix {
            is_fixed: false,
            ..fix(45.0, 9.0)
        };
        assert!(none.fault().is_some());
        let wide = NavSatFix {
            variance: Some(100.0),
            ..fix(45.0, 9.0)
        };
        assert!(wide.fault().is_some());
        // an unknown covariance is not exact
        let unknown = NavSatFix {
            status: 0,
            ..fix(45.0, 9.0)
        };
        assert!(unknown.fault().is_some() && unknown.sigma() > 1.0);
    }
}
