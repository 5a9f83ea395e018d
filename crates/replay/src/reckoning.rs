//! Odometry step by step: the filter's own, or the motion integrated.

use std::collections::VecDeque;

use grouser_real::Real;
use grouser_slip::{BodyMotion, Health, Invalid, Robot, WheelEstimate, WheelRole};

use crate::checks::WayCheck;
use crate::moment::{Moment, Travel, seconds};
use crate::odometry::{Odometry, sandwich};
use crate::place_way::{PlaceWay, RimPath};
use crate::ways::along_rims;

/// The robot's odometry: the filter's own where it runs alone, else the motion integrated, by the reference or by the
/// wheels.
///
/// What the wheels said and the reference did not follow is slip. It is put into the covariance as a
/// whole, P_v = Σ + d dᵀ with d = (v_wheels − v, 0, 0), so that a filter which fuses this odometry trusts it
/// the less, the more the wheels slip. The pose's covariance grows as if the errors of one window were
/// independent of the next one's: dP = J P_v Jᵀ · window · dt, J the turn by yaw.
///
/// Assumes: level ground. Speeds are means over a window, so that the pose lags by half of it.
#[derive(Clone, Debug)]
pub(crate) struct Reckoning {
    window: f64,
    until_ns: Option<i64>,
    pose: [f64; 3],
    covariance: [[f64; 3]; 3],
    distances: [f64; 2],
    ways: WaysBeside,
    /// Where the filter goes by places, if there are any.
    by_places: Option<PlaceWay>,
    /// The path of the wheels, and the robot's heading along it, rad.
    rims: RimPath,
    heading: f64,
    /// The filter's odometry at the first step.
    origin: Option<Odometry>,
}

impl Reckoning {
    /// Begins at the origin; `window` is that of the estimates, s.
    pub(crate) fn new(window: f64, by_places: Option<PlaceWay>) -> Self {
        Self {
            window,
            by_places,
            rims: RimPath::default(),
            heading: 0.0,
            until_ns: None,
            pose: [0.0; 3],
            covariance: [[0.0; 3]; 3],
            distances: [0.0; 2],
            ways: WaysBeside::default(),
            origin: None,
        }
    }

    /// The odometry after an estimate; `None` where it says nothing new, or no motion is known.
    pub(crate) fn step(&mut self, moment: &Moment) -> Option<Odometry> {
        let until_ns = moment.until_ns?;
        let motion = moment.motion?;
        let last_ns = self.until_ns.replace(until_ns).unwrap_or(until_ns);
        if until_ns < last_ns {
            return None;
        }
        // A gap is no motion that was seen.
        let passed = seconds(last_ns, until_ns);
        let is_gap = passed > self.window;
        if is_gap {
            self.ways.forget();
        }
        let seconds = passed.min(self.window);
        let mut covariance = motion.covariance;
        // a reference that is read more seldom than the window of the estimates has no motion in it
        let seldom = moment.travel.and_then(|travel| travel.motion);
        let wheels = moment.wheels_motion.or(seldom);
        if let Some(wheels) = wheels {
            let (by_wheels, along) = along_the_wheels(&wheels, &motion);
            self.distances[0] += along.abs() * seconds;
            self.distances[1] += by_wheels * seconds;
            self.roll(&wheels, motion.velocity[2], seconds);
            covariance[0][0] += Real::powi(wheels.velocity[0] - motion.velocity[0], 2);
        }
        let filter = self.ways.step((until_ns, seconds), &motion, wheels, moment);
        if let Some(by_places) = &mut self.by_places {
            let path = (!is_gap).then_some(self.rims);
            by_places.step(until_ns, path, filter);
        }
        let [distance, distance_of_wheels] = self.distances;
        if let Some(odometry) = &moment.odometry {
            return Some(Odometry {
                distance,
                distance_of_wheels,
                ..odometry.since(self.origin.get_or_insert(*odometry))
            });
        }
        self.advance(&motion, &covariance, seconds);
        Some(Odometry {
            pose: self.pose,
            pose_covariance: self.covariance,
            velocity: motion.velocity,
            velocity_covariance: covariance,
            distance,
            distance_of_wheels,
        })
    }

