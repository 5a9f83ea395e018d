use super::*;

mod arcs;

/// One second of arc of the meridian at 45°, m.
const SECOND_M: f64 = 30.87;

fn fix(latitude_deg: f64, longitude_deg: f64) -> NavSatFix {
    NavSatFix {
        latitude_deg,
        longitude_deg,
        altitude: 100.0,
        is_fixed: true,
        status: 2,
        variance: None,
    }
}

/// A fix at a place near 45° north, 9° east, m.
fn at(east: f64, north: f64) -> NavSatFix {
    let scale = 45.0_f64.to_radians().cos() * 1.001_68;
    fix(
        45.0 + north / SECOND_M / 3600.0,
        9.0 + east / (SECOND_M * scale) / 3600.0,
    )
}

#[test]
fn a_drive_to_the_north_and_back_is_forwards_and_backwards() {
    let step = 0.1 / SECOND_M / 3600.0;
    let mut track = Track::default();
    let mut ways = Vec::new();
    for (time, k) in (0..50).chain((0..49).rev()).enumerate() {
        let time_ns = 200_000_000 * i64::try_from(time).unwrap();
        if let Some(Measurement::Displacement { forward, left, .. }) =
            track.take_fix(time_ns, &fix(45.0 + step * f64::from(k), 9.0))[1]
        {
            ways.push(forward);
            assert!(left.abs() < 1e-6, "{left}");
        }
    }
    assert!((ways[0] - 0.1).abs() < 1e-4, "{}", ways[0]);
    assert!((ways.last().unwrap() + 0.1).abs() < 1e-4);
    let sum: f64 = ways.iter().sum();
    assert!(sum.abs() < 0.3, "{sum}");
}

/// A drive at 0.5 m/s, straight, then in circles at 0.4 rad/s, then on the spot; fixes at 5 Hz, the antenna at
/// (`forward`, `left`). Returns the way forwards in the circles and on the spot, and the greatest displacement to the
/// left, m.
fn circles(forward: f64, left: f64, described: [f64; 2], has_gyro: bool) -> (f64, f64, f64) {
    let mut track = Track::new(described);
    let (mut x, mut y, mut yaw) = (0.0, 0.0, 0.7_f64);
    let (mut way, mut spot, mut aside): (f64, f64, f64) = (0.0, 0.0, 0.0);
    for step in 0..6000_i64 {
        let time_ns = step * 10_000_000;
        let (speed, rate) = match step {
            ..1000 => (0.5, 0.0),
            1000..5000 => (0.5, 0.4),
            _ => (0.0, 0.4),
        };
        if has_gyro {
            track.turn(time_ns, rate);
        }
        let (sin, cos) = yaw.sin_cos();
        if step % 20 == 0 {
            let place = at(
                x + cos * forward - sin * left,
                y + sin * forward + cos * left,
            );
            let found = track.take_fix(time_ns, &place)[1];
            if let Some(Measurement::Displacement { forward, left, .. }) = found {
                // the fixes at a change of the motion are of both
                match step {
                    1020..=4980 => way += forward,
                    5020.. => spot += forward,
                    _ => continue,
                }
                aside = aside.max(left.abs());
            }
        }
        (x, y, yaw) = (
            x + 0.01 * speed * cos,
            y + 0.01 * speed * sin,
            yaw + 0.01 * rate,
        );
    }
    (way, spot, aside)
}

#[test]
fn the_turn_of_an_antenna_about_the_robots_origin_is_no_motion() {
    // 199 fixes of 0.1 m
    let (way, spot, aside) = circles(0.4, 0.3, [0.4, 0.3], true);
    assert!((way - 19.9).abs() < 0.05, "{way}");
    assert!(spot.abs() < 0.05 && aside < 0.01, "{spot} {aside}");
    // Described at the origin, the same antenna shows its own circle.
    let (way, spot, _) = circles(0.4, 0.3, [0.0, 0.0], true);
    assert!(way < 18.0 && spot < -0.5, "{way} {spot}");
    // Above the origin a gyro is not needed, but without one the course lags in a bend.
    let (way, _, _) = circles(0.0, 0.0, [0.0, 0.0], false);
    assert!((way - 19.9).abs() < 0.3, "{way}");
}

