use super::*;
use crate::robot::Wheel;
use core::f64::consts::FRAC_PI_2;
use grouser_terra::Angle;

/// Two powered wheels 0.4 m apart, and two free ones behind them.
fn cart() -> Robot {
    let wheels = [
        Wheel::powered("left").at(0.0, 0.2),
        Wheel::powered("right").at(0.0, -0.2),
        Wheel::free("behind left").at(-0.3, 0.1),
        Wheel::free("behind right").at(-0.3, -0.1),
    ];
    Robot::new("cart".into(), wheels.to_vec()).unwrap()
}

fn yaw_rate(rate: f64) -> Measurement {
    Measurement::YawRate { rate }
}

fn speed(forward: f64, left: f64) -> Measurement {
    let left = Some(left);
    Measurement::Speed { forward, left }
}

fn force(forward: f64, left: f64) -> Measurement {
    Measurement::Acceleration { forward, left }
}

fn displacement(forward: f64, left: f64) -> Measurement {
    Measurement::Displacement {
        forward,
        left,
        turn: None,
    }
}

const NOTHING: Measurement = Measurement::Command {
    forward: 0.0,
    left: 0.0,
};

/// A check with the time that it is.
struct Fed {
    check: StartCheck,
    ms: i64,
}

impl Fed {
    fn new(robot: &Robot) -> Self {
        let mut fed = Self {
            check: StartCheck::new(robot).unwrap(),
            ms: 0,
        };
        fed.take(0, NOTHING, &[]).unwrap();
        fed
    }

    /// `measurement` after `ms` more, beside rims of these speeds.
    fn take(&mut self, ms: i64, measurement: Measurement, rims: &[f64]) -> Result<Progress, Fault> {
        self.ms += ms;
        let wheels: Vec<_> = rims
            .iter()
            .map(|value| WheelEstimate {
                rim_speed: Some(Measured {
                    value: *value,
                    variance: 0.0,
                }),
                ..WheelEstimate::NOTHING
            })
            .collect();
        let sample = Sample {
            time_ns: self.ms * 1_000_000,
            measurement,
        };
        self.check.step(&sample, &wheels)
    }

    /// Measurements in the middle of a window of 0.2 s.
    fn window(&mut self, measurements: &[Measurement], rims: &[f64]) -> Result<Progress, Fault> {
        for (index, measurement) in measurements.iter().enumerate() {
            self.take(if index == 0 { 100 } else { 0 }, *measurement, rims)?;
        }
        let passed = if measurements.is_empty() { 200 } else { 100 };
        self.take(passed, NOTHING, rims)
    }
}

type Result<T, E> = core::result::Result<T, E>;

/// The rims of the cart at a speed and a yaw rate, without slip.
fn rims(forward: f64, turn: f64) -> [f64; 4] {
    [0.2, -0.2, 0.1, -0.1].map(|y| forward - turn * y)
}

/// A fault's field, its factor and what it looks like.
fn named(found: Result<Progress, Fault>) -> (&'static str, f64, &'static str) {
    match found {
        Err(Fault::Implausible {
            field,
            times,
            looks_like,
        }) => (field, times, looks_like),
        other => panic!("{other:?}"),
    }
}

/// Speeds that differ from window to window, m/s.
fn speed_at(index: u32) -> f64 {
    0.5 + 0.3 * f64::sin(f64::from(index))
}

#[test]
fn at_rest_a_bias_and_a_slope_have_their_limits() {
    let at = |measurements: &[Measurement], speed: f64| {
        let mut fed = Fed::new(&cart());
        fed.window(measurements, &rims(speed, 0.0))
    };
    assert!(at(&[yaw_rate(0.5), force(6.9, -6.9)], 0.0).is_ok());
    let turning = "it turns while all wheels are stationary";
    assert_eq!(
        named(at(&[yaw_rate(-0.75)], 0.0)),
        ("yaw rate", -1.5, turning)
    );
    // a mean
    let means = [yaw_rate(0.4), yaw_rate(0.8)];
    let (_, times, _) = named(at(&means, 0.0));
    assert!((times - 1.2).abs() < 1e-12);
    for (slope, of) in [
        (force(-7.0, 0.0), "acceleration forward"),
        (force(0.0, -7.0), "acceleration left"),
    ] {
        let (field, times, looks_like) = named(at(&[slope], 0.0009));
        assert_eq!(
            (field, looks_like),
            (of, "gravity lies along this axis at rest")
        );
        assert!((times + 7.0 / 9.806_65).abs() < 1e-12);
        // 1 mm/s is no rest
        assert!(at(&[slope, yaw_rate(2.0)], 0.001).is_ok());
    }
}

