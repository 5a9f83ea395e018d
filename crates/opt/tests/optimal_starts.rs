//! A search that begins where another one ended ends there as well, as solved.

use crate::literature::suite;
use crate::random_starts::{Stream, starts};

use grouser_opt::{
    Certificate, CertifySettings, CertifyStatus, Exact, Functions, Method, Problem, ProblemParams,
    Settings, Solution, Variable, certify, solve,
};
use grouser_real::Scalar;

/// A smooth sum with several valleys, and a smooth limit.
#[derive(Clone, Debug)]
struct Waves {
    bowl: [f64; 2],
    wave: [f64; 3],
    offset: f64,
    limit: Option<[f64; 3]>,
}

impl Waves {
    fn new(stream: &mut Stream) -> Self {
        let mut number = || 2.0 * stream.next() - 1.0;
        Self {
            bowl: [number(), number()],
            wave: [number(), 3.0 * number(), number()],
            offset: if number() > 0.0 { number() } else { 0.0 },
            limit: (number() > 0.0).then(|| [number(), number(), number().abs()]),
        }
    }
}

impl Functions for Waves {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let c = R::from_f64;
        let [a, b] = self.bowl;
        let [size, rate, phase] = self.wave;
        f[0] = (x[0] - c(a)).square()
            + c(0.5) * (x[1] - c(b) * x[0]).square()
            + c(size) * (c(rate) * x[0] + x[1] + c(phase)).sin()
            + c(self.offset);
        if let Some([a, b, room]) = self.limit {
            f[1] = (x[0] - c(a)).square() + (x[1] - c(b)).square() - c(1.0 + room);
        }
    }
}

impl Waves {
    fn problem(&self) -> Problem<'static> {
        let sides = ["x", "y"].map(|name| Variable::bounded(name, 0.3, -2.0, 2.0));
        let params = ProblemParams::new(&[0.3, 0.3], 1, Exact(self.clone())).variables(sides);
        let limits = self.limit.map(|_| "limit".to_owned());
        Problem::new(params.inequalities(limits)).unwrap()
    }
}

fn from(problem: &Problem<'_>, x: &[f64]) -> Solution {
    let again = problem.from_start(x).unwrap();
    solve(&again, &Method::Minimax, &Settings::default()).unwrap()
}

#[test]
fn a_search_from_a_solution_is_solved() {
    let mut stream = Stream(3);
    let (mut count, mut bad) = (0, Vec::new());
    for case in suite::all() {
        let problem = Problem::new((case.params)()).unwrap();
        for _ in 0..starts(5) {
            let x: Vec<f64> = problem
                .variables()
                .iter()
                .map(|v| (v.start + 2.0 * stream.next() - 1.0).clamp(v.lower, v.upper))
                .collect();
            let first = from(&problem, &x);
            if !first.status.is_solved() {
                continue;
            }
            count += 1;
            let again = from(&problem, &first.x);
            if !again.status.is_solved() {
                bad.push((
                    case.name,
                    first.status,
                    again.status,
                    again.utility - first.utility,
                ));
            }
        }
    }
    println!("{count} solutions; not solved again: {bad:?}");
    assert!(count > 50 && bad.is_empty(), "{bad:?}");
}

#[test]
fn a_search_from_the_best_point_of_a_proof_is_solved() {
    let mut stream = Stream(5);
    let mut bad = Vec::new();
    for number in 0..starts(60) {
        let waves = Waves::new(&mut stream);
        let problem = waves.problem();
        let mut settings = CertifySettings::default();
        settings.max_boxes = 20_000;
        settings.starts = 4 * (number % 3) as usize;
        let proof: Certificate = certify(&problem, &Method::Minimax, &settings).unwrap();
        assert_eq!(proof.status, CertifyStatus::Proved, "{waves:?}: {proof:?}");
        let Some(x) = proof.x else { continue };
        let again = from(&problem, &x);
        if !again.status.is_solved() {
            let off = again.utility - proof.upper;
            bad.push((number, again.status, off, again.kkt));
        }
    }
    assert!(bad.is_empty(), "{bad:?}");
}
