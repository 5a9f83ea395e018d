//! What holds of everything that the filter says: finite, within its limits, and with a sigma where it is `Ok`.

use grouser_slip::Health;
use grouser_slip::filter::SlipFilter;
use proptest::prelude::*;

pub(crate) fn is_sane(filter: &SlipFilter) -> Result<(), TestCaseError> {
    let known = filter.latest();
    for wheel in known.wheels {
        if let Some(slip) = wheel.slip {
            prop_assert!(slip.value().abs() <= 1.0);
            prop_assert!(
                wheel
                    .sigma
                    .is_some_and(|sigma| sigma.is_finite() && sigma > 0.0)
            );
        }
        if wheel.health == Health::Ok {
            prop_assert!(wheel.slip.is_none() || wheel.sigma.is_some());
        }
    }
    for angle in (0..known.wheels.len()).filter_map(|i| known.side_slip_angle(i)) {
        prop_assert!(angle.value.is_finite() && angle.variance >= 0.0);
    }
    let body = known.body;
    for speed in [body.forward, body.left, body.yaw_rate, body.common_slip] {
        prop_assert!(
            speed.value.is_finite() && speed.variance.is_finite() && speed.variance >= 0.0
        );
    }
    let place = body.odometry;
    prop_assert!(place.x.is_finite() && place.y.is_finite() && place.yaw.is_finite());
    prop_assert!(place.covariance.iter().flatten().all(|v| v.is_finite()));
    prop_assert!(body.distance.is_finite() && body.distance_of_wheels.is_finite());
    prop_assert!(known.time_slip >= 0.0);
    Ok(())
}
