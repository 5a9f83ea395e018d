//! Random subproblems against their conditions of optimality, which of a convex problem are sufficient.

use proptest::prelude::*;

use super::*;

#[derive(Clone, Debug)]
struct Drawn {
    matrix: Vec<f64>,
    rows: Rows,
    lower: Vec<f64>,
    upper: Vec<f64>,
    warm: Vec<f64>,
}

/// What a row is drawn as, with its cap.
fn kind() -> impl Strategy<Value = RowKind> {
    let cap = prop_oneof![0.1..20.0_f64, Just(f64::INFINITY)];
    (0..4_u8, cap).prop_map(|(kind, cap)| match kind {
        0 => RowKind::Equality { cap },
        1 => RowKind::Ignored,
        _ => RowKind::Inequality { cap },
    })
}

prop_compose! {
    /// Up to five variables, some without bounds and some fixed; rows that must hold do so at a drawn point inside.
    fn drawn()(n in 1..=5_usize)(
        root in prop::collection::vec(-1.0..1.0_f64, n * n),
        point in prop::collection::vec(-1.0..1.0_f64, n),
        room in prop::collection::vec((0.01..2.0_f64, 0.01..2.0_f64, 0..6_u8), n),
        objectives in 0..=4_usize,
        kinds in prop::collection::vec(kind(), 0..=5),
        gradients in prop::collection::vec(prop_oneof![4 => -3.0..3.0_f64, 1 => Just(0.0)], 9 * n),
        offsets in prop::collection::vec(-2.0..2.0_f64, 9),
        repeated in any::<bool>(),
        warm in prop::collection::vec(-1.0..3.0_f64, 0..20),
        n in Just(n),
    ) -> Drawn {
        let matrix = (0..n * n).map(|at| {
            let (i, j) = (at / n, at % n);
            let own = if i == j { 0.1 } else { 0.0 };
            own + (0..n).map(|k| root[i * n + k] * root[j * n + k]).sum::<f64>()
        }).collect();
        let mut equal = 0;
        let kinds = kinds.into_iter().map(|kind| match kind {
            // more than n equations that must hold hold nowhere
            RowKind::Equality { cap } if cap.is_infinite() && { equal += 1; equal >= n } => RowKind::Ignored,
            kind => kind,
        });
        let mut rows = Rows {
            kinds: vec![RowKind::Objective; objectives].into_iter().chain(kinds).collect(),
            ..Rows::default()
        };
        for (row, kind) in rows.kinds.iter().enumerate() {
            let from = if repeated && row == 1 { 0 } else { row };
            let gradient = &gradients[from * n..(from + 1) * n];
            let there: f64 = gradient.iter().zip(&point).map(|(g, d)| g * d).sum();
            let free = offsets[from];
            rows.gradients.extend(gradient);
            rows.offsets.push(match kind {
                RowKind::Equality { cap } if cap.is_infinite() => -there,
                RowKind::Inequality { cap } if cap.is_infinite() => -there - free.abs(),
                _ => free,
            });
        }
        let bounds = point.iter().zip(&room).map(|(d, (below, above, kind))| match kind {
            0 => (f64::NEG_INFINITY, f64::INFINITY),
            1 => (*d, *d),
            2 => (d - below, f64::INFINITY),
            _ => (d - below, d + above),
        });
        let (lower, upper) = bounds.unzip();
        Drawn { matrix, rows, lower, upper, warm }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn a_solution_meets_the_conditions_of_optimality(drawn in drawn()) {
        let Drawn { matrix, rows, lower, upper, warm } = drawn;
        let n = lower.len();
        let factor = Factor::new(&matrix, n).unwrap();
        let found = Qp { factor: &factor, rows: &rows, lower: &lower, upper: &upper }.solve(&warm, &mut || false);
        prop_assert!(found.exact);
        let (d, u) = (&found.step, &found.multipliers);
        let count = rows.kinds.len();
        let size = 1.0 + u.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
        let zero = |value: f64| value.abs() < 1e-7 * size;
        let residual = |row: usize| -> f64 {
            rows.offsets[row] + rows.gradients[row * n..(row + 1) * n].iter().zip(d).map(|(g, d)| g * d).sum::<f64>()
        };
        for i in 0..n {
            let curved: f64 = (0..n).map(|j| matrix[i * n + j] * d[j]).sum();
            let pulled: f64 = (0..count).map(|row| u[row] * rows.gradients[row * n + i]).sum();
            let (low, high) = (u[count + 2 * i], u[count + 2 * i + 1]);
            prop_assert!(zero(curved + pulled + high - low));
            prop_assert!(d[i] >= lower[i] && d[i] <= upper[i] && low >= 0.0 && high >= 0.0);
            prop_assert!((low == 0.0 || zero(d[i] - lower[i])) && (high == 0.0 || zero(d[i] - upper[i])));
        }
        let objectives = || (0..count).filter(|row| rows.kinds[*row] == RowKind::Objective);
        let level = objectives().map(residual).fold(f64::NEG_INFINITY, f64::max);
        if objectives().next().is_some() {
            prop_assert!((objectives().map(|row| u[row]).sum::<f64>() - 1.0).abs() < 1e-9);
        }
        for (row, kind) in rows.kinds.iter().enumerate() {
            let (r, u) = (residual(row), u[row]);
            match *kind {
                RowKind::Objective => prop_assert!(u >= 0.0 && (u == 0.0 || zero(level - r))),
                RowKind::Inequality { cap } => {
                    prop_assert!(u >= 0.0 && u <= cap && (u == 0.0 || r > -1e-7 * size) && (u == cap || r < 1e-7 * size));
                }
                RowKind::Equality { cap } => {
                    prop_assert!(u.abs() <= cap && (u == -cap || r > -1e-7 * size) && (u == cap || r < 1e-7 * size));
                }
                RowKind::Ignored => prop_assert!(u == 0.0),
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// For one objective over a box and B = scale · I the first guess of the multipliers is the solution.
    #[test]
    fn the_first_guess_is_right_for_one_objective(
        variables in prop::collection::vec((-3.0..3.0_f64, -2.0..0.0_f64, 0.0..2.0_f64, any::<bool>()), 1..6),
        scale in 0.1..5.0_f64,
        place in 0..3_usize,
    ) {
        let n = variables.len();
        let gradient: Vec<f64> = variables.iter().map(|v| v.0).collect();
        let lower: Vec<f64> = variables.iter().map(|v| if v.3 { v.1 } else { f64::NEG_INFINITY }).collect();
        let upper: Vec<f64> = variables.iter().map(|v| v.2).collect();
        // beside it a constraint and an objective that are far from binding
        let mut rows = Rows {
            kinds: vec![RowKind::Objective, RowKind::Inequality { cap: 10.0 }],
            gradients: vec![0.0; 2 * n],
            offsets: vec![-1e3, -1e3],
            ..Rows::default()
        };
        rows.kinds.insert(place, RowKind::Objective);
        rows.offsets.insert(place, 1.0);
        rows.gradients.splice(place * n..place * n, gradient);
        let matrix: Vec<f64> = (0..n * n).map(|at| if at / n == at % n { scale } else { 0.0 }).collect();
        let factor = Factor::new(&matrix, n).unwrap();
        let found = Qp { factor: &factor, rows: &rows, lower: &lower, upper: &upper }.solve(&[], &mut || false);
        let guess = super::super::guess_multipliers(&rows, &lower, &upper, scale);
        prop_assert_eq!(guess.len(), found.multipliers.len());
        prop_assert!(guess.iter().zip(&found.multipliers).all(|(a, b)| (a - b).abs() < 1e-9), "{guess:?} {found:?}");
        rows.kinds.fill(RowKind::Ignored);
        prop_assert!(super::super::guess_multipliers(&rows, &lower, &upper, scale).iter().all(|u| *u == 0.0));
    }
}

#[test]
fn only_a_positive_definite_matrix_has_a_factor() {
    assert!(Factor::new(&[1.0, 2.0, 2.0, 4.1], 2).is_some());
    // a second pivot of up to four units in the last place of its entry is rounding
    let of_pivot = |units: f64| {
        let large = (1u64 << 20) as f64;
        let matrix = [1.0 / large, 1.0, 1.0, large * (1.0 + units * f64::EPSILON)];
        Factor::new(&matrix, 2)
    };
    assert!(of_pivot(3.0).is_none() && of_pivot(6.0).is_some());
    for matrix in [
        [1.0, 2.0, 2.0, 4.0],
        [1.0, 2.0, 2.0, 3.0],
        [0.0, 0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0, f64::INFINITY],
    ] {
        assert!(Factor::new(&matrix, 2).is_none(), "{matrix:?}");
    }
}

/// All bounds of 600 variables in the working set: 10⁸ products for their rows, and 2·10⁸ of one factorisation, before a second
/// round begins.
#[test]
fn a_factorisation_is_stopped_between_its_columns() {
    const N: usize = 600;
    let curvature: Vec<f64> = (0..N * N)
        .map(|at| if at % (N + 1) == 0 { 1.0 } else { 0.0 })
        .collect();
    let rows = Rows {
        kinds: vec![RowKind::Objective],
        gradients: vec![10.0; N],
        offsets: vec![0.0],
        ..Rows::default()
    };
    let (lower, upper) = (vec![-1.0; N], vec![1.0; N]);
    let qp = Qp {
        factor: &Factor::new(&curvature, N).unwrap(),
        rows: &rows,
        lower: &lower,
        upper: &upper,
    };
    // the objective's multiplier, and 9 for each lower bound: the solution
    let warm: Vec<f64> = (0..=2 * N)
        .map(|row| match row {
            0 => 1.0,
            _ if row % 2 == 1 => 9.0,
            _ => 0.0,
        })
        .collect();
    let mut calls = 0;
    let mut go_on = || {
        calls += 1;
        false
    };
    let solution = qp.solve(&warm, &mut go_on);
    assert!(solution.exact && solution.step.iter().all(|d| *d == -1.0));
    assert_eq!(calls, 3, "one in 10⁸ of 600 · 600 · (300 + 599) products");
    let mut calls = 0;
    let mut stop = || {
        calls += 1;
        true
    };
    assert!(qp.solve(&warm, &mut stop).stopped);
    assert_eq!(calls, 1);
}

/// Multipliers of another problem are put within their bounds, those of the objectives onto the sum 1; of a variable that is
/// fixed here the two bounds are one.
#[test]
fn where_multipliers_begin() {
    let rows = Rows {
        kinds: vec![
            RowKind::Objective,
            RowKind::Objective,
            RowKind::Inequality { cap: 2.0 },
            RowKind::Equality { cap: 3.0 },
            RowKind::Ignored,
        ],
        gradients: vec![0.0; 10],
        offsets: vec![0.0, 1.0, 0.0, 0.0, 0.0],
        ..Rows::default()
    };
    let qp = Qp {
        factor: &Factor::new(&[1.0, 0.0, 0.0, 1.0], 2).unwrap(),
        rows: &rows,
        lower: &[-1.0, 0.5],
        upper: &[1.0, 0.5],
    };
    let warm = [0.5, 1.5, 5.0, -1.0, 9.0, 0.25, f64::NAN, 2.0, 0.75];
    let expected = [0.25, 0.75, 2.0, -1.0, 0.0, 0.25, 0.0, 1.25, 0.0];
    assert_eq!(qp.feasible_start(&warm), expected);
    // without any the highest objective has all
    let expected = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(qp.feasible_start(&[]), expected);
    let mut u = [0.0, 0.0, 0.0, 0.0, 0.0, 0.25, 0.5, -1.25, 0.0];
    qp.split_fixed(&mut u);
    assert_eq!(u[5..], [0.25, 0.5, 0.0, 1.25]);
    u[7..].copy_from_slice(&[1.25, 0.0]);
    qp.split_fixed(&mut u);
    assert_eq!(u[5..], [0.25, 0.5, 1.25, 0.0]);
    let alone = Qp {
        factor: &Factor::new(&[1.0], 1).unwrap(),
        rows: &Rows::default(),
        lower: &[0.5],
        upper: &[0.5],
    };
    assert_eq!(alone.feasible_start(&[0.25, 0.75]), [-0.5, 0.0]);
}

/// Twelve rows that all meet in one point, of small whole slopes, so that many of them depend on others. The less a step costs the
/// more of its digits are rounding, by which some go round in circles: of a hundred each as many do not as did not.
#[test]
fn rows_that_meet_in_a_point_end_as_often_as_they_did() {
    /// Where they meet.
    const POINT: [f64; 3] = [0.1, 0.7, -0.3];
    let ended = |curvature: f64| {
        let one = |seed: u64| {
            let mut stream = crate::random::Random::new(seed);
            let mut rows = Rows::default();
            let cap = if seed.is_multiple_of(2) {
                f64::INFINITY
            } else {
                10.0
            };
            for row in 0..12 {
                let kind = if row < 9 {
                    RowKind::Objective
                } else {
                    RowKind::Inequality { cap }
                };
                let gradient = POINT.map(|_| (4.0 * stream.uniform() - 2.0).round());
                rows.kinds.push(kind);
                rows.gradients.extend(gradient);
                rows.offsets
                    .push(-gradient.iter().zip(POINT).map(|(g, d)| g * d).sum::<f64>());
            }
            let matrix = [
                curvature, 0.0, 0.0, 0.0, curvature, 0.0, 0.0, 0.0, curvature,
            ];
            let factor = Factor::new(&matrix, 3).unwrap();
            let (lower, upper) = (&[-3.0; 3], &[2.0; 3]);
            Qp {
                factor: &factor,
                rows: &rows,
                lower,
                upper,
            }
            .solve(&[], &mut || false)
            .exact
        };
        (0..100).filter(|seed| one(*seed)).count()
    };
    assert_eq!([1.0, 1e-6, 1e-12].map(ended), [100, 73, 56]);
}

/// At the limits of its multiplier a row is held, between them it is free, and each costs half of a square of products.
#[test]
fn rows_are_free_between_the_limits_of_their_multipliers() {
    let (inequality, equality) = (
        RowKind::Inequality { cap: 2.0 },
        RowKind::Equality { cap: 3.0 },
    );
    let rows = Rows {
        kinds: vec![
            RowKind::Objective,
            inequality,
            inequality,
            equality,
            equality,
            RowKind::Ignored,
        ],
        gradients: vec![1.0; 18],
        offsets: vec![0.0; 6],
        ..Rows::default()
    };
    let qp = Qp {
        factor: &Factor::new(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], 3).unwrap(),
        rows: &rows,
        lower: &[f64::NEG_INFINITY; 3],
        upper: &[f64::INFINITY; 3],
    };
    let (mut members, mut held) = (Vec::new(), Vec::new());
    let mut pace = Pace {
        products: 0,
        stop: &mut || true,
    };
    let u = [1.0, 2.0, 0.5, -3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert!(qp.gather(&u, &mut pace, (&mut members, &mut held)));
    let rows_of = |list: &[Member]| list.iter().map(|member| member.row).collect::<Vec<_>>();
    assert_eq!(
        (rows_of(&members), rows_of(&held)),
        (vec![0, 2, 4], vec![1, 3])
    );
    assert_eq!(pace.products, 5 * 4);
    pace.products = PRODUCTS_PER_CALL - 1;
    assert!(!pace.is_stopped(1) && pace.is_stopped(1) && pace.products == 0);
}

/// What is left of a row after a step, and the size of its terms: (2, −3) · (1/2, 1/4) − 1, of an objective less the level; of
/// bounds the greatest of the bound and the step.
#[test]
fn residuals_and_their_sizes() {
    let rows = Rows {
        kinds: vec![RowKind::Objective, RowKind::Inequality { cap: 2.0 }],
        gradients: vec![2.0, -3.0, 2.0, -3.0],
        offsets: vec![-1.0, -1.0],
        ..Rows::default()
    };
    let qp = Qp {
        factor: &Factor::new(&[1.0, 0.0, 0.0, 1.0], 2).unwrap(),
        rows: &rows,
        lower: &[-1.0, 0.0],
        upper: &[2.0, 0.75],
    };
    let of = |row| qp.residual(row, &[0.5, 0.25], 0.125);
    assert_eq!((of(0), of(1)), ((-0.875, 2.875), (-0.75, 2.75)));
    assert_eq!((of(2), of(5)), ((-1.5, 1.0), (-0.5, 0.75)));
}
