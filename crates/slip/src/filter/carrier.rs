//! The carrier of a wheel (a rocker, an arm): the wheel's sensor counts against it, and it lifts the wheel over the ground.

use grouser_real::Real;

use crate::fault::Fault;
use crate::history::seconds_between;

/// No carrier turns faster than this (rad/s) or moves its wheel faster relative to the robot (m/s).
const MAX_CARRIER_RATE: f64 = 20.0;
/// The ground under a wheel is never steeper relative to the robot than this: rise over run.
const MAX_RELATIVE_SLOPE: f64 = 0.7;
/// Below this speed of the wheel its rise shows no slope, m/s.
const MIN_SLOPE_SPEED_M_PER_S: f64 = 1e-3;

/// The motion of one wheel's carrier.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carrier {
    radius: f64,
    dropout: f64,
    time_ns: Option<i64>,
    turn: f64,
    forward: f64,
    up: f64,
    /// The angle that it has turned in all, rad, and that at the beginning of the open window.
    turned: f64,
    from: f64,
}

impl Carrier {
    pub(super) const fn new(radius: f64, dropout: f64) -> Self {
        Self {
            radius,
            dropout,
            time_ns: None,
            turn: 0.0,
            forward: 0.0,
            up: 0.0,
            turned: 0.0,
            from: 0.0,
        }
    }

    pub(super) fn update(
        &mut self,
        time_ns: i64,
        [turn, forward, up]: [f64; 3],
    ) -> Result<(), Fault> {
        Fault::check_range(
            "carrier turn",
            turn,
            -MAX_CARRIER_RATE,
            MAX_CARRIER_RATE,
            "rad/s",
        )?;
        Fault::check_range(
            "carrier forward",
            forward,
            -MAX_CARRIER_RATE,
            MAX_CARRIER_RATE,
            "m/s",
        )?;
        Fault::check_range("carrier up", up, -MAX_CARRIER_RATE, MAX_CARRIER_RATE, "m/s")?;
        let last = self.time_ns.replace(time_ns).unwrap_or(time_ns);
        let passed = seconds_between(last, time_ns);
        if (0.0..=self.dropout).contains(&passed) {
            self.turned += 0.5 * passed * (turn + self.turn);
        }
        self.turn = turn;
        self.forward = forward;
        self.up = up;
        Ok(())
    }

    /// The clock was set: the last reading is forgotten.
    pub(super) const fn restart_clock(&mut self) {
        self.time_ns = None;
    }

    /// Marks the beginning of a window of the wheel.
    pub(super) fn mark(&mut self) {
        self.from = self.turned;
    }

    /// The travel of the rim in this window beyond the one that its sensor counted, m.
    pub(super) fn rolled(&self) -> f64 {
        self.radius * (self.turned - self.from)
    }

    /// The speed over the ground (m/s) of a wheel whose centre the robot moves at `speed` along the wheel's heading, and its
    /// derivative by `speed`. `ahead` is the forward component of the heading. Where the wheel rises relative to the robot,
    /// the ground under it is steeper and its way longer.
    pub(super) fn over_ground(&self, speed: f64, ahead: f64, now_ns: i64) -> (f64, f64) {
        let fresh = self
            .time_ns
            .is_some_and(|then| seconds_between(then, now_ns) <= self.dropout);
        if !fresh {
            return (speed, 1.0);
        }
        let level = speed + ahead * self.forward;
        let slope = if level.abs() > MIN_SLOPE_SPEED_M_PER_S {
            (self.up / level).clamp(-MAX_RELATIVE_SLOPE, MAX_RELATIVE_SLOPE)
        } else {
            0.0
        };
        let longer = Real::sqrt(1.0 + slope * slope);
        (level * longer, longer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS_M: f64 = 0.3;
    const MS: i64 = 1_000_000;
    const DROPOUT_NS: i64 = 100 * MS;

    fn carrier() -> Carrier {
        Carrier::new(RADIUS_M, seconds_between(0, DROPOUT_NS))
    }

    #[test]
    fn its_turn_is_the_trapezoid_of_its_rate_within_the_dropout_time() {
        let rolled = |clock_is_set: bool, to_ns: i64| {
            let mut carrier = carrier();
            carrier.update(20 * MS, [2.0, 0.4, 0.1]).unwrap();
            carrier.update(70 * MS, [2.0, 0.4, 0.1]).unwrap();
            carrier.mark();
            if clock_is_set {
                carrier.restart_clock();
            }
            carrier.update(to_ns, [3.0, 0.4, 0.1]).unwrap();
            carrier.rolled()
        };
        let last_ns = 70 * MS + DROPOUT_NS;
        // from 2 to 3 rad/s in 0.1 s
        assert!((rolled(false, last_ns) - RADIUS_M * 0.25).abs() < 1e-15);
        // beyond the dropout time, backwards, at the same time, and after the clock was set: none
        for (clock_is_set, to_ns) in [
            (false, last_ns + 1),
            (false, 10 * MS),
            (false, 70 * MS),
            (true, last_ns),
        ] {
            assert_eq!(rolled(clock_is_set, to_ns), 0.0, "{clock_is_set} {to_ns}");
        }
    }

    #[test]
    fn a_wheel_that_rises_goes_the_longer_way() {
        let over_ground = |speed, ahead, [forward, up]: [f64; 2], now_ns| {
            let mut carrier = carrier();
            carrier.update(0, [0.7, forward, up]).unwrap();
            carrier.over_ground(speed, ahead, now_ns)
        };
        let near = |(speed, longer): (f64, f64), expected: (f64, f64)| {
            (speed - expected.0).abs() < 1e-12 && (longer - expected.1).abs() < 1e-12
        };
        // 0.5 + 0.8 · 0.25 = 0.7 m/s ahead, 0.21 m/s up: a slope of 0.3
        let longer = f64::hypot(1.0, 0.3);
        let motion = over_ground(0.5, 0.8, [0.25, 0.21], DROPOUT_NS);
        assert!(near(motion, (0.7 * longer, longer)), "{motion:?}");
        let motion = over_ground(-0.5, 0.8, [-0.25, 0.21], DROPOUT_NS);
        assert!(near(motion, (-0.7 * longer, longer)), "{motion:?}");
        let steepest = f64::hypot(1.0, MAX_RELATIVE_SLOPE);
        let motion = over_ground(0.5, 0.8, [0.25, 5.0], DROPOUT_NS);
        assert!(near(motion, (0.7 * steepest, steepest)), "{motion:?}");
        // a reading that is too old, and a speed that shows no slope
        let motion = over_ground(0.5, 0.8, [0.25, 0.21], DROPOUT_NS + 1);
        assert_eq!(motion, (0.5, 1.0));
        let slow = MIN_SLOPE_SPEED_M_PER_S;
        assert_eq!(over_ground(slow, 0.8, [0.0, 0.21], 0), (slow, 1.0));
    }
}
