//! A robot, and a stream of samples of its sensors with every fault that bytes can make.
#![allow(dead_code, reason = "each target uses its own part of this")]

use grouser_slip::{
    CounterWidth, Encoder, Health, Measurement, Robot, Sample, Wheel, WheelEstimate,
};

use crate::bytes::Bytes;

/// Three to six wheels, the last one free.
pub fn robot(bits: u32, wheels: u8) -> Robot {
    let width = CounterWidth::new(bits).expect("a width");
    let encoder = Encoder::counting(1000).counter(width);
    let wheel = |k: u8| {
        let name = format!("w{k}");
        let wheel = if k == wheels - 1 {
            Wheel::free(name)
        } else {
            Wheel::powered(name)
        };
        let y = if k % 2 == 0 { 0.2 } else { -0.2 };
        wheel
            .at(0.3 - 0.2 * f64::from(k), y)
            .radius(0.1)
            .encoder(encoder)
    };
    Robot::new("robot".into(), (0..wheels).map(wheel).collect()).expect("a robot")
}

/// A time after, at, before or far from the last one.
pub fn time(bytes: &mut Bytes<'_>, last_ns: i64) -> i64 {
    match bytes.u8() {
        0 => bytes.u64() as i64,
        1 => last_ns,
        2 => last_ns.wrapping_sub(bytes.u64() as i64 >> 20),
        3 => last_ns.saturating_add(i64::MAX / 2),
        step => last_ns.saturating_add(i64::from(step) * 100_000),
    }
}

/// A sample of any sensor, of a wheel that may not be there.
pub fn sample(bytes: &mut Bytes<'_>, time_ns: i64, wheels: u8) -> Sample {
    let wheel = usize::from(bytes.u8() % (wheels + 1));
    let turn = |bytes: &mut Bytes<'_>| (bytes.u8() % 2 == 0).then(|| bytes.any());
    let measurement = match bytes.u8() % 10 {
        0 | 1 => Measurement::WheelCount {
            wheel,
            raw: bytes.u64() >> (bytes.u8() % 64),
        },
        2 => Measurement::WheelEdge {
            wheel,
            forward: bytes.u8() % 2 == 0,
        },
        3 => Measurement::WheelAngle {
            wheel,
            angle: bytes.any(),
        },
        4 => Measurement::WheelRate {
            wheel,
            rate: bytes.any(),
        },
        5 => Measurement::YawRate { rate: bytes.any() },
        6 => Measurement::Displacement {
            forward: bytes.any(),
            left: bytes.any(),
            turn: turn(bytes),
        },
        7 => Measurement::Pose {
            x: bytes.any(),
            y: bytes.any(),
            yaw: bytes.any(),
        },
        8 => Measurement::Speed {
            forward: bytes.any(),
            left: turn(bytes),
        },
        _ => Measurement::Command {
            forward: bytes.any(),
            left: bytes.any(),
        },
    };
    Sample {
        time_ns,
        measurement,
    }
}

/// What holds of an estimate whatever came in.
pub fn check(wheels: &[WheelEstimate]) {
    for wheel in wheels {
        if let Some(slip) = wheel.slip {
            assert!((-1.0..=1.0).contains(&slip.value()), "{wheel:?}");
            assert!(
                wheel
                    .sigma
                    .is_some_and(|sigma| sigma.is_finite() && sigma >= 0.0),
                "{wheel:?}"
            );
            assert!(
                !matches!(wheel.health, Health::Uninitialised | Health::Invalid(_)),
                "{wheel:?}"
            );
        }
        for speed in [wheel.forward_speed, wheel.rim_speed].into_iter().flatten() {
            assert!(
                speed.value.is_finite() && speed.variance.is_finite(),
                "{wheel:?}"
            );
            assert!(speed.variance >= 0.0, "{wheel:?}");
        }
    }
}
