use super::*;
use crate::filter::estimator::Core;
use crate::filter::pulse_check;
use crate::filter::recovery::tests::{MS, NOW_NS, RADIUS_M, core, core_of, near, roll, rolling};
use crate::robot::Wheel;
use crate::sample::Measurement;

const PLACES_M: [(f64, f64); 4] = [(0.5, 0.4), (0.5, -0.3), (-0.6, 0.35), (-0.6, -0.45)];

/// Four powered wheels that roll at these speeds, m/s.
fn four(rims: [f64; 4]) -> Core {
    let mut core = core_of(at(&PLACES_M));
    for (wheel, rim) in rims.into_iter().enumerate() {
        roll(&mut core, wheel, NOW_NS, &[rim; 3]);
    }
    core
}

fn at(places: &[(f64, f64)]) -> Vec<Wheel> {
    let wheel = |(x, y): &(f64, f64)| {
        Wheel::powered(format!("{x} {y}"))
            .at(*x, *y)
            .radius(RADIUS_M)
    };
    places.iter().map(wheel).collect()
}

/// A robot that steers all its wheels to one side drifts across its wheels, not across its body.
#[test]
fn the_sideways_speed_is_that_of_the_wheels_as_they_stand() {
    let places = [(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)];
    let wheels = places.map(|(x, y)| Wheel::powered(format!("{x} {y}")).at(x, y).radius(0.1));
    let robot = Robot::new("crab".into(), wheels.into()).unwrap();
    let mut bank = WheelBank::new(&robot, &FilterSettings::default());
    let is = |bank: &WheelBank, expected: [f64; 3]| {
        let row = bank.lateral.unwrap();
        row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12)
    };
    assert!(is(&bank, [0.0, 1.0, 0.0]));
    // as long as one of them was never turned
    for wheel in 0..4 {
        bank.steer(wheel, 0.0).unwrap();
        assert!(is(&bank, [0.0, 1.0, 0.0]));
    }
    for wheel in 0..4 {
        assert!(is(&bank, [0.0, 1.0, 0.0]));
        bank.steer(wheel, 0.5).unwrap();
    }
    assert!(is(&bank, [-f64::sin(0.5), f64::cos(0.5), 0.0]));
    // on an arc about a point beside the robot the mean of all wheels does not move sideways
    for (wheel, (x, y)) in places.into_iter().enumerate() {
        bank.steer(wheel, f64::atan2(x, 2.0 - y)).unwrap();
    }
    let [across, along, turn] = bank.lateral.unwrap();
    let speed = across * 2.0 + turn;
    assert!(speed.abs() < 1e-12 && along > 0.8, "{:?}", bank.lateral);
}

#[test]
fn wheels_that_are_not_steered_move_along_themselves() {
    let mut bank = core_of(at(&PLACES_M)).wheels;
    for angle in [0.1, 0.2] {
        bank.steer(0, angle).unwrap();
        bank.steer(1, angle).unwrap();
    }
    // both behind are 0.6 m behind
    for (found, expected) in bank.lateral.unwrap().into_iter().zip([0.0, 1.0, -0.6]) {
        near(found, expected);
    }
    bank.lateral = None;
    bank.steer(0, 0.3).unwrap();
    assert_eq!(bank.lateral, None);
    let unknown = Fault::UnknownWheel {
        index: 4,
        wheels: 4,
    };
    assert_eq!(bank.steer(4, 0.1), Err(unknown));
    assert_eq!(bank.get_mut(4).err(), Some(unknown));
    // one of four weighs as all together
    near(bank.mean_weight, 1.0 - 0.8_f64.powi(4));
    near(core(true).wheels.mean_weight, 1.0 - 0.8 * 0.8);
    // headings that differ by less than a sine of 0.02, either way
    for (angle, is_parallel) in [
        (0.019, true),
        (-0.019, true),
        (0.021, false),
        (-0.021, false),
    ] {
        let mut wheels = at(&PLACES_M);
        wheels[0].heading = grouser_terra::Angle::from_rad(0.3);
        for wheel in &mut wheels[1..] {
            wheel.heading = grouser_terra::Angle::from_rad(0.3 + angle);
        }
        let lateral = core_of(wheels).wheels.lateral;
        assert_eq!(lateral.is_some(), is_parallel);
        for (found, expected) in
            lateral
                .into_iter()
                .flatten()
                .zip([-f64::sin(0.3), f64::cos(0.3), 0.0])
        {
            near(found, expected);
        }
    }
}

