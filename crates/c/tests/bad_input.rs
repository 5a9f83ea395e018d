//! What C can do wrong is a code, never a crash, and changes nothing.
#![allow(unsafe_code, reason = "C calls these functions by pointers")]

use std::ffi::{CStr, c_char};
use std::ptr::{null, null_mut};

use grouser_c::*;
use grouser_slip::MAX_WHEELS;

/// The size that a struct begins with.
pub(crate) fn size<T>() -> u32 {
    u32::try_from(size_of::<T>()).unwrap()
}

pub(crate) fn wheel() -> GrouserWheel {
    GrouserWheel {
        size: size::<GrouserWheel>(),
        radius_m: 0.1,
        ticks_per_turn: 1000.0,
        ..GrouserWheel::default()
    }
}

pub(crate) fn settings() -> GrouserSettings {
    let mut settings = GrouserSettings {
        size: size::<GrouserSettings>(),
        start_policy: 99,
        warm_up_s: f64::NAN,
        gravity_m_per_s2: 0.0,
        heading_rad: f64::NAN,
        filter: null(),
        filter_count: 9,
    };
    // SAFETY: it is alive and its size is set
    assert_eq!(
        unsafe { grouser_default_settings(&raw mut settings) },
        GROUSER_OK
    );
    settings
}

/// Code and message of making a robot.
fn make(wheels: &[GrouserWheel], settings: *const GrouserSettings) -> (i32, String) {
    let (mut out, mut text) = (null_mut(), [0x55 as c_char; 120]);
    let message = text.as_mut_ptr();
    // SAFETY: all of it is alive
    let code = unsafe {
        grouser_new(
            wheels.as_ptr(),
            wheels.len(),
            settings,
            &raw mut out,
            message,
            text.len(),
        )
    };
    assert_eq!(out.is_null(), code != GROUSER_OK);
    // SAFETY: it is NULL or was made above; the message ends with a NUL
    let text = unsafe {
        grouser_free(out);
        CStr::from_ptr(text.as_ptr())
    };
    (code, text.to_str().unwrap().into())
}

/// A robot of two powered wheels and a free one.
fn robot() -> *mut GrouserOnBoard {
    let free = GrouserWheel {
        role: GROUSER_FREE,
        x_m: -0.3,
        ..wheel()
    };
    let wheels = [
        GrouserWheel {
            y_m: 0.2,
            ..wheel()
        },
        GrouserWheel {
            y_m: -0.2,
            ..wheel()
        },
        free,
    ];
    let (mut out, settings) = (
        null_mut(),
        GrouserSettings {
            warm_up_s: 0.0,
            ..settings()
        },
    );
    // SAFETY: all of it is alive
    let code = unsafe {
        grouser_new(
            wheels.as_ptr(),
            3,
            &raw const settings,
            &raw mut out,
            null_mut(),
            0,
        )
    };
    assert_eq!(code, GROUSER_OK);
    out
}

pub(crate) fn push(robot: *mut GrouserOnBoard, sample: GrouserSample) -> i32 {
    let size = size::<GrouserSample>();
    let sample = GrouserSample { size, ..sample };
    // SAFETY: both are alive
    unsafe { grouser_push(robot, sample.time_ns, &raw const sample) }
}

fn body(robot: *mut GrouserOnBoard) -> GrouserBodyEstimate {
    let size = size::<GrouserBodyEstimate>();
    let mut body = GrouserBodyEstimate {
        size,
        ..GrouserBodyEstimate::default()
    };
    // SAFETY: both are alive
    assert_eq!(unsafe { grouser_body(robot, &raw mut body) }, GROUSER_OK);
    assert_eq!(body.size, size);
    body
}

