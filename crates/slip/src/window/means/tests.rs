use super::*;
use crate::robot::Wheel;
use grouser_terra::Angle;

const MS: i64 = 1_000_000;
const ALL_SIGMA: f64 = 0.01;

fn settings(reference: Reference) -> WindowSettings {
    WindowSettings {
        reference,
        position_sigma: 0.001,
        lateral_sigma: ALL_SIGMA,
        ..WindowSettings::default()
    }
}

fn means(wheels: &[Wheel], reference: Reference) -> WindowMeans {
    let mut wheels = wheels.to_vec();
    for (index, wheel) in wheels.iter_mut().enumerate() {
        wheel.name = format!("{index}");
    }
    let robot = Robot::new("cart".into(), wheels).unwrap();
    WindowMeans::new(&robot, settings(reference)).unwrap()
}

/// Three powered wheels and a free one, all of 0.1 m, that send angles.
fn cart() -> [Wheel; 4] {
    [
        Wheel::powered("left").at(0.0, 0.2),
        Wheel::powered("right").at(0.0, -0.2),
        Wheel::powered("middle").at(0.1, 0.0),
        Wheel::free("free").at(-0.3, 0.0),
    ]
}

fn sample(ms: i64, measurement: Measurement) -> Sample {
    Sample {
        time_ns: ms * MS,
        measurement,
    }
}

/// A wheel's way in m.
fn way(wheel: usize, metres: f64) -> Measurement {
    let angle = metres / 0.1;
    Measurement::WheelAngle { wheel, angle }
}

fn speed(forward: f64) -> Measurement {
    let left = None;
    Measurement::Speed { forward, left }
}

fn yaw_rate(rate: f64) -> Measurement {
    Measurement::YawRate { rate }
}

fn headed(heading: f64) -> Wheel {
    Wheel::powered("wheel").heading(Angle::from_rad(heading))
}

fn measured(value: f64) -> Measured {
    Measured {
        value,
        variance: 1e-8,
    }
}

fn near(value: f64, expected: f64) -> bool {
    (value - expected).abs() < 1e-9
}

fn all_near(value: [f64; 3], expected: [f64; 3]) -> bool {
    value.iter().zip(expected).all(|(v, e)| near(*v, e))
}

/// Rows of 20 ms: the wheels' ways by time (s) and the rest of the row, from the first row on.
fn run(
    means: &mut WindowMeans,
    rows: std::ops::RangeInclusive<i64>,
    ways: &[&dyn Fn(f64) -> f64],
    others: &[Measurement],
) {
    for row in rows {
        let ways = ways.iter().enumerate();
        let ways = ways.map(|(wheel, of)| way(wheel, of(0.02 * row as f64)));
        for measurement in ways.chain(others.iter().copied()) {
            means.update(sample(20 * row, measurement)).unwrap();
        }
    }
}

#[test]
fn wheels_that_all_point_one_way_cannot_drive_aside() {
    let one_way = |wheels: &[Wheel]| means(wheels, Reference::Speed).one_way;
    assert!(one_way(&[
        headed(0.7),
        headed(0.7),
        headed(0.7 - core::f64::consts::PI)
    ]));
    assert!(one_way(&[headed(0.7), headed(0.719)]));
    assert!(!one_way(&[headed(0.7), headed(0.721)]) && !one_way(&[headed(0.7), headed(0.679)]));
    assert!(!one_way(&[headed(-0.7), headed(0.7)]));
    // exactly the limit
    let limit = 0.02_f64.asin();
    assert_eq!(limit.sin(), 0.02);
    assert!(!one_way(&[headed(0.0), headed(limit)]));
    // a free wheel is another matter, and without any powered one there is no other way
    let free = Wheel::free("free").heading(Angle::from_rad(1.5));
    assert!(one_way(&[headed(0.0), free.clone()]) && one_way(&[free]));
    let sideways = |wheels: &[Wheel]| means(wheels, Reference::Speed).sideways();
    let free = Wheel::free("free").heading(Angle::from_rad(1.5));
    let aside = sideways(&[free.clone(), headed(0.7)]);
    assert!(all_near(aside, [-f64::sin(0.7), f64::cos(0.7), 0.0]));
    assert_eq!(sideways(&[headed(0.0), headed(1.0)]), [0.0, 1.0, 0.0]);
    assert_eq!(sideways(&[free]), [0.0, 1.0, 0.0]);
}

