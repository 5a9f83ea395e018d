//! Which readings of a record belong to which test, and which are of a plate or shear box that goes back.

use grouser_real::median;

/// Multiples of a quantity's noise that chance does not reach.
const NOISE_MULTIPLE: f64 = 6.0;
/// A way back that is shorter than this many of the least steps is the rounding of the record.
const MIN_STEPS: f64 = 1.5;
/// Where the load falls below this share of that at the farthest position, it was taken off, however stiff the soil is.
const UNLOADED_SHARE: f64 = 0.5;
/// A test begins where the one before began, within this share of its way.
const RESTART_SHARE: f64 = 0.1;

/// What a reading is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Branch {
    /// The number of its test in the record.
    pub test: usize,
    /// Does it lie on a way back, or on the way forth again up to where that began?
    pub is_unloading: bool,
}

/// Of each reading of a record in the order of time: `position` is depth or displacement, `load` is force or stress.
///
/// A test ends where the position goes back to where the test began, by more than half of its way from one reading to the next; `returns`: also where it gets back there step by step.
pub(crate) fn branches(position: &[f64], load: &[f64], returns: bool) -> Vec<Branch> {
    let min_way = (NOISE_MULTIPLE * noise(position)).max(MIN_STEPS * least_step(position));
    let min_fall = NOISE_MULTIPLE * noise(load);
    let mut out = Vec::with_capacity(position.len());
    let (mut test, mut first, mut farthest) = (0, 0, 0);
    for (index, &x) in position.iter().enumerate() {
        let (begin, end) = (position[first], position[farthest]);
        let is_back = end - x > min_way && x <= begin + RESTART_SHARE * (end - begin);
        let is_rising = position.get(index + 1).is_some_and(|next| *next > x);
        let is_jump = index > 0 && position[index - 1] - x > 0.5 * (end - begin);
        if is_back && is_rising && (is_jump || returns) {
            (test, first, farthest) = (test + 1, index, index);
        } else if x > end {
            farthest = index;
        }
        out.push((test, farthest));
    }
    let mut rest = 0;
    let mut branches = Vec::with_capacity(out.len());
    // readings with the same farthest one before them are an excursion together
    for excursion in out.chunk_by(|a, b| a == b) {
        let (test, farthest) = excursion[0];
        let places = rest..rest + excursion.len();
        rest = places.end;
        let least = |of: &[f64]| {
            of[places.clone()]
                .iter()
                .copied()
                .fold(f64::INFINITY, f64::min)
        };
        let (way, fall) = (
            position[farthest] - least(position),
            load[farthest] - least(load),
        );
        let is_unloading =
            fall > min_fall && (way > min_way || least(load) < UNLOADED_SHARE * load[farthest]);
        branches.extend(places.map(|place| Branch {
            test,
            is_unloading: is_unloading && place != farthest,
        }));
    }
    branches
}

/// The standard deviation of noise that is independent from reading to reading, from the median size of second differences.
fn noise(values: &[f64]) -> f64 {
    /// The median size of second differences of such noise with a standard deviation of 1: 0.6745 √6.
    const MEDIAN_SECOND_DIFFERENCE: f64 = 1.652_155_8;
    let bends = values.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs());
    let mut bends: Vec<f64> = bends.collect();
    median(&mut bends).unwrap_or(0.0) / MEDIAN_SECOND_DIFFERENCE
}

