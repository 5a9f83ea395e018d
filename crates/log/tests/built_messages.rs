//! Messages as they are built: rotations by the product of three turns, covariances by their places.

use grouser_log::message::{Value, build};

fn hamilton(p: [f64; 4], q: [f64; 4]) -> [f64; 4] {
    let ([a, b, c, d], [e, f, g, h]) = (p, q);
    // x, y, z, w
    [
        d * e + a * h + b * g - c * f,
        d * f - a * g + b * h + c * e,
        d * g + a * f - b * e + c * h,
        d * h - a * e - b * f - c * g,
    ]
}

fn parts(value: &Value) -> [f64; 4] {
    ["x", "y", "z", "w"].map(|name| value.number_at(name).unwrap())
}

#[test]
fn an_orientation_is_a_yaw_then_a_pitch_then_a_roll() {
    for [roll, pitch, yaw] in [[0.3, -0.7, 1.9], [-2.0, 0.4, 0.1], [0.0, 0.0, 1.0]] {
        let about = |axis: usize, angle: f64| {
            let mut turn = [0.0, 0.0, 0.0, (0.5 * angle).cos()];
            turn[axis] = (0.5 * angle).sin();
            turn
        };
        let expected = hamilton(hamilton(about(2, yaw), about(1, pitch)), about(0, roll));
        let found = parts(&build::orientation([roll, pitch, yaw]));
        assert!(
            found
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-15),
            "{found:?} {expected:?}"
        );
        let found = parts(&build::turn(yaw));
        assert!(
            found
                .iter()
                .zip(about(2, yaw))
                .all(|(a, b)| (a - b).abs() < 1e-15)
        );
    }
}

#[test]
fn what_a_planar_unit_does_not_measure_is_marked() {
    let diagonal = |value: &Value, name: &str| {
        let all = value.at(name).unwrap().elements().unwrap();
        assert_eq!(all.len(), 9);
        let zeros = [1, 2, 3, 5, 6, 7]
            .iter()
            .all(|place| all[*place] == Value::Float(0.0));
        assert!(zeros, "{name}");
        [0, 4, 8].map(|place| all[place].number().unwrap())
    };
    let rows = |value: &Value| {
        [
            "orientation_covariance",
            "angular_velocity_covariance",
            "linear_acceleration_covariance",
        ]
        .map(|name| diagonal(value, name))
    };
    let absent = [-1.0, 0.0, 0.0];
    let both = build::planar_imu(build::header(5, "base"), Some(0.3), Some([1.5, -0.5]));
    let unused = f64::MAX;
    assert_eq!(
        rows(&both),
        [absent, [unused, unused, 0.0], [0.0, 0.0, unused]]
    );
    let numbers = [
        "angular_velocity.z",
        "linear_acceleration.x",
        "linear_acceleration.y",
        "linear_acceleration.z",
    ];
    assert_eq!(
        numbers.map(|name| both.number_at(name).unwrap()),
        [0.3, 1.5, -0.5, 0.0]
    );
    let neither = build::planar_imu(build::header(5, "base"), None, None);
    assert_eq!(rows(&neither), [absent; 3]);
    assert_eq!(
        numbers.map(|name| neither.number_at(name).unwrap()),
        [0.0; 4]
    );
}

#[test]
fn fields_have_their_names_and_places() {
    let header = || build::header(-1_500_000_000, "map");
    let stamp = build::stamp(-1_500_000_000);
    assert_eq!(
        (stamp.number_at("sec"), stamp.number_at("nanosec")),
        (Some(-2.0), Some(5e8))
    );
    assert_eq!(header().at("frame_id").and_then(Value::text), Some("map"));
    assert_eq!(
        parts(
            &build::pose(1.0, 2.0, 0.0)
                .at("orientation")
                .unwrap()
                .clone()
        ),
        [0.0, 0.0, 0.0, 1.0]
    );
    let way = build::displacement(header(), 1.0, 2.0, Some(3.0));
    assert_eq!(
        ["forward", "left", "turn"].map(|name| way.number_at(name)),
        [Some(1.0), Some(2.0), Some(3.0)]
    );
    assert!(
        build::displacement(header(), 1.0, 2.0, None)
            .number_at("turn")
            .unwrap()
            .is_nan()
    );
    let contacts = build::wheel_contacts(
        header(),
        &["a", "b"],
        &[[Some(0.1), None], [None, Some(0.2)]],
    );
    let at = |path: &str| contacts.at(path).and_then(Value::text);
    assert_eq!(
        at("interface_values[0].interface_names[0]"),
        Some("sinkage")
    );
    assert_eq!(
        at("interface_values[1].interface_names[0]"),
        Some("entry_angle")
    );
    assert_eq!(
        contacts.number_at("interface_values[1].values[0]"),
        Some(0.2)
    );
    let twist = build::twist_stamped(header(), [1.0, 2.0, 3.0], [4.0, 5.0, 6.0]);
    assert_eq!(
        (
            twist.number_at("twist.linear.y"),
            twist.number_at("twist.angular.x")
        ),
        (Some(2.0), Some(4.0))
    );
}
