//! The heading by an arc of the antenna's way, beside the gyro's turns.

use super::*;

/// The ends of an arc of the robot's origin of this length and turn, as the antenna shows it on the plane, with the
/// gyro's turns; the robot's heading is 0.8 rad before the gyro's turn.
fn arc(antenna: [f64; 2], length: f64, turns: [f64; 2]) -> [Placed; 2] {
    let headings = turns.map(|turn| 0.8 + turn);
    let turned = headings[1] - headings[0];
    let middle = headings[0] + 0.5 * turned;
    // the chord of the arc
    let chord = if turned == 0.0 {
        length
    } else {
        length * (0.5 * turned).sin() / (0.5 * turned)
    };
    let origins = [
        [3.0, -2.0],
        [3.0 + chord * middle.cos(), -2.0 + chord * middle.sin()],
    ];
    std::array::from_fn(|end| {
        let (sin, cos) = headings[end].sin_cos();
        let [x, y] = origins[end];
        let [forward, left] = antenna;
        Placed {
            time_ns: 0,
            place: [
                x + cos * forward - sin * left,
                y + sin * forward + cos * left,
            ],
            turn: Some(turns[end]),
            sigma: 0.02,
        }
    })
}

/// Corrects a heading by an arc.
fn corrected(
    antenna: f64,
    heading: Option<(f64, f64)>,
    [from, to]: [Placed; 2],
) -> Option<(f64, f64)> {
    let mut track = Track {
        heading: heading.map(|(angle, variance)| Heading::new(angle, variance)),
        ..Track::new([antenna, 0.0])
    };
    track.add_step(&from, &to);
    track.correct_heading(&from, &to);
    let Heading {
        angle,
        angle_variance,
        ..
    } = track.heading?;
    Some((angle, angle_variance))
}

#[test]
fn an_arc_shows_the_heading() {
    for (antenna, length, turns) in [
        (0.0, 0.5, [0.0, 0.0]),
        (0.4, 0.5, [0.3, 0.3]),
        (0.4, 0.5, [0.3, 0.9]),
        (-0.3, 0.5, [0.3, 0.9]),
        (0.4, 0.5, [2.0, 1.5]),
    ] {
        let ends = arc([antenna, 0.0], length, turns);
        let way = [0, 1].map(|i| ends[1].place[i] - ends[0].place[i]);
        let noise = 2.0 * 0.02 * 0.02 / (way[0] * way[0] + way[1] * way[1]) + 0.035 * 0.035;
        let (heading, variance) = corrected(antenna, None, ends).unwrap();
        assert!(
            wrap_angle(heading - 0.8).abs() < 1e-12,
            "{antenna} {turns:?}: {heading}"
        );
        assert!((variance - noise).abs() < 1e-12, "{variance} {noise}");
        // of two estimates the mean, weighted by their variances, and the variance of that
        let (heading, variance) = corrected(antenna, Some((0.9, 3.0 * noise)), ends).unwrap();
        assert!((heading - 0.825).abs() < 1e-12, "{heading}");
        assert!((variance - 0.75 * noise).abs() < 1e-12);
        // backwards the heading is the same
        let ends = arc([antenna, 0.0], -length, turns);
        let (heading, _) = corrected(antenna, Some((0.9, 3.0 * noise)), ends).unwrap();
        assert!(
            (heading - 0.825).abs() < 0.01,
            "{antenna} {turns:?}: {heading}"
        );
        let far = corrected(antenna, Some((0.8, 1e9)), ends).unwrap().0;
        assert!((far - 0.8).abs() < 1e-9, "{antenna} {turns:?}: {far}");
    }
    // with a gyro whatever lies behind is reversing, without one what lies 120° aside
    for (heading, has_gyro, expected) in [
        (0.8 - 1.5, true, 0.8),
        (0.8 - 1.6, true, 0.8 - std::f64::consts::PI),
        (0.8 - 2.0, false, 0.8),
        (0.8 - 2.2, false, 0.8 - std::f64::consts::PI),
        (0.8 + 2.2, false, 0.8 + std::f64::consts::PI),
    ] {
        let mut ends = arc([0.0; 2], 0.5, [0.0; 2]);
        if !has_gyro {
            ends = ends.map(|end| Placed { turn: None, ..end });
        }
        let (found, _) = corrected(0.0, Some((heading, 1e12)), ends).unwrap();
        assert!(
            (found - expected).abs() < 1e-9,
            "{heading} {has_gyro}: {found}"
        );
    }
    // a way that is mostly the antenna's own turn shows nothing
    let turned = 2.0 * 0.2_f64.asin();
    let aside = 0.4 * 0.4;
    for (share, shows) in [(0.71, false), (0.69, true)] {
        let size: f64 = aside / share;
        let chord = (size * size - aside * aside).sqrt();
        let length = chord * (0.5 * turned) / (0.5 * turned).sin();
        for turned in [turned, -turned] {
            let ends = arc([0.4, 0.0], length, [0.0, turned]);
            assert_eq!(corrected(0.4, None, ends).is_some(), shows, "{share}");
        }
    }
}

#[test]
fn limits_of_a_course_belong_to_it() {
    // the shortest way
    let mut track = known([0.0; 2], 0.3, None);
    track.last.as_mut().unwrap().place = [-0.2, 0.0];
    track.anchor = track.last;
    track.take_fix(S, &at(0.0, 0.0))[1].unwrap();
    assert_eq!(track.anchor.unwrap().time_ns, S);
    // a way whose share of the antenna's turn is the greatest
    let placed = |place: [f64; 2], turn: Option<f64>| Placed {
        time_ns: 0,
        place,
        turn,
        sigma: 0.02,
    };
    let from = placed([0.0; 2], Some(0.0));
    let to = placed([1.0, 0.0], Some(std::f64::consts::PI));
    assert_eq!(corrected(0.35, None, [from, to]), None);
    assert!(corrected(0.34, None, [from, to]).is_some());
    // as far ahead as behind: ahead
    let to = placed([1.0, 0.0], Some(0.0));
    let aside = Some((-std::f64::consts::FRAC_PI_2, 1e12));
    assert!(corrected(0.0, aside, [from, to]).unwrap().0.abs() < 1e-9);
    // without a gyro 120° are not behind
    let ends = [placed([0.0; 2], None), placed([1.0, 0.0], None)];
    assert!(
        corrected(0.0, Some((-REVERSED_RAD, 1e12)), ends)
            .unwrap()
            .0
            .abs()
            < 1e-9
    );
}
