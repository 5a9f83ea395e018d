//! The range of tests that a soil's numbers were fitted on.

use crate::error::{Error, Result};
use crate::kinematics::Kinematics;

/// Share of a range's limit by which a point may lie beyond it without a caution: rounding of files and of tests
/// that are repeated.
const RANGE_TOLERANCE_SHARE: f64 = 0.01;

/// The least and greatest slip, slip angle, width and load of the tests that a soil's numbers were fitted on.
///
/// Outside it the laws are computed and carry [`Caution::OutsideFit`](crate::Caution): a fit of a narrow wheel
/// need not hold for a wide one.
///
/// ```
/// use grouser_terra::{FittedRange, Kinematics, Slip};
/// let range = FittedRange {
///     slip: (-0.7, 0.75),
///     slip_angle: (0.0, 0.0),
///     width: (0.05, 0.05),
///     load: (20.0, 26.0),
/// };
/// let at = |slip| Slip::new(slip).map(Kinematics::straight);
/// assert!(range.holds(&at(0.5)?, 0.05, 24.0));
/// assert!(!range.holds(&at(0.9)?, 0.05, 24.0) && !range.holds(&at(0.5)?, 0.2, 24.0));
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedRange {
    /// Slip in the wheel's plane.
    pub slip: (f64, f64),
    /// Magnitude of the slip angle, rad.
    pub slip_angle: (f64, f64),
    /// Width of the wheel, m.
    pub width: (f64, f64),
    /// Load, N.
    pub load: (f64, f64),
}

impl FittedRange {
    /// Checks that each range is one.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a limit that is NaN, outside its quantity's own range or above its other end.
    pub fn check(&self) -> Result<()> {
        for (field, (low, high), (least, most), unit) in [
            ("fitted_slip", self.slip, (-1.0, 1.0), "1"),
            (
                "fitted_slip_angle",
                self.slip_angle,
                (0.0, core::f64::consts::FRAC_PI_2),
                "rad",
            ),
            ("fitted_width", self.width, (0.0, 100.0), "m"),
            ("fitted_load", self.load, (0.0, 1e12), "N"),
        ] {
            Error::check_range(field, high, least, most, unit)?;
            Error::check_range(field, low, least, high, unit)?;
        }
        Ok(())
    }

    /// Does a wheel of `width` (m) in this motion under `load` (N) lie within what was fitted?
    #[must_use]
    pub fn holds(&self, kinematics: &Kinematics, width: f64, load: f64) -> bool {
        let within = |x: f64, (low, high): (f64, f64)| {
            x >= low - RANGE_TOLERANCE_SHARE * low.abs()
                && x <= high + RANGE_TOLERANCE_SHARE * high.abs()
        };
        within(kinematics.slip().value(), self.slip)
            && within(kinematics.slip_angle().rad().abs(), self.slip_angle)
            && within(width, self.width)
            && within(load, self.load)
    }
}
