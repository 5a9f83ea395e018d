use super::*;
use crate::filter::motion_model::{own_slip, size};
use crate::robot::{Robot, Wheel};
use crate::speed::Measured;

const MS: i64 = 1_000_000;
const NOW_NS: i64 = 4_000 * MS;
/// Of a reading, of the yaw rate and of the bias before it.
const RATE_SIGMA_RAD_PER_S: f64 = 0.005;
const YAW_VARIANCE_RAD2_PER_S2: f64 = 0.04;
const BIAS_VARIANCE_RAD2_PER_S2: f64 = 1e-4;

/// A robot whose wheels at 0.5 m to either side turn it at `turn`, rad/s, with its state, path and settings.
struct Cart {
    gyro: GyroMonitor,
    wheels: WheelBank,
    state: Kalman,
    path: InertialPath,
    settings: FilterSettings,
}

impl Cart {
    fn new(turn: f64) -> Self {
        let settings = FilterSettings {
            yaw_rate_sigma: RATE_SIGMA_RAD_PER_S,
            gyro_bias: 0.3,
            ..FilterSettings::default()
        };
        let wheels = [0.5, -0.5].map(|y| Wheel::powered(format!("{y}")).at(0.0, y).radius(0.1));
        let robot = Robot::new("cart".into(), wheels.into()).unwrap();
        let mut wheels = WheelBank::new(&robot, &settings);
        for (wheel, side) in [(0, -0.5), (1, 0.5)] {
            let value = 0.6 + side * turn;
            let variance = 1e-4;
            wheels.channels[wheel].rim = Some((Measured { value, variance }, NOW_NS));
        }
        let mut state = Kalman::new(size(2));
        state.reset(YAW, 0.2, YAW_VARIANCE_RAD2_PER_S2);
        state.reset(GYRO_BIAS, 0.01, BIAS_VARIANCE_RAD2_PER_S2);
        Self {
            gyro: GyroMonitor::default(),
            wheels,
            state,
            path: InertialPath::new(1.0, 100.0),
            settings,
        }
    }

    fn update(
        &mut self,
        time_ns: i64,
        rate: f64,
        is_confirmed: bool,
    ) -> Result<Option<f64>, Fault> {
        let beside = (&self.wheels, is_confirmed);
        let (state, path) = (&mut self.state, &mut self.path);
        self.gyro
            .update((time_ns, rate), &self.settings, beside, state, path)
    }
}

#[test]
fn a_rate_is_the_yaw_rate_and_the_bias_within_the_gate() {
    let total = YAW_VARIANCE_RAD2_PER_S2
        + BIAS_VARIANCE_RAD2_PER_S2
        + RATE_SIGMA_RAD_PER_S * RATE_SIGMA_RAD_PER_S;
    let mut cart = Cart::new(0.2);
    let nis = cart.update(NOW_NS, 0.25, false).unwrap().unwrap();
    assert!((nis - 0.04 * 0.04 / total).abs() < 1e-12);
    for (i, mean, variance) in [
        (YAW, 0.2, YAW_VARIANCE_RAD2_PER_S2),
        (GYRO_BIAS, 0.01, BIAS_VARIANCE_RAD2_PER_S2),
    ] {
        let is = (cart.state.mean(i), cart.state.covariance(i, i));
        assert!((is.0 - mean - variance / total * 0.04).abs() < 1e-12, "{i}");
        assert!(
            (is.1 - variance + variance * variance / total).abs() < 1e-12,
            "{i}"
        );
    }
    assert_eq!(cart.path.yaw_rate, 0.25);
    // at the gate to the bit, from a state at 0
    for (share, is_used) in [(1.0, true), (1.0 + 1e-12, false)] {
        for sign in [-1.0, 1.0] {
            let mut cart = Cart::new(0.2);
            cart.state.set_mean(YAW, 0.0);
            cart.state.set_mean(GYRO_BIAS, 0.0);
            let rate = sign * share * cart.settings.gate * f64::sqrt(total);
            assert_eq!(cart.update(NOW_NS, rate, false).unwrap().is_some(), is_used);
            assert_eq!(cart.path.yaw_rate, if is_used { rate } else { 0.0 });
        }
    }
    for rate in [100.1, -100.1, f64::NAN] {
        assert!(cart.update(NOW_NS, rate, false).is_err());
    }
}

