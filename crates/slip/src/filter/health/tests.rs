use super::*;
use crate::filter::free_wheel_update::tests::{FREE, MS, NOW_NS, POWERED, core, near, turn};
use crate::filter::motion_model::{COMMON_SLIP, FORWARD, LEFT, own_slip};
use crate::sample::{Measurement, Sample};

/// Time of a state of the wheel's sensor before now, ns.
const WRONG_NS: i64 = 250 * MS;
const DRIVING: MeasuredSlip = MeasuredSlip {
    slip: Some(Slip::ZERO),
    sigma: Some(0.1),
    motion: Motion::Driving,
    health: Health::Ok,
};

fn without_slip(motion: Motion) -> MeasuredSlip {
    MeasuredSlip {
        slip: None,
        sigma: None,
        motion,
        health: Health::Degraded(Degraded::LowSpeed),
    }
}

fn health_of(wheel: usize, change: impl Fn(&mut Core), measured: &MeasuredSlip) -> Health {
    let mut core = core();
    change(&mut core);
    let sigma = core.settings.max_sigma;
    core.health(wheel, NOW_NS, measured, sigma)
}

#[test]
fn health_names_the_first_thing_that_is_wrong() {
    let inconsistent = Health::Invalid(Invalid::Inconsistent);
    let suspect = Health::Degraded(Degraded::Suspect);
    let lost = Health::Degraded(Degraded::ReferenceLost);
    let still = |ago_ns: i64| {
        move |core: &mut Core| core.wheels.channels[POWERED].still_since_ns = Some(NOW_NS - ago_ns)
    };
    assert_eq!(health_of(POWERED, |_| (), &DRIVING), Health::Ok);
    assert_eq!(health_of(POWERED, still(WRONG_NS), &DRIVING), inconsistent);
    assert_eq!(health_of(POWERED, still(WRONG_NS - 1), &DRIVING), suspect);
    assert_eq!(health_of(POWERED, still(0), &DRIVING), Health::Ok);
    let standing = MeasuredSlip {
        motion: Motion::Standstill,
        ..DRIVING
    };
    assert_eq!(health_of(POWERED, still(WRONG_NS), &standing), Health::Ok);
    let against = |ago_ns: i64| {
        move |core: &mut Core| {
            core.wheels.channels[POWERED].against_since_ns = Some(NOW_NS - ago_ns);
        }
    };
    assert_eq!(
        health_of(POWERED, against(WRONG_NS), &DRIVING),
        inconsistent
    );
    assert_eq!(
        health_of(POWERED, against(WRONG_NS - 1), &DRIVING),
        Health::Ok
    );
    // a rate that repeats itself is wrong beside one that changes, of which there is none
    let repeats = |core: &mut Core| {
        for index in 0..150_i64 {
            let rate = 1.0 + 0.01 * index.min(100) as f64;
            let repeated = &mut core.wheels.channels[POWERED].repeated;
            repeated.push(10 * MS * index, rate);
        }
        assert!(core.wheels.channels[POWERED].repeated.has_stopped());
    };
    assert_eq!(health_of(POWERED, repeats, &DRIVING), Health::Ok);
    // trust in a free wheel
    let failed = |core: &mut Core| {
        for wheel in &mut core.wheels.channels {
            for reading in 0..9 {
                wheel.monitor.record(reading * 100 * MS, false, 0.3);
            }
        }
    };
    assert_eq!(health_of(FREE, failed, &DRIVING), inconsistent);
    assert_eq!(health_of(POWERED, failed, &DRIVING), lost);
    // without a slip the motion's own, but for powered wheels that roll back where the robot may be stuck
    let blocked = |core: &mut Core| core.recovery.is_blocked = true;
    let disputed = |core: &mut Core| core.recovery.is_disputed = true;
    let back = without_slip(Motion::RollBack);
    for (wheel, measured, expected) in [
        (POWERED, DRIVING, suspect),
        (FREE, DRIVING, Health::Ok),
        (POWERED, back, suspect),
        (FREE, back, back.health),
        (POWERED, without_slip(Motion::Driving), back.health),
    ] {
        assert_eq!(health_of(wheel, blocked, &measured), expected);
        assert_eq!(health_of(wheel, disputed, &measured), expected);
    }
    assert_eq!(health_of(POWERED, |_| (), &back), back.health);
    let misses = |core: &mut Core| core.output.checks[POWERED].misses_pulses = true;
    assert_eq!(health_of(POWERED, misses, &DRIVING), suspect);
    assert_eq!(health_of(FREE, misses, &DRIVING), Health::Ok);
    // dropout time and four windows of 0.05 s
    let known = |then_ns: Option<i64>| move |core: &mut Core| core.speed_known_ns = then_ns;
    let relative = Health::Degraded(Degraded::Relative);
    assert_eq!(health_of(POWERED, known(None), &DRIVING), relative);
    assert_eq!(
        health_of(POWERED, known(Some(NOW_NS - 300 * MS)), &DRIVING),
        Health::Ok
    );
    assert_eq!(
        health_of(POWERED, known(Some(NOW_NS - 301 * MS)), &DRIVING),
        lost
    );
    let quantised = Health::Degraded(Degraded::Quantised);
    let sigma = core().settings.max_sigma.next_up();
    assert_eq!(core().health(POWERED, NOW_NS, &DRIVING, sigma), quantised);
}