#[test]
fn a_row_is_whole_when_all_that_came_together_have_come() {
    let (before, now) = (NOW_NS - 20 * MS, NOW_NS);
    let read = |core: &mut Core, wheel: usize, to_ns: i64| {
        let channel = &mut core.wheels.channels[wheel];
        channel.read_before_ns = channel.track.newest_time().unwrap_or(i64::MIN);
        let rate = Measurement::WheelRate { wheel, rate: 1.0 };
        channel.track.take(to_ns, &rate).unwrap();
    };
    let mut core = core(true);
    assert!(!core.wheels.is_whole_row(now) && !core.wheels.measure_ways());
    for wheel in 0..2 {
        read(&mut core, wheel, before);
    }
    // the third goes by itself
    read(&mut core, 2, before + MS);
    assert!(!core.wheels.is_whole_row(now));
    read(&mut core, 0, now);
    assert!(!core.wheels.is_whole_row(now));
    read(&mut core, 1, now);
    assert!(core.wheels.is_whole_row(now));
    read(&mut core, 2, now + MS);
    assert!(core.wheels.is_whole_row(now + MS));
    let angle = Measurement::WheelAngle {
        wheel: 1,
        angle: 1.0,
    };
    core.wheels.channels[1]
        .track
        .take(now + MS, &angle)
        .unwrap();
    assert!(core.wheels.measure_ways());
    assert!(rolling(&[0.0, 0.1]).wheels.any_turns() && !rolling(&[0.0; 2]).wheels.any_turns());
}

#[test]
fn unequal_rims_show_a_turn() {
    let rims = [0.5, 0.62, 0.47, 0.71];
    let arms = PLACES_M.map(|(_, y)| -y);
    // the slope of a line through the rims' speeds over their arms
    let slope = |of: &[usize]| {
        let count = of.len() as f64;
        let mean = |values: [f64; 4]| of.iter().map(|&i| values[i]).sum::<f64>() / count;
        let off = |i: usize| arms[i] - mean(arms);
        let product: f64 = of.iter().map(|&i| off(i) * (rims[i] - mean(rims))).sum();
        product / of.iter().map(|&i| off(i) * off(i)).sum::<f64>()
    };
    let mut core = four(rims);
    near(core.wheels.yaw_rate().unwrap(), slope(&[0, 1, 2, 3]));
    // without one that turns against the robot's travel
    core.wheels.channels[1].against_since_ns = Some(0);
    near(core.wheels.yaw_rate().unwrap(), slope(&[0, 2, 3]));
    core.wheels.channels[2].rim = None;
    assert_eq!(core.wheels.yaw_rate(), None);
    let mut core = four(rims);
    core.wheels.lateral = None;
    assert_eq!(core.wheels.yaw_rate(), None);
    // wheels behind one another
    let mut core = core_of(at(&[(0.5, 0.2), (-0.5, 0.2)]));
    for wheel in 0..2 {
        roll(&mut core, wheel, NOW_NS, &[0.5; 3]);
    }
    assert_eq!(core.wheels.yaw_rate(), None);
    near(core.wheels.yaw_rate_sigma(&core.state), 0.0);
}

