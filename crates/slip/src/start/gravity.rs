//! Which way is up, by what three axes show at rest.

use grouser_real::Real;
use grouser_terra::{Angle, EARTH_GRAVITY_M_PER_S2};

use crate::fault::Fault;

/// Gravity and a good sensor differ by no more than this share.
const GRAVITY_TOLERANCE_SHARE: f64 = 0.1;

/// Checks the specific force (m/s²; forwards, to the left, up) of a robot that rests on ground no steeper than `steepest`: at
/// rest an accelerometer shows 9.81 m/s² upwards. Gives the tilt, rad.
///
/// # Errors
/// [`Fault::Implausible`] names the axis: along which gravity lies instead (axes exchanged, the robot on its side), or up, with
/// the other sign (upside down, or gravity's own sign), or in another unit. [`Fault::NotFinite`].
///
/// ```
/// use grouser_slip::start::check_gravity;
/// use grouser_terra::{Angle, EARTH_GRAVITY_M_PER_S2};
/// let steepest = Angle::from_deg(35.0);
/// let tilt = check_gravity([1.70, 0.0, 9.66], steepest)?; // nose up by 10°
/// assert!((tilt.deg() - 10.0).abs() < 0.05);
/// let exchanged = check_gravity([9.8, 0.1, 0.2], steepest).unwrap_err();
/// assert!(exchanged.to_string().contains("acceleration forward"));
/// let upside_down = check_gravity([0.0, 0.1, -9.8], steepest).unwrap_err();
/// assert!(upside_down.to_string().contains("acceleration up"));
/// # Ok::<(), grouser_slip::Fault>(())
/// ```
pub fn check_gravity(force: [f64; 3], steepest: Angle) -> Result<Angle, Fault> {
    let fields = [
        "acceleration forward",
        "acceleration left",
        "acceleration up",
    ];
    for (field, value) in fields.into_iter().zip(force) {
        Fault::check_finite(field, value, "m/s²")?;
    }
    let [forward, left, up] = force;
    let size = Real::hypot(Real::hypot(forward, left), up);
    let implausible = |field, times, looks_like| {
        Err(Fault::Implausible {
            field,
            times,
            looks_like,
        })
    };
    if !((size / EARTH_GRAVITY_M_PER_S2 - 1.0).abs() <= GRAVITY_TOLERANCE_SHARE) {
        let looks_like = if (size - 1.0).abs() <= GRAVITY_TOLERANCE_SHARE {
            "g given as m/s²"
        } else if (size / (1000.0 * EARTH_GRAVITY_M_PER_S2) - 1.0).abs() <= GRAVITY_TOLERANCE_SHARE
        {
            "mm/s² given as m/s²"
        } else {
            "another unit, or a robot that does not rest"
        };
        return implausible("acceleration up", size / EARTH_GRAVITY_M_PER_S2, looks_like);
    }
    let level = Real::hypot(forward, left);
    let tilt = Real::atan2(level, up);
    if tilt <= steepest.rad() {
        return Ok(Angle::from_rad(tilt));
    }
    let (index, most) = force
        .into_iter()
        .enumerate()
        .fold((2, 0.0_f64), |best, (i, f)| {
            if f.abs() > best.1.abs() { (i, f) } else { best }
        });
    let looks_like = if index == 2 {
        "upside down, or gravity with the other sign"
    } else {
        "gravity lies along this axis at rest"
    };
    implausible(fields[index], most / EARTH_GRAVITY_M_PER_S2, looks_like)
}
