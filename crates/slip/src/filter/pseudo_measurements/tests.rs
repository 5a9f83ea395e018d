use super::*;
use crate::filter::kalman::Kalman;
use crate::filter::motion_model::{LEFT, YAW};
use crate::filter::recovery::tests::{MS, NOW_NS, core, failed, near, rolling, with_gyro};

/// Pseudo-measurements 0.02 s apart whose errors last 0.5 s.
const SIGMA_FACTOR: f64 = 5.0;
const YAW_ROW: [f64; 3] = [0.0, 0.0, 1.0];
const LEFT_ROW: [f64; 3] = [0.0, 1.0, 0.0];

/// A motion with correlations, that pseudo-measurements change.
fn moving(mut core: Core) -> Core {
    for (i, value) in [(FORWARD, 0.4), (LEFT, 0.03), (YAW, 0.2)] {
        core.state.reset(i, value, 0.04);
    }
    core.state.set_covariance(FORWARD, LEFT, 0.01);
    core.state.set_covariance(FORWARD, YAW, -0.015);
    core.state.set_covariance(LEFT, YAW, 0.02);
    core
}

fn assert_same(found: &Kalman, expected: &Kalman) {
    for i in [FORWARD, LEFT, YAW] {
        near(found.mean(i), expected.mean(i));
        for j in [FORWARD, LEFT, YAW] {
            near(found.covariance(i, j), expected.covariance(i, j));
        }
    }
}

#[test]
fn a_robot_does_not_drift_but_down_a_slope() {
    for (cross_slope, drifts) in [(0.0, false), (0.03, false), (0.2, true)] {
        let mut core = moving(rolling(&[0.5, 0.6, 0.3]));
        with_gyro(&mut core);
        core.cross_slope = cross_slope;
        assert_eq!(core.drifts_downhill(), drifts);
        let mut expected = core.state.clone();
        // twice the slope times the rims' slip speed, which lasts for 10 s, beside 0.01 m/s
        let downhill = 2.0 * cross_slope * (0.55 - 0.4) * f64::sqrt(10.0 / 0.02);
        let sigma = f64::hypot(downhill, SIGMA_FACTOR * 0.01);
        motion_model::hold(&mut expected, LEFT_ROW, 0.0, sigma);
        core.apply_pseudo_measurements(NOW_NS);
        assert_same(&core.state, &expected);
        // without a direction that all wheels share
        core.wheels.lateral = None;
        assert!(!core.drifts_downhill());
        let before = core.state.clone();
        core.apply_pseudo_measurements(NOW_NS);
        assert_same(&core.state, &before);
    }
}

#[test]
fn without_a_gyro_the_wheels_show_the_turn() {
    let mut core = moving(rolling(&[0.4, 0.75, 0.3]));
    let mut expected = core.state.clone();
    motion_model::hold(&mut expected, LEFT_ROW, 0.0, SIGMA_FACTOR * 0.01);
    // the right one is 0.35 m/s faster, 0.7 m apart
    let turn = 0.5;
    motion_model::hold(
        &mut expected,
        YAW_ROW,
        turn,
        SIGMA_FACTOR * (0.3 * turn + 0.05),
    );
    core.apply_pseudo_measurements(NOW_NS);
    assert_same(&core.state, &expected);
}

#[test]
fn wheels_that_stand_hold_the_robot() {
    // a free wheel that has stood for 0.2 s: 0.6 of a tick in that time; that of a wheel without ticks is 2 mm/s
    for (tick, sigma) in [(0.004, 0.6 * 0.004 / 0.2), (0.0, 0.002)] {
        for (since_ms, stop_expected, is_clean, holds) in [
            (200, true, true, true),
            (199, true, true, false),
            (200, false, true, false),
            (200, true, false, false),
        ] {
            let mut core = moving(rolling(&[0.5, 0.6, 0.0]));
            with_gyro(&mut core);
            let free = &mut core.wheels.channels[2];
            free.tick = tick;
            free.still_since_ns = Some(NOW_NS - since_ms * MS);
            free.rolling.stop_expected = stop_expected;
            if !is_clean {
                free.monitor = failed();
            }
            let row = free.row;
            let mut expected = core.state.clone();
            motion_model::hold(&mut expected, LEFT_ROW, 0.0, SIGMA_FACTOR * 0.01);
            if holds {
                motion_model::hold(&mut expected, row, 0.0, SIGMA_FACTOR * sigma);
            }
            core.apply_pseudo_measurements(NOW_NS);
            assert_same(&core.state, &expected);
        }
    }
    // all wheels, with and without a free one
    for (rims, sigma) in [(&[0.0; 3][..], 0.002), (&[0.0; 2], 0.02)] {
        for (since_ms, has_failed, stands) in
            [(200, false, true), (199, false, false), (200, true, false)]
        {
            let mut core = moving(rolling(rims));
            with_gyro(&mut core);
            for wheel in 0..rims.len() {
                let wheel = &mut core.wheels.channels[wheel];
                wheel.still_since_ns = Some(NOW_NS - since_ms * MS);
                wheel.rolling.stop_expected = false;
                wheel.rolling.has_turned = true;
            }
            if has_failed {
                core.wheels.channels[0].monitor = failed();
            }
            core.accelerometer.noise_scale = 3.0;
            let mut expected = core.state.clone();
            let mut learnt = core.accelerometer;
            motion_model::hold(&mut expected, LEFT_ROW, 0.0, SIGMA_FACTOR * 0.01);
            if stands {
                let variance = expected.covariance(FORWARD, FORWARD) + sigma * sigma;
                learnt.learn_noise(expected.mean(FORWARD), variance);
                let rows = [
                    ([1.0, 0.0, 0.0], sigma),
                    (LEFT_ROW, sigma),
                    (YAW_ROW, 0.002),
                ];
                for (row, sigma) in rows {
                    motion_model::hold(&mut expected, row, 0.0, SIGMA_FACTOR * sigma);
                }
            }
            core.apply_pseudo_measurements(NOW_NS);
            assert_same(&core.state, &expected);
            near(core.accelerometer.noise_scale, learnt.noise_scale);
            for wheel in core.wheels.iter() {
                assert_eq!(wheel.rolling.stop_expected, stands);
                assert_eq!(wheel.rolling.has_turned, !stands);
            }
        }
    }
    // no wheel that was never read stands
    let mut unread = moving(core(true));
    let mut expected = unread.state.clone();
    motion_model::hold(&mut expected, LEFT_ROW, 0.0, SIGMA_FACTOR * 0.01);
    unread.apply_pseudo_measurements(NOW_NS);
    assert_same(&unread.state, &expected);
}