#[test]
fn the_error_of_a_turn_by_wheels_is_that_of_their_slips() {
    let rims = [0.5, 0.62, -0.47, 0.71];
    let mut core = four(rims);
    let arms = PLACES_M.map(|(_, y)| -y);
    let square: f64 = arms.iter().map(|arm| arm * arm).sum();
    let own = [0.05, -0.1, 0.15, 0.2];
    for (i, slip) in own.into_iter().enumerate() {
        core.state.set_mean(own_slip(i), slip);
    }
    let sum =
        |slips: [f64; 4]| -> f64 { (0..4).map(|i| (arms[i] * rims[i] * slips[i]).powi(2)).sum() };
    near(
        core.wheels.yaw_rate_sigma(&core.state),
        f64::sqrt(sum(own)) / square,
    );
    // half of the turn is a skid
    let expected = f64::hypot(f64::sqrt(sum([0.08; 4])) / square, 0.5 * 0.3);
    near(core.wheels.turn_sigma(-0.3, &core.settings), expected);
    // free wheels do not count, nor those without a window
    core.wheels.channels[2].free = true;
    core.wheels.channels[3].rim = None;
    let square = square - arms[2] * arms[2];
    let sum =
        |slips: [f64; 4]| -> f64 { (0..2).map(|i| (arms[i] * rims[i] * slips[i]).powi(2)).sum() };
    near(
        core.wheels.yaw_rate_sigma(&core.state),
        f64::sqrt(sum(own)) / square,
    );
    near(
        core.wheels.turn_sigma(0.0, &core.settings),
        f64::sqrt(sum([0.08; 4])) / square,
    );
    // wheels near one another
    let mut close = core_of(at(&[(0.5, 0.02), (0.5, -0.02)]));
    for (wheel, rim) in [0.5, 0.3].into_iter().enumerate() {
        roll(&mut close, wheel, NOW_NS, &[rim; 3]);
    }
    let expected = 0.02 * f64::hypot(0.5, 0.3) * 0.08 / (2.0 * 0.02 * 0.02);
    near(close.wheels.turn_sigma(0.0, &close.settings), expected);
    // up to three sigma
    core.settings.wheel_slip_sigma = 0.0625;
    for (slip, alike) in [
        (0.1875, true),
        (-0.1875, true),
        (0.19, false),
        (-0.19, false),
    ] {
        core.state.set_mean(own_slip(3), slip);
        assert_eq!(core.wheels.slip_alike(&core.state, &core.settings), alike);
    }
    core.state.set_mean(own_slip(3), 0.1);
    core.state.set_mean(own_slip(2), 0.9);
    assert!(core.wheels.slip_alike(&core.state, &core.settings));
}

#[test]
fn a_steered_turn_is_that_about_the_wheels_axes() {
    const SPEED_M_PER_S: f64 = 0.8;
    // about a point 2 m to the left of the middle of the axle behind, by wheels in front
    let mut core = core_of(at(&PLACES_M));
    assert_eq!(
        core.wheels.steered_turn(SPEED_M_PER_S, &core.settings),
        None
    );
    for (wheel, (x, y)) in PLACES_M.into_iter().enumerate().take(2) {
        core.wheels.steer(wheel, 0.0).unwrap();
        core.wheels
            .steer(wheel, f64::atan2(x + 0.6, 2.0 - y))
            .unwrap();
    }
    let turn = core
        .wheels
        .steered_turn(SPEED_M_PER_S, &core.settings)
        .unwrap();
    assert!((turn.value - SPEED_M_PER_S / 2.0).abs() < 1e-5, "{turn:?}");
    // by the arms along the way
    let arms: [f64; 4] = core::array::from_fn(|i| core.wheels.channels[i].steering.across()[2]);
    let mean = arms.iter().sum::<f64>() / 4.0;
    let square: f64 = arms.iter().map(|arm| (arm - mean).powi(2)).sum();
    let variance = (0.01_f64.powi(2) + (0.05 * SPEED_M_PER_S).powi(2)) / square;
    near(turn.variance, variance);
    // that do not agree: least squares over the speed to 1 mm/s and no speed across each wheel, by Cramer's rule
    core.wheels.steer(1, 0.1).unwrap();
    let mut normal = [[1e6, 0.0, 0.0], [0.0; 3], [0.0; 3]];
    let sigma_2 = 0.01_f64.powi(2) + (0.05 * SPEED_M_PER_S).powi(2);
    for wheel in core.wheels.iter() {
        let row = wheel.steering.across();
        for (i, line) in normal.iter_mut().enumerate() {
            for (slot, part) in line.iter_mut().zip(row) {
                *slot += row[i] * part / sigma_2;
            }
        }
    }
    let determinant = |m: [[f64; 3]; 3]| {
        let minor = |a: usize, b: usize| m[1][a] * m[2][b] - m[1][b] * m[2][a];
        m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1)
    };
    let mut of_turn = normal;
    for (line, right) in of_turn.iter_mut().zip([1e6 * SPEED_M_PER_S, 0.0, 0.0]) {
        line[2] = right;
    }
    let found = core
        .wheels
        .steered_turn(SPEED_M_PER_S, &core.settings)
        .unwrap();
    let expected = determinant(of_turn) / determinant(normal);
    assert!(
        (found.value - expected).abs() < 1e-9,
        "{found:?} {expected}"
    );
    // wheels beside one another
    let mut core = core_of(at(&[(0.5, 0.2), (0.5, -0.2)]));
    for wheel in 0..2 {
        core.wheels.steer(wheel, 0.0).unwrap();
        core.wheels.steer(wheel, 0.02).unwrap();
    }
    assert_eq!(
        core.wheels.steered_turn(SPEED_M_PER_S, &core.settings),
        None
    );
}