#[test]
fn another_kind_of_solution_and_an_outage_are_no_motion() {
    let mut track = Track::default();
    let mut step = |time_s: i64, north: f64, variance: f64| {
        let fix = NavSatFix {
            variance: Some(variance),
            ..at(0.0, north)
        };
        let found = track.take_fix(time_s * 1_000_000_000, &fix)[1]?;
        let Measurement::Displacement { forward, .. } = found else {
            return None;
        };
        Some(forward)
    };
    for second in 0..10 {
        step(second, second as f64, 4e-4);
    }
    assert!((step(10, 10.0, 4e-4).unwrap() - 1.0).abs() < 0.01);
    // From fixed to float the position jumps by half a metre; then it goes on.
    assert_eq!(step(11, 11.5, 0.09), None);
    assert!((step(12, 12.5, 0.09).unwrap() - 1.0).abs() < 0.01);
    // An outage of eight seconds.
    assert_eq!(step(20, 20.5, 0.09), None);
    assert!((step(21, 21.5, 0.09).unwrap() - 1.0).abs() < 0.01);
}

#[test]
fn bad_fixes_are_named() {
    assert_eq!(fix(45.0, 9.0).fault(ACCURATE_SIGMA_M), None);
    assert!(fix(91.0, 9.0).fault(ACCURATE_SIGMA_M).is_some());
    // an altitude alone
    assert!(fix(f64::NAN, f64::NAN).fault(ACCURATE_SIGMA_M).is_some());
    let none = NavSatFix {
        is_fixed: false,
        ..fix(45.0, 9.0)
    };
    assert!(none.fault(ACCURATE_SIGMA_M).is_some());
    let wide = NavSatFix {
        variance: Some(100.0),
        ..fix(45.0, 9.0)
    };
    assert!(wide.fault(ACCURATE_SIGMA_M).is_some());
    // up to 10 m of a receiver that has no better
    for (variance, limit, is_used) in [
        (100.0, MAX_SIGMA_M, true),
        (100.1, MAX_SIGMA_M, false),
        (f64::INFINITY, MAX_SIGMA_M, false),
        (0.25, ACCURATE_SIGMA_M, true),
        (0.26, ACCURATE_SIGMA_M, false),
    ] {
        let poor = NavSatFix {
            variance: Some(variance),
            ..fix(45.0, 9.0)
        };
        assert_eq!(poor.fault(limit).is_none(), is_used, "{variance} {limit}");
    }
    // the equator, and the meridian of Greenwich; where they meet none is
    for (latitude, longitude, is_used) in [(0.0, 7.5, true), (51.5, 0.0, true), (0.0, 0.0, false)] {
        let fault = fix(latitude, longitude).fault(ACCURATE_SIGMA_M);
        assert_eq!(fault.is_none(), is_used, "{latitude} {longitude}");
    }
    // an unknown covariance is not exact
    let unknown = NavSatFix {
        status: 0,
        ..fix(45.0, 9.0)
    };
    assert!(unknown.fault(ACCURATE_SIGMA_M).is_some() && unknown.sigma() > 1.0);
}

const S: i64 = 1_000_000_000;

#[test]
fn places_are_on_the_ellipsoid() {
    // NIMA TR8350.2: the semi-minor axis, m
    let (a, b) = (SEMI_MAJOR_M, 6_356_752.314_245);
    let place = |latitude: f64, longitude: f64, altitude: f64| {
        NavSatFix {
            altitude,
            ..fix(latitude, longitude)
        }
        .place()
    };
    let close = |found: [f64; 3], expected: [f64; 3]| {
        let far = found
            .iter()
            .zip(expected)
            .any(|(a, b)| (a - b).abs() > 1e-6);
        assert!(!far, "{found:?} {expected:?}");
    };
    close(place(0.0, 0.0, 0.0), [a, 0.0, 0.0]);
    close(place(0.0, 90.0, 50.0), [0.0, a + 50.0, 0.0]);
    close(place(-90.0, 7.0, 20.0), [0.0, 0.0, -b - 20.0]);
    close(place(0.0, 180.0, f64::NAN), [-a, 0.0, 0.0]);
    for (latitude, longitude) in [(45.0, 9.0), (-33.0, -70.0), (12.0, 130.0)] {
        let low = place(latitude, longitude, 0.0);
        let [x, y, z] = low;
        assert!(((x * x + y * y) / (a * a) + z * z / (b * b) - 1.0).abs() < 1e-13);
        // the latitude is that of the normal, along which the altitude counts
        let normal = [x / (a * a), y / (a * a), z / (b * b)];
        let size = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
        assert!(((normal[2] / size).asin() - latitude.to_radians()).abs() < 1e-12);
        assert!((y.atan2(x) - longitude.to_radians()).abs() < 1e-12);
        let up: [f64; 3] = std::array::from_fn(|i| low[i] + 100.0 * normal[i] / size);
        close(place(latitude, longitude, 100.0), up);
    }
}

