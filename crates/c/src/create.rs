//! The object behind the opaque pointer: made of structs or of a robot file's text, and freed.

use alloc::{boxed::Box, format, vec, vec::Vec};
use core::ffi::{CStr, c_char};
use core::fmt;

use grouser_slip::control::WheelCommand;
use grouser_slip::filter::FilterSettings;
use grouser_slip::onboard::{OnBoard, OnBoardSettings, StartPolicy};
use grouser_slip::{CounterWidth, Encoder, MAX_WHEELS, Robot, Shaft, Wheel};
use grouser_terra::Angle;

use crate::abi::{
    GROUSER_ABI, GROUSER_ENCODER_ON_MOTOR, GROUSER_ENCODER_REVERSED, GROUSER_ERROR_DESCRIPTION,
    GROUSER_ERROR_INTERNAL, GROUSER_ERROR_POINTER, GROUSER_ERROR_SIZE, GROUSER_ERROR_VALUE,
    GROUSER_FREE, GROUSER_POWERED, GROUSER_START_OFF, GROUSER_START_REFUSE, GROUSER_START_REPORT,
    GrouserFilterSetting, GrouserSettings, GrouserWheel,
};
use crate::border::{Code, check_pointer, guarded, read, write};
use crate::message::Message;

/// More settings than the filter has are refused before they are read.
const MAX_FILTER_SETTINGS: usize = FilterSettings::FIELDS.len();

/// The software of one robot. C sees it as an opaque pointer.
#[derive(Debug)]
pub struct GrouserOnBoard {
    pub(crate) on_board: OnBoard,
    /// Those of the last tick.
    pub(crate) commands: Box<[WheelCommand]>,
    /// A panic was caught in it.
    pub(crate) is_broken: bool,
}

/// Runs `work` with the object behind a pointer. An object in which a panic was caught is not used again.
///
/// # Safety
/// `on_board` is NULL or was returned by `grouser_new`, has not been freed, and no other thread uses it.
pub(crate) unsafe fn with(
    on_board: *mut GrouserOnBoard,
    work: impl FnOnce(&mut GrouserOnBoard) -> Result<(), Code>,
) -> Code {
    if let Err(code) = check_pointer(on_board) {
        return code;
    }
    // SAFETY: not NULL and aligned; alive and not shared by this function's own condition
    let on_board = unsafe { &mut *on_board };
    if on_board.is_broken {
        return GROUSER_ERROR_INTERNAL;
    }
    // it stays set when `work` panics
    on_board.is_broken = true;
    let code = guarded(|| {
        let outcome = work(on_board);
        on_board.is_broken = false;
        outcome
    });
    debug_assert!(!on_board.is_broken || code == GROUSER_ERROR_INTERNAL);
    code
}

/// The version of the interface that the library was built with; compare it with the header's `GROUSER_ABI`.
#[unsafe(no_mangle)]
pub extern "C" fn grouser_abi() -> u32 {
    GROUSER_ABI
}

/// Writes the settings that apply without any.
///
/// # Safety
/// `out` is NULL or points to a `GrouserSettings` whose `size` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn grouser_default_settings(out: *mut GrouserSettings) -> i32 {
    guarded(|| {
        let robot = Robot::new("default".into(), vec![Wheel::free("wheel")])
            .map_err(|_| GROUSER_ERROR_DESCRIPTION)?;
        let settings = OnBoardSettings::new(&robot);
        let value = GrouserSettings {
            size: 0,
            start_policy: GROUSER_START_REPORT,
            warm_up_s: settings.warm_up,
            gravity_m_per_s2: 0.0,
            heading_rad: settings.heading,
            filter: core::ptr::null(),
            filter_count: 0,
        };
        // SAFETY: by this function's own condition
        unsafe { write(out, value) }
    })
}

