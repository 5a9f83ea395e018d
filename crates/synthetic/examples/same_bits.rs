//! Prints a SHA-256 over every number of some computations, for comparison between machines (`just same-bits`):
//! `same_bits [canary|reference|batch|drives|scenarios|estimate]… [print] [seconds of each scenario]`, from the project's
//! folder; `print` prints the numbers too.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a check fails by panicking and prints what it found"
)]

use std::fmt::{Debug, Write};
use std::hint::black_box;
use std::path::Path;

use grouser_files::{columns, robot};
use grouser_log::Log;
use grouser_real::Real;
use grouser_replay::{Options, run};
use grouser_rover::drive::{Pilot, Simulation, read_scenario};
use grouser_terra::{
    Accuracy, BatchColumns, BatchKernel, BatchPoints, Kinematics, RigidWheel, Settings, Slip,
    SolveStatus, WheelOnSoil, catalogue,
};
use sha2::{Digest, Sha256};

/// Every number by its shortest text that reads back to the same bits; NaN without its sign and payload, which
/// processors choose freely.
struct Sum {
    hash: Sha256,
    prints: bool,
}

impl Write for Sum {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.hash.update(text);
        if self.prints {
            print!("{text}");
        }
        Ok(())
    }
}

impl Sum {
    fn add(&mut self, value: impl Debug) {
        writeln!(self, "{value:?}").unwrap();
    }
}

/// Adds the numbers of a computation; with the seconds of each scenario.
type Part = fn(&mut Sum, f64);

const PARTS: [(&str, Part); 6] = [
    ("canary", canary),
    ("reference", reference),
    ("batch", batch),
    ("drives", drives),
    ("scenarios", scenarios),
    ("estimate", estimate),
];
/// Shipped scenarios, seeds of the short drives, and their length.
const SCENARIOS: [&str; 7] = [
    "sandbox",
    "slope",
    "soft-patch",
    "dunes",
    "faults",
    "plan-and-learn",
    "unknown-soil",
];
const SHORT_DRIVES: u64 = 50;
const SHORT_DRIVE_S: f64 = 4.0;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let seconds = arguments.iter().find_map(|a| a.parse().ok());
    let named = |name: &str| arguments.iter().any(|a| a == name);
    let all = !PARTS.iter().any(|(name, _)| named(name));
    let lanes = BatchKernel::new(catalogue::find("dry-sand").unwrap().soil().unwrap());
    println!(
        "deterministic: {}, lanes: {}",
        grouser_real::DETERMINISTIC,
        lanes.instructions()
    );
    for (name, part) in PARTS {
        if all || named(name) {
            let mut sum = Sum {
                hash: Sha256::new(),
                prints: named("print"),
            };
            part(&mut sum, seconds.unwrap_or(f64::INFINITY));
            let hash: String = sum
                .hash
                .finalize()
                .iter()
                .fold(String::new(), |mut s, byte| {
                    write!(s, "{byte:02x}").unwrap();
                    s
                });
            println!("{hash}  {name}");
            assert!(
                name != "canary" || !grouser_real::DETERMINISTIC || hash == CANARY,
                "other functions than libm's, or contraction: the canary's sum must be {CANARY}"
            );
        }
    }
}

/// The sum of `canary` with libm and without contraction. It moves with a version of libm only, which then changes
/// results (CHANGELOG.md).
const CANARY: &str = "30856f9bd3122aa60649985e75e44f035fd36c146b4c0da0fffba627e167b264";

/// Each function on its own, over its usual range.
fn canary(sum: &mut Sum, _: f64) {
    type Function = fn(f64) -> f64;
    let functions: [(&str, Function, f64, f64); 14] = [
        ("exp", Real::exp, -30.0, 30.0),
        ("exp_m1", Real::exp_m1, -3.0, 3.0),
        ("ln", Real::ln, 1e-3, 1e3),
        ("ln_1p", Real::ln_1p, -0.9, 9.0),
        ("sin", Real::sin, -10.0, 10.0),
        ("cos", Real::cos, -10.0, 10.0),
        ("tan", Real::tan, -1.5, 1.5),
        ("asin", Real::asin, -1.0, 1.0),
        ("acos", Real::acos, -1.0, 1.0),
        ("atan", Real::atan, -5.0, 5.0),
        ("sinh", Real::sinh, -3.0, 3.0),
        ("cosh", Real::cosh, -3.0, 3.0),
        ("tanh", Real::tanh, -3.0, 3.0),
        ("powi", |x| Real::powi(x, -5), 0.1, 9.0),
    ];
    let steps = 2000;
    for (name, function, low, high) in functions {
        sum.add(name);
        for i in 0..=steps {
            let x = low + (high - low) * f64::from(i) / f64::from(steps);
            sum.add(function(x));
            sum.add(Real::powf(x.abs(), 0.3 + 1e-3 * f64::from(i)));
            sum.add(Real::atan2(x, 1.7));
            sum.add(Real::hypot(x, 1.7));
            // contraction would round once
            sum.add(black_box(x) * black_box(x) - black_box(0.3));
        }
    }
}

