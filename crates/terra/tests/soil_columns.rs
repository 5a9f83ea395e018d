//! A batch with a soil for each point, against each soil by itself.

use grouser_terra::{
    Angle, BatchColumns, BatchInput, BatchKernel, Bekker, Error, Kinematics, Pressure, Reece,
    RigidWheel, Settings, Slip, Soil, SoilColumns, SoilParams, SolveStatus, WheelOnSoil, catalogue,
};
use proptest::prelude::*;

use super::batches::{Columns, Point, batch, contact, done, point, soil};

/// A soil that differs from another in what may be a column: factors of the moduli, and all other numbers.
#[derive(Clone, Copy, Debug)]
struct Draw {
    moduli: (f64, f64),
    n: f64,
    cohesion: f64,
    phi: f64,
    k_shear: f64,
    position: (f64, f64),
}

fn draw() -> impl Strategy<Value = Draw> {
    let cohesion = prop_oneof![Just(0.0), 0.0..2e4_f64];
    let position = (0.0..0.7_f64, -0.2..0.5_f64);
    let moduli = (0.5..2.0_f64, 0.5..2.0_f64);
    (
        moduli,
        0.1..=3.0_f64,
        cohesion,
        0.0..0.9_f64,
        -3.5..-1.0_f64,
        position,
    )
        .prop_map(|(moduli, n, cohesion, phi, log_k, position)| Draw {
            moduli,
            n,
            cohesion,
            phi,
            k_shear: 10_f64.powf(log_k),
            position,
        })
}

impl Draw {
    /// The whole soil, made without columns.
    fn soil(&self, base: &Soil) -> Result<Soil, Error> {
        let scaled = |(k_c, k_phi): (f64, f64)| (k_c * self.moduli.0, k_phi * self.moduli.1);
        let pressure = match base.params().pressure {
            Pressure::Bekker(law) => {
                let (k_c, k_phi) = scaled((law.k_c, law.k_phi));
                Pressure::Bekker(Bekker { k_c, k_phi })
            }
            Pressure::Reece(law) => {
                let (k_c_prime, k_phi_prime) = scaled((law.k_c_prime, law.k_phi_prime));
                Pressure::Reece(Reece {
                    k_c_prime,
                    k_phi_prime,
                })
            }
        };
        Soil::new(SoilParams {
            pressure,
            n: self.n,
            cohesion: self.cohesion,
            phi: Angle::from_rad(self.phi),
            k_shear: self.k_shear,
            c_1: self.position.0,
            c_2: self.position.1,
            ..*base.params()
        })
    }
}

/// Draws as columns; of the exponent one number where it is `shared`.
struct DrawColumns {
    columns: [Vec<f64>; 8],
    shared: Option<f64>,
}

impl DrawColumns {
    fn new(base: &Soil, draws: &[Draw], shared: Option<f64>) -> Self {
        let (k_c, k_phi) = match base.params().pressure {
            Pressure::Bekker(law) => (law.k_c, law.k_phi),
            Pressure::Reece(law) => (law.k_c_prime, law.k_phi_prime),
        };
        let of = |f: &dyn Fn(&Draw) -> f64| draws.iter().map(f).collect();
        Self {
            columns: [
                of(&|d| k_c * d.moduli.0),
                of(&|d| k_phi * d.moduli.1),
                of(&|d| d.n),
                of(&|d| d.cohesion),
                of(&|d| d.phi),
                of(&|d| d.k_shear),
                of(&|d| d.position.0),
                of(&|d| d.position.1),
            ],
            shared,
        }
    }

    fn part(&self, range: std::ops::Range<usize>) -> SoilColumns<'_> {
        let [k_c, k_phi, n, cohesion, phi, k_shear, c_1, c_2] = self
            .columns
            .each_ref()
            .map(|column| BatchInput::Column(&column[range.clone()]));
        SoilColumns {
            k_c,
            k_phi,
            n: self.shared.map_or(n, BatchInput::Constant),
            cohesion,
            phi,
            k_shear,
            c_1,
            c_2,
        }
    }
}

