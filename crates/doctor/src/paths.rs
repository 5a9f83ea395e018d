//! Straight paths of a pose: its course compared with its yaw.

use std::f64::consts::PI;

use grouser_real::{Real, solve, wrap_angle};

/// Straight paths: their length, m, and in standard deviations of a place; how far they turn, rad, and their longest time, s.
pub(crate) const MIN_PATH_M: f64 = 0.5;
const PATH_SIGMAS: f64 = 6.0;
const MAX_BEND_RAD: f64 = 0.05;
const MAX_PATH_TIME_S: f64 = 20.0;
/// Paths that are kept and that must have been, at least.
const MAX_PATHS: usize = 4000;
const MIN_PATHS: usize = 8;
/// Directions of paths agree where the mean of their unit vectors is at least this long.
const AGREED_LENGTH: f64 = 0.85;
/// The headings of paths show a mirrored place where the mean of their unit vectors, at twice the angle, is not longer.
const MAX_HEADINGS_LENGTH: f64 = 0.7;
/// An offset of the yaw is reported beyond this angle (5°) and this number of standard deviations.
const MIN_OFFSET_RAD: f64 = 0.087;
const OFFSET_SIGMAS: f64 = 5.0;
/// Standard deviation of a robot's drift on a side slope, rad, which changes with the heading as an offset of the yaw does not.
const DRIFT_RAD: f64 = 0.3;
/// Paths in succession have correlated errors: this times their variance, and not less than the second number, rad².
const PATH_VARIANCE_FACTOR: f64 = 2.0;
const MIN_PATH_VARIANCE: f64 = 4e-4;

/// Where a path begins.
#[derive(Clone, Copy, Debug)]
struct Begun {
    time_ns: i64,
    place: [f64; 2],
    yaw: f64,
    sign: f64,
}

/// The paths of a log.
#[derive(Clone, Debug, Default)]
pub(crate) struct Paths {
    low_speed: f64,
    min_path: f64,
    /// Mean speed of the powered wheels, m/s.
    speed: f64,
    open_straight: Option<Begun>,
    /// Course less yaw, and the direction along the yaw in which the wheels drove, of straight paths, rad.
    straight: Vec<[f64; 2]>,
}

impl Paths {
    /// For places of standard deviation `sigma`, m.
    pub(crate) fn new(low_speed: f64, sigma: f64) -> Self {
        Self {
            low_speed,
            min_path: MIN_PATH_M.max(PATH_SIGMAS * sigma),
            ..Self::default()
        }
    }

    /// Takes the mean speed of the powered wheels, m/s.
    pub(crate) const fn step(&mut self, speed: f64) {
        self.speed = speed;
    }

    /// Takes a place, m, and its yaw, rad.
    pub(crate) fn take(&mut self, now_ns: i64, place: [f64; 2], yaw: f64) {
        let sign = if self.speed.abs() > self.low_speed {
            self.speed.signum()
        } else {
            0.0
        };
        let here = Begun {
            time_ns: now_ns,
            place,
            yaw,
            sign,
        };
        let passed = |begun: &Begun| now_ns.saturating_sub(begun.time_ns) as f64 * 1e-9;
        let is_straight = |begun: &Begun| {
            begun.sign == sign
                && wrap_angle(yaw - begun.yaw).abs() < MAX_BEND_RAD
                && passed(begun) < MAX_PATH_TIME_S
        };
        let mut straight = self.open_straight.filter(is_straight);
        if let Some(begun) = straight {
            let [dx, dy] = [place[0] - begun.place[0], place[1] - begun.place[1]];
            if Real::hypot(dx, dy) >= self.min_path {
                let backwards = if sign < 0.0 { PI } else { 0.0 };
                let ahead = begun.yaw + 0.5 * wrap_angle(yaw - begun.yaw) + backwards;
                let course = Real::atan2(dy, dx);
                if self.straight.len() < MAX_PATHS {
                    self.straight.push([wrap_angle(course - ahead), ahead]);
                }
                straight = None;
            }
        }
        self.open_straight = straight.or((sign != 0.0).then_some(here));
    }

    /// Length of the mean unit vector of an angle of the straight paths.
    fn length(&self, angle: impl Fn(&[f64; 2]) -> f64) -> f64 {
        let (mut x, mut y) = (0.0, 0.0);
        for path in &self.straight {
            let (sin, cos) = Real::sin_cos(angle(path));
            x += cos;
            y += sin;
        }
        Real::hypot(x, y) / self.straight.len() as f64
    }

    /// Does the course turn against the yaw?
    pub(crate) fn is_mirrored(&self) -> bool {
        self.straight.len() >= MIN_PATHS
            && self.length(|[_, yaw]| 2.0 * yaw) < MAX_HEADINGS_LENGTH
            && self.length(|[angle, yaw]| angle + 2.0 * yaw) > AGREED_LENGTH
            && self.length(|[angle, _]| *angle) < AGREED_LENGTH
    }

    /// The angle a from the yaw ψ to the course, of angle = a + b cos ψ + c sin ψ: b and c are the drift on a slope.
    pub(crate) fn offset(&self, heading: f64) -> Option<f64> {
        let count = self.straight.len();
        if count < MIN_PATHS || self.length(|[angle, _]| *angle) < AGREED_LENGTH {
            return None;
        }
        let (mut x, mut y) = (0.0, 0.0);
        for [angle, _] in &self.straight {
            x += Real::cos(*angle);
            y += Real::sin(*angle);
        }
        let mean = Real::atan2(y, x);
        let rest = |path: &[f64; 2]| wrap_angle(path[0] - mean);
        let squares: f64 = self
            .straight
            .iter()
            .map(|path| Real::powi(rest(path), 2))
            .sum();
        let variance = (squares / count as f64).max(MIN_PATH_VARIANCE) * PATH_VARIANCE_FACTOR;
        let prior = variance / (DRIFT_RAD * DRIFT_RAD);
        let mut normal = [[0.0, 0.0, 0.0], [0.0, prior, 0.0], [0.0, 0.0, prior]];
        let mut right = [0.0; 3];
        for path in &self.straight {
            let (sin, cos) = Real::sin_cos(path[1]);
            let row = [1.0, cos, sin];
            for (i, line) in normal.iter_mut().enumerate() {
                for (slot, other) in line.iter_mut().zip(row) {
                    *slot += row[i] * other;
                }
                right[i] += row[i] * (mean + rest(path));
            }
        }
        let angle = solve(normal, right)?[0] - heading;
        let sigma = (solve(normal, [1.0, 0.0, 0.0])?[0] * variance).sqrt();
        (angle.abs() > MIN_OFFSET_RAD + OFFSET_SIGMAS * sigma).then_some(angle)
    }
}
