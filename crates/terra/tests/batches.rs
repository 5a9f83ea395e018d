//! Lanes against one at a time, and a lane against its neighbours (faults D13 and D14).

use grouser_terra::{
    Accuracy, Angle, BatchColumns, BatchInput, BatchKernel, BatchPoints, BestOf, BestSlipColumns,
    Cautions, Error, FittedRange, Kinematics, LawChoice, RigidWheel, Settings, ShearLaw, Slip,
    SlipNorm, SlopeOutcome, Soil, SoilParams, SolveStatus, StressPosition, WheelOnSoil, catalogue,
};
use proptest::prelude::*;

/// radius, width, rebound, slip, sinkage over radius
pub(super) type Point = (f64, f64, f64, f64, f64);

pub(super) fn point() -> impl Strategy<Value = Point> {
    let slip = prop_oneof![8 => 0.0..=1.0_f64, 1 => -1.0..0.0_f64, 1 => Just(0.0)];
    let rebound = prop_oneof![4 => Just(0.0), 1 => 0.0..1.0_f64];
    let z = prop_oneof![9 => (-3.3..-0.302_f64).prop_map(|x| 10_f64.powf(x)), 1 => 0.0..0.99_f64];
    (0.02..0.6_f64, 0.02..0.5_f64, rebound, slip, z)
}

/// Laws of which some change a wheel that drives straight ahead.
fn laws() -> impl Strategy<Value = LawChoice> {
    let shear = [
        ShearLaw::Coupled,
        ShearLaw::SlipVelocity,
        ShearLaw::SlipVelocityRegular,
        ShearLaw::Independent,
    ];
    let any = (
        prop::sample::select(&StressPosition::ALL),
        prop::sample::select(&[SlipNorm::Greater, SlipNorm::Root]),
        prop::option::of(prop::sample::select(shear.to_vec())),
    );
    let any = any.prop_map(|(stress_position, slip_norm, shear)| LawChoice {
        stress_position,
        slip_norm,
        shear,
        ..LawChoice::default()
    });
    prop_oneof![2 => Just(LawChoice::default()), 1 => any]
}

pub(super) fn soil() -> impl Strategy<Value = Soil> {
    (
        0..5_usize,
        0.1..2.5_f64,
        -3.5..-1.0_f64,
        prop_oneof![Just(0.0), 0.0..2e4_f64],
        laws(),
    )
        .prop_map(|(key, n, log_k, cohesion, laws)| {
            let key = ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"][key];
            let params = *catalogue::find(key).unwrap().soil().unwrap().params();
            Soil::new(SoilParams {
                n,
                k_shear: 10_f64.powf(log_k),
                cohesion,
                laws,
                ..params
            })
            .unwrap()
        })
}

/// One point of a batch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solved {
    pub(super) status: SolveStatus,
    pub(super) sinkage: f64,
    pub(super) vertical_force: f64,
    pub(super) drawbar_pull: f64,
    pub(super) torque: f64,
}

