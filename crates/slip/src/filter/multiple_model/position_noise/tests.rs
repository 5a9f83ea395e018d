use super::*;

const ROUNDING: f64 = 1e-9;
/// A course along no axis, with exact parts.
const COURSE_SIN_COS: (f64, f64) = (0.6, 0.8);
const PERIOD_S: f64 = 0.1;

/// A noise that has learnt these means.
fn learnt(lasting: f64, across: f64, along: [f64; 3]) -> PositionNoise {
    let mut noise = PositionNoise::new();
    noise.scale.lasting = Some(lasting);
    noise.squares = ENOUGH_SQUARES;
    noise.across = across;
    noise.along = along;
    noise
}

#[test]
fn second_differences_are_along_the_course_and_across() {
    let mut noise = PositionNoise::new();
    // 0.8 t² along a course to the left, 0.3 t² to its right, t in readings: twice that over one, and m² times
    let (sin, cos) = COURSE_SIN_COS;
    for t in 0..9_u8 {
        for (over, size) in [(1, 1.0), (2, 4.0), (4, 16.0)] {
            let found = noise.second_difference(over, COURSE_SIN_COS);
            assert_eq!(found.is_some(), usize::from(t) > 2 * over, "{t} {over}");
            if let Some([along, across]) = found {
                assert!((along - 1.6 * size).abs() < ROUNDING, "{along}");
                assert!((across + 0.6 * size).abs() < ROUNDING, "{across}");
            }
        }
        let square = f64::from(t).powi(2);
        let [ahead, aside] = [0.8 * square + 0.4, -0.3 * square + 0.1];
        noise.push(
            [ahead * cos - aside * sin, ahead * sin + aside * cos],
            COURSE_SIN_COS,
            None,
        );
    }
    assert!(noise.second_difference(4, COURSE_SIN_COS).is_some());
    assert_eq!(noise.squares, 1);
    // half of the sizes are 0.6, half of them 1.6: the means begin with the larger one's variance
    let first = (1.6 / MEDIAN_OF_NORMAL).powi(2);
    assert!((noise.across - first - (0.36 - first) / 11.0).abs() < ROUNDING);
    noise.interrupt();
    assert_eq!(noise.second_difference(1, COURSE_SIN_COS), None);
}

#[test]
fn squares_are_means_that_outliers_hardly_change() {
    let mut noise = PositionNoise::new();
    noise.add_squares([[3.0, 0.5], [1.0, 9.0], [-2.0, 9.0]], 4.0);
    // the first is one of eleven; at most four times the mean counts
    let first = |square: f64| 4.0 + (f64::min(square, 16.0) - 4.0) / 11.0;
    assert!((noise.across - first(0.25)).abs() < ROUNDING);
    for (mean, square) in noise.along.into_iter().zip([9.0, 1.0, 4.0]) {
        assert!((mean - first(square)).abs() < ROUNDING);
    }
    let before = noise.clone();
    noise.add_squares([[100.0, 100.0], [0.0, 0.0], [0.0, 0.0]], 7.0);
    let second = |mean: f64| mean + 3.0 * mean / 12.0;
    assert!((noise.across - second(before.across)).abs() < ROUNDING);
    assert!((noise.along[0] - second(before.along[0])).abs() < ROUNDING);
    assert!((noise.along[2] - before.along[2] * 11.0 / 12.0).abs() < ROUNDING);
    // in the end a weight of 0.004
    noise.squares = 1000;
    let before = noise.along[1];
    noise.add_squares([[0.0; 2]; 3], 7.0);
    assert!((noise.along[1] - before * 0.996).abs() < ROUNDING);
    assert_eq!(noise.squares, 1001);
}

#[test]
fn a_robot_at_rest_shows_no_smaller_noise() {
    const STATED_M: f64 = 0.02;
    // positions that alternate by d: second differences of 2 d on one axis, 0 on the other
    let push = |noise: &mut PositionNoise, d: f64, at_rest: Option<f64>| {
        for i in 0..100 {
            noise.push(
                [f64::from(i % 2) * d, f64::from(i % 2) * d],
                (0.0, 1.0),
                at_rest,
            );
        }
    };
    let mut noise = PositionNoise::new();
    push(&mut noise, 0.001, Some(STATED_M));
    assert!((noise.learnt().unwrap() - STATED_M).abs() < ROUNDING);
    assert_eq!((noise.squares, noise.has_moved), (0, false));
    // more than is stated is learnt
    let mut noise = PositionNoise::new();
    push(&mut noise, 0.05, Some(STATED_M));
    let expected = 0.1 / MEDIAN_OF_NORMAL / f64::sqrt(6.0);
    assert!((noise.learnt().unwrap() - expected).abs() < 0.1 * expected);
    // in motion it is learnt, and holds at rest
    let mut noise = PositionNoise::new();
    push(&mut noise, 0.002, None);
    assert!(noise.has_moved && noise.squares > 0);
    let moving = noise.learnt().unwrap();
    assert!(moving < 0.2 * STATED_M);
    noise.interrupt();
    push(&mut noise, 0.0005, Some(STATED_M));
    assert_eq!(noise.learnt(), Some(moving));
}

