use super::*;
use crate::robot::{Robot, Wheel};
use grouser_terra::Angle;

mod readings;

pub(super) const MS: i64 = 1_000_000;
pub(super) const NOW_NS: i64 = 9_000 * MS;
/// Direction of the rims beside the robot's heading, rad, and their speed, m/s.
pub(super) const DIRECTION_RAD: f64 = 0.4;
pub(super) const RIM_M_PER_S: f64 = 0.5;
/// The slip of the models, and the prior that it fades into.
const SLIP_AND_SIGMA: [f64; 2] = [0.3, 0.05];
const PRIOR_AND_SIGMA: [f64; 2] = [0.1, 0.2];
pub(super) const HEADING_RAD: f64 = 0.6;
/// 1.3 periods of 0.3 s.
const LATE_NS: i64 = 390 * MS;
/// The least step later.
const READ_NS: i64 = NOW_NS + 5 * MS;
pub(super) const PLACE_M: [f64; 2] = [2.0, -1.0];

pub(super) fn settings() -> FilterSettings {
    FilterSettings::default()
}

pub(super) fn wheel_step(rim_way: f64) -> WheelStep {
    WheelStep {
        dt: 0.01,
        rim_way,
        direction: DIRECTION_RAD,
        turn: 0.002,
        turn_error: TurnError::default(),
        curvature: None,
        acceleration: None,
        rim: Rim {
            speed: RIM_M_PER_S,
            variance: 1e-4,
            lag: 0.025,
            rise: 0.0,
            gained: 0.0,
        },
        max_slip: 1.0,
    }
}

/// Models that have started at a place with a slip.
pub(super) fn started() -> GroundTrack {
    let mut ground = *GroundTrack::boxed(&settings());
    ground.models.advance(&wheel_step(0.005));
    ground.models.set_slip_prior(SLIP_AND_SIGMA);
    ground.models.start(PLACE_M, HEADING_RAD, 0.01, 0.02);
    ground.models.set_slip_prior(PRIOR_AND_SIGMA);
    ground.direction = DIRECTION_RAD;
    ground.rim_speed = RIM_M_PER_S;
    ground.has_rims = true;
    ground.stepped_ns = Some(NOW_NS);
    ground.accepted_ns = Some(NOW_NS);
    ground.started_ns = Some(NOW_NS);
    ground
}

pub(super) fn near(value: f64, expected: f64) -> bool {
    (value - expected).abs() < 1e-12
}

const fn posed(stamp_ns: i64) -> Awaiting {
    (
        stamp_ns,
        Measurement::Pose {
            x: 0.0,
            y: 0.0,
            yaw: 0.0,
        },
        None,
    )
}

#[test]
fn readings_wait_in_their_order_and_of_places_of_one_queue_the_last() {
    const STAMP_NS: i64 = 7_000 * MS;
    // a tenth of a period of 0.25 s
    const QUEUE_NS: i64 = 25 * MS;
    let displaced = |stamp_ns| {
        let measurement = Measurement::Displacement {
            forward: 0.1,
            left: 0.0,
            turn: None,
        };
        (stamp_ns, measurement, None)
    };
    let mut ground = *GroundTrack::boxed(&settings());
    ground.period_s = 0.25;
    assert_eq!(ground.last_awaiting_ns(), None);
    assert!(ground.put_off(posed(STAMP_NS)));
    assert!(ground.put_off(posed(STAMP_NS + QUEUE_NS - 1)));
    assert_eq!(ground.last_awaiting_ns(), Some(STAMP_NS + QUEUE_NS - 1));
    let second = STAMP_NS + 2 * QUEUE_NS - 1;
    assert!(ground.put_off(posed(second)));
    // displacements are no places: none replaces another
    assert!(ground.put_off(displaced(second + 1)) && ground.put_off(displaced(second + 2)));
    assert!(ground.put_off(posed(second + 3)));
    // a sixth finds no room beside it
    assert!(!ground.put_off(displaced(second + 4)));
    let waiting = core::iter::from_fn(|| ground.next_awaiting()).map(|(stamp_ns, ..)| stamp_ns);
    let expected = [
        STAMP_NS + QUEUE_NS - 1,
        second,
        second + 1,
        second + 2,
        second + 3,
        second + 4,
    ];
    assert!(waiting.eq(expected));
}

