//! The carrier of a wheel (a rocker, an arm): the wheel's sensor counts against it, and it lifts the wheel over the ground.

use grouser_real::Real;

use crate::fault::Fault;
use crate::history::seconds_between;

/// No carrier turns faster than this (rad/s) or moves its wheel faster relative to the robot (m/s).
const MAX_CARRIER_RATE: f64 = 20.0;
/// The ground under a wheel is never steeper relative to the robot than this: rise over run.
const MAX_RELATIVE_SLOPE: f64 = 0.7;

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
        if passed > 0.0 && passed <= self.dropout {
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
        let slope = if level.abs() > 1e-3 {
            (self.up / level).clamp(-MAX_RELATIVE_SLOPE, MAX_RELATIVE_SLOPE)
        } else {
            0.0
        };
        let longer = Real::sqrt(1.0 + slope * slope);
        (level * longer, longer)
    }
}
