//! One wheel in a control loop: every call timed by itself.

use std::hint::black_box;
use std::time::Instant;

use grouser_terra::{
    RigidWheel, Settings, Slip, Surrogate, SurrogateBox, TrackedWheel, WheelOnSoil, catalogue,
};

const TICKS: usize = 200_000;

/// Median, 99.9 % and greatest of some times, ns.
fn quantiles(mut times: Vec<f64>) -> [f64; 3] {
    times.sort_by(f64::total_cmp);
    [0.5, 0.999, 1.0].map(|q| times[((times.len() - 1) as f64 * q) as usize])
}

/// Times `call` at every tick of a loop of 100 Hz in which slip and load sway.
fn timed(mut call: impl FnMut(f64, f64) -> f64) -> [f64; 3] {
    let mut sum = 0.0;
    let mut times = Vec::with_capacity(TICKS);
    for i in 0..TICKS {
        let t = i as f64 * 0.01;
        let (slip, load) = (0.2 + 0.15 * t.sin(), 20.0 + 3.0 * (2.3 * t).cos());
        let start = Instant::now();
        sum += black_box(call(black_box(slip), black_box(load)));
        times.push(start.elapsed().as_secs_f64() * 1e9);
    }
    black_box(sum);
    quantiles(times)
}

pub fn run() {
    let soil = catalogue::find("dry-sand")
        .expect("in the catalogue")
        .soil()
        .expect("complete");
    let wheel = RigidWheel::new(0.1, 0.05).expect("a wheel");
    let pair = WheelOnSoil::new(wheel, soil, Settings::default()).expect("a pair");
    let slip = |s: f64| Slip::new(s).expect("a slip");
    let line = |name: &str, [p50, p999, most]: [f64; 3]| {
        println!("{name:<44}{p50:>10.0}{p999:>10.0}{most:>10.0}");
    };
    println!(
        "{:<44}{:>10}{:>10}{:>10}",
        "one call, ns (the clock's own time with it)", "p50", "p99.9", "max"
    );
    line("the clock alone", timed(|s, _| s));
    let mut tracked = TrackedWheel::new(pair.clone());
    let mut evaluations = 0;
    line(
        "sinkage and forces under a load, tracked",
        timed(|s, load| {
            let solved = tracked.under_load(load, slip(s)).expect("a search");
            evaluations += solved.evaluations;
            solved.forces.expect("carried").drawbar_pull
        }),
    );
    line(
        "the same, from nothing every time",
        timed(|s, load| {
            tracked.forget();
            let solved = tracked.under_load(load, slip(s)).expect("a search");
            solved.forces.expect("carried").drawbar_pull
        }),
    );
    line(
        "forces at a sinkage",
        timed(|s, _| tracked.forces(0.01, slip(s)).expect("forces").drawbar_pull),
    );
    let mut portable = TrackedWheel::new(pair.clone()).portable();
    line(
        "tracked, portable code",
        timed(|s, load| {
            let solved = portable.under_load(load, slip(s)).expect("a search");
            solved.forces.expect("carried").drawbar_pull
        }),
    );
    line(
        "the general solver",
        timed(|s, load| {
            let motion = grouser_terra::Kinematics::straight(slip(s));
            let found = pair.sinkage_under(load, &motion).expect("a search");
            let sinkage = found.sinkage().expect("carried");
            pair.forces_at(sinkage, &motion)
                .expect("forces")
                .drawbar_pull
        }),
    );
    let inside = SurrogateBox {
        slip: (0.0, 0.5),
        sinkage: (0.004, 0.03),
    };
    let built = (0..200)
        .map(|_| {
            let start = Instant::now();
            black_box(Surrogate::new(&pair, black_box(inside)).expect("a surrogate"));
            start.elapsed().as_secs_f64() * 1e9
        })
        .collect();
    let fast = Surrogate::new(&pair, inside).expect("a surrogate");
    line(
        "surrogate: sinkage and forces under a load",
        timed(|s, load| fast.under_load(load, s).expect("inside").drawbar_pull),
    );
    line(
        "surrogate: forces at a sinkage",
        timed(|s, _| fast.forces(0.01, s).expect("inside").drawbar_pull),
    );
    line("surrogate: built", quantiles(built));
    let bounds = fast.bounds();
    println!(
        "bounds of the surrogate: forces {:.1e}, entry angle {:.1e}",
        bounds.forces, bounds.theta_1
    );
    println!(
        "evaluations a tick, tracked: {:.2}",
        f64::from(evaluations) / TICKS as f64
    );
}
