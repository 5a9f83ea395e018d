//! GNSS fixes as the robot's motion: a local tangent plane, and the course that the motion itself shows.

use std::collections::VecDeque;

use grouser_files::topics::Topics;
use grouser_real::{Real, wrap_angle};
use grouser_slip::Measurement;

use crate::message::NavSatFix;

/// Semi-major axis, m, and squared eccentricity of the ellipsoid of WGS 84 (NIMA TR8350.2).
const SEMI_MAJOR_M: f64 = 6_378_137.0;
const ECCENTRICITY_2: f64 = 6.694_379_990_141_317e-3;
/// The course is taken over at least this way, m: ten times the error of an RTK fix.
const MIN_COURSE_M: f64 = 0.2;
/// And over this many standard deviations of a fix.
const COURSE_SIGMAS: f64 = 4.0;
/// Without a gyro, a course that turns by more than this between two fixes is a robot that reverses, rad (120°); with a
/// gyro the turn is known, and whatever lies behind the robot is reversing.
const REVERSED_RAD: f64 = 2.1;
/// Course and heading differ by this for other reasons than the fixes, rad (2°): the robot drifts sideways.
const DRIFT_SIGMA_RAD: f64 = 0.035;
/// Process noise of the heading, rad per √s: beside a gyro of a robot, and without one.
const GYRO_NOISE_RAD_SQRT_S: f64 = 0.005;
const TURN_NOISE_RAD_SQRT_S: f64 = 0.5;
/// Standard deviation of a gyro's bias, rad/s: a cheap one that nobody calibrated; and its process noise, rad/s per √s.
const GYRO_BIAS_RAD_PER_S: f64 = 0.02;
const GYRO_DRIFT_RAD_PER_S: f64 = 2e-4;
/// A gyro that is silent for longer says nothing of the turn, s.
const MAX_GYRO_GAP_S: f64 = 0.5;
/// Readings of the gyro that are kept for fixes which come later than they were measured: 2 s at 1 kHz.
const MAX_TURNS: usize = 2048;
/// A receiver that has fixes of at most this horizontal standard deviation is used by these alone, m: one with worse ones
/// between them changes its kind of solution.
pub(super) const ACCURATE_SIGMA_M: f64 = 0.5;
/// A fix whose horizontal standard deviation is larger than this is never used, m.
pub(super) const MAX_SIGMA_M: f64 = 10.0;
/// The standard deviation of a fix by satellites alone where nothing states it, m.
pub(super) const UNSTATED_SIGMA_M: f64 = 2.5;
/// Where the standard deviation changes by more than this factor, the receiver changed its kind of solution, and the
/// position jumps with it.
const MAX_SIGMA_RATIO: f64 = 3.0;
/// The standard deviation of a place without a heading where nothing states it, m: a good one of ultra-wideband.
const PLACE_SIGMA_M: f64 = 0.05;
/// After a longer outage the way between two fixes is no measured motion, s.
const MAX_OUTAGE_S: f64 = 5.0;

/// Fixes that are looked at before one is used: half an hour at 10 Hz.
pub(crate) const MAX_FIXES: usize = 20_000;

