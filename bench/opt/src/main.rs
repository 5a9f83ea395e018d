//! The optimiser beside its rivals, in one run: effort and time over the published minimax problems.
//!
//! `cargo run --release --manifest-path bench/opt/Cargo.toml [-- --csv]`; `bench/opt/rivals.py` adds SciPy and pymoo.

#[path = "../../../crates/opt/tests/literature/luksan_vlcek_linear.rs"]
mod luksan_vlcek_linear;
#[path = "../../../crates/opt/tests/literature/luksan_vlcek_unconstrained.rs"]
mod luksan_vlcek_unconstrained;
#[path = "../../../crates/opt/tests/literature/other.rs"]
mod other;
#[path = "../../../crates/opt/tests/literature/suite.rs"]
mod suite;

mod basin_slsqp;

use std::hint::black_box;
use std::time::Instant;

use grouser_opt::{Method, Problem, Settings, solve};

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

fn main() {
    println!("problem,optimum,ours,ours_jacobians,ours_us,ours_ok,basin,basin_jacobians,basin_us,basin_ok");
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