#[test]
fn a_drift_is_held_where_wheels_point_one_way_and_nothing_measures_it() {
    let sigma = |wheels: &[Wheel], is_held| {
        let mut seen = Observations::default();
        means(wheels, Reference::Speed).hold_sideways(&mut seen, is_held);
        for row in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] {
            seen.add(row, measured(0.0));
        }
        seen.solve().unwrap().covariance[1][1].sqrt()
    };
    let (parallel, crossed) = ([headed(0.0)], [headed(0.0), headed(1.0)]);
    assert!(near(sigma(&parallel, true), ALL_SIGMA));
    for sigma in [
        sigma(&parallel, false),
        sigma(&crossed, true),
        sigma(&crossed, false),
    ] {
        assert!(near(sigma, UNKNOWN_SPEED_SIGMA));
    }
    // what a camera measures is no drift to be held
    let mut by_camera = means(&cart(), Reference::Displacement);
    let displaced = Measurement::Displacement {
        forward: 0.004,
        left: 0.003,
        turn: Some(0.0),
    };
    let ahead = |time: f64| 0.2 * time;
    run(
        &mut by_camera,
        0..=50,
        &[&ahead, &ahead, &ahead],
        &[displaced],
    );
    let motion = by_camera.latest().unwrap().motion.unwrap();
    assert!((motion.velocity[1] - 0.15).abs() < 1e-4, "{motion:?}");
    // beside a free wheel it is
    let mut by_free = means(&cart(), Reference::FreeWheel);
    run(&mut by_free, 0..=50, &[&ahead, &ahead, &ahead, &ahead], &[]);
    let motion = by_free.latest().unwrap().motion.unwrap();
    assert!((motion.covariance[1][1].sqrt() / ALL_SIGMA - 1.0).abs() < 1e-3);
}

#[test]
fn a_slip_is_counted_along_the_command_or_the_wheels_way() {
    let direction = |means: &WindowMeans, velocity: [f64; 2]| {
        means.direction(&BodyMotion {
            velocity: [velocity[0], velocity[1], 0.3],
            covariance: [[0.0; 3]; 3],
        })
    };
    let parallel = means(&[headed(0.7), headed(0.7)], Reference::Speed);
    let along = direction(&parallel, [0.3, -0.4]);
    assert!(all_near(along, [f64::cos(0.7), f64::sin(0.7), 0.0]));
    let mut crossed = means(&[headed(0.0), headed(1.0)], Reference::Speed);
    assert!(all_near(direction(&crossed, [0.3, -0.4]), [0.6, -0.8, 0.0]));
    assert!(all_near(direction(&crossed, [0.0, 0.0]), [1.0, 0.0, 0.0]));
    let command = Measurement::Command {
        forward: -0.5,
        left: 0.0,
    };
    crossed.update(sample(0, command)).unwrap();
    assert!(all_near(direction(&crossed, [0.3, -0.4]), [-1.0, 0.0, 0.0]));
}

/// Readings are late one after the other: a free wheel, a powered one, a gyro.
#[test]
fn a_reference_is_known_as_far_as_the_oldest_of_its_readings() {
    let until = |reference, wheels: &[Wheel]| {
        let mut means = means(wheels, reference);
        let found = |means: &WindowMeans| means.reference_until(500 * MS).map(|ns| ns / MS);
        let mut all = Vec::new();
        let count = wheels.len();
        for (index, ms) in [(0, 100), (1, 80), (2, 90), (3, 70)] {
            if index < count {
                means.update(sample(ms, way(index, 0.0))).unwrap();
            }
            all.push(found(&means));
        }
        means.update(sample(60, yaw_rate(0.0))).unwrap();
        all.push(found(&means));
        all
    };
    let none = None;
    assert_eq!(
        until(Reference::FreeWheel, &cart()),
        [none, none, none, Some(70), Some(60)]
    );
    assert_eq!(until(Reference::FreeWheel, &cart()[..2]), [none; 5]);
    assert_eq!(
        until(Reference::Grip, &cart()),
        [none, none, Some(80), Some(80), Some(60)]
    );
    assert_eq!(until(Reference::Speed, &cart()), [none; 5]);
    // what the robot can never have
    let lacks = |reference, wheels: &[Wheel]| means(wheels, reference).lacks_reference();
    let (powered, free) = (&cart()[..3], &cart()[3..]);
    assert!(lacks(Reference::FreeWheel, powered) && !lacks(Reference::FreeWheel, &cart()));
    assert!(lacks(Reference::Grip, free) && !lacks(Reference::Grip, &cart()));
    assert!(!lacks(Reference::Speed, powered) && !lacks(Reference::Speed, free));
}

#[test]
fn now_is_the_newest_of_all_times() {
    let mut means = means(&cart(), Reference::Speed);
    let mut at = |ms, measurement| {
        means.accept(sample(ms, measurement)).unwrap();
        means.now_ns().unwrap() / MS
    };
    assert_eq!(at(100, way(0, 0.0)), 100);
    assert_eq!(at(90, way(1, 0.0)), 100);
    assert_eq!(at(110, speed(0.0)), 110);
    assert_eq!(at(95, way(1, 0.0)), 110);
    // silent from more than a dropout on
    assert!(!means.is_silent(100 * MS, 600 * MS) && means.is_silent(100 * MS, 601 * MS));
}