#[test]
fn the_speed_without_slip_is_that_of_all_rims_that_are_received() {
    let mut core = rolling(&[0.5, 0.64, 0.3]);
    let dropout_s = core.settings.dropout;
    // v − y Ω = u, with Ω = 0 ± 10 rad/s and each rim to 0.01 m/s
    let two = |rims: [f64; 2], arms: [f64; 2]| {
        let weight = 1e4;
        let sum: f64 = arms.iter().sum();
        let [a, b, d] = [
            2.0,
            sum,
            arms[0] * arms[0] + arms[1] * arms[1] + 1e-2 / weight,
        ];
        let (e, f) = (rims[0] + rims[1], rims[0] * arms[0] + rims[1] * arms[1]);
        (e * d - b * f) / (a * d - b * b)
    };
    let found = core.wheels.forward_speed(NOW_NS, dropout_s);
    assert!(
        (found - two([0.5, 0.64], [-0.4, 0.3])).abs() < 1e-9,
        "{found}"
    );
    near(
        core.wheels.mean_powered_rim(NOW_NS, dropout_s).unwrap(),
        0.57,
    );
    near(core.wheels.fastest_rim().unwrap(), 0.64);
    roll(&mut core, 1, NOW_NS + 100 * MS, &[-0.7]);
    let now_ns = NOW_NS + 101 * MS;
    near(
        core.wheels.mean_powered_rim(now_ns, dropout_s).unwrap(),
        -0.7,
    );
    near(core.wheels.fastest_rim().unwrap(), -0.7);
    // one alone shows no turn
    let found = core.wheels.forward_speed(now_ns, dropout_s);
    assert!((found + 0.7).abs() < 1e-9);
    let late_ns = NOW_NS + 999 * MS;
    assert_eq!(core.wheels.mean_powered_rim(late_ns, dropout_s), None);
    assert_eq!(core.wheels.forward_speed(late_ns, dropout_s), 0.0);
    // the first of two that are as fast
    near(rolling(&[-0.5, 0.5]).wheels.fastest_rim().unwrap(), -0.5);
}