#[test]
fn a_bad_description_is_named_with_field_value_limits_and_unit() {
    assert_eq!(make(&[wheel()], null()), (GROUSER_OK, String::new()));
    let (code, text) = make(
        &[
            wheel(),
            GrouserWheel {
                radius_m: f64::NAN,
                ..wheel()
            },
        ],
        null(),
    );
    assert_eq!(code, GROUSER_ERROR_DESCRIPTION);
    assert!(
        text.starts_with("wheel 1: radius is NaN m, but must lie in [0.001, 10] m"),
        "{text}"
    );
    let cases = [
        (
            GrouserWheel { role: 2, ..wheel() },
            GROUSER_ERROR_VALUE,
            "role is 2",
        ),
        (
            GrouserWheel {
                encoder_flags: 4,
                ..wheel()
            },
            GROUSER_ERROR_VALUE,
            "encoder_flags is 4",
        ),
        (
            GrouserWheel {
                counter_bits: 7,
                ..wheel()
            },
            GROUSER_ERROR_DESCRIPTION,
            "7 bits",
        ),
        (
            GrouserWheel {
                max_torque_n_m: f64::INFINITY,
                ..wheel()
            },
            GROUSER_ERROR_DESCRIPTION,
            "max_torque is inf",
        ),
        (
            GrouserWheel { size: 1, ..wheel() },
            GROUSER_ERROR_SIZE,
            "wheel 0: wrong size",
        ),
    ];
    for (wheel, code, part) in cases {
        let (found, text) = make(&[wheel], null());
        assert_eq!(found, code, "{text}");
        assert!(text.contains(part), "{text}");
    }
    assert_eq!(make(&[], null()).0, GROUSER_ERROR_SIZE);
    assert_eq!(
        make(&[wheel(); MAX_WHEELS + 1], null()).0,
        GROUSER_ERROR_SIZE
    );
}

#[test]
fn settings_are_checked_and_named() {
    let setting = |key: &'static CStr, value| {
        let filter = GrouserFilterSetting {
            key: key.as_ptr(),
            value,
        };
        let given = GrouserSettings {
            filter: &raw const filter,
            filter_count: 1,
            ..settings()
        };
        make(&[wheel()], &raw const given)
    };
    assert_eq!(setting(c"slip_sigma", 0.3).0, GROUSER_OK);
    assert_eq!(setting(c"horizon", 0.0).0, GROUSER_OK);
    for (key, value, part) in [
        (c"no_such", 1.0, "\"no_such\""),
        (c"slip_sigma", f64::NAN, "slip sigma is NaN"),
        (c"horizon", 2.0, "horizon is 2 s, but must lie in [0, 1] s"),
    ] {
        let (code, text) = setting(key, value);
        assert_eq!(code, GROUSER_ERROR_DESCRIPTION);
        assert!(text.contains(part), "{text}");
    }
    for wrong in [
        GrouserSettings {
            gravity_m_per_s2: f64::NAN,
            ..settings()
        },
        GrouserSettings {
            start_policy: 3,
            ..settings()
        },
        GrouserSettings {
            filter_count: 1,
            ..settings()
        },
        GrouserSettings {
            filter_count: usize::MAX,
            ..settings()
        },
        GrouserSettings {
            size: 0,
            ..settings()
        },
    ] {
        assert_ne!(
            make(&[wheel()], &raw const wrong).0,
            GROUSER_OK,
            "{wrong:?}"
        );
    }
}

#[test]
fn a_robot_files_text_is_refused_with_its_place_and_a_message_is_cut_with_its_nul() {
    let text = "format = 1\nname = \"é\"\n[[wheel]]\nraduis_m = 1\n";
    let mut whole = String::new();
    for room in [200, 12, 1, 0] {
        let (mut out, mut message) = (null_mut(), [0x55 as c_char; 200]);
        // SAFETY: all of it is alive
        let code = unsafe {
            let (text, length) = (text.as_ptr().cast(), text.len());
            grouser_new_from_toml(
                text,
                length,
                null(),
                &raw mut out,
                message.as_mut_ptr(),
                room,
            )
        };
        assert_eq!((code, out.is_null()), (GROUSER_ERROR_DESCRIPTION, true));
        assert!(
            message[room..].iter().all(|&byte| byte == 0x55),
            "written behind {room} bytes"
        );
        if room > 0 {
            // SAFETY: it ends with a NUL
            let found = unsafe { CStr::from_ptr(message.as_ptr()) }
                .to_str()
                .unwrap();
            if room == 200 {
                found.clone_into(&mut whole);
                assert!(whole.starts_with("robot:"), "{whole}");
            }
            assert_eq!(found, &whole[..whole.len().min(room - 1)]);
        }
    }
}

