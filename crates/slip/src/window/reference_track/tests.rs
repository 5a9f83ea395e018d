use super::*;
use core::f64::consts::TAU;

const MS: i64 = 1_000_000;

fn track(reference: Reference) -> ReferenceTrack {
    ReferenceTrack::new(&WindowSettings {
        reference,
        window: 0.5,
        dropout: 0.3,
        max_speed: 2.0,
        position_sigma: 0.004,
        yaw_sigma: 0.03,
        speed_sigma: 0.02,
        yaw_rate_sigma: 0.01,
        ..WindowSettings::default()
    })
}

fn near(value: [f64; 3], expected: [f64; 3]) -> bool {
    value
        .iter()
        .zip(expected)
        .all(|(v, e)| (v - e).abs() < 1e-12)
}

const fn displaced(forward: f64, turn: Option<f64>) -> Measurement {
    Measurement::Displacement {
        forward,
        left: 0.0,
        turn,
    }
}

const fn posed(x: f64, yaw: f64) -> Measurement {
    Measurement::Pose { x, y: 0.0, yaw }
}

/// What was added in all from one time to another.
fn passed(track: &ReferenceTrack, from_ms: i64, to_ms: i64) -> Option<[f64; 3]> {
    track.displacement.history.between(from_ms * MS, to_ms * MS)
}

#[test]
fn a_way_between_poses_is_in_the_frame_halfway() {
    for (yaw, turn, way) in [
        (0.0, 0.0, [0.3, -0.2]),
        (0.7, 0.4, [0.3, 0.1]),
        (-2.0, -0.9, [-0.5, 0.2]),
        // over half a turn and back
        (3.0, 0.5, [0.3, 0.1]),
        (-3.1, -0.3, [0.3, 0.1]),
    ] {
        // a rotation by the heading halfway, by its complex number
        let (sin, cos) = f64::sin_cos(yaw + turn / 2.0);
        let to = [
            1.0 + way[0] * cos - way[1] * sin,
            2.0 + way[0] * sin + way[1] * cos,
        ];
        for whole in [-TAU, 0.0, TAU] {
            let found = displacement([1.0, 2.0, yaw], [to[0], to[1], yaw + turn + whole]);
            assert!(near(found, [way[0], way[1], turn]), "{yaw}: {found:?}");
        }
    }
}

#[test]
fn only_the_reference_that_is_set_is_taken() {
    let speed = Measurement::Speed {
        forward: 0.1,
        left: None,
    };
    let all = [
        (Reference::Displacement, displaced(0.1, None)),
        (Reference::Pose, posed(0.1, 0.0)),
        (Reference::Speed, speed),
    ];
    for (reference, _) in all {
        for (of, measurement) in all {
            let mut track = track(reference);
            track.take(7, &measurement).unwrap();
            let expected = (of == reference).then_some(7);
            assert_eq!(track.displacement_time(), expected);
            assert_eq!(track.known_until(), expected);
        }
    }
    assert_eq!(track(Reference::Grip).known_until(), Some(i64::MAX));
    // twice the longer of a window and a dropout
    assert_eq!(track(Reference::Grip).gap, 1.0);
}

#[test]
fn a_command_is_a_direction() {
    let mut track = track(Reference::Speed);
    let mut command = |ms: i64, forward, left| {
        let taken = track.take(ms * MS, &Measurement::Command { forward, left });
        (taken.is_ok(), track.command)
    };
    assert_eq!(command(0, -0.375, -0.5), (true, Some([-0.6, -0.8])));
    assert_eq!(command(10, 0.0, 0.0), (true, None));
    // up to the greatest speed
    assert_eq!(command(20, -2.0, 0.0), (true, Some([-1.0, 0.0])));
    assert_eq!(command(30, 0.0, -2.0), (true, Some([0.0, -1.0])));
    assert_eq!(command(40, -2.1, 0.0), (false, Some([0.0, -1.0])));
    assert_eq!(command(40, 0.0, -2.1), (false, Some([0.0, -1.0])));
}

