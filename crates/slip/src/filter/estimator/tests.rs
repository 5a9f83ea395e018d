use super::*;
use crate::history::nanoseconds;
use crate::robot::Wheel;

const MS: i64 = 1_000_000;
const WHEELS: usize = 4;
const RADIUS_M: f64 = 0.1;

/// A skid-steered robot.
fn core(settings: FilterSettings) -> (Core, Input) {
    let places = [(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)];
    let wheels = places.map(|(x, y)| Wheel::powered(format!("{x} {y}")).at(x, y).radius(RADIUS_M));
    let robot = Robot::new("skid".into(), wheels.into()).unwrap();
    (Core::new(&robot, settings), Input::new(WHEELS, &settings))
}

fn add((core, input): &mut (Core, Input), time_ns: i64, measurement: Measurement) {
    let sample = Sample {
        time_ns,
        measurement,
    };
    core.step(&sample, input).unwrap();
}

/// Reads all wheels: those on the left turn at one rim speed, those on the right at another, m/s.
fn read(core: &mut (Core, Input), time_ns: i64, [left, right]: [f64; 2]) {
    for wheel in 0..WHEELS {
        let rim = if wheel % 2 == 0 { left } else { right };
        let rate = rim / RADIUS_M;
        add(core, time_ns, Measurement::WheelRate { wheel, rate });
    }
}

const fn pose(x: f64) -> Measurement {
    let (y, yaw) = (0.0, 0.0);
    Measurement::Pose { x, y, yaw }
}

/// After a second straight ahead at 0.3 m/s with rims at 0.4 m/s, with a reading of the wheels at its end.
fn driven() -> (Core, Input) {
    let mut core = core(FilterSettings::default());
    for step in 0..=100_i64 {
        read(&mut core, 10 * MS * step, [0.4; 2]);
        if step % 10 == 0 {
            add(&mut core, 10 * MS * step, pose(0.003 * step as f64));
        }
    }
    core
}

#[test]
fn the_inertial_path_reaches_back_by_latency_horizon_and_clock_step() {
    let settings = FilterSettings {
        reference_latency: 0.3,
        horizon: 0.05,
        max_rate: 1000.0,
        ..FilterSettings::default()
    };
    let (mut core, _) = core(settings);
    let span_ns = nanoseconds(0.3 + 0.05 + CLOCK_STEP_S) - 40 * MS;
    let now_ns = 5_000 * MS;
    for time_ns in (0..=now_ns).step_by(100_000) {
        // turned at 0.5 rad/s until the last step
        core.path.yaw_rate = 0.5;
        core.path.advance(1e-4, [0.0; 2]);
        core.path.record(time_ns);
    }
    core.path.yaw_rate = 0.2;
    let mean = core
        .path
        .mean_yaw_rate(&core.state, now_ns - span_ns, now_ns);
    assert!((mean - 0.3).abs() < 1e-12, "{mean}");
}

#[test]
fn rates_lead_the_motion_on_at_each_sample_unless_they_are_sparse() {
    let way = |core: &(Core, Input)| core.0.ground.as_ref().unwrap().rim_path().unwrap().way;
    for (later_ms, is_led) in [(20, true), (60, false)] {
        let mut core = driven();
        let before = way(&core);
        let command = Measurement::YawRate { rate: 0.0 };
        add(&mut core, (1_000 + later_ms) * MS, command);
        let gone = way(&core) - before;
        assert_eq!(
            (gone - 0.4e-3 * later_ms as f64).abs() < 1e-9,
            is_led,
            "{later_ms} {gone}"
        );
    }
}

#[test]
fn a_late_reading_of_the_reference_counts() {
    let mut core = driven();
    read(&mut core, 1_100 * MS, [0.4; 2]);
    read(&mut core, 1_200 * MS, [0.4; 2]);
    let sample = Sample {
        time_ns: 1_100 * MS,
        measurement: pose(0.33),
    };
    let before = core.0.output.reference_readings;
    core.0.update_late(&sample, &core.1).unwrap();
    assert_eq!(core.0.output.reference_readings, before + 1);
}

#[test]
fn torques_of_either_sign_are_used_and_those_beyond_the_limit_refused() {
    let (mut core, _) = core(FilterSettings::default());
    for (torque, is_used) in [
        (3.0, true),
        (-3.0, true),
        (1.1 * MAX_TORQUE_N_M, false),
        (-1.1 * MAX_TORQUE_N_M, false),
    ] {
        let measured = Measurement::WheelTorque { wheel: 1, torque };
        assert_eq!(core.update(MS, &measured).is_ok(), is_used, "{torque}");
    }
}

/// The gyro turns against the wheels: without headings that confirm it, it is not trusted, however well it is received.
#[test]
fn a_gyro_is_confirmed_by_headings_and_not_by_being_trusted() {
    let mut core = core(FilterSettings::default());
    for step in 0..400_i64 {
        let time_ns = 10 * MS * step;
        read(&mut core, time_ns, [0.2, 0.4]);
        let noise = 1e-6 * (step % 7) as f64;
        add(
            &mut core,
            time_ns,
            Measurement::YawRate {
                rate: -0.25 + noise,
            },
        );
    }
    assert!(core.0.gyro.contradicts_wheels());
}