#[test]
fn null_and_wrong_sizes_are_refused_and_nothing_is_written() {
    let robot = robot();
    // SAFETY: pointers are NULL or alive
    unsafe {
        assert_eq!(grouser_push(null_mut(), 0, null()), GROUSER_ERROR_POINTER);
        assert_eq!(grouser_push(robot, 0, null()), GROUSER_ERROR_POINTER);
        assert_eq!(
            grouser_push(robot, 0, &GrouserSample::default()),
            GROUSER_ERROR_SIZE
        );
        assert_eq!(grouser_tick(null_mut(), 0, 0.0, 0.0), GROUSER_ERROR_POINTER);
        assert_eq!(grouser_wheel(robot, 0, null_mut()), GROUSER_ERROR_POINTER);
        assert_eq!(
            grouser_wheel_count(robot, null_mut()),
            GROUSER_ERROR_POINTER
        );
        let mut short = GrouserWheelEstimate {
            size: 8,
            slip: 7.0,
            ..GrouserWheelEstimate::default()
        };
        assert_eq!(grouser_wheel(robot, 0, &raw mut short), GROUSER_ERROR_SIZE);
        assert_eq!((short.size, short.slip), (8, 7.0));
        let mut command = GrouserCommand {
            size: size::<GrouserCommand>(),
            ..GrouserCommand::default()
        };
        assert_eq!(
            grouser_command(robot, 3, &raw mut command),
            GROUSER_ERROR_WHEEL
        );
        assert_eq!(
            grouser_set_steering_angle(robot, 3, 0.0),
            GROUSER_ERROR_WHEEL
        );
        assert_eq!(
            grouser_set_steering_angle(robot, 0, f64::NAN),
            GROUSER_ERROR_VALUE
        );
        grouser_free(null_mut());
        grouser_free(robot);
    }
}

/// The start's check of the accelerometer, at rest under the gravity of Mars.
#[test]
fn gravity_is_the_settings_then_the_files_then_the_earths() {
    let wheel = "[[wheel]]\nname = \"left\"\nx_m = 0\ny_m = 0\ndrive = \"powered\"\nradius_m = 0.1\n\
                 ticks_per_turn = 1000\n";
    let faults = |gravity: &str, setting: f64| {
        let text = format!("format = 1\nname = \"rover\"\n{gravity}\n{wheel}");
        let settings = GrouserSettings {
            gravity_m_per_s2: setting,
            ..settings()
        };
        let mut robot = null_mut();
        // SAFETY: all of it is alive
        let code = unsafe {
            grouser_new_from_toml(
                text.as_ptr().cast(),
                text.len(),
                &raw const settings,
                &raw mut robot,
                null_mut(),
                0,
            )
        };
        assert_eq!(code, GROUSER_OK, "{text}");
        for step in 0..500 {
            let sample = GrouserSample {
                kind: GROUSER_INERTIAL,
                time_ns: step * 10_000_000,
                values: [0.0, 0.0, 3.72, 0.0, 0.0, 0.0],
                ..GrouserSample::default()
            };
            assert_eq!(push(robot, sample), GROUSER_OK);
        }
        let fault = body(robot).start_fault;
        // SAFETY: it was made above
        unsafe { grouser_free(robot) };
        fault
    };
    assert_eq!(faults("gravity_m_per_s2 = \"mars\"", 0.0), 0);
    assert_eq!(faults("", 3.72), 0);
    assert_eq!(faults("", 0.0), 1);
    assert_eq!(faults("gravity_m_per_s2 = \"mars\"", 9.81), 1);
}

