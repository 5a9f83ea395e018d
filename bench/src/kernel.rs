//! Forces, sinkage and slip curve: lanes against the naive program, in interleaved rounds.

use std::hint::black_box;
use std::time::Instant;

use grouser_terra::{
    Accuracy, BatchColumns, BatchKernel, BatchPoints, Kinematics, RigidWheel, Settings, Slip,
    SolveStatus, WheelOnSoil, entry_angle,
};

use crate::naive::{Naive, Table};
use crate::points::{Points, points};

pub const BATCH: usize = 4096;
const ROUNDS: usize = 41;
const CURVE: usize = 101;

/// Every round's times of one job, piece by piece. A piece is short (a tenth of a millisecond or so), so that
/// its median over the rounds is free of what else the machine does; the job's time is the sum of them.
#[derive(Default)]
struct Timing {
    pieces: Vec<Vec<f64>>,
    sum: f64,
}

impl Timing {
    /// Runs and times a piece; its outputs' sum is one that no compiler may drop.
    fn piece(&mut self, place: usize, job: impl FnOnce() -> f64) {
        let start = Instant::now();
        let sum = black_box(job());
        let time = start.elapsed().as_secs_f64() * 1e9;
        if self.pieces.len() <= place {
            self.pieces.resize_with(place + 1, Vec::new);
        }
        self.pieces[place].push(time);
        self.sum += sum;
    }

    /// The job's time, ns.
    fn time(&mut self) -> f64 {
        self.pieces
            .iter_mut()
            .map(|times| {
                times.sort_by(f64::total_cmp);
                times[times.len() / 2]
            })
            .sum()
    }

    /// The sum of a round's outputs.
    fn check_sum(&self) -> f64 {
        self.sum / ROUNDS as f64
    }
}

fn batch(points: &Points) -> BatchPoints<'_> {
    BatchPoints {
        radius: (&points.radius).into(),
        width: (&points.width).into(),
        rebound: (&points.rebound).into(),
        slip: (&points.slip).into(),
    }
}

/// The columns of a batch.
struct Out {
    sinkage: Vec<f64>,
    vertical_force: Vec<f64>,
    drawbar_pull: Vec<f64>,
    torque: Vec<f64>,
    status: Vec<SolveStatus>,
}

impl Out {
    fn new(n: usize) -> Self {
        let [sinkage, vertical_force, drawbar_pull, torque] = [(); 4].map(|()| vec![0.0; n]);
        let status = vec![SolveStatus::default(); n];
        Self {
            sinkage,
            vertical_force,
            drawbar_pull,
            torque,
            status,
        }
    }

    fn columns(&mut self) -> BatchColumns<'_> {
        BatchColumns {
            sinkage: &mut self.sinkage,
            vertical_force: &mut self.vertical_force,
            drawbar_pull: &mut self.drawbar_pull,
            torque: &mut self.torque,
            status: &mut self.status,
        }
    }

    /// Every point of the bench has an answer.
    fn check(&self) {
        assert!(self.status.iter().all(|s| *s == SolveStatus::Solved));
    }
}

fn naive(points: &Points, i: usize) -> Naive {
    let p = points.soil.params();
    let grouser_terra::Pressure::Bekker(law) = p.pressure else {
        unreachable!("the catalogue's law")
    };
    Naive {
        k_c: law.k_c,
        k_phi: law.k_phi,
        n: p.n,
        cohesion: p.cohesion,
        phi: p.phi.rad(),
        k_shear: p.k_shear,
        c_1: p.c_1,
        c_2: p.c_2,
        radius: points.radius[i],
        width: points.width[i],
    }
}

/// Worst error over max(|W|, |DP|, |T|/r) of forces against the reference mode.
fn worst(sets: &[Points], forces: impl Fn(&Points, usize) -> [f64; 3]) -> f64 {
    let mut worst = 0.0_f64;
    for set in sets {
        for i in 0..set.slip.len() {
            let exact = Settings {
                accuracy: Accuracy::Reference,
                ..Settings::default()
            };
            let wheel = RigidWheel::new(set.radius[i], set.width[i]).expect("a wheel");
            let contact = WheelOnSoil::new(wheel, set.soil, exact).expect("a wheel on its soil");
            let motion = Kinematics::straight(Slip::new(set.slip[i]).expect("a slip"));
            let f = contact.forces_at(set.sinkage[i], &motion).expect("forces");
            let r = set.radius[i];
            let exact = [f.vertical_force, f.drawbar_pull, f.torque / r];
            let [w, pull, torque] = forces(set, i);
            let got = [w, pull, torque / r];
            let size = exact.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            let off = exact
                .iter()
                .zip(got)
                .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            worst = worst.max(off / size);
        }
    }
    worst
}