    /// Takes a place without a heading, m, with its stamp.
    pub(crate) fn take_place(&mut self, stamp_ns: i64, place: [f64; 2]) {
        if let Some(by_places) = &mut self.by_places {
            by_places.take(stamp_ns, place);
        }
    }

    /// Ways so far, for comparison.
    pub(crate) fn ways(&self) -> WayCheck {
        self.ways_by_places().unwrap_or(self.ways.check)
    }

    /// The ways by places without a heading, where these are the reference.
    pub(crate) fn ways_by_places(&self) -> Option<WayCheck> {
        self.by_places.as_ref().and_then(PlaceWay::ways)
    }

    /// Does the filter go by places without a heading?
    pub(crate) fn is_by_places(&self) -> bool {
        self.by_places.as_ref().is_some_and(PlaceWay::has_places)
    }

    /// The wheels run on for a time at the speeds that they have, while the robot turns at `turn` (rad/s).
    fn roll(&mut self, wheels: &BodyMotion, turn: f64, seconds: f64) {
        let [v_x, v_y, _] = wheels.velocity;
        let (sin, cos) = Real::sin_cos(self.heading + 0.5 * turn * seconds);
        self.heading += turn * seconds;
        self.rims.x += (cos * v_x - sin * v_y) * seconds;
        self.rims.y += (sin * v_x + cos * v_y) * seconds;
        self.rims.way += Real::hypot(v_x, v_y) * seconds;
    }

    fn advance(&mut self, motion: &BodyMotion, covariance: &[[f64; 3]; 3], seconds: f64) {
        let [forward, left, turn] = motion.velocity;
        let middle = self.pose[2] + 0.5 * turn * seconds;
        let (sin, cos) = Real::sin_cos(middle);
        let step = [
            (forward * cos - left * sin) * seconds,
            (forward * sin + left * cos) * seconds,
            turn * seconds,
        ];
        // How an error in yaw moves the step: F = 1 + [−Δy, Δx]ᵀ in the column of yaw.
        let carry = [[1.0, 0.0, -step[1]], [0.0, 1.0, step[0]], [0.0, 0.0, 1.0]];
        let turned = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]];
        let old = sandwich(&carry, &self.covariance);
        let new = sandwich(&turned, covariance);
        for i in 0..3 {
            self.pose[i] += step[i];
            for j in 0..3 {
                self.covariance[i][j] = old[i][j] + new[i][j] * self.window * seconds;
            }
        }
    }
}

/// The filter's way beside those of wheels and reference, all between the same times: positions that come late bring the way of
/// their delay with them, which means over windows count twice or not at all.
#[derive(Clone, Debug, Default)]
struct WaysBeside {
    check: WayCheck,
    /// The motion by the wheels that was known last: its direction counts.
    wheels: Option<BodyMotion>,
    /// The filter's way up to now, m, and before it up to the times that the others have not reached.
    by_filter: VecDeque<(i64, f64)>,
    /// The ways that are counted, and the filter's up to there.
    last: Option<(Travel, f64)>,
}

impl WaysBeside {
    /// Counts the ways up to a time; gives the filter's since the last time.
    fn step(
        &mut self,
        (now_ns, seconds): (i64, f64),
        motion: &BodyMotion,
        wheels: Option<BodyMotion>,
        moment: &Moment,
    ) -> f64 {
        self.wheels = wheels.or(self.wheels);
        let along = (self.wheels).map_or(0.0, |wheels| along_the_wheels(&wheels, motion).1);
        let before = self.by_filter.back().map_or(0.0, |(_, way)| *way);
        self.by_filter.push_back((now_ns, before + along * seconds));
        let until_ns = moment.travel.map_or(now_ns, |travel| travel.until_ns);
        let passed = self
            .by_filter
            .partition_point(|(time, _)| *time <= until_ns);
        self.by_filter.drain(..passed.saturating_sub(1));
        let is_known = |travel: &Travel| {
            (self.by_filter.front()).is_some_and(|(from, _)| travel.until_ns >= *from)
        };
        match moment.travel.filter(is_known) {
            Some(travel) => self.count(travel),
            None => self.last = None,
        }
        along * seconds
    }

    /// Begins anew after a gap, over which the filter's way is not known but the counts of wheels and reference go on.
    fn forget(&mut self) {
        self.by_filter.clear();
        self.last = None;
    }

