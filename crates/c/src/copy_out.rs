//! Estimates and commands, copied into the caller's structs.

use grouser_slip::control::Mode;
use grouser_slip::{Degraded, Health, Invalid, Measured, Motion};

use crate::abi::{
    GROUSER_ERROR_WHEEL, GROUSER_HEALTH_DEGRADED, GROUSER_HEALTH_INVALID, GROUSER_HEALTH_OK,
    GROUSER_HEALTH_UNINITIALISED, GROUSER_KNOWS_FORWARD_SPEED, GROUSER_KNOWS_LAST_GOOD_AGE,
    GROUSER_KNOWS_REFERENCE_AGE, GROUSER_KNOWS_RIM_SPEED, GROUSER_KNOWS_SIDE_SLIP,
    GROUSER_KNOWS_SLIP, GROUSER_MODE_BACK_OUT, GROUSER_MODE_DETOUR, GROUSER_MODE_FORWARD,
    GROUSER_MODE_STOPPED, GROUSER_MODE_TRAVERSE, GROUSER_MOTION_BRAKING, GROUSER_MOTION_DRIVING,
    GROUSER_MOTION_LIFT_OFF, GROUSER_MOTION_ROLL_BACK, GROUSER_MOTION_STALL,
    GROUSER_MOTION_STANDSTILL, GROUSER_MOTION_UNKNOWN, GROUSER_REASON_DROPOUT,
    GROUSER_REASON_INCONSISTENT, GROUSER_REASON_LOW_SPEED, GROUSER_REASON_NO_REFERENCE,
    GROUSER_REASON_NONE, GROUSER_REASON_OTHER, GROUSER_REASON_QUANTISED,
    GROUSER_REASON_REFERENCE_LOST, GROUSER_REASON_RELATIVE, GROUSER_REASON_SUSPECT,
    GrouserBodyEstimate, GrouserCommand, GrouserWheelEstimate,
};
use crate::border::write;
use crate::create::{GrouserOnBoard, with};

/// Copies out what is known of a wheel.
///
/// # Safety
/// `on_board` as in [`grouser_push`](crate::grouser_push); `out` is NULL or points to a struct whose `size` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn grouser_wheel(
    on_board: *mut GrouserOnBoard,
    wheel: u32,
    out: *mut GrouserWheelEstimate,
) -> i32 {
    let work = |object: &mut GrouserOnBoard| {
        let index = wheel as usize;
        let output = object.on_board.estimate();
        let estimate = *output.wheels.get(index).ok_or(GROUSER_ERROR_WHEEL)?;
        let side_slip_angle = output.side_slip_angle(index);
        let motion = object.on_board.detector().motion(index, estimate.motion);
        let mut known = 0;
        let mut number = |bit: u32, value: Option<f64>| {
            if value.is_some() {
                known |= bit;
            }
            value.unwrap_or(0.0)
        };
        let sigma = |measured: Option<Measured>| measured.map(sigma);
        let value = |measured: Option<Measured>| measured.map(|m| m.value);
        let (health, reason) = health(estimate.health);
        let mut copy = GrouserWheelEstimate {
            health,
            reason,
            motion: motion.map_or(GROUSER_MOTION_UNKNOWN, motion_code),
            slip: number(
                GROUSER_KNOWS_SLIP,
                estimate.slip.map(grouser_slip::Slip::value),
            ),
            slip_sigma: number(GROUSER_KNOWS_SLIP, estimate.sigma),
            forward_speed_m_per_s: number(
                GROUSER_KNOWS_FORWARD_SPEED,
                value(estimate.forward_speed),
            ),
            forward_speed_sigma_m_per_s: number(
                GROUSER_KNOWS_FORWARD_SPEED,
                sigma(estimate.forward_speed),
            ),
            rim_speed_m_per_s: number(GROUSER_KNOWS_RIM_SPEED, value(estimate.rim_speed)),
            rim_speed_sigma_m_per_s: number(GROUSER_KNOWS_RIM_SPEED, sigma(estimate.rim_speed)),
            side_slip_angle_rad: number(GROUSER_KNOWS_SIDE_SLIP, value(side_slip_angle)),
            side_slip_angle_sigma_rad: number(GROUSER_KNOWS_SIDE_SLIP, sigma(side_slip_angle)),
            last_good_age_s: number(GROUSER_KNOWS_LAST_GOOD_AGE, estimate.last_good_age),
            ..GrouserWheelEstimate::default()
        };
        copy.known = known;
        // SAFETY: by this function's own condition
        unsafe { write(out, copy) }
    };
    // SAFETY: by this function's own condition
    unsafe { with(on_board, work) }
}

