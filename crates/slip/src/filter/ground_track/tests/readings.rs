//! Poses, headings and displacements as they are used and refused.

use super::*;

/// Uses a pose; returns what became of it.
fn pose(ground: &mut GroundTrack, place: [f64; 2], taken_ns: i64) -> Outcome {
    let [x, y] = place;
    let measurement = Measurement::Pose {
        x,
        y,
        yaw: HEADING_RAD,
    };
    ground.update(taken_ns, &measurement, (taken_ns, true), &settings())
}

#[test]
fn a_place_is_used_once_and_not_too_soon_after_the_last() {
    // 0.1 s less half a step
    const LEAST_NS: i64 = 97_500_000;
    let other = [PLACE_M[0] + 0.001, PLACE_M[1]];
    let mut ground = started();
    ground.has_rims = false;
    assert_eq!(pose(&mut ground, PLACE_M, NOW_NS), Outcome::Unused);
    ground.has_rims = true;
    assert_eq!(pose(&mut ground, PLACE_M, NOW_NS), Outcome::Accepted);
    assert_eq!(
        (ground.period_s, ground.used_ns),
        (POSITION_PERIOD_S, Some(NOW_NS))
    );
    let after = |place, passed_ns: i64| {
        let mut ground = ground.clone();
        let outcome = pose(&mut ground, place, NOW_NS + passed_ns);
        assert_eq!(
            (ground.received_ns, ground.position),
            (Some(NOW_NS + passed_ns), place)
        );
        outcome
    };
    assert_eq!(after(other, LEAST_NS - 1), Outcome::Unused);
    assert_eq!(after(other, LEAST_NS), Outcome::Accepted);
    // the same place to the bit is no reading of a robot that moves, one that differs in a part is
    assert_eq!(after(PLACE_M, LEAST_NS), Outcome::Unused);
    assert_eq!(
        after([PLACE_M[0], PLACE_M[1] + 0.001], LEAST_NS),
        Outcome::Accepted
    );
    // of one that hardly moves it is, and from then on also where it moves: poses without a new number
    for (rim, repeats) in [
        (TURNING_SPEED_M_PER_S.next_up(), false),
        (TURNING_SPEED_M_PER_S, true),
        (-0.5, false),
    ] {
        let mut ground = ground.clone();
        ground.rim_speed = rim;
        pose(&mut ground, PLACE_M, NOW_NS + LEAST_NS);
        assert_eq!(ground.repeats_at_rest, repeats, "{rim}");
        ground.rim_speed = RIM_M_PER_S;
        let outcome = pose(&mut ground, PLACE_M, NOW_NS + 2 * LEAST_NS);
        assert_eq!(outcome == Outcome::Accepted, repeats, "{rim}");
    }
    // another place does not repeat, nor at rest; a second repetition changes nothing
    ground.rim_speed = 0.0;
    for (step, place, repeats) in [(1, other, false), (2, other, true), (3, other, true)] {
        pose(&mut ground, place, NOW_NS + LEAST_NS * step);
        assert_eq!(ground.repeats_at_rest, repeats, "{step}");
    }
    // models that had started before the clock was set start again
    ground.started_ns = None;
    pose(&mut ground, PLACE_M, NOW_NS + 4 * LEAST_NS);
    assert_eq!(ground.started_ns, Some(NOW_NS + 4 * LEAST_NS));
}

