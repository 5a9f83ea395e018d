//! What a robot's description means, and what it may be.

use std::f64::consts::TAU;

use grouser_slip::filter::FilterSettings;
use grouser_slip::settings::FileUnit;
use grouser_slip::{CounterWidth, Encoder, Error, MAX_WHEELS, Robot, Shaft, Wheel};

#[test]
fn an_encoder_keeps_what_was_set_before() {
    let width = CounterWidth::new(16).unwrap();
    let encoder = Encoder::counting(500).counter(width).rate_step(0.2);
    let encoder = encoder.on_motor(20.0).reversed();
    assert_eq!(encoder.shaft, Shaft::Motor);
    assert_eq!((encoder.gear, encoder.rate_step), (20.0, 0.2));
    assert_eq!(
        (encoder.ticks_per_turn, encoder.counter),
        (Some(500.0), width)
    );
    assert!(encoder.reversed);
    let encoder = Encoder::counting(500).reversed().on_motor(20.0);
    assert!(encoder.reversed && encoder.rate_step(0.2).reversed);
}

/// A rim of 0.1 m: 20 turns of the motor, or 10 000 ticks, are one of its own.
#[test]
fn a_rim_travels_by_the_sensors_shaft() {
    let wheel = |encoder| Wheel::powered("left").radius(0.1).encoder(encoder);
    let own = wheel(Encoder::counting(500));
    let geared = wheel(Encoder::counting(500).on_motor(20.0));
    let reversed = wheel(Encoder::counting(500).on_motor(20.0).reversed());
    for (wheel, turns) in [(own, 1.0), (geared, 20.0), (reversed, -20.0)] {
        let round = 0.1 * TAU;
        assert!((wheel.travel_per_radian() * TAU * turns - round).abs() < 1e-12);
        assert!((wheel.travel_per_tick().unwrap() * 500.0 * turns - round).abs() < 1e-12);
    }
}

#[test]
fn wheels_are_found_by_their_names() {
    let wheels = ["left", "right", "fifth"].map(Wheel::powered);
    let robot = Robot::new("cart".into(), wheels.to_vec()).unwrap();
    assert_eq!(robot.name(), "cart");
    let found = ["left", "right", "fifth", "sixth"].map(|name| robot.wheel_index(name));
    assert_eq!(found, [Some(0), Some(1), Some(2), None]);
}

#[test]
fn a_robot_has_1_to_64_wheels_within_100_m() {
    let of = |count: usize| {
        let wheels = (0..count).map(|index| Wheel::powered(format!("wheel {index}")));
        Robot::new("long".into(), wheels.collect())
    };
    for count in [1, 2, MAX_WHEELS] {
        assert_eq!(of(count).unwrap().wheels().len(), count);
    }
    for count in [0, MAX_WHEELS + 1] {
        assert!(matches!(of(count), Err(Error::WheelCount { .. })));
    }
    for (place, is_legal) in [
        (-100.0, true),
        (100.0, true),
        (-100.1, false),
        (100.1, false),
    ] {
        let wheel = || Wheel::powered("wheel");
        for wheel in [
            wheel().at(place, 0.0),
            wheel().at(0.0, place),
            wheel().steered_about(place, 0.0),
            wheel().steered_about(0.0, place),
        ] {
            assert_eq!(Robot::new("cart".into(), vec![wheel]).is_ok(), is_legal);
        }
    }
}

#[test]
fn limits_in_a_file_are_in_its_unit() {
    for field in FilterSettings::FIELDS {
        let factor = match field.file_unit {
            FileUnit::Degrees => 360.0 / TAU,
            _ => 1.0,
        };
        let (low, high) = field.limits_in_file();
        let near = |file: f64, own: f64| (file - factor * own).abs() <= 1e-12 * file.abs();
        assert!(
            near(low, field.limits.0) && near(high, field.limits.1),
            "{}",
            field.name
        );
    }
}
