//! Turns by the wheels beside turns by the gyro.

use grouser_doctor::TurnCheck;

use crate::carts::{doctor, findings, step};

/// Drives `seconds` in arcs; the track is described `track` too small, the right radius `radius` too large, and the
/// left wheel slips by `slip` from the `from`th second on.
fn drive(seconds: u32, [track, radius]: [f64; 2], (slip, from): (f64, f64)) -> TurnCheck {
    let mut doctor = doctor(&[[0.0, 0.25, 0.0], [0.0, -0.25, 0.0]], 0.02);
    for index in 0..10 * seconds {
        let time_s = f64::from(index) / 10.0;
        let now_ns = i64::from(index) * 100_000_000;
        let turn = 0.2 * (time_s / 7.0).sin();
        let left = 0.3 - 0.25 * turn * (1.0 + track);
        let right = (0.3 + 0.25 * turn * (1.0 + track)) * (1.0 + radius);
        let slips = time_s >= from;
        let left = if slips { left / (1.0 - slip) } else { left };
        let wheels = [[0.25, left], [-0.25, right]];
        step(&mut doctor, (now_ns, 0.1), &wheels, Some(turn));
    }
    findings(&mut doctor).turns.unwrap()
}

#[test]
fn an_error_of_track_or_radius_is_geometry_and_no_slip() {
    for geometry in [[0.03, 0.0], [-0.03, 0.0], [0.0, 0.03], [0.02, -0.02]] {
        let found = drive(3600, geometry, (0.0, 0.0));
        assert_eq!(found.alarms_beyond_geometry, 0, "{geometry:?}");
        assert_eq!(found.wheel, None, "{geometry:?}");
        let [track, radius] = found.geometry.map(|error| error.value);
        // a larger right radius makes half of its share more turn as well
        let expected = geometry[0] + 0.5 * geometry[1];
        assert!((track - expected).abs() < 0.005, "{found:?}");
        assert!((radius - geometry[1]).abs() < 0.005, "{found:?}");
    }
}

#[test]
fn a_slip_beside_wrong_geometry_is_called() {
    let found = drive(120, [0.02, 0.02], (0.1, 60.0));
    assert!(found.alarms_beyond_geometry > 0, "{found:?}");
}

#[test]
fn a_slip_from_the_start_beyond_any_geometry_is_called() {
    let found = drive(60, [0.0, 0.0], (0.15, 0.0));
    assert!(found.alarms_beyond_geometry > 0, "{found:?}");
}

/// A wheel is named where it is twenty times likelier than any other explanation, and not before.
#[test]
fn a_wheel_is_named_by_its_odds() {
    let (mut named, mut unnamed) = (0, 0);
    for slip in [0.05, 0.08, 0.12, 0.2] {
        for seconds in (4..60).step_by(4) {
            let found = drive(seconds, [0.0, 0.0], (slip, 0.0));
            let is_likely = found.likelier > 20.0_f64.ln();
            if found.alarms_beyond_geometry == 0 {
                assert_eq!(found.wheel, None, "{seconds} s: {found:?}");
            } else if found.wheel.is_some() {
                assert!(is_likely, "{seconds} s: {found:?}");
                named += 1;
            } else {
                assert!(found.likelier < 21.0_f64.ln(), "{seconds} s: {found:?}");
                unnamed += 1;
            }
        }
    }
    println!("{named} named, {unnamed} not");
    assert!(named > 0 && unnamed > 0, "{named} named, {unnamed} not");
}
