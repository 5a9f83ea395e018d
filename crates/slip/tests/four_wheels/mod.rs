//! Powered wheels at the corners of a robot.

use grouser_slip::Wheel;

/// Four wheels with encoders of as many ticks, each under 50 N.
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