#[test]
fn the_period_is_a_fading_mean_and_an_outage_is_many_of_it() {
    let mut first = started();
    pose(&mut first, PLACE_M, NOW_NS);
    first.period_s = 0.0;
    let mut ground = first.clone();
    pose(&mut ground, PLACE_M.map(|x| x + 0.001), NOW_NS + 200 * MS);
    assert!(near(ground.period_s, 0.2));
    pose(&mut ground, PLACE_M, NOW_NS + 500 * MS);
    assert!(near(ground.period_s, 0.2 + 0.2 * (0.3 - 0.2)));
    // after 2.5 periods and beyond dropout time and failure, 0.4 s, a place that was not predicted returns with a reservation
    let after = |period_s: f64, passed_ns: i64, off: f64| {
        let mut ground = first.clone();
        ground.period_s = period_s;
        pose(
            &mut ground,
            [PLACE_M[0] + off, PLACE_M[1]],
            NOW_NS + passed_ns,
        );
        (ground.readmitted_ns.is_some(), ground.period_s == period_s)
    };
    assert_eq!(after(0.1, 400 * MS, 9.0), (false, false));
    assert_eq!(after(0.1, 401 * MS, 9.0), (true, true));
    assert_eq!(after(0.2, 500 * MS, 9.0), (false, false));
    assert_eq!(after(0.2, 501 * MS, 9.0), (true, true));
    assert_eq!(after(0.0, 501 * MS, 9.0), (false, false));
    // one that was predicted without, up to five seconds
    assert_eq!(after(0.2, 5_000 * MS, 0.001), (false, true));
    assert_eq!(after(0.2, 5_000 * MS + 1, 0.001), (true, true));
    // the robot may have moved by the rims' way since
    let variance = |ground: &GroundTrack| {
        let agreement = |off: f64| {
            ground
                .models
                .position_agreement([PLACE_M[0] + off, PLACE_M[1]], [0.0; 4], 0.01)
        };
        agreement(1.0)
    };
    let mut wide = first.clone();
    wide.end_outage((6.0, NOW_NS), PLACE_M, [0.0; 4], &settings());
    let mut models = first.clone();
    models.models.inflate_position(6.0 * RIM_M_PER_S);
    assert_eq!(variance(&wide), variance(&models));
    assert!(variance(&wide) > 2.0 * variance(&first));
}

#[test]
fn refused_places_are_remembered_from_the_first_and_readmitted_after_the_failure_time() {
    let mut ground = started();
    pose(&mut ground, PLACE_M, NOW_NS);
    ground.models.advance(&wheel_step(0.004));
    let far = |index: i64| [PLACE_M[0] + 5.0 + 0.01 * index as f64, PLACE_M[1]];
    for index in 1..4 {
        let taken_ns = NOW_NS + 100 * MS * index;
        assert_eq!(pose(&mut ground, far(index), taken_ns), Outcome::Refused);
        let first = (far(1), 0.004, NOW_NS + 100 * MS);
        assert_eq!(
            (
                ground.refused_position,
                ground.refused_way,
                ground.refused_ns
            ),
            first
        );
        assert_eq!(ground.accepted_ns, Some(NOW_NS));
    }
    // two of them at 0.25 s took no longer than 0.5 s
    let patient = FilterSettings {
        failure: 0.5,
        ..settings()
    };
    for (refused, passed_ms, is_readmitted) in [(0, 250, false), (2, 250, false), (2, 251, true)] {
        let mut ground = started();
        pose(&mut ground, PLACE_M, NOW_NS);
        for _ in 0..refused {
            ground.refused.accepts(0.0);
        }
        let taken_ns = NOW_NS + passed_ms * MS;
        let next = Measurement::Pose {
            x: PLACE_M[0] + 0.001,
            y: PLACE_M[1],
            yaw: HEADING_RAD,
        };
        let outcome = ground.update(taken_ns, &next, (taken_ns, true), &patient);
        assert_eq!(outcome, Outcome::Accepted);
        assert_eq!(ground.readmitted_ns, is_readmitted.then_some(taken_ns));
    }
    // a slide goes on from its first place
    let mut ground = started();
    pose(&mut ground, PLACE_M, NOW_NS);
    ground.rim_speed = 0.0;
    ground.refused_ns = NOW_NS - 2_000 * MS;
    pose(&mut ground, far(1), NOW_NS + 100 * MS);
    assert_eq!(ground.refused_ns, NOW_NS - 2_000 * MS);
}

