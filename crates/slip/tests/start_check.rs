//! The comparison of sensors over the first metres: each unit, sign and axis that is mixed up is named, and right ones are
//! plausible, at any speed of the robot.

use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::start::{Progress, StartCheck, check_gravity};
use grouser_slip::{Fault, Measurement, Robot, Sample, Wheel};
use grouser_terra::{Angle, EARTH_GRAVITY_M_PER_S2};

const PERIOD_S: f64 = 0.01;
const TICKS_PER_TURN: u32 = 10_000;
const RADIUS_M: f64 = 0.1;
const HALF_TRACK_M: f64 = 0.2;

/// What the sensors measure in one period: yaw rate, forces and reference forwards and to the left.
struct Row {
    yaw_rate: f64,
    force: [f64; 2],
    speed: [f64; 2],
}

/// `pair` with both numbers `factor` times as large.
fn scale(pair: &mut [f64; 2], factor: f64) {
    *pair = pair.map(|number| factor * number);
}

#[derive(Clone, Copy, PartialEq)]
enum Reference {
    Displacement,
    Speed,
}

/// Drives for 20 s with speeds that rise and fall, and turns; `change` is what is wrong with the sensors.
fn drive(top: f64, reference: Reference, change: impl Fn(&mut Row)) -> Result<Progress, Fault> {
    let side = |name: &str, y| Wheel::powered(name).at(0.0, y).radius(RADIUS_M);
    let free = Wheel::free("free").at(-0.3, 0.0).radius(RADIUS_M);
    let wheels = [
        side("left", HALF_TRACK_M),
        side("right", -HALF_TRACK_M),
        free,
    ];
    let wheels = wheels.map(|wheel| wheel.ticks_per_turn(TICKS_PER_TURN));
    let robot = Robot::new("tricycle".into(), wheels.to_vec()).unwrap();
    let mut filter = SlipFilter::new(&robot, FilterSettings::default()).unwrap();
    let mut check = StartCheck::new(&robot).unwrap();
    let mut last = Ok(Progress::Looking);
    for index in 0..2000_i64 {
        // rest for a second, then v = top (1 − cos 2t)/2 and ω = 0.4 sin t
        let time = (index as f64 * PERIOD_S - 1.0).max(0.0);
        let way = 0.5 * top * (time - 0.5 * (2.0 * time).sin());
        let turned = 0.4 * (1.0 - time.cos());
        let mut row = Row {
            yaw_rate: 0.4 * time.sin(),
            force: [top * (2.0 * time).sin(), 0.02],
            speed: [0.5 * top * (1.0 - (2.0 * time).cos()), 0.0],
        };
        change(&mut row);
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a counter that begins at a million ticks"
        )]
        let ticks = |way: f64| {
            let turns = way / (RADIUS_M * std::f64::consts::TAU);
            (1e6 + turns * f64::from(TICKS_PER_TURN)) as u64
        };
        let counts = [
            way - HALF_TRACK_M * turned,
            way + HALF_TRACK_M * turned,
            way,
        ]
        .map(ticks);
        let [forward, left] = row.force;
        let [ahead, aside] = row.speed;
        let reference = match reference {
            Reference::Displacement => Measurement::Displacement {
                forward: PERIOD_S * ahead,
                left: PERIOD_S * aside,
                turn: None,
            },
            Reference::Speed => Measurement::Speed {
                forward: ahead,
                left: Some(aside),
            },
        };
        let counts = (0..3).map(|wheel| Measurement::WheelCount {
            wheel,
            raw: counts[wheel],
        });
        let others = [
            Measurement::YawRate { rate: row.yaw_rate },
            Measurement::Acceleration { forward, left },
            reference,
        ];
        for measurement in counts.chain(others) {
            let sample = Sample {
                time_ns: index * 10_000_000,
                measurement,
            };
            let _ = filter.update(sample);
            last = check.take(&sample, &filter.latest());
        }
    }
    last
}

#[test]
fn what_is_mixed_up_is_named() {
    type Change = fn(&mut Row);
    let (yaw_rate, force, speed) = ("yaw rate", "acceleration forward", "displacement forward");
    let exchanged = "forward and left exchanged";
    let all: [(Change, &str, &str); 17] = [
        (
            |row| row.yaw_rate *= 57.3,
            yaw_rate,
            "degrees given as radians",
        ),
        (
            |row| row.yaw_rate *= 9.55,
            yaw_rate,
            "revolutions a minute given as radians a second",
        ),
        (
            |row| row.yaw_rate /= 57.3,
            yaw_rate,
            "radians given as degrees, or another axis",
        ),
        (|row| row.yaw_rate *= -1.0, yaw_rate, "the other sign"),
        (|row| scale(&mut row.force, 9.8), force, "m/s² given as g"),
        (
            |row| scale(&mut row.force, 1.0 / 9.8),
            force,
            "g given as m/s²",
        ),
        (
            |row| scale(&mut row.force, 0.001),
            force,
            "m/s² given as mm/s²",
        ),
        (|row| scale(&mut row.force, 40.0), force, "another unit"),
        (|row| scale(&mut row.force, -1.0), force, "the other sign"),
        (
            |row| row.force = [row.force[0] + 8.0, 0.0],
            force,
            "gravity lies along this axis at rest",
        ),
        (
            |row| scale(&mut row.speed, 1000.0),
            speed,
            "millimetres given as metres",
        ),
        (
            |row| scale(&mut row.speed, 0.001),
            speed,
            "metres given as millimetres",
        ),
        (
            |row| scale(&mut row.speed, 100.0),
            speed,
            "centimetres given as metres",
        ),
        (
            |row| scale(&mut row.speed, 0.01),
            speed,
            "metres given as centimetres",
        ),
        (|row| scale(&mut row.speed, -1.0), speed, "the other sign"),
        (|row| row.force.swap(0, 1), "acceleration left", exchanged),
        (|row| row.speed.swap(0, 1), "displacement left", exchanged),
    ];
    for (change, of, says) in all {
        for (top, by) in [(0.5, Reference::Displacement), (0.8, Reference::Speed)] {
            let fault = drive(top, by, change).unwrap_err();
            let Fault::Implausible {
                field, looks_like, ..
            } = fault
            else {
                panic!("{fault}");
            };
            assert_eq!((field, looks_like), (of, says), "{top} m/s");
        }
    }
}

