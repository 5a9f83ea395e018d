//! Every path that is not the common one, one point at a time, with its worst error against the reference mode
//! over a hundred sinkages, and the cost of exact derivatives against the value.

use std::hint::black_box;
use std::time::Instant;

use grouser_real::Dual;
use grouser_terra::{
    Accuracy, Angle, BatchColumns, BatchKernel, BatchPoints, BestOf, BestSlipColumns, DualInputs,
    Kinematics, Pressure, RigidWheel, Settings, ShearLaw, Slip, SlopeOutcome, Soil, SoilColumns,
    SoilParams, SolveStatus, WheelOnSoil, WheelSize, catalogue, entry_angle,
};

/// Median time of `job`, ns, over rounds that last long enough to be measured.
fn median_ns(mut job: impl FnMut() -> f64) -> f64 {
    let mut times: Vec<f64> = (0..31)
        .map(|_| {
            let start = Instant::now();
            let mut sum = 0.0;
            for _ in 0..200 {
                sum += job();
            }
            black_box(sum);
            start.elapsed().as_secs_f64() * 1e9 / 200.0
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn sand() -> SoilParams {
    *catalogue::find("dry-sand")
        .expect("in the catalogue")
        .soil()
        .expect("complete")
        .params()
}

/// Name, soil, motion, shear law and sinkage over radius of a path.
fn paths() -> Vec<(&'static str, SoilParams, Kinematics, ShearLaw, f64)> {
    let straight = |slip: f64| Kinematics::straight(Slip::new(slip).expect("a slip"));
    let drifting = |slip: f64, beta: f64| {
        Kinematics::with_slip_angle(Slip::new(slip).expect("a slip"), Angle::from_deg(beta))
            .expect("a drift")
    };
    let coupled = ShearLaw::Coupled;
    vec![
        ("driving", sand(), straight(0.3), coupled, 0.15),
        ("large sinkage", sand(), straight(0.3), coupled, 0.8),
        (
            "rebound",
            SoilParams {
                rebound: 0.5,
                ..sand()
            },
            straight(0.3),
            coupled,
            0.15,
        ),
        (
            "braking, j one-signed",
            sand(),
            straight(-0.6),
            coupled,
            0.15,
        ),
        ("braking, j reverses", sand(), straight(-0.1), coupled, 0.15),
        ("nearly locked", sand(), straight(-0.98), coupled, 0.15),
        (
            "stiff shear",
            SoilParams {
                k_shear: 1e-4,
                ..sand()
            },
            straight(0.3),
            coupled,
            0.15,
        ),
        (
            "slip-sinkage n(s)",
            SoilParams { n_1: 0.5, ..sand() },
            straight(0.3),
            coupled,
            0.15,
        ),
        (
            "slip angle, coupled",
            sand(),
            drifting(0.3, 20.0),
            coupled,
            0.15,
        ),
        (
            "slip angle, independent",
            sand(),
            drifting(0.3, 20.0),
            ShearLaw::Independent,
            0.15,
        ),
        (
            "slip angle, slip velocity",
            sand(),
            drifting(0.3, 20.0),
            ShearLaw::SlipVelocity,
            0.15,
        ),
        (
            "drifting and braking",
            sand(),
            drifting(-0.1, 5.0),
            coupled,
            0.15,
        ),
    ]
}

pub fn run() {
    let wheel = RigidWheel::new(0.15, 0.1).expect("a wheel");
    println!(
        "{:<28}{:>12}{:>14}{:>14}{:>16}{:>14}",
        "path (one point, f64)",
        "forces, ns",
        "solve, ns",
        "worst error",
        "simulation, ns",
        "worst error"
    );
    for (name, params, motion, shear, depth) in paths() {
        let soil = Soil::new(params).expect("a soil");
        let contact = |accuracy| {
            let settings = Settings {
                accuracy,
                shear,
                ..Settings::default()
            };
            WheelOnSoil::new(wheel, soil, settings).expect("a wheel on its soil")
        };
        let (fast, exact) = (contact(Accuracy::Standard), contact(Accuracy::Reference));
        let sinkage = depth * wheel.radius();
        let f = exact.forces_at(sinkage, &motion).expect("forces");
        let quick = contact(Accuracy::Simulation);
        // the error over a hundred sinkages, not at one only
        let error_of = |fast: &WheelOnSoil| {
            (1..=100)
                .map(|k| {
                    let z = sinkage * f64::from(k) / 85.0;
                    let f = exact.forces_at(z, &motion).expect("forces");
                    let g = fast.forces_at(z, &motion).expect("forces");
                    let size = f.vertical_force.abs().max(f.drawbar_pull.abs());
                    (f.vertical_force - g.vertical_force)
                        .abs()
                        .max((f.drawbar_pull - g.drawbar_pull).abs())
                        / size
                })
                .fold(0.0_f64, f64::max)
        };
        let (error, quick_error) = (error_of(&fast), error_of(&quick));
        let forces = median_ns(|| {
            fast.forces_at(black_box(sinkage), &motion)
                .expect("forces")
                .drawbar_pull
        });
        let simulated = median_ns(|| {
            quick
                .forces_at(black_box(sinkage), &motion)
                .expect("forces")
                .drawbar_pull
        });
        let load = f.vertical_force;
        let solve = median_ns(|| {
            fast.sinkage_under(black_box(load), &motion)
                .expect("a search")
                .sinkage()
                .unwrap_or(0.0)
        });
        println!(
            "{name:<28}{forces:>12.0}{solve:>14.0}{error:>14.1e}{simulated:>16.0}{quick_error:>14.1e}"
        );
    }
    derivatives(wheel);
    slip_demands(wheel);
    best_slips(wheel);
    soils(wheel);
}

/// Forces at 4096 sinkages and under 4096 loads: on one soil, on 4096 that share their exponent, on 4096 that share nothing;
/// and what a soil costs whose exponent is new.
fn soils(wheel: RigidWheel) {
    const COUNT: usize = 4096;
    let base = sand();
    let soil = Soil::new(base).expect("a soil");
    let kernel = BatchKernel::new(soil);
    // each number by its own irrational turn
    let spread = |turn: f64, low: f64, high: f64| -> Vec<f64> {
        let at = |i: usize| low + (high - low) * (turn * i as f64).fract();
        (0..COUNT).map(at).collect()
    };
    let slip = spread(0.618_034, 0.0, 0.9);
    let load = spread(0.414_214, 20.0, 150.0);
    let sinkage = spread(0.732_051, 0.003, 0.045);
    let n = spread(0.236_068, 0.9, 1.3);
    let cohesion = spread(0.645_751, 500.0, 2000.0);
    let phi = spread(0.316_625, 0.45, 0.6);
    let k_shear = spread(0.872_983, 0.015, 0.035);
    let k_phi = spread(0.358_899, 1.2e6, 1.8e6);
    let c_1 = spread(0.123_106, 0.15, 0.25);
    let each = SoilColumns {
        n: (&n).into(),
        cohesion: (&cohesion).into(),
        phi: (&phi).into(),
        k_shear: (&k_shear).into(),
        k_phi: (&k_phi).into(),
        c_1: (&c_1).into(),
        ..SoilColumns::from_soil(&soil)
    };
    let one_exponent = SoilColumns {
        n: base.n.into(),
        ..each
    };
    let points = BatchPoints {
        radius: wheel.radius().into(),
        width: wheel.width().into(),
        rebound: 0.0.into(),
        slip: (&slip).into(),
    };
    let mut out = vec![vec![0.0; COUNT]; 4];
    let mut status = vec![SolveStatus::default(); COUNT];
    let mut time = |soils: Option<&SoilColumns<'_>>, by_load: bool| {
        let mut times: Vec<f64> = (0..31)
            .map(|_| {
                let [sinkage_m, vertical_force, drawbar_pull, torque] = &mut out[..] else {
                    unreachable!("four columns");
                };
                let mut columns = BatchColumns {
                    sinkage: sinkage_m,
                    vertical_force,
                    drawbar_pull,
                    torque,
                    status: &mut status,
                };
                let start = Instant::now();
                match (soils, by_load) {
                    (None, true) => kernel.under_load(&points, black_box(&load), &mut columns),
                    (None, false) => kernel.forces(&points, black_box(&sinkage), &mut columns),
                    (Some(soils), true) => {
                        kernel.under_load_on(soils, &points, black_box(&load), &mut columns)
                    }
                    (Some(soils), false) => {
                        kernel.forces_on(soils, &points, black_box(&sinkage), &mut columns)
                    }
                }
                .expect("columns of one length");
                start.elapsed().as_secs_f64() * 1e9 / COUNT as f64
            })
            .collect();
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    };
    for (what, by_load) in [("forces at a sinkage", false), ("sinkage of a load", true)] {
        let one = time(None, by_load);
        let shared = time(Some(&one_exponent), by_load);
        let own = time(Some(&each), by_load);
        println!(
            "{what}: {one:.0} ns on one soil, {shared:.0} ns on soils of one exponent ({:.2} x), {own:.0} ns on soils that share \
             nothing ({:.2} x)",
            shared / one,
            own / one
        );
    }
    let mut exponent = base.n;
    let new = median_ns(|| {
        exponent += 1e-6;
        let soil = Soil::new(SoilParams {
            n: exponent,
            ..base
        });
        soil.expect("a soil").params().n
    });
    println!("a soil of a new exponent: {new:.0} ns");
}

/// The slips that hold 4096 slopes, from the level to a little beyond the steepest that is held: on lanes, and one by one.
fn slip_demands(wheel: RigidWheel) {
    const COUNT: usize = 4096;
    let soil = Soil::new(sand()).expect("a soil");
    let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).expect("a wheel on its soil");
    let weight = 80.0;
    let steepest = on_soil.gradeability(weight).expect("a search");
    let steepest = 1.1 * steepest.expect("it pulls on the level").rad();
    let slope: Vec<f64> = (0..COUNT)
        .map(|i| steepest * (i as f64 + 0.5) / COUNT as f64)
        .collect();
    let kernel = BatchKernel::new(soil);
    let (mut slip, mut status) = (vec![0.0; COUNT], vec![SolveStatus::default(); COUNT]);
    let mut times: Vec<f64> = (0..15)
        .map(|_| {
            let start = Instant::now();
            kernel
                .slip_demand(&wheel, weight, black_box(&slope), &mut slip, &mut status)
                .expect("columns of one length");
            start.elapsed().as_secs_f64() * 1e6 / COUNT as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    let start = Instant::now();
    let mut worst = 0.0_f64;
    let mut differ = 0;
    for i in (0..COUNT).step_by(16) {
        let outcome = on_soil
            .slip_demand(weight, Angle::from_rad(slope[i]))
            .expect("a search");
        match outcome {
            SlopeOutcome::Holds { slip: alone } => {
                worst = worst.max((alone.value() - slip[i]).abs())
            }
            _ => differ += usize::from(status[i] != SolveStatus::NoSolution),
        }
    }
    let alone = start.elapsed().as_secs_f64() * 1e6 / (COUNT / 16) as f64;
    let lanes = times[times.len() / 2];
    println!(
        "slip demand of a slope: {lanes:.1} us on lanes, {alone:.0} us one by one ({:.0} x); slips differ by {worst:.1e}, \
         {differ} outcomes differ",
        alone / lanes
    );
}

/// The slips of greatest pull and efficiency under 4096 loads: on lanes, and one by one.
fn best_slips(wheel: RigidWheel) {
    const COUNT: usize = 4096;
    let soil = Soil::new(sand()).expect("a soil");
    let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).expect("a wheel on its soil");
    let kernel = BatchKernel::new(soil);
    let load: Vec<f64> = (0..COUNT)
        .map(|i| 10.0 + 100.0 * i as f64 / COUNT as f64)
        .collect();
    for (name, of) in [("pull", BestOf::Pull), ("efficiency", BestOf::Efficiency)] {
        let (mut slip, mut value) = (vec![0.0; COUNT], vec![0.0; COUNT]);
        let mut status = vec![SolveStatus::default(); COUNT];
        let mut times: Vec<f64> = (0..15)
            .map(|_| {
                let mut columns = BestSlipColumns {
                    slip: &mut slip,
                    value: &mut value,
                    status: &mut status,
                };
                let start = Instant::now();
                kernel
                    .best_slip(&wheel, of, black_box(&load), &mut columns)
                    .expect("columns of one length");
                start.elapsed().as_secs_f64() * 1e6 / COUNT as f64
            })
            .collect();
        times.sort_by(f64::total_cmp);
        let start = Instant::now();
        let (mut worst, mut differ) = (0.0_f64, 0);
        for i in (0..COUNT).step_by(16) {
            let alone = match of {
                BestOf::Pull => on_soil.slip_of_maximum_pull(load[i]),
                BestOf::Efficiency => on_soil.slip_of_maximum_efficiency(load[i]),
            };
            match alone.expect("a search") {
                Some(alone) => worst = worst.max((alone.value / value[i] - 1.0).abs()),
                None => differ += usize::from(status[i] != SolveStatus::NoSolution),
            }
        }
        let alone = start.elapsed().as_secs_f64() * 1e6 / (COUNT / 16) as f64;
        let lanes = times[times.len() / 2];
        println!(
            "slip of the greatest {name}: {lanes:.1} us on lanes, {alone:.0} us one by one ({:.0} x); values differ by {worst:.1e}, \
             {differ} outcomes differ",
            alone / lanes
        );
    }
}

/// Three forces by nine inputs (r, b, z, s, c, φ, K, k_phi, n) in dual numbers, against the value by the
/// same rule.
fn derivatives(wheel: RigidWheel) {
    let soil = Soil::new(sand()).expect("a soil");
    let contact = WheelOnSoil::new(wheel, soil, Settings::default()).expect("a wheel on its soil");
    let motion = Kinematics::straight(Slip::new(0.3).expect("a slip"));
    let sinkage = 0.15 * wheel.radius();
    let value = {
        let inputs = DualInputs::<0>::new(&contact, &motion);
        median_ns(|| {
            let theta_1 = entry_angle(Dual::constant(black_box(sinkage)), inputs.size.radius);
            inputs.forces(theta_1).drawbar_pull.value
        })
    };
    let jacobian = {
        let mut inputs = DualInputs::<9>::new(&contact, &motion);
        inputs.size = WheelSize::smooth(
            Dual::variable(wheel.radius(), 0),
            Dual::variable(wheel.width(), 1),
        );
        inputs.motion.slip = Dual::variable(0.3, 3);
        inputs.soil.strength.cohesion = Dual::variable(soil.params().cohesion, 4);
        inputs.soil.strength.phi = Dual::variable(soil.params().phi.rad(), 5);
        inputs.soil.k_shear = Dual::variable(soil.params().k_shear, 6);
        if let Pressure::Bekker(law) = &mut inputs.soil.pressure {
            law.k_phi = Dual::variable(law.k_phi.value, 7);
        }
        inputs.soil.exponent.n_0 = Dual::variable(soil.params().n, 8);
        median_ns(|| {
            let z = Dual::<9>::variable(black_box(sinkage), 2);
            let f = inputs.forces(entry_angle(z, inputs.size.radius));
            f.drawbar_pull.gradient.iter().sum::<f64>()
                + f.torque.gradient[8]
                + f.vertical_force.gradient[0]
        })
    };
    println!(
        "Jacobian 3 x 9: {jacobian:.0} ns, {:.1} x the value by the same rule ({value:.0} ns)",
        jacobian / value
    );
}