#[test]
fn displacements_are_summed_at_their_mean_heading_and_without_their_outliers() {
    let mut ground = started();
    ground.summed = [0.3, -0.2, 0.5];
    let displaced = |turn| Measurement::Displacement {
        forward: 0.7,
        left: 0.1,
        turn,
    };
    let times = (NOW_NS, NOW_NS);
    let turned = ([0.0, 0.0, 1.4, 0.0], [0.0, 0.0, 0.6, 0.0]);
    for (turn, by) in [(Some(0.4), 0.4), (None, 1.4 - 0.6 - 0.5)] {
        let mut ground = ground.clone();
        let place = ground.place_by(&displaced(turn), times, turned, &settings());
        let ([x, y], heading, sigma) = place.unwrap();
        let middle = 0.5 + by / 2.0;
        assert!(near(
            x,
            0.3 + 0.7 * f64::cos(middle) - 0.1 * f64::sin(middle)
        ));
        assert!(near(
            y,
            -0.2 + 0.7 * f64::sin(middle) + 0.1 * f64::cos(middle)
        ));
        assert!(near(heading.unwrap(), 0.5 + by) && near(sigma, SUMMED_HEADING_SIGMA_RAD));
        assert_eq!(ground.summed, [x, y, heading.unwrap()]);
    }
    // the sum of one that is refused goes on from the models' place
    let jump = Measurement::Displacement {
        forward: 9.0,
        left: 0.0,
        turn: Some(0.1),
    };
    ground.used_ns = Some(NOW_NS - 100 * MS);
    let outcome = ground.update(NOW_NS, &jump, (NOW_NS, true), &settings());
    assert_eq!(outcome, Outcome::Refused);
    let [x, y] = ground.models.place([0.0; 4]);
    assert!(near(ground.summed[0], x) && near(ground.summed[1], y) && near(ground.summed[2], 0.6));
    // a refused pose is no sum
    let mut ground = started();
    pose(&mut ground, PLACE_M, NOW_NS);
    pose(&mut ground, [9.0, 9.0], NOW_NS + 100 * MS);
    assert_eq!(ground.summed, [0.0; 3]);
    // a speed is no place
    let speed = Measurement::Speed {
        forward: 0.1,
        left: None,
    };
    assert!(
        ground
            .place_by(&speed, times, turned, &settings())
            .is_none()
    );
}

#[test]
fn a_pose_has_a_heading_once_that_has_changed() {
    // 0.05 rad to the bit is no change
    for poses in [
        &[
            (0.0, false),
            (-0.05, false),
            (0.04, false),
            (0.06, true),
            (0.0, true),
        ][..],
        &[(0.3, false), (0.34, false), (0.26, false), (0.24, true)],
    ] {
        let mut ground = started();
        ground.heading_offset = 0.7;
        for &(yaw, has_heading) in poses {
            let (x, y) = (1.0, 2.0);
            let pose = Measurement::Pose { x, y, yaw };
            let place = ground.place_by(&pose, (0, 0), ([0.0; 4], [0.0; 4]), &settings());
            let expected = ([x, y], Some(yaw + 0.7), MEASURED_HEADING_SIGMA_RAD);
            assert_eq!(
                (place, ground.has_heading),
                (Some(expected), has_heading),
                "{yaw}"
            );
        }
    }
}

#[test]
fn headings_are_used_beside_a_gyro_until_they_were_wrong_twice() {
    for (has_gyro, restarts, is_used) in [(true, 1, true), (true, 2, false), (false, 2, true)] {
        let mut ground = started();
        ground.restarts = restarts;
        let [x, y] = PLACE_M;
        let measurement = Measurement::Pose {
            x,
            y,
            yaw: HEADING_RAD,
        };
        ground.update(NOW_NS, &measurement, (NOW_NS, has_gyro), &settings());
        assert_eq!(
            ground.agreed_headings,
            u32::from(is_used),
            "{has_gyro} {restarts}"
        );
    }
}