#[test]
fn the_plane_touches_the_first_fix() {
    let e2 = ECCENTRICITY_2;
    for (latitude, longitude) in [(45.0_f64, 9.0), (-33.0, -70.0)] {
        // radii of curvature along the meridian and across it, m
        let root = (1.0 - e2 * latitude.to_radians().sin().powi(2)).sqrt();
        let across = SEMI_MAJOR_M / root + 100.0;
        let along = SEMI_MAJOR_M * (1.0 - e2) / root.powi(3) + 100.0;
        let mut track = Track::default();
        assert_eq!(track.on_plane(&fix(latitude, longitude)), [0.0, 0.0]);
        let turn = 1e-5_f64.to_radians();
        let [east, north] = track.on_plane(&fix(latitude + 1e-5, longitude));
        assert!(east.abs() < 1e-6 && (north - along * turn).abs() < 1e-6);
        let [east, north] = track.on_plane(&fix(latitude, longitude - 1e-5));
        let expected = -across * latitude.to_radians().cos() * turn;
        assert!((east - expected).abs() < 1e-6 && north.abs() < 1e-6);
    }
}

#[test]
fn faults_begin_behind_their_limits() {
    let with = |status, variance| NavSatFix {
        status,
        variance,
        ..fix(-90.0, 180.0)
    };
    assert_eq!(
        [2, 1, 0].map(|status| with(status, None).sigma()),
        [0.02, 1.0, 2.5]
    );
    assert_eq!(with(0, Some(0.0625)).sigma(), 0.25);
    assert_eq!(with(2, Some(0.25)).fault(ACCURATE_SIGMA_M), None);
    assert!(
        with(2, Some(0.26))
            .fault(ACCURATE_SIGMA_M)
            .unwrap()
            .contains("standard deviation")
    );
    assert!(with(2, Some(f64::NAN)).fault(ACCURATE_SIGMA_M).is_some());
    for (latitude, longitude) in [(90.1, 0.0), (0.0, -180.1), (0.0, f64::NAN)] {
        let fault = fix(latitude, longitude).fault(ACCURATE_SIGMA_M).unwrap();
        assert!(fault.contains("out of range"), "{fault}");
    }
    let none = NavSatFix {
        is_fixed: false,
        ..with(2, None)
    };
    assert!(
        none.fault(ACCURATE_SIGMA_M)
            .unwrap()
            .contains("without a position")
    );
}

#[test]
fn the_first_fixes_choose_a_standard_deviation() {
    let of = |variance| NavSatFix {
        variance,
        ..fix(45.0, 9.0)
    };
    let choose = |groups: &[(usize, Option<f64>)]| {
        let mut fixes = Fixes::default();
        for (count, variance) in groups {
            let one = of(*variance);
            (0..*count).for_each(|_| fixes.add(&one));
        }
        let (found, note) = fixes.choose("/fix");
        (found.map(|(sigma, _)| sigma), note.unwrap_or_default())
    };
    // one fix more than are looked at would change the median
    let (half, wide, wider) = (MAX_FIXES / 2, Some(1.0), Some(4.0));
    assert_eq!(
        choose(&[(half, wider), (half, wide), (1, wide)]).0,
        Some(2.0)
    );
    assert_eq!(
        choose(&[(half, wider), (half - 1, wide), (1, wide)]).0,
        Some(2.0)
    );
    assert_eq!(choose(&[(half - 1, wider), (half + 1, wide)]).0, Some(1.0));
    // up to half a metre there is no note; how accurate they are is unknown if more than half do not say it
    assert_eq!(choose(&[(3, Some(0.25))]), (Some(0.5), String::new()));
    assert!(choose(&[(3, Some(0.26))]).1.contains("has fixes with"));
    let unknown = |stated, unstated| {
        let unstated_fix = NavSatFix {
            status: 0,
            ..of(None)
        };
        let mut fixes = Fixes::default();
        (0..stated).for_each(|_| fixes.add(&of(Some(9.0))));
        (0..unstated).for_each(|_| fixes.add(&unstated_fix));
        fixes.choose("/fix").1.unwrap().contains("does not say")
    };
    assert!(!unknown(2, 2) && unknown(2, 3) && !unknown(3, 2) && unknown(0, 1));
    assert_eq!(Fixes::default().choose("/fix").0, None);
}

