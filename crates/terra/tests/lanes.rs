//! Lanes against the general kernel at fixed random points, few enough for a test to take a tenth of a second: `batches` and
//! `soil_columns` have the same by thousands.

use grouser_real::Real;
use grouser_terra::{
    Accuracy, Angle, BatchColumns, BatchInput, BatchKernel, BatchPoints, Bekker, BestOf,
    BestSlipColumns, Caution, Forces, Kinematics, Lanes, LawChoice, Pressure, Reece, RigidWheel,
    Settings, Slip, SlipNorm, SlopeOutcome, Soil, SoilColumns, SoilParams, SolveStatus,
    StressPosition, WheelOnSoil, catalogue,
};

use super::batches::{Solved, batch, done};
use super::simulation_accuracy::Random;

/// A soil of either law of pressure: every rule of the ladder is required by some wheel on it.
fn soil(random: &mut Random, is_reece: bool, stress_position: StressPosition) -> Soil {
    let pressure = if is_reece {
        Pressure::Reece(Reece {
            k_c_prime: random.between(0.0, 50.0),
            k_phi_prime: random.log(20.0, 2000.0),
        })
    } else {
        Pressure::Bekker(Bekker {
            k_c: random.between(-500.0, 2e4),
            k_phi: random.log(1e5, 3e6),
        })
    };
    Soil::new(SoilParams {
        pressure,
        n: random.between(0.1, 2.8),
        cohesion: if random.next() < 0.4 {
            0.0
        } else {
            random.log(10.0, 2e4)
        },
        phi: Angle::from_rad(random.between(0.0, 0.8)),
        k_shear: random.log(5e-4, 0.1),
        c_1: random.between(-0.1, 0.7),
        c_2: random.between(-0.3, 0.5),
        unit_weight: Some(16e3),
        laws: LawChoice {
            stress_position,
            slip_norm: if random.next() < 0.5 {
                SlipNorm::Greater
            } else {
                SlipNorm::Root
            },
            ..LawChoice::default()
        },
        ..*catalogue::find("dry-sand")
            .unwrap()
            .soil()
            .unwrap()
            .params()
    })
    .unwrap()
}

/// Wheels, rebound ratios, slips and sinkages, some of which no lane serves.
struct Points {
    radius: Vec<f64>,
    width: Vec<f64>,
    rebound: Vec<f64>,
    slip: Vec<f64>,
    sinkage: Vec<f64>,
}

impl Points {
    fn new(random: &mut Random, n: usize) -> Self {
        let mut points = Self {
            radius: vec![],
            width: vec![],
            rebound: vec![],
            slip: vec![],
            sinkage: vec![],
        };
        for _ in 0..n {
            let radius = random.log(0.02, 0.6);
            points.radius.push(radius);
            points.width.push(random.log(0.02, 0.5));
            let rebound = if random.next() < 0.7 {
                0.0
            } else {
                random.between(0.0, 1.0)
            };
            points.rebound.push(rebound);
            points.slip.push(match random.next() {
                ..0.1 => random.between(-0.9, 0.0),
                ..0.2 => 0.0,
                ..0.25 => 1.0,
                _ => random.next(),
            });
            points.sinkage.push(radius * random.log(3e-4, 0.6));
        }
        points
    }

