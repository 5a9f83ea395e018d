//! Speed from counts between time-stamped edges (the M/T method).

use core::f64::consts::TAU;

use super::Measured;
use crate::fault::Fault;
use crate::history::seconds_between;

/// Speed from whole pulses between two time-stamped edges: no tick is cut, so only the clock's
/// resolution is left.
///
/// ω = 2π n/(N (t_b − t_a)) with n pulses from the edge at t_a to the edge at t_b. A clock of
/// resolution δ gives each time an error uniform over δ, so var ω = ω² · δ²/(6 (t_b − t_a)²).
///
/// Assumes: edges equally spaced. n = 0 has no speed: use the bound of [`PeriodSpeed`](super::PeriodSpeed).
///
/// ```
/// use grouser_slip::MixedSpeed;
/// let law = MixedSpeed::new(500.0, 1e-6)?; // ticks per turn, clock resolution in s
/// let omega = law.speed(39, 0, 98_000_000)?; // 39 pulses in 98 ms
/// assert!((omega.value - 5.000_902_6).abs() < 1e-7);
/// assert!(omega.sigma() < 1e-4);
/// # Ok::<(), grouser_slip::Fault>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct MixedSpeed {
    angle_per_tick: f64,
    clock_resolution: f64,
}

impl MixedSpeed {
    /// An encoder of `ticks_per_turn` ticks whose edges are timed to `clock_resolution` seconds.
    ///
    /// # Errors
    /// [`Fault::OutOfRange`] for ticks outside [1, 1e9] or a resolution outside [0, 1] s.
    pub fn new(ticks_per_turn: f64, clock_resolution: f64) -> Result<Self, Fault> {
        Fault::check_range("ticks_per_turn", ticks_per_turn, 1.0, 1e9, "1")?;
        Fault::check_range("clock_resolution", clock_resolution, 0.0, 1.0, "s")?;
        Ok(Self {
            angle_per_tick: TAU / ticks_per_turn,
            clock_resolution,
        })
    }

    /// The mean speed from the edge at `first_ns` to the edge at `last_ns`, `pulses` (signed) later,
    /// in rad/s.
    ///
    /// # Errors
    /// [`Fault::OutOfRange`] for no pulses or times less than 1e-9 s or more than 1e6 s apart.
    pub fn speed(&self, pulses: i64, first_ns: i64, last_ns: i64) -> Result<Measured, Fault> {
        let span = seconds_between(first_ns, last_ns);
        Fault::check_range("pulses", (pulses as f64).abs(), 1.0, f64::MAX, "1")?;
        Fault::check_range("span", span, 1e-9, 1e6, "s")?;
        let value = pulses as f64 * self.angle_per_tick / span;
        let relative = self.clock_resolution / span;
        Ok(Measured {
            value,
            variance: value * value * relative * relative / 6.0,
        })
    }
}