#[test]
fn without_a_reference_the_slip_fades_into_its_prior_after_five_seconds() {
    let ground = started();
    let [rim_share, drift] = ground
        .models
        .motion()
        .map(|m| [m.rim_share, m.drift])
        .unwrap();
    assert!(near(rim_share, 1.0 - SLIP_AND_SIGMA[0]) && drift == 0.0);
    let after = |passed_ns: i64| ground.motion(NOW_NS + passed_ns, &settings()).unwrap();
    for passed_ms in [0, 4_000, 5_000, 12_000, 45_000] {
        let outage_s = (passed_ms as f64 * 1e-3 - MAX_PREDICTION_S).max(0.0);
        let kept = f64::exp(-outage_s / settings().slip_memory);
        let (motion, direction, rim) = after(passed_ms * MS);
        let slip = PRIOR_AND_SIGMA[0] + kept * (SLIP_AND_SIGMA[0] - PRIOR_AND_SIGMA[0]);
        assert!(
            near(motion.slip, slip) && near(motion.speed, RIM_M_PER_S * (1.0 - slip)),
            "{passed_ms}"
        );
        assert_eq!((direction, rim), (DIRECTION_RAD, RIM_M_PER_S));
    }
    // a slide takes the place of the slip while the rims stand
    let mut ground = started();
    ground.slide = Some((0.07, NOW_NS));
    assert!(near(
        ground.motion(NOW_NS, &settings()).unwrap().0.slip,
        SLIP_AND_SIGMA[0]
    ));
    ground.rim_speed = 0.001;
    let motion = ground.motion(NOW_NS, &settings()).unwrap().0;
    assert_eq!((motion.speed, motion.slip), (0.07, -1.0));
    ground.accepted_ns = None;
    assert!(ground.motion(NOW_NS, &settings()).is_none());
}

#[test]
fn the_mean_motion_of_a_window_is_its_rims_way_less_slip_and_across_by_the_drift() {
    let mut ground = started();
    // a robot that goes to one side of its wheels' direction shows a drift
    for step in 1..200 {
        ground.models.advance(&wheel_step(0.005));
        if step % 10 == 0 {
            let way = 0.005 * 0.7 * f64::from(step);
            let course = HEADING_RAD + DIRECTION_RAD + 0.1;
            let place = [
                PLACE_M[0] + way * f64::cos(course),
                PLACE_M[1] + way * f64::sin(course),
            ];
            ground
                .models
                .update_position(place, ([0.0; 4], 0.0), (Errors::Independent, 0.01, 0.0));
        }
    }
    let motion = ground.models.motion().unwrap();
    assert!(motion.drift.abs() > 0.02);
    let from_ns = NOW_NS - 80 * MS;
    ground.history.push(from_ns - 20 * MS, [0.0, 0.0, 0.0, 3.0]);
    ground.history.push(from_ns, [0.0, 0.0, 0.0, 3.01]);
    ground.history.push(NOW_NS, [0.0, 0.0, 0.0, 3.05]);
    // 0.04 m in 0.08 s, also where the window ends after the last step
    let speed = 0.04 / 0.08 * motion.rim_share;
    let across = motion.drift * speed;
    let (sin, cos) = f64::sin_cos(DIRECTION_RAD);
    for to_ns in [NOW_NS, NOW_NS + 7 * MS] {
        let [forward, left] = ground.mean_motion((from_ns, to_ns), &settings()).unwrap();
        assert!(near(forward, cos * speed - sin * across), "{forward}");
        assert!(near(left, sin * speed + cos * across), "{left}");
    }
    assert!(ground.mean_motion((NOW_NS, NOW_NS), &settings()).is_none());
}