/// The points of a batch of `n` that `solve` writes.
pub(super) fn batch(
    n: usize,
    solve: impl FnOnce(&mut BatchColumns<'_>) -> Result<(), Error>,
) -> Vec<Solved> {
    let [
        mut sinkage,
        mut vertical_force,
        mut drawbar_pull,
        mut torque,
    ] = [(); 4].map(|()| vec![f64::NAN; n]);
    // whatever stood there before is written anew
    let mut status = vec![SolveStatus::Solved; n];
    solve(&mut BatchColumns {
        sinkage: &mut sinkage,
        vertical_force: &mut vertical_force,
        drawbar_pull: &mut drawbar_pull,
        torque: &mut torque,
        status: &mut status,
    })
    .unwrap();
    (0..n)
        .map(|i| Solved {
            status: status[i],
            sinkage: sinkage[i],
            vertical_force: vertical_force[i],
            drawbar_pull: drawbar_pull[i],
            torque: torque[i],
        })
        .collect()
}

pub(super) struct Columns {
    radius: Vec<f64>,
    width: Vec<f64>,
    rebound: Vec<f64>,
    pub(super) slip: Vec<f64>,
    pub(super) sinkage: Vec<f64>,
}

impl Columns {
    pub(super) fn new(points: &[Point]) -> Self {
        Self {
            radius: points.iter().map(|p| p.0).collect(),
            width: points.iter().map(|p| p.1).collect(),
            rebound: points.iter().map(|p| p.2).collect(),
            slip: points.iter().map(|p| p.3).collect(),
            sinkage: points.iter().map(|p| p.4 * p.0).collect(),
        }
    }
    pub(super) fn points(&self) -> BatchPoints<'_> {
        BatchPoints {
            radius: (&self.radius).into(),
            width: (&self.width).into(),
            rebound: (&self.rebound).into(),
            slip: (&self.slip).into(),
        }
    }
    fn forces(&self, kernel: &BatchKernel) -> Vec<Solved> {
        batch(self.slip.len(), |out| {
            kernel.forces(&self.points(), &self.sinkage, out)
        })
    }
    fn cautions(&self, kernel: &BatchKernel) -> Vec<Cautions> {
        let n = self.slip.len();
        let [
            mut sinkage,
            mut vertical_force,
            mut drawbar_pull,
            mut torque,
        ] = [(); 4].map(|()| vec![f64::NAN; n]);
        let mut out = BatchColumns {
            sinkage: &mut sinkage,
            vertical_force: &mut vertical_force,
            drawbar_pull: &mut drawbar_pull,
            torque: &mut torque,
            status: &mut vec![SolveStatus::default(); n],
        };
        let points = self.points();
        kernel.forces(&points, &self.sinkage, &mut out).unwrap();
        (0..n)
            .map(|at| kernel.cautions(&points, &out, at))
            .collect()
    }
    fn under_load(&self, kernel: &BatchKernel, load: &[f64]) -> Vec<Solved> {
        batch(self.slip.len(), |out| {
            kernel.under_load(&self.points(), load, out)
        })
    }
}

pub(super) fn done(solved: &Solved) -> Solved {
    assert_eq!(solved.status, SolveStatus::Solved, "{solved:?}");
    *solved
}

pub(super) fn contact(soil: &Soil, p: Point) -> WheelOnSoil {
    let exact = Settings {
        accuracy: Accuracy::Reference,
        ..Settings::default()
    };
    let soil = soil.with_rebound(p.2).unwrap();
    WheelOnSoil::new(RigidWheel::new(p.0, p.1).unwrap(), soil, exact).unwrap()
}

