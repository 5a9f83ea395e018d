//! Speed from counts over a window.

use core::f64::consts::TAU;

use super::Measured;
use crate::fault::Fault;

/// Speed from the ticks that a window of time saw.
///
/// ω = 2π n/(N T). The window begins and ends between two edges, so the true turn differs from n ticks
/// by the difference of two errors uniform over one tick: variance (2π/N)²/6, so
/// var ω = (2π/N)²/(6 T²).
///
/// Assumes: edges equally spaced, window ends independent of the edges. Valid at any speed; below one
/// tick a window it gives 0 or one tick, with a sigma that says so.
///
/// ```
/// use grouser_slip::CountWindow;
/// let window = CountWindow::new(500.0)?; // ticks per turn
/// let omega = window.speed(40, 0.1)?; // 40 ticks in 0.1 s
/// assert!((omega.value - 5.026_548_245_743_669).abs() < 1e-15);
/// assert!((omega.sigma() - 0.051_302).abs() < 1e-6); // rad/s
/// # Ok::<(), grouser_slip::Fault>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct CountWindow {
    angle_per_tick: f64,
}

impl CountWindow {
    /// An encoder of `ticks_per_turn` ticks.
    ///
    /// # Errors
    /// [`Fault::OutOfRange`] unless it lies in [1, 1e9].
    pub fn new(ticks_per_turn: f64) -> Result<Self, Fault> {
        Fault::check_range("ticks_per_turn", ticks_per_turn, 1.0, 1e9, "1")?;
        Ok(Self {
            angle_per_tick: TAU / ticks_per_turn,
        })
    }

    /// The mean speed over `window` seconds that saw `ticks` (signed), in rad/s.
    ///
    /// # Errors
    /// [`Fault::OutOfRange`] unless the window lies in [1e-6, 1e6] s.
    pub fn speed(&self, ticks: i64, window: f64) -> Result<Measured, Fault> {
        Fault::check_range("window", window, 1e-6, 1e6, "s")?;
        let per_tick = self.angle_per_tick / window;
        Ok(Measured {
            value: ticks as f64 * per_tick,
            variance: per_tick * per_tick / 6.0,
        })
    }
}
