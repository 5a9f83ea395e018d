//! The published problems over boxes of ±5 around their starts (`literature/boxes.csv`, within the problems' own
//! bounds): proved, or the gap that was reached.
//! `GROUSER_CERTIFY_S=60 cargo test --release -p grouser-opt --test all certified:: -- --nocapture` measures all of them.

use std::collections::BTreeMap;

use std::fmt::Write as _;
use std::ops::ControlFlow;

use grouser_opt::{
    CertifyError, CertifySettings, CertifyStatus, Differences, Exact, Functions, Method, Problem,
    ProblemParams, Settings, Variable, certify, certify_with, evaluate, solve,
};
use grouser_real::Scalar;

use crate::literature::further;
use crate::literature::suite;
use crate::random_starts::Stream;

/// The boxes: problem, variable, lower, upper.
const BOXES: &str = include_str!("literature/boxes.csv");

fn boxes() -> BTreeMap<&'static str, Vec<(f64, f64)>> {
    let mut map: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
    for line in BOXES.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let list = map.entry(cells[0]).or_default();
        list.push((cells[2].parse().unwrap(), cells[3].parse().unwrap()));
    }
    map
}

/// The side of ±5 around a start, within the variable's own bounds.
fn around(params: &ProblemParams<'_>) -> Vec<(f64, f64)> {
    let side = |v: &Variable| (v.lower.max(v.start - 5.0), v.upper.min(v.start + 5.0));
    params.variables.iter().map(side).collect()
}

fn boxed(params: fn() -> ProblemParams<'static>, sides: &[(f64, f64)]) -> Problem<'static> {
    let mut params = params();
    for (variable, (lower, upper)) in params.variables.iter_mut().zip(sides) {
        (variable.lower, variable.upper) = (*lower, *upper);
    }
    Problem::new(params).unwrap()
}

/// The problems that are proved within a second each.
const QUICK: [&str; 9] = [
    "CB2",
    "SPIRAL",
    "RosenSuzuki",
    "PBC3",
    "Davidon2",
    "MAD1",
    "MAD4",
    "MAD6",
    "MATLAB-doc",
];

#[test]
fn quick_problems_are_proved_with_little_effort() {
    let boxes = boxes();
    let mut table = String::new();
    for case in suite::all()
        .iter()
        .filter(|case| QUICK.contains(&case.name))
    {
        let problem = boxed(case.params, &boxes[case.name]);
        let mut settings = CertifySettings::default();
        settings.max_boxes = 5000;
        let c = certify(&problem, &Method::Minimax, &settings).unwrap();
        assert_eq!(c.status, CertifyStatus::Proved, "{}", case.name);
        assert!(
            c.gap() <= 1e-6 * (1.0 + c.upper.abs()) && c.lower <= c.upper,
            "{}",
            case.name
        );
        // the published optimum is that of the whole space; some boxes do not hold it
        assert!(
            c.upper >= case.optimum - 1e-6 * (1.0 + case.optimum.abs()),
            "{}: {}",
            case.name,
            c.upper
        );
        let _ = writeln!(table, "{:<12} boxes {:>5}", case.name, c.boxes);
    }
    insta::assert_snapshot!(table);
}

/// The further problems: the local solve from the published start ends at the published optimum, so that the functions
/// are those of the source, and the global optimum of the box is proved. OET6 and Wong1 take thousands of boxes.
#[test]
fn further_problems_are_proved_with_little_effort() {
    let mut table = String::new();
    for case in further::all() {
        let local = Problem::new((case.params)()).unwrap();
        let local = solve(&local, &Method::Minimax, &Settings::default()).unwrap();
        let off = local.maximum - case.optimum;
        println!("{:<10} {:?} off {off:.1e}", case.name, local.status);
        assert!(
            off.abs() <= 1e-6 * (1.0 + case.optimum.abs()),
            "{}",
            case.name
        );
        if ["OET6", "Wong1"].contains(&case.name) {
            continue;
        }
        let problem = boxed(case.params, &around(&(case.params)()));
        let mut settings = CertifySettings::default();
        settings.max_boxes = 2000;
        let c = certify(&problem, &Method::Minimax, &settings).unwrap();
        assert_eq!(c.status, CertifyStatus::Proved, "{}", case.name);
        // PBC1's published optimum is not in the box
        let mut sides = problem.variables().iter().zip(&local.x);
        let inside = sides.all(|(v, x)| v.lower <= *x && *x <= v.upper);
        assert_eq!(inside, case.name != "PBC1");
        assert!(!inside || (c.lower <= local.maximum && c.upper >= case.optimum - 1e-6));
        let _ = writeln!(table, "{:<12} boxes {:>5}", case.name, c.boxes);
    }
    insta::assert_snapshot!(table);
}

/// No random feasible point of any box lies below the proved bound, however early the search ends.
#[test]
fn no_point_lies_below_a_proved_bound() {
    let boxes = boxes();
    let mut stream = Stream(5);
    let mut tried = 0;
    for case in suite::all().into_iter().chain(further::all()) {
        let sides = boxes.get(case.name).cloned();
        let sides = sides.unwrap_or_else(|| around(&(case.params)()));
        let problem = boxed(case.params, &sides);
        let mut settings = CertifySettings::default();
        settings.max_boxes = 300;
        let c = certify(&problem, &Method::Minimax, &settings).unwrap();
        assert!(c.lower <= c.upper, "{}", case.name);
        let centre = c.x.clone();
        for turn in 0..1000 {
            // over the whole box, and near the best point
            let x: Vec<f64> = problem
                .variables()
                .iter()
                .enumerate()
                .map(|(i, v)| {
                    let anywhere = v.lower + (v.upper - v.lower) * stream.next();
                    match &centre {
                        Some(c) if turn % 2 == 0 => {
                            (c[i] + 1e-3 * (anywhere - c[i])).clamp(v.lower, v.upper)
                        }
                        _ => anywhere,
                    }
                })
                .collect();
            let merit = evaluate(&problem, &Method::Minimax, &x).unwrap();
            if merit.violation <= 0.0 && !merit.utility.is_nan() {
                tried += 1;
                assert!(
                    merit.utility >= c.lower,
                    "{}: {} < {} at {x:?}",
                    case.name,
                    merit.utility,
                    c.lower
                );
            }
        }
    }
    assert!(tried > 5000, "{tried}");
}

struct Nowhere;
impl Functions for Nowhere {
    /// x² + y² ≤ 1 and x y ≥ 0.51 exclude each other.
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = x[0];
        f[1] = x[0].square() + x[1].square() - R::ONE;
        f[2] = R::from_f64(0.51) - x[0] * x[1];
    }
}

