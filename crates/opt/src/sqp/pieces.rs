//! Subproblems of functions that are the greatest of many combinations of parts.
//!
//! The parts are linearised, and a function is the greatest of all combinations of them: of very many rows, of which few matter.
//! They are found one by one: the subproblem is solved with the rows so far, the combination of each function is computed at
//! its step, and one that is greater than the rows so far becomes a row, until there is none. Afterwards each function
//! has one row again, the blend of its rows by their multipliers.
//!
//! Source: Kelley 1960, J. SIAM 8 (cutting planes), here within a subproblem.

use std::collections::BTreeMap;

use super::qp::{QpSolution, RowKind, Rows};
use super::subspace::dot;
use super::{Expansion, Sqp};
use crate::jacobian::Jacobian;
use crate::parts::{add_gradients, combined};
use crate::program::{Program, Row};

/// A combination that is greater by less than this share of its terms is none: rounding.
const ROUNDING_SHARE: f64 = 1e-12;
/// A subproblem takes a few rounds; after this many it is left as it is.
const MAX_ROUNDS: usize = 1000;

/// A row of a subproblem, of a row of the program.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece {
    row: usize,
    combination: Vec<(usize, f64)>,
}

/// What the rows of one function are together.
#[derive(Clone, Debug)]
pub(super) struct Blend {
    pub(super) row: usize,
    pub(super) combination: Vec<(usize, f64)>,
    gradient: Vec<f64>,
    offset: f64,
}

impl Blend {
    /// Puts it in the place of the function's row.
    pub(super) fn place(&self, rows: &mut Rows) {
        let n = self.gradient.len();
        rows.gradients[self.row * n..(self.row + 1) * n].copy_from_slice(&self.gradient);
        rows.offsets[self.row] = self.offset;
    }

    /// As the gradient of the row's function.
    pub(super) fn derive(&self, row: &Row, jacobian: &mut Jacobian) {
        let gradient = jacobian.row_mut(row.function);
        for (slot, g) in gradient.iter_mut().zip(&self.gradient) {
            *slot = g / row.slope();
        }
    }
}

/// The rows of a subproblem, and which of them belong to functions of parts.
struct Growing<'a> {
    program: &'a Program<'a>,
    slopes: &'a Jacobian,
    rows: Rows,
    /// Each with its place among the rows: first one in the place of each function's row, then those behind all rows.
    pieces: Vec<(usize, Piece)>,
}

impl Growing<'_> {
    /// The gradient and the offset of a combination, as a row of the program.
    fn row_of(&self, row: usize, combination: &[(usize, f64)]) -> (Vec<f64>, f64) {
        let row = &self.program.rows[row];
        let mut gradient = vec![0.0; self.program.dimension()];
        add_gradients(combination, row.slope(), self.slopes, &mut gradient);
        (gradient, row.value(combined(combination, &self.rows.parts)))
    }

    /// Puts a piece in the place of its function's row.
    fn set(&mut self, piece: Piece) {
        let (gradient, offset) = self.row_of(piece.row, &piece.combination);
        let n = gradient.len();
        self.rows.gradients[piece.row * n..(piece.row + 1) * n].copy_from_slice(&gradient);
        self.rows.offsets[piece.row] = offset;
        self.pieces.push((piece.row, piece));
    }

    /// Puts a piece behind all rows, unless it is there.
    fn push(&mut self, piece: Piece) {
        if self.pieces.iter().any(|(_, own)| *own == piece) {
            return;
        }
        let (gradient, offset) = self.row_of(piece.row, &piece.combination);
        let place = self.rows.kinds.len();
        self.rows.kinds.push(self.rows.kinds[piece.row]);
        self.rows.gradients.extend(gradient);
        self.rows.offsets.push(offset);
        self.pieces.push((place, piece));
    }

    /// The value of the row at `place` after a step.
    fn value(&self, place: usize, step: &[f64]) -> f64 {
        let n = step.len();
        self.rows.offsets[place] + dot(&self.rows.gradients[place * n..(place + 1) * n], step)
    }

    /// What must be exceeded by a combination of a function to matter after a step: the level, or what is violated already.
    fn known(&self, row: usize, step: &[f64]) -> f64 {
        let kinds = &self.rows.kinds;
        if kinds[row] == RowKind::Objective {
            let objectives = (0..kinds.len()).filter(|place| kinds[*place] == RowKind::Objective);
            let values = objectives.map(|place| self.value(place, step));
            return values.fold(f64::NEG_INFINITY, f64::max);
        }
        let own = self.pieces.iter().filter(|(_, piece)| piece.row == row);
        own.map(|(place, _)| self.value(*place, step))
            .fold(0.0, f64::max)
    }

    /// All pieces of a function together, by their multipliers, which add up to the second number.
    fn blend(&self, row: usize, multipliers: &[f64]) -> (Blend, f64) {
        let own = self.pieces.iter().filter(|(_, piece)| piece.row == row);
        let own: Vec<_> = own
            .map(|(place, piece)| (multipliers[*place], piece))
            .collect();
        let total: f64 = own.iter().map(|(u, _)| u).sum();
        let mut shares: BTreeMap<usize, f64> = BTreeMap::new();
        for (index, (u, piece)) in own.iter().enumerate() {
            let share = if total > 0.0 {
                u / total
            } else {
                f64::from(u8::from(index == 0))
            };
            for (part, c) in piece.combination.iter().filter(|_| share > 0.0) {
                *shares.entry(*part).or_default() += share * c;
            }
        }
        let combination: Vec<(usize, f64)> = shares.into_iter().collect();
        let (gradient, offset) = self.row_of(row, &combination);
        let blend = Blend {
            row,
            combination,
            gradient,
            offset,
        };
        (blend, total)
    }
}

