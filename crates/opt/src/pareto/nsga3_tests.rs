//! Survival by hand, of points whose objectives are two numbers.

use proptest::prelude::*;

use super::super::das_dennis;
use super::*;

fn individuals(points: &[[f64; 2]], violation: f64) -> Vec<Individual> {
    let of = |point: &[f64; 2]| Individual {
        x: point.to_vec(),
        objectives: point.to_vec(),
        violation,
    };
    points.iter().map(of).collect()
}

fn survivors(
    population: Vec<Individual>,
    count: usize,
    seed: u64,
) -> (Vec<Vec<f64>>, Normalisation) {
    let (mut memory, mut random) = (Normalisation::new(2), Random::new(seed));
    let directions = das_dennis(2, 2);
    let kept = survive(population, count, &directions, &mut memory, &mut random);
    (kept.into_iter().map(|one| one.objectives).collect(), memory)
}

/// The best along an axis is the nearest to it, by a factor of a million, and then the nearest to the ideal point: (3, 5e-7), not
/// (10, 1e-7). An extent of up to 1e-6 has no intercept.
#[test]
fn extremes_lie_near_the_axes() {
    for (unit, extent) in [(1.0, 3.0), (1e-8, 10.0)] {
        let points = [[10.0, 1e-7], [3.0, 5e-7], [0.0, 10.0]].map(|p| p.map(|f| f * unit));
        let points: Vec<&[f64]> = points.iter().map(|p| &p[..]).collect();
        let (ideal, scale) = Normalisation::new(2).update(&points);
        assert_eq!(ideal, [0.0, 1e-7 * unit]);
        assert!((scale[0] / unit - extent).abs() < 1e-5, "{scale:?}");
    }
}

/// Fronts that fill the room exactly are kept as they are, and nothing is learned from them.
#[test]
fn whole_fronts_are_kept_in_order() {
    let points = [[2.0, 0.5], [0.0, 1.0], [1.0, 0.0], [3.0, 3.0]];
    let (kept, memory) = survivors(individuals(&points, 0.0), 3, 1);
    assert_eq!(kept, [[0.0, 1.0], [1.0, 0.0], [2.0, 0.5]]);
    assert_eq!(memory.ideal, [f64::INFINITY; 2]);
}

#[test]
fn of_points_that_violate_alike_as_many_are_kept_as_there_is_room_for() {
    let mut population = individuals(
        &[
            [0.0, 1.0],
            [1.0, 0.0],
            [2.0, -1.0],
            [3.0, -2.0],
            [4.0, -3.0],
        ],
        2.0,
    );
    population[4].violation = 1.0;
    let (kept, _) = survivors(population, 3, 1);
    assert_eq!((kept.len(), &kept[0][..]), (3, &[4.0, -3.0][..]));
}

/// The better front lies along both axes: of the next one the point between them is kept, whatever is drawn.
#[test]
fn a_direction_without_a_survivor_comes_first() {
    let points = [[1.0, 0.0], [0.0, 1.0], [1.5, 0.1], [0.1, 1.5], [1.2, 1.2]];
    for seed in 0..20 {
        let (kept, _) = survivors(individuals(&points, 0.0), 3, seed);
        assert_eq!(kept[2], [1.2, 1.2]);
    }
}

fn close(found: &[f64], wanted: &[f64]) -> bool {
    found
        .iter()
        .zip(wanted)
        .all(|(a, b)| (a - b).abs() < 1e-6 * b.abs().max(1.0))
}

proptest! {
    /// Points of the plane Σ (f_k − ideal_k)/s_k = 1 give back s, and with the ideal and their ends the normalisation.
    #[test]
    fn a_plane_has_its_intercepts(
        cuts in prop::array::uniform3(0.5..20.0_f64),
        ideal in prop::array::uniform3(-5.0..5.0_f64),
        part in prop::array::uniform3(0.05..0.3_f64),
    ) {
        let place = |w: [f64; 3]| -> Vec<f64> { (0..3).map(|k| ideal[k] + cuts[k] * w[k]).collect() };
        let [a, b, c] = part;
        let inner = [place([1.0 - 2.0 * a, a, a]), place([b, 1.0 - 2.0 * b, b]), place([c, c, 1.0 - 2.0 * c])];
        for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0]] {
            let points = order.map(|i| inner[i].clone());
            prop_assert!(close(&intercepts(&points, &ideal).unwrap(), &cuts));
        }
        prop_assert!(intercepts(&inner[..2], &ideal).is_none());
        // a point twice, and a plane that an axis meets on the far side
        prop_assert!(intercepts(&[inner[0].clone(), inner[0].clone(), inner[2].clone()], &ideal).is_none());
        let far = [place([2.0, 1.0, 0.0]), place([1.0, 0.0, 0.0]), place([0.0, 0.0, 1.0])];
        prop_assert!(intercepts(&far, &ideal).is_none());

        let ends = [place([1.0, 0.0, 0.0]), place([0.0, 1.0, 0.0]), place([0.0, 0.0, 1.0])];
        let front: Vec<&[f64]> = ends.iter().chain(&inner).map(Vec::as_slice).collect();
        let mut memory = Normalisation::new(3);
        let (best, scale) = memory.update(&front);
        prop_assert!(close(&best, &ideal) && close(&scale, &cuts));
        // the extremes are remembered after they have left
        let (best, scale) = memory.update(&front[3..]);
        prop_assert!(close(&best, &ideal) && close(&scale, &cuts));
        // without a plane the greatest values count
        let line = [place([1.0, 0.0, 0.5]), place([0.0, 1.0, 0.5])];
        let (best, scale) = Normalisation::new(3).update(&[&line[0], &line[1]]);
        prop_assert!(close(&best, &place([0.0, 0.0, 0.5])));
        prop_assert!(close(&scale[..2], &cuts[..2]) && scale[2] <= 1e-9);
    }
}
