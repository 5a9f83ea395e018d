use super::*;

const MS: i64 = 1_000_000;

fn window(ms: i64, rim: f64, innovation: f64, is_off: bool) -> WheelWindow {
    WheelWindow {
        index: 0,
        to_ns: ms * MS,
        rim,
        forward: 0.0,
        faster: rim,
        innovation,
        variance: 1.0,
        is_off,
        has_slip: true,
    }
}

fn known(ms: i64, speed: f64, accel_integral: f64) -> KnownSpeed {
    KnownSpeed {
        time_ns: ms * MS,
        speed,
        variance: 0.01,
        accel_integral,
    }
}

#[test]
fn a_wheel_has_turned_until_the_robot_stands() {
    let mut history = RollingHistory::default();
    assert!(history.stop_expected);
    for (rim, turned) in [(0.04, false), (-0.04, false), (-0.05, true), (0.0, true)] {
        history.runs(rim);
        assert_eq!(history.has_turned, turned);
    }
    history.stop_expected = false;
    history.turns(known(0, 0.25, 0.0));
    history.jumps(&window(10, 0.5, 0.25, true), (0.0, 0.0));
    assert!(history.stop_expected);
    history.stop_expected = false;
    history.stands();
    assert!(history.stop_expected && !history.has_turned && history.jump.is_none());
}

#[test]
fn a_jump_counts_after_a_second_of_calm() {
    for (calm_ms, noise_scale, was_calm) in
        [(1000, 1.9, true), (999, 1.9, false), (1000, 2.0, false)]
    {
        let mut history = RollingHistory::default();
        history.record(&window(5, 0.3, 0.0, false), 1.0);
        history.record(&window(500, 0.3, 0.0, false), 1.0);
        history.record(&window(5 + calm_ms, 0.3, 1.0, true), noise_scale);
        assert_eq!(history.was_calm, was_calm);
        // as it was until it agrees again
        history.record(&window(1050, 0.3, 1.0, true), 1.0);
        assert_eq!(history.was_calm, was_calm);
        history.record(&window(1100, 0.3, 0.0, false), 1.0);
        history.record(&window(1200, 0.3, 1.0, true), 1.0);
        assert!(!history.was_calm);
    }
}

#[test]
fn a_speed_is_remembered_for_up_to_twice_its_time() {
    let mut history = RollingHistory::default();
    assert!(history.known_before().is_none());
    let before = |history: &RollingHistory| history.known_before().map(|known| known.time_ns / MS);
    for (ms, expected) in [(0, 0), (299, 0), (300, 0), (599, 0), (600, 300), (700, 300)] {
        history.turns(known(ms, 0.25, 0.0));
        assert_eq!(before(&history), Some(expected), "{ms}");
    }
    // at rest, whatever the robot does
    let mut history = RollingHistory {
        stop_expected: false,
        ..RollingHistory::default()
    };
    history.rests(known(0, 0.25, 0.125));
    let resting = history.known_before().unwrap();
    assert_eq!((resting.speed, resting.accel_integral), (0.0, 0.125));
    assert!(!history.stop_expected);
}

#[test]
fn a_jump_is_over_where_the_wheel_is_as_fast_as_before() {
    const SKID_AND_SIGMA: (f64, f64) = (0.25, 0.04);
    let jumped = || {
        let mut history = RollingHistory {
            jumped_ns: Some(7),
            ..RollingHistory::default()
        };
        history.turns(known(0, 0.5, 0.125));
        history.jumps(&window(100, 2.0, -0.5, true), SKID_AND_SIGMA);
        history
    };
    // 0.5 m/s, and 0.25 m/s gained since: by a rim of a quarter more, within half of the jump
    let gained = 0.375;
    let (at, edge) = (1.0, 4.0 / 3.0);
    for (rims, ends_ms, is_over) in [
        ([at, at, at], 290, true),
        ([at, at, at], 289, false),
        // back since the last window that was not
        ([at, edge, at], 290, false),
        ([2.0 * at, at, at], 290, false),
        ([at, at, edge], 290, false),
        ([at, at, 2.0 / 3.0], 290, false),
        ([1.3, 0.7, 1.3], 290, true),
    ] {
        let mut history = jumped();
        let mut found = None;
        for (ms, rim) in [200, 250, ends_ms].into_iter().zip(rims) {
            assert_eq!(found, None);
            found = history.returns(&window(ms, rim, 0.0, false), gained);
        }
        assert_eq!(
            found,
            is_over.then_some(SKID_AND_SIGMA),
            "{rims:?} {ends_ms}"
        );
        assert_eq!(history.jumped_ns, (!is_over).then_some(7));
        assert_eq!(history.jump.is_none(), is_over);
    }
    // after a second it is a change of the skid
    for (ms, is_kept) in [(1099, true), (1100, false)] {
        let mut history = jumped();
        assert_eq!(history.returns(&window(ms, 2.0, 0.0, true), gained), None);
        assert_eq!(history.jump.is_some(), is_kept);
        assert_eq!(history.jumped_ns, Some(7));
    }
    assert_eq!(
        RollingHistory::default().returns(&window(0, 1.0, 0.0, false), 0.0),
        None
    );
}