    fn inputs(&self) -> BatchPoints<'_> {
        BatchPoints {
            radius: (&self.radius).into(),
            width: (&self.width).into(),
            rebound: (&self.rebound).into(),
            slip: (&self.slip).into(),
        }
    }

    fn reference(&self, soil: &Soil, i: usize) -> (WheelOnSoil, Kinematics) {
        let wheel = RigidWheel::new(self.radius[i], self.width[i]).unwrap();
        let settings = Settings {
            accuracy: Accuracy::Reference,
            ..Settings::default()
        };
        let soil = soil.with_rebound(self.rebound[i]).unwrap();
        let motion = Kinematics::straight(Slip::new(self.slip[i]).unwrap());
        (WheelOnSoil::new(wheel, soil, settings).unwrap(), motion)
    }

    fn assert_forces(&self, soil: &Soil, i: usize, found: &Solved, expected: &Forces) {
        let per_radius = 1.0 / self.radius[i];
        let size = expected
            .vertical_force
            .abs()
            .max(expected.drawbar_pull.abs());
        let size = size.max(expected.torque.abs() * per_radius);
        for off in [
            found.vertical_force - expected.vertical_force,
            found.drawbar_pull - expected.drawbar_pull,
            (found.torque - expected.torque) * per_radius,
        ] {
            assert!(
                off.abs() <= 1e-9 * size,
                "{:e} at {i} on {soil:?}: {found:?}",
                off / size
            );
        }
    }

    /// Loads that the points carry at their sinkages come back as the general search has it.
    fn assert_loads(&self, soils: &[Soil], loads: &[f64], solved: &[Solved]) {
        for (i, (found, &load)) in solved.iter().zip(loads).enumerate() {
            let soil = &soils[i % soils.len()];
            let (on_soil, motion) = self.reference(soil, i);
            let general = on_soil.under_load(load, &motion).unwrap();
            let Some(point) = general.point() else {
                assert_eq!(found.status, general.outcome.status());
                continue;
            };
            let found = done(found);
            assert!(
                (found.sinkage / point.sinkage - 1.0).abs() < 1e-8,
                "{found:?} {point:?}"
            );
            assert!((found.vertical_force / load - 1.0).abs() < 1e-9);
            let size = load.max(point.forces.drawbar_pull.abs());
            let size = size.max(point.forces.torque.abs() / self.radius[i]);
            let off = (found.drawbar_pull - point.forces.drawbar_pull).abs();
            let off_torque = (found.torque - point.forces.torque).abs() / self.radius[i];
            assert!(
                off.max(off_torque) < 3e-9 * size,
                "{i}: {found:?} {point:?} {soil:?}"
            );
        }
    }
}

fn loads_of(forces: &[Solved]) -> Vec<f64> {
    let load = |solved: &Solved| done(solved).vertical_force.abs().max(1e-3);
    forces.iter().map(load).collect()
}

fn kernels(soil: &Soil) -> [BatchKernel; 2] {
    [BatchKernel::new(*soil), BatchKernel::new(*soil).portable()]
}

#[test]
fn forces_and_loads_on_one_soil() {
    let mut random = Random(3);
    for round in 0..12 {
        let position = StressPosition::ALL[round % StressPosition::ALL.len()];
        let soil = soil(&mut random, round % 3 == 0, position);
        let points = Points::new(&mut random, 20 + round);
        let n = points.slip.len();
        for kernel in kernels(&soil) {
            let forces = batch(n, |out| {
                kernel.forces(&points.inputs(), &points.sinkage, out)
            });
            for (i, found) in forces.iter().enumerate() {
                let (on_soil, motion) = points.reference(&soil, i);
                let expected = on_soil.forces_at(points.sinkage[i], &motion).unwrap();
                points.assert_forces(&soil, i, &done(found), &expected);
            }
            if round < 6 {
                let loads = loads_of(&forces);
                let solved = batch(n, |out| kernel.under_load(&points.inputs(), &loads, out));
                points.assert_loads(&[soil], &loads, &solved);
            }
        }
    }
}

/// A soil for each point, with the laws of the first; one exponent for all in every other round.
#[test]
fn forces_and_loads_on_a_soil_for_each_point() {
    let mut random = Random(4);
    for round in 0..8 {
        let is_reece = round % 3 == 0;
        let position = StressPosition::ALL[round % StressPosition::ALL.len()];
        let base = soil(&mut random, is_reece, position);
        let points = Points::new(&mut random, 18 + round);
        let n = points.slip.len();
        let soils: Vec<Soil> = (0..n)
            .map(|_| {
                let drawn = *soil(&mut random, is_reece, position).params();
                let exponent = if round % 2 == 0 {
                    base.params().n
                } else {
                    drawn.n
                };
                Soil::new(SoilParams {
                    n: exponent,
                    laws: base.params().laws,
                    ..drawn
                })
                .unwrap()
            })
            .collect();
        let column = |of: &dyn Fn(&SoilParams) -> f64| -> Vec<f64> {
            soils.iter().map(|soil| of(soil.params())).collect()
        };
        let moduli = |params: &SoilParams| match params.pressure {
            Pressure::Bekker(law) => (law.k_c, law.k_phi),
            Pressure::Reece(law) => (law.k_c_prime, law.k_phi_prime),
        };
        let columns = [
            column(&|params| moduli(params).0),
            column(&|params| moduli(params).1),
            column(&|params| params.n),
            column(&|params| params.cohesion),
            column(&|params| params.phi.rad()),
            column(&|params| params.k_shear),
            column(&|params| params.c_1),
            column(&|params| params.c_2),
        ];
        let [k_c, k_phi, exponent, cohesion, phi, k_shear, c_1, c_2] =
            columns.each_ref().map(|column| BatchInput::Column(column));
        let given = SoilColumns {
            k_c,
            k_phi,
            n: if round % 2 == 0 {
                base.params().n.into()
            } else {
                exponent
            },
            cohesion,
            phi,
            k_shear,
            c_1,
            c_2,
        };
        for kernel in kernels(&base) {
            let inputs = points.inputs();
            let forces = batch(n, |out| {
                kernel.forces_on(&given, &inputs, &points.sinkage, out)
            });
            for (i, found) in forces.iter().enumerate() {
                let (on_soil, motion) = points.reference(&soils[i], i);
                let expected = on_soil.forces_at(points.sinkage[i], &motion).unwrap();
                points.assert_forces(&soils[i], i, &done(found), &expected);
            }
            if round < 4 {
                let loads = loads_of(&forces);
                let solved = batch(n, |out| kernel.under_load_on(&given, &inputs, &loads, out));
                points.assert_loads(&soils, &loads, &solved);
            }
        }
    }
}

