//! Robots, and a stream of samples of its sensors with every fault that bytes can make.
use grouser_slip::{
    CounterWidth, Encoder, Health, Measurement, MeasurementKind, MeasurementPart, MeasurementParts,
    Robot, Sample, Wheel, WheelEstimate,
};
use grouser_terra::Angle;

use crate::bytes::Bytes;

/// Wheels on both sides, the last one free.
pub fn plain_robot(bits: u32, wheels: u8) -> Robot {
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
        let wheel = wheel.at(0.3 - 0.2 * f64::from(k), y).radius(0.1);
        wheel.width(0.05).load(20.0).encoder(encoder)
    };
    Robot::new("robot".into(), (0..wheels).map(wheel).collect()).expect("a robot")
}

/// One to eight wheels anywhere, in any direction, of any size, steered or not; `None` where the library refuses it.
pub fn robot(bytes: &mut Bytes<'_>) -> Option<Robot> {
    let wheels = 1 + bytes.u8() % 8;
    if bytes.u8() % 2 == 0 {
        return Some(plain_robot(8 << (bytes.u8() % 4), wheels.max(2)));
    }
    let wheels = (0..wheels).map(|k| {
        let kind = bytes.u8();
        let name = format!("w{k}");
        let wheel = if kind % 4 == 0 {
            Wheel::free(name)
        } else {
            Wheel::powered(name)
        };
        let mut wheel = wheel
            .at(bytes.within(-2.0, 2.0), bytes.within(-1.0, 1.0))
            .radius(10_f64.powf(bytes.within(-2.0, 0.0)))
            .ticks_per_turn(10_f64.powf(bytes.within(0.0, 6.0)));
        if kind & 16 != 0 {
            wheel = wheel.heading(Angle::from_deg(bytes.within(-180.0, 180.0)));
        }
        if kind & 32 != 0 {
            wheel = wheel.steered_about(bytes.within(-2.0, 2.0), bytes.within(-1.0, 1.0));
        }
        wheel
    });
    Robot::new("robot".into(), wheels.collect()).ok()
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
    let kind = MeasurementKind::ALL[usize::from(bytes.u8()) % MeasurementKind::ALL.len()];
    let mut parts = MeasurementParts {
        index: wheel,
        count: bytes.u64() >> (bytes.u8() % 64),
        ..MeasurementParts::default()
    };
    let mut numbers = parts.numbers.iter_mut();
    for field in kind.fields() {
        let (count, may_lack) = match field.part {
            MeasurementPart::Index | MeasurementPart::Count => (0, false),
            MeasurementPart::Number | MeasurementPart::YesOrNo => (1, false),
            MeasurementPart::OptionalNumber => (1, true),
            MeasurementPart::Vector => (3, false),
        };
        for number in numbers.by_ref().take(count) {
            let is_there = !may_lack || bytes.u8() % 2 == 0;
            *number = is_there.then(|| bytes.any());
        }
    }
    let measurement = Measurement::from_parts(kind, parts).expect("no number is missing");
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