#[test]
fn the_absence_of_feasible_points_is_proved() {
    let params = ProblemParams::new(&[0.0, 0.0], 1, Exact(Nowhere))
        .variables(["x", "y"].map(|name| Variable::bounded(name, 0.0, -3.0, 3.0)))
        .inequalities(["disc".to_owned(), "product".to_owned()]);
    let c = certify(
        &Problem::new(params).unwrap(),
        &Method::Minimax,
        &CertifySettings::default(),
    )
    .unwrap();
    assert_eq!(c.status, CertifyStatus::Infeasible);
    assert!(c.x.is_none() && c.lower == f64::INFINITY);
}

#[test]
fn functions_that_are_no_formulas_are_refused() {
    let model = Differences::new(|x: &[f64], f: &mut [f64]| f[0] = x[0]);
    let params =
        ProblemParams::new(&[0.0], 1, model).variables([Variable::bounded("x", 0.0, -1.0, 1.0)]);
    let refused = certify(
        &Problem::new(params).unwrap(),
        &Method::Minimax,
        &CertifySettings::default(),
    );
    assert_eq!(refused, Err(CertifyError::NoFormula));
}

struct Infinite;
impl Functions for Infinite {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = x[0].min(R::from_f64(f64::INFINITY));
    }
}

#[test]
fn infinite_numbers_in_a_formula_are_refused() {
    let params = ProblemParams::new(&[0.0], 1, Exact(Infinite))
        .variables([Variable::bounded("x", 0.0, -1.0, 1.0)]);
    let refused = certify(
        &Problem::new(params).unwrap(),
        &Method::Minimax,
        &CertifySettings::default(),
    );
    assert_eq!(
        refused.unwrap_err().to_string(),
        "the formula of `f1` holds inf, which is no finite number"
    );
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let boxes = boxes();
    let case = suite::all()
        .into_iter()
        .find(|case| case.name == "RosenSuzuki")
        .unwrap();
    let problem = boxed(case.params, &boxes[case.name]);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let mut c = pool
            .install(|| certify(&problem, &Method::Minimax, &CertifySettings::default()).unwrap());
        c.seconds = 0.0;
        c
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn published_problems_are_proved_or_their_gap_is_measured() {
    let Ok(seconds) = std::env::var("GROUSER_CERTIFY_S") else {
        println!("skipped: GROUSER_CERTIFY_S gives the seconds for each problem");
        return;
    };
    let seconds: f64 = seconds.parse().unwrap();
    let only = std::env::var("GROUSER_CERTIFY_ONLY").unwrap_or_default();
    let folder = std::env::var("GROUSER_CERTIFY_LOGS").ok();
    let boxes = boxes();
    for case in suite::all().into_iter().chain(further::all()) {
        if !case.name.contains(&only) {
            continue;
        }
        let sides = boxes.get(case.name).cloned();
        let sides = sides.unwrap_or_else(|| around(&(case.params)()));
        let problem = boxed(case.params, &sides);
        let mut settings = CertifySettings::default();
        settings.time_limit_s = Some(seconds);
        let mut log = folder.as_ref().map(|folder| {
            let file = std::fs::File::create(format!("{folder}/{}.jsonl", case.name)).unwrap();
            std::io::BufWriter::new(file)
        });
        let mut write = |line: &str| {
            if let Some(log) = &mut log {
                std::io::Write::write_fmt(log, format_args!("{line}\n")).unwrap();
            }
            ControlFlow::Continue(())
        };
        let go_on = &mut |_: &_| ControlFlow::Continue(());
        let c = certify_with(
            &problem,
            &Method::Minimax,
            &settings,
            go_on,
            Some(&mut write),
        )
        .unwrap();
        println!(
            "{:<15} n {:>2}  {:<10} lower {:>18.10e} upper {:>18.10e} gap {:>9.2e} ({:.1e} of 1 + |f|) boxes {:>8} in {:>5.1} s",
            case.name,
            problem.variables().len(),
            c.status.name(),
            c.lower,
            c.upper,
            c.gap(),
            c.gap() / (1.0 + c.upper.abs()),
            c.boxes,
            c.seconds
        );
    }
}