    /// Counts the ways up to that of wheels and reference.
    fn count(&mut self, travel: Travel) {
        let filter = self.filter_at(travel.until_ns);
        let (last, filter_before) = *self.last.get_or_insert((travel, filter));
        // they grow in steps
        if travel.wheels == last.wheels && travel.reference == last.reference {
            return;
        }
        let (wheels, reference) = along_rims((
            travel.wheels - last.wheels,
            travel.reference - last.reference,
        ));
        self.check.wheels += wheels;
        self.check.reference += reference;
        self.check.filter += filter - filter_before;
        self.last = Some((travel, filter));
    }

    /// The filter's way up to a time, m.
    fn filter_at(&self, time_ns: i64) -> f64 {
        match (self.by_filter.front(), self.by_filter.get(1)) {
            (Some((from, a)), Some((to, b))) if time_ns > *from => {
                a + (time_ns - from) as f64 / (to - from) as f64 * (b - a)
            }
            (first, _) => first.map_or(0.0, |(_, way)| *way),
        }
    }
}

/// Speed by the wheels, and the robot's along the way of its wheels, m/s.
fn along_the_wheels(wheels: &BodyMotion, motion: &BodyMotion) -> (f64, f64) {
    let [w_x, w_y, _] = wheels.velocity;
    let [v_x, v_y, _] = motion.velocity;
    let speed = Real::hypot(w_x, w_y);
    if speed > 0.0 {
        (speed, (w_x * v_x + w_y * v_y) / speed)
    } else {
        (0.0, 0.0)
    }
}

/// The powered wheels whose sensors contradict the others, bit by bit; none where all of them do: such a robot is carried.
pub(crate) fn inconsistent(wheels: &[WheelEstimate], robot: &Robot) -> u64 {
    let (mut found, mut bit, mut has_other) = (0, 1, false);
    for (wheel, described) in wheels.iter().zip(robot.wheels()) {
        if described.role == WheelRole::Powered {
            if wheel.health == Health::Invalid(Invalid::Inconsistent) {
                found |= bit;
            } else {
                has_other = true;
            }
        }
        bit <<= 1;
    }
    if has_other { found } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(until_s: i64, velocity: [f64; 3], wheels: [f64; 3], variance: f64) -> Moment {
        let motion = |velocity| BodyMotion {
            velocity,
            covariance: [[variance, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
        };
        Moment {
            time_ns: until_s * 1_000_000_000,
            read: 1,
            wheels: Vec::new(),
            motion: Some(motion(velocity)),
            wheels_motion: Some(motion(wheels)),
            travel: None,
            until_ns: Some(until_s * 1_000_000_000),
            odometry: None,
        }
    }

    #[test]
    fn a_circle_closes_and_slip_shows_in_the_covariance() {
        let mut reckoning = Reckoning::new(1.0, None);
        let turn = std::f64::consts::TAU / 100.0;
        let mut last = None;
        for second in 0..=100 {
            last = reckoning.step(&moment(second, [0.2, 0.0, turn], [0.3, 0.0, turn], 1e-4));
        }
        let odometry = last.unwrap();
        assert!(
            odometry.pose[0].hypot(odometry.pose[1]) < 1e-12,
            "{odometry:?}"
        );
        assert!((odometry.pose[2] - std::f64::consts::TAU).abs() < 1e-12);
        assert!((odometry.distance - 20.0).abs() < 1e-9);
        assert!((odometry.distance_of_wheels - 30.0).abs() < 1e-9);
        // 0.1 m/s of slip: 1e-4 + 0.1² m²/s².
        assert!((odometry.velocity_covariance[0][0] - 0.0101).abs() < 1e-15);
        // In a hundred windows, along x and y together: 100 · 0.0101 m².
        let spread = odometry.pose_covariance[0][0] + odometry.pose_covariance[1][1];
        assert!((spread - 1.01).abs() < 1e-9, "{spread}");
    }

    #[test]
    fn nothing_known_is_nothing_said() {
        let mut reckoning = Reckoning::new(0.5, None);
        let nothing = Moment {
            motion: None,
            ..moment(0, [0.0; 3], [0.0; 3], 1.0)
        };
        assert_eq!(reckoning.step(&nothing), None);
    }
}