/// Headings of an uneven turn, each taken one step before it is used: beside the turn until it was taken they are exact.
#[test]
fn a_heading_is_compared_with_the_turn_until_it_was_taken() {
    let mut ground = started();
    for index in 0..90_i64 {
        let taken_ns = NOW_NS + 100 * MS * index;
        let taken = ground.models.totals();
        ground.history.push(taken_ns, taken);
        let turn = [0.05, -0.02, 0.11, 0.0][usize::try_from(index % 4).unwrap()];
        ground.models.advance(&WheelStep {
            turn,
            ..wheel_step(0.0)
        });
        ground
            .history
            .push(taken_ns + 50 * MS, ground.models.totals());
        ground.stepped_ns = Some(taken_ns + 50 * MS);
        let [x, y] = PLACE_M.map(|x| x + 1e-3 * (index % 7) as f64);
        let pose = Measurement::Pose {
            x,
            y,
            yaw: HEADING_RAD + taken[2],
        };
        ground.update(taken_ns, &pose, (taken_ns + 50 * MS, true), &settings());
    }
    let sigma = ground.heading_noise.sigma(1.0);
    assert!(sigma < 1e-3, "{sigma}");
}

#[test]
fn headings_of_displacements_let_the_heading_wander() {
    let mut ground = started();
    let before = ground.models.heading_sigma();
    let sigma = ground.heading_sigma((0.1, 0.03), Errors::Independent);
    assert!(near(sigma, 0.03) && near(ground.models.heading_sigma(), before));
    ground.heading_sigma((0.1, 0.03), Errors::Summed);
    assert!(ground.models.heading_sigma() > before + 1e-6);
}

#[test]
fn places_without_a_heading_are_turned_by_the_course() {
    let position = |ground: &mut GroundTrack, [x, y]: [f64; 2], taken_ns: i64| {
        let measurement = Measurement::Position { x, y };
        let state = (ground.models.totals(), [0.0; 4]);
        ground.place_by(&measurement, (taken_ns, taken_ns + MS), state, &settings())
    };
    for started_ns in [None, Some(NOW_NS - MS)] {
        let mut ground = started();
        (ground.started_ns, ground.used_ns) = (started_ns, Some(NOW_NS));
        assert!(position(&mut ground, [10.0, 5.0], NOW_NS).is_none());
        assert_eq!((ground.accepted_ns, ground.used_ns), (None, None));
        // the models begin anew at their origin, and poses at the same places are not used
        assert!(ground.places.has_begun() && ground.models.place([0.0; 4]) == [0.0; 2]);
        let state = ([0.0; 4], [0.0; 4]);
        let pose = Measurement::Pose {
            x: 0.0,
            y: 0.0,
            yaw: 0.0,
        };
        assert!(ground.place_by(&pose, (0, 0), state, &settings()).is_none());
        for _ in 0..200 {
            let turn = 0.0;
            ground.models.advance(&WheelStep {
                turn,
                ..wheel_step(0.005)
            });
        }
        // a metre of rims along their direction is 0.9 m by the prior slip; the places went as far along y
        let [x, y] = ground.models.place([0.0; 4]);
        let way = f64::hypot(x, y);
        let taken_ns = NOW_NS + 1_000 * MS;
        let (place, yaw, _) = position(&mut ground, [10.0, 5.0 + way], taken_ns).unwrap();
        assert!((place[0] - x).abs() < 1e-9 && (place[1] - y).abs() < 1e-9 && yaw.is_none());
        assert_eq!(
            (ground.started_ns, ground.used_ns),
            (Some(taken_ns + MS), Some(taken_ns))
        );
        assert_eq!(ground.readmitted_ns, started_ns.map(|_| taken_ns + MS));
        // from then on a place is one at once, but after an outage with an uncertain heading
        for (heading_sigma, passed_ns, is_lost) in [
            (0.31, 5_000 * MS + 1, true),
            (0.31, 5_000 * MS, false),
            (0.29, 5_000 * MS + 1, false),
        ] {
            let mut ground = ground.clone();
            ground.models.start([0.0; 2], 0.0, 0.01, heading_sigma);
            let place = position(&mut ground, [10.0, 6.0], taken_ns + passed_ns);
            assert_eq!(
                (place.is_none(), ground.used_ns.is_none()),
                (is_lost, is_lost)
            );
        }
        // and where the models begin anew
        ground.models.restart();
        assert!(position(&mut ground, [10.0, 6.0], taken_ns).is_none() && ground.used_ns.is_none());
    }
}
