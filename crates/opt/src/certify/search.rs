//! Best-first branch and bound.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::ControlFlow;
use std::time::Instant;

use grouser_real::Interval;
use rayon::prelude::*;

use super::bound::{Bounder, Weights};
use super::process::{Aim, End, Examined, Examiner};
use super::proof::{Proof, claim};
use super::rows::Rows;
use super::{Certificate, CertifyProgress, CertifySettings, CertifyStatus};
use crate::method::Method;
use crate::multi_start::multi_start;
use crate::problem::Problem;
use crate::solve::solve;

/// Boxes examined between two looks at the best point: fixed, so that the number of threads changes nothing.
const BATCH: usize = 48;
/// Of the required gap, what a closed box may use; the rest is for the rounding of claims.
const GAP_SHARE: f64 = 0.9;
/// A closed box claims at most what the gap needs and this share leaves: a checker with other forms of the slopes
/// proves a little less than was found here.
const CLAIMED_SHARE: f64 = 0.97;

/// The greatest number of divisions between two attempts at a bound of second order.
const MAX_WAIT: u8 = 6;

/// Bounds of second order are tried in every batch while at least one of this many closes its box, else in one batch
/// of [`TRIAL_BATCHES`].
const MAX_TRIED_PER_CLOSED: u64 = 8;
const MIN_TRIED: u64 = 64;
const TRIAL_BATCHES: u64 = 16;

/// A box that is still open.
struct Open {
    id: u64,
    bound: f64,
    weights: Weights,
    x: Vec<Interval>,
    backoff: Backoff,
}

/// Bounds of second order are expensive: the more of them failed on the way to a box, the fewer are tried.
#[derive(Clone, Copy, Default)]
struct Backoff {
    failed: u8,
    /// Divisions until the next attempt.
    wait: u8,
}

impl Backoff {
    /// After the division of a box, for which such a bound was tried or not.
    fn after(self, tried: bool) -> Self {
        if !tried {
            return Self {
                wait: self.wait.saturating_sub(1),
                ..self
            };
        }
        let failed = (self.failed + 1).min(MAX_WAIT);
        Self {
            failed,
            wait: failed,
        }
    }
}

/// What bounds of second order brought over the whole search, the last batches first.
#[derive(Default)]
struct SecondOrderYield {
    tried: u64,
    closed: u64,
    batches: u64,
}

impl SecondOrderYield {
    /// Are they tried in the next batch?
    fn is_worthwhile(&mut self) -> bool {
        self.batches += 1;
        if self.batches.is_multiple_of(TRIAL_BATCHES) {
            (self.tried, self.closed) = (self.tried / 2, self.closed / 2);
            return true;
        }
        self.tried < MIN_TRIED || self.closed * MAX_TRIED_PER_CLOSED >= self.tried
    }