#[test]
fn sensors_that_measure_what_they_should_are_plausible() {
    for top in [0.3, 0.5, 0.8] {
        for reference in [Reference::Displacement, Reference::Speed] {
            // a factor near 1 may be slip
            for factor in [1.0, 0.7, 1.4] {
                let off = |row: &mut Row| {
                    row.yaw_rate *= factor;
                    scale(&mut row.force, factor);
                    scale(&mut row.speed, factor);
                };
                assert_eq!(
                    drive(top, reference, off),
                    Ok(Progress::Plausible),
                    "{top} m/s"
                );
            }
        }
    }
}

#[test]
fn gravity_shows_its_unit_and_its_axis_at_rest() {
    let steepest = Angle::from_deg(35.0);
    let [forward, left, up] = [
        "acceleration forward",
        "acceleration left",
        "acceleration up",
    ];
    let (in_g, in_mm) = ("g given as m/s²", "mm/s² given as m/s²");
    let other = "another unit, or a robot that does not rest";
    let along = "gravity lies along this axis at rest";
    let upside_down = "upside down, or gravity with the other sign";
    let side = EARTH_GRAVITY_M_PER_S2 / 2.0_f64.sqrt();
    for (force, field, times, looks_like) in [
        ([0.0, 0.0, 1.0], up, 1.0 / EARTH_GRAVITY_M_PER_S2, in_g),
        ([0.0, 0.6, 0.8], up, 1.0 / EARTH_GRAVITY_M_PER_S2, in_g),
        ([0.0, 0.0, 1.09], up, 1.09 / EARTH_GRAVITY_M_PER_S2, in_g),
        ([0.0, 0.0, -0.91], up, 0.91 / EARTH_GRAVITY_M_PER_S2, in_g),
        ([0.0, 0.0, 1.11], up, 1.11 / EARTH_GRAVITY_M_PER_S2, other),
        ([0.0, 0.0, 0.05], up, 0.05 / EARTH_GRAVITY_M_PER_S2, other),
        (
            [0.0, 0.0, 1000.0 * EARTH_GRAVITY_M_PER_S2],
            up,
            1000.0,
            in_mm,
        ),
        (
            [0.0, 0.0, 1090.0 * EARTH_GRAVITY_M_PER_S2],
            up,
            1090.0,
            in_mm,
        ),
        ([0.0, 0.0, 890.0 * EARTH_GRAVITY_M_PER_S2], up, 890.0, other),
        ([0.0, 0.0, 1.11 * EARTH_GRAVITY_M_PER_S2], up, 1.11, other),
        ([0.0, 0.0, 0.89 * EARTH_GRAVITY_M_PER_S2], up, 0.89, other),
        ([EARTH_GRAVITY_M_PER_S2, 0.0, 0.0], forward, 1.0, along),
        (
            [0.0, -0.95 * EARTH_GRAVITY_M_PER_S2, 1.0],
            left,
            -0.95,
            along,
        ),
        (
            [side, side, 0.0],
            forward,
            side / EARTH_GRAVITY_M_PER_S2,
            along,
        ),
        (
            [0.0, 0.1, -1.05 * EARTH_GRAVITY_M_PER_S2],
            up,
            -1.05,
            upside_down,
        ),
    ] {
        let fault = check_gravity(force, steepest).unwrap_err();
        let Fault::Implausible {
            field: named,
            times: factor,
            looks_like: like,
        } = fault
        else {
            panic!("{fault}");
        };
        assert_eq!((named, like), (field, looks_like), "{force:?}");
        assert!((factor - times).abs() < 1e-12 * times.abs(), "{force:?}");
    }
    // as steep as the steepest ground, exactly
    let level = check_gravity([0.0, 0.0, EARTH_GRAVITY_M_PER_S2], Angle::from_rad(0.0)).unwrap();
    assert_eq!(level.rad(), 0.0);
    let tilted = check_gravity(
        [
            0.6 * EARTH_GRAVITY_M_PER_S2,
            0.0,
            0.8 * EARTH_GRAVITY_M_PER_S2,
        ],
        Angle::from_deg(37.0),
    )
    .unwrap();
    assert!((tilted.rad().tan() - 0.75).abs() < 1e-12);
    assert!(
        check_gravity(
            [
                0.6 * EARTH_GRAVITY_M_PER_S2,
                0.0,
                0.8 * EARTH_GRAVITY_M_PER_S2
            ],
            steepest
        )
        .is_err()
    );
}
