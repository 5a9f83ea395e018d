use grouser_terra::Angle;

use super::*;
use crate::filter::settings::FilterSettings;
use crate::robot::{Robot, Wheel};
use crate::sample::Measurement;

const MS: i64 = 1_000_000;
const NOW_NS: i64 = 3_000 * MS;
const DT_S: f64 = 0.01;
/// Of each rim over its window.
const RIM_VARIANCE_M2_PER_S2: f64 = 1e-4;
const WINDOW_S: f64 = 0.04;

/// Wheels that stand at a place and turn at a rim speed: x and y, m, heading, rad, and m/s. The last one was read `silent_ns` ago.
fn bank<const N: usize>(wheels: [([f64; 3], f64); N], silent_ns: i64) -> WheelBank {
    let described = wheels
        .iter()
        .enumerate()
        .map(|(index, ([x, y, heading], _))| {
            let wheel = Wheel::powered(format!("{index}")).at(*x, *y).radius(0.1);
            wheel.heading(Angle::from_rad(*heading))
        });
    let robot = Robot::new("wheels".into(), described.collect()).unwrap();
    let mut bank = WheelBank::new(&robot, &FilterSettings::default());
    for (wheel, (_, rim)) in wheels.into_iter().enumerate() {
        let read_ns = NOW_NS - if wheel + 1 == N { silent_ns } else { 0 };
        let channel = &mut bank.channels[wheel];
        let rate = rim / 0.1;
        channel
            .track
            .take(read_ns, &Measurement::WheelRate { wheel, rate })
            .unwrap();
        let rim = Measured {
            value: rim,
            variance: RIM_VARIANCE_M2_PER_S2,
        };
        // windows that ended one after the other
        channel.rim = Some((rim, NOW_NS - 2 * MS * i64::try_from(wheel).unwrap()));
        channel.rim_window = WINDOW_S;
    }
    bank
}

fn step(ways: &[f64], yaw_rate: f64, rim_share: f64) -> RimStep {
    RimStep {
        now_ns: NOW_NS,
        dt: DT_S,
        ways: core::array::from_fn(|i| ways.get(i).copied().unwrap_or(0.0)),
        yaw_rate,
        rim_share,
        direction: -1.2,
    }
}

fn flat(rims: &Rims) -> [f64; 7] {
    [
        rims.way,
        rims.direction,
        rims.speed,
        rims.variance,
        rims.lag,
        rims.gained,
        rims.max_slip,
    ]
}

fn assert_near(rims: Option<Rims>, expected: [f64; 7]) {
    let is = flat(&rims.unwrap());
    for (a, b) in is.into_iter().zip(expected) {
        assert!((a - b).abs() < 1e-12, "{is:?} {expected:?}");
    }
}

/// Three wheels ahead at heading 0.3: arms x sin − y cos of the turn, which is taken off each rim and way.
#[test]
fn parallel_rims_have_the_mean_of_those_near_their_median() {
    const HEADING_RAD: f64 = 0.3;
    let places = [[0.5, 0.4], [0.1, -0.4], [-0.5, 0.3]];
    let arm = |[x, y]: [f64; 2]| x * f64::sin(HEADING_RAD) - y * f64::cos(HEADING_RAD);
    // a turn of the robot of 0.08 rad/s is one of 0.1 rad/s by rims that slip by 0.2
    let turn = 0.08 / 0.8;
    let levels = [0.5, 0.52, 0.61];
    let wheels: [_; 3] = core::array::from_fn(|i| {
        let [x, y] = places[i];
        ([x, y, HEADING_RAD], levels[i] + turn * arm(places[i]))
    });
    let ways: [f64; 3] =
        core::array::from_fn(|i| 0.004 + 0.001 * i as f64 + turn * DT_S * arm(places[i]));
    let gained = |wheel: &WheelChannel| Some(0.03 * wheel.row[2].signum() + 0.1);
    let rims = mean_rims(&step(&ways, 0.08, 0.8), &bank(wheels, 0), gained);
    // all three are within 20 % of 0.52 m/s; windows end 2 ms apart
    let gains = places.map(|place| 0.03 * arm(place).signum() + 0.1);
    let variance = RIM_VARIANCE_M2_PER_S2 / 3.0 + RIM_CREEP_M_PER_S * RIM_CREEP_M_PER_S;
    let mean = |values: [f64; 3]| values.iter().sum::<f64>() / 3.0;
    let expected = [
        0.005,
        HEADING_RAD,
        mean(levels),
        variance,
        0.022,
        mean(gains),
        1.0,
    ];
    assert_near(rims, expected);
    // one that is 21 % off is left out
    let mut off = wheels;
    off[2].1 += 0.52 * 1.21 - levels[2];
    let rims = mean_rims(&step(&ways, 0.08, 0.8), &bank(off, 0), gained);
    let variance = RIM_VARIANCE_M2_PER_S2 / 2.0 + RIM_CREEP_M_PER_S * RIM_CREEP_M_PER_S;
    let gain = 0.5 * (gains[0] + gains[1]);
    assert_near(
        rims,
        [0.0045, HEADING_RAD, 0.51, variance, 0.021, gain, 1.0],
    );
    // beside one that is silent beyond the dropout time two are no majority: both count
    let rims = mean_rims(&step(&ways, 0.08, 0.8), &bank(wheels, 500 * MS), gained);
    assert_near(
        rims,
        [0.0045, HEADING_RAD, 0.51, variance, 0.021, gain, 1.0],
    );
    // a robot that hardly moves beside its rims turns them by ten times its turn at most
    let rims = mean_rims(&step(&ways, 0.0, 0.01), &bank(wheels, 0), gained).unwrap();
    let slowly = mean_rims(&step(&ways, 0.01, 0.01), &bank(wheels, 0), gained).unwrap();
    let arms = mean(places.map(arm));
    assert!((rims.speed - slowly.speed - 0.1 * arms).abs() < 1e-12);
}