/// The soil behind a wheel that springs back changes what is to be kept in mind: of a driving wheel, and of a braking one.
#[test]
fn rebound_counts_in_cautions() {
    let (mut driving, mut braking) = (0, 0);
    for key in ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"] {
        let soil = catalogue::find(key).unwrap().soil().unwrap();
        let points: Vec<Point> = [-0.5, -0.2, -0.05, -0.01, 0.01, 0.05, 0.2, 0.5]
            .into_iter()
            .flat_map(|slip| [0.2, 1.0, 4.0].map(|rebound| (slip, rebound)))
            .flat_map(|(slip, rebound)| [0.01, 0.1].map(|z| (0.1, 0.1, rebound, slip, z)))
            .collect();
        let columns = Columns::new(&points);
        let found = columns.cautions(&BatchKernel::new(soil));
        for ((at, p), found) in points.iter().enumerate().zip(found) {
            let motion = Kinematics::straight(Slip::new(p.3).unwrap());
            let single = |rebound: f64| {
                let contact = contact(&soil, (p.0, p.1, rebound, p.3, p.4));
                let point = contact.at_sinkage(columns.sinkage[at], &motion);
                point.unwrap().cautions
            };
            assert_eq!(found, single(p.2), "{key} {p:?}");
            let count = if p.3 > 0.0 {
                &mut driving
            } else {
                &mut braking
            };
            *count += usize::from(found != single(0.0));
        }
    }
    println!("{driving} driving and {braking} braking wheels by their rebound");
    assert!(driving > 0 && braking > 0, "{driving} {braking}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn lanes_are_good_to_1e_9(soil in soil(), points in prop::collection::vec(point(), 1..40)) {
        let columns = Columns::new(&points);
        for kernel in [BatchKernel::new(soil), BatchKernel::new(soil).portable()] {
            for (p, outcome) in points.iter().zip(columns.forces(&kernel)) {
                let motion = Kinematics::straight(Slip::new(p.3).unwrap());
                let f = contact(&soil, *p).forces_at(p.4 * p.0, &motion).unwrap();
                let got = done(&outcome);
                let size = f.vertical_force.abs().max(f.drawbar_pull.abs()).max(f.torque.abs() / p.0);
                let off = (f.vertical_force - got.vertical_force).abs()
                    .max((f.drawbar_pull - got.drawbar_pull).abs())
                    .max((f.torque - got.torque).abs() / p.0);
                prop_assert!(off <= 1e-9 * size, "{:e} at {:?}", off / size, p);
            }
        }
    }

    /// Cautions from the numbers of lanes are those of the general kernel.
    #[test]
    fn cautions_are_those_of_single_points(
        soil in soil(),
        (c_1, c_2) in (-0.2..0.9_f64, -0.5..0.9_f64),
        points in prop::collection::vec(point(), 1..40),
    ) {
        let fitted = FittedRange {
            slip: (-0.2, 0.6),
            slip_angle: (0.0, 0.0),
            width: (0.1, 0.4),
            load: (0.0, 1e4),
        };
        let soil = Soil::new(SoilParams { c_1, c_2, fitted: Some(fitted), ..*soil.params() }).unwrap();
        let columns = Columns::new(&points);
        let found = columns.cautions(&BatchKernel::new(soil));
        for ((at, p), found) in points.iter().enumerate().zip(found) {
            let motion = Kinematics::straight(Slip::new(p.3).unwrap());
            let single = contact(&soil, *p).at_sinkage(columns.sinkage[at], &motion).unwrap();
            prop_assert_eq!(found, single.cautions, "{:?}", p);
        }
    }

    #[test]
    fn loads_come_back(soil in soil(), points in prop::collection::vec(point(), 1..40)) {
        let columns = Columns::new(&points);
        let kernel = BatchKernel::new(soil);
        let load: Vec<f64> =
            columns.forces(&kernel).iter().map(|f| done(f).vertical_force.abs().max(1e-3)).collect();
        for ((p, load), outcome) in points.iter().zip(&load).zip(columns.under_load(&kernel, &load)) {
            let got = outcome;
            if got.status == SolveStatus::Solved {
                prop_assert!((got.vertical_force / load - 1.0).abs() < 2e-9);
                let motion = Kinematics::straight(Slip::new(p.3).unwrap());
                let exact = contact(&soil, *p).sinkage_under(*load, &motion).unwrap();
                let exact = exact.sinkage().unwrap();
                prop_assert!((got.sinkage / exact - 1.0).abs() < 1e-8, "{} {exact}", got.sinkage);
            } else {
                prop_assert!(p.4 > 0.9 || p.2 > 0.0 || p.3 < 0.0, "{outcome:?} at {p:?}");
            }
        }
    }

    #[test]
    fn a_lane_gives_the_same_bits_in_any_company(
        soil in soil(),
        points in prop::collection::vec(point(), 1..30),
        bad in prop::collection::vec(0..30_usize, 0..4),
    ) {
        let kernel = BatchKernel::new(soil);
        let mut columns = Columns::new(&points);
        for &i in &bad {
            if i < points.len() {
                columns.slip[i] = [f64::NAN, 7.0, f64::INFINITY, -2.0][i % 4];
            }
        }
        let together = columns.forces(&kernel);
        let loads: Vec<f64> = together.iter().map(|f| f.vertical_force.abs() + 0.1).collect();
        let solved = columns.under_load(&kernel, &loads);
        for i in 0..points.len() {
            let alone = Columns {
                radius: vec![columns.radius[i]],
                width: vec![columns.width[i]],
                rebound: vec![columns.rebound[i]],
                slip: vec![columns.slip[i]],
                sinkage: vec![columns.sinkage[i]],
            };
            let is_bad = bad.contains(&i);
            prop_assert_eq!(together[i].status == SolveStatus::BadInput, is_bad);
            // by their text, so that a NaN equals itself
            prop_assert_eq!(format!("{:?}", &alone.forces(&kernel)[0]), format!("{:?}", &together[i]));
            prop_assert_eq!(
                format!("{:?}", &alone.under_load(&kernel, &loads[i..=i])[0]),
                format!("{:?}", &solved[i])
            );
        }
    }
}