#[test]
fn an_estimate_holds_the_state_along_the_wheel_and_its_doubts() {
    const BRAKING_SLIP: f64 = -0.25;
    let mut core = core();
    let input = Input::new(2, &core.settings);
    let row = core.wheels.channels[POWERED].row;
    let (speeds, sigmas) = ([0.9, 0.1, 0.3], [0.03, 0.02, 0.04]);
    for ((i, mean), sigma) in [FORWARD, LEFT, YAW].into_iter().zip(speeds).zip(sigmas) {
        core.state.reset(i, mean, sigma * sigma);
    }
    core.state.reset(COMMON_SLIP, BRAKING_SLIP, 0.0025);
    core.state.reset(own_slip(POWERED), 0.04, 0.0016);
    let estimate = core.wheel_estimate(POWERED, NOW_NS, &input);
    let forward = estimate.forward_speed.unwrap();
    assert!(near(forward.value, 0.9 + 0.3 * row[2]) && row[2].abs() > 0.0);
    let variance = 9e-4 + 16e-4 * row[2] * row[2];
    assert!(near(forward.variance, variance), "{forward:?}");
    // by one powered wheel alone the robot turns as much as its own slip lets it
    let sigma = f64::sqrt(0.0025 + 0.0016);
    assert!(near(estimate.slip.unwrap().value(), BRAKING_SLIP + 0.04));
    assert!(near(estimate.sigma.unwrap(), f64::hypot(sigma, 0.04)));
    assert_eq!(
        (estimate.motion, estimate.health),
        (Some(Motion::Braking), Health::Ok)
    );
    // a skid by the rim is one by the faster: x = −0.25 is −0.2, with 1/1.25² of its sigma
    core.state.reset(own_slip(FREE), -0.25, 4e-4);
    let free = core.wheel_estimate(FREE, NOW_NS, &input);
    assert!(near(free.slip.unwrap().value(), -0.2));
    // and that turn is the pair's alone, by arms of 0.1 m and 0.2 m at 0.8 m/s and 0.5 m/s
    let turned = 0.04 * 0.8 / 0.1 * 0.2 / 0.5;
    let expected = f64::hypot(0.02, turned) / (1.25 * 1.25);
    assert!(near(free.sigma.unwrap(), expected));
    // a wheel that rises by 0.6 of its way goes the longer way; one that stands wrongly has no slip
    let mut steep = core.clone();
    let up = 0.6 * forward.value;
    let carrier = &mut steep.wheels.channels[POWERED].carrier;
    carrier.update(NOW_NS, [0.0, 0.0, up]).unwrap();
    let estimate = steep.wheel_estimate(POWERED, NOW_NS, &input);
    let longer = estimate.forward_speed.unwrap();
    assert!(near(longer.variance, (1.0 + 0.36) * variance), "{longer:?}");
    steep.wheels.channels[POWERED].against_since_ns = Some(NOW_NS - WRONG_NS);
    let estimate = steep.wheel_estimate(POWERED, NOW_NS, &input);
    assert_eq!((estimate.slip, estimate.sigma), (None, None));
    // no slip is driving
    steep.state.set_mean(COMMON_SLIP, -0.04);
    let estimate = steep.wheel_estimate(POWERED, NOW_NS, &input);
    assert_eq!(estimate.motion, Some(Motion::Driving));
    // slips beyond 1 are none
    core.state.reset(COMMON_SLIP, 1.5, 0.0025);
    let estimate = core.wheel_estimate(POWERED, NOW_NS, &input);
    assert_eq!(estimate.slip.unwrap().value(), 1.0);
    assert_eq!(estimate.motion, Some(Motion::Driving));
    // on a cross slope a steered wheel does not know its drift
    core.cross_slope = 0.2;
    core.wheels.channels[POWERED].row = [0.8, 0.6, 0.0];
    let rim = core.wheels.channels[POWERED].rim.unwrap().0.value;
    let drift = 0.6 * 0.02 / rim;
    let estimate = core.wheel_estimate(POWERED, NOW_NS, &input);
    assert!(near(estimate.sigma.unwrap(), f64::hypot(sigma, drift)));
    turn(&mut core, POWERED, 0.012);
    let wheel = &core.wheels.channels[POWERED];
    let least = core.settings.low_speed;
    assert!(near(core.drift_doubt(wheel, 0.012), 0.6 * 0.02 / least));
    core.state.reset(LEFT, 0.0, 9.0);
    let wheel = &core.wheels.channels[POWERED];
    assert_eq!(core.drift_doubt(wheel, 0.5), 1.0);
    // across the wheels by both parts
    core.state.reset(LEFT, 0.0, 4e-4);
    core.state.reset(FORWARD, 0.0, 9e-4);
    core.wheels.lateral = Some([-0.6, 0.8, 0.0]);
    core.wheels.channels[POWERED].row = [0.96, -0.28, 0.0];
    let across = 0.6 * 0.96 + 0.8 * 0.28;
    let drift = across * f64::sqrt(0.36 * 9e-4 + 0.64 * 4e-4) / 0.5;
    assert!(near(
        core.drift_doubt(&core.wheels.channels[POWERED], 0.5),
        drift
    ));
    core.is_led = true;
    assert_eq!(core.drift_doubt(&core.wheels.channels[POWERED], 0.5), 0.0);
}

