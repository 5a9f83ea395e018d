use super::*;
use crate::filter::motion_model::{LEFT, YAW};
use crate::filter::recovery::tests::{MS, NOW_NS, core, failed, failed_until, near, roll, rolling};

/// No default.
const GATE_SIGMAS: f64 = 4.5;

type Change = fn(&mut Core);

const fn speed(forward: f64, left: Option<f64>) -> Measurement {
    Measurement::Speed { forward, left }
}

/// A robot at 0.4 m/s by a state that is known.
fn moving() -> Core {
    let mut core = rolling(&[0.5, 0.5, 0.4]);
    for (i, value) in [(FORWARD, 0.4), (LEFT, 0.01), (YAW, 0.05)] {
        core.state.reset(i, value, 0.01);
    }
    core.speed_known_ns = Some(NOW_NS);
    core.path.record(NOW_NS);
    core
}

#[test]
fn a_past_motion_is_compared_with_the_state_less_what_was_gained_since() {
    let mut core = moving();
    // 1 s at an even acceleration of (0.3, −0.2) m/s² and a turn of 0.7 rad/s by the gyro
    core.path.yaw_rate = 0.7;
    core.path.advance(1.0, [0.3, -0.2]);
    core.path.record(NOW_NS + 1000 * MS);
    core.path.yaw_rate = 0.6;
    let motion = ReferenceMotion {
        from_ns: NOW_NS + 200 * MS,
        to_ns: NOW_NS + 600 * MS,
        speed: [Some(0.35), None],
        turn: Some(0.2),
        sigma: 0.04,
    };
    let now_ns = NOW_NS + 1000 * MS;
    core.now_ns = Some(now_ns);
    core.speed_known_ns = Some(now_ns);
    let density = core.process_noise_density();
    // 0.4 s behind, and half of a window of 0.4 s
    let changed = density * density * 0.6;
    let [forward, left, turn] = core.components(&motion, now_ns);
    let (row, residual, variance) = forward.unwrap();
    assert_eq!(row, along([1.0, 0.0, 0.0]));
    near(residual, 0.35 - (0.4 - 0.3 * 0.6));
    near(variance, 0.0016 + changed);
    assert!(left.is_none());
    let (row, residual, variance) = turn.unwrap();
    assert_eq!(row, along([0.0, 0.0, 1.0]));
    near(residual, 0.2 - (0.05 + 0.7 - 0.6));
    near(variance, 25.0 * 0.0016 + 0.005 * 0.005);
    let sideways = ReferenceMotion {
        speed: [None, Some(0.35)],
        turn: None,
        ..motion
    };
    let [forward, left, none] = core.components(&sideways, now_ns);
    let (row, residual, variance) = left.unwrap();
    assert!(forward.is_none() && none.is_none());
    assert_eq!(row, along([0.0, 1.0, 0.0]));
    near(residual, 0.35 - (0.01 + 0.2 * 0.6));
    near(variance, 0.0016 + changed);
    // a turn alone changes the yaw rate alone
    let mut turned = core.clone();
    turned.update_turn(&motion, now_ns);
    let gain = 0.01 / (0.01 + 25.0 * 0.0016 + 0.005 * 0.005);
    near(turned.state.mean(YAW), 0.05 + gain * (0.2 - 0.15));
    assert_eq!(turned.state.mean(FORWARD), core.state.mean(FORWARD));
    turned.update_turn(&sideways, now_ns);
    near(turned.state.mean(YAW), 0.05 + gain * (0.2 - 0.15));
}