#[test]
fn numbers_that_are_none_are_refused_in_every_kind_and_what_comes_out_is_finite() {
    let robot = robot();
    for step in 0..200_i64 {
        let time_ns = step * 10_000_000;
        let sample = GrouserSample {
            time_ns,
            ..GrouserSample::default()
        };
        for wheel in 0..3 {
            let raw = u64::try_from(step * if wheel < 2 { 10 } else { 8 }).unwrap();
            let count = GrouserSample {
                kind: GROUSER_WHEEL_COUNT,
                wheel,
                raw,
                ..sample
            };
            // the code may be that of a sample that waited before it
            assert!([GROUSER_OK, GROUSER_SAMPLE_REFUSED].contains(&push(robot, count)));
        }
        for kind in GROUSER_WHEEL_ANGLE..=GROUSER_ENTRY_ANGLE + 1 {
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let flags = GROUSER_HAS_TURN | GROUSER_HAS_LEFT;
                let bad = GrouserSample {
                    kind,
                    flags,
                    raw: 2,
                    values: [value; 6],
                    ..sample
                };
                let code = push(robot, bad);
                // within the horizon the filter judges a sample when its time comes
                let waits = code == GROUSER_OK && kind <= GROUSER_ENTRY_ANGLE;
                assert!(code == GROUSER_SAMPLE_REFUSED || code == GROUSER_ERROR_VALUE || waits);
            }
        }
        // SAFETY: it is alive
        let code = unsafe { grouser_tick(robot, time_ns, f64::NAN, 0.0) };
        assert_eq!(code, GROUSER_ERROR_VALUE);
        // SAFETY: it is alive
        assert_eq!(
            unsafe { grouser_tick(robot, time_ns, 0.1, 0.0) },
            GROUSER_OK
        );
    }
    for kind in [GROUSER_MOTOR_CURRENT, GROUSER_SINKAGE, GROUSER_ENTRY_ANGLE] {
        let unknown = GrouserSample {
            kind,
            wheel: 3,
            ..GrouserSample::default()
        };
        assert_eq!(push(robot, unknown), GROUSER_ERROR_WHEEL);
    }
    let body = body(robot);
    assert!(body.rejected_bad_value > 200, "{body:?}");
    assert!(
        body.forward_m_per_s.is_finite() && body.place_covariance.iter().all(|c| c.is_finite())
    );
    for index in 0..3 {
        let size = size::<GrouserWheelEstimate>();
        let mut wheel = GrouserWheelEstimate {
            size,
            ..GrouserWheelEstimate::default()
        };
        // SAFETY: both are alive
        assert_eq!(
            unsafe { grouser_wheel(robot, index, &raw mut wheel) },
            GROUSER_OK
        );
        assert!(
            wheel.slip.abs() <= 1.0 && wheel.slip_sigma.is_finite(),
            "{wheel:?}"
        );
        if index < 2 {
            assert!((wheel.slip - 0.2).abs() < 0.05, "{wheel:?}");
        }
    }
    // a robot that drives stops by a request that is refused
    let mut time_ns = 2_000_000_000;
    let speeds = [0.1, f64::NAN].map(|requested| {
        let mut command = GrouserCommand {
            size: size::<GrouserCommand>(),
            ..GrouserCommand::default()
        };
        for _ in 0..22 {
            time_ns += 10_000_000;
            // SAFETY: both are alive
            unsafe {
                grouser_tick(robot, time_ns, requested, 0.0);
                assert_eq!(grouser_command(robot, 0, &raw mut command), GROUSER_OK);
            }
        }
        command.rim_speed_m_per_s
    });
    assert!(speeds[0] > 0.05 && speeds[1] == 0.0, "{speeds:?}");
    // SAFETY: it is not used any more
    unsafe { grouser_free(robot) };
}