#[test]
fn turns_are_summed_and_read_between() {
    let mut track = Track::default();
    assert_eq!(track.turn_at(5), None);
    let close = |found: Option<f64>, expected: f64| {
        assert!(
            (found.unwrap() - expected).abs() < 1e-12,
            "{found:?} {expected}"
        );
    };
    track.turn(S, 0.2);
    track.turn(S + S / 10, f64::NAN);
    track.turn(S + S / 5, 0.6);
    // the mean of both rates for 0.2 s
    close(track.turn_at(S + S / 5), 0.08);
    close(track.turn_at(S), 0.0);
    close(track.turn_at(S + S / 20), 0.02);
    // beside the readings the last rate holds, for less than half a second
    close(track.turn_at(S + S / 5 + S / 4), 0.08 + 0.6 * 0.25);
    close(track.turn_at(S - S / 4), -0.6 * 0.25);
    assert_eq!(track.turn_at(S + S / 5 + S / 2), None);
    assert_eq!(track.turn_at(S - S / 2), None);
    // what is not later is left out, but its rate is the newest
    track.turn(S + S / 5, 0.4);
    close(track.turn_at(S + S / 5), 0.08);
    track.turn(S + 2 * (S / 5), 0.4);
    close(track.turn_at(S + 2 * (S / 5)), 0.16);
    let readings = track.turns.len();
    for earlier in [0, 1] {
        track.turn(S + 2 * (S / 5) - earlier, 0.4);
    }
    assert_eq!(track.turns.len(), readings);
    // after half a second of silence nothing is known
    let now = Placed {
        time_ns: S,
        place: [1.0, 2.0],
        turn: Some(0.1),
        sigma: 0.02,
    };
    (track.heading, track.anchor, track.last) =
        (Some(Heading::new(0.5, 0.1)), Some(now), Some(now));
    track.turn(S + 2 * (S / 5) + S / 2 - 1, 0.4);
    assert!(track.heading.is_some());
    track.turn(2 * S + 2 * (S / 5) - 1, 0.4);
    assert!(track.heading.is_none() && track.anchor.is_none() && track.last.is_none());
    close(track.turn_at(2 * S + 2 * (S / 5) - 1), 0.0);
    assert_eq!(track.turns.len(), 1);
    for step in 0..3000 {
        track.turn(3 * S + step * 1_000_000, 0.1);
    }
    assert_eq!(track.turns.len(), MAX_TURNS);
}

/// A track with a known heading that was at the middle of its plane a second ago.
fn known(antenna: [f64; 2], heading: f64, turn: Option<f64>) -> Track {
    let mut track = Track::new(antenna);
    track.on_plane(&at(0.0, 0.0));
    let last = Placed {
        time_ns: 0,
        place: [0.0; 2],
        turn,
        sigma: 0.02,
    };
    (track.last, track.anchor) = (Some(last), Some(last));
    track.heading = Some(Heading::new(heading, 1e-3));
    track
}