    fn add(&mut self, examined: &[Examined]) {
        for result in examined.iter().filter(|result| result.tried_second_order) {
            self.tried += 1;
            self.closed += u64::from(matches!(result.end, End::Closed));
        }
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Open {}
impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Open {
    /// The lowest bound first, then the oldest.
    fn cmp(&self, other: &Self) -> Ordering {
        other
            .bound
            .total_cmp(&self.bound)
            .then(other.id.cmp(&self.id))
    }
}

/// The best point so far.
struct Best {
    x: Vec<f64>,
    level: f64,
    violation: f64,
}

pub(super) struct Search<'a, 's> {
    pub(super) problem: &'a Problem<'a>,
    pub(super) method: &'a Method,
    pub(super) settings: &'a CertifySettings,
    pub(super) rows: &'a Rows,
    /// The rows without divisors, where one may vanish.
    pub(super) cleared: Option<&'a Rows>,
    pub(super) proof: Proof<'a, 's>,
}

impl Search<'_, '_> {
    /// γ and the worst violation at a point; `None` where a row has no value or is violated by more than the tolerance.
    fn at_point(&self, x: &[f64]) -> Option<Best> {
        let tolerance = self.settings.solve.constraint_tolerance;
        let (level, violation) = self.rows.level_at(x, tolerance)?;
        Some(Best {
            x: x.to_vec(),
            level,
            violation,
        })
    }

    fn consider(&self, best: &mut Option<Best>, x: &[f64]) {
        if let Some(found) = self.at_point(x)
            && best.as_ref().is_none_or(|b| found.level < b.level)
        {
            *best = Some(found);
        }
    }

    /// A local solve from a point.
    fn polish(&self, best: &mut Option<Best>, start: &[f64]) {
        if let Ok(problem) = self.problem.from_start(start)
            && let Ok(solution) = solve(&problem, self.method, &self.settings.solve)
        {
            self.consider(best, &solution.x[..self.rows.dimension()]);
        }
    }

    fn gap_at(&self, level: f64) -> f64 {
        self.settings.gap * (1.0 + level.abs())
    }

    /// What a box must reach to be closed.
    fn target(&self, best: Option<&Best>) -> f64 {
        best.map_or(f64::INFINITY, |b| {
            b.level - GAP_SHARE * self.gap_at(b.level)
        })
    }

    /// The best of the candidates and of the local solves.
    fn first(&self) -> Option<Best> {
        let mut best = None;
        for candidate in &self.settings.candidates {
            self.consider(&mut best, candidate);
        }
        // no starts are refused
        if let Ok(found) = multi_start(
            self.problem,
            self.method,
            &self.settings.solve,
            self.settings.starts,
            self.settings.seed,
        ) {
            for run in &found.runs {
                self.consider(&mut best, &run.x[..self.rows.dimension()]);
            }
        }
        best
    }

    /// What may be claimed of all boxes that are not closed.
    fn lowest(&self, heap: &BinaryHeap<Open>, stuck: &[Open]) -> f64 {
        let open = heap.peek().map_or(f64::INFINITY, |o| o.bound);
        let stuck = stuck.iter().map(|o| o.bound).fold(f64::INFINITY, f64::min);
        let floor = self.rows.opposites.map_or(f64::NEG_INFINITY, |_| 0.0);
        claim(open.min(stuck).max(floor))
    }

    /// The whole box.
    fn root(&self) -> Open {
        let sides = self.rows.lower.iter().zip(&self.rows.upper);
        Open {
            id: 0,
            bound: f64::NEG_INFINITY,
            weights: Weights::default(),
            x: sides
                .map(|(low, high)| Interval::new(*low, *high))
                .collect(),
            backoff: Backoff::default(),
        }
    }

    pub(super) fn run(
        mut self,
        callback: &mut dyn FnMut(&CertifyProgress) -> ControlFlow<()>,
    ) -> Certificate {
        let began = Instant::now();
        let mut best = self.first();
        let mut heap = BinaryHeap::from([self.root()]);
        let mut next = 1_u64;
        let mut stuck: Vec<Open> = Vec::new();
        // the lowest claim among closed boxes
        let mut closed = f64::INFINITY;
        let mut boxes = 0_u64;
        let mut polish_at = 1_u64;
        let mut yields = SecondOrderYield::default();
        let status = loop {
            let lower = self.lowest(&heap, &stuck).min(closed);
            let upper = best.as_ref().map_or(f64::INFINITY, |b: &Best| b.level);
            if heap.is_empty() {
                break match &best {
                    None if stuck.is_empty() => CertifyStatus::Infeasible,
                    Some(b) if b.level - lower <= self.gap_at(b.level) => CertifyStatus::Proved,
                    _ => CertifyStatus::Precision,
                };
            }
            let progress = CertifyProgress {
                lower,
                upper,
                boxes,
                open: heap.len() as u64,
                seconds: began.elapsed().as_secs_f64(),
            };
            if callback(&progress).is_break() || self.proof.broken {
                break CertifyStatus::Stopped;
            }
            if self
                .settings
                .time_limit_s
                .is_some_and(|limit| progress.seconds >= limit)
            {
                break CertifyStatus::TimeLimit;
            }
            if boxes >= self.settings.max_boxes {
                break CertifyStatus::BoxLimit;
            }
            let target = self.target(best.as_ref());
            let mut batch: Vec<Open> = Vec::with_capacity(BATCH);
            while batch.len() < BATCH
                && let Some(open) = heap.pop()
            {
                batch.push(open);
            }
            let (rows, cleared) = (self.rows, self.cleared);
            let at = best.as_ref().map(|b| b.x.clone());
            let aim = Aim {
                target,
                tolerance: self.settings.solve.constraint_tolerance,
                best: at.as_deref(),
            };
            let second_order = yields.is_worthwhile();
            let examined: Vec<Examined> = batch
                .par_iter()
                .map_init(Examiner::default, |examiner, open| {
                    examiner.examine(
                        rows,
                        cleared,
                        &open.x,
                        &aim,
                        second_order && open.backoff.wait == 0,
                    )
                })
                .collect();
            yields.add(&examined);
            boxes += batch.len() as u64;
            for result in &examined {
                if result.middle_level < best.as_ref().map_or(f64::INFINITY, |b| b.level) {
                    self.consider(&mut best, &result.middle);
                }
            }
            if boxes >= polish_at && self.settings.starts > 0 {
                polish_at = polish_at.saturating_mul(2).max(boxes);
                if let Some(first) = examined.first() {
                    let middle: Vec<f64> = first.rest.iter().map(|x| x.middle()).collect();
                    self.polish(&mut best, &middle);
                }
            }
            let cap = best.as_ref().map_or(f64::INFINITY, |b| {
                b.level - CLAIMED_SHARE * self.gap_at(b.level)
            });
            for (open, result) in batch.into_iter().zip(examined) {
                closed =
                    closed.min(self.enter(open, result, cap, &mut heap, &mut stuck, &mut next));
            }
        };
        // what is still open is claimed as far as it is known
        let mut rest = heap.into_vec();
        rest.append(&mut stuck);
        rest.sort_by_key(|open| open.id);
        for open in rest {
            closed = closed.min(self.close(&open));
        }
        self.certificate(status, closed, best, boxes, began.elapsed().as_secs_f64())
    }

    fn certificate(
        mut self,
        status: CertifyStatus,
        lower: f64,
        best: Option<Best>,
        boxes: u64,
        seconds: f64,
    ) -> Certificate {
        let (x, upper, violation) = best.map_or((None, f64::INFINITY, 0.0), |b| {
            (Some(b.x), b.level, b.violation)
        });
        let at = x.as_deref().unwrap_or_default();
        self.proof.end(status.name(), lower, upper, at, violation);
        Certificate {
            status,
            lower,
            upper,
            x,
            violation,
            boxes,
            seconds,
        }
    }

    /// Enters a box that is claimed as it is; returns the claim.
    fn close(&mut self, open: &Open) -> f64 {
        // the bound may be that of the box from which this one was divided
        let mut bounder = Bounder::default();
        let own = bounder.bound(self.rows, &open.weights, &open.x);
        let trivial = self.rows.nonnegative().filter(|_| own < 0.0);
        let (bound, weights) = match &trivial {
            Some(weights) => (bounder.bound(self.rows, weights, &open.x), weights),
            None => (own, &open.weights),
        };
        let bound = claim(bound);
        self.proof.leaf(open.id, bound, weights);
        bound
    }

    /// Enters what became of a box; returns the lowest claim of what was closed.
    fn enter(
        &mut self,
        open: Open,
        result: Examined,
        cap: f64,
        heap: &mut BinaryHeap<Open>,
        stuck: &mut Vec<Open>,
        next: &mut u64,
    ) -> f64 {
        let mut lowest = f64::INFINITY;
        let mut id = open.id;
        let mut pair = || {
            *next += 2;
            (*next - 2, *next - 1)
        };
        for trim in &result.trims {
            let (below, above) = pair();
            self.proof
                .divided(id, trim.variable, trim.at, (below, above));
            let (leaf, rest) = if trim.above {
                (above, below)
            } else {
                (below, above)
            };
            let bound = claim(trim.bound.min(cap));
            self.proof.leaf(leaf, bound, &trim.weights);
            lowest = lowest.min(bound);
            id = rest;
        }
        if matches!(result.end, End::Closed) {
            let bound = claim(result.bound.min(cap));
            self.proof.leaf(id, bound, &result.weights);
            return lowest.min(bound);
        }
        // a bound of the parent holds for its parts
        let (bound, weights) = if result.bound >= open.bound || open.weights.rows.is_empty() {
            (result.bound, result.weights)
        } else {
            (open.bound, open.weights)
        };
        match result.end {
            End::Closed => {}
            End::Stuck => stuck.push(Open {
                id,
                bound,
                weights,
                x: result.rest,
                backoff: open.backoff,
            }),
            End::Divided { variable, at } => {
                let (below, above) = pair();
                self.proof.divided(id, variable, at, (below, above));
                let side = result.rest[variable];
                for (id, part) in [
                    (below, Interval::new(side.low(), at)),
                    (above, Interval::new(at, side.high())),
                ] {
                    let mut x = result.rest.clone();
                    x[variable] = part;
                    heap.push(Open {
                        id,
                        bound,
                        weights: weights.clone(),
                        x,
                        backoff: open.backoff.after(result.tried_second_order),
                    });
                }
            }
        }
        lowest
    }
}

#[cfg(test)]
#[path = "search_tests.rs"]
mod tests;