#[test]
fn a_window_lasts_two_to_four_tenths_of_a_second() {
    for (ms, is_one) in [(199, false), (200, true), (400, true), (401, false)] {
        let mut fed = Fed::new(&cart());
        fed.take(1, yaw_rate(9.0), &rims(0.0, 0.0)).unwrap();
        assert_eq!(
            fed.take(ms - 1, NOTHING, &rims(0.0, 0.0)).is_err(),
            is_one,
            "{ms}"
        );
    }
}

/// What is proportional to the truth is found with its factor.
#[test]
fn factors_are_found() {
    let run = |of: &dyn Fn(f64, f64, f64) -> Measurement| {
        let mut fed = Fed::new(&cart());
        let mut before = 0.5;
        for index in 0..40 {
            let (forward, turn) = (speed_at(index), 0.3 * f64::cos(f64::from(index)));
            let rise = (forward - before) / 0.2;
            before = forward;
            let measurements = if index == 0 {
                vec![]
            } else {
                vec![of(forward, turn, rise)]
            };
            // the powered wheels slip; a constant part of the gyro is a bias
            let mut rims = rims(forward, turn);
            let found = fed.window(&measurements, {
                rims[0] += 0.1;
                rims[1] += 0.1;
                &rims
            });
            if found.is_err() {
                return named(found);
            }
        }
        panic!("nothing found");
    };
    let close = |found: (&'static str, f64, &'static str), times: f64| {
        assert!((found.1 / times - 1.0).abs() < 1e-6, "{found:?}");
        (found.0, found.2)
    };
    for (times, unit) in [
        (57.295_78, "degrees given as radians"),
        (9.549_297, "revolutions a minute given as radians a second"),
        (-9.549_297, "the other sign"),
        (0.017_453, "radians given as degrees, or another axis"),
    ] {
        let found = run(&|_, turn, _| yaw_rate(times * turn + 0.01));
        assert_eq!(close(found, times), ("yaw rate", unit));
    }
    for (times, unit) in [
        (1000.0, "millimetres given as metres"),
        (-1.0, "the other sign"),
    ] {
        let found = run(&|forward, _, _| speed(times * forward, 0.0));
        assert_eq!(close(found, times), ("displacement forward", unit));
    }
    for (times, unit) in [(9.806_65, "m/s² given as g"), (-1.0, "the other sign")] {
        let found = run(&|_, _, rise| force(times * rise + 0.2, 0.1));
        assert_eq!(close(found, times), ("acceleration forward", unit));
    }
    let (field, times, looks_like) = run(&|_, _, rise| force(0.2, rise));
    assert_eq!(
        (field, times, looks_like),
        ("acceleration left", 0.0, "forward and left exchanged")
    );
    let (field, times, looks_like) = run(&|forward, _, _| speed(0.0, forward));
    assert_eq!(
        (field, times, looks_like),
        ("displacement left", 0.0, "forward and left exchanged")
    );
}

#[test]
fn what_has_nothing_to_do_with_the_wheels_is_no_exchange() {
    let mut fed = Fed::new(&cart());
    for index in 0..20 {
        let measurements = [speed(0.0, 0.0), force(0.2, 0.1)];
        let found = fed.window(&measurements, &rims(speed_at(index), 0.0));
        // five windows of the reference, and one more before there is a rise
        let expected = if index < 5 {
            Progress::Looking
        } else {
            Progress::Plausible
        };
        assert_eq!(found, Ok(expected), "{index}");
    }
}