#[test]
fn a_way_is_turned_into_the_robots_frame() {
    let displaced = |track: &mut Track, time_ns, fix: &NavSatFix| {
        let found = track.take_fix(time_ns, fix)[1]?;
        let Measurement::Displacement {
            forward,
            left,
            turn,
        } = found
        else {
            panic!("{found:?}")
        };
        assert_eq!(turn, None);
        Some((forward, left))
    };
    // less than a course
    let mut track = known([0.0; 2], 0.6, None);
    let (forward, left) = displaced(&mut track, S, &at(0.1, 0.05)).unwrap();
    let (sin, cos) = 0.6_f64.sin_cos();
    let [east, north] = track.on_plane(&at(0.1, 0.05));
    assert!(
        (forward - (east * cos + north * sin)).abs() < 1e-15,
        "{forward}"
    );
    assert!((left - (north * cos - east * sin)).abs() < 1e-15, "{left}");
    // the variance grows by 0.5² rad² a second without a gyro, by 0.005² with one, and by its bias of 0.02 rad/s
    assert!((track.heading.unwrap().angle_variance - 1e-3 - 0.25).abs() < 1e-12);
    assert_eq!(track.anchor.unwrap().place, [0.0; 2]);
    let mut track = known([0.0; 2], 0.6, Some(0.0));
    track.turn(0, 0.0);
    displaced(&mut track, S / 4, &at(0.1, 0.05)).unwrap();
    let grown = 0.25 * 2.5e-5 + (0.25 * 0.02) * (0.25 * 0.02);
    assert!((track.heading.unwrap().angle_variance - 1e-3 - grown).abs() < 1e-15);
    // on the spot the antenna moves and the robot does not
    for antenna in [[0.4, 0.3], [-0.2, 0.1]] {
        let mut track = known(antenna, 0.6, Some(0.1));
        let [from, to] = [0.1, 0.5].map(|turn: f64| {
            let (sin, cos) = (0.6 + turn).sin_cos();
            [
                cos * antenna[0] - sin * antenna[1],
                sin * antenna[0] + cos * antenna[1],
            ]
        });
        track.turns = [(0, 0.1), (S, 0.5)].into();
        let fix = at(to[0] - from[0], to[1] - from[1]);
        let place = track.on_plane(&fix);
        track.last.as_mut().unwrap().place = [0, 1].map(|i| place[i] - (to[i] - from[i]));
        // the course of this way is not taken
        track.anchor = Some(Placed {
            time_ns: S,
            place,
            turn: Some(0.5),
            sigma: 0.02,
        });
        let (forward, left) = displaced(&mut track, S, &fix).unwrap();
        assert!(
            forward.abs() < 1e-15 && left.abs() < 1e-15,
            "{forward} {left}"
        );
    }
    // a course is taken over 0.2 m or four standard deviations, and corrects the heading before it is used
    for (way, deviation, is_taken) in [
        (0.199, 0.02, false),
        (0.201, 0.02, true),
        (0.239, 0.06, false),
        (0.241, 0.06, true),
    ] {
        let mut track = known([0.0; 2], 0.3, None);
        let fix = NavSatFix {
            variance: Some(deviation * deviation),
            ..at(way, 0.0)
        };
        displaced(&mut track, S, &fix).unwrap();
        let heading = track.heading.unwrap().angle;
        assert_eq!(heading < 0.2, is_taken, "{way}: {heading}");
        assert_eq!(track.anchor.unwrap().place != [0.0; 2], is_taken);
    }
    // what goes on
    let goes_on = |time_ns: i64, deviation: f64, turns: &[(i64, f64)]| {
        let mut track = known([0.0; 2], 0.3, None);
        track.last.as_mut().unwrap().sigma = 0.25;
        track.turns = turns.iter().copied().collect();
        let fix = NavSatFix {
            variance: Some(deviation * deviation),
            ..at(0.1, 0.0)
        };
        let found = displaced(&mut track, time_ns, &fix).is_some();
        assert_eq!(
            track.anchor.unwrap().time_ns == time_ns,
            !found || time_ns == 0
        );
        assert_eq!(track.last.unwrap().time_ns, time_ns);
        found
    };
    assert!(goes_on(S, 0.75, &[]) && goes_on(S, 0.0834, &[]));
    assert!(!goes_on(S, 0.76, &[]) && !goes_on(S, 0.083, &[]));
    assert!(goes_on(5 * S - 1, 0.25, &[]) && !goes_on(5 * S, 0.25, &[]));
    assert!(goes_on(1, 0.25, &[]) && !goes_on(0, 0.25, &[]) && !goes_on(-1, 0.25, &[]));
    // a gyro that is there from now on
    assert!(!goes_on(S, 0.25, &[(S, 0.0)]));
}