impl NavSatFix {
    /// Why the fix is not used, if it is not; `limit` is the largest standard deviation that is, m.
    pub(super) fn fault(&self, limit: f64) -> Option<&'static str> {
        if !self.is_fixed {
            Some("fixes without a position (status below 0)")
        } else if !(self.latitude_deg.abs() <= 90.0 && self.longitude_deg.abs() <= 180.0) {
            Some("fixes whose latitude or longitude is out of range, or missing")
        } else if self.latitude_deg == 0.0 && self.longitude_deg == 0.0 {
            Some("fixes at latitude 0 and longitude 0, which receivers without a position send")
        } else if !(self.sigma() <= MAX_SIGMA_M) {
            Some("fixes with a standard deviation above 10 m")
        } else if self.sigma() > limit {
            Some("fixes with a standard deviation above 0.5 m, of a receiver that has better ones")
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
            (None, _) => UNSTATED_SIGMA_M,
        }
    }

    /// Place on the earth, m (WGS 84, centred and fixed to the earth). A missing altitude is 0.
    fn place(&self) -> [f64; 3] {
        let (sin, cos) = Real::sin_cos(self.latitude_deg.to_radians());
        let (sin_l, cos_l) = Real::sin_cos(self.longitude_deg.to_radians());
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

/// The standard deviation of places without a heading by the robot file, m, else a usual one with a note about the topic or
/// the file.
pub(crate) fn place_sigma(name: &str, topics: &Topics) -> (f64, Option<String>) {
    match topics.position_sigma {
        Some(sigma) => (sigma, None),
        None => (
            PLACE_SIGMA_M,
            Some(format!(
                "`{name}` does not say how accurate its places are: {PLACE_SIGMA_M} m is assumed; `position_sigma_m` in \
                 `[estimator]` states it"
            )),
        ),
    }
}

/// The fixes of a satellite receiver.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fixes {
    /// Standard deviations of those that can be used, m.
    sigmas: Vec<f64>,
    /// How many of them state none.
    unstated: usize,
    /// Why the first of the others cannot be.
    fault: Option<&'static str>,
}

impl Fixes {
    pub(super) fn add(&mut self, fix: &NavSatFix) {
        if self.sigmas.len() >= MAX_FIXES {
            return;
        }
        match fix.fault(MAX_SIGMA_M) {
            None => {
                self.sigmas.push(fix.sigma());
                self.unstated += usize::from(fix.variance.is_none());
            }
            Some(fault) => {
                self.fault.get_or_insert(fault);
            }
        }
    }

    /// The median of the standard deviations of the fixes to be used, and the largest that is, m; `None` where no fix can
    /// be used. A receiver with one accurate fix in ten is used by its accurate ones.
    fn sigma(&self) -> Option<(f64, f64)> {
        let mut sorted = self.sigmas.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let accurate = sorted.partition_point(|sigma| *sigma <= ACCURATE_SIGMA_M);
        let limit = if 10 * accurate >= sorted.len() {
            sorted.truncate(accurate);
            ACCURATE_SIGMA_M
        } else {
            MAX_SIGMA_M
        };
        Some((*sorted.get(sorted.len() / 2)?, limit))
    }

    /// [`Fixes::sigma`] of a topic or a file of that name, with a note about it where there is one.
    pub(crate) fn choose(&self, name: &str) -> (Option<(f64, f64)>, Option<String>) {
        let Some((sigma, limit)) = self.sigma() else {
            let fault = self.fault.unwrap_or("fixes that cannot be decoded");
            let note = format!("`{name}` is not used: it holds only {fault}");
            return (None, Some(note));
        };
        let note = (sigma > ACCURATE_SIGMA_M).then(|| {
            let says = if 2 * self.unstated > self.sigmas.len() {
                "does not say how accurate its fixes are, assumed is a standard deviation of"
            } else {
                "has fixes with a standard deviation of"
            };
            format!("`{name}` {says} {sigma:.1} m: slips follow slowly, over many metres")
        });
        (Some((sigma, limit)), note)
    }
}

/// Reads the fixes that columns of numbers hold.
#[derive(Clone, Debug)]
pub(crate) struct FixColumns {
    plane: Plane,
    /// The largest standard deviation that is used, m.
    limit: f64,
    /// What the robot file states of those that state none, m.
    stated: Option<f64>,
    /// All of them so far.
    pub(crate) seen: Fixes,
}

impl FixColumns {
    pub(crate) fn new(stated: Option<f64>) -> Self {
        Self {
            plane: Plane::default(),
            limit: MAX_SIGMA_M,
            stated,
            seen: Fixes::default(),
        }
    }

    /// With the largest standard deviation that is used, m.
    pub(crate) fn with_limit(self, limit: f64) -> Self {
        Self { limit, ..self }
    }

