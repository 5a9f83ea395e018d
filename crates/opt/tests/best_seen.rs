//! No search returns less than the best feasible point that its functions were evaluated at, on random problems with kinks and
//! jumps. `GROUSER_STARTS=10000 cargo test -p grouser-opt --test all best_seen::` makes ten thousand of each kind.

use std::sync::Mutex;

use crate::random_starts::{Stream, starts};

use grouser_opt::{
    Differences, LinearConstraint, Measure, Method, ParetoSettings, Problem, ProblemParams,
    Settings, Variable, World, evaluate, multi_start, pareto, robust, solve,
};

/// What the conditions of an optimum and the tolerance of constraints leave open, relative to 1 + |f|.
const OPEN_SHARE: f64 = 1e-6;
/// Over that, what polishing leaves open at an end of a front.
const END_FACTOR: f64 = 3.0;
const HALF_WIDTH: f64 = 3.0;

/// A sum of terms: kinks, jumps, smooth valleys, waves.
struct Rough(Vec<(usize, [f64; 4])>);

impl Rough {
    fn new(stream: &mut Stream) -> Self {
        let count = 1 + below(3, stream);
        let term = |_| {
            let numbers = [(); 4].map(|()| 2.0 * stream.next() - 1.0);
            (below(6, stream), numbers)
        };
        Self((0..count).map(term).collect())
    }

    fn at(&self, x: &[f64]) -> f64 {
        let terms = self.0.iter().enumerate().map(|(k, (kind, [a, b, c, d]))| {
            let (x, y) = (x[k % x.len()], x[(k + 1) % x.len()]);
            let off = x - HALF_WIDTH * b;
            match kind {
                0 => a * off.abs(),
                1 => (off + c * y).abs() + 0.1 * d * y,
                2 => off * off + a * x * y,
                3 => a + d * off + if off > 0.0 { *c } else { 0.0 },
                4 => off.abs().min((x - HALF_WIDTH * c).powi(2) + 0.5 * d.abs()),
                _ => (2.0 * off).sin() + a * y.abs().sqrt(),
            }
        });
        terms.sum()
    }
}

fn below(count: usize, stream: &mut Stream) -> usize {
    let at = count as f64 * stream.next();
    (0..count).rfind(|k| *k as f64 <= at).unwrap_or(0)
}

/// Rough functions of up to three variables over a box.
struct Case {
    variables: usize,
    objectives: usize,
    inequalities: usize,
    functions: Vec<Rough>,
    absolute: usize,
    start: Vec<f64>,
    rows: Vec<LinearConstraint>,
    /// Every point of an evaluation.
    seen: Mutex<Vec<Vec<f64>>>,
}

impl Case {
    fn new(objectives: usize, stream: &mut Stream) -> Self {
        let variables = 1 + below(3, stream);
        let inequalities = below(3, stream);
        let coefficients = (0..variables).map(|_| 2.0 * stream.next() - 1.0).collect();
        let row = LinearConstraint::at_most("row", coefficients, stream.next() + 0.2);
        Self {
            variables,
            objectives,
            inequalities,
            functions: (0..objectives + inequalities)
                .map(|_| Rough::new(stream))
                .collect(),
            absolute: below(objectives + 1, stream),
            start: (0..variables)
                .map(|_| HALF_WIDTH * (2.0 * stream.next() - 1.0))
                .collect(),
            rows: if stream.next() < 0.5 {
                vec![row]
            } else {
                Vec::new()
            },
            seen: Mutex::default(),
        }
    }

    fn model(&self) -> Differences<impl Fn(&[f64], &mut [f64]) + Sync> {
        let limit = [HALF_WIDTH; 3];
        Differences::new(|x: &[f64], f: &mut [f64]| {
            self.seen.lock().unwrap().push(x.to_vec());
            for (f, function) in f.iter_mut().zip(&self.functions) {
                *f = function.at(x);
            }
        })
        .within(
            &limit.map(|limit| -limit)[..self.variables],
            &limit[..self.variables],
        )
    }

    fn params(&self) -> ProblemParams<'_> {
        let variables = self.start.iter().enumerate();
        let bounded = |(k, start): (usize, &f64)| {
            Variable::bounded(format!("x{k}"), *start, -HALF_WIDTH, HALF_WIDTH)
        };
        ProblemParams::new(&self.start, self.objectives, self.model())
            .variables(variables.map(bounded))
            .inequalities((0..self.inequalities).map(|k| format!("g{k}")))
            .linear(self.rows.clone())
            .absolute(self.absolute)
    }

    /// The points so far.
    fn take(&self) -> Vec<Vec<f64>> {
        std::mem::take(&mut self.seen.lock().unwrap())
    }

    fn method(&self, stream: &mut Stream) -> Method {
        let mut numbers = |least: f64| -> Vec<f64> {
            (0..self.objectives)
                .map(|_| least + stream.next())
                .collect()
        };
        let (goals, weights) = (numbers(-1.0), numbers(0.1));
        match below(4, stream) {
            0 => Method::Minimax,
            1 => Method::Attain { goals, weights },
            2 => Method::Weighted { weights },
            _ => Method::Chebyshev {
                ideal: goals,
                weights,
            },
        }
    }
}