#[test]
fn batches_of_every_small_length() {
    let soil = catalogue::find("lunar").unwrap().soil().unwrap();
    let kernel = BatchKernel::new(soil);
    for n in [0, 1, 3, 5, 7, 8, 9, 255, 256, 257, 1000] {
        let points: Vec<Point> = (0..n)
            .map(|i| (0.1, 0.05, 0.0, f64::from(i) / 1000.0, 0.1))
            .collect();
        let out = Columns::new(&points).forces(&kernel);
        assert_eq!(out.len(), points.len());
        assert!(out.iter().all(|f| done(f).vertical_force > 0.0));
    }
    // all but one lane bad
    let mut columns = Columns::new(&[(0.1, 0.05, 0.0, 0.3, 0.1); 8]);
    for (i, radius) in columns.radius.iter_mut().enumerate() {
        if i != 5 {
            *radius = [0.0, -1.0, f64::NAN, 1e300, f64::INFINITY, 0.0, 5e-324, -0.0][i];
        }
    }
    for (i, outcome) in columns.forces(&kernel).iter().enumerate() {
        assert_eq!(
            outcome.status == SolveStatus::Solved,
            i == 5,
            "{i}: {outcome:?}"
        );
    }
}

#[test]
fn continuous_where_the_lanes_end() {
    // Slip, sinkage and rebound through every limit of the lanes: from one rule to the next and from the
    // lanes to the general kernel, which agree to their accuracy.
    let soil = catalogue::find("clayey-soil").unwrap().soil().unwrap();
    let kernel = BatchKernel::new(soil);
    let along = |at: &dyn Fn(f64) -> Point| {
        let points: Vec<Point> = (0..4001).map(|i| at(f64::from(i) / 4000.0)).collect();
        let nudged: Vec<Point> = (0..4001)
            .map(|i| at(f64::from(i) / 4000.0 + 1e-12))
            .collect();
        let (a, b) = (
            Columns::new(&points).forces(&kernel),
            Columns::new(&nudged).forces(&kernel),
        );
        for (a, b) in a.iter().zip(&b) {
            let (a, b) = (done(a), done(b));
            assert!(
                (a.drawbar_pull - b.drawbar_pull).abs() < 1e-9 * a.vertical_force.abs().max(1e-9)
            );
        }
    };
    along(&|x| (0.1, 0.05, 0.0, 0.3, 0.4 + 0.2 * x));
    along(&|x| (0.1, 0.05, 0.0, 0.3, 4e-4 + 1e-4 * x));
    along(&|x| (0.1, 0.05, 0.0, 0.9 * x, 0.2));
    // from a rebound of 0.05 on: the exit angle starts as its square root
    along(&|x| (0.1, 0.05, 0.05 + 0.9 * x, 0.2, 0.4));
}

#[test]
fn slices_of_unequal_length_are_refused() {
    let kernel = BatchKernel::new(catalogue::find("lunar").unwrap().soil().unwrap());
    let columns = Columns::new(&[(0.1, 0.05, 0.0, 0.3, 0.1); 3]);
    let points = columns.points();
    let refused = |sinkage: BatchInput<'_>, n: usize| {
        let [mut a, mut b, mut c, mut d] = [[0.0; 3]; 4];
        let error = kernel.forces(
            &points,
            sinkage,
            &mut BatchColumns {
                sinkage: &mut a[..n],
                vertical_force: &mut b,
                drawbar_pull: &mut c,
                torque: &mut d,
                status: &mut [SolveStatus::default(); 3],
            },
        );
        matches!(error, Err(Error::Lengths { .. }))
    };
    assert!(refused((&columns.sinkage).into(), 2));
    assert!(refused((&columns.sinkage[..2]).into(), 3));
    assert!(!refused(0.01.into(), 3));
}