/// Points of a batch that lanes serve are solved by them: their last digits differ from those of the general kernel somewhere.
#[test]
fn lanes_are_used_where_they_serve() {
    let soil = catalogue::find("sandy-loam").unwrap().soil().unwrap();
    let kernel = BatchKernel::new(soil);
    let wheel = RigidWheel::new(0.1, 0.05).unwrap();
    let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
    let apart = |slip: f64, sinkage: f64, rebound: f64| {
        let points = BatchPoints {
            radius: 0.1.into(),
            width: 0.05.into(),
            rebound: rebound.into(),
            slip: slip.into(),
        };
        let lanes = done(&batch(1, |out| kernel.forces(&points, sinkage, out))[0]);
        let motion = Kinematics::straight(Slip::new(slip).unwrap());
        let soil = soil.with_rebound(rebound).unwrap();
        let alone = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        let forces = alone.forces_at(sinkage, &motion).unwrap();
        lanes.vertical_force.to_bits() != forces.vertical_force.to_bits()
            || lanes.torque.to_bits() != forces.torque.to_bits()
    };
    let slips = || (0..8).map(|i| 0.1 * f64::from(i));
    // at the ends of what lanes serve, slips and sinkages over the radius
    for (share, expected) in [
        (4.6e-4, true),
        (4.4e-4, false),
        (0.499, true),
        (0.501, false),
    ] {
        assert_eq!(
            slips().any(|slip| apart(slip, 0.1 * share, 0.0)),
            expected,
            "{share}"
        );
    }
    assert!(slips().any(|slip| apart(slip, 0.01, 0.3)));
    assert!(!slips().any(|slip| apart(slip, 0.02, 2.6)));
    assert!(!apart(-1e-9, 0.01, 0.0) && !apart(-0.5, 0.01, 0.0));
    // under a load
    let slip: Vec<f64> = (0..100).map(|i| 0.009 * f64::from(i)).collect();
    let points = BatchPoints {
        radius: 0.1.into(),
        width: 0.05.into(),
        rebound: 0.0.into(),
        slip: (&slip).into(),
    };
    let lanes = batch(100, |out| kernel.under_load(&points, 60.0, out));
    let mut from_alone = 0;
    for (i, &slip) in slip.iter().enumerate() {
        let motion = Kinematics::straight(Slip::new(slip).unwrap());
        let alone = on_soil
            .sinkage_under(60.0, &motion)
            .unwrap()
            .sinkage()
            .unwrap();
        from_alone += u32::from(lanes[i].sinkage.to_bits() != alone.to_bits());
    }
    assert!(from_alone > 50, "{from_alone}");
}

