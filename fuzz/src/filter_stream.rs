//! The filter over all sensors under any stream of samples: total, finite, and honest about what it refuses.

use crate::bytes::Bytes;
use crate::{settings, stream};
use grouser_slip::filter::{FilterSettings, SlipFilter};

pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes(bytes);
    let Some(robot) = stream::robot(&mut bytes) else {
        return;
    };
    let settings = settings::drawn(&mut bytes, FilterSettings::FIELDS);
    let Ok(mut filter) = SlipFilter::new(&robot, settings) else {
        return;
    };
    let wheels = robot.wheels().len() as u8;
    let mut time_ns = 0_i64;
    while !bytes.is_empty() {
        time_ns = stream::time(&mut bytes, time_ns);
        let sample = stream::sample(&mut bytes, time_ns, wheels);
        let before = filter.latest().rejected.total();
        let refused = filter.update(sample).is_err();
        let now = if bytes.u8() % 8 == 0 {
            filter.estimate_at(time_ns)
        } else {
            filter.latest()
        };
        assert!(now.rejected.total() >= before + u64::from(refused));
        stream::check(now.wheels);
        let body = now.body;
        for known in [body.forward, body.left, body.yaw_rate, body.common_slip] {
            assert!(known.value.is_finite(), "{body:?}");
            assert!(
                known.variance.is_finite() && known.variance >= 0.0,
                "{body:?}"
            );
        }
        assert!(
            body.distance.is_finite() && body.distance_of_wheels.is_finite(),
            "{body:?}"
        );
        assert!(now.reference_age.is_none_or(f64::is_finite));
    }
}