#[test]
fn a_reference_is_late_silent_or_readmitted_by_its_times() {
    let mut ground = started();
    assert_eq!(ground.silent_after(), 0.0);
    assert!(!ground.is_late(NOW_NS + LATE_NS));
    ground.received_ns = Some(NOW_NS);
    assert!(!ground.is_late(NOW_NS + LATE_NS));
    ground.period_s = 0.3;
    assert!(!ground.is_late(NOW_NS + LATE_NS) && ground.is_late(NOW_NS + LATE_NS + 1));
    assert_eq!(ground.silent_after(), SILENT_PERIODS * 0.3);
    ground.period_s = 1.7;
    assert_eq!(ground.silent_after(), SILENT_PERIODS);
    // two seconds after a start, five after a return
    let at = |ground: &GroundTrack, ms: i64| ground.is_readmitted(NOW_NS + ms * MS);
    assert!(at(&ground, 1_999) && !at(&ground, 2_000));
    ground.readmitted_ns = Some(NOW_NS);
    assert!(at(&ground, 4_999) && !at(&ground, 5_000));
    ground.started_ns = None;
    assert!(at(&ground, 1_000));
}

#[test]
fn headings_confirm_a_turn_or_show_it_wrong_by_a_series_of_six() {
    let mut ground = started();
    for count in [5, 6, 7] {
        for has_heading in [false, true] {
            ground.has_heading = has_heading;
            ground.agreed_headings = count;
            assert_eq!(ground.confirms_turn(), has_heading && count > 5);
        }
    }
    for count in 1..=6 {
        ground.refused_headings.accepts(0.0);
        for has_heading in [false, true] {
            ground.has_heading = has_heading;
            assert_eq!(ground.has_wrong_turn(), has_heading && count == 6);
        }
    }
}

#[test]
fn a_clock_that_was_set_forgets_times_and_keeps_the_rims_way() {
    let mut ground = started();
    ground.models.advance(&wheel_step(0.005));
    let path = ground.rim_path().unwrap();
    let middle = HEADING_RAD + DIRECTION_RAD + 0.001;
    let expected = [
        0.005 * f64::cos(middle),
        0.005 * f64::sin(middle),
        0.002,
        0.005,
    ];
    let is = [path.x, path.y, path.turned, path.way];
    assert!(
        is.iter().zip(expected).all(|(a, b)| near(*a, b)),
        "{path:?}"
    );
    ground.history.push(NOW_NS, [0.0; 4]);
    (ground.used_ns, ground.received_ns) = (Some(NOW_NS), Some(NOW_NS));
    (ground.readmitted_ns, ground.awaited_speed) = (Some(NOW_NS), Some((NOW_NS, 0.3)));
    ground.refused_ns = NOW_NS;
    ground.refused.accepts(0.0);
    ground.put_off(posed(NOW_NS));
    ground.force.observe(NOW_NS, [0.1, 0.2]);
    ground.restart_clock();
    let times = [
        ground.stepped_ns,
        ground.used_ns,
        ground.received_ns,
        ground.accepted_ns,
        ground.started_ns,
        ground.readmitted_ns,
        ground.last_awaiting_ns(),
        ground.history.newest().map(|(time_ns, _)| time_ns),
        ground.awaited_speed.map(|(time_ns, _)| time_ns),
    ];
    assert_eq!(times, [None; 9]);
    assert!(ground.rim_path().is_none() && !ground.has_rims && ground.refused.len() == 0);
    assert_eq!(
        (ground.refused_ns, ground.models.totals()[3]),
        (i64::MIN, 0.005)
    );
    assert!(ground.force.step(NOW_NS, 0.0, (0.01, 1.0)).is_none());
}