#[test]
fn a_silent_wheel_has_no_estimate_and_the_last_good_one_is_dated() {
    let mut core = core();
    let mut input = Input::new(2, &core.settings);
    let at = |core: &Core, input: &Input, ns: i64| {
        core.wheel_estimate(POWERED, NOW_NS + ns, input).health
    };
    let dropout = Health::Invalid(Invalid::Dropout);
    core.state.reset(COMMON_SLIP, 0.1, 1e-4);
    assert_eq!(at(&core, &input, 100 * MS), Health::Ok);
    assert_eq!(at(&core, &input, 100 * MS + 1), dropout);
    // another sensor's reading shows the silence
    let sample = Sample {
        time_ns: NOW_NS + 150 * MS,
        measurement: Measurement::YawRate { rate: 0.0 },
    };
    assert!(input.offer(sample));
    assert_eq!(at(&core, &input, 0), dropout);
    input.clear();
    core.wheels.channels[FREE].rolling.runs(0.5);
    core.update_health(NOW_NS, &input);
    core.update_health(NOW_NS + 120 * MS, &input);
    let estimate = core.output.estimates[POWERED];
    assert_eq!(estimate.health, dropout);
    assert!(near(estimate.last_good_age.unwrap(), 0.12));
    core.wheels.channels[POWERED].rim = None;
    assert_eq!(at(&core, &input, 0), Health::Uninitialised);
    // estimates change only where there is news
    let before = core.output.estimates[FREE];
    core.settle_estimates(&input);
    assert_eq!(core.output.estimates[FREE], before);
    core.has_news = true;
    core.settle_estimates(&input);
    assert!(core.output.estimates[FREE] != before && !core.has_news);
}

