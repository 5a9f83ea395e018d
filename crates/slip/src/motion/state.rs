//! The numbers of the state.

use grouser_real::Real;

/// How many numbers the state has.
pub const SIZE: usize = 8;
/// Place in the reference's frame, m.
pub const X: usize = 0;
/// See [`X`].
pub const Y: usize = 1;
/// Heading in the reference's frame, rad.
pub const HEADING: usize = 2;
/// Mean speed over the step, along the direction in which the wheels run, m/s.
pub const SPEED: usize = 3;
/// The powered wheels' common logarithmic slip λ = ln(wheel speed/speed over ground): s = 1 − e^−λ where they drive, e^λ − 1 where
/// they brake.
pub const SLIP: usize = 4;
/// Sideways speed over [`SPEED`], to the left of the direction in which the wheels run.
pub const DRIFT: usize = 5;
/// Error of the turn rate that the gyro (or the wheels) show, rad/s.
pub const TURN_BIAS: usize = 6;
/// Error of the accelerometer along the direction of travel, a slope's share included, m/s².
pub const FORCE_BIAS: usize = 7;

/// A wheel that spins on the spot has this logarithmic slip at most (a slip of 0.98), and a locked one this at least.
pub const MAX_LOG_SLIP: f64 = 4.0;

/// The slip of a logarithmic slip, and its derivative: 1 − e^−λ where the wheel drives, e^λ − 1 where it brakes.
///
/// ```
/// use grouser_slip::motion::slip_of_log;
/// assert!((slip_of_log(2.0_f64.ln()).0 - 0.5).abs() < 1e-15);
/// assert!((slip_of_log(-2.0_f64.ln()).0 + 0.5).abs() < 1e-15);
/// ```
#[must_use]
pub fn slip_of_log(log: f64) -> (f64, f64) {
    let share = Real::exp(-log.abs());
    (if log >= 0.0 { 1.0 - share } else { share - 1.0 }, share)
}

/// The slip of a logarithmic slip with a variance, and the variance of its error. Within a sigma of [`MAX_LOG_SLIP`] it may be
/// anything up to full slip.
///
/// ```
/// use grouser_slip::motion::{MAX_LOG_SLIP, slip_within};
/// let (slip, variance) = slip_within(MAX_LOG_SLIP, 1e-6);
/// assert!((1.0 - slip) / variance.sqrt() < 1.01);
/// ```
#[must_use]
pub fn slip_within(log: f64, variance: f64) -> (f64, f64) {
    let (slip, slope) = slip_of_log(log);
    let is_full = log.abs() + Real::sqrt(variance) >= MAX_LOG_SLIP;
    let beyond = if is_full { 1.0 } else { 0.0 };
    (slip, slope * slope * (variance + beyond))
}

/// The logarithmic slip of a wheel that runs at `wheel` while its centre moves at `ground` along it.
#[must_use]
pub fn log_slip(wheel: f64, ground: f64) -> f64 {
    let ratio = wheel / ground;
    if ratio > 0.0 {
        Real::ln(ratio).clamp(-MAX_LOG_SLIP, MAX_LOG_SLIP)
    } else if wheel == 0.0 {
        -MAX_LOG_SLIP
    } else {
        MAX_LOG_SLIP
    }
}