#[test]
fn errors_that_depend_on_the_course_and_wander_are_told_apart() {
    let near = |found: Noise, reading: f64, wander: f64| {
        let off = (found.reading - reading)
            .abs()
            .max((found.wander - wander).abs());
        assert!(off < ROUNDING, "{found:?}: {reading} {wander}");
    };
    let deviation = |variance: f64| f64::sqrt(variance);
    // errors of σ = 0.1 each, by the median
    let (variance, of_median) = (0.01, 0.1 * f64::sqrt(6.0) * MEDIAN_OF_NORMAL);
    let of = |across: f64, along: [f64; 3], period_s: f64| {
        let noise = learnt(of_median, 6.0 * across, along);
        noise.noise(Errors::Independent, 9.0, period_s)
    };
    let [along, across] = of(variance, [6.0 * variance; 3], PERIOD_S);
    near(along, 0.1, 0.0);
    near(across, 0.1, 0.0);
    // 0.8 of the root mean square where the median is less
    let [along, across] = of(4.0 * variance, [6.0 * 2.25 * variance; 3], PERIOD_S);
    near(along, 0.8 * 0.15, 0.0);
    near(across, 0.8 * 0.2, 0.0);
    // twice as much variance along as across, and more
    let [along, _] = of(variance, [6.0 * 2.0 * variance; 3], PERIOD_S);
    near(along, 0.8 * deviation(2.0 * variance), 0.0);
    let [along, _] = of(variance, [6.0 * 3.0 * variance; 3], PERIOD_S);
    near(along, deviation(3.0 * variance), 0.0);
    // 6 σ² + 2 m q² + m³ w² over m readings
    let of_all =
        |own: f64, q: f64, w: f64| [1.0, 2.0, 4.0].map(|m| 6.0 * own + 2.0 * m * q + m * m * m * w);
    let (own, q) = (0.3 * variance, 2.0 * variance);
    for w in [0.0, 0.1 * variance] {
        let [along, across] = of(variance, of_all(own, q, w), PERIOD_S);
        // by all three exactly; the reading is what is left over one
        let own = own + w / 6.0;
        near(along, deviation(own), deviation(q - own));
        near(across, 0.1, 0.0);
    }
    // by two of them where that is less
    for along in [[0.06, 0.1, 0.12], [0.06, 0.075, 0.3]] {
        let [one, two, four] = along;
        let all = (9.0 * (two - one) - (four - one)) / 12.0;
        let wander = f64::min(all, (four - one) / 6.0);
        let own = f64::max((one - 2.0 * wander) / 6.0, 0.0);
        let [found, _] = of(variance, along, PERIOD_S);
        if wander > own {
            near(found, deviation(own), deviation(wander - own));
        } else {
            near(found, 0.1, 0.0);
        }
    }
    // errors that are filtered have a fifth of it for themselves
    let [along, _] = of(variance, of_all(0.0, q, 0.0), PERIOD_S);
    near(along, 0.2 * deviation(q), deviation(q));
    // at four readings a second
    let [along, _] = of(variance, of_all(own, q, 0.0), 0.25);
    assert!(along.wander > 0.0);
    let [along, _] = of(variance, of_all(own, q, 0.0), 0.26);
    assert_eq!(along.wander, 0.0);
    // sums, and too few squares
    let mut noise = learnt(of_median, 6.0, of_all(own, q, 0.0));
    let both = noise.noise(Errors::Summed, 9.0, PERIOD_S);
    assert_eq!(
        both,
        [Noise::of(Errors::Summed, Some(noise.learnt().unwrap()), 9.0); 2]
    );
    noise.squares -= 1;
    for found in noise.noise(Errors::Independent, 9.0, PERIOD_S) {
        near(found, 0.1, 0.0);
    }
    noise.scale.lasting = None;
    near(noise.noise(Errors::Independent, 9.0, PERIOD_S)[0], 9.0, 0.0);
}
