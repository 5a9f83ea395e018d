use super::*;

const ROUNDING: f64 = 1e-12;

/// A scale that has seen these sizes, followed after each.
fn after(sizes: &[f64]) -> Scale {
    let mut scale = Scale::NEW;
    for size in sizes {
        scale.push(*size, 0.0);
        scale.follow();
    }
    scale
}

#[test]
fn the_median_of_sizes_is_followed_in_small_steps() {
    assert_eq!(after(&[1.0; 7]).lasting, None);
    // until 32 are kept each of them changes it: the upper one of the two in the middle
    let first = [5.0, 1.0, 2.0, 8.0, 3.0, 9.0, 4.0, 7.0];
    assert_eq!(after(&first).lasting, Some(5.0));
    assert_eq!(after(&[&first[..], &[4.5]].concat()).lasting, Some(4.5));
    let deviation = after(&first).deviation().unwrap();
    // half of normal errors are within 0.674 sigma
    assert!((deviation - 5.0 / 0.674_489_750_2).abs() < 1e-6);
    // 31 sizes whose median is 3, then steps of 0.5 %
    let many: Vec<f64> = (0..31).map(|i| if i < 15 { 2.0 } else { 3.0 }).collect();
    let mut scale = after(&many);
    let mut expected = 3.0;
    assert_eq!(scale.lasting, Some(expected));
    scale.push(3.25, 0.0);
    scale.follow();
    expected *= 1.005;
    for (size, factor) in [(3.5, 1.005), (2.5, 0.995), (3.2, 1.005), (2.9, 0.995)] {
        scale.push(size, 0.0);
        expected *= factor;
        let lasting = scale.lasting.unwrap();
        assert!(
            (lasting - expected).abs() < ROUNDING,
            "{lasting} {expected}"
        );
    }
    // one as large is not larger
    scale.push(scale.lasting.unwrap(), 0.0);
    expected *= 0.995;
    assert!((scale.lasting.unwrap() - expected).abs() < ROUNDING);
    // one that is no evidence
    let (lasting, kept) = (scale.lasting, scale.sizes);
    scale.push(0.5, 2.75);
    assert_eq!(scale.lasting, lasting);
    assert_eq!(scale.sizes.iter().filter(|size| **size == 2.75).count(), 1);
    assert_eq!(scale.sizes[5], 2.75);
    assert_eq!(scale.sizes[6..], kept[6..]);
    // one at the limit is
    scale.push(2.0, 2.0);
    assert!((scale.lasting.unwrap() - lasting.unwrap() * 0.995).abs() < ROUNDING);
}

#[test]
fn a_noise_that_has_changed_is_followed_at_once() {
    for (size, lasting, expected) in [
        (3.0, 1.0, 3.0 / f64::sqrt(2.0)),
        (1.0, 3.0, f64::sqrt(2.0)),
        (1.5, 1.0, 1.5),
        (1.0, 1.5, 1.0),
        (2.0, 1.0, 1.0),
        (1.0, 2.0, 2.0),
    ] {
        let mut scale = after(&[size; 40]);
        // within a factor of 2 it stays as it is
        scale.lasting = Some(lasting);
        scale.follow();
        let is_far = size > 2.0 * lasting || lasting > 2.0 * size;
        let found = scale.lasting.unwrap();
        assert!((found - if is_far { expected } else { lasting }).abs() < ROUNDING);
    }
}

#[test]
fn noise_is_that_of_the_second_differences() {
    let mut noise = ReferenceNoise::<2>::new();
    // the second differences of 0, d, 0, d … are ±2 d, those of a straight line 0
    for i in 0..6 {
        assert_eq!(noise.learnt(), None);
        let other = f64::from(i % 2);
        noise.push([7.0 + 0.3 * f64::from(i) + 0.25 * other, 5.0 - 0.25 * other]);
    }
    let expected = 0.5 / 0.674_489_750_2 / f64::sqrt(6.0);
    assert!((noise.learnt().unwrap() - expected).abs() < 1e-7);
    assert_eq!(Some(noise.sigma(9.0)), noise.learnt());
    assert_eq!(ReferenceNoise::<1>::new().sigma(9.0), 9.0);
    let of = noise.noise(Errors::Independent, 9.0);
    assert_eq!((Some(of.reading), of.wander), (noise.learnt(), 0.0));
}

#[test]
fn sums_wander_and_are_read_well() {
    // a reading of 0.3 q beside steps of q: the second difference has the variance 2 q² + 6 (0.3 q)²
    for (learnt, prior, wander) in [
        (Some(0.4), 0.1, 0.4 * f64::sqrt(6.0 / 2.54)),
        (None, 0.1, 0.1),
    ] {
        let noise = Noise::of(Errors::Summed, learnt, prior);
        assert!((noise.wander - wander).abs() < ROUNDING);
        assert!((noise.reading - 0.3 * wander).abs() < ROUNDING);
    }
    let displaced = Measurement::Displacement {
        forward: 0.1,
        left: 0.0,
        turn: None,
    };
    assert_eq!(Errors::of(&displaced), Errors::Summed);
    let at = Measurement::Position { x: 0.1, y: 0.0 };
    assert_eq!(Errors::of(&at), Errors::Independent);
}