/// Worst relative error of the entry angle against the reference mode.
fn worst_angle(set: &Points, out: &Out, load: &[f64]) -> f64 {
    out.check();
    let exact = Settings {
        accuracy: Accuracy::Reference,
        ..Settings::default()
    };
    (0..load.len())
        .map(|i| {
            let wheel = RigidWheel::new(set.radius[i], set.width[i]).expect("a wheel");
            let contact = WheelOnSoil::new(wheel, set.soil, exact).expect("a wheel on its soil");
            let motion = Kinematics::straight(Slip::new(set.slip[i]).expect("a slip"));
            let found = contact.sinkage_under(load[i], &motion).expect("a search");
            let angle = |z: f64| entry_angle(z, set.radius[i]);
            let exact = angle(found.sinkage().expect("carried"));
            (angle(out.sinkage[i]) / exact - 1.0).abs()
        })
        .fold(0.0, f64::max)
}

pub fn run(json: bool) {
    let sets = points(BATCH);
    let kernels: Vec<BatchKernel> = sets.iter().map(|set| BatchKernel::new(set.soil)).collect();
    let table = Table::new();
    let mut outs: Vec<Out> = sets.iter().map(|set| Out::new(set.slip.len())).collect();
    // loads: what the sinkages carry
    let loads: Vec<Vec<f64>> = sets
        .iter()
        .zip(&kernels)
        .zip(&mut outs)
        .map(|((set, kernel), out)| {
            kernel
                .forces(&batch(set), &set.sinkage, &mut out.columns())
                .expect("equal lengths");
            out.check();
            out.vertical_force.clone()
        })
        .collect();
    // one curve a soil: the middle of the wheels
    let curves: Vec<Points> = sets
        .iter()
        .map(|set| Points {
            key: set.key,
            soil: set.soil,
            radius: vec![0.2; CURVE],
            width: vec![0.15; CURVE],
            rebound: vec![0.0; CURVE],
            slip: (0..CURVE)
                .map(|i| 0.9 * i as f64 / (CURVE - 1) as f64)
                .collect(),
            sinkage: vec![0.02; CURVE],
        })
        .collect();
    let curve_loads: Vec<Vec<f64>> = curves
        .iter()
        .map(|curve| vec![naive(curve, 0).forces(&table, entry_angle(0.02, 0.2), 0.2)[0]; CURVE])
        .collect();
    let mut curve_out = Out::new(CURVE);

    let mut timings: [Timing; 6] = std::array::from_fn(|_| Timing::default());
    // every sixteenth point for the slow search
    let some: Vec<(usize, usize)> = sets
        .iter()
        .enumerate()
        .flat_map(|(k, set)| (0..set.slip.len()).step_by(16).map(move |i| (k, i)))
        .collect();
    for _ in 0..ROUNDS {
        let [eval, solve, curve, naive_eval, naive_solve, naive_curve] = &mut timings;
        for (place, ((set, kernel), out)) in sets.iter().zip(&kernels).zip(&mut outs).enumerate() {
            eval.piece(place, || {
                kernel
                    .forces(&batch(set), &set.sinkage, &mut out.columns())
                    .expect("equal lengths");
                out.drawbar_pull.iter().sum()
            });
        }
        for (place, ((set, kernel), (out, load))) in sets
            .iter()
            .zip(&kernels)
            .zip(outs.iter_mut().zip(&loads))
            .enumerate()
        {
            solve.piece(place, || {
                kernel
                    .under_load(&batch(set), load, &mut out.columns())
                    .expect("equal lengths");
                out.sinkage.iter().sum()
            });
        }
        for (place, ((set, kernel), load)) in
            curves.iter().zip(&kernels).zip(&curve_loads).enumerate()
        {
            let wheel = RigidWheel::new(set.radius[0], set.width[0]).expect("a wheel");
            curve.piece(place, || {
                kernel
                    .curve(&wheel, load[0], &set.slip, &mut curve_out.columns())
                    .expect("equal lengths");
                curve_out.drawbar_pull.iter().sum()
            });
        }
        let mut place = 0;
        for set in &sets {
            for part in (0..set.slip.len()).collect::<Vec<_>>().chunks(32) {
                naive_eval.piece(place, || {
                    part.iter()
                        .map(|&i| {
                            let theta_1 = (1.0 - set.sinkage[i] / set.radius[i]).acos();
                            naive(set, i).forces(&table, theta_1, set.slip[i])[1]
                        })
                        .sum()
                });
                place += 1;
            }
        }
        for (place, part) in some.chunks(4).enumerate() {
            naive_solve.piece(place, || {
                part.iter()
                    .map(|&(k, i)| {
                        let set = &sets[k];
                        let theta_1 = naive(set, i).solve(&table, loads[k][i], set.slip[i]);
                        set.radius[i] * (1.0 - theta_1.cos())
                    })
                    .sum()
            });
        }
        let (set, load) = (&curves[0], &curve_loads[0]);
        for (place, part) in (0..CURVE).collect::<Vec<_>>().chunks(4).enumerate() {
            naive_curve.piece(place, || {
                part.iter()
                    .map(|&i| {
                        let wheel = naive(set, i);
                        let theta_1 = wheel.solve(&table, load[i], set.slip[i]);
                        wheel.forces(&table, theta_1, set.slip[i])[1]
                    })
                    .sum()
            });
        }
    }
    let checks = timings.each_ref().map(Timing::check_sum);
    let counts = [BATCH, BATCH, curves.len(), BATCH, some.len(), 1];
    let mut times = timings.each_mut().map(Timing::time);
    for (time, count) in times.iter_mut().zip(counts) {
        *time /= count as f64;
    }
    let [eval, solve, curve, naive_eval, naive_solve, naive_curve] = times;
    let lanes_error = worst(&sets, |set, i| {
        let place = sets
            .iter()
            .position(|other| other.key == set.key)
            .expect("one of them");
        let mut out = Out::new(1);
        let one = BatchPoints {
            radius: set.radius[i].into(),
            width: set.width[i].into(),
            rebound: set.rebound[i].into(),
            slip: set.slip[i].into(),
        };
        kernels[place]
            .forces(&one, set.sinkage[i], &mut out.columns())
            .expect("equal lengths");
        out.check();
        [out.vertical_force[0], out.drawbar_pull[0], out.torque[0]]
    });
    let solve_error = sets
        .iter()
        .zip(&kernels)
        .zip(&loads)
        .map(|((set, kernel), load)| {
            let mut out = Out::new(load.len());
            kernel
                .under_load(&batch(set), load, &mut out.columns())
                .expect("equal lengths");
            worst_angle(set, &out, load)
        })
        .fold(0.0_f64, f64::max);
    let naive_error = worst(&sets, |set, i| {
        naive(set, i).forces(
            &table,
            entry_angle(set.sinkage[i], set.radius[i]),
            set.slip[i],
        )
    });
    if json {
        println!(
            "{}",
            serde_json::json!({
                "eval_ns": eval, "solve_ns": solve, "curve_us": curve / 1e3,
                "naive_eval_ns": naive_eval, "naive_solve_ns": naive_solve,
                "naive_curve_us": naive_curve / 1e3,
                "worst_error": lanes_error, "solve_worst_error": solve_error, "naive_worst_error": naive_error,
                "instructions": kernels[0].instructions(), "check_sums": checks,
            })
        );
        return;
    }
    println!(
        "lanes: {}; worst error {lanes_error:.1e}, of a solved angle {solve_error:.1e}, naive {naive_error:.1e}",
        kernels[0].instructions()
    );
    println!(
        "three forces      {eval:9.1} ns   naive {naive_eval:10.1} ns   {:6.0} x",
        naive_eval / eval
    );
    println!(
        "sinkage of a load {solve:9.1} ns   naive {naive_solve:10.1} ns   {:6.0} x",
        naive_solve / solve
    );
    println!(
        "101-point curve   {:9.2} us   naive {:10.1} us   {:6.0} x",
        curve / 1e3,
        naive_curve / 1e3,
        naive_curve / curve
    );
    println!("check sums {checks:?}");
}