impl Sqp<'_, '_, '_, '_> {
    /// Solves the subproblem with all rows that functions of parts have.
    pub(super) fn subproblem(
        &mut self,
        model: &Expansion,
        rows: &Rows,
        warm: &[f64],
    ) -> QpSolution {
        let program = self.program;
        let Some(source) = program.problem.model().parts() else {
            return self.plain_subproblem(model, rows, warm);
        };
        let objectives = program.problem.objectives().len();
        let own: Vec<usize> = (0..program.rows.len())
            .filter(|row| program.rows[*row].function < objectives)
            .filter(|row| rows.kinds[*row] != RowKind::Ignored)
            .collect();
        let piece = |row: usize, parts: &[f64]| Piece {
            row,
            combination: source.combination(program.rows[row].function, parts),
        };
        let mut all = Growing {
            program,
            slopes: &model.slopes,
            rows: rows.clone(),
            pieces: Vec::new(),
        };
        for row in &own {
            all.set(piece(*row, &rows.parts));
        }
        for carried in std::mem::take(&mut self.pieces) {
            all.push(carried);
        }
        let fixed = rows.kinds.len();
        let warm = with_zeros(warm, fixed, all.rows.kinds.len());
        let mut solution = self.plain_subproblem(model, &all.rows, &warm);
        for _ in 0..MAX_ROUNDS {
            if solution.stopped {
                break;
            }
            let step = &solution.step;
            let parts = rows.parts.iter().enumerate();
            let parts = parts.map(|(k, part)| part + dot(model.slopes.row(k), step));
            let parts: Vec<f64> = parts.collect();
            let greater = own.iter().filter_map(|row| {
                let found = piece(*row, &parts);
                let (value, size) = reading(&program.rows[*row], &found.combination, &parts);
                (value - all.known(*row, step) > ROUNDING_SHARE * size).then_some(found)
            });
            let greater: Vec<Piece> = greater.collect();
            let before = all.rows.kinds.len();
            for piece in greater {
                all.push(piece);
            }
            let count = all.rows.kinds.len();
            if count == before {
                break;
            }
            let warm = with_zeros(&solution.multipliers, before, count);
            solution = self.plain_subproblem(model, &all.rows, &warm);
        }
        let u = &solution.multipliers;
        let mut multipliers = [&u[..fixed], &u[all.rows.kinds.len()..]].concat();
        for row in own {
            let (blend, total) = all.blend(row, u);
            multipliers[row] = total;
            solution.blends.push(blend);
        }
        let used = all.pieces.into_iter().filter(|(place, _)| u[*place] > 0.0);
        self.pieces = used.map(|(_, piece)| piece).collect();
        solution.multipliers = multipliers;
        solution
    }
}

/// The value of a row for these parts, and the size of the terms it is made of.
fn reading(row: &Row, combination: &[(usize, f64)], parts: &[f64]) -> (f64, f64) {
    let terms = combination.iter().map(|(k, c)| (c * parts[*k]).abs());
    let size = (terms.sum::<f64>() + row.shift.abs()) * row.scale;
    (row.value(combined(combination, parts)), size)
}

/// Multipliers of `rows` rows, then of bounds, with zeros between them for the rows up to `all`.
fn with_zeros(multipliers: &[f64], rows: usize, all: usize) -> Vec<f64> {
    if multipliers.is_empty() {
        return Vec::new();
    }
    let (own, bounds) = multipliers.split_at(rows.min(multipliers.len()));
    [own, &vec![0.0; all - rows], bounds].concat()
}

#[cfg(test)]
#[path = "pieces_tests.rs"]
mod tests;
