//! No point that is called a solution is refuted by random probes around it, from random starts of the shipped
//! problems. `GROUSER_STARTS=1000 cargo test --release -p grouser-design --test all refuted::` makes thousands of solves.

use std::collections::BTreeMap;
use std::path::Path;

use grouser_design::{Answer, Design, Task, read};

use crate::random_starts::{Stream, starts};

/// The decrease by the best of 200 probes of up to 1e-4 of each variable's range; `None` where none lowers the
/// utility by 1e-6 (1 + |utility|).
fn refuted(design: &Design, x: &[f64], stream: &mut Stream) -> Option<f64> {
    let here = design.merit(x).unwrap();
    let allowed = here.violation.max(0.0);
    let best = (0..200)
        .filter_map(|_| {
            let probe: Vec<f64> = x
                .iter()
                .zip(&design.variables)
                .map(|(x, v)| {
                    let step = 1e-4 * (v.upper - v.lower) * (2.0 * stream.next() - 1.0);
                    (x + step).clamp(v.lower, v.upper)
                })
                .collect();
            let merit = design.merit(&probe).unwrap();
            (merit.violation <= allowed).then_some(merit.utility)
        })
        .fold(f64::INFINITY, f64::min);
    let decrease = here.utility - best;
    (decrease > 1e-6 * (1.0 + here.utility.abs())).then_some(decrease)
}

#[test]
fn no_solution_of_a_shipped_problem_is_refuted() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/problems");
    let mut stream = Stream(11);
    let mut bad = Vec::new();
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    for path in files {
        let mut design = read(&path).unwrap();
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let start: Vec<f64> = design.variables.iter().map(|v| v.start).collect();
        let bounded = design
            .variables
            .iter()
            .all(|v| (v.upper - v.lower).is_finite());
        if design.task == Task::Pareto || !bounded || design.merit(&start).is_err() {
            println!("{name}: left out (a front, an open box, or a measure with helpers)");
            continue;
        }
        design.starts = 1;
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        let mut best = f64::INFINITY;
        for index in 0..starts(3) {
            for variable in &mut design.variables {
                variable.start = variable.lower + (variable.upper - variable.lower) * stream.next();
            }
            let Answer::Optimum(optimum) = design.solve().unwrap() else {
                unreachable!()
            };
            *counts.entry(optimum.status.name()).or_default() += 1;
            if optimum.status.is_solved() {
                best = best.min(optimum.utility);
                if let Some(decrease) = refuted(&design, &optimum.x, &mut stream) {
                    bad.push((name.clone(), index, optimum.utility, decrease));
                }
            }
        }
        println!("{name}: {counts:?}, best {best}");
    }
    assert!(bad.is_empty(), "{bad:?}");
}