/// Makes the software of a robot of these wheels. It allocates; nothing else in this interface does.
///
/// # Safety
/// `wheels` points to `wheel_count` wheels, `settings` is NULL or points to settings whose array and keys are readable,
/// `out` is writable, `message` is NULL or has `message_size` writable bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn grouser_new(
    wheels: *const GrouserWheel,
    wheel_count: usize,
    settings: *const GrouserSettings,
    out: *mut *mut GrouserOnBoard,
    message: *mut c_char,
    message_size: usize,
) -> i32 {
    // SAFETY: by this function's own condition
    let mut message = unsafe { Message::new(message, message_size) };
    guarded(|| {
        // SAFETY: `out` is writable where it is not NULL
        let out = unsafe { empty(out, &mut message) }?;
        if wheel_count == 0 || wheel_count > MAX_WHEELS {
            let text = format!("wheel_count is {wheel_count}, but must be 1 to {MAX_WHEELS}");
            return Err(refuse(&mut message, GROUSER_ERROR_SIZE, text));
        }
        check_pointer(wheels).map_err(|code| refuse(&mut message, code, "wheels is NULL"))?;
        let mut described = Vec::with_capacity(wheel_count);
        for index in 0..wheel_count {
            // SAFETY: `wheels` points to `wheel_count` wheels
            let wheel = unsafe { read(wheels.add(index)) }
                .map_err(|code| refuse(&mut message, code, format!("wheel {index}: wrong size")))?;
            let parsed = described_wheel(index, &wheel);
            described.push((
                parsed.map_err(|(code, text)| refuse(&mut message, code, text))?,
                wheel,
            ));
        }
        let robot = Robot::new(
            "robot".into(),
            described.iter().map(|d| d.0.clone()).collect(),
        )
        .map_err(|error| refuse(&mut message, GROUSER_ERROR_DESCRIPTION, error))?;
        let mut on_board = OnBoardSettings::new(&robot);
        for (setup, (_, wheel)) in on_board.wheels.iter_mut().zip(&described) {
            setup.max_torque = known(wheel.max_torque_n_m);
            setup.max_steering_angle = wheel.max_steering_angle_rad;
        }
        // SAFETY: by this function's own condition
        unsafe { finish(&robot, on_board, settings, out, &mut message) }
    })
}

/// Makes the software of the robot that a robot file's text describes, with the file's settings of the filter.
///
/// # Safety
/// As [`grouser_new`]; `text` points to `text_size` bytes.
#[cfg(feature = "std")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn grouser_new_from_toml(
    text: *const c_char,
    text_size: usize,
    settings: *const GrouserSettings,
    out: *mut *mut GrouserOnBoard,
    message: *mut c_char,
    message_size: usize,
) -> i32 {
    // SAFETY: by this function's own condition
    let mut message = unsafe { Message::new(message, message_size) };
    guarded(|| {
        // SAFETY: `out` is writable where it is not NULL
        let out = unsafe { empty(out, &mut message) }?;
        check_pointer(text).map_err(|code| refuse(&mut message, code, "text is NULL"))?;
        if text_size as u64 > grouser_files::SIZE_LIMIT {
            let limit = grouser_files::SIZE_LIMIT;
            let text = format!("text has {text_size} bytes, but must have at most {limit} bytes");
            return Err(refuse(&mut message, GROUSER_ERROR_SIZE, text));
        }
        // SAFETY: `text` points to `text_size` bytes, fewer than half the address space
        let bytes = unsafe { core::slice::from_raw_parts(text.cast::<u8>(), text_size) };
        let text = core::str::from_utf8(bytes)
            .map_err(|error| refuse(&mut message, GROUSER_ERROR_DESCRIPTION, error))?;
        let file = grouser_files::Document::from_text("robot", text.into())
            .and_then(|document| grouser_files::robot::parse(&document))
            .map_err(|error| refuse(&mut message, GROUSER_ERROR_DESCRIPTION, error))?;
        let mut on_board = OnBoardSettings::new(&file.robot);
        on_board.filter = file.filter;
        on_board.gravity = file.gravity.unwrap_or(on_board.gravity);
        // SAFETY: by this function's own condition
        unsafe { finish(&file.robot, on_board, settings, out, &mut message) }
    })
}