#[test]
fn a_pace_is_that_of_the_median_wheel() {
    let mut core = core_of(at(&PLACES_M));
    let dropout_s = core.settings.dropout;
    near(core.wheels.pace(NOW_NS, dropout_s), 0.0);
    for (wheel, gained) in [0.9, -0.02, -0.03, -0.04].into_iter().enumerate() {
        roll(&mut core, wheel, NOW_NS, &[0.5, 0.5, 0.5 + gained]);
    }
    // windows of 0.1 s
    near(core.wheels.pace(NOW_NS, dropout_s), 0.025 / f64::sqrt(0.1));
    // without the fourth and with the first
    roll(&mut core, 1, NOW_NS + MS, &[0.48]);
    roll(&mut core, 2, NOW_NS + MS, &[0.47]);
    near(
        core.wheels.pace(NOW_NS + 101 * MS, dropout_s),
        0.025 / f64::sqrt(0.1),
    );
}

#[test]
fn slips_change_together_where_most_are_off_to_one_side() {
    let mut core = four([0.5; 4]);
    for (means, together) in [
        ([0.8, 0.9, 1.0, -0.1], true),
        ([-0.8, -0.9, -1.0, 0.1], true),
        // half of them
        ([0.36, 0.34, 1.2, 1.2], true),
        ([0.34, 0.34, 1.2, 1.2], false),
        // a median of exactly 0.7
        ([0.7, 0.7, 0.7, 0.7], false),
        ([0.71, 0.71, 0.71, 0.71], true),
        ([0.0, 0.0, 0.0, 4.0], false),
        // two of four beyond 0.35 on the side of a median of 1
        ([-5.0, 0.35, 1.65, 2.0], false),
    ] {
        for (wheel, mean) in core.wheels.channels.iter_mut().zip(means) {
            wheel.mean_innovation = mean;
        }
        assert_eq!(core.wheels.slips_change_together(), together, "{means:?}");
    }
    let free = Wheel::free("free").radius(RADIUS_M);
    assert!(!core_of(vec![free.clone()]).wheels.slips_change_together());
    // against a free wheel: all of them, or half of them by 1.3
    let mut core = core_of([at(&PLACES_M), vec![free.clone()]].concat());
    for (of_free, means, oppose) in [
        (1.5, [-0.1, -0.2, -0.3, -0.4], true),
        (-1.5, [0.1, 0.2, 0.3, 0.4], true),
        (-1.5, [0.1, 0.2, 0.3, 0.0], false),
        (-1.5, [1.4, 1.5, -0.3, 0.0], true),
        (1.5, [1.4, 1.5, -0.3, 0.0], false),
        (-1.5, [1.4, 1.3, -0.3, 0.0], false),
        (1.3, [-1.4; 4], false),
        (1.31, [-1.4; 4], true),
    ] {
        for (wheel, mean) in core.wheels.channels.iter_mut().zip(means) {
            wheel.mean_innovation = mean;
        }
        core.wheels.channels[4].mean_innovation = of_free;
        assert_eq!(core.wheels.slips_oppose(4), oppose, "{of_free} {means:?}");
    }
    let mut two = self::core(true);
    for (of_free, means) in [(0.0, [0.3, 1.5]), (-1.5, [0.5, -0.5])] {
        for (wheel, mean) in two.wheels.channels.iter_mut().zip(means) {
            wheel.mean_innovation = mean;
        }
        two.wheels.channels[2].mean_innovation = of_free;
        assert!(!two.wheels.slips_change_together() && !two.wheels.slips_oppose(2));
    }
    let mut alone = core_of(vec![free]);
    alone.wheels.channels[0].mean_innovation = 9.0;
    assert!(!alone.wheels.slips_oppose(0));
}

#[test]
fn the_usual_share_of_missed_pulses_is_that_of_the_others() {
    let mut core = four([0.5; 4]);
    near(core.wheels.usual_missed_share(1), 0.0);
    for (wheel, share) in core
        .wheels
        .channels
        .iter_mut()
        .zip([0.05, 0.03, 0.09, 0.07])
    {
        wheel.pulses = pulse_check::tests::known(share);
    }
    for (index, expected) in [0.07, 0.07, 0.05, 0.05].into_iter().enumerate() {
        near(core.wheels.usual_missed_share(index), expected);
    }
    // the larger one of two in the middle
    core.wheels.channels[0].pulses = pulse_check::PulseCheck::new(1.0, 960.0);
    near(core.wheels.usual_missed_share(1), 0.09);
}

