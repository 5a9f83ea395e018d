//! Samples in, and the control loop.

use grouser_slip::control::Request;

use crate::abi::{GROUSER_ERROR_VALUE, GROUSER_ERROR_WHEEL, GROUSER_SAMPLE_REFUSED, GrouserSample};
use crate::border::read;
use crate::create::{GrouserOnBoard, with};
use crate::sample::parse;

/// Takes one sample that arrives at `now_ns` by the computer's clock.
///
/// # Safety
/// `on_board` is NULL or was returned by `grouser_new`, has not been freed, and no other thread uses it. `sample` is NULL or
/// points to a sample whose `size` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn grouser_push(
    on_board: *mut GrouserOnBoard,
    now_ns: i64,
    sample: *const GrouserSample,
) -> i32 {
    let work = |object: &mut GrouserOnBoard| {
        // SAFETY: by this function's own condition
        let given = unsafe { read(sample) }?;
        let parsed = parse(&given)?;
        let measurement = &parsed.measurement;
        // the filter does not see raw numbers as they are, so that it cannot refuse them
        if measurement.is_raw() {
            if given.values.iter().any(|value| !value.is_finite()) {
                return Err(GROUSER_ERROR_VALUE);
            }
            let is_unknown = |wheel| wheel >= object.commands.len();
            if measurement.wheel().is_some_and(is_unknown) {
                return Err(GROUSER_ERROR_WHEEL);
            }
        }
        let refused = object.on_board.refused();
        object.on_board.update_at(now_ns, parsed);
        if object.on_board.refused() > refused {
            return Err(GROUSER_SAMPLE_REFUSED);
        }
        Ok(())
    };
    // SAFETY: by this function's own condition
    unsafe { with(on_board, work) }
}

/// Runs the control loop; [`grouser_command`](crate::grouser_command) copies the commands out.
///
/// # Safety
/// `on_board` as in [`grouser_push`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn grouser_tick(
    on_board: *mut GrouserOnBoard,
    now_ns: i64,
    speed_m_per_s: f64,
    heading_rad: f64,
) -> i32 {
    let work = |object: &mut GrouserOnBoard| {
        let request = Request {
            speed: speed_m_per_s,
            heading: heading_rad,
            yaw_rate: None,
        };
        let commands = object.on_board.tick(now_ns, request);
        object.commands.copy_from_slice(commands);
        // the robot stands, whether the caller looks at this or not
        if !(speed_m_per_s.is_finite() && heading_rad.is_finite()) {
            return Err(GROUSER_ERROR_VALUE);
        }
        Ok(())
    };
    // SAFETY: by this function's own condition
    unsafe { with(on_board, work) }
}

/// A wheel is steered by `angle_rad` to the left from now on.
///
/// # Safety
/// `on_board` as in [`grouser_push`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn grouser_set_steering_angle(
    on_board: *mut GrouserOnBoard,
    wheel: u32,
    angle_rad: f64,
) -> i32 {
    let work = |object: &mut GrouserOnBoard| {
        let wheel = wheel as usize;
        if wheel >= object.commands.len() {
            return Err(GROUSER_ERROR_WHEEL);
        }
        let outcome = object.on_board.set_steering_angle(wheel, angle_rad);
        outcome.map_err(|_| GROUSER_ERROR_VALUE)
    };
    // SAFETY: by this function's own condition
    unsafe { with(on_board, work) }
}