#[test]
fn estimates_change_by_all_but_forces_torques_and_commands() {
    let (core, _) = driven();
    let (now_ns, wheel) = (1_000 * MS, 0);
    let changes = |time_ns, measurement| core.changes_estimate(time_ns, &measurement);
    let rate = Measurement::WheelRate { wheel, rate: 0.0 };
    assert!(changes(now_ns, Measurement::YawRate { rate: 0.0 }) && changes(now_ns, pose(0.0)));
    let acceleration = Measurement::Acceleration {
        forward: 0.0,
        left: 0.0,
    };
    assert!(!changes(now_ns, acceleration));
    assert!(!changes(
        now_ns,
        Measurement::WheelTorque { wheel, torque: 0.0 }
    ));
    // a wheel's only where its window ends
    let ended_ns = core.wheels.channels[wheel].rim.unwrap().1;
    assert!(changes(ended_ns, rate) && !changes(ended_ns + 1, rate));
}

#[test]
fn a_clock_that_was_set_forgets_the_motion_and_keeps_what_was_learnt() {
    /// A gyro's bias within the default standard deviation.
    const LEARNT_BIAS_RAD_PER_S: f64 = 0.013;
    let (mut core, _) = driven();
    core.state.set_mean(FORWARD, -0.31);
    core.state.set_mean(GYRO_BIAS, LEARNT_BIAS_RAD_PER_S);
    core.accelerometer.last = Some(super::super::accelerometer::SpecificForce {
        time_ns: 0,
        force: [0.1; 2],
    });
    let [x, y] = motion_model::PLACE;
    let heading = motion_model::HEADING;
    let before = core.state.clone();
    core.restart_clock();
    // for a second the robot may have gone on at its speed
    for (i, rate) in [(x, FORWARD), (y, FORWARD), (heading, YAW)] {
        let moved = before.mean(rate).abs() + before.sigma(rate);
        let variance = before.covariance(i, i) + moved * moved;
        assert!(
            (core.state.covariance(i, i) / variance - 1.0).abs() < 1e-12,
            "{i}"
        );
        assert_eq!(core.state.mean(i), before.mean(i));
    }
    let variance = core.settings.gyro_bias * core.settings.gyro_bias;
    let bias = (
        core.state.mean(GYRO_BIAS),
        core.state.covariance(GYRO_BIAS, GYRO_BIAS),
    );
    assert_eq!(bias, (LEARNT_BIAS_RAD_PER_S, variance));
    assert_eq!(core.state.mean(FORWARD), 0.0);
    let times = [
        core.now_ns,
        core.pseudo_measured_ns,
        core.output.checked_ns,
        core.speed_known_ns,
    ];
    assert_eq!(times, [None; 4]);
    assert!(!core.has_news && !core.is_led && core.accelerometer.last.is_none());
    assert!(core.wheels.iter().all(|wheel| wheel.rim.is_none()));
    assert!(core.ground.as_ref().unwrap().rim_path().is_none());
    // priors of slips and radii
    let slip = core.settings.slip;
    assert_eq!(core.state.mean(COMMON_SLIP), slip.mean);
    assert_eq!(core.state.sigma(COMMON_SLIP), slip.sigma);
    for wheel in 0..WHEELS {
        let sigmas = [own_slip(wheel), radius(wheel)].map(|i| core.state.sigma(i));
        assert_eq!(
            sigmas,
            [core.settings.wheel_slip_sigma, core.settings.radius_sigma]
        );
    }
}

/// Pseudo-measurements come once in 20 ms: not a nanosecond earlier.
#[test]
fn pseudo_measurements_keep_their_period() {
    let (forward, left) = (0.1, 0.0);
    let command = Measurement::Command { forward, left };
    let mut core = core(FilterSettings::default());
    for (time_ns, last_ns) in [
        (100 * MS, 100 * MS),
        (110 * MS, 100 * MS),
        (120 * MS - 1, 100 * MS),
        (120 * MS, 120 * MS),
        (139 * MS, 120 * MS),
        (200 * MS, 200 * MS),
    ] {
        add(&mut core, time_ns, command);
        assert_eq!(core.0.pseudo_measured_ns, Some(last_ns), "{time_ns}");
    }
}

/// A command changes no estimate: news comes with another time, and then the readings of the time before are used.
#[test]
fn what_moves_time_on_is_news() {
    let (forward, left) = (0.1, 0.0);
    let command = Measurement::Command { forward, left };
    let mut core = driven();
    for (time_ns, is_news) in [(1_000 * MS, false), (1_003 * MS, true)] {
        core.0.has_news = false;
        add(&mut core, time_ns, command);
        assert_eq!(core.0.has_news, is_news, "{time_ns}");
    }
}

/// Without a gyro the yaw rate is that of the wheels less the error that the reference shows of it.
#[test]
fn without_a_gyro_wheels_lead_the_yaw_rate() {
    const TURN_RAD_PER_S: f64 = 0.05;
    let mut core = core(FilterSettings::default());
    for step in 0..=200_i64 {
        let time = 0.01 * step as f64;
        read(&mut core, 10 * MS * step, [0.36, 0.44]);
        if step % 10 == 0 {
            let yaw = TURN_RAD_PER_S * time;
            let arc = 0.3 / TURN_RAD_PER_S;
            let (x, y) = (arc * f64::sin(yaw), arc * (1.0 - f64::cos(yaw)));
            add(&mut core, 10 * MS * step, Measurement::Pose { x, y, yaw });
        }
    }
    let core = &mut core.0;
    let now_ns = core.now_ns.unwrap();
    core.predict_ground_motion(now_ns);
    let by_wheels = core.turn_by_wheels().unwrap();
    assert!((by_wheels.value - 0.08 / 0.8).abs() < 1e-9);
    let ground = core.ground.as_ref().unwrap();
    let error = ground.motion(now_ns, &core.settings).unwrap().0.turn_error;
    assert!(error.value.abs() > 1e-3);
    assert_eq!(core.state.mean(YAW), by_wheels.value - error.value);
    assert_eq!(core.state.covariance(YAW, YAW), error.variance);
}