#[test]
fn a_gyro_is_trusted_while_it_is_received_and_agrees() {
    let mut cart = Cart::new(0.2);
    assert!(!cart.gyro.is_trusted(NOW_NS, &cart.settings));
    let last_ns = NOW_NS + 100 * MS;
    assert_eq!(cart.settings.dropout, seconds_between(NOW_NS, last_ns));
    cart.update(NOW_NS, 0.25, false).unwrap();
    let trusted = |cart: &Cart, now_ns| cart.gyro.is_trusted(now_ns, &cart.settings);
    assert!(trusted(&cart, last_ns) && !trusted(&cart, last_ns + 1));
    // outliers for longer than the failure time, and then a reading within the gate
    for step in 1..=5 {
        let outcome = cart.update(NOW_NS + 80 * MS * step, 9.0 + 0.01 * step as f64, false);
        assert_eq!(outcome.unwrap(), None);
        assert_eq!(trusted(&cart, NOW_NS + 80 * MS * step), step < 4, "{step}");
    }
    assert_eq!(cart.update(NOW_NS + 480 * MS, 0.2, false).unwrap(), None);
    assert_eq!(cart.path.yaw_rate, cart.state.mean(YAW));
    // a clock that was set forgets the time, not the distrust
    cart.gyro.restart_clock();
    let times = (cart.gyro.last_ns, cart.gyro.repeated, cart.gyro.compared_ns);
    assert_eq!(times, (None, None, None));
    assert!(cart.gyro.gate.has_failed());
}

#[test]
fn a_rate_that_repeats_itself_for_half_a_second_beside_turning_wheels_is_stuck() {
    let mut gyro = GyroMonitor::default();
    let half_ns = 500 * MS;
    assert!(!gyro.is_stuck(NOW_NS, 0.2, true) && !gyro.is_stuck(NOW_NS + half_ns - 1, 0.2, true));
    assert!(gyro.is_stuck(NOW_NS + half_ns, 0.2, true));
    // another rate, and wheels that stand, begin anew
    assert!(!gyro.is_stuck(NOW_NS + half_ns, 0.3, true));
    assert!(!gyro.is_stuck(NOW_NS + 2 * half_ns - 1, 0.3, true));
    assert!(!gyro.is_stuck(NOW_NS + 2 * half_ns, 0.3, false));
    assert!(!gyro.is_stuck(NOW_NS + 3 * half_ns - 1, 0.3, true));
    assert!(gyro.is_stuck(NOW_NS + 3 * half_ns, 0.3, true));
    // a stuck reading is not used
    let mut cart = Cart::new(0.2);
    assert!(cart.update(NOW_NS, 0.2, false).unwrap().is_some());
    assert!(cart.update(NOW_NS + half_ns, 0.2, false).unwrap().is_none());
}

/// The mean gap follows within two seconds: after half a second it is a quarter of the gap.
#[test]
fn a_gap_in_straight_driving_widens_the_bias() {
    const PASSED_S: f64 = 0.5;
    let variance = |by_wheels: f64, before: f64| {
        let Cart {
            mut gyro,
            mut state,
            settings,
            ..
        } = Cart::new(0.0);
        state.reset(GYRO_BIAS, 0.02, before);
        gyro.compare((NOW_NS, 0.2), by_wheels, &settings, &mut state);
        assert_eq!(state.covariance(GYRO_BIAS, GYRO_BIAS), before);
        gyro.compare((NOW_NS + 500 * MS, 0.2), by_wheels, &settings, &mut state);
        state.covariance(GYRO_BIAS, GYRO_BIAS)
    };
    for by_wheels in [0.01, -0.029] {
        let change = BIAS_CHANGE_PER_SQRT_S * 0.25 * (0.2 - 0.02 - by_wheels);
        let expected = BIAS_VARIANCE_RAD2_PER_S2 + change * change * PASSED_S;
        assert!((variance(by_wheels, BIAS_VARIANCE_RAD2_PER_S2) - expected).abs() < 1e-15);
    }
    for by_wheels in [BEND_YAW_RATE_RAD_PER_S, -BEND_YAW_RATE_RAD_PER_S, 0.2] {
        assert_eq!(
            variance(by_wheels, BIAS_VARIANCE_RAD2_PER_S2),
            BIAS_VARIANCE_RAD2_PER_S2
        );
    }
    // up to the prior's
    assert_eq!(variance(0.01, 0.3 * 0.3 - 1e-9), 0.3 * 0.3);
}