#[test]
fn the_wheel_that_runs_slowest_for_the_yaw_rate_grips() {
    let mut means = means(&cart(), Reference::Grip);
    // turning left at 0.5 rad/s: the sides differ by 0.2 m/s
    let mut slowest = |rims: [f64; 3]| {
        for (speed, rim) in means.speeds.iter_mut().zip(rims) {
            *speed = Some(measured(rim));
        }
        let (row, rim) = means.gripping(measured(0.5)).unwrap();
        (row[2], rim.value)
    };
    assert_eq!(slowest([0.25, 0.45, 0.3]), (0.0, 0.3));
    assert_eq!(slowest([0.1, 0.45, 0.3]), (-0.2, 0.1));
    assert_eq!(slowest([0.25, 0.35, 0.5]), (0.2, 0.35));
    assert_eq!(slowest([-0.3, -0.1, -0.1]), (0.0, -0.1));
    assert_eq!(slowest([-0.5, 0.2, -0.3]), (0.2, 0.2));
    // the first of equal ones
    let tied = {
        let mut means = super::tests::means(&cart(), Reference::Grip);
        for speed in &mut means.speeds {
            *speed = Some(measured(0.25));
        }
        means.gripping(measured(0.0)).unwrap().0[2]
    };
    assert_eq!(tied, -0.2);
    // and by it the robot's motion
    let mut means = super::tests::means(&cart(), Reference::Grip);
    let at = |speed: f64| move |time: f64| speed * time;
    let (fast, slow) = (at(0.4), at(0.3));
    run(
        &mut means,
        0..=50,
        &[&fast, &slow, &fast, &fast],
        &[yaw_rate(0.0)],
    );
    let motion = means.latest().unwrap().motion.unwrap();
    assert!((motion.velocity[0] - 0.3).abs() < 1e-6, "{motion:?}");
    means.speeds[1] = None;
    assert!(means.gripping(measured(0.0)).is_none());
}

#[test]
fn wheels_that_are_left_out_count_for_nothing_and_the_gyro_for_them() {
    let at = |speed: f64| move |time: f64| speed * time;
    let motion = |left_out| {
        let mut means = means(&cart(), Reference::Speed);
        means.leave_out(left_out);
        let (left, right, middle) = (at(0.2), at(0.4), at(0.3));
        let row = [speed(0.3), yaw_rate(0.1)];
        run(&mut means, 0..=50, &[&left, &right, &middle], &row);
        means.latest().unwrap().wheels_motion.unwrap().velocity
    };
    // by the wheels alone they turn at 0.5 rad/s
    let [forward, _, turn] = motion(0);
    assert!(
        (forward - 0.3).abs() < 1e-3 && (turn - 0.5).abs() < 1e-3,
        "{forward} {turn}"
    );
    // the right one stands out of it: 0.2 + 0.2 ω and 0.3 beside 0.1 rad/s
    let [forward, _, turn] = motion(0b10);
    assert!(
        (forward - 0.3).abs() < 0.05 && turn < 0.5,
        "{forward} {turn}"
    );
    // right and middle
    let [forward, _, turn] = motion(0b110);
    assert!(
        (forward - 0.22).abs() < 1e-3 && (turn - 0.1).abs() < 1e-3,
        "{forward} {turn}"
    );
    // left and middle
    let [forward, _, turn] = motion(0b101);
    assert!(
        (forward - 0.38).abs() < 1e-3 && (turn - 0.1).abs() < 1e-3,
        "{forward} {turn}"
    );
}

/// The wheels at 0.4 m/s beside 0.3 m/s over ground, for a second beyond the first window.
#[test]
fn distances_are_those_while_the_robot_moves() {
    let drive = |rim: f64, ground: f64| {
        let mut means = means(&cart(), Reference::Speed);
        let of = |time: f64| rim * time;
        run(&mut means, 0..=75, &[&of, &of, &of], &[speed(ground)]);
        means
    };
    let moving = drive(0.4, 0.3);
    let body = moving.latest().unwrap();
    assert!((body.travel_wheels - 0.4).abs() < 0.4 * 0.13, "{body:?}");
    assert!(
        (body.travel_reference / body.travel_wheels - 0.75).abs() < 1e-3,
        "{body:?}"
    );
    let back = drive(-0.4, -0.3);
    let body = back.latest().unwrap();
    assert!((body.travel_wheels + 0.4).abs() < 0.4 * 0.13, "{body:?}");
    // slower than 2 mm/s is none
    let resting = drive(0.001, 0.001);
    let body = resting.latest().unwrap();
    assert_eq!(body.along_motion, Some(Motion::Standstill));
    assert_eq!((body.travel_wheels, body.travel_reference), (0.0, 0.0));
    // a lost reference: the way is kept, and the rest forgotten
    let mut lost = drive(0.4, 0.3);
    let before = *lost.latest().unwrap();
    for ms in (1520..2100).step_by(20) {
        lost.update(sample(ms, way(0, 0.4 * 0.001 * ms as f64)))
            .unwrap();
    }
    let kept = WindowBody {
        travel_wheels: before.travel_wheels,
        travel_reference: before.travel_reference,
        ..WindowBody::default()
    };
    assert_eq!(lost.latest(), Some(&kept));
    assert!(before.motion.is_some());
}

