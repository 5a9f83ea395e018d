use super::*;

fn transform<'a>(frame: &'a str, child: &'a str, x: f64) -> Transform<'a> {
    Transform {
        stamp_ns: None,
        frame,
        child_frame: child,
        translation: [x, 0.0, 0.0],
        rotation: [0.0, 0.0, 0.0, 1.0],
    }
}

/// The pose of `base` in `fixed`.
fn absolute(fixed: &str, base: &str) -> FramePair {
    FramePair {
        fixed: fixed.into(),
        base: base.into(),
        is_absolute: true,
    }
}

fn tree(links: &[(&str, &str, bool)]) -> Tree {
    let mut first = FirstTransforms::default();
    for (frame, child, is_static) in links {
        first.enter(0, &transform(frame, child, 0.0), *is_static);
    }
    first.tree(|_| true)
}

fn found(links: &[(&str, &str, bool)], fixed: Option<&str>, base: Option<&str>) -> Vec<String> {
    let found = poses(&tree(links), fixed, base);
    let words = |pair: FramePair| {
        format!(
            "{} in {}{}",
            pair.base,
            pair.fixed,
            if pair.is_absolute { "" } else { "?" }
        )
    };
    found.into_iter().map(words).collect()
}

#[test]
fn poses_are_those_of_bases_in_the_nearest_map() {
    let slam = [
        ("earth", "map", true),
        ("map", "odom", false),
        ("odom", "base_footprint", false),
        ("base_footprint", "base_link", true),
    ];
    assert_eq!(found(&slam, None, None), ["base_link in map"]);
    assert_eq!(found(&slam, Some("/earth"), None), ["base_link in earth?"]);
    assert_eq!(
        found(&slam, Some("odom"), Some("/base_footprint")),
        ["base_footprint in odom?"]
    );
    assert_eq!(found(&slam, None, Some("odom")), ["odom in map"]);
    assert_eq!(found(&slam, Some("base_link"), None), [""; 0]);
    assert_eq!(found(&slam[2..], None, None), ["base_link in odom?"]);
    // what a tracker follows, where no base is in its frame; of a localisation, sensors are not
    let vicon = [
        ("world", "vicon/cart/cart", false),
        ("odom", "base_link", false),
    ];
    assert_eq!(found(&vicon, None, None), ["vicon/cart/cart in world"]);
    let own_base = [
        ("map", "odom", false),
        ("odom", "chassis", false),
        ("chassis", "laser", false),
    ];
    assert_eq!(found(&own_base, None, None), [""; 0]);
    assert_eq!(found(&own_base, None, Some("chassis")), ["chassis in map"]);
    assert_eq!(found(&[], None, None), [""; 0]);
}

#[test]
fn frames_that_are_kept_are_limited() {
    let mut first = FirstTransforms::default();
    let mut pose = FramePose::new(Tree::default(), absolute("map", "base"));
    for number in 0..5000 {
        let frame = format!("frame{number}");
        first.enter(number, &transform("map", &frame, 0.0), false);
        assert!(pose.take(&transform("map", &frame, 0.0), false).is_none());
    }
    assert_eq!(
        (first.tree(|_| true).0.len(), pose.tree.0.len()),
        (MAX_FRAMES, MAX_FRAMES)
    );
    let held = first.by_topic.iter().map(|tree| tree.0.len());
    assert_eq!(held.sum::<usize>(), MAX_FRAMES);
    // a longer chain is a circle
    let chain: Vec<String> = (0..70).map(|number| number.to_string()).collect();
    let links = |length: usize| {
        let all = chain[..length]
            .windows(2)
            .map(|pair| (pair[0].as_str(), pair[1].as_str(), false));
        all.collect::<Vec<_>>()
    };
    assert_eq!(found(&links(64), None, Some("63")), ["63 in 0?"]);
    assert_eq!(found(&links(65), None, Some("64")), [""; 0]);
}

#[test]
fn a_correction_counts_until_the_pose_is_given() {
    let pair = absolute("map", "base");
    let mut pose = FramePose::new(Tree::default(), pair);
    let mut given = |parent, child, x| match pose.take(&transform(parent, child, x), false) {
        Some(Measurement::Pose { x, .. }) => Some(x),
        _ => None,
    };
    // the odometry moves; two corrections before it moves again, and then none
    for (parent, child, x, expected) in [
        ("odom", "base", 0.0, None),
        ("odom", "base", 0.25, None),
        ("map", "odom", 1.0, None),
        ("map", "odom", 2.0, None),
        ("odom", "base", 0.5, Some(2.5)),
        ("odom", "base", 0.75, None),
        ("map", "odom", 2.0, None),
        ("odom", "base", 1.0, None),
    ] {
        assert_eq!(given(parent, child, x), expected, "{parent} {child} {x}");
    }
}

#[test]
fn what_is_sent_again_moves_nothing() {
    // fixed to the base, but sent as if it moved, and ahead of its time: the pose is that of what changes
    let pair = absolute("world", "base_link");
    let mut pose = FramePose::new(Tree::default(), pair);
    let mut given = Vec::new();
    for step in 0..4 {
        let x = f64::from(step);
        for (frame, child, x) in [
            ("world", "base_footprint", x),
            ("base_footprint", "base_link", 0.5),
        ] {
            if let Some(Measurement::Pose { x, .. }) = pose.take(&transform(frame, child, x), false)
            {
                given.push((child, x));
            }
        }
    }
    let moved = [
        "base_link",
        "base_footprint",
        "base_footprint",
        "base_footprint",
    ];
    assert_eq!(
        given,
        moved
            .into_iter()
            .zip([0.5, 1.5, 2.5, 3.5])
            .collect::<Vec<_>>()
    );
}
