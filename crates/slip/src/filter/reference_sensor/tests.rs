use super::*;

const MS: i64 = 1_000_000;
const ROUNDING: f64 = 1e-12;

fn settings() -> FilterSettings {
    FilterSettings {
        max_speed: 2.0,
        position_sigma: 0.003,
        speed_sigma: 0.04,
        reference_latency: 0.15,
        wheel_window: 0.08,
        max_rate: 100.0,
        ..FilterSettings::default()
    }
}

const fn displaced(forward: f64, left: f64, turn: Option<f64>) -> Measurement {
    Measurement::Displacement {
        forward,
        left,
        turn,
    }
}

const fn posed(x: f64, y: f64, yaw: f64) -> Measurement {
    Measurement::Pose { x, y, yaw }
}

/// What readings at these times (ms) show in the end.
fn after(readings: &[(i64, Measurement)]) -> Result<Option<ReferenceMotion>, Fault> {
    let mut sensor = ReferenceSensor::default();
    let mut last = Ok(None);
    for (ms, measurement) in readings {
        last = sensor.motion(ms * MS, measurement, &settings());
    }
    last
}

fn near(found: Option<f64>, expected: f64) {
    assert!(
        (found.unwrap() - expected).abs() < ROUNDING,
        "{found:?} {expected}"
    );
}

#[test]
fn a_speed_is_that_of_the_last_window_before_its_delay() {
    for left in [None, Some(-0.5)] {
        let measurement = Measurement::Speed { forward: 1.5, left };
        let motion = after(&[(1000, measurement)]).unwrap().unwrap();
        assert_eq!((motion.from_ns, motion.to_ns), (770 * MS, 850 * MS));
        assert_eq!(motion.speed, [Some(1.5), left]);
        assert_eq!((motion.turn, motion.sigma), (None, 0.04));
    }
    for (forward, left, is_legal) in [
        (-2.0, 2.0, true),
        (2.0, -2.0, true),
        (2.1, 0.0, false),
        (0.0, -2.1, false),
        (f64::NAN, 0.0, false),
    ] {
        let left = Some(left);
        assert_eq!(
            after(&[(0, Measurement::Speed { forward, left })]).is_ok(),
            is_legal
        );
    }
}

#[test]
fn a_displacement_is_a_mean_speed_since_the_last() {
    let first = displaced(9.0, 9.0, None);
    assert!(after(&[(0, first)]).unwrap().is_none());
    for turn in [None, Some(-0.1)] {
        let motion = after(&[(0, first), (250, displaced(0.3, -0.2, turn))])
            .unwrap()
            .unwrap();
        assert_eq!((motion.from_ns, motion.to_ns), (-150 * MS, 100 * MS));
        near(motion.speed[0], 1.2);
        near(motion.speed[1], -0.8);
        assert_eq!(motion.turn.is_some(), turn.is_some());
        if turn.is_some() {
            near(motion.turn, -0.4);
        }
        // of two positions
        near(Some(motion.sigma), f64::sqrt(2.0) * 0.003 / 0.25);
    }
    // over a second, and at once
    let small = displaced(0.3, 0.4, None);
    assert!(after(&[(0, first), (1000, small)]).unwrap().is_some());
    for ms in [1001, 0, -10] {
        assert!(after(&[(0, first), (ms, small)]).unwrap().is_none(), "{ms}");
    }
    // 0.5 m in 0.25 s are 2 m/s; faster than that is a jump
    assert!(after(&[(0, first), (250, small)]).unwrap().is_some());
    let jump = after(&[(0, first), (240, small)]);
    assert!(
        matches!(jump, Err(Fault::Jump { value, limit: 2.0, .. }) if (value - 0.5 / 0.24).abs() < ROUNDING)
    );
    for (measurement, is_legal) in [
        (displaced(1e8, -1e8, Some(7.0)), true),
        (displaced(1.1e8, 0.0, None), false),
        (displaced(0.0, -1.1e8, None), false),
        (displaced(0.0, 0.0, Some(-7.1)), false),
        (posed(-1e8, 1e8, -1e6), true),
        (posed(1.1e8, 0.0, 0.0), false),
        (posed(0.0, -1.1e8, 0.0), false),
        (posed(0.0, 0.0, 1.1e6), false),
        (Measurement::Position { x: 1e8, y: -1e8 }, true),
        (Measurement::Position { x: -1e8, y: 1e8 }, true),
        (Measurement::Position { x: 1.1e8, y: 0.0 }, false),
        (Measurement::Position { x: 0.0, y: 1.1e8 }, false),
        (Measurement::YawRate { rate: 1.0 }, true),
    ] {
        let found = after(&[(0, measurement)]);
        assert_eq!(found.is_ok(), is_legal, "{measurement:?}");
        // the first of its kind is none
        assert!(!is_legal || found.unwrap().is_none());
    }
}

#[test]
fn poses_are_displacements_in_the_frame_halfway() {
    for (yaw, turn) in [(0.4, 0.6), (3.0, 0.5), (-3.0, -0.7)] {
        let (from, to) = (posed(1.0, 2.0, yaw), yaw + turn);
        let (sin, cos) = f64::sin_cos(yaw + turn / 2.0);
        let (ahead, left) = (0.3, -0.1);
        let [x, y] = [
            1.0 + cos * ahead - sin * left,
            2.0 + sin * ahead + cos * left,
        ];
        for whole in [0.0, core::f64::consts::TAU] {
            let motion = after(&[(0, from), (500, posed(x, y, to + whole))])
                .unwrap()
                .unwrap();
            near(motion.speed[0], 0.6);
            near(motion.speed[1], -0.2);
            near(motion.turn, 2.0 * turn);
        }
    }
    // those of a queue come within half a period of 10 ms
    let poses = [posed(0.0, 0.0, 0.0), posed(0.005, 0.0, 0.0)];
    for (ms, is_motion) in [(4, false), (5, true)] {
        let motion = after(&[(0, poses[0]), (ms, poses[1])]).unwrap();
        assert_eq!(motion.is_some(), is_motion);
    }
    let displacements = [displaced(0.0, 0.0, None), displaced(0.005, 0.0, None)];
    assert!(
        after(&[(0, displacements[0]), (4, displacements[1])])
            .unwrap()
            .is_some()
    );
}

#[test]
fn a_sensor_that_repeats_all_its_bits_is_frozen() {
    let motion = |ms: i64, speed: [Option<f64>; 2], turn: Option<f64>| ReferenceMotion {
        from_ns: 0,
        to_ns: ms * MS,
        speed,
        turn,
        sigma: 0.1,
    };
    let same = ([Some(0.3), Some(0.1)], Some(0.2));
    for (other, is_same) in [
        (same, true),
        (([Some(0.4), Some(0.1)], Some(0.2)), false),
        (([Some(0.3), None], Some(0.2)), false),
        (([Some(0.3), Some(0.1)], None), false),
    ] {
        let mut sensor = ReferenceSensor::default();
        let mut is_frozen =
            |ms: i64, (speed, turn)| sensor.is_frozen(&motion(ms, speed, turn), 0.25);
        assert!(!is_frozen(0, same) && !is_frozen(249, same));
        assert_eq!(is_frozen(250, other), is_same);
        assert_eq!(is_frozen(499, other), is_same);
        assert!(is_frozen(500, other));
    }
}