/// Steps of exactly a quarter of a window are added.
#[test]
fn a_distance_grows_in_steps_of_a_quarter_window() {
    let steps = |period_ms: i64| {
        let mut means = means(&cart(), Reference::Speed);
        let mut found: Vec<f64> = Vec::new();
        for ms in (0..=1500).step_by(usize::try_from(period_ms).unwrap()) {
            for wheel in 0..3 {
                let _ = means.update(sample(ms, way(wheel, 0.4 * 0.001 * ms as f64)));
            }
            let body = *means.update(sample(ms, speed(0.4))).unwrap();
            if found.last() != Some(&body.travel_wheels) {
                found.push(body.travel_wheels);
            }
        }
        let step = found[2] - found[1];
        assert!(
            found.windows(2).all(|pair| near(pair[1] - pair[0], step)),
            "{found:?}"
        );
        step
    };
    assert!((steps(125) - 0.05).abs() < 1e-6);
    assert!((steps(100) - 0.08).abs() < 1e-6);
}

#[test]
fn the_body_waits_for_its_powered_wheels_alone() {
    let mut means = means(&cart(), Reference::Speed);
    let ahead = |time: f64| 0.3 * time;
    run(
        &mut means,
        0..=50,
        &[&ahead, &ahead, &ahead, &ahead],
        &[speed(0.3)],
    );
    // the free wheel is late, then a powered one
    run(
        &mut means,
        51..=60,
        &[&ahead, &ahead, &ahead],
        &[speed(0.3)],
    );
    assert_eq!(means.latest().unwrap().until_ns, Some(1200 * MS));
    run(&mut means, 61..=65, &[&ahead, &ahead], &[speed(0.3)]);
    assert_eq!(means.latest().unwrap().until_ns, Some(1200 * MS));
    // each wheel's speed is over a window of its own: faster for the last 0.1 s
    let mut means = super::tests::means(&cart(), Reference::Speed);
    let faster = |time: f64| 0.3 * time + (time - 1.2).max(0.0);
    run(
        &mut means,
        0..=60,
        &[&faster, &ahead, &ahead],
        &[speed(0.3)],
    );
    run(&mut means, 61..=65, &[&faster], &[speed(0.3)]);
    assert!(near(means.rim_speed(0).unwrap().value, (0.15 + 0.1) / 0.5));
    assert!(near(means.rim_speed(1).unwrap().value, 0.3));
    assert_eq!(means.rim_speed(3), None);
}

/// A wheel 0.5 m ahead of its joint and 0.2 m to the right of it, heading to the left: each rad to the left moves it along.
#[test]
fn what_a_rim_rolls_by_steering_is_no_speed_of_the_robot() {
    let steered = Wheel::powered("front")
        .at(0.5, -0.2)
        .steered_about(0.0, 0.0)
        .heading(Angle::from_rad(core::f64::consts::FRAC_PI_2));
    let mut means = means(&[steered], Reference::Speed);
    let steering = |angle| Measurement::SteeringAngle { wheel: 0, angle };
    let (mut angle, mut rolled) = (0.3, 0.7);
    for row in 0..=50 {
        means.update(sample(20 * row, steering(angle))).unwrap();
        // the same angle again, as a driver may send it
        means.update(sample(20 * row, steering(angle))).unwrap();
        // 0.1 m/s beside the 0.5 m of each rad of its steering
        means.update(sample(20 * row, way(0, rolled))).unwrap();
        angle += 0.01;
        rolled += 0.5 * 0.01 + 0.1 * 0.02;
    }
    let speed = means.wheels[0].speed(600 * MS, 1000 * MS).unwrap();
    assert!((speed.value - 0.1).abs() < 1e-9, "{speed:?}");
    // four windows are kept
    for ms in 1001..=8000 {
        angle += 0.0005;
        means.update(sample(ms, steering(angle))).unwrap();
    }
    let swings = &means.wheels[0].swings;
    assert!(swings.at(6100 * MS).is_some() && swings.at(5800 * MS).is_none());
    // a clock that was set back begins anew
    means.update(sample(7000, steering(0.0))).unwrap();
    let swings = &means.wheels[0].swings;
    assert!(swings.at(6900 * MS).is_none() && swings.at(7000 * MS).is_some());
}