/// A constant input gives the same bits as a column that is filled with it, through several chunks.
#[test]
fn a_constant_is_a_column_of_one_number() {
    let kernel = BatchKernel::new(catalogue::find("lunar").unwrap().soil().unwrap());
    let points: Vec<Point> = (0..500)
        .map(|i| (0.1, 0.05, 0.0, f64::from(i) / 500.0, 0.1))
        .collect();
    let columns = Columns::new(&points);
    let constant = BatchPoints {
        radius: 0.1.into(),
        width: 0.05.into(),
        rebound: 0.0.into(),
        slip: (&columns.slip).into(),
    };
    for (a, b) in [
        (
            columns.forces(&kernel),
            batch(500, |out| kernel.forces(&constant, columns.sinkage[0], out)),
        ),
        (
            columns.under_load(&kernel, &[40.0; 500]),
            batch(500, |out| kernel.under_load(&constant, 40.0, out)),
        ),
    ] {
        assert_eq!(format!("{a:?}"), format!("{b:?}"));
    }
}

#[test]
fn a_soil_that_digs_with_slip_runs_one_at_a_time() {
    let soil = catalogue::find("mars-sim-sand").unwrap();
    let completion = grouser_terra::catalogue::Completion {
        c_1: Some(0.3),
        c_2: Some(0.2),
        ..Default::default()
    };
    let soil = soil.completed(&completion).unwrap();
    let out = Columns::new(&[(0.1, 0.05, 0.0, 0.3, 0.1); 3]).forces(&BatchKernel::new(soil));
    assert!(out.iter().all(|f| done(f).vertical_force > 0.0));
}

#[test]
fn a_curve_is_as_good_as_its_points() {
    for key in ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"] {
        let kernel = BatchKernel::new(catalogue::find(key).unwrap().soil().unwrap());
        let wheel = RigidWheel::new(0.2, 0.15).unwrap();
        for (from, to, load) in [
            (0.0, 0.9, 300.0),
            (0.0, 1.0, 3.0),
            (-0.2, 0.4, 100.0),
            (0.3, 0.301, 900.0),
        ] {
            let slip: Vec<f64> = (0..301)
                .map(|i| from + (to - from) * f64::from(i) / 300.0)
                .collect();
            let out = batch(slip.len(), |out| kernel.curve(&wheel, load, &slip, out));
            for (s, got) in slip.iter().zip(&out) {
                let p = (0.2, 0.15, 0.0, *s, 0.0);
                let motion = Kinematics::straight(Slip::new(*s).unwrap());
                let exact = contact(kernel.soil(), p).under_load(load, &motion).unwrap();
                let Some(point) = exact.point() else {
                    assert_eq!(got.status, SolveStatus::NoSolution);
                    continue;
                };
                let (got, f) = (done(got), point.forces);
                let size = f
                    .vertical_force
                    .max(f.drawbar_pull.abs())
                    .max(f.torque.abs() / 0.2);
                let off = (f.vertical_force - got.vertical_force)
                    .abs()
                    .max((f.drawbar_pull - got.drawbar_pull).abs())
                    .max((f.torque - got.torque).abs() / 0.2);
                // the forces' own 1e-9 and, at the same load, what 1e-9 of sinkage makes of them
                assert!(
                    off <= 2e-9 * size,
                    "{key} slip {s} load {load}: {:e}",
                    off / size
                );
                assert!(
                    (got.sinkage / point.sinkage - 1.0).abs() < 2e-9,
                    "{key} slip {s} load {load}"
                );
            }
        }
    }
}

