//! The estimator under any stream of samples: total, finite, and honest about what it refuses.
#![no_main]

mod bytes;

use bytes::Bytes;
use grouser_slip::{
    CounterWidth, Drive, Encoder, Estimator, Health, Measurement, Reference, Robot, Sample,
    Settings, Shaft, Wheel,
};
use grouser_terra::Angle;
use libfuzzer_sys::fuzz_target;

fn robot(bits: u32, wheels: u8) -> Robot {
    let encoder = Encoder {
        shaft: Shaft::Wheel,
        gear: 1.0,
        ticks_per_turn: Some(1000.0),
        counter: CounterWidth::new(bits).expect("a width"),
        reversed: false,
        rate_step: 0.0,
    };
    let wheel = |k: u8| Wheel {
        name: format!("w{k}"),
        x: 0.3 - 0.2 * f64::from(k),
        y: if k % 2 == 0 { 0.2 } else { -0.2 },
        heading: Angle::from_deg(0.0),
        radius: 0.1,
        drive: if k == wheels - 1 { Drive::Free } else { Drive::Powered },
        encoder,
        width: None,
        load: None,
    };
    Robot::new("robot".into(), (0..wheels).map(wheel).collect()).expect("a robot")
}

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Bytes(bytes);
    let wheels = 3 + bytes.u8() % 4;
    let bits = [8, 16, 32, 64][usize::from(bytes.u8() % 4)];
    let reference = Reference::ALL[usize::from(bytes.u8()) % Reference::ALL.len()];
    let settings = Settings { reference, ..Settings::default() };
    let Ok(mut estimator) = Estimator::new(&robot(bits, wheels), settings) else {
        return;
    };
    let mut time_ns = 0_i64;
    while !bytes.is_empty() {
        time_ns = match bytes.u8() {
            0 => bytes.u64() as i64,
            1 => time_ns,
            2 => time_ns.wrapping_sub(bytes.u64() as i64 >> 20),
            3 => time_ns.saturating_add(i64::MAX / 2),
            step => time_ns.saturating_add(i64::from(step) * 100_000),
        };
        let wheel = usize::from(bytes.u8() % (wheels + 1));
        let turn = |bytes: &mut Bytes<'_>| (bytes.u8() % 2 == 0).then(|| bytes.any());
        let measurement = match bytes.u8() % 10 {
            0 | 1 => Measurement::WheelCount { wheel, raw: bytes.u64() >> (bytes.u8() % 64) },
            2 => Measurement::WheelEdge { wheel, forward: bytes.u8() % 2 == 0 },
            3 => Measurement::WheelAngle { wheel, angle: bytes.any() },
            4 => Measurement::WheelRate { wheel, rate: bytes.any() },
            5 => Measurement::YawRate { rate: bytes.any() },
            6 => Measurement::Displacement {
                forward: bytes.any(),
                left: bytes.any(),
                turn: turn(&mut bytes),
            },
            7 => Measurement::Pose { x: bytes.any(), y: bytes.any(), yaw: bytes.any() },
            8 => Measurement::Speed { forward: bytes.any(), left: turn(&mut bytes) },
            _ => Measurement::Command { forward: bytes.any(), left: bytes.any() },
        };
        let before = estimator.rejected().total();
        let refused = estimator.update(Sample { time_ns, measurement }).is_err();
        assert_eq!(estimator.rejected().total() - before, u64::from(refused));
        let Some(estimate) = estimator.latest() else {
            continue;
        };
        for wheel in estimate.wheels {
            if let Some(slip) = wheel.slip {
                assert!((-1.0..=1.0).contains(&slip.value()));
                assert!(wheel.sigma.is_some_and(|sigma| sigma.is_finite() && sigma >= 0.0));
                assert!(!matches!(wheel.health, Health::Uninitialised | Health::Invalid(_)));
            }
            for speed in [wheel.forward_speed, wheel.rim_speed].into_iter().flatten() {
                assert!(speed.value.is_finite() && speed.variance.is_finite());
                assert!(speed.variance >= 0.0);
            }
        }
        let body = estimate.body;
        assert!(body.travel_wheels.is_finite() && body.travel_reference.is_finite());
        if let Some(motion) = body.motion {
            assert!(motion.velocity.iter().all(|v| v.is_finite()));
            assert!(motion.covariance.iter().flatten().all(|v| v.is_finite()));
        }
    }
});