/// The least utility of points that violate nothing.
fn least(problem: &Problem<'_>, method: &Method, points: &[Vec<f64>]) -> f64 {
    let merits = points.iter().map(|x| evaluate(problem, method, x).unwrap());
    let feasible = merits.filter(|merit| merit.violation <= 0.0);
    feasible
        .map(|merit| merit.utility)
        .fold(f64::INFINITY, f64::min)
}

fn is_below(found: f64, seen: f64) -> bool {
    found <= seen + OPEN_SHARE * (1.0 + seen.abs())
}

#[test]
fn no_solve_returns_less_than_it_has_seen() {
    let (mut stream, mut solved, mut stalled) = (Stream(56), 0, 0);
    for number in 0..starts(300) {
        let case = Case::new(1 + below(3, &mut stream), &mut stream);
        let (problem, method) = (
            Problem::new(case.params()).unwrap(),
            case.method(&mut stream),
        );
        let mut settings = Settings::default();
        if stream.next() < 0.2 {
            settings.max_iterations = below(5, &mut stream);
        }
        let found = solve(&problem, &method, &settings).unwrap();
        let seen = least(&problem, &method, &case.take());
        assert!(
            is_below(found.utility, seen),
            "{number}: {found:?} instead of {seen}"
        );
        let there = evaluate(&problem, &method, &found.x).unwrap();
        assert!((there.utility - found.utility).abs() <= 1e-12 * (1.0 + found.utility.abs()));
        assert!(
            there.violation <= 1e-6 || seen == f64::INFINITY,
            "{number}: {found:?}"
        );
        solved += usize::from(found.status.is_solved());
        stalled += usize::from(found.status.name() == "stalled");
        case.take();
        let found = multi_start(&problem, &method, &settings, 4, number).unwrap();
        let seen = least(&problem, &method, &case.take());
        assert!(
            is_below(found.best().utility, seen),
            "{number}: {:?} instead of {seen}",
            found.best()
        );
    }
    println!("{solved} solved, {stalled} stalled");
}

#[test]
fn no_robust_solve_returns_less_than_it_has_seen() {
    let mut stream = Stream(5);
    for number in 0..starts(100) {
        let case = Case::new(1 + below(2, &mut stream), &mut stream);
        let shifts = [(); 5].map(|()| stream.next() - 0.5);
        let case_ref = &case;
        let world = |shift: &f64| {
            let shift = *shift;
            let model = Differences::new(move |x: &[f64], f: &mut [f64]| {
                let moved: Vec<f64> = x.iter().map(|x| x + shift).collect();
                case_ref.seen.lock().unwrap().push(x.to_vec());
                for (f, function) in f.iter_mut().zip(&case_ref.functions) {
                    *f = function.at(&moved);
                }
            });
            World::new(shift.to_string(), model)
        };
        let measure = match below(3, &mut stream) {
            0 => Measure::WorstCase,
            1 => Measure::MeanPlusDeviations { kappa: 1.0 },
            _ => Measure::ConditionalValueAtRisk { alpha: 0.6 },
        };
        let problem = robust(case.params(), shifts.iter().map(world).collect(), measure).unwrap();
        let settings = Settings::default();
        let found = solve(&problem, &Method::Minimax, &settings).unwrap();
        let seen = least(&problem, &Method::Minimax, &case.take());
        assert!(
            is_below(found.utility, seen),
            "{number}: {found:?} instead of {seen}"
        );
    }
}

/// No point that was evaluated beats a point of a front in both objectives, or an end of it in one.
#[test]
fn no_front_has_less_than_it_has_seen() {
    let mut stream = Stream(9);
    for number in 0..starts(30) {
        let case = Case::new(2 + below(2, &mut stream), &mut stream);
        let problem = Problem::new(case.params()).unwrap();
        let mut settings = ParetoSettings::default();
        (settings.population, settings.generations) = (20, 15);
        (settings.polish, settings.seed) = (stream.next() < 0.8, number);
        let front = pareto(&problem, &settings).unwrap();
        let seen = case.take();
        let feasible = seen
            .iter()
            .filter(|x| evaluate(&problem, &Method::Minimax, x).unwrap().violation <= 0.0);
        let sized = |x: &Vec<f64>| -> Vec<f64> {
            let values = case.functions[..case.objectives].iter().map(|f| f.at(x));
            let sized = values
                .enumerate()
                .map(|(k, f)| if k < case.absolute { f.abs() } else { f });
            sized.collect()
        };
        for objectives in feasible.map(sized) {
            for (k, own) in objectives.iter().enumerate() {
                assert!(
                    (front.ideal[k] - own) <= END_FACTOR * OPEN_SHARE * (1.0 + own.abs()),
                    "{number}: {own} of {k}: {:?}",
                    front.ideal
                );
            }
            for point in &front.points {
                let mut pairs = point.objectives.iter().zip(&objectives);
                assert!(
                    pairs.any(|(own, seen)| is_below(*own, *seen)),
                    "{number}: {objectives:?} {point:?}"
                );
            }
        }
    }
}