/// The same step by hand: two wheels of one heading, whose rims ran 3 and 4 mm on at 0.6 and 0.8 m/s.
#[test]
fn a_step_is_the_rims_mean_way_beside_the_turn() {
    let settings = settings();
    let wheels = [(0.3, 0.2), (-0.3, -0.2)].map(|(x, y)| {
        Wheel::powered(format!("{x}"))
            .at(x, y)
            .heading(Angle::from_rad(DIRECTION_RAD))
            .radius(0.1)
    });
    let robot = Robot::new("crab".into(), wheels.into()).unwrap();
    let mut bank = WheelBank::new(&robot, &settings);
    for (wheel, rim) in [(0, 0.6), (1, 0.8)] {
        let channel = &mut bank.channels[wheel];
        for time_ns in [NOW_NS, READ_NS] {
            let rate = rim / 0.1;
            channel
                .track
                .take(time_ns, &Measurement::WheelRate { wheel, rate })
                .unwrap();
        }
        let variance = 1e-4;
        channel.rim = Some((
            crate::speed::Measured {
                value: rim,
                variance,
            },
            READ_NS,
        ));
        channel.rim_window = 0.04;
    }
    let turn_error = TurnError {
        by_gyro: true,
        removed: 0.01,
        sigma: 0.02,
        memory: 50.0,
    };
    let inertial = Inertial {
        yaw_rate: 0.2,
        turn_rate: 0.3,
        turn_error,
        curvature: Some(0.7),
    };
    let mut ground = started();
    ground.stepped_ns = None;
    // the rims show less of a rise than the force does
    ground.slow_rim_speed = 0.698;
    // held for 6 ms until the end of the step
    let forces = [1.1, -0.4];
    ground.force.observe(NOW_NS - MS, forces);
    let force =
        6.0 / 5.0 * (forces[0] * f64::cos(DIRECTION_RAD) + forces[1] * f64::sin(DIRECTION_RAD));
    ground.step(NOW_NS, &bank, inertial, &settings);
    ground.travels = core::array::from_fn(|i| {
        bank.channels.get(i).map_or(0.0, |w| w.track.travel())
            - [0.003, 0.004, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0][i]
    });
    let mut models = ground.models.clone();
    // a step as short as this counts, a shorter one waits
    ground.step(NOW_NS + 5 * MS - 1, &bank, inertial, &settings);
    assert_eq!(ground.stepped_ns, Some(NOW_NS));
    ground.step(NOW_NS + 5 * MS, &bank, inertial, &settings);
    assert_eq!(ground.stepped_ns, Some(NOW_NS + 5 * MS));
    // both wheels' arms are as long, so that the turn leaves their mean
    let (dt, lag, speed) = (0.005, 0.02, 0.7);
    models.advance(&WheelStep {
        dt,
        rim_way: 0.0035,
        direction: DIRECTION_RAD,
        turn: 0.3 * dt,
        turn_error,
        curvature: Some(0.7 * f64::cos(DIRECTION_RAD)),
        acceleration: Some((force, settings.accelerometer_noise)),
        rim: Rim {
            speed,
            // two wheels, their creep, and ten steps to a window
            variance: (0.5e-4 + 25e-8) * 10.0,
            lag,
            rise: RISE_FACTOR * (1.0 - dt / (dt + lag)) * 0.002,
            gained: lag * force,
        },
        max_slip: 1.0,
    });
    let (is, expected) = (ground.models.motion().unwrap(), models.motion().unwrap());
    let flat = |m: ModelMotion| {
        [
            m.speed,
            m.slip,
            m.slip_sigma,
            m.drift,
            m.drift_sigma,
            m.heading,
            m.place[0],
            m.place[1],
            m.turn_error.value,
            m.turn_error.variance,
        ]
    };
    for (a, b) in flat(is).into_iter().zip(flat(expected)) {
        assert!((a - b).abs() < 1e-12, "{is:?} {expected:?}");
    }
    assert!(near(ground.slow_rim_speed, 0.698 + dt / (dt + lag) * 0.002));
    assert!(near(ground.rim_lag, lag) && near(ground.rim_speed, speed) && ground.has_rims);
}
