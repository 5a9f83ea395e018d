//! The rows of a box to first order.

use grouser_real::Interval;

use super::bound::Multipliers;
use super::process::Examiner;
use super::rows::Rows;
use crate::sqp::LinearKind;
use crate::tape::Enclosures;

/// So many rows with poles are looked at for pairs whose poles cancel.
const MAX_POLES: usize = 16;
/// Multipliers of such pairs are multiples of the inverse of this.
const PAIR_STEPS: f64 = 1_073_741_824.0;

/// The rows that matter in a box, to first order. A pair of rows stands for two of them whose poles cancel.
pub(super) struct Expansion {
    pub(super) rows: Vec<Multipliers>,
    pub(super) kinds: Vec<LinearKind>,
    /// Row-major enclosures of the gradients.
    pub(super) gradients: Vec<Interval>,
    /// The rows at the middle.
    pub(super) offsets: Vec<Interval>,
}

impl Expansion {
    /// Adds a multiple of row or pair `at` to a weighted sum.
    pub(super) fn add(&self, sum: &mut Multipliers, at: usize, multiplier: f64) {
        let multiplier = if let [(row, weight)] = self.rows[at][..] {
            debug_assert!(weight == 1.0, "row {row}");
            multiplier
        } else {
            // so that the poles of several pairs cancel without rounding
            (multiplier * PAIR_STEPS).round() / PAIR_STEPS
        };
        for &(row, weight) in &self.rows[at] {
            match sum.iter_mut().find(|(other, _)| *other == row) {
                Some((_, sum)) => *sum += weight * multiplier,
                None => sum.push((row, weight * multiplier)),
            }
        }
    }
}

impl Examiner {
    /// The rows that matter, with gradients over the box and values at its middle.
    pub(super) fn expand(&mut self, rows: &Rows, x: &[Interval]) -> Expansion {
        let value = |over: &Enclosures, index: usize| over.values[rows.list[index].node as usize];
        let highest_low = (0..rows.list.len())
            .filter(|r| rows.list[*r].kind == LinearKind::Objective)
            .map(|r| value(&self.over, r).low())
            .fold(f64::NEG_INFINITY, f64::max);
        let mut expansion = Expansion {
            rows: Vec::new(),
            kinds: Vec::new(),
            gradients: Vec::new(),
            offsets: Vec::new(),
        };
        let middle: Vec<Interval> = x.iter().map(|x| Interval::point(x.middle())).collect();
        self.at.forward(&rows.tape, &middle, &rows.needed);
        let mut gradient = vec![Interval::ZERO; x.len()];
        let mut irregular: Multipliers = Vec::new();
        for (index, row) in rows.list.iter().enumerate() {
            let over = value(&self.over, index);
            let matters = match row.kind {
                LinearKind::Objective => over.high() >= highest_low,
                LinearKind::AtMost => over.high() > 0.0,
                LinearKind::Equal => true,
            };
            let offset = value(&self.at, index);
            if !matters {
                continue;
            }
            let term = [(row.node, 1.0)];
            let regular = self
                .over
                .gradient(&rows.tape, &row.needed, &term, &mut gradient);
            // the rows without divisors do better where there are opposites
            if !regular && row.kind == LinearKind::Objective && rows.opposites.is_none() {
                irregular.push((index, 0.5));
            }
            if regular && gradient.iter().all(|g| g.is_bounded()) && offset.is_bounded() {
                expansion.rows.push(vec![(index, 1.0)]);
                // the greatest of the rows without divisors is to be above 0
                let is_limit = rows.is_cleared && row.kind == LinearKind::AtMost;
                expansion.kinds.push(if is_limit {
                    LinearKind::Objective
                } else {
                    row.kind
                });
                expansion.gradients.extend(&gradient);
                expansion.offsets.push(offset);
            }
        }
        irregular.truncate(MAX_POLES);
        for (at, &first) in irregular.iter().enumerate() {
            for &second in &irregular[at + 1..] {
                let pair = vec![first, second];
                let (terms, needed) = (rows.terms(&pair), rows.needed_by(&pair));
                let regular = self
                    .over
                    .gradient(&rows.tape, &needed, &terms, &mut gradient);
                let offset = self.at.sum(&rows.tape, &needed, &terms);
                if regular && gradient.iter().all(|g| g.is_bounded()) && offset.is_bounded() {
                    expansion.rows.push(pair);
                    expansion.kinds.push(LinearKind::Objective);
                    expansion.gradients.extend(&gradient);
                    expansion.offsets.push(offset);
                }
            }
        }
        expansion
    }
}