#[test]
fn the_speed_changes_as_the_rims_do_or_by_the_accelerometer() {
    const PACE_M_PER_S_SQRT_S: f64 = 0.06;
    let walk = 0.1;
    let unaided = 10.0 * walk;
    // both rims gain the same within windows of 0.1 s
    let pacing = |has_free: bool, pace: f64| {
        let mut core = core(has_free);
        for wheel in 0..2 {
            let gained = pace * f64::sqrt(0.1);
            roll(&mut core, wheel, NOW_NS, &[0.5, 0.5, 0.5 + gained]);
        }
        core.speed_known_ns = Some(NOW_NS - 500 * MS);
        core
    };
    let mut core = pacing(true, PACE_M_PER_S_SQRT_S);
    near(
        core.process_noise_density(),
        f64::hypot(walk, PACE_M_PER_S_SQRT_S),
    );
    core.accelerometer.update(NOW_NS, [0.1, 0.0]).unwrap();
    core.accelerometer.noise_scale = 4.0;
    near(
        core.process_noise_density(),
        f64::hypot(0.03 * 2.0, 0.25 * PACE_M_PER_S_SQRT_S),
    );
    // that is worse than none
    core.accelerometer.noise_scale = 40.0;
    near(
        core.process_noise_density(),
        f64::hypot(walk, PACE_M_PER_S_SQRT_S),
    );
    core.accelerometer = super::super::accelerometer::Accelerometer::default();
    core.speed_known_ns = Some(NOW_NS - 501 * MS);
    near(core.process_noise_density(), unaided);
    core.speed_known_ns = None;
    near(core.process_noise_density(), unaided);
    near(pacing(true, 5.0).process_noise_density(), unaided);
    // where the motion over the ground is measured, the rims lead
    near(
        pacing(false, PACE_M_PER_S_SQRT_S).process_noise_density(),
        walk,
    );
}

#[test]
fn a_reading_within_the_gate_updates_the_state() {
    let start = moving();
    let reading = speed(0.42, Some(0.03));
    let mut found = start.clone();
    found.update_reference(NOW_NS, &reading).unwrap();
    let motion = found
        .reference
        .motion(NOW_NS, &reading, &start.settings)
        .unwrap()
        .unwrap();
    let mut expected = start.state.clone();
    let components = start.components(&motion, NOW_NS);
    let (innovation, variance) = expected.innovation(&measured(&components[0].unwrap()));
    let r = innovation / f64::sqrt(variance);
    let mut nis = 0.0;
    for component in components.iter().flatten() {
        nis = expected.update(&measured(component));
    }
    for i in [FORWARD, LEFT, YAW] {
        near(found.state.mean(i), expected.mean(i));
        near(found.state.sigma(i), expected.sigma(i));
    }
    near(found.nis, nis);
    near(found.reference.mean_innovation, 0.3 * r);
    assert_eq!(found.reference.accepted_ns, Some(NOW_NS));
    assert_eq!(found.speed_known_ns, Some(NOW_NS));
    assert_eq!(found.reference.speed, Some((0.42, NOW_NS)));
    assert_eq!(
        (
            found.output.reference_readings,
            found.output.reference_refused
        ),
        (1, 0)
    );
    // one of the future is of the time that it states, the first displacement and one that cannot be are none
    found.update_reference(NOW_NS + MS, &reading).unwrap();
    assert_eq!(found.reference.accepted_ns, Some(NOW_NS + MS));
    let displaced = Measurement::Displacement {
        forward: 0.0,
        left: 0.0,
        turn: None,
    };
    found.update_reference(NOW_NS, &displaced).unwrap();
    assert!(
        found
            .update_reference(NOW_NS, &speed(f64::NAN, None))
            .is_err()
    );
    assert_eq!(
        (
            found.output.reference_readings,
            found.output.reference_refused
        ),
        (2, 0)
    );
}

#[test]
fn readings_beyond_the_gate_are_refused() {
    let sigma = |core: &Core, i: usize| {
        let motion = ReferenceMotion {
            from_ns: NOW_NS - 50 * MS,
            to_ns: NOW_NS,
            speed: [Some(0.4), Some(0.01)],
            turn: None,
            sigma: 0.01,
        };
        let components = core.components(&motion, NOW_NS);
        f64::sqrt(core.state.innovation(&measured(&components[i].unwrap())).1)
    };
    for (off, mean, is_refused) in [
        ([0.0, 0.0], 0.0, false),
        ([0.99 * GATE_SIGMAS, -0.99 * GATE_SIGMAS], 0.0, false),
        ([-1.01 * GATE_SIGMAS, 0.0], 0.0, true),
        ([0.0, -1.01 * GATE_SIGMAS], 0.0, true),
        // a mean over many that is off by more than 2 sigma, of which one counts 0.3 and is limited to 4 sigma
        ([0.0, 0.0], 2.8, false),
        ([0.0, 0.0], -2.9, true),
        ([4.4, 0.0], 1.13, false),
        ([4.4, 0.0], 1.15, true),
    ] {
        let start = moving();
        let reading = speed(
            0.4 + off[0] * sigma(&start, 0),
            Some(0.01 + off[1] * sigma(&start, 1)),
        );
        let mut found = start.clone();
        found.reference.mean_innovation = mean;
        found.update_reference(NOW_NS, &reading).unwrap();
        assert_eq!(
            found.output.reference_refused,
            u64::from(is_refused),
            "{off:?} {mean}"
        );
        let is_same = found.state.sigma(FORWARD) == start.state.sigma(FORWARD);
        assert_eq!(is_same, is_refused);
        assert_eq!(found.reference.accepted_ns.is_none(), is_refused);
        assert_eq!(found.reference.monitor.is_suspect(), is_refused);
    }
}