#[test]
fn a_gyro_that_turns_against_the_wheels_fails_until_both_agree_and_slip_alike() {
    let run = |cart: &mut Cart, from_ms: i64, to_ms: i64, rate: f64, is_confirmed| {
        for time_ms in (from_ms..to_ms).step_by(20) {
            cart.state.reset(YAW, rate, YAW_VARIANCE_RAD2_PER_S2);
            let noise = 1e-6 * (time_ms % 140) as f64;
            cart.update(time_ms * MS, rate + noise, is_confirmed)
                .unwrap();
        }
        cart.gyro.contradicts_wheels()
    };
    let opposite = |is_confirmed| {
        let mut cart = Cart::new(0.3);
        let is_found = run(&mut cart, 4_000, 6_000, -0.3, is_confirmed);
        (cart, is_found)
    };
    assert!(!opposite(true).1);
    let (cart, is_found) = opposite(false);
    assert!(is_found && !cart.gyro.is_trusted(5_980 * MS, &cart.settings));
    assert_eq!(cart.path.yaw_rate, cart.state.mean(YAW));
    // both turn one way again, or headings confirm it: beside wheels that slip alike
    for (rate, is_confirmed, unlike, is_cleared) in [
        (0.3, false, 0.0, true),
        (-0.3, true, 0.0, true),
        (0.3, false, 0.9, false),
        (-0.3, false, 0.0, false),
    ] {
        let mut cart = opposite(false).0;
        cart.state.set_mean(own_slip(0), unlike);
        let fails = run(&mut cart, 6_000, 10_000, rate, is_confirmed);
        assert_eq!(!fails, is_cleared, "{rate} {is_confirmed} {unlike}");
    }
    // readings beyond the gate clear nothing
    let mut cart = opposite(false).0;
    for step in 0..200_i64 {
        cart.state.reset(YAW, 5.0, YAW_VARIANCE_RAD2_PER_S2);
        cart.update(
            (6_000 + 20 * step) * MS,
            0.3 + 1e-6 * (step % 7) as f64,
            true,
        )
        .unwrap();
    }
    assert!(cart.gyro.contradicts_wheels());
}

/// Rims at 0.6 m/s half a metre to either side: at 0.45 rad/s one of them is dragged and the other held back by 0.37 of it, once the
/// mean over half a second is near.
#[test]
fn a_turn_that_nothing_on_the_robot_makes_is_the_gyro_s() {
    for (rate, bias, is_confirmed, contradicts) in [
        (0.45, 0.01, false, true),
        (0.45, 0.01, true, false),
        (0.4, 0.01, false, false),
        // what counts is the turn, without the bias
        (0.45, 0.06, false, false),
        (0.4, -0.04, false, true),
    ] {
        let mut cart = Cart::new(0.0);
        cart.state.set_mean(FORWARD, 0.6);
        for step in 0..100 {
            cart.state.set_mean(YAW, rate - bias);
            cart.state.set_mean(GYRO_BIAS, bias);
            let change = 1e-6 * step as f64;
            cart.update(NOW_NS + 20 * MS * step, rate + change, is_confirmed)
                .unwrap();
        }
        let settings = &cart.settings;
        assert_eq!(cart.gyro.contradicts_wheels(), contradicts, "{rate}");
        assert_eq!(cart.gyro.is_trusted(NOW_NS, settings), !contradicts);
    }
}
