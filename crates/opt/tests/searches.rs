//! Multi-start and fronts: what they find, and that neither seed-mates nor threads change it.

use grouser_opt::{
    Differences, Error, Exact, Functions, Method, ParetoSettings, Problem, ProblemParams, Settings,
    Variable, das_dennis, knee, multi_start, pareto,
};
use grouser_real::Scalar;

use crate::fronts::hypervolume::hypervolume;

/// Two equally deep valleys at ±1, and a shallow one at 3.
fn valleys() -> Problem<'static> {
    let model = Differences::new(|x: &[f64], f: &mut [f64]| {
        let two = (x[0] * x[0] - 1.0).powi(2);
        f[0] = two.min((x[0] - 3.0).powi(2) + 0.5);
    });
    Problem::new(
        ProblemParams::new(&[0.0], 1, model)
            .variables(vec![Variable::bounded("x", 0.9, -2.0, 4.0)]),
    )
    .unwrap()
}

#[test]
fn every_valley_is_reported() {
    let found = multi_start(&valleys(), &Method::Minimax, &Settings::default(), 30, 5).unwrap();
    let places: Vec<f64> = found
        .optima
        .iter()
        .map(|o| found.runs[o.run].x[0])
        .collect();
    assert!(places.len() >= 3, "{places:?}");
    for expected in [-1.0, 1.0, 3.0] {
        assert!(
            places.iter().any(|x| (x - expected).abs() < 1e-3),
            "{places:?}"
        );
    }
    assert!(found.is_ambiguous());
    assert!((found.best().x[0].abs() - 1.0).abs() < 1e-3);
    assert_eq!(found.starts[0], [0.9]);
}

#[test]
fn searches_over_a_box_need_one() {
    let mut params = ProblemParams::new(&[0.0], 1, Differences::new(|_: &[f64], _: &mut [f64]| {}));
    params.variables[0].lower = 0.0;
    let problem = Problem::new(params).unwrap();
    let error = multi_start(&problem, &Method::Minimax, &Settings::default(), 3, 1).unwrap_err();
    assert!(matches!(error, Error::UnboundedVariable { .. }), "{error}");
}

/// Two circles' distances with a forbidden disc between: constrained domination at work.
struct Detour;
impl Functions for Detour {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = (x[0] + R::ONE).square() + x[1].square();
        f[1] = (x[0] - R::ONE).square() + x[1].square();
        f[2] = R::from_f64(0.25) - x[0].square() - x[1].square();
    }
}

fn detour() -> Problem<'static> {
    let axis = |name: &str| Variable::bounded(name, 0.0, -2.0, 2.0);
    Problem::new(
        ProblemParams::new(&[0.0, 0.0], 2, Exact(Detour))
            .variables(vec![axis("x"), axis("y")])
            .inequalities(vec!["keep out".to_owned()]),
    )
    .unwrap()
}

#[test]
fn fronts_do_not_depend_on_the_number_of_threads() {
    let mut settings = ParetoSettings::default();
    settings.population = 40;
    settings.generations = 20;
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| pareto(&detour(), &settings).unwrap())
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(5));
    let starts = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| multi_start(&valleys(), &Method::Minimax, &Settings::default(), 9, 2))
            .unwrap()
    };
    assert_eq!(starts(1), starts(4));
}

#[test]
fn a_front_keeps_its_constraints_and_has_prices() {
    let front = pareto(&detour(), &ParetoSettings::default()).unwrap();
    assert!(front.points.len() > 50);
    for point in &front.points {
        let [x, y] = [point.x[0], point.x[1]];
        assert!(x * x + y * y >= 0.25 - 1e-7);
        // Between the centres, or around the disc: the way round is at most its half circumference.
        assert!(x.abs() <= 1.0 + 1e-6 && y.abs() <= 0.5 + 1e-6, "{x} {y}");
    }
    let priced = front.points.iter().filter(|p| p.multipliers.is_some());
    assert!(priced.count() > 50);
}

#[test]
fn hypervolume_of_three_objectives_against_inclusion_exclusion() {
    let points = vec![
        vec![0.2, 0.5, 0.6],
        vec![0.5, 0.2, 0.4],
        vec![0.6, 0.6, 0.1],
        vec![0.7, 0.7, 0.7],
    ];
    let reference = [1.0, 1.0, 1.0];
    // By inclusion and exclusion over all subsets: ∏ (1 − max over the subset).
    let mut expected = 0.0;
    for subset in 1_u32..16 {
        let members: Vec<&Vec<f64>> = (0..4)
            .filter(|i| subset >> i & 1 == 1)
            .map(|i| &points[i])
            .collect();
        let volume: f64 = (0..3)
            .map(|k| 1.0 - members.iter().map(|p| p[k]).fold(0.0, f64::max))
            .product();
        expected += if members.len() % 2 == 1 {
            volume
        } else {
            -volume
        };
    }
    let two = [vec![1.0, 2.0], vec![2.0, 1.0]];
    assert_eq!(hypervolume(&two, &[3.0, 3.0]), Ok(3.0));
    let got = hypervolume(&points, &reference).unwrap();
    assert!((got - expected).abs() < 1e-15, "{got} {expected}");
    assert!(hypervolume(&points, &[1.0, 1.0]).is_err());
    assert!(hypervolume(&[vec![f64::NAN, 1.0]], &[1.0, 1.0]).is_err());
}

#[test]
fn directions_are_complete_and_sum_to_one() {
    for (m, d, count) in [(2, 99, 100), (3, 12, 91), (5, 6, 210)] {
        let all = das_dennis(m, d);
        assert_eq!(all.len(), count);
        assert!(
            all.iter()
                .all(|w| (w.iter().sum::<f64>() - 1.0).abs() < 1e-12)
        );
        let mut sorted = all.clone();
        sorted.sort_by(|a, b| a.partial_cmp(b).unwrap());
        sorted.dedup();
        assert_eq!(sorted.len(), count);
    }
}

#[test]
fn the_knee_is_where_the_front_bends() {
    let front: Vec<Vec<f64>> = (1..=40)
        .map(|i| {
            let x = f64::from(i) / 10.0;
            vec![x, 1.0 / x]
        })
        .collect();
    // Scaled to [0, 1] over x in [0.1, 4]: the slope −1/x² · (3.9/9.75) is −1 at x = 0.632.
    let at = knee(&front).unwrap();
    assert!((front[at][0] - 0.6).abs() < 1e-12, "{:?}", front[at]);
    assert_eq!(knee(&front[..2]), None);
}

/// Where nothing is feasible there is no front, only the least violation; where all points are as good there is one point.
#[test]
fn a_front_has_feasible_points_and_each_once() {
    let of = |least: f64| {
        let model = Differences::new(move |x: &[f64], f: &mut [f64]| {
            (f[0], f[1]) = (1.0, 2.0);
            f[2] = least + x[0] * x[0];
        });
        let params = ProblemParams::new(&[0.5], 2, model)
            .variables([Variable::bounded("x", 0.5, -1.0, 1.0)])
            .inequalities(["g".to_owned()]);
        let mut settings = ParetoSettings::default();
        (settings.population, settings.generations, settings.polish) = (20, 5, false);
        pareto(&Problem::new(params).unwrap(), &settings).unwrap()
    };
    let none = of(0.25);
    assert!(none.points.is_empty() && none.violation >= 0.25, "{none:?}");
    let one = of(-9.0);
    assert_eq!((one.points.len(), one.violation), (1, 0.0));
}