#[test]
fn a_sensor_that_repeats_a_speed_is_frozen_and_one_at_rest_is_not() {
    for (forward, is_frozen) in [(0.4, true), (0.0, false)] {
        let mut core = moving();
        core.state.reset(FORWARD, forward, 0.01);
        for ms in [0, 150, 299] {
            core.update_reference(NOW_NS + ms * MS, &speed(forward, None))
                .unwrap();
        }
        assert_eq!(core.output.reference_refused, 0);
        core.update_reference(NOW_NS + 300 * MS, &speed(forward, None))
            .unwrap();
        assert_eq!(core.output.reference_refused, u64::from(is_frozen));
        assert_eq!(core.reference.speed.is_none(), is_frozen);
    }
}

/// A reference that has agreed again for all but the last tenth of a second that it takes.
fn almost_readmitted(own: f64, rims: f64, free: f64) -> Core {
    let mut core = rolling(&[rims, rims, free]);
    core.state.reset(FORWARD, own, 0.01);
    core.path.record(NOW_NS);
    core.reference.monitor = failed_until(NOW_NS - 800 * MS);
    for i in (1..8).rev() {
        core.reference
            .monitor
            .record(NOW_NS - i * 100 * MS, true, 0.3);
    }
    core
}

#[test]
fn a_reference_that_failed_is_readmitted_near_the_state_or_where_nothing_else_is_known() {
    let readmitted = |own: f64, rims: f64, free: f64, reads: f64, change: Change| {
        let mut core = almost_readmitted(own, rims, free);
        change(&mut core);
        core.reference.mean_innovation = 0.5;
        core.update_reference(NOW_NS, &speed(reads, None)).unwrap();
        core
    };
    let known: Change = |core| core.speed_known_ns = Some(NOW_NS);
    let keep: Change = |_| ();
    // near by 0.15 of the speed, and the low speed
    for (reads, is_near) in [(0.479, true), (0.321, true), (0.482, false), (0.319, false)] {
        let core = readmitted(0.4, 0.5, 0.4, reads, known);
        assert_eq!(
            core.output.reference_refused,
            u64::from(!is_near),
            "{reads}"
        );
        assert_eq!(core.reference.accepted_ns.is_some(), is_near);
    }
    // a robot that seems to stand at 0.1 m/s, rims at 0.5 m/s, and a free wheel that shows 0.4 m/s as the reference does
    let core = readmitted(0.1, 0.5, 0.4, 0.4, keep);
    near(core.state.mean(FORWARD), 0.4);
    near(core.state.sigma(FORWARD), 0.05 * 0.4 + 0.02);
    assert_eq!(core.reference.mean_innovation, 0.0);
    assert_eq!(
        (core.reference.accepted_ns, core.output.reference_refused),
        (None, 0)
    );
    for (core, why) in [
        (readmitted(0.1, 0.5, 0.4, 0.4, known), "the speed is known"),
        (readmitted(0.1, 2.5, 0.4, 0.4, keep), "a slip of 0.84"),
        (
            readmitted(0.1, 0.5, 0.2, 0.4, keep),
            "the free wheel shows less",
        ),
    ] {
        assert_eq!(core.output.reference_refused, 1, "{why}");
        near(core.state.mean(FORWARD), 0.1);
    }
    // a reading that agrees is not enough so soon
    let mut core = almost_readmitted(0.4, 0.5, 0.4);
    core.reference.monitor = failed();
    core.update_reference(NOW_NS, &speed(0.4, None)).unwrap();
    assert_eq!(core.output.reference_refused, 1);
}
