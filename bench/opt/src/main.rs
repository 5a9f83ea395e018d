//! The optimiser beside its rivals, in one run: effort and time over the published minimax problems.
//!
//! `cargo run --release --manifest-path bench/opt/Cargo.toml [-- fronts]` prints CSV; `bench/opt/rivals.py` puts
//! SciPy and pymoo beside it.

#[path = "../../../crates/opt/tests/literature/luksan_vlcek_linear.rs"]
mod luksan_vlcek_linear;
#[path = "../../../crates/opt/tests/literature/luksan_vlcek_unconstrained.rs"]
mod luksan_vlcek_unconstrained;
#[path = "../../../crates/opt/tests/literature/other.rs"]
mod other;
#[path = "../../../crates/opt/tests/literature/suite.rs"]
mod suite;

#[allow(dead_code, reason = "shared with the tests")]
#[path = "../../../crates/opt/tests/fronts/problems.rs"]
mod fronts;
#[path = "../../../crates/opt/tests/fronts/hypervolume.rs"]
mod hypervolume;

mod basin_slsqp;

use std::hint::black_box;
use std::time::Instant;

use grouser_opt::{Method, ParetoSettings, Problem, Settings, pareto, solve};
use hypervolume::hypervolume;

/// The best of several repetitions, in microseconds.
fn microseconds(mut job: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..20 {
        let start = Instant::now();
        job();
        best = best.min(start.elapsed().as_secs_f64() * 1e6);
    }
    best
}

/// Hypervolume and time of a front before and after polishing.
fn front(name: &str, (problem, settings): (Problem<'_>, ParetoSettings)) {
    let reference = vec![1.1; problem.objectives().len()];
    let measure = |polish: bool| {
        let mut settings = settings.clone();
        settings.polish = polish;
        let front = pareto(&problem, &settings).expect("valid settings");
        let mut seconds = f64::INFINITY;
        for _ in 0..5 {
            let start = Instant::now();
            black_box(pareto(&problem, &settings).expect("valid settings"));
            seconds = seconds.min(start.elapsed().as_secs_f64());
        }
        let volume = hypervolume(&front.objectives(), &reference).expect("a finite front");
        (volume, seconds)
    };
    let ((volume, seconds), (volume_polished, seconds_polished)) = (measure(false), measure(true));
    println!("{name},{volume:.6},{seconds:.4},{volume_polished:.6},{seconds_polished:.4}");
}

fn main() {
    if std::env::args().any(|argument| argument == "fronts") {
        println!("problem,volume,seconds,volume_polished,seconds_polished");
        front("ZDT1", fronts::zdt1());
        front("DTLZ2", fronts::dtlz2());
        return;
    }
    println!(
        "problem,optimum,ours,ours_jacobians,ours_us,ours_ok,basin,basin_jacobians,basin_us,basin_ok"
    );
    for case in suite::all() {
        let problem = Problem::new((case.params)()).expect("a published problem");
        let settings = Settings::default();
        let ours = solve(&problem, &Method::Minimax, &settings).expect("valid settings");
        let ours_us = microseconds(|| {
            black_box(solve(&problem, &Method::Minimax, &settings).expect("valid settings"));
        });
        let basin = basin_slsqp::solve(&problem);
        let basin_us = microseconds(|| {
            black_box(basin_slsqp::solve(&problem));
        });
        let ok = |value: f64| (value - case.optimum).abs() <= 1e-6 * (1.0 + case.optimum.abs());
        println!(
            "{},{},{:.10},{},{ours_us:.1},{},{:.10},{},{basin_us:.1},{}",
            case.name,
            case.optimum,
            ours.maximum,
            ours.counts.jacobians,
            ok(ours.maximum),
            basin.maximum,
            basin.jacobians,
            ok(basin.maximum),
        );
    }
}