/// Copies out what is known of the robot.
///
/// # Safety
/// As [`grouser_wheel`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn grouser_body(
    on_board: *mut GrouserOnBoard,
    out: *mut GrouserBodyEstimate,
) -> i32 {
    let work = |object: &mut GrouserOnBoard| {
        let on_board = &mut object.on_board;
        let (mode, start_fault) = (mode(on_board.mode()), on_board.start_fault());
        let attitude = on_board.attitude();
        let (roll_rad, pitch_rad) = (attitude.roll(), attitude.pitch());
        let output = on_board.estimate();
        let (body, place) = (output.body, output.body.odometry);
        let copy = GrouserBodyEstimate {
            size: 0,
            known: if output.reference_age.is_some() {
                GROUSER_KNOWS_REFERENCE_AGE
            } else {
                0
            },
            mode,
            start_fault: start_fault.is_some().into(),
            time_ns: output.time_ns,
            time_slip_s: output.time_slip,
            forward_m_per_s: body.forward.value,
            forward_sigma_m_per_s: sigma(body.forward),
            left_m_per_s: body.left.value,
            left_sigma_m_per_s: sigma(body.left),
            yaw_rate_rad_per_s: body.yaw_rate.value,
            yaw_rate_sigma_rad_per_s: sigma(body.yaw_rate),
            common_slip: body.common_slip.value,
            common_slip_sigma: sigma(body.common_slip),
            x_m: place.x,
            y_m: place.y,
            yaw_rad: place.yaw,
            place_covariance: core::array::from_fn(|i| place.covariance[i / 3][i % 3]),
            distance_m: body.distance,
            distance_of_wheels_m: body.distance_of_wheels,
            roll_rad,
            pitch_rad,
            reference_age_s: output.reference_age.unwrap_or(0.0),
            rejected_bad_value: output.rejected.bad_value,
            rejected_not_later: output.rejected.not_later,
            rejected_jump: output.rejected.jump,
            rejected_unknown: output.rejected.unknown,
            dropped: output.dropped,
            clock_steps: output.clock_steps,
        };
        // SAFETY: by this function's own condition
        unsafe { write(out, copy) }
    };
    // SAFETY: by this function's own condition
    unsafe { with(on_board, work) }
}

/// Copies out a wheel's command of the last tick; before the first one it is a wheel at rest.
///
/// # Safety
/// As [`grouser_wheel`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn grouser_command(
    on_board: *mut GrouserOnBoard,
    wheel: u32,
    out: *mut GrouserCommand,
) -> i32 {
    let work = |object: &mut GrouserOnBoard| {
        let command = object
            .commands
            .get(wheel as usize)
            .ok_or(GROUSER_ERROR_WHEEL)?;
        let copy = GrouserCommand {
            size: 0,
            reserved: 0,
            rim_speed_m_per_s: command.rim_speed,
            traction: command.traction,
            steering_angle_rad: command.steering_angle,
        };
        // SAFETY: by this function's own condition
        unsafe { write(out, copy) }
    };
    // SAFETY: by this function's own condition
    unsafe { with(on_board, work) }
}

fn sigma(measured: Measured) -> f64 {
    measured.sigma()
}

fn health(health: Health) -> (u32, u32) {
    match health {
        Health::Uninitialised => (GROUSER_HEALTH_UNINITIALISED, GROUSER_REASON_NONE),
        Health::Ok => (GROUSER_HEALTH_OK, GROUSER_REASON_NONE),
        Health::Degraded(reason) => (
            GROUSER_HEALTH_DEGRADED,
            match reason {
                Degraded::LowSpeed => GROUSER_REASON_LOW_SPEED,
                Degraded::Quantised => GROUSER_REASON_QUANTISED,
                Degraded::ReferenceLost => GROUSER_REASON_REFERENCE_LOST,
                Degraded::Relative => GROUSER_REASON_RELATIVE,
                Degraded::Suspect => GROUSER_REASON_SUSPECT,
                _ => GROUSER_REASON_OTHER,
            },
        ),
        Health::Invalid(reason) => (
            GROUSER_HEALTH_INVALID,
            match reason {
                Invalid::Dropout => GROUSER_REASON_DROPOUT,
                Invalid::NoReference => GROUSER_REASON_NO_REFERENCE,
                Invalid::Inconsistent => GROUSER_REASON_INCONSISTENT,
                _ => GROUSER_REASON_OTHER,
            },
        ),
        _ => (GROUSER_HEALTH_INVALID, GROUSER_REASON_OTHER),
    }
}

fn motion_code(motion: Motion) -> u32 {
    match motion {
        Motion::Driving => GROUSER_MOTION_DRIVING,
        Motion::Braking => GROUSER_MOTION_BRAKING,
        Motion::Standstill => GROUSER_MOTION_STANDSTILL,
        Motion::RollBack => GROUSER_MOTION_ROLL_BACK,
        Motion::LiftOff => GROUSER_MOTION_LIFT_OFF,
        Motion::Stall => GROUSER_MOTION_STALL,
        _ => GROUSER_MOTION_UNKNOWN,
    }
}

fn mode(mode: Mode) -> u32 {
    match mode {
        Mode::Forward => GROUSER_MODE_FORWARD,
        Mode::Traverse => GROUSER_MODE_TRAVERSE,
        Mode::BackOut => GROUSER_MODE_BACK_OUT,
        Mode::Detour => GROUSER_MODE_DETOUR,
        Mode::Stopped => GROUSER_MODE_STOPPED,
    }
}