#[test]
fn a_displacement_is_a_speed_over_the_time_since_the_last() {
    // a second at most
    for (last_ms, expected) in [(200, Progress::Plausible), (201, Progress::Looking)] {
        let mut fed = Fed::new(&cart());
        let mut found = fed.take(0, displacement(0.0, 0.0), &rims(0.1, 0.0));
        for _ in 0..10 {
            for _ in 0..4 {
                let _ = fed.take(200, NOTHING, &rims(0.1, 0.0));
            }
            found = fed.take(last_ms, displacement(0.1, 0.0), &rims(0.1, 0.0));
        }
        assert_eq!(found, Ok(expected), "{last_ms}");
    }
    // after 0.2 s at 1 m/s and after 1 s at 0.1 m/s, in turn: ways that have little to do with the speeds
    let run = |of: &dyn Fn(f64) -> Measurement| {
        let mut fed = Fed::new(&cart());
        let mut found = fed.take(0, displacement(0.0, 0.0), &rims(0.0, 0.0));
        for _ in 0..10 {
            found = fed.take(200, of(0.2), &rims(1.0, 0.0));
            for _ in 0..4 {
                let _ = fed.take(200, NOTHING, &rims(0.1, 0.0));
            }
            found = found.and(fed.take(200, of(0.1), &rims(0.1, 0.0)));
        }
        found
    };
    assert_eq!(run(&|way| displacement(way, 0.0)), Ok(Progress::Plausible));
    let (field, times, _) = named(run(&|way| displacement(1000.0 * way, 0.0)));
    assert!(field == "displacement forward" && (times - 1000.0).abs() < 1e-6);
    assert_eq!(
        named(run(&|way| displacement(0.0, way))).0,
        "displacement left"
    );
}

#[test]
fn a_robot_without_a_free_wheel_compares_its_turn_and_its_rise() {
    let sides = [("left", 0.2), ("right", -0.2)];
    let wheels = sides.map(|(name, y)| Wheel::powered(name).at(0.0, y));
    let robot = Robot::new("cart".into(), wheels.to_vec()).unwrap();
    let mut fed = Fed::new(&robot);
    let mut found = Ok(Progress::Looking);
    for index in 0..20 {
        let turn = 0.3 * f64::cos(f64::from(index));
        let speed = speed_at(index);
        found = fed.window(&[yaw_rate(turn)], &rims(speed, turn)[..2]);
    }
    assert_eq!(found, Ok(Progress::Plausible));
    // windows without a reading count for nothing
    let mut fed = Fed::new(&robot);
    for index in 0..40 {
        let turn = 0.3 * f64::cos(f64::from(index));
        let measured = [yaw_rate(-turn)];
        let measured = if index < 10 { &[] } else { &measured[..] };
        found = fed.window(measured, &rims(speed_at(index), turn)[..2]);
    }
    assert_eq!(named(found).2, "the other sign");
}

/// From 30 mm/s on a robot moves, and the turn of its wheels is its own.
#[test]
fn a_turn_counts_from_the_least_speed_on() {
    for (forward, expected) in [(0.03, Progress::Plausible), (0.029, Progress::Looking)] {
        let mut fed = Fed::new(&cart());
        let mut found = Ok(Progress::Looking);
        for index in 0..20 {
            let turn = 0.3 * f64::cos(f64::from(index));
            let mut rims = rims(forward, turn);
            // exactly the same for both free wheels
            (rims[2], rims[3]) = (forward, forward);
            found = fed.window(&[yaw_rate(turn)], &rims);
        }
        assert_eq!(found, Ok(expected), "{forward}");
    }
}

#[test]
fn a_turn_by_the_wheels_is_weighed_against_a_drift() {
    let aside = Wheel::powered("aside").at(0.3, 0.0);
    let wheels = [
        Wheel::powered("left").at(0.0, 0.2),
        Wheel::powered("right").at(0.0, -0.2),
        aside.heading(Angle::from_rad(FRAC_PI_2)),
    ];
    let robot = Robot::new("cart".into(), wheels.to_vec()).unwrap();
    let check = StartCheck::new(&robot).unwrap();
    // 0.5 m/s by a wheel across that the others do not show: a drift of 0.1 m/s (one sigma) against 0.01 m/s at each wheel.
    // Minimum over ω of 0.08 ω² + (0.01/1.01)(0.3 ω − 0.5)²
    let turn = check.turn_of(&[Some(1.0), Some(1.0), Some(0.5)]).unwrap();
    assert!((turn - 0.018_359_85).abs() < 1e-7, "{turn}");
    // wheels 1 cm apart show none
    for (y, is_one) in [(0.005, false), (0.006, true)] {
        let wheels = [("left", y), ("right", -y)].map(|(name, y)| Wheel::powered(name).at(0.0, y));
        let robot = Robot::new("cart".into(), wheels.to_vec()).unwrap();
        let check = StartCheck::new(&robot).unwrap();
        assert_eq!(check.turn_of(&[Some(1.0), Some(1.0)]).is_some(), is_one);
    }
}