struct Case {
    soil: String,
    radius: f64,
    width: f64,
    rebound: f64,
    slip: f64,
    sinkage: f64,
    load: f64,
}

/// The operating points of terra's 221 reference cases.
fn cases() -> Vec<Case> {
    include_str!("../../terra/tests/oracle/wheel_cases.csv")
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let number = |i: usize| cells[i].parse::<f64>().unwrap();
            Case {
                soil: cells[1].to_owned(),
                radius: number(2),
                width: number(3),
                rebound: number(4),
                slip: number(5),
                sinkage: number(6),
                load: number(7),
            }
        })
        .collect()
}

fn reference(sum: &mut Sum, _: f64) {
    for accuracy in [
        Accuracy::Simulation,
        Accuracy::Standard,
        Accuracy::Reference,
    ] {
        for case in cases() {
            let soil = catalogue::find(&case.soil).unwrap().soil().unwrap();
            let wheel = RigidWheel::new(case.radius, case.width).unwrap();
            let settings = Settings {
                accuracy,
                ..Settings::default()
            };
            let soil = soil.with_rebound(case.rebound).unwrap();
            let contact = WheelOnSoil::new(wheel, soil, settings).unwrap();
            let motion = Kinematics::straight(Slip::new(case.slip).unwrap());
            sum.add(contact.at_sinkage(case.sinkage, &motion));
            sum.add(contact.under_load(case.load.abs(), &motion));
        }
    }
}

/// The same points on lanes, those of this machine and plain code.
fn batch(sum: &mut Sum, _: f64) {
    let cases = cases();
    let column = |of: fn(&Case) -> f64| cases.iter().map(of).collect::<Vec<f64>>();
    let (radius, width) = (column(|c| c.radius), column(|c| c.width));
    let (rebound, slip) = (column(|c| c.rebound), column(|c| c.slip));
    let (sinkage, load) = (column(|c| c.sinkage), column(|c| c.load.abs()));
    for soil in catalogue::entries()
        .iter()
        .filter_map(|entry| entry.soil().ok())
    {
        let kernel = BatchKernel::new(soil);
        let points = BatchPoints {
            radius: (&radius[..]).into(),
            width: (&width[..]).into(),
            rebound: (&rebound[..]).into(),
            slip: (&slip[..]).into(),
        };
        let count = cases.len();
        let run = |kernel: &BatchKernel, under_load: bool| {
            let mut columns: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; count]);
            let mut status = vec![SolveStatus::default(); count];
            let [z, w, dp, t] = &mut columns;
            let mut out = BatchColumns {
                sinkage: z,
                vertical_force: w,
                drawbar_pull: dp,
                torque: t,
                status: &mut status,
            };
            if under_load {
                kernel.under_load(&points, &load[..], &mut out).unwrap();
            } else {
                kernel.forces(&points, &sinkage[..], &mut out).unwrap();
            }
            format!("{columns:?} {status:?}")
        };
        for under_load in [false, true] {
            let text = run(&kernel, under_load);
            assert!(
                !grouser_real::DETERMINISTIC || text == run(&kernel.clone().portable(), under_load),
                "lanes of {} differ from plain code",
                kernel.instructions()
            );
            sum.add(text);
        }
    }
}

fn drive(sum: &mut Sum, name: &str, seed: Option<u64>, seconds: f64) {
    let path = Path::new("examples/scenarios")
        .join(name)
        .with_extension("toml");
    let mut scenario = read_scenario(&path).unwrap();
    scenario.duration = scenario.duration.min(seconds);
    let slip = scenario.slip_setpoint().unwrap();
    let seed = seed.unwrap_or(scenario.seed);
    let mut drive = Simulation::new(&scenario, Pilot::Controller, slip, seed).unwrap();
    let result = drive.run(|frame| {
        sum.add(frame);
        true
    });
    sum.add(result);
}

/// The first seconds of many drives.
fn drives(sum: &mut Sum, _: f64) {
    for seed in 0..SHORT_DRIVES {
        let name = SCENARIOS[usize::try_from(seed).unwrap() % SCENARIOS.len()];
        drive(sum, name, Some(seed), SHORT_DRIVE_S);
    }
}

fn scenarios(sum: &mut Sum, seconds: f64) {
    for name in SCENARIOS {
        drive(sum, name, None, seconds);
    }
}

fn estimate(sum: &mut Sum, _: f64) {
    let folder = Path::new("examples/five-wheel");
    let robot = robot::read(&folder.join("robot.toml")).unwrap();
    let map = columns::read(&folder.join("columns.toml")).unwrap();
    let log = Log::find(&[folder.join("log.csv")], map).unwrap();
    let summary = run(&log, &robot, &Options::default(), |row| {
        sum.add(row);
        Ok(())
    });
    sum.add(summary.unwrap());
}