    /// A fix as a place, whose yaw is its standard deviation, m; else why it is not used.
    pub(crate) fn place(&mut self, mut fix: NavSatFix) -> Result<Measurement, &'static str> {
        fix.variance = fix.variance.or(self.stated.map(|sigma| sigma * sigma));
        self.seen.add(&fix);
        if let Some(fault) = fix.fault(self.limit) {
            return Err(fault);
        }
        let [x, y] = self.plane.place(&fix);
        let yaw = fix.sigma();
        Ok(Measurement::Pose { x, y, yaw })
    }
}

/// The track of an antenna on the plane that touches the earth at the first fix.
///
/// The gyro turns the heading, courses over ground correct it and the gyro's bias.
#[derive(Clone, Debug, Default)]
pub(crate) struct Track {
    /// Position of the antenna in the robot's frame, m.
    antenna: [f64; 2],
    plane: Plane,
    last: Option<Placed>,
    /// Where the course was taken last.
    anchor: Option<Placed>,
    /// The antenna's way since then, each step turned back by the gyro's turn: in a winding drive it points along the
    /// heading that the robot had where the gyro began.
    way: [f64; 2],
    /// What the antenna moved aside of the robot by its turns on that way, m.
    aside: f64,
    heading: Option<Heading>,
    /// The gyro's turn since the start, rad, over time.
    turns: VecDeque<(i64, f64)>,
    rate: f64,
}

/// The robot's heading less the gyro's turn, from east to north, rad, and the gyro's bias, rad/s: a Kalman filter.
#[derive(Clone, Copy, Debug)]
struct Heading {
    angle: f64,
    bias: f64,
    /// Variances of both and their covariance.
    angle_variance: f64,
    bias_variance: f64,
    covariance: f64,
}

impl Heading {
    fn new(angle: f64, variance: f64) -> Self {
        Self {
            angle,
            bias: 0.0,
            angle_variance: variance,
            bias_variance: Real::powi(GYRO_BIAS_RAD_PER_S, 2),
            covariance: 0.0,
        }
    }

    /// Predicts over a time (s) beside a gyro, or without one.
    fn predict(&mut self, passed: f64, has_gyro: bool) {
        if !has_gyro {
            self.angle_variance += Real::powi(TURN_NOISE_RAD_SQRT_S, 2) * passed;
            return;
        }
        self.angle -= self.bias * passed;
        self.angle_variance += passed * (passed * self.bias_variance - 2.0 * self.covariance)
            + Real::powi(GYRO_NOISE_RAD_SQRT_S, 2) * passed;
        self.covariance -= passed * self.bias_variance;
        self.bias_variance += Real::powi(GYRO_DRIFT_RAD_PER_S, 2) * passed;
    }

    /// Corrects both by how much a course of this variance is ahead of the heading.
    fn correct(&mut self, ahead: f64, variance: f64) {
        let total = self.angle_variance + variance;
        let (by_angle, by_bias) = (self.angle_variance / total, self.covariance / total);
        self.angle += by_angle * ahead;
        self.bias += by_bias * ahead;
        self.bias_variance -= by_bias * self.covariance;
        self.covariance *= 1.0 - by_angle;
        self.angle_variance *= 1.0 - by_angle;
    }
}

/// The plane that touches the earth at the first fix.
#[derive(Clone, Debug, Default)]
struct Plane(Option<Origin>);