#[test]
fn rims_that_stand_count_by_their_sigma_and_those_that_run_apart_all() {
    let ahead = |rims: [f64; 4]| {
        let places = [(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)];
        let mut rims = rims.into_iter();
        bank(places.map(|(x, y)| ([x, y, 0.0], rims.next().unwrap())), 0)
    };
    let speed = |rims: [f64; 4]| {
        let rims = mean_rims(&step(&[0.001; 4], 0.0, 1.0), &ahead(rims), |_| None).unwrap();
        (rims.speed, rims.max_slip)
    };
    let near = |is: (f64, f64), expected: (f64, f64)| {
        (is.0 - expected.0).abs() < 1e-12 && (is.1 - expected.1).abs() < 1e-12
    };
    // 3 σ are 0.03 m/s; the median is 0.001 m/s
    assert!(near(speed([0.0, 0.0, 0.002, 0.029]), (0.007_75, 1.0)));
    assert!(near(speed([0.0, 0.0, 0.002, 0.04]), (0.002 / 3.0, 1.0)));
    // 0.3 m/s one way and 0.5 m/s the other: none is near the middle, and the slowest runs against the mean
    assert!(near(speed([-0.3, -0.3, 0.5, 0.5]), (0.1, 4.0)));
    assert!(near(speed([0.3, 0.3, -0.5, -0.5]), (-0.1, 4.0)));
    assert!(near(speed([-0.3, -0.3, 0.9, 0.9]), (0.3, 2.0)));
    assert!(near(
        speed([-0.49, -0.49, 0.5, 0.5]),
        (0.005, 1.0 + MAX_AGAINST_SHARE)
    ));
}

/// Rims of wheels that are not parallel, of a robot that moves at a velocity without turning: each shows its part of it.
#[test]
fn rims_that_are_not_parallel_show_the_direction() {
    let velocity = [0.3, 0.12];
    // omnidirectional wheels, which roll across as well
    let headings = [0.0, 0.7, -0.7, 2.0];
    let places = [[0.5, 0.4], [0.5, -0.4], [-0.5, 0.4], [-0.5, -0.4]];
    let along = |heading: f64, [x, y]: [f64; 2]| x * f64::cos(heading) + y * f64::sin(heading);
    let wheels = |velocity: [f64; 2]| -> [_; 4] {
        core::array::from_fn(|i| {
            let [x, y] = places[i];
            ([x, y, headings[i]], along(headings[i], velocity))
        })
    };
    let ways = headings.map(|heading| along(heading, velocity.map(|v| v * DT_S)));
    let rims = mean_rims(&step(&ways, 0.0, 1.0), &bank(wheels(velocity), 0), |_| {
        Some(0.2)
    });
    let speed = f64::hypot(velocity[0], velocity[1]);
    let variance = RIM_VARIANCE_M2_PER_S2 / 4.0 + RIM_CREEP_M_PER_S * RIM_CREEP_M_PER_S;
    let direction = f64::atan2(velocity[1], velocity[0]);
    let expected = [speed * DT_S, direction, speed, variance, 0.023, 0.2, 1.0];
    assert_near(rims, expected);
    // slower than rims turn, the direction is the one before
    let slow = velocity.map(|v| v * 0.9 * TURNING_SPEED_M_PER_S / speed);
    let rims = mean_rims(&step(&ways, 0.0, 1.0), &bank(wheels(slow), 0), |_| None).unwrap();
    assert_eq!(rims.direction, -1.2);
    let part = |[x, y]: [f64; 2]| x * f64::cos(-1.2) + y * f64::sin(-1.2);
    assert!(
        (rims.speed - part(slow)).abs() < 1e-12 && (rims.way - DT_S * part(velocity)).abs() < 1e-12
    );
}

