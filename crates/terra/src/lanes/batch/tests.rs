use super::super::machine::tests::levels;
use super::*;
use crate::catalogue;

/// Six lanes full, and one point more.
const POINTS: usize = 49;

#[test]
fn the_instructions_have_the_name_of_the_best() {
    let best = Level::best().name();
    let kernel = BatchKernel::new(catalogue::find("snow").unwrap().soil().unwrap());
    assert_eq!(kernel.instructions(), best);
    assert_eq!(kernel.portable().instructions(), "portable");
    let all = if grouser_real::DETERMINISTIC {
        "deterministic"
    } else {
        best
    };
    assert_eq!(instructions(), all);
}

/// Every set of instructions writes every column, to 1e-9 as the portable one does, as do the points by themselves.
#[test]
fn all_instructions_solve_the_same() {
    let soil = catalogue::find("sandy-loam").unwrap().soil().unwrap();
    let radius = 0.15;
    let slip: [f64; POINTS] = core::array::from_fn(|i| 0.05 + 0.017 * i as f64);
    let sinkage: [f64; POINTS] = core::array::from_fn(|i| 0.004 + 0.001 * i as f64);
    let points = BatchPoints {
        radius: radius.into(),
        width: 0.1.into(),
        rebound: 0.0.into(),
        slip: (&slip).into(),
    };
    let wheel = RigidWheel::new(radius, 0.1).unwrap();
    let solved = |level: Level, task: usize| {
        let kernel = BatchKernel {
            level,
            ..BatchKernel::new(soil)
        };
        let mut columns = [[-1.0; POINTS]; 4];
        let [z, vertical_force, drawbar_pull, torque] = &mut columns;
        let mut out = BatchColumns {
            sinkage: z,
            vertical_force,
            drawbar_pull,
            torque,
            status: &mut [SolveStatus::Solved; POINTS],
        };
        match task {
            0 => kernel.forces(&points, &sinkage, &mut out),
            1 => kernel.under_load(&points, 150.0, &mut out),
            _ => kernel.curve(&wheel, 150.0, &slip, &mut out),
        }
        .unwrap();
        columns
    };
    let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
    for task in 0..3 {
        let expected: [[f64; 4]; POINTS] = core::array::from_fn(|i| {
            let motion = Kinematics::straight(Slip::new(slip[i]).unwrap());
            let z = if task == 0 {
                sinkage[i]
            } else {
                on_soil
                    .sinkage_under(150.0, &motion)
                    .unwrap()
                    .sinkage()
                    .unwrap()
            };
            let forces = on_soil.forces_at(z, &motion).unwrap();
            [z, forces.vertical_force, forces.drawbar_pull, forces.torque]
        });
        for level in levels() {
            let found = solved(level, task);
            for (i, expected) in expected.iter().enumerate() {
                let size = [expected[0], expected[1], expected[1], expected[1] * radius];
                for (k, size) in size.into_iter().enumerate() {
                    let off = (found[k][i] - expected[k]).abs();
                    assert!(off < 3e-9 * size, "{level:?} {task} {i} {k}: {off:e}");
                }
            }
        }
    }
}

#[test]
fn which_exponents_share_their_tables() {
    let shared = |n: f64| shared_tables(BatchInput::Constant(n));
    assert_eq!(shared(0.1), Some(ExponentTables::with_exponent(0.1)));
    assert_eq!(shared(3.0), Some(ExponentTables::with_exponent(3.0)));
    for n in [0.099, 3.001, f64::NAN] {
        assert_eq!(shared(n), None);
    }
    assert_eq!(shared_tables(BatchInput::Column(&[0.8])), None);
}

/// As few chunks as there can be, as long as one another but for a group.
#[test]
fn chunks_are_as_equal_as_they_can_be() {
    let of = chunk_length;
    assert_eq!([0, 1, 8, 9, CHUNK].map(of), [8, 8, 8, 16, CHUNK]);
    assert_eq!(of(CHUNK + 1), (CHUNK / 2 + 1).next_multiple_of(8));
    assert_eq!(of(4 * CHUNK - 7), CHUNK);
}
