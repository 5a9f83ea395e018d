use super::*;
use crate::message::Transform;
use crate::orientation::yaw;
use crate::recording::frames::FirstTransforms;

/// Frames as they are entered by one topic.
#[derive(Default)]
struct Frames(FirstTransforms);

impl Frames {
    fn enter(&mut self, transform: &Transform) {
        self.0.enter(0, transform, true);
    }

    fn tree(&self) -> Tree {
        self.0.tree(|_| true)
    }
}

fn transform<'a>(frame: &'a str, child: &'a str, rotation: [f64; 4]) -> Transform<'a> {
    Transform {
        stamp_ns: None,
        frame,
        child_frame: child,
        translation: [0.0; 3],
        rotation,
    }
}

#[test]
fn up_goes_through_a_chain_of_frames() {
    let half = 0.5_f64.sqrt();
    let mut frames = Frames::default();
    // Turned about x by 90 degrees: the child's y axis is the parent's z axis.
    frames.enter(&transform("/base_link", "mast", [half, 0.0, 0.0, half]));
    let [forward, _, up] = axes_by_transforms(&frames.tree(), "mast").unwrap();
    assert!((forward[0] - 1.0).abs() < 1e-15, "{forward:?}");
    assert!(
        up[0].abs() < 1e-15 && (up[1] - 1.0).abs() < 1e-15 && up[2].abs() < 1e-15,
        "{up:?}"
    );
    // And then about z by 90 degrees: the child's x axis is the mast's y axis.
    frames.enter(&transform("mast", "imu", [0.0, 0.0, half, half]));
    let [forward, left, up] = axes_by_transforms(&frames.tree(), "/imu").unwrap();
    assert!((up[0] - 1.0).abs() < 1e-15, "{up:?}");
    assert!((forward[1] + 1.0).abs() < 1e-15, "{forward:?}");
    assert!((left[2] + 1.0).abs() < 1e-15, "{left:?}");
    assert_eq!(axes_by_transforms(&frames.tree(), "camera"), None);
    frames.enter(&transform("b", "a", [0.0, 0.0, 0.0, 1.0]));
    frames.enter(&transform("a", "b", [0.0, 0.0, 0.0, 1.0]));
    assert_eq!(axes_by_transforms(&frames.tree(), "a"), None);
}

/// As many links as a chain may have lead to the base, and one more does not.
#[test]
fn a_chain_is_as_long_as_it_may_be() {
    let names: Vec<String> = (0..=MAX_CHAIN + 1).map(|k| format!("link{k}")).collect();
    for (links, is_known) in [(MAX_CHAIN, true), (MAX_CHAIN + 1, false)] {
        let mut frames = Frames::default();
        let mut parent = "base_link";
        for name in &names[..links] {
            frames.enter(&transform(parent, name, [0.0, 0.0, 0.0, 1.0]));
            parent = name;
        }
        let axes = axes_by_transforms(&frames.tree(), parent);
        assert_eq!(axes.is_some(), is_known, "{links}");
    }
}

#[test]
fn gravity_tells_up_and_free_fall_does_not() {
    let mut mean = Accelerations::default();
    assert_eq!(mean.up(), None);
    mean.add([0.3, 9.7, -0.4]);
    assert_eq!(mean.up(), Some([0.0, 1.0, 0.0]));
    let mut fall = Accelerations::default();
    fall.add([0.0, 0.1, 0.2]);
    assert_eq!(fall.up(), None);
}

#[test]
fn yaw_is_the_turn_about_z() {
    let (sin, cos) = (1.0_f64).sin_cos();
    assert!((yaw([0.0, 0.0, sin, cos]).unwrap() - 2.0).abs() < 1e-15);
    assert!((yaw([0.0, 0.0, 3.0 * sin, 3.0 * cos]).unwrap() - 2.0).abs() < 1e-15);
    assert_eq!(yaw([0.0; 4]), None);
}

/// The matrix of a rotation by its four parts, row by row.
fn matrix([x, y, z, w]: [f64; 4]) -> [[f64; 3]; 3] {
    [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ],
        [
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
        ],
        [
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ]
}

