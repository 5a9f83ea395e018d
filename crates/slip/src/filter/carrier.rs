//! How a wheel's carrier moves beside the robot: a sensor counts against it, and it lifts the wheel over the ground.

use grouser_real::Real;

use crate::fault::Fault;
use crate::history::seconds_between;

/// Nothing that carries a wheel turns faster than this, rad/s, or moves faster beside the robot, m/s.
const MOST: f64 = 20.0;
/// The ground under a wheel is no steeper beside the robot than this.
const STEEPEST: f64 = 0.7;

/// What is known of one wheel's carrier.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carrier {
    radius: f64,
    dropout: f64,
    time_ns: Option<i64>,
    turn: f64,
    forward: f64,
    up: f64,
    /// How far it has turned, rad: in all, and when the open window began.
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

    pub(super) fn take(
        &mut self,
        time_ns: i64,
        [turn, forward, up]: [f64; 3],
    ) -> Result<(), Fault> {
        Fault::check_range("carrier turn", turn, -MOST, MOST, "rad/s")?;
        Fault::check_range("carrier forward", forward, -MOST, MOST, "m/s")?;
        Fault::check_range("carrier up", up, -MOST, MOST, "m/s")?;
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

    /// The clock was set.
    pub(super) const fn restart_clock(&mut self) {
        self.time_ns = None;
    }

    /// A window of the wheel begins.
    pub(super) fn mark(&mut self) {
        self.from = self.turned;
    }

    /// What the rim has rolled in this window beyond what its sensor counted, m.
    pub(super) fn rolled(&self) -> f64 {
        self.radius * (self.turned - self.from)
    }

    /// The speed over the ground (m/s) of a wheel whose centre the robot moves at `speed` along its heading, which has the
    /// share `ahead` forwards; and how much it grows with `speed`. Where the wheel rises beside the robot, the ground is
    /// steeper under it, and its way longer.
    pub(super) fn over_ground(&self, speed: f64, ahead: f64, now_ns: i64) -> (f64, f64) {
        let fresh = self
            .time_ns
            .is_some_and(|then| seconds_between(then, now_ns) <= self.dropout);
        if !fresh {
            return (speed, 1.0);
        }
        let level = speed + ahead * self.forward;
        let slope = if level.abs() > 1e-3 {
            (self.up / level).clamp(-STEEPEST, STEEPEST)
        } else {
            0.0
        };
        let longer = Real::sqrt(1.0 + slope * slope);
        (level * longer, longer)
    }
}
