//! Rows of combinations by hand: of three parts, for goals of which the third is a limit.

use core::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use grouser_real::Scalar;

use super::super::bfgs::Curvature;
use super::super::point::{Evaluator, Point};
use super::super::{Phase, Settings};
use super::*;
use crate::callback::Progress;
use crate::derivative::{Exact, Functions};
use crate::method::Method;
use crate::model::Model;
use crate::parts::Parts;
use crate::problem::{Problem, ProblemParams};
use crate::solution::Counts;

/// Never evaluated.
struct Nothing;
impl Functions for Nothing {
    fn evaluate<R: Scalar>(&self, _: &[R], f: &mut [R]) {
        f.fill(R::ZERO);
    }
}

/// Goals 1, −1 and 0.5 with the weights 2, 0.5 and none; the parts are 3, −2 and 0.5.
fn with_rows(test: impl FnOnce(Growing<'_>)) {
    let problem = Problem::new(ProblemParams::new(&[0.0; 2], 3, Exact(Nothing))).unwrap();
    let method = Method::Attain {
        goals: vec![1.0, -1.0, 0.5],
        weights: vec![2.0, 0.5, 0.0],
    };
    let program = Program::new(&problem, &method);
    let mut slopes = Jacobian::zeros(3, 2);
    for (row, gradient) in [[1.0, 2.0], [-1.0, 0.5], [0.25, -4.0]].iter().enumerate() {
        slopes.row_mut(row).copy_from_slice(gradient);
    }
    let cap = 10.0;
    let kinds = [
        RowKind::Objective,
        RowKind::Objective,
        RowKind::Inequality { cap },
    ];
    test(Growing {
        program: &program,
        slopes: &slopes,
        rows: Rows {
            kinds: kinds.to_vec(),
            gradients: vec![0.0; 6],
            offsets: vec![0.0; 3],
            parts: vec![3.0, -2.0, 0.5],
        },
        pieces: Vec::new(),
    });
}

fn piece(row: usize, combination: &[(usize, f64)]) -> Piece {
    Piece {
        row,
        combination: combination.to_vec(),
    }
}

#[test]
fn rows_of_combinations_and_their_blend() {
    with_rows(|mut all| {
        let first = piece(0, &[(0, 1.0), (1, 0.5)]);
        let later = piece(0, &[(1, -2.0)]);
        let limit = piece(2, &[(0, 1.0)]);
        all.set(first.clone());
        all.set(piece(1, &[(2, 1.0)]));
        all.set(limit);
        all.push(later.clone());
        all.push(piece(2, &[(1, 1.0)]));
        for known in [&first, &later] {
            all.push(known.clone());
        }
        assert_eq!(all.pieces.len(), 5);
        // (3 − 1 − 1)/2, (0.5 + 1)/0.5, 3 − 0.5, (4 − 1)/2, −2 − 0.5
        assert_eq!(all.rows.offsets, [0.5, 3.0, 2.5, 1.5, -2.5]);
        let gradients = [0.25, 1.125, 0.5, -8.0, 1.0, 2.0, 1.0, -0.5, -1.0, 0.5];
        assert_eq!(all.rows.gradients, gradients);
        assert_eq!(all.rows.kinds[3..], [all.rows.kinds[0], all.rows.kinds[2]]);
        let step = [2.0, 0.5];
        let values = [0, 1, 2, 3, 4].map(|place| all.value(place, &step));
        assert_eq!(values, [1.5625, 0.0, 5.5, 3.25, -4.25]);
        // the level, by any objective; what is violated, by the limit's own rows
        assert_eq!(
            [0, 1, 2].map(|row| all.known(row, &step)),
            [3.25, 3.25, 5.5]
        );
        // 0.25 − 8 · 2 and 2.5 − 10
        assert_eq!(all.known(0, &[0.0, 2.0]), 2.75);
        assert_eq!(all.known(2, &[-5.0, -4.0]), 0.5);
        assert_eq!(all.known(2, &[0.0, -3.0]), 0.0);

        let multipliers = [0.25, 0.0, 2.0, 0.75, 0.0];
        let (blend, total) = all.blend(0, &multipliers);
        assert_eq!((blend.row, total), (0, 1.0));
        assert_eq!(blend.combination, [(0, 0.25), (1, 0.125 - 1.5)]);
        assert_eq!(
            (&blend.gradient[..], blend.offset),
            (&[0.8125, -0.09375][..], 1.25)
        );
        // without multipliers the first one, and what has none is no part of it
        let (alone, total) = all.blend(0, &[0.0; 5]);
        assert_eq!((alone.combination, total), (first.combination.clone(), 0.0));
        let (alone, _) = all.blend(2, &multipliers);
        assert_eq!(alone.combination, [(0, 1.0)]);
        blend.place(&mut all.rows);
        assert_eq!(all.rows.gradients[..4], [0.8125, -0.09375, 0.5, -8.0]);
        assert_eq!(all.rows.offsets[..2], [1.25, 3.0]);
        let mut jacobian = Jacobian::zeros(3, 2);
        blend.derive(&all.program.rows[0], &mut jacobian);
        assert_eq!(jacobian.row(0), [1.625, -0.1875]);
        assert_eq!(jacobian.row(1), [0.0, 0.0]);
    });
}

/// The value of a row, and the size of what it is made of.
#[test]
fn values_of_rows_and_their_sizes() {
    with_rows(|all| {
        let parts = [3.0, -2.0, 0.5];
        let combination = [(0, 0.5), (1, 2.0)];
        // (1.5 − 4 − 1)/2 of 1.5 + 4 + 1, and (1.5 − 4 + 1)/0.5
        let rows = &all.program.rows;
        assert_eq!(reading(&rows[0], &combination, &parts), (-1.75, 3.25));
        assert_eq!(reading(&rows[1], &combination, &parts), (-3.0, 13.0));
    });
    assert_eq!(with_zeros(&[], 2, 4), [0.0; 0]);
    assert_eq!(
        with_zeros(&[1.0, 2.0, 3.0], 2, 4),
        [1.0, 2.0, 0.0, 0.0, 3.0]
    );
    assert_eq!(with_zeros(&[1.0, 2.0, 3.0], 2, 2), [1.0, 2.0, 3.0]);
}

/// f is the greatest of lines (value at 0, slope) in x, the last one where several are; combinations are counted.
struct Fan {
    lines: Vec<(f64, f64)>,
    counted: AtomicUsize,
}

impl Parts for &Fan {
    fn count(&self) -> usize {
        self.lines.len()
    }

    fn evaluate(
        &self,
        _: &[f64],
        _: &mut [f64],
        _: Option<&mut Jacobian>,
        _: &mut dyn crate::watch::Watch,
    ) {
    }

    fn combination(&self, _: usize, parts: &[f64]) -> Vec<(usize, f64)> {
        self.counted.fetch_add(1, Ordering::Relaxed);
        let of = |k: &usize, l: &usize| parts[*k].total_cmp(&parts[*l]);
        vec![((0..parts.len()).max_by(of).unwrap(), 1.0)]
    }
}

impl Model for &Fan {
    fn values(&self, _: &[f64], _: &mut [f64]) {}

    fn derivatives(&self, _: &[f64], _: &mut [f64], _: &mut Jacobian) {}

    fn parts(&self) -> Option<&dyn Parts> {
        Some(self)
    }
}

/// The subproblem of a fan at x, of the curvature 1/4: its solution, which lines are carried on, and how many were looked for.
fn of_fan(x: f64, lines: &[(f64, f64)], carried: &[usize]) -> (QpSolution, Vec<usize>, usize) {
    let fan = Fan {
        lines: lines.to_vec(),
        counted: AtomicUsize::new(0),
    };
    let problem = Problem::new(ProblemParams::new(&[x], 1, &fan)).unwrap();
    let program = Program::new(&problem, &Method::Minimax);
    let mut go_on = |_: &Progress<'_>| ControlFlow::Continue(());
    let mut slopes = Jacobian::zeros(lines.len(), 1);
    (0..lines.len()).for_each(|k| slopes.set(k, 0, lines[k].1));
    let parts: Vec<f64> = lines
        .iter()
        .map(|(value, slope)| value + slope * x)
        .collect();
    let rows = Rows {
        kinds: vec![RowKind::Objective],
        gradients: vec![0.0],
        offsets: vec![0.0],
        parts: parts.clone(),
    };
    let model = Expansion {
        point: Point {
            x: vec![x],
            functions: vec![0.0],
            rows: vec![0.0],
            parts,
        },
        jacobian: Jacobian::zeros(1, 1),
        slopes,
    };
    let mut sqp = Sqp {
        program: &program,
        settings: &Settings::default(),
        curvature: Curvature::new(1, 1, 0.25),
        evaluator: &mut Evaluator::new(&program, &mut go_on, Counts::default()),
        phase: Phase::Optimality,
        price: 10.0,
        multipliers: Vec::new(),
        history: Vec::new(),
        quiet: 0,
        pieces: carried.iter().map(|k| piece(0, &[(*k, 1.0)])).collect(),
        blends: Vec::new(),
        gradient_floor: 1.0,
        level_floor: 1.0,
    };
    let solution = sqp.subproblem(&model, &rows, &[]);
    let carried = sqp.pieces.iter().map(|piece| piece.combination[0].0);
    let carried = carried.collect();
    (solution, carried, fan.counted.load(Ordering::Relaxed))
}

/// −x and x − 1 are as high at 1/2, with 9/16 and 7/16 of the multiplier: the slopes' sum and d/4 cancel there.
#[test]
fn a_subproblem_finds_the_rows_that_it_needs() {
    let lines = [(0.0, -1.0), (-1.0, 1.0), (-3.0, 0.5)];
    // found one by one, or carried from the subproblem before: the third line holds nothing, and is carried no further
    for (carried, looks) in [(&[][..], 3), (&[2, 0, 1], 2)] {
        let (solution, used, counted) = of_fan(0.0, &lines, carried);
        assert!(solution.exact && (solution.step[0] - 0.5).abs() < 1e-15);
        assert_eq!(solution.multipliers, [1.0, 0.0, 0.0]);
        let blend = &solution.blends[0];
        assert_eq!((blend.row, blend.offset), (0, -0.4375));
        assert_eq!(blend.combination, [(0, 0.5625), (1, 0.4375)]);
        assert_eq!((used, counted), (vec![0, 1], looks));
    }
}

/// Where the first two lines cross a third one is as high, or higher by less than rounding is of a million.
#[test]
fn a_line_that_is_as_high_is_not_needed() {
    for (base, more) in [(0.0, 0.0), (1e6, 1e-8)] {
        let lines = [(base, -1.0), (base, 1.0), (base + more, 0.0)];
        let (solution, used, counted) = of_fan(1.0, &lines, &[]);
        assert_eq!((solution.step[0], used, counted), (-1.0, vec![1, 0], 3));
    }
}
