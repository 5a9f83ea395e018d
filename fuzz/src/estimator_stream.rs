//! The estimator under any stream of samples: total, finite, and honest about what it refuses.

use crate::bytes::Bytes;
use crate::{settings, stream};
use grouser_slip::Reference;
use grouser_slip::window::{WindowEstimator, WindowSettings};

pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes(bytes);
    let Some(robot) = stream::robot(&mut bytes) else {
        return;
    };
    let mut settings: WindowSettings = settings::drawn(&mut bytes, WindowSettings::FIELDS);
    settings.reference = Reference::ALL[usize::from(bytes.u8()) % Reference::ALL.len()];
    settings.history = [8, 100, 1000][usize::from(bytes.u8()) % 3];
    let Ok(mut estimator) = WindowEstimator::new(&robot, settings) else {
        return;
    };
    let wheels = robot.wheels().len() as u8;
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
}