/// A straight drive to the north-east at 0.5 m/s beside a gyro that says that it turns.
#[test]
fn courses_show_the_bias_of_the_gyro() {
    for bias in [0.05, -0.02] {
        let mut track = Track::default();
        let mut aside = 0.0_f64;
        for step in 0..6000_i64 {
            let time_ns = step * 10_000_000;
            track.turn(time_ns, bias);
            if step % 20 != 0 {
                continue;
            }
            let way = 0.005 * step as f64 * std::f64::consts::FRAC_1_SQRT_2;
            let place = [way, way];
            let [position, moved] = track.take(time_ns, place, 0.01);
            let [x, y] = place;
            assert_eq!(position, Some(Measurement::Position { x, y }));
            if let Some(Measurement::Displacement { forward, left, .. }) = moved
                && step > 3000
            {
                aside = aside.max(left.atan2(forward).abs());
            }
        }
        let heading = track.heading.unwrap();
        assert!(
            (heading.bias - bias).abs() < 0.1 * bias.abs(),
            "{bias}: {heading:?}"
        );
        assert!(aside < 0.02, "{bias}: {aside}");
    }
}

/// The place of the robot's origin by an antenna 0.4 m ahead of it and 0.3 m to the left, which looks to the west.
#[test]
fn the_place_of_an_antenna_is_not_that_of_the_robot() {
    let mut track = known([0.4, 0.3], std::f64::consts::PI, None);
    let [position, _] = track.take(S, [0.1, 0.05], 0.02);
    let Some(Measurement::Position { x, y }) = position else {
        panic!("{position:?}")
    };
    assert!(
        (x - 0.5).abs() < 1e-12 && (y - 0.35).abs() < 1e-12,
        "{x} {y}"
    );
    assert_eq!(Track::new([0.4, 0.3]).take(S, [5.0, 7.0], 0.02), [None; 2]);
}

/// The same while a gyro has turned the robot on since its heading was known.
#[test]
fn a_gyro_turns_the_antenna_between_places() {
    let mut track = known([0.4, 0.3], 0.3, None);
    for tenth in 0..=10 {
        track.turn(tenth * S / 10, 0.2);
    }
    let Some(Measurement::Position { x, y }) = track.origin_at(S, [5.0, 7.0]) else {
        panic!("a place")
    };
    let (sin, cos) = f64::sin_cos(0.5);
    assert!((x - (5.0 - 0.4 * cos + 0.3 * sin)).abs() < 1e-12, "{x}");
    assert!((y - (7.0 - 0.4 * sin - 0.3 * cos)).abs() < 1e-12, "{y}");
    for place in [[f64::NAN, 7.0], [5.0, f64::NAN]] {
        assert_eq!(track.origin_at(S, place), None);
    }
}

/// An angle whose rate has an error and wanders, over two seconds: P ← F P Fᵀ + Q.
#[test]
fn a_heading_is_predicted_beside_its_bias() {
    let mut heading = Heading {
        angle: 1.0,
        bias: 0.1,
        angle_variance: 0.01,
        bias_variance: 0.04,
        covariance: 0.003,
    };
    heading.predict(2.0, true);
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-15, "{found}");
    near(heading.angle, 0.8);
    near(heading.bias, 0.1);
    let noise = 2.0 * GYRO_NOISE_RAD_SQRT_S * GYRO_NOISE_RAD_SQRT_S;
    near(
        heading.angle_variance,
        0.01 - 4.0 * 0.003 + 4.0 * 0.04 + noise,
    );
    near(heading.covariance, 0.003 - 2.0 * 0.04);
    let drift = 2.0 * GYRO_DRIFT_RAD_PER_S * GYRO_DRIFT_RAD_PER_S;
    near(heading.bias_variance, 0.04 + drift);
    let before = heading.angle_variance;
    heading.predict(2.0, false);
    let noise = 2.0 * TURN_NOISE_RAD_SQRT_S * TURN_NOISE_RAD_SQRT_S;
    near(heading.angle_variance, before + noise);
    near(heading.angle, 0.8);
}