/// Found by fuzzing: with the greatest stress close behind the entry, what the short cosine lacks counts by the
/// narrow front. Such a point is not for lanes.
#[test]
fn a_narrow_front_deep_in_the_ground_is_as_exact_on_lanes() {
    let radius = 0.318_132_698_162_955_36;
    for (c_2, n) in [
        (0.0, 2.2),
        (0.2, 2.2),
        (0.3, 2.2),
        (0.4, 1.1),
        (0.529_4, 2.2),
        (0.54, 1.1),
    ] {
        let soil = Soil::new(SoilParams {
            n,
            c_1: 0.529_411_764_705_882_4,
            c_2,
            phi: grouser_terra::Angle::from_rad(0.0),
            cohesion: 0.27,
            k_shear: 0.071_3,
            ..*catalogue::find("lunar").unwrap().soil().unwrap().params()
        })
        .unwrap();
        let columns = Columns::new(&[(radius, 0.495, 0.0, 0.866_8, 0.4936)]);
        let lanes = done(&columns.forces(&BatchKernel::new(soil))[0]);
        let exact = Settings {
            accuracy: Accuracy::Reference,
            ..Settings::default()
        };
        let wheel = RigidWheel::new(radius, 0.495).unwrap();
        let contact = WheelOnSoil::new(wheel, soil, exact).unwrap();
        let straight = Kinematics::straight(Slip::new(0.866_8).unwrap());
        let reference = contact
            .at_sinkage(columns.sinkage[0], &straight)
            .unwrap()
            .forces;
        let size = reference
            .vertical_force
            .abs()
            .max(reference.drawbar_pull.abs());
        for (a, b) in [
            (lanes.vertical_force, reference.vertical_force),
            (lanes.drawbar_pull, reference.drawbar_pull),
        ] {
            assert!(
                (a - b).abs() <= 1e-9 * size,
                "c_2 {c_2}: {a:e} {b:e} of {size:e}"
            );
        }
    }
}

/// A wheel on a soil, weights and slopes (rad).
fn slopes() -> impl Strategy<Value = (Soil, RigidWheel, Vec<(f64, f64)>)> {
    let point = (0.0..4.0_f64, -0.2..0.7_f64)
        .prop_map(|(log_weight, slope)| (10_f64.powf(log_weight), slope));
    let wheel = (0.02..0.6_f64, 0.02..0.5_f64)
        .prop_map(|(radius, width)| RigidWheel::new(radius, width).unwrap());
    let rebound = prop_oneof![4 => Just(0.0), 1 => 0.0..1.0_f64];
    let soil = (soil(), rebound).prop_map(|(soil, rebound)| soil.with_rebound(rebound).unwrap());
    (soil, wheel, proptest::collection::vec(point, 1..40))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Slip demands on lanes are those of the general search: the same points are held, by slips that give the same pull.
    #[test]
    fn slip_demands_are_those_of_the_general_search((soil, wheel, points) in slopes()) {
        let (weight, slope): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        let n = points.len();
        let (mut slip, mut status) = (vec![0.0; n], vec![SolveStatus::default(); n]);
        let kernel = BatchKernel::new(soil);
        kernel.slip_demand(&wheel, &weight, &slope, &mut slip, &mut status).unwrap();
        let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        for (i, (weight, slope)) in points.into_iter().enumerate() {
            let what = format!("{weight} N on {slope} rad: {} {:?}", slip[i], status[i]);
            let required = weight * slope.sin();
            let pull = |slip: f64| {
                let motion = Kinematics::straight(Slip::new(slip).unwrap());
                let solved = on_soil.under_load(weight * slope.cos(), &motion).unwrap();
                solved.point().map(|point| point.forces.drawbar_pull)
            };
            match on_soil.slip_demand(weight, Angle::from_rad(slope)).unwrap() {
                SlopeOutcome::Holds { slip: expected } => {
                    prop_assert_eq!(status[i], SolveStatus::Solved, "{} {:?}", what, expected);
                    let apart = (slip[i] - expected.value()).abs();
                    let off = (pull(slip[i]).unwrap() - required).abs() / weight;
                    prop_assert!(apart < 1e-9 || off < 1e-9, "{what} {expected:?} {off:e}");
                }
                SlopeOutcome::Immobilised { max_pull, .. } => {
                    let near = max_pull.is_some_and(|pull| (pull - required).abs() < 1e-9 * weight);
                    prop_assert!(near || (status[i] == SolveStatus::NoSolution && slip[i].is_nan()), "{what} {max_pull:?}");
                }
                SlopeOutcome::Slides { .. } => {
                    prop_assert_eq!(status[i], SolveStatus::NoSolution, "{}", what);
                }
            }
        }
    }
}