/// Wheels of one heading that are steered to either side: one that slips turns the direction by little.
#[test]
fn steered_wheels_do_not_move_across_themselves() {
    const STEERING_RAD: f64 = 0.3;
    const HEADING_RAD: f64 = 1.0;
    let (sin, cos) = f64::sin_cos(HEADING_RAD);
    let turn = 0.4 * f64::sin(STEERING_RAD) / 0.5;
    for rear in [0.4, 0.5] {
        let wheels = [
            ([0.5 * cos, 0.5 * sin, HEADING_RAD], 0.4),
            ([-0.5 * cos, -0.5 * sin, HEADING_RAD], rear),
        ];
        let mut bank = bank(wheels, 0);
        bank.steer(0, STEERING_RAD).unwrap();
        bank.steer(1, -STEERING_RAD).unwrap();
        // both roll on an arc about a point to the left; the middle moves ahead at v cos
        let rims = mean_rims(&step(&[0.004; 2], turn, 1.0), &bank, |_| None).unwrap();
        assert!(
            (rims.direction - HEADING_RAD).abs() < 0.01,
            "{}",
            rims.direction
        );
        let speed = 0.4 * f64::cos(STEERING_RAD);
        assert!((rims.way - speed * DT_S).abs() < 1e-4 * speed);
        assert!(rear > 0.4 || (rims.speed - speed).abs() < 1e-4);
    }
    // one way or the other way round is one way
    for (other, is_one_way) in [
        (HEADING_RAD, true),
        (HEADING_RAD + core::f64::consts::PI, true),
        (HEADING_RAD + 0.03, false),
        (HEADING_RAD - 0.03, false),
    ] {
        let wheels = [([0.5, 0.0, HEADING_RAD], 0.4), ([-0.5, 0.0, other], 0.4)];
        assert_eq!(roll_one_way(&bank(wheels, 0)), is_one_way, "{other}");
    }
}

#[test]
fn one_wheel_is_its_own_mean_and_two_are_no_majority() {
    let alone = bank([([0.5, 0.0, 0.0], 0.4)], 0);
    let rims = mean_rims(&step(&[0.004], 0.0, 1.0), &alone, |_| None).unwrap();
    assert_eq!((rims.way, rims.speed), (0.004, 0.4));
    // also where one is within its sigma of their median and the other is not
    let mut two = bank([([0.5, 0.0, 0.0], 0.1), ([-0.5, 0.0, 0.0], 0.5)], 0);
    if let Some((rim, _)) = &mut two.channels[0].rim {
        rim.variance = 0.04;
    }
    let rims = mean_rims(&step(&[0.001, 0.005], 0.0, 1.0), &two, |_| None).unwrap();
    assert!((rims.speed - 0.3).abs() < 1e-15 && (rims.way - 0.003).abs() < 1e-15);
}

/// A wheel across the others that has not been read yet does not make them show a sideways speed, which a steering angle of a hair then
/// would, greater than any.
#[test]
fn wheels_that_roll_one_way_are_parallel_beside_one_that_was_not_read() {
    const HAIR_RAD: f64 = 6.7e-67;
    let mut bank = bank(
        [
            ([0.4, 0.3, 0.0], 0.31),
            ([0.4, -0.3, HAIR_RAD], 0.3),
            ([-0.4, 0.3, 0.0], 0.29),
            ([-0.4, -0.3, 1.2], 0.7),
        ],
        0,
    );
    bank.channels[3].rim = None;
    let rims = mean_rims(&step(&[0.01; 4], 0.0, 1.0), &bank, |_| None).unwrap();
    assert!((rims.speed - 0.3).abs() < 1e-12 && rims.direction.abs() < 1e-12);
    assert!((rims.way - 0.01).abs() < 1e-12);
}