/// Demands of slopes, best slips and skids of a few wheels are those of the single searches.
#[test]
fn searches_over_slip_of_a_few_wheels() {
    let mut random = Random(5);
    for (round, key) in ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"]
        .iter()
        .enumerate()
    {
        let soil = catalogue::find(key).unwrap().soil().unwrap();
        let (radius, width) = (random.log(0.05, 0.4), random.log(0.04, 0.3));
        let wheel = RigidWheel::new(radius, width).unwrap();
        let kernel = BatchKernel::new(soil);
        let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        let n = 6 + round;
        let load: Vec<f64> = (0..n)
            .map(|_| radius * width * random.log(500.0, 5e4))
            .collect();
        let slope: Vec<f64> = (0..n).map(|_| random.between(-0.1, 0.5)).collect();
        let (mut slip, mut value) = (vec![0.0; n], vec![0.0; n]);
        let mut status = vec![SolveStatus::default(); n];
        kernel
            .slip_demand(&wheel, &load, &slope, &mut slip, &mut status)
            .unwrap();
        for i in 0..n {
            match on_soil
                .slip_demand(load[i], Angle::from_rad(slope[i]))
                .unwrap()
            {
                SlopeOutcome::Holds { slip: alone } => {
                    assert_eq!(status[i], SolveStatus::Solved, "{key} {i}");
                    assert!(
                        (slip[i] - alone.value()).abs() < 1e-8,
                        "{key} {i}: {} {alone:?}",
                        slip[i]
                    );
                }
                _ => assert!(
                    status[i] == SolveStatus::NoSolution && slip[i].is_nan(),
                    "{key} {i}"
                ),
            }
        }
        for of in [BestOf::Pull, BestOf::Efficiency] {
            let mut columns = BestSlipColumns {
                slip: &mut slip,
                value: &mut value,
                status: &mut status,
            };
            kernel.best_slip(&wheel, of, &load, &mut columns).unwrap();
            for i in (0..n).step_by(3) {
                let (alone, size) = match of {
                    BestOf::Pull => (on_soil.slip_of_maximum_pull(load[i]).unwrap(), load[i]),
                    BestOf::Efficiency => {
                        (on_soil.slip_of_maximum_efficiency(load[i]).unwrap(), 1.0)
                    }
                };
                if let Some(alone) = alone {
                    assert_eq!(status[i], SolveStatus::Solved, "{key} {i}");
                    assert!(
                        (value[i] - alone.value).abs() < 1e-9 * size,
                        "{key} {i} {alone:?}"
                    );
                    assert!(
                        (slip[i] - alone.slip.value()).abs() < 1e-4,
                        "{key} {i} {alone:?}"
                    );
                } else {
                    assert!(
                        status[i] == SolveStatus::NoSolution && slip[i].is_nan(),
                        "{key} {i}"
                    );
                }
            }
        }
    }
}

/// More searches than run at a time end each at its own place.
#[test]
fn a_hundred_searches_at_a_time() {
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let wheel = RigidWheel::new(0.1, 0.05).unwrap();
    let kernel = BatchKernel::new(soil);
    let slope: Vec<f64> = (0..150)
        .map(|i| [0.02, 0.04, -0.02, 0.9, 0.06][i % 5])
        .collect();
    let (mut slip, mut status) = ([0.0; 150], [SolveStatus::default(); 150]);
    kernel
        .slip_demand(&wheel, 30.0, &slope, &mut slip, &mut status)
        .unwrap();
    for i in 5..150 {
        assert_eq!(slip[i].to_bits(), slip[i % 5].to_bits());
        assert_eq!(status[i], status[i % 5]);
    }
    assert!(slip[2] < slip[0] && slip[0] < slip[1] && slip[1] < slip[4]);
    assert_eq!(status[3], SolveStatus::NoSolution);
}