/// β = atan2(across, along), its variance by its numerical slopes.
#[test]
fn a_side_slip_angle_is_known_to_half_a_radian_above_the_low_speed() {
    const STEP_M_PER_S: f64 = 1e-6;
    let speeds = [0.6, 0.2, 0.3];
    let mut core = core();
    core.wheels.channels[POWERED].steer(0.3);
    let (ahead, sideways) = {
        let wheel = &core.wheels.channels[POWERED];
        (wheel.row, wheel.steering.across())
    };
    let angle = |speeds: [f64; 3]| {
        let dot = |row: [f64; 3]| -> f64 { (0..3).map(|i| row[i] * speeds[i]).sum() };
        f64::atan2(dot(sideways), dot(ahead))
    };
    let mut variance = 0.0;
    for (k, i) in [FORWARD, LEFT, YAW].into_iter().enumerate() {
        let sigma = 0.01 * (k as f64 + 2.0);
        core.state.reset(i, speeds[k], sigma * sigma);
        let [mut less, mut more] = [speeds; 2];
        (less[k], more[k]) = (less[k] - STEP_M_PER_S, more[k] + STEP_M_PER_S);
        let slope = (angle(more) - angle(less)) / (2.0 * STEP_M_PER_S);
        variance += slope * slope * sigma * sigma;
    }
    let is = core.side_slip_angle(POWERED).unwrap();
    assert!((is.value - angle(speeds)).abs() < 1e-14);
    assert!(
        (is.variance / variance - 1.0).abs() < 1e-6,
        "{is:?} {variance}"
    );
    assert_eq!(core.side_slip_angle(2), None);
    // of a wheel straight ahead at v the variance is that of the drift over v²
    core.wheels.channels[POWERED].steer(0.0);
    let mut at = |speed: f64, drift_variance: f64| {
        core.state.reset(FORWARD, speed, 1e-4);
        core.state.reset(LEFT, 0.0, drift_variance);
        core.state.reset(YAW, 0.0, 0.0);
        core.side_slip_angle(POWERED).is_some()
    };
    assert!(at(0.5, 0.062_499) && !at(0.5, 0.0625));
    assert!(at(0.020_001, 1e-6) && !at(0.02, 1e-6));
}

#[test]
fn a_turn_that_no_gyro_measures_is_a_doubt_of_wheels_beside_the_middle() {
    let mut core = core();
    core.state.reset(YAW, 0.1, 9e-4);
    core.is_led = true;
    let doubt = |core: &Core, rim: f64| core.yaw_doubt(&core.wheels.channels[FREE], rim, NOW_NS);
    // one powered wheel shows no turn, however it slips
    core.state.set_mean(own_slip(POWERED), 0.04);
    assert_eq!(doubt(&core, 0.5), 0.0);
    core.state.set_mean(own_slip(POWERED), 0.0);
    // of two the motion over the ground corrects it
    core.wheels.channels[FREE].free = false;
    let arm = core.wheels.channels[FREE].row[2].abs();
    assert!(near(doubt(&core, 0.5), 0.03 * arm / 0.5) && arm > 0.0);
    assert!(near(
        doubt(&core, 0.001),
        0.03 * arm / core.settings.low_speed
    ));
    core.state.reset(YAW, 0.1, 900.0);
    assert_eq!(doubt(&core, 0.5), 1.0);
    // without one, wheels that slip alike show it
    core.is_led = false;
    core.state.set_mean(own_slip(FREE), 0.0);
    assert_eq!(doubt(&core, 0.5), 0.0);
}

#[test]
fn a_robot_is_blocked_or_disputed_by_its_free_wheels() {
    let mut core = core();
    core.update_disputes(NOW_NS);
    // the free wheel has not turned since the start
    assert!(core.recovery.is_blocked && !core.recovery.is_disputed);
    core.wheels.channels[FREE].rolling.runs(0.5);
    core.output.checks[FREE].misses_pulses = true;
    core.update_disputes(NOW_NS);
    assert!(!core.recovery.is_blocked && core.recovery.is_disputed);
}
