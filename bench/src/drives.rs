//! Whole drives: robot, ground, sensors, filter and controller. Start-up; simulated time over computing time with
//! the forces of steps in time and with those to 1e-9, in turn; and many robots on all cores.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::Instant;

use grouser_rover::drive::{Pilot, Scenario, Simulation, read_scenario};
use grouser_terra::Accuracy;

const RUNS: usize = 5;
const ROBOTS: u64 = 64;
/// Near the slip of the greatest efficiency of the robot on dry sand.
const SLIP: f64 = 0.39;

fn least(times: &[f64]) -> f64 {
    times.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Processor time of this thread, s (Linux), so that other programs have little effect.
fn now() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux");
    let first = text.split_whitespace().next().expect("a number");
    1e-9 * first.parse::<f64>().expect("nanoseconds")
}

/// Seconds that a drive simulates and takes after its start.
fn drive(scenario: &Scenario, accuracy: Accuracy) -> (f64, f64) {
    let new = Simulation::new(scenario, Pilot::Controller, SLIP, scenario.seed);
    let mut drive = new.expect("a drive");
    drive.set_accuracy(accuracy);
    let start = now();
    let result = drive.run(|_| true);
    (result.duration, now() - start)
}

/// Seconds that all robots simulate and take, on all cores, with their start.
fn many(scenario: &Scenario) -> (f64, f64) {
    let start = Instant::now();
    let tables = Simulation::soil_tables(scenario).expect("tables");
    let next = AtomicU64::new(0);
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let work = || {
        let mut simulated = 0.0;
        loop {
            let robot = next.fetch_add(1, Ordering::Relaxed);
            if robot >= ROBOTS {
                return simulated;
            }
            let seed = scenario.seed + robot;
            let new = Simulation::with_tables(scenario, Pilot::Controller, SLIP, seed, &tables);
            simulated += new.expect("a drive").run(|_| true).duration;
        }
    };
    let simulated: f64 = thread::scope(|scope| {
        let threads: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        threads
            .into_iter()
            .map(|thread| thread.join().expect("a drive"))
            .sum()
    });
    (simulated, start.elapsed().as_secs_f64())
}

pub fn run() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/scenarios");
    println!(
        "{:<12}{:>12}{:>16}{:>14}{:>8}",
        "drive", "start, ms", "times real time", "at 1e-9", "ratio"
    );
    for name in ["slope", "dunes", "sandbox"] {
        let scenario =
            read_scenario(&folder.join(name).with_extension("toml")).expect("a scenario");
        let (mut starts, mut quick, mut exact) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..RUNS {
            let start = now();
            Simulation::new(&scenario, Pilot::Controller, SLIP, scenario.seed).expect("a drive");
            starts.push(now() - start);
            let (simulated, took) = drive(&scenario, Accuracy::Simulation);
            quick.push(took / simulated);
            let (simulated, took) = drive(&scenario, Accuracy::Standard);
            exact.push(took / simulated);
        }
        let (start, quick, exact) = (1e3 * least(&starts), least(&quick), least(&exact));
        let (ratio, per_second) = (exact / quick, [1.0 / quick, 1.0 / exact]);
        println!(
            "{name:<12}{start:>12.1}{:>16.1}{:>14.1}{ratio:>8.2}",
            per_second[0], per_second[1]
        );
    }
    let sandbox = read_scenario(&folder.join("sandbox.toml")).expect("a scenario");
    let (simulated, took) = many(&sandbox);
    println!(
        "{ROBOTS} robots on all cores: {simulated:.0} s in {took:.1} s, {:.0} a second",
        simulated / took
    );
}
