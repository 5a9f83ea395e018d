//! The start on soil that is not sheared yet. Thrust needs shear displacement, which a rim builds up by its travel: until then
//! the wheels slip by up to 0.9 for a third of a second, and the robot swings on the shear as on a spring. The soil's prior is
//! of steady motion and does not contain this: the common slip changes fast then.

use super::kalman::Kalman;
use super::motion_model::COMMON_SLIP;
use crate::robot::{Robot, WheelRole};

/// A start lasts until the rims have travelled this many radii of a wheel: 1.4 lengths of a contact of half a radius, after
/// which a quarter of the shear is still to build up. With more travel, or more noise, a free wheel that begins to skid at twice
/// its speed within the first second is believed (`a_free_wheel_that_fails_is_found` of the generator's crate).
const START_TRAVEL_RADII: f64 = 0.7;
/// Process noise density of the common slip during a start, 1/√s: it changes by 0.2 within 0.1 s (the shipped sandbox).
const START_SLIP_NOISE: f64 = 0.7;
/// This noise makes the common slip no less certain than this, so that it stays below `max_sigma` beside a wheel's own slip.
const START_SLIP_SIGMA: f64 = 0.2;

/// The travel of the powered rims since they stood or turned round.
#[derive(Clone, Copy, Debug)]
pub(super) struct StartShear {
    /// m.
    travel: f64,
    /// Travel at which the start is over, m.
    end: f64,
    /// The rims' last mean speed, m/s.
    rim_speed: f64,
    /// Are the rims within their first travel?
    is_under_way: bool,
}

impl StartShear {
    /// For a robot with a free wheel, which measures the slip during a start; `None` for others.
    pub(super) fn of(robot: &Robot) -> Option<Self> {
        let wheels = robot.wheels();
        let powered = wheels
            .iter()
            .filter(|wheel| wheel.role == WheelRole::Powered);
        let radius = powered.map(|wheel| wheel.radius).reduce(f64::max)?;
        let has_free = wheels.iter().any(|wheel| wheel.role == WheelRole::Free);
        has_free.then(|| Self::new(radius))
    }

    /// For powered wheels of at most this radius, m.
    const fn new(radius: f64) -> Self {
        Self {
            travel: 0.0,
            end: START_TRAVEL_RADII * radius,
            rim_speed: 0.0,
            is_under_way: false,
        }
    }

    /// Predicts the common slip after `dt` (s) in which the powered rims turned at the mean speed `rims` (m/s; `None`: not known).
    pub(super) fn predict(
        &mut self,
        state: &mut Kalman,
        dt: f64,
        rims: Option<f64>,
        low_speed: f64,
    ) {
        if let Some(rims) = rims {
            self.travel_on(rims, dt, low_speed);
        }
        if self.is_under_way {
            let limit = START_SLIP_SIGMA * START_SLIP_SIGMA;
            let noise = START_SLIP_NOISE * START_SLIP_NOISE * dt;
            state.inflate(COMMON_SLIP, noise, limit);
        }
    }

    /// The rims turn at `rim_speed` (m/s) for `dt` (s). Below `low_speed` (m/s) they have no slip.
    fn travel_on(&mut self, rim_speed: f64, dt: f64, low_speed: f64) {
        let rests = rim_speed == 0.0 || rim_speed.abs() < low_speed;
        if rests || rim_speed * self.rim_speed < 0.0 {
            self.travel = 0.0;
        }
        self.rim_speed = rim_speed;
        self.travel = (self.travel + rim_speed.abs() * dt).min(self.end);
        self.is_under_way = !rests && self.travel < self.end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How long the start is under way (steps of 0.01 s) while rims of wheels of 0.15 m turn at `rim_speed`.
    fn under_way(start: &mut StartShear, rim_speed: f64) -> usize {
        let mut steps = 0;
        for _ in 0..500 {
            start.travel_on(rim_speed, 0.01, 0.02);
            steps += usize::from(start.is_under_way);
        }
        steps
    }

    #[test]
    fn a_start_lasts_for_one_radius_of_travel_after_each_rest_and_turn() {
        let mut start = StartShear::new(0.15);
        assert_eq!(under_way(&mut start, 0.07), 149);
        assert_eq!(under_way(&mut start, 0.31), 0);
        // turned round
        assert_eq!(under_way(&mut start, -0.31), 33);
        // at rest there is no slip; after it the shear builds up again
        assert_eq!(under_way(&mut start, 0.019), 0);
        assert_eq!(under_way(&mut start, -0.31), 33);
    }

    #[test]
    fn a_start_begins_at_the_low_speed_and_ends_at_its_travel() {
        const DT_S: f64 = 0.5;
        const RIM_M_PER_S: f64 = 0.0625;
        let mut start = StartShear::new(1.0);
        start.end = 3.0 * RIM_M_PER_S * DT_S;
        for is_under_way in [true, true, false, false] {
            start.travel_on(RIM_M_PER_S, DT_S, RIM_M_PER_S);
            assert_eq!(start.is_under_way, is_under_way);
        }
        // without a low speed a rim that stops rests, too
        let mut start = StartShear::new(1.0);
        for rim_speed in [RIM_M_PER_S, 0.0, -RIM_M_PER_S] {
            start.travel_on(rim_speed, DT_S, 0.0);
            assert_eq!(start.is_under_way, rim_speed != 0.0);
        }
        assert_eq!(start.travel, RIM_M_PER_S * DT_S);
    }

    #[test]
    fn slip_changes_fast_within_a_start() {
        const DT_S: f64 = 0.01;
        let mut state = Kalman::new(COMMON_SLIP + 1);
        state.reset(COMMON_SLIP, 0.1, 0.03);
        let mut start = StartShear::new(0.15);
        let mut after = |rims: Option<f64>| {
            start.predict(&mut state, DT_S, rims, 0.02);
            state.covariance(COMMON_SLIP, COMMON_SLIP)
        };
        let noise = 0.7 * 0.7 * DT_S;
        for (rims, variance) in [
            (None, 0.03),
            (Some(0.01), 0.03),
            (Some(0.07), 0.03 + noise),
            // it goes on where the rims are not known, up to a standard deviation of 0.2
            (None, 0.03 + 2.0 * noise),
            (None, 0.2 * 0.2),
        ] {
            let found = after(rims);
            assert!((found - variance).abs() < 1e-12, "{found} {variance}");
        }
    }

    #[test]
    fn only_a_free_wheel_measures_the_slip_of_a_start() {
        use crate::robot::Wheel;
        let (a, b) = (
            Wheel::powered("a").radius(0.1),
            Wheel::powered("b").radius(0.3),
        );
        let free = Wheel::free("c").radius(0.5);
        let of = |wheels: &[&Wheel]| {
            let wheels = wheels.iter().map(|wheel| (*wheel).clone()).collect();
            StartShear::of(&Robot::new("cart".into(), wheels).unwrap())
        };
        assert!(of(&[&a, &b]).is_none() && of(&[&free]).is_none());
        // 0.7 radii of the larger one
        let end = of(&[&b, &a, &free]).unwrap().end;
        assert!((end - 0.21).abs() < 1e-12);
    }
}