/// Every operation of eight numbers is that of each of them.
#[test]
fn eight_numbers_compute_as_one_does() {
    const A: [f64; 8] = [0.5, -1.5, 2.0, -0.25, 3.0, 0.0, 1.0, 7.5];
    const B: [f64; 8] = [0.75, 2.5, 2.0, -4.0, -0.5, 1.0, -1.0, 0.125];
    const C: [f64; 8] = [1.0, -2.0, 0.5, 8.0, 0.0, -3.0, 4.0, 0.25];
    let (a, b, c) = (Lanes(A), Lanes(B), Lanes(C));
    let two = |f: fn(f64, f64) -> f64| -> [f64; 8] { std::array::from_fn(|i| f(A[i], B[i])) };
    let one = |f: fn(f64) -> f64| A.map(f);
    assert_eq!((a + b).0, two(|a, b| a + b));
    assert_eq!((a - b).0, two(|a, b| a - b));
    assert_eq!((a * b).0, two(|a, b| a * b));
    assert_eq!((a / b).0, two(|a, b| a / b));
    assert_eq!((-a).0, one(|a| -a));
    let (mut sum, mut difference, mut product) = (a, a, a);
    sum += b;
    difference -= b;
    product *= b;
    assert_eq!([sum, difference, product], [a + b, a - b, a * b]);
    assert_eq!(
        a.mul_add(b, c).0,
        std::array::from_fn(|i| A[i] * B[i] + C[i])
    );
    assert_eq!(a.abs().0, one(f64::abs));
    assert_eq!(a.powi(3).0, one(|a| a.powi(3)));
    assert_eq!(a.atan2(b).0, two(Real::atan2));
    let near = |found: Lanes, expected: [f64; 8]| {
        for (found, expected) in found.0.iter().zip(expected) {
            assert!(
                (found - expected).abs() <= 2e-15 * expected.abs().max(1.0),
                "{found} {expected}"
            );
        }
    };
    near(a.abs().sqrt(), one(|a| a.abs().sqrt()));
    near(
        b.abs().powf(c),
        std::array::from_fn(|i| B[i].abs().powf(C[i])),
    );
    near(a.tan(), one(f64::tan));
    near(a.atan(), one(f64::atan));
    near(a.tanh(), one(f64::tanh));
    near(a.sin(), one(f64::sin));
    near(a.cos(), one(f64::cos));
    // with many half turns, and with too many for the lanes, where each number is taken by itself
    for turned in [A.map(|a| 1000.0 * a), A.map(|a| 1e5 * a)] {
        near(Lanes(turned).sin(), turned.map(f64::sin));
        near(Lanes(turned).cos(), turned.map(f64::cos));
    }
    // masks: less, not greater, and their combinations, with an equal pair at place 2
    let (less, not_greater) = (a.lt(b), a.le(b));
    assert_eq!(less.0, std::array::from_fn(|i| A[i] < B[i]));
    assert_eq!(not_greater.0, std::array::from_fn(|i| A[i] <= B[i]));
    assert_ne!(less, not_greater);
    let other = b.lt(c);
    assert_eq!(
        (less & other).0,
        std::array::from_fn(|i| A[i] < B[i] && B[i] < C[i])
    );
    assert_eq!(
        (less | other).0,
        std::array::from_fn(|i| A[i] < B[i] || B[i] < C[i])
    );
    assert_eq!((!less).0, std::array::from_fn(|i| A[i] >= B[i]));
    assert_eq!(Lanes::select(less, a, b).0, two(f64::min));
}

#[test]
fn instructions_have_a_name() {
    let kernel = BatchKernel::new(catalogue::find("lunar").unwrap().soil().unwrap());
    assert!(["avx512", "avx2", "portable"].contains(&kernel.instructions()));
    assert_eq!(kernel.clone().portable().instructions(), "portable");
    let of_machine = grouser_terra::instructions();
    assert!([kernel.instructions(), "deterministic"].contains(&of_machine));
}

/// Soil that rises behind the wheel by more than it sank pushes it on.
#[test]
fn work_that_soil_gives_back_is_cautioned_of() {
    const RADIUS_M: f64 = 0.1;
    const SINKAGE_M: f64 = 0.02;
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let kernel = BatchKernel::new(soil);
    let wheel = RigidWheel::new(RADIUS_M, 0.05).unwrap();
    let gained = [
        (0.0, 2.0),
        (0.02, 1.6),
        (0.3, 0.0),
        (-0.05, 0.0),
        (-0.05, 2.0),
    ]
    .map(|(slip, rebound)| {
        let points = BatchPoints {
            radius: RADIUS_M.into(),
            width: 0.05.into(),
            rebound: rebound.into(),
            slip: slip.into(),
        };
        let [
            mut sinkage,
            mut vertical_force,
            mut drawbar_pull,
            mut torque,
        ] = [[0.0]; 4];
        let mut out = BatchColumns {
            sinkage: &mut sinkage,
            vertical_force: &mut vertical_force,
            drawbar_pull: &mut drawbar_pull,
            torque: &mut torque,
            status: &mut [SolveStatus::default()],
        };
        kernel.forces(&points, SINKAGE_M, &mut out).unwrap();
        let found = kernel.cautions(&points, &out, 0);
        let soil = soil.with_rebound(rebound).unwrap();
        let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        let motion = Kinematics::straight(Slip::new(slip).unwrap());
        let alone = on_soil.at_sinkage(SINKAGE_M, &motion).unwrap();
        assert_eq!(found, alone.cautions, "{slip} {rebound}");
        found.contains(Caution::WorkGained)
    });
    assert!(gained[0] && !gained[2]);
}