impl Plane {
    /// East and north of the first fix, m.
    fn place(&mut self, fix: &NavSatFix) -> [f64; 2] {
        let place = fix.place();
        let origin = self.0.get_or_insert_with(|| {
            let (sin, cos) = Real::sin_cos(fix.latitude_deg.to_radians());
            let (sin_l, cos_l) = Real::sin_cos(fix.longitude_deg.to_radians());
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

#[derive(Clone, Debug)]
struct Origin {
    place: [f64; 3],
    east: [f64; 3],
    north: [f64; 3],
}

/// A fix on the plane.
#[derive(Clone, Copy, Debug)]
struct Placed {
    time_ns: i64,
    /// East and north, m.
    place: [f64; 2],
    /// The gyro's turn, rad; `None` without a gyro.
    turn: Option<f64>,
    sigma: f64,
}

impl Track {
    /// Of an antenna at a position in the robot's frame: forwards and to the left, m.
    pub(crate) fn new(antenna: [f64; 2]) -> Self {
        Self {
            antenna,
            ..Self::default()
        }
    }

    /// Takes a yaw rate, rad/s.
    pub(crate) fn turn(&mut self, time_ns: i64, rate: f64) {
        if !rate.is_finite() {
            return;
        }
        let before = std::mem::replace(&mut self.rate, rate);
        let turn = match self.turns.back() {
            Some(&(last_ns, _)) if last_ns >= time_ns => return,
            Some(&(last_ns, turn)) if seconds(last_ns, time_ns) < MAX_GYRO_GAP_S => {
                turn + 0.5 * (before + rate) * seconds(last_ns, time_ns)
            }
            Some(_) => {
                // What was turned in the gap is unknown.
                self.turns.clear();
                (self.heading, self.anchor, self.last) = (None, None, None);
                (self.way, self.aside) = ([0.0; 2], 0.0);
                0.0
            }
            None => 0.0,
        };
        self.turns.push_back((time_ns, turn));
        if self.turns.len() > MAX_TURNS {
            self.turns.pop_front();
        }
    }

    /// The gyro's turn at a time, rad.
    fn turn_at(&self, time_ns: i64) -> Option<f64> {
        let next = self.turns.partition_point(|(time, _)| *time < time_ns);
        let after = self.turns.get(next);
        let before = next
            .checked_sub(1)
            .and_then(|before| self.turns.get(before));
        match (before, after) {
            (Some(&(t0, turn0)), Some(&(t1, turn1))) => {
                let share = seconds(t0, time_ns) / seconds(t0, t1);
                Some(turn0 + (turn1 - turn0) * share)
            }
            (Some(&(time, turn)), None) | (None, Some(&(time, turn))) => {
                let gap = seconds(time, time_ns);
                (gap.abs() < MAX_GYRO_GAP_S).then_some(turn + self.rate * gap)
            }
            (None, None) => None,
        }
    }

    /// As [`Track::take`], of a fix.
    pub(super) fn take_fix(&mut self, time_ns: i64, fix: &NavSatFix) -> [Option<Measurement>; 2] {
        let place = self.on_plane(fix);
        self.take(time_ns, place, fix.sigma())
    }

    /// The place of the robot's origin, once it is known where that of the antenna is not the same, and [`Track::moved`].
    pub(crate) fn take(
        &mut self,
        time_ns: i64,
        place: [f64; 2],
        sigma: f64,
    ) -> [Option<Measurement>; 2] {
        let moved = self.moved(time_ns, place, sigma);
        [self.origin_at(time_ns, place), moved]
    }

    /// The place of the robot's origin by that of the antenna.
    fn origin_at(&self, time_ns: i64, [x, y]: [f64; 2]) -> Option<Measurement> {
        if !(x.is_finite() && y.is_finite()) {
            return None;
        }
        let [ahead, left] = self.antenna;
        if self.antenna == [0.0; 2] {
            return Some(Measurement::Position { x, y });
        }
        let (sin, cos) = Real::sin_cos(self.heading?.angle + self.turn_at(time_ns).unwrap_or(0.0));
        Some(Measurement::Position {
            x: x - (cos * ahead - sin * left),
            y: y - (sin * ahead + cos * left),
        })
    }

    /// The displacement of the robot's origin since the last place of its antenna in the robot's frame, once its heading is
    /// known. Places are on a plane, m, with a standard deviation.
    ///
    /// Assumes: the robot begins forwards and does not drift sideways in the mean; without a gyro it does not turn on the
    /// spot, and an antenna beside its origin shows the turns as motion.
    pub(crate) fn moved(
        &mut self,
        time_ns: i64,
        place: [f64; 2],
        sigma: f64,
    ) -> Option<Measurement> {
        if !place.iter().all(|part| part.is_finite()) {
            return None;
        }
        let now = Placed {
            time_ns,
            place,
            turn: self.turn_at(time_ns),
            sigma,
        };
        let last = self.last.replace(now)?;
        let passed = seconds(last.time_ns, time_ns);
        let ratio = now.sigma / last.sigma;
        let is_continued = (MAX_SIGMA_RATIO.recip()..=MAX_SIGMA_RATIO).contains(&ratio)
            && passed > 0.0
            && passed < MAX_OUTAGE_S
            && now.turn.is_some() == last.turn.is_some();
        if !is_continued {
            self.begin_course(now);
            return None;
        }
        if let Some(heading) = &mut self.heading {
            heading.predict(passed, now.turn.is_some());
        }
        let anchor = *self.anchor.get_or_insert(last);
        self.add_step(&last, &now);
        let size = Real::hypot(self.way[0], self.way[1]);
        if size >= MIN_COURSE_M.max(COURSE_SIGMAS * now.sigma) {
            self.correct_heading(&anchor, &now);
            self.begin_course(now);
        }
        let heading = self.heading?;
        let (turned, middle) = between(&last, &now);
        let (north, east) = Real::sin_cos(heading.angle + middle);
        let (dx, dy) = (now.place[0] - last.place[0], now.place[1] - last.place[1]);
        let arc = 2.0 * Real::sin(0.5 * turned);
        Some(Measurement::Displacement {
            forward: east * dx + north * dy + arc * self.antenna[1],
            left: east * dy - north * dx - arc * self.antenna[0],
            turn: None,
        })
    }

    fn begin_course(&mut self, from: Placed) {
        (self.anchor, self.way, self.aside) = (Some(from), [0.0; 2], 0.0);
    }

    /// Adds a step of the antenna to its way.
    fn add_step(&mut self, from: &Placed, to: &Placed) {
        let (turned, middle) = between(from, to);
        let (sin, cos) = Real::sin_cos(middle);
        let (dx, dy) = (to.place[0] - from.place[0], to.place[1] - from.place[1]);
        self.way[0] += cos * dx + sin * dy;
        self.way[1] += cos * dy - sin * dx;
        self.aside += 2.0 * Real::sin(0.5 * turned) * self.antenna[0];
    }

    /// Corrects the heading by the course of the antenna's way, whose own turn about the robot's origin is taken out.
    fn correct_heading(&mut self, from: &Placed, to: &Placed) {
        let ([x, y], aside) = (self.way, self.aside);
        let size = Real::hypot(x, y);
        if aside.abs() >= 0.7 * size {
            return;
        }
        let along = (size * size - aside * aside).sqrt();
        let course = Real::atan2(y, x);
        let (forwards, backwards) = (
            course - Real::atan2(aside, along),
            course - Real::atan2(aside, -along),
        );
        let noise =
            (2.0 * Real::powi(from.sigma, 2)) / (size * size) + Real::powi(DRIFT_SIGMA_RAD, 2);
        let Some(heading) = &mut self.heading else {
            self.heading = Some(Heading::new(forwards, noise));
            return;
        };
        let (ahead, behind) = (
            wrap_angle(forwards - heading.angle),
            wrap_angle(backwards - heading.angle),
        );
        let is_reversing = match to.turn {
            Some(_) => behind.abs() < ahead.abs(),
            None => ahead.abs() > REVERSED_RAD,
        };
        let innovation = if is_reversing { behind } else { ahead };
        heading.correct(innovation, noise);
    }

    fn on_plane(&mut self, fix: &NavSatFix) -> [f64; 2] {
        self.plane.place(fix)
    }
}

/// The turn by the gyro between two fixes, and the mean of its turns there, rad; 0 without a gyro.
fn between(from: &Placed, to: &Placed) -> (f64, f64) {
    let (from, to) = (from.turn.unwrap_or(0.0), to.turn.unwrap_or(0.0));
    (to - from, 0.5 * (from + to))
}

fn seconds(from_ns: i64, to_ns: i64) -> f64 {
    to_ns.saturating_sub(from_ns) as f64 * 1e-9
}

#[cfg(test)]
mod tests;