fn least_step(values: &[f64]) -> f64 {
    let steps = values.windows(2).map(|w| (w[1] - w[0]).abs());
    let least = steps
        .filter(|step| *step > 0.0)
        .fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(points: &[(f64, f64)], returns: bool) -> Vec<(usize, bool)> {
        let (x, load): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        let found = branches(&x, &load, returns);
        found.iter().map(|b| (b.test, b.is_unloading)).collect()
    }

    /// Forth to `end` in steps of 1, the load being the position.
    fn forth(end: u32) -> Vec<(f64, f64)> {
        (1..=end).map(|i| (f64::from(i), f64::from(i))).collect()
    }

    #[test]
    fn the_way_back_and_forth_again_is_unloading() {
        let mut points = forth(20);
        points.extend([(19.0, 12.0), (17.0, 1.0), (18.0, 4.0), (20.0, 19.0)]);
        points.extend([(21.0, 21.0), (22.0, 22.0)]);
        let found = of(&points, false);
        for (index, branch) in found.iter().enumerate() {
            assert_eq!(*branch, (0, (20..24).contains(&index)), "{index}");
        }
        // a stiff soil hardly rises
        let mut points = forth(20);
        points.extend([(19.9, 5.0), (19.8, 0.0)]);
        assert!(of(&points, false)[20..].iter().all(|b| b.1));
    }

    #[test]
    fn tests_in_a_row_are_apart() {
        let twice = [forth(20), forth(20)].concat();
        let found = of(&twice, false);
        let (first, second) = found.split_at(20);
        assert!(first.iter().all(|b| *b == (0, false)));
        assert!(second.iter().all(|b| *b == (1, false)));
        // a shear box that is driven back between them
        let back: Vec<(f64, f64)> = forth(19).into_iter().rev().map(|(x, _)| (x, 0.0)).collect();
        let whole = [forth(20), back, forth(20)].concat();
        let found = of(&whole, true);
        assert!(found[..20].iter().all(|b| *b == (0, false)));
        assert!(found[20..38].iter().all(|b| *b == (0, true)));
        assert!(found[39..].iter().all(|b| *b == (1, false)), "{found:?}");
    }

    #[test]
    fn noise_and_rest_are_loading() {
        let wave = |i: usize| 0.2 * (2.4 * i as f64).sin();
        let points: Vec<(f64, f64)> = (1..200)
            .map(|i| (0.05 * i as f64 + wave(i), i as f64 + 8.0 * wave(3 * i)))
            .collect();
        assert!(of(&points, false).iter().all(|b| *b == (0, false)));
        // the plate rests and the soil creeps
        let rest = [
            (1.0, 1.0),
            (2.0, 2.0),
            (3.0, 3.0),
            (3.0, 2.7),
            (3.0, 2.6),
            (4.0, 3.9),
        ];
        assert!(of(&rest, false).iter().all(|b| !b.1));
    }

    #[test]
    fn noise_and_steps_by_hand() {
        let per_bend = 1.0 / 1.652_155_8;
        assert_eq!(
            [noise(&[]), noise(&[1.0, 2.0]), noise(&[1.0, 2.0, 3.0])],
            [0.0; 3]
        );
        // bends of 2, and of 0, 3 and 1
        assert!((noise(&[0.0, 1.0, 0.0]) - 2.0 * per_bend).abs() < 1e-6);
        assert!((noise(&[0.0, 1.0, 2.0, 6.0, 9.0]) - per_bend).abs() < 1e-6);
        assert_eq!(least_step(&[1.0, 1.0, 3.0, 2.5, 4.0]), 0.5);
        assert_eq!([least_step(&[]), least_step(&[1.0, 1.0])], [0.0; 2]);
    }

    #[test]
    fn a_way_back_is_longer_than_rounding_and_takes_load_off() {
        // forth in steps of 2 to 40 under a load of 20, so that 3 is rounding; then one reading, and forth again
        let is_unloading = |x: f64, load: f64| {
            let mut points: Vec<(f64, f64)> = (1..=20)
                .map(|i| (2.0 * f64::from(i), f64::from(i)))
                .collect();
            points.push((x, load));
            points.extend([(40.0, 20.0), (42.0, 21.0), (44.0, 22.0)]);
            of(&points, false)[20] == (0, true)
        };
        // by the way, while more than half of the load stays
        assert!(is_unloading(36.8, 19.0) && !is_unloading(37.0, 19.0) && !is_unloading(38.0, 19.5));
        // by the load
        assert!(is_unloading(38.0, 9.9) && !is_unloading(38.0, 10.0));
        // no load was taken off
        assert!(!is_unloading(36.8, 20.0));
    }

    #[test]
    fn a_test_begins_within_a_tenth_of_the_way_of_the_one_before() {
        // from 10 to 30 in steps of 1, then these, and forth again: the numbers of their tests
        let tests = |then: &[f64], returns: bool| -> Vec<usize> {
            let forth = (10..=30).map(f64::from);
            let all = forth.chain(then.iter().copied());
            let points: Vec<(f64, f64)> = all.map(|x| (x, x)).collect();
            of(&points, returns)[21..].iter().map(|one| one.0).collect()
        };
        assert_eq!(tests(&[12.0, 13.0, 14.0], false), [1, 1, 1]);
        assert_eq!(tests(&[12.1, 13.1, 14.1], false), [0, 0, 0]);
        // a jump is of more than half the way
        let steps = [28.0, 26.0, 24.0];
        let after = |x: f64| tests(&[&steps[..], &[x, 12.0, 13.0, 14.0]].concat(), false);
        assert_eq!(after(22.0)[4..], [0, 0, 0]);
        assert_eq!(after(22.5)[4..], [1, 1, 1]);
        // what goes back step by step rests before it goes forth
        let rest = [&steps[..], &[18.0, 12.0, 12.0, 13.0]].concat();
        assert_eq!(tests(&rest, true)[3..], [0, 0, 1, 1]);
        assert_eq!(tests(&rest, false)[3..], [0, 0, 0, 0]);
        // 3 is the rounding of steps of 2
        let after = |first: f64| {
            let steps = [0.0, first, 0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0];
            of(&steps.map(|x| (x, x)), false)[8].0
        };
        assert_eq!([after(3.0), after(3.01)], [0, 1]);
    }
}