#[test]
fn axes_are_the_rows_of_the_rotations_matrix() {
    let size = (1.0_f64 + 4.0 + 9.0 + 16.0).sqrt();
    let q = [1.0, -2.0, 3.0, 4.0].map(|part| part / size);
    let mut frames = Frames::default();
    frames.enter(&transform("robot/base_link", "imu", q));
    // whatever the length of the four
    frames.enter(&transform("base", "other", q.map(|part| 3.0 * part)));
    for frame in ["imu", "/other"] {
        let found = axes_by_transforms(&frames.tree(), frame).unwrap();
        for (axis, row) in found.iter().zip(matrix(q)) {
            assert!(
                axis.iter().zip(row).all(|(a, b)| (a - b).abs() < 1e-15),
                "{found:?}"
            );
        }
    }
    // the first of two transforms is kept; none, too short, too long
    frames.enter(&transform("base", "imu", [0.0, 0.0, 0.0, 1.0]));
    assert_eq!(frames.tree().get("imu").unwrap().rotation, q);
    for (number, part) in [0.0, 9e-4, 1.1e-3, 1e200].into_iter().enumerate() {
        let frame = format!("frame{number}");
        frames.enter(&transform("base", &frame, [0.0, 0.0, 0.0, part]));
        assert_eq!(
            axes_by_transforms(&frames.tree(), &frame).is_some(),
            number == 2,
            "{part}"
        );
        assert_eq!(yaw([0.0, 0.0, 0.0, part]).is_some(), number == 2, "{part}");
    }
    assert_eq!(
        axes_by_transforms(&frames.tree(), "base_footprint"),
        Some(matrix([0.0, 0.0, 0.0, 1.0]))
    );
    assert!(
        has_frame(&frames.tree(), "/imu")
            && has_frame(&frames.tree(), "x/base")
            && !has_frame(&frames.tree(), "xbase")
    );
}

#[test]
fn chains_and_trees_end() {
    let none = [0.0, 0.0, 0.0, 1.0];
    let mut frames = Frames::default();
    frames.enter(&transform("base", "0", none));
    for number in 1..70 {
        frames.enter(&transform(
            &(number - 1).to_string(),
            &number.to_string(),
            none,
        ));
    }
    assert!(
        axes_by_transforms(&frames.tree(), "63").is_some()
            && axes_by_transforms(&frames.tree(), "64").is_none()
    );
    for number in 70..5000 {
        frames.enter(&transform("base", &number.to_string(), none));
    }
    assert_eq!(
        (0..5000)
            .filter(|n| frames.tree().get(&n.to_string()).is_some())
            .count(),
        4096
    );
}

#[test]
fn axes_of_the_robot_file_are_square() {
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    assert_eq!(axes_by_file(x, z), Some([x, y, z]));
    assert_eq!(axes_by_file(z, y), Some([z, x, y]));
    assert_eq!(axes_by_file(y, x), Some([y, z, x]));
    assert_eq!(axes_by_file([1.0, 0.0, -0.16], z).unwrap()[2], z);
    assert_eq!(axes_by_file([1.0, 0.0, -0.17], z), None);
    assert!(
        agree(z, [0.49, 0.0, 0.88]) && !agree(z, [0.0, 0.51, 0.86]) && !agree(z, [0.0, 0.0, -1.0])
    );
}

#[test]
fn gravity_is_a_mean_of_its_size() {
    let mean = |all: &[[f64; 3]]| {
        let mut mean = Accelerations::default();
        for one in all {
            mean.add(*one);
        }
        mean
    };
    let two = mean(&[[5.0, 0.0, 6.0], [f64::NAN, 0.0, 9.8], [7.0, 0.0, 10.0]]);
    assert_eq!(two.count(), 2.0);
    // (6, 0, 8): a direction of its own
    let up = two.up().unwrap();
    assert!(
        up.iter()
            .zip([0.6, 0.0, 0.8])
            .all(|(a, b)| (a - b).abs() < 1e-15),
        "{up:?}"
    );
    // near to an axis it is that axis, on either side
    assert_eq!(mean(&[[3.2, 0.0, -9.2]]).up(), Some([0.0, 0.0, -1.0]));
    assert_ne!(mean(&[[3.7, 0.0, -9.2]]).up(), Some([0.0, 0.0, -1.0]));
    for (size, is_gravity) in [(8.3, false), (8.4, true), (11.2, true), (11.3, false)] {
        assert_eq!(
            mean(&[[0.0, size, 0.0]]).up().is_some(),
            is_gravity,
            "{size}"
        );
    }
}

#[test]
fn yaw_is_that_of_the_x_axis_whatever_tilts() {
    let tilted = [
        [0.1, -0.3, 0.5, 0.8],
        [0.6, 0.2, -0.3, 0.1],
        [-0.6, 0.2, -0.3, 0.1],
        [0.1, -0.9, 0.1, 0.1],
    ];
    let turned = [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ];
    for q in tilted.into_iter().chain(turned) {
        let size = q.iter().map(|part| part * part).sum::<f64>().sqrt();
        let rotation = matrix(q.map(|part| part / size));
        let expected = rotation[1][0].atan2(rotation[0][0]);
        assert!((yaw(q).unwrap() - expected).abs() < 1e-15);
    }
}

#[test]
fn limits_themselves_are_outside() {
    assert_eq!(squared([0.94, 0.2, 0.1]), [0.94, 0.2, 0.1]);
    assert_eq!(squared([0.95, 0.2, 0.1]), [1.0, 0.0, 0.0]);
    assert!(!agree([0.0, 0.0, 1.0], [0.5, 0.0, 0.866]));
    let shortest = [0.0, 0.0, 0.0, 0.001];
    assert_eq!(
        (yaw(shortest), turned_back(shortest, [1.0; 3])),
        (None, None)
    );
}