#[test]
fn a_speed_is_a_way_in_both_directions() {
    let mut track = track(Reference::Speed);
    for ms in [0, 250, 500] {
        let measurement = Measurement::Speed {
            forward: 1.5,
            left: Some(-0.5),
        };
        track.take(ms * MS, &measurement).unwrap();
    }
    assert!(near(passed(&track, 0, 500).unwrap(), [0.75, -0.25, 0.0]));
}

/// 2 m/s over a window of 0.5 s, or over a longer interval.
#[test]
fn a_displacement_that_is_too_long_leaves_a_hole() {
    let reference = Reference::Displacement;
    let take = |elapsed_ms: i64, way: f64| {
        let mut track = track(reference);
        track.take(0, &displaced(0.0, None)).unwrap();
        track.take(elapsed_ms * MS, &displaced(way, None))
    };
    assert!(take(250, 1.0).is_ok() && take(1000, 2.0).is_ok());
    let fault = take(250, -1.1).unwrap_err();
    let Fault::Jump { value, limit, .. } = fault else {
        panic!("{fault}");
    };
    assert!((value - 4.4).abs() < 1e-12 && limit == 2.0);
    assert!(take(1000, 2.01).is_err());
    // one refused displacement or two: the next starts anew
    for refused in [1, 2] {
        let mut track = track(reference);
        track.take(0, &displaced(0.0, None)).unwrap();
        track.take(100 * MS, &displaced(0.1, None)).unwrap();
        for index in 0..refused {
            let jump = track.take((200 + 100 * index) * MS, &displaced(9.0, None));
            assert!(jump.is_err());
        }
        for ms in [400, 500] {
            track.take(ms * MS, &displaced(0.1, None)).unwrap();
        }
        assert_eq!(passed(&track, 100, 500), None);
        assert!(near(passed(&track, 400, 500).unwrap(), [0.1, 0.0, 0.0]));
        // one that arrives twice is refused and leaves none
        assert!(track.take(500 * MS, &displaced(0.1, None)).is_err());
        track.take(600 * MS, &displaced(0.1, None)).unwrap();
        assert!(near(passed(&track, 400, 600).unwrap(), [0.2, 0.0, 0.0]));
    }
}

/// Poses along x every 100 ms with these yaws: the way from the first to the last, as added up.
fn along_x(yaws: &[f64]) -> [f64; 3] {
    let mut track = track(Reference::Pose);
    let mut ms = 0;
    for (index, yaw) in yaws.iter().enumerate() {
        ms = 100 * i64::try_from(index).unwrap();
        track
            .take(ms * MS, &posed(0.1 * index as f64, *yaw))
            .unwrap();
    }
    passed(&track, 0, ms).unwrap()
}

#[test]
fn a_yaw_that_goes_aside_and_comes_back_turns_no_way() {
    // aside by 0.5 rad for one pose: as if it had not been
    assert!(near(along_x(&[0.0, 0.5, 0.0]), [0.2, 0.0, 0.0]));
    assert!(near(along_x(&[0.0, -0.5, 0.0, 0.0]), [0.3, 0.0, 0.0]));
    let back = along_x(&[0.0, 0.14, -0.059]);
    assert!(near(
        back,
        [0.2 * f64::cos(0.0295), 0.2 * f64::sin(0.0295), -0.059]
    ));
    // 0.1 rad and less, and what comes back with 0.3 of it still missing, is taken as it is
    let each = |yaws: &[f64]| {
        let parts = yaws.windows(2).map(|pair| {
            let half = f64::midpoint(pair[0], pair[1]);
            [
                0.1 * f64::cos(half),
                -0.1 * f64::sin(half),
                pair[1] - pair[0],
            ]
        });
        parts.fold([0.0; 3], |sum, part| [0, 1, 2].map(|i| sum[i] + part[i]))
    };
    for yaws in [
        vec![0.0, 0.1, 0.0],
        vec![0.0, 0.14, -0.06],
        vec![0.0, 0.14, -0.061],
        vec![0.0, 0.05, 0.01],
        // a bend
        vec![0.0, 0.2, 0.4, 0.6],
        vec![0.0, 0.5, 1.0],
    ] {
        assert!(near(along_x(&yaws), each(&yaws)), "{yaws:?}");
    }
}

