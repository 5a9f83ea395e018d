//! The estimator under any stream of samples: total, finite, and honest about what it refuses.
#![no_main]

mod bytes;
mod stream;

use bytes::Bytes;
use grouser_slip::Reference;
use grouser_slip::window::{WindowEstimator, WindowSettings};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Bytes(bytes);
    let wheels = 3 + bytes.u8() % 4;
    let bits = [8, 16, 32, 64][usize::from(bytes.u8() % 4)];
    let reference = Reference::ALL[usize::from(bytes.u8()) % Reference::ALL.len()];
    let settings = WindowSettings {
        reference,
        ..WindowSettings::default()
    };
    let Ok(mut estimator) = WindowEstimator::new(&stream::robot(bits, wheels), settings) else {
        return;
    };
    let mut time_ns = 0_i64;
    while !bytes.is_empty() {
        time_ns = stream::time(&mut bytes, time_ns);
        let sample = stream::sample(&mut bytes, time_ns, wheels);
        let before = estimator.rejected().total();
        let refused = estimator.update(sample).is_err();
        assert_eq!(estimator.rejected().total() - before, u64::from(refused));
        let Some(estimate) = estimator.latest() else {
            continue;
        };
        stream::check(estimate.wheels);
        let body = estimate.body;
        assert!(body.travel_wheels.is_finite() && body.travel_reference.is_finite());
        if let Some(motion) = body.motion {
            assert!(motion.velocity.iter().all(|v| v.is_finite()));
            assert!(motion.covariance.iter().flatten().all(|v| v.is_finite()));
        }
    }
});