/// Frees the object; NULL is allowed.
///
/// # Safety
/// `on_board` is NULL or was returned by `grouser_new` and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn grouser_free(on_board: *mut GrouserOnBoard) {
    if !on_board.is_null() {
        guarded(|| {
            // SAFETY: it came from `Box::into_raw` in `finish`
            drop(unsafe { Box::from_raw(on_board) });
            Ok(())
        });
    }
}

/// Writes the number of wheels.
///
/// # Safety
/// `on_board` as in [`grouser_push`](crate::grouser_push); `out` is NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn grouser_wheel_count(
    on_board: *mut GrouserOnBoard,
    out: *mut usize,
) -> i32 {
    let work = |object: &mut GrouserOnBoard| {
        check_pointer(out)?;
        // SAFETY: not NULL, aligned, writable
        unsafe { out.write(object.commands.len()) };
        Ok(())
    };
    // SAFETY: by this function's own condition
    unsafe { with(on_board, work) }
}

/// Writes an error's text and returns its code.
fn refuse(message: &mut Message, code: Code, text: impl fmt::Display) -> Code {
    message.set(text);
    code
}

/// Sets `*out` to NULL, so that a program that ignores the code does not use it.
///
/// # Safety
/// `out` is NULL or writable.
unsafe fn empty(
    out: *mut *mut GrouserOnBoard,
    message: &mut Message,
) -> Result<*mut *mut GrouserOnBoard, Code> {
    check_pointer(out).map_err(|code| refuse(message, code, "out is NULL"))?;
    // SAFETY: not NULL, aligned, writable
    unsafe { out.write(core::ptr::null_mut()) };
    Ok(out)
}

/// A number of which 0 means that it is not known.
fn known(value: f64) -> Option<f64> {
    (value != 0.0).then_some(value)
}

fn described_wheel(
    index: usize,
    wheel: &GrouserWheel,
) -> Result<Wheel, (Code, alloc::string::String)> {
    let name = format!("wheel {index}");
    let blank = match wheel.role {
        GROUSER_POWERED => Wheel::powered(name),
        GROUSER_FREE => Wheel::free(name),
        other => {
            let text = format!("wheel {index}: role is {other}, but must be 0 or 1");
            return Err((GROUSER_ERROR_VALUE, text));
        }
    };
    let flags = wheel.encoder_flags;
    if flags & !(GROUSER_ENCODER_ON_MOTOR | GROUSER_ENCODER_REVERSED) != 0 {
        let text = format!("wheel {index}: encoder_flags is {flags}, but must be 0 to 3");
        return Err((GROUSER_ERROR_VALUE, text));
    }
    let bits = if wheel.counter_bits == 0 {
        CounterWidth::MAX.bits()
    } else {
        wheel.counter_bits
    };
    let counter = CounterWidth::new(bits)
        .map_err(|error| (GROUSER_ERROR_DESCRIPTION, format!("wheel {index}: {error}")))?;
    let mut encoder = Encoder::default();
    if flags & GROUSER_ENCODER_ON_MOTOR != 0 {
        encoder.shaft = Shaft::Motor;
    }
    encoder.gear = known(wheel.gear).unwrap_or(1.0);
    encoder.ticks_per_turn = known(wheel.ticks_per_turn);
    encoder.counter = counter;
    encoder.reversed = flags & GROUSER_ENCODER_REVERSED != 0;
    encoder.rate_step = wheel.rate_step_rad_per_s;
    let mut described = blank
        .at(wheel.x_m, wheel.y_m)
        .heading(Angle::from_rad(wheel.heading_rad))
        .radius(wheel.radius_m)
        .encoder(encoder);
    described.load = known(wheel.load_n);
    Ok(described)
}

