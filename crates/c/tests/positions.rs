//! Places without a heading are a reference for a robot that has no free wheel.
#![allow(unsafe_code, reason = "C calls these functions by pointers")]

use std::f64::consts::TAU;
use std::ptr::null_mut;

use grouser_c::*;

use crate::bad_input::{push, settings, size, wheel};

const RIM_M_PER_S: f64 = 0.25;
const GROUND_M_PER_S: f64 = 0.2;
/// Direction of the drive in the frame of the places, rad: places have no heading, so that the filter has to find it. Neither axis, nor
/// a diagonal, which an exchange of axes would not show.
const COURSE_RAD: f64 = 0.5;

/// The left wheel after 40 s straight ahead, with or without places at 5 Hz.
fn driven(has_places: bool) -> GrouserWheelEstimate {
    let wheels = [0.2, -0.2].map(|y_m| GrouserWheel { y_m, ..wheel() });
    let settings = GrouserSettings {
        warm_up_s: 0.0,
        ..settings()
    };
    let mut robot = null_mut();
    // SAFETY: all of it is alive
    let code = unsafe {
        grouser_new(
            wheels.as_ptr(),
            2,
            &raw const settings,
            &raw mut robot,
            null_mut(),
            0,
        )
    };
    assert_eq!(code, GROUSER_OK);
    let ticks_per_m = 1000.0 / (TAU * wheel().radius_m);
    for step in 0..4000_u32 {
        let time = 0.01 * f64::from(step);
        let sample = GrouserSample {
            time_ns: i64::from(step) * 10_000_000,
            ..GrouserSample::default()
        };
        for wheel in 0..2 {
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a positive count"
            )]
            let raw = (RIM_M_PER_S * time * ticks_per_m) as u64;
            let kind = GROUSER_WHEEL_COUNT;
            push(
                robot,
                GrouserSample {
                    kind,
                    wheel,
                    raw,
                    ..sample
                },
            );
        }
        let kind = GROUSER_YAW_RATE;
        push(robot, GrouserSample { kind, ..sample });
        if has_places && step % 20 == 0 {
            let kind = GROUSER_POSITION;
            let way = GROUND_M_PER_S * time;
            let mut values = [f64::NAN; 6];
            values[..2]
                .copy_from_slice(&[3.0 + way * COURSE_RAD.cos(), way * COURSE_RAD.sin() - 7.0]);
            assert_eq!(
                push(
                    robot,
                    GrouserSample {
                        kind,
                        values,
                        ..sample
                    }
                ),
                GROUSER_OK
            );
        }
    }
    let mut estimate = GrouserWheelEstimate {
        size: size::<GrouserWheelEstimate>(),
        ..GrouserWheelEstimate::default()
    };
    // SAFETY: both are alive, and the robot is not used any more
    unsafe {
        assert_eq!(grouser_wheel(robot, 0, &raw mut estimate), GROUSER_OK);
        grouser_free(robot);
    }
    estimate
}

#[test]
fn places_without_a_heading_show_the_slip() {
    let slip = 1.0 - GROUND_M_PER_S / RIM_M_PER_S;
    let estimate = driven(true);
    assert!(estimate.known & GROUSER_KNOWS_SLIP != 0, "{estimate:?}");
    assert!((estimate.slip - slip).abs() < 0.02, "{estimate:?}");
    let blind = driven(false);
    assert!(blind.health != GROUSER_HEALTH_OK, "{blind:?}");
}
