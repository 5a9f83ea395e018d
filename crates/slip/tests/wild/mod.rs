//! Measurements that no sensor makes, for what must survive everything.

use grouser_slip::Measurement;
use proptest::prelude::*;

/// Any bit pattern, and those that break things more often.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        prop::sample::select(vec![
            0.0,
            -0.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN_POSITIVE,
            5e-324,
            1e308,
            f64::from(f32::MAX),
            1.0,
            -1.0,
        ]),
        -2.0..2.0_f64,
    ]
}

/// Of sensors of any wheel, there or not.
pub(crate) fn measurement() -> impl Strategy<Value = Measurement> {
    let wheel = || prop_oneof![0..6_usize, any::<usize>()];
    prop_oneof![
        (wheel(), any::<u64>()).prop_map(|(wheel, raw)| Measurement::WheelCount { wheel, raw }),
        (wheel(), 0..5000_u64).prop_map(|(wheel, raw)| Measurement::WheelCount { wheel, raw }),
        (wheel(), any::<bool>())
            .prop_map(|(wheel, forward)| Measurement::WheelEdge { wheel, forward }),
        (wheel(), number()).prop_map(|(wheel, angle)| Measurement::WheelAngle { wheel, angle }),
        (wheel(), number()).prop_map(|(wheel, rate)| Measurement::WheelRate { wheel, rate }),
        (wheel(), number()).prop_map(|(wheel, torque)| Measurement::WheelTorque { wheel, torque }),
        (wheel(), number(), number(), number()).prop_map(|(wheel, turn, forward, up)| {
            Measurement::Carrier {
                wheel,
                turn,
                forward,
                up,
            }
        }),
        number().prop_map(|rate| Measurement::YawRate { rate }),
        (number(), number())
            .prop_map(|(forward, left)| Measurement::Acceleration { forward, left }),
        (number(), number(), prop::option::of(number())).prop_map(|(forward, left, turn)| {
            Measurement::Displacement {
                forward,
                left,
                turn,
            }
        }),
        (number(), number(), number()).prop_map(|(x, y, yaw)| Measurement::Pose { x, y, yaw }),
        (number(), prop::option::of(number()))
            .prop_map(|(forward, left)| Measurement::Speed { forward, left }),
        (number(), number()).prop_map(|(forward, left)| Measurement::Command { forward, left }),
    ]
}