#[test]
fn a_median_is_the_middle_or_the_mean_of_both() {
    for (values, expected) in [
        (&[][..], None),
        (&[3.0], Some(3.0)),
        (&[3.0, 1.0], Some(2.0)),
        (&[9.0, 1.0, 3.0], Some(3.0)),
        (&[9.0, 1.0, 3.0, 4.0], Some(3.5)),
        (&[9.0, 1.0, 3.0, 4.0, -2.0], Some(3.0)),
    ] {
        assert_eq!(median(values.iter().copied()), expected);
    }
}

/// Rims at 0.3 m/s to both sides of a robot that is as fast: what a turn adds to them is a third at the wheels 0.4 m to the left
/// where it is 0.25 rad/s.
#[test]
fn a_turn_that_drags_one_side_and_holds_the_other_back_is_forced() {
    const RIM_M_PER_S: f64 = 0.3;
    let row = |core: &Core, wheel: usize| core.wheels.channels[wheel].row[2];
    let turning = |by_wheels: f64| {
        let still = four([RIM_M_PER_S; 4]);
        four(core::array::from_fn(|wheel| {
            RIM_M_PER_S + row(&still, wheel) * by_wheels
        }))
    };
    for (by_wheels, speed, turn, forced) in [
        (0.0, 0.3, 0.26, true),
        (0.0, 0.3, -0.26, true),
        (0.0, 0.3, 0.24, false),
        (0.0, 0.3, -0.24, false),
        // by both wheels of each side
        (0.0, 0.3, 0.35, true),
        // one side slips, the other rolls
        (0.0, 0.2, 0.26, false),
        (0.0, 0.4, 0.26, false),
        // the rims turn the robot too
        (0.079, 0.3, 0.4, true),
        (0.081, 0.3, 0.4, false),
        (-0.081, 0.3, 0.4, false),
    ] {
        let core = turning(by_wheels);
        let found = core.wheels.are_forced((speed, turn), 0.05);
        assert_eq!(found, forced, "{by_wheels} {speed} {turn}");
    }
    let mut core = turning(0.0);
    let rim = |wheel: usize| core.wheels.channels[wheel].rim.unwrap().0.value;
    assert!((0..4).all(|wheel| rim(wheel) == rim(0)));
    assert!(!core.wheels.are_forced((0.3, 0.26), rim(0)));
    // 0.2, 0.38, 0.21, 0.42 m/s of ground under them, and 0.4, 0.22, 0.39, 0.18 the other way round
    let unequal = four([0.35, 0.411_67, 0.3, 0.27]);
    assert!(unequal.wheels.are_forced((0.3, 0.26), 0.05));
    assert!(!unequal.wheels.are_forced((0.3, -0.26), 0.05));
    // rims that turn it as little as the gyro: not at all
    let mut straight = core_of(at(&[(0.0, 0.5), (0.0, -0.5), (1.0, 0.5), (1.0, -0.5)]));
    for (wheel, rim) in [0.25, 0.25, 1.0, 1.0].into_iter().enumerate() {
        roll(&mut straight, wheel, NOW_NS, &[rim; 3]);
    }
    assert!(!straight.wheels.are_forced((0.5, 0.0), 0.05));
    assert!(straight.wheels.are_forced((0.5, 1e-9), 0.05));
    // backwards, and with a wheel that a wrong turn has running against the travel
    let back = four([-RIM_M_PER_S; 4]);
    assert!(back.wheels.are_forced((-0.3, 0.26), 0.05));
    core.wheels.channels[0].against_since_ns = Some(NOW_NS);
    assert!(core.wheels.are_forced((0.3, 0.26), 0.05));
    core.wheels.lateral = None;
    assert!(!core.wheels.are_forced((0.3, 0.26), 0.05));
}