/// Applies the caller's settings and makes the object.
///
/// # Safety
/// `settings` as in [`grouser_new`]; `out` is writable.
unsafe fn finish(
    robot: &Robot,
    mut on_board: OnBoardSettings,
    settings: *const GrouserSettings,
    out: *mut *mut GrouserOnBoard,
    message: &mut Message,
) -> Result<(), Code> {
    if !settings.is_null() {
        // SAFETY: by this function's own condition
        let given = unsafe { read(settings) }
            .map_err(|code| refuse(message, code, "settings: wrong size"))?;
        on_board.start_policy = match given.start_policy {
            GROUSER_START_REPORT => StartPolicy::Report,
            GROUSER_START_OFF => StartPolicy::Off,
            GROUSER_START_REFUSE => StartPolicy::Refuse,
            other => {
                let text = format!("settings: start_policy is {other}, but must be 0 to 2");
                return Err(refuse(message, GROUSER_ERROR_VALUE, text));
            }
        };
        on_board.warm_up = given.warm_up_s;
        if given.gravity_m_per_s2 != 0.0 {
            on_board.gravity = given.gravity_m_per_s2;
        }
        on_board.heading = given.heading_rad;
        // SAFETY: by this function's own condition
        unsafe { set_filter(&mut on_board.filter, &given, message) }?;
    }
    let made = OnBoard::new(robot, on_board)
        .map_err(|error| refuse(message, GROUSER_ERROR_DESCRIPTION, error))?;
    let commands = vec![WheelCommand::default(); robot.wheels().len()];
    let object = Box::new(GrouserOnBoard {
        on_board: made,
        commands: commands.into_boxed_slice(),
        is_broken: false,
    });
    // SAFETY: writable by this function's own condition
    unsafe { out.write(Box::into_raw(object)) };
    Ok(())
}

/// Sets the filter's settings by their names.
///
/// # Safety
/// `given.filter` points to `given.filter_count` settings, each with a key that ends with a NUL.
unsafe fn set_filter(
    filter: &mut FilterSettings,
    given: &GrouserSettings,
    message: &mut Message,
) -> Result<(), Code> {
    if given.filter_count > MAX_FILTER_SETTINGS {
        let count = given.filter_count;
        let text = format!("filter_count is {count}, but must be 0 to {MAX_FILTER_SETTINGS}");
        return Err(refuse(message, GROUSER_ERROR_SIZE, text));
    }
    if given.filter_count > 0 {
        check_pointer(given.filter).map_err(|code| refuse(message, code, "filter is NULL"))?;
    }
    for index in 0..given.filter_count {
        // SAFETY: `filter` points to `filter_count` settings
        let GrouserFilterSetting { key, value } = unsafe { given.filter.add(index).read() };
        if key.is_null() {
            return Err(refuse(
                message,
                GROUSER_ERROR_POINTER,
                "a filter key is NULL",
            ));
        }
        // SAFETY: it ends with a NUL
        let key = unsafe { CStr::from_ptr(key) };
        let Some((field, in_file_unit)) = FilterSettings::FIELDS.iter().find_map(|field| {
            let is_key = field.key.is_some_and(|k| k.as_bytes() == key.to_bytes());
            (is_key || field.name.as_bytes() == key.to_bytes()).then_some((field, is_key))
        }) else {
            let text = format!("filter has no setting {key:?}");
            return Err(refuse(message, GROUSER_ERROR_DESCRIPTION, text));
        };
        if in_file_unit {
            field.set_from_file(filter, value);
        } else {
            field.set(filter, value);
        }
        field
            .check("filter", filter)
            .map_err(|error| refuse(message, GROUSER_ERROR_DESCRIPTION, error))?;
    }
    Ok(())
}

#[cfg(all(test, feature = "std"))]
pub(crate) mod tests {
    use super::*;

    /// The software of a robot with two wheels.
    pub(crate) fn two_wheels() -> *mut GrouserOnBoard {
        let wheel = GrouserWheel {
            size: u32::try_from(size_of::<GrouserWheel>()).unwrap_or(0),
            radius_m: 0.1,
            ticks_per_turn: 1000.0,
            ..GrouserWheel::default()
        };
        let free = GrouserWheel {
            role: GROUSER_FREE,
            ..wheel
        };
        let (wheels, mut out) = ([wheel, free], core::ptr::null_mut());
        let (settings, message) = (core::ptr::null(), core::ptr::null_mut());
        // SAFETY: all pointers are NULL or alive
        let code = unsafe { grouser_new(wheels.as_ptr(), 2, settings, &raw mut out, message, 0) };
        assert_eq!(code, 0);
        out
    }
}