#[test]
fn the_way_to_a_pose_that_jumped_is_unknown() {
    for jumps in [1, 2] {
        let mut track = track(Reference::Pose);
        track.take(0, &posed(0.0, 0.0)).unwrap();
        track.take(100 * MS, &posed(0.1, 0.0)).unwrap();
        for index in 1..=jumps {
            let jump = posed(50.0 * index as f64, 0.0);
            assert!(track.take((100 + 100 * index) * MS, &jump).is_err());
        }
        let at = 50.0 * jumps as f64;
        track.take(400 * MS, &posed(at + 0.1, 0.0)).unwrap();
        track.take(500 * MS, &posed(at + 0.2, 0.0)).unwrap();
        assert_eq!(passed(&track, 100, 500), None);
        assert!(near(passed(&track, 400, 500).unwrap(), [0.1, 0.0, 0.0]));
    }
}

#[test]
fn a_yaw_rate_is_the_gyros_or_the_references_own() {
    // by a gyro: 0.2 rad/s as a mean, its sigma as set
    let mut by_gyro = track(Reference::Displacement);
    for (ms, rate) in [(0, 0.1), (400, 0.3)] {
        let measurement = Measurement::Inertial {
            force: [0.0; 3],
            rate: [9.0, 9.0, rate],
        };
        by_gyro.take(ms * MS, &measurement).unwrap();
    }
    let seen = by_gyro.yaw_rate(0, 400 * MS).unwrap();
    assert!((seen.value - 0.2).abs() < 1e-12 && (seen.variance - 1e-4).abs() < 1e-18);
    // by displacements: 0.1 rad in 0.4 s, 0.03 rad at both ends
    let turning = |turn| {
        let mut track = track(Reference::Displacement);
        track.take(0, &displaced(0.0, turn)).unwrap();
        track.take(400 * MS, &displaced(0.1, turn)).unwrap();
        track.yaw_rate(0, 400 * MS)
    };
    let seen = turning(Some(0.1)).unwrap();
    assert!((seen.value - 0.25).abs() < 1e-12);
    assert!((seen.variance - 2.0 * 0.0009 / 0.16).abs() < 1e-12);
    assert_eq!(turning(None), None);
    let mut track = track(Reference::Speed);
    for ms in [0, 400] {
        let measurement = Measurement::Speed {
            forward: 0.1,
            left: None,
        };
        track.take(ms * MS, &measurement).unwrap();
    }
    assert_eq!(track.yaw_rate(0, 400 * MS), None);
}

/// 0.3 m forwards and 0.1 m to the right in 0.4 s.
#[test]
fn a_motion_is_known_to_the_sigma_of_a_speed_or_of_two_places() {
    let displaced = Measurement::Displacement {
        forward: 0.3,
        left: -0.1,
        turn: None,
    };
    let moving = Measurement::Speed {
        forward: 0.75,
        left: Some(-0.25),
    };
    let of_places = 2.0 * 0.000_016 / 0.16;
    for (reference, measurement, variance) in [
        (Reference::Displacement, displaced, of_places),
        (Reference::Speed, moving, 0.0004),
    ] {
        let mut track = track(reference);
        track.take(0, &measurement).unwrap();
        track.take(400 * MS, &measurement).unwrap();
        let mut seen = Observations::default();
        let turn = Measured {
            value: 0.0,
            variance: 1.0,
        };
        seen.add([0.0, 0.0, 1.0], turn);
        track.observe(0, 400 * MS, &mut seen).unwrap();
        let motion = seen.solve().unwrap();
        assert!(near(motion.velocity, [0.75, -0.25, 0.0]));
        for i in [0, 1] {
            assert!((motion.covariance[i][i] / variance - 1.0).abs() < 1e-9);
        }
        assert!(track.observe(-1, 400 * MS, &mut seen).is_none());
    }
}
