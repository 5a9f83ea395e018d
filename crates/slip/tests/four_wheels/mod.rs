//! Powered wheels at the corners of a robot, and what a controller observes of them.

use grouser_slip::control::WheelObservation;
use grouser_slip::{Health, Motion, Robot, Wheel};

/// Four wheels 0.2 m aside, with encoders of this number of ticks, each under 50 N.
pub(crate) fn four_wheels(ticks_per_turn: u32) -> Vec<Wheel> {
    let corners = [
        ("a", 0.3, 0.2),
        ("b", 0.3, -0.2),
        ("c", -0.3, 0.2),
        ("d", -0.3, -0.2),
    ];
    let wheels = corners.map(|(name, x, y)| {
        Wheel::powered(name)
            .at(x, y)
            .radius(0.1)
            .ticks_per_turn(ticks_per_turn)
            .load(50.0)
    });
    wheels.to_vec()
}

/// The robot of four wheels whose encoders have 1000 ticks.
pub(crate) fn robot() -> Robot {
    Robot::new("four wheels".into(), four_wheels(1000)).unwrap()
}

/// A wheel that drives with this slip, known exactly, at this rim speed, m/s.
pub(crate) fn driving(slip: f64, rim_speed: f64) -> WheelObservation {
    WheelObservation {
        slip: Some(slip),
        sigma: Some(0.0),
        health: Health::Ok,
        motion: Some(Motion::Driving),
        forward_speed: Some((1.0 - slip) * rim_speed),
        rim_speed: Some(rim_speed),
        torque_share: Some(0.3),
        firmness: None,
        load: 50.0,
    }
}

/// Yaw rate (rad/s) of the robot by its rim speeds, m/s.
pub(crate) fn yaw_rate(rims: [f64; 4]) -> f64 {
    (rims[1] + rims[3] - rims[0] - rims[2]) / (4.0 * 0.2)
}