/// A wheel on a soil, loads and frictions of its bearing (N m).
fn loads() -> impl Strategy<Value = (Soil, RigidWheel, Vec<(f64, f64)>)> {
    let point = (
        0.0..4.0_f64,
        prop_oneof![Just(0.0), -3.0..-0.5_f64],
        0.0..1.0_f64,
    )
        .prop_map(|(log_load, log_share, _)| {
            let load = 10_f64.powf(log_load);
            let share = if log_share == 0.0 {
                0.0
            } else {
                10_f64.powf(log_share)
            };
            (load, share * load)
        });
    slopes().prop_flat_map(move |(soil, wheel, _)| {
        (
            Just(soil),
            Just(wheel),
            proptest::collection::vec(point.clone(), 1..20),
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Best slips on lanes are those of the general search: equally good, and as good as any of a hundred samples.
    #[test]
    fn best_slips_are_those_of_the_general_search((soil, wheel, points) in loads()) {
        let load: Vec<f64> = points.iter().map(|point| point.0).collect();
        let n = load.len();
        let kernel = BatchKernel::new(soil);
        let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        for of in [BestOf::Pull, BestOf::Efficiency] {
            let (mut slip, mut value) = (vec![0.0; n], vec![0.0; n]);
            let mut status = vec![SolveStatus::default(); n];
            let mut columns = BestSlipColumns { slip: &mut slip, value: &mut value, status: &mut status };
            kernel.best_slip(&wheel, of, &load, &mut columns).unwrap();
            for (i, &load) in load.iter().enumerate() {
                let what = format!("{of:?} {load} N: {} {} {:?}", slip[i], value[i], status[i]);
                let at = |slip: f64| {
                    let motion = Kinematics::straight(Slip::new(slip).unwrap());
                    let solved = on_soil.under_load(load, &motion).unwrap();
                    match (solved.point(), of) {
                        (Some(point), BestOf::Pull) => Some(point.forces.drawbar_pull),
                        (Some(point), BestOf::Efficiency) => point.tractive_efficiency(),
                        (None, _) => None,
                    }
                };
                let (alone, size) = match of {
                    BestOf::Pull => (on_soil.slip_of_maximum_pull(load).unwrap(), load),
                    BestOf::Efficiency => (on_soil.slip_of_maximum_efficiency(load).unwrap(), 1.0),
                };
                let Some(alone) = alone else {
                    prop_assert!(status[i] == SolveStatus::NoSolution && slip[i].is_nan(), "{what}");
                    continue;
                };
                prop_assert_eq!(status[i], SolveStatus::Solved, "{} {:?}", what, alone);
                // a light wheel may pull more than it carries
                let size = size.max(alone.value);
                prop_assert!((value[i] - alone.value).abs() < 1e-9 * size, "{what} {alone:?}");
                // the place is as good as its value, and better than any other
                let there = at(slip[i]).unwrap();
                prop_assert!((there - value[i]).abs() < 1e-9 * size, "{what} {there}");
                for k in (0..=100).step_by(5) {
                    let other = at(f64::from(k) / 100.0).unwrap_or(f64::NEG_INFINITY);
                    prop_assert!(other <= value[i] + 1e-9 * size, "{what} {other} at {k}");
                }
            }
        }
    }

    /// The skid of a free wheel is the first slip from −1 at which the soil no longer turns the wheel faster: none of 133 slips before
    /// it suffices, and there the torque vanishes, or jumps over zero where the sinkage does.
    #[test]
    fn skids_are_where_the_torque_first_suffices((soil, wheel, points) in loads()) {
        let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        for (load, bearing) in points {
            let skid = on_soil.free_slip(load, bearing).unwrap().map(Slip::value);
            // over load and radius; `None` where nothing carries the load
            let surplus = |slip: f64| {
                let motion = Kinematics::straight(Slip::new(slip.clamp(-1.0, 1.0)).unwrap());
                let point = on_soil.under_load(load, &motion).unwrap().point();
                point.map(|point| (point.forces.torque + bearing) / (load * wheel.radius()))
            };
            let samples = (0..=132).map(|k| f64::from(k) / 132.0 - 1.0);
            let carried = samples.filter_map(|slip| Some((slip, surplus(slip)?)));
            // what rises and falls again within 0.002 of slip is missed, as the documentation says
            let lasts = |slip: f64, by: f64| surplus(slip + by).is_none_or(|surplus| surplus > 0.0);
            let first = carried
                .clone()
                .find(|&(slip, over)| over > 1e-11 && (lasts(slip, -2e-3) || lasts(slip, 2e-3)));
            let what = format!("{load} N, {bearing} N m: {skid:?} {first:?}");
            let Some(slip) = skid else {
                let locked = carried.clone().next();
                prop_assert!(first.is_none() || first == locked, "{what}");
                continue;
            };
            prop_assert!(first.is_none_or(|first| slip - 1e-9 < first.0), "{what}");
            let before = surplus(slip - 1e-9).is_none_or(|before| before < 0.0);
            let jumps = before && surplus(slip + 1e-9).is_some_and(|behind| behind >= 0.0);
            let off = surplus(slip).map_or(f64::INFINITY, f64::abs);
            prop_assert!(off < 1e-11 || jumps, "{what} {off:e}");
        }
    }
}

#[test]
fn best_slips_of_bad_loads_and_columns_of_unequal_length() {
    let kernel = BatchKernel::new(catalogue::find("dry-sand").unwrap().soil().unwrap());
    let wheel = RigidWheel::new(0.125, 0.1).unwrap();
    let load = [80.0, f64::NAN, -1.0, 2e12, 1e9];
    let (mut slip, mut value, mut status) = ([0.0; 5], [0.0; 5], [SolveStatus::default(); 5]);
    let mut columns = BestSlipColumns {
        slip: &mut slip,
        value: &mut value,
        status: &mut status,
    };
    kernel
        .best_slip(&wheel, BestOf::Pull, &load, &mut columns)
        .unwrap();
    let short = kernel.best_slip(&wheel, BestOf::Pull, &load[..4], &mut columns);
    assert!(matches!(short, Err(Error::Lengths { .. })));
    let bad = SolveStatus::BadInput;
    assert_eq!(status[1..4], [bad; 3]);
    assert_eq!(
        (status[0], status[4]),
        (SolveStatus::Solved, SolveStatus::NoSolution)
    );
    assert!(slip[0] > 0.3 && slip[1..].iter().chain(&value[1..]).all(|x| x.is_nan()));
}

#[test]
fn a_slope_that_is_none_and_columns_of_unequal_length() {
    let kernel = BatchKernel::new(catalogue::find("dry-sand").unwrap().soil().unwrap());
    let wheel = RigidWheel::new(0.125, 0.1).unwrap();
    let slope = [0.1, f64::NAN, 1.6, -1.6, 0.1];
    let weight = [80.0, 80.0, 80.0, 80.0, -1.0];
    let (mut slip, mut status) = ([0.0; 5], [SolveStatus::default(); 5]);
    kernel
        .slip_demand(&wheel, &weight, &slope, &mut slip, &mut status)
        .unwrap();
    assert_eq!(status[0], SolveStatus::Solved);
    assert_eq!(status[1..], [SolveStatus::BadInput; 4]);
    assert!(slip[0] > 0.0 && slip[1..].iter().all(|slip| slip.is_nan()));
    let short = kernel.slip_demand(&wheel, &weight, &slope[..4], &mut slip, &mut status);
    assert!(matches!(short, Err(Error::Lengths { .. })));
}

/// At the steepest slope itself the samples decide nothing: a hair less is held, a hair more is not.
#[test]
fn slopes_at_the_limit_are_decided_as_one_by_one() {
    for key in ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"] {
        let soil = catalogue::find(key).unwrap().soil().unwrap();
        let wheel = RigidWheel::new(0.15, 0.1).unwrap();
        let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        let kernel = BatchKernel::new(soil);
        for weight in [10.0, 80.0, 300.0] {
            let Some(limit) = on_soil.gradeability(weight).unwrap() else {
                continue;
            };
            let slope = [1.0 - 1e-3, 1.0 - 1e-7, 1.0 + 1e-7, 1.0 + 1e-3].map(|x| x * limit.rad());
            let (mut slip, mut status) = ([0.0; 4], [SolveStatus::default(); 4]);
            kernel
                .slip_demand(&wheel, weight, &slope, &mut slip, &mut status)
                .unwrap();
            let (held, not) = (SolveStatus::Solved, SolveStatus::NoSolution);
            assert_eq!(status, [held, held, not, not], "{key} {weight} N");
        }
    }
}
