use super::*;
use crate::filter::free_wheel_update::tests::{FREE, POWERED, core, near};

#[allow(
    clippy::unnecessary_wraps,
    reason = "all that is learnt may be missing"
)]
fn known(value: f64, variance: f64) -> Option<Measured> {
    Some(Measured { value, variance })
}

/// What is saved is restored, a skid by its two forms and a radius with the other sign.
#[test]
fn what_was_learnt_is_restored_to_the_state() {
    let mut learnt = Learnt {
        gyro_bias: known(-0.02, 1e-5),
        accelerometer_bias: [known(0.3, 2e-4), known(-0.4, 3e-4)],
        common_slip: known(0.17, 4e-4),
        ..Learnt::default()
    };
    let skid = SlipPrior {
        mean: -0.2,
        sigma: 0.032,
    };
    learnt.wheels[FREE].free_slip = Some(skid);
    learnt.wheels[POWERED].radius_excess = known(0.03, 5e-5);
    let mut core = core();
    core.restore(&learnt).unwrap();
    for (i, mean, variance) in [
        (GYRO_BIAS, -0.02, 1e-5),
        (FORWARD_BIAS, 0.3, 2e-4),
        (LEFT_BIAS, -0.4, 3e-4),
        (COMMON_SLIP, 0.17, 4e-4),
        // 1 − 1/0.8, and 0.032/0.8²
        (own_slip(FREE), -0.25, 0.05 * 0.05),
        (radius(POWERED), -0.03, 5e-5),
    ] {
        assert!(near(core.state.mean(i), mean), "{i}");
        assert!(
            (core.state.covariance(i, i) / variance - 1.0).abs() < 1e-12,
            "{i}"
        );
    }
    let again = core.learnt();
    assert_eq!(
        (again.gyro_bias, again.accelerometer_bias),
        (learnt.gyro_bias, learnt.accelerometer_bias)
    );
    assert_eq!(again.common_slip, learnt.common_slip);
    let is = again.wheels[FREE].free_slip.unwrap();
    assert!(near(is.mean, skid.mean) && near(is.sigma, skid.sigma));
    assert_eq!(
        (
            again.wheels[POWERED].free_slip,
            again.wheels[POWERED].radius_excess
        ),
        (None, None)
    );
    core.output.checks[POWERED].radius_excess = known(0.03, 5e-5);
    assert_eq!(
        core.learnt().wheels[POWERED].radius_excess,
        known(0.03, 5e-5)
    );
    // a powered wheel has no skid, and a variance of 0 is no certainty
    learnt.wheels[POWERED].free_slip = Some(skid);
    let certain = |known: Option<Measured>| {
        known.map(|known| Measured {
            variance: 0.0,
            ..known
        })
    };
    learnt.gyro_bias = certain(learnt.gyro_bias);
    learnt.wheels[POWERED].radius_excess = certain(known(0.03, 1.0));
    learnt.wheels[FREE].free_slip = Some(SlipPrior { sigma: 0.0, ..skid });
    let before = core.state.mean(own_slip(POWERED));
    core.restore(&learnt).unwrap();
    assert_eq!(core.state.mean(own_slip(POWERED)), before);
    for i in [GYRO_BIAS, radius(POWERED), own_slip(FREE)] {
        assert_eq!(
            core.state.covariance(i, i).to_bits(),
            MIN_VARIANCE.to_bits(),
            "{i}"
        );
    }
}

#[test]
fn numbers_beyond_their_limits_are_neither_saved_nor_restored() {
    type Change = fn(&mut Learnt, f64, f64);
    let changes: [(Change, f64); 5] = [
        (
            |learnt, value, variance| learnt.gyro_bias = known(value, variance),
            0.5,
        ),
        (
            |learnt, value, variance| learnt.accelerometer_bias[0] = known(value, variance),
            5.0,
        ),
        (
            |learnt, value, variance| learnt.accelerometer_bias[1] = known(value, variance),
            5.0,
        ),
        (
            |learnt, value, variance| learnt.common_slip = known(value, variance),
            1.0,
        ),
        (
            |learnt, value, variance| learnt.wheels[7].radius_excess = known(value, variance),
            0.2,
        ),
    ];
    let start = core();
    for (index, (change, limit)) in changes.into_iter().enumerate() {
        for (value, variance, is_legal) in [
            (limit, 1e6, true),
            (-limit, 0.0, true),
            (limit.next_up(), 0.1, false),
            (-limit.next_up(), 0.1, false),
            (0.1, 1e6 + 1.0, false),
            (0.1, -1e-9, false),
            (f64::NAN, 0.1, false),
        ] {
            let mut learnt = Learnt::default();
            change(&mut learnt, value, variance);
            let mut core = start.clone();
            assert_eq!(
                core.restore(&learnt).is_ok(),
                is_legal,
                "{index} {value} {variance}"
            );
        }
    }
    for (mean, sigma, is_legal) in [
        (0.95, 10.0, true),
        (-0.95, 0.0, true),
        (0.96, 0.1, false),
        (-0.96, 0.1, false),
        (0.1, 10.1, false),
        (0.1, -0.1, false),
    ] {
        let mut learnt = Learnt::default();
        learnt.wheels[FREE].free_slip = Some(SlipPrior { mean, sigma });
        assert_eq!(
            start.clone().restore(&learnt).is_ok(),
            is_legal,
            "{mean} {sigma}"
        );
    }
    let mut core = start;
    core.state.set_mean(GYRO_BIAS, 0.6);
    core.state.set_mean(own_slip(FREE), 0.99);
    let learnt = core.learnt();
    assert_eq!(
        (learnt.gyro_bias, learnt.wheels[FREE].free_slip),
        (None, None)
    );
    assert!(learnt.common_slip.is_some());
}