/// Soils of both laws of pressure.
fn base() -> impl Strategy<Value = Soil> {
    (soil(), any::<bool>()).prop_map(|(soil, is_reece)| {
        let reece = Pressure::Reece(Reece {
            k_c_prime: 2.0,
            k_phi_prime: 30.0,
        });
        let params = SoilParams {
            pressure: if is_reece {
                reece
            } else {
                soil.params().pressure
            },
            unit_weight: Some(16e3),
            ..*soil.params()
        };
        Soil::new(params).unwrap()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// A soil for each point: forces, sinkages and cautions are those of each soil by itself in the reference mode.
    #[test]
    fn every_point_has_its_soil(
        base in base(),
        shared in prop::option::of(0.1..3.0_f64),
        rows in prop::collection::vec((point(), draw()), 1..40),
    ) {
        let (points, mut draws): (Vec<Point>, Vec<Draw>) = rows.into_iter().unzip();
        if let Some(n) = shared {
            for draw in &mut draws {
                draw.n = n;
            }
        }
        let soils = DrawColumns::new(&base, &draws, shared);
        let columns = Columns::new(&points);
        let n = points.len();
        for kernel in [BatchKernel::new(base), BatchKernel::new(base).portable()] {
            let forces = batch(n, |out| {
                kernel.forces_on(&soils.part(0..n), &columns.points(), &columns.sinkage, out)
            });
            let loads: Vec<f64> =
                forces.iter().map(|f| done(f).vertical_force.abs().max(1e-3)).collect();
            let solved = batch(n, |out| {
                kernel.under_load_on(&soils.part(0..n), &columns.points(), &loads, out)
            });
            for (i, (p, draw)) in points.iter().zip(&draws).enumerate() {
                let soil = draw.soil(&base).unwrap();
                let exact = contact(&soil, *p);
                let motion = Kinematics::straight(Slip::new(p.3).unwrap());
                let single = exact.at_sinkage(p.4 * p.0, &motion).unwrap();
                let (f, got) = (single.forces, done(&forces[i]));
                let size = f.vertical_force.abs().max(f.drawbar_pull.abs()).max(f.torque.abs() / p.0);
                let off = (f.vertical_force - got.vertical_force).abs()
                    .max((f.drawbar_pull - got.drawbar_pull).abs())
                    .max((f.torque - got.torque).abs() / p.0);
                prop_assert!(off <= 1e-9 * size, "{:e} at {:?} on {:?}", off / size, p, draw);
                let exact = exact.sinkage_under(loads[i], &motion).unwrap();
                match exact.sinkage() {
                    Some(exact) if solved[i].status == SolveStatus::Solved => {
                        prop_assert!((solved[i].sinkage / exact - 1.0).abs() < 1e-8, "{p:?} on {draw:?}");
                    }
                    _ => prop_assert_eq!(solved[i].status, exact.outcome.status(), "{:?} on {:?}", p, draw),
                }
            }
        }
    }

    /// Soils of neighbours, bad ones among them, change no bit of a point.
    #[test]
    fn soils_of_neighbours_change_nothing(
        base in base(),
        rows in prop::collection::vec((point(), draw()), 1..30),
        bad in prop::collection::vec((0..30_usize, 0..8_usize), 0..4),
    ) {
        let (points, draws): (Vec<Point>, Vec<Draw>) = rows.into_iter().unzip();
        let mut soils = DrawColumns::new(&base, &draws, None);
        for &(i, column) in bad.iter().filter(|(i, _)| *i < points.len()) {
            soils.columns[column][i] = [f64::NAN, f64::INFINITY, -1e13, 1e300][i % 4];
        }
        let columns = Columns::new(&points);
        let kernel = BatchKernel::new(base);
        let n = points.len();
        let together = batch(n, |out| {
            kernel.forces_on(&soils.part(0..n), &columns.points(), &columns.sinkage, out)
        });
        let loads: Vec<f64> = together.iter().map(|f| f.vertical_force.abs().max(0.1)).collect();
        let solved = batch(n, |out| {
            kernel.under_load_on(&soils.part(0..n), &columns.points(), &loads, out)
        });
        for i in 0..n {
            let is_bad = bad.iter().any(|(place, _)| *place == i);
            prop_assert_eq!(together[i].status == SolveStatus::BadInput, is_bad, "{:?}", &together[i]);
            let alone = Columns::new(&points[i..=i]);
            let forces = batch(1, |out| {
                kernel.forces_on(&soils.part(i..i + 1), &alone.points(), &alone.sinkage, out)
            });
            prop_assert_eq!(format!("{:?}", &forces[0]), format!("{:?}", &together[i]));
            let load = batch(1, |out| {
                kernel.under_load_on(&soils.part(i..i + 1), &alone.points(), &loads[i..=i], out)
            });
            prop_assert_eq!(format!("{:?}", &load[0]), format!("{:?}", &solved[i]));
        }
    }
}

/// Cautions are those of each point's soil.
#[test]
fn cautions_are_those_of_the_point_s_soil() {
    let sand = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let kernel = BatchKernel::new(sand);
    let columns = Columns::new(&[
        (0.1, 0.05, 0.0, 0.3, 0.1),
        (0.1, 0.05, 0.0, 0.3, 0.1),
        (0.1, 0.05, 0.0, -0.07, 0.1),
    ]);
    let c_1 = [0.2, 1.5, 0.2];
    let soils = SoilColumns {
        c_1: (&c_1).into(),
        ..SoilColumns::from_soil(&sand)
    };
    let [
        mut sinkage,
        mut vertical_force,
        mut drawbar_pull,
        mut torque,
    ] = [[0.0; 3]; 4];
    let mut status = [SolveStatus::default(); 3];
    let mut out = BatchColumns {
        sinkage: &mut sinkage,
        vertical_force: &mut vertical_force,
        drawbar_pull: &mut drawbar_pull,
        torque: &mut torque,
        status: &mut status,
    };
    kernel
        .forces_on(&soils, &columns.points(), &columns.sinkage, &mut out)
        .unwrap();
    for (i, c_1) in c_1.into_iter().enumerate() {
        let soil = Soil::new(SoilParams {
            c_1,
            ..*sand.params()
        })
        .unwrap();
        let motion = Kinematics::straight(Slip::new(columns.slip[i]).unwrap());
        let wheel = RigidWheel::new(0.1, 0.05).unwrap();
        let single = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        let single = single.at_sinkage(columns.sinkage[i], &motion).unwrap();
        let cautions = kernel.cautions_on(&soils, &columns.points(), &out, i);
        assert_eq!(cautions, single.cautions);
        assert_eq!(cautions.is_empty(), i == 0);
    }
}

#[test]
fn soil_columns_of_unequal_length_are_refused() {
    let sand = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let columns = Columns::new(&[(0.1, 0.05, 0.0, 0.3, 0.1); 3]);
    let soils = SoilColumns {
        c_2: (&[0.3, 0.3]).into(),
        ..SoilColumns::from_soil(&sand)
    };
    let [mut a, mut b, mut c, mut d] = [[0.0; 3]; 4];
    let error = BatchKernel::new(sand).under_load_on(
        &soils,
        &columns.points(),
        50.0,
        &mut BatchColumns {
            sinkage: &mut a,
            vertical_force: &mut b,
            drawbar_pull: &mut c,
            torque: &mut d,
            status: &mut [SolveStatus::default(); 3],
        },
    );
    assert!(matches!(
        error,
        Err(Error::Lengths {
            expected: 3,
            found: 2
        })
    ));
}
