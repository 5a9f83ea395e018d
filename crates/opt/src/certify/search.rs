//! Best-first branch and bound.

use std::ops::ControlFlow;
use std::time::Instant;

use grouser_real::Interval;
use rayon::prelude::*;

use super::bound::{Bounder, Weights};
use super::open::{Backoff, Open, OpenBoxes};
use super::process::{Aim, End, Examined, Examiner};
use super::proof::{Proof, claim};
use super::reach::Reach;
use super::rows::Rows;
use super::{Certificate, CertifyProgress, CertifySettings, CertifyStatus};
use crate::callback::Progress;
use crate::method::Method;
use crate::multi_start::multi_start_with;
use crate::problem::Problem;
use crate::solve::solve_with;

/// Boxes examined between two looks at the best point: fixed, so that the number of threads changes nothing.
const BATCH: usize = 48;
/// Of the required gap, what a closed box may use; the rest is for the rounding of claims.
const GAP_SHARE: f64 = 0.9;
/// A closed box claims at most what the gap needs and this share leaves: a checker with other forms of the slopes
/// proves a little less than was found here.
const CLAIMED_SHARE: f64 = 0.97;

/// The local solves that come first end after this share of the time.
const STARTS_TIME_SHARE: f64 = 0.5;
/// Boxes that are bounded side by side at the end: some hundred kilobytes.
const CLOSING_BOXES: usize = 1024;

/// Bounds of second order are tried in every batch while at least one of this many closes its box, else in one batch
/// of [`TRIAL_BATCHES`].
const MAX_TRIED_PER_CLOSED: u64 = 8;
const MIN_TRIED: u64 = 64;
const TRIAL_BATCHES: u64 = 16;

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

    /// What a local solve calls: it ends so many seconds after the beginning.
    fn until(began: Instant, end_s: f64) -> impl FnMut(&Progress<'_>) -> ControlFlow<()> {
        move |_| {
            if began.elapsed().as_secs_f64() >= end_s {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        }
    }

    /// Which limit the search has reached, if any.
    fn limit(&self, reach: &Reach, open: &OpenBoxes) -> Option<CertifyStatus> {
        let settings = self.settings;
        let mut end_bytes = 0;
        if self.proof.sink.is_some() {
            // the next batch may add as much as any, and as many leaves
            let leaves = (open.count() as u64 + 2 * BATCH as u64) * self.proof.leaf_bytes;
            end_bytes = self.proof.bytes + 2 * reach.batch_bytes + leaves;
        }
        if reach.seconds() >= reach.last_begin_s(settings.time_limit_s, open.count()) {
            return Some(CertifyStatus::TimeLimit);
        }
        let limits = [
            (reach.boxes, settings.max_boxes, CertifyStatus::BoxLimit),
            (
                open.bytes,
                settings.max_open_bytes,
                CertifyStatus::MemoryLimit,
            ),
            (
                end_bytes,
                settings.max_proof_bytes,
                CertifyStatus::ProofLimit,
            ),
        ];
        let reached = limits.into_iter().find(|(used, limit, _)| used >= limit);
        reached.map(|(_, _, status)| status)
    }

    /// A local solve from a point.
    fn polish(&self, best: &mut Option<Best>, start: &[f64], began: Instant, end_s: f64) {
        if let Ok(problem) = self.problem.from_start(start)
            && let Ok(solution) = solve_with(
                &problem,
                self.method,
                &self.settings.solve,
                &mut Self::until(began, end_s),
            )
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
    fn first(&self, began: Instant) -> Option<Best> {
        let mut best = None;
        for candidate in &self.settings.candidates {
            self.consider(&mut best, candidate);
        }
        let limit_s = self.settings.time_limit_s.unwrap_or(f64::INFINITY);
        // no starts are refused
        if let Ok(found) = multi_start_with(
            self.problem,
            self.method,
            &self.settings.solve,
            (self.settings.starts, self.settings.seed),
            &mut Self::until(began, STARTS_TIME_SHARE * limit_s),
        ) {
            for run in &found.runs {
                self.consider(&mut best, &run.x[..self.rows.dimension()]);
            }
        }
        best
    }

    /// What may be claimed of all boxes that are not closed.
    fn lowest(&self, boxes: &OpenBoxes) -> f64 {
        let open = boxes.heap.peek().map_or(f64::INFINITY, |o| o.bound);
        let stuck = boxes.stuck.iter().map(|o| o.bound);
        let stuck = stuck.fold(f64::INFINITY, f64::min);
        let floor = self.rows.opposites.map_or(f64::NEG_INFINITY, |_| 0.0);
        claim(open.min(stuck).max(floor), self.settings.gap)
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
        began: Instant,
        callback: &mut dyn FnMut(&CertifyProgress) -> ControlFlow<()>,
    ) -> Certificate {
        let mut best = self.first(began);
        let mut open = OpenBoxes::default();
        open.push(self.root());
        let mut next = 1_u64;
        // the lowest claim among closed boxes
        let mut closed = f64::INFINITY;
        let mut reach = Reach::new(began);
        let mut polish_at = 1_u64;
        let mut yields = SecondOrderYield::default();
        let status = loop {
            let lower = self.lowest(&open).min(closed);
            let upper = best.as_ref().map_or(f64::INFINITY, |b: &Best| b.level);
            if open.heap.is_empty() {
                break match &best {
                    // a point within the tolerances is none that meets all constraints
                    _ if lower == f64::INFINITY && open.stuck.is_empty() => {
                        CertifyStatus::Infeasible
                    }
                    Some(b) if b.level - lower <= self.gap_at(b.level) => CertifyStatus::Proved,
                    _ => CertifyStatus::Precision,
                };
            }
            let progress = CertifyProgress {
                lower,
                upper,
                boxes: reach.boxes,
                open: open.heap.len() as u64,
                seconds: reach.seconds(),
            };
            if callback(&progress).is_break() || self.proof.broken {
                break CertifyStatus::Stopped;
            }
            if let Some(status) = self.limit(&reach, &open) {
                break status;
            }
            let written = self.proof.bytes;
            let target = self.target(best.as_ref());
            let mut batch: Vec<Open> = Vec::with_capacity(BATCH);
            while batch.len() < BATCH
                && let Some(open) = open.pop()
            {
                batch.push(open);
            }
            let at = best.as_ref().map(|b| b.x.clone());
            let aim = Aim {
                target,
                tolerance: self.settings.solve.constraint_tolerance,
                best: at.as_deref(),
            };
            let last_s = reach.last_begin_s(self.settings.time_limit_s, open.count() + batch.len());
            let mut examined =
                self.examine(&batch, &aim, yields.is_worthwhile(), (&mut reach, last_s));
            let rest = batch.split_off(examined.len());
            for late in rest {
                open.push(late);
            }
            yields.add(&examined);
            for result in &examined {
                if result.middle_level < best.as_ref().map_or(f64::INFINITY, |b| b.level) {
                    self.consider(&mut best, &result.middle);
                }
            }
            if reach.boxes >= polish_at && self.settings.starts > 0 {
                polish_at = polish_at.saturating_mul(2).max(reach.boxes);
                if let Some(first) = examined.first() {
                    let middle: Vec<f64> = first.rest.iter().map(|x| x.middle()).collect();
                    self.polish(&mut best, &middle, began, last_s);
                }
            }
            let cap = best.as_ref().map_or(f64::INFINITY, |b| {
                b.level - CLAIMED_SHARE * self.gap_at(b.level)
            });
            let before = Instant::now();
            for (own, result) in batch.into_iter().zip(examined.drain(..)) {
                closed = closed.min(self.enter(own, result, cap, &mut open, &mut next));
            }
            if let (Some(own), true) = (open.heap.peek(), self.proof.sink.is_some()) {
                reach.entered(before.elapsed().as_secs_f64());
                let before = Instant::now();
                Self::closing(self.rows, self.settings.gap, own);
                reach.bounded(before.elapsed().as_secs_f64());
            }
            reach.batch_bytes = reach.batch_bytes.max(self.proof.bytes - written);
        };
        let lower = closed.min(self.end(open));
        // the end may have proved more of the open boxes
        let status = match &best {
            Some(b) if !status.is_proved() && b.level - lower <= self.gap_at(b.level) => {
                CertifyStatus::Proved
            }
            _ => status,
        };
        self.certificate(status, lower, best, reach.boxes, reach.seconds())
    }

    /// Examines boxes: each that begins before `last_s`.
    fn examine(
        &self,
        batch: &[Open],
        aim: &Aim<'_>,
        second_order: bool,
        (reach, last_s): (&mut Reach, f64),
    ) -> Vec<Examined> {
        let (rows, cleared, began) = (self.rows, self.cleared, reach.began);
        let begun_s = reach.seconds();
        let results: Vec<Option<(Examined, f64)>> = batch
            .par_iter()
            .map_init(Examiner::default, |examiner, open| {
                let second_order = second_order && open.backoff.wait == 0;
                let before_s = began.elapsed().as_secs_f64();
                (before_s < last_s).then(|| {
                    let examined = examiner.examine(rows, cleared, &open.x, aim, second_order);
                    (examined, began.elapsed().as_secs_f64() - before_s)
                })
            })
            .collect();
        let (examined, seconds): (Vec<Examined>, Vec<f64>) =
            results.into_iter().map_while(|result| result).unzip();
        reach.examined(&seconds, began.elapsed().as_secs_f64() - begun_s);
        examined
    }

    /// Enters what is still open, as far as it is known; returns the lowest claim.
    fn end(&mut self, open: OpenBoxes) -> f64 {
        if self.proof.sink.is_none() {
            return self.lowest(&open);
        }
        let mut rest = open.heap.into_vec();
        rest.extend(open.stuck);
        rest.sort_by_key(|open| open.id);
        let (mut lowest, rows, gap) = (f64::INFINITY, self.rows, self.settings.gap);
        for some in rest.chunks(CLOSING_BOXES) {
            let ends: Vec<(f64, Weights)> = some
                .par_iter()
                .map(|own| Self::closing(rows, gap, own))
                .collect();
            for (own, (bound, weights)) in some.iter().zip(ends) {
                self.proof.leaf(own.id, bound, &weights);
                lowest = lowest.min(bound);
            }
        }
        lowest
    }

    /// The claim of a box that is not closed, and what proves it: the bound so far may be that of the box from which this one was
    /// divided.
    fn closing(rows: &Rows, gap: f64, open: &Open) -> (f64, Weights) {
        let mut bounder = Bounder::default();
        let own = bounder.bound(rows, &open.weights, &open.x);
        let trivial = rows.nonnegative().filter(|_| own < 0.0);
        let (bound, weights) = match trivial {
            Some(weights) => (bounder.bound(rows, &weights, &open.x), weights),
            None => (own, open.weights.clone()),
        };
        (claim(bound, gap), weights)
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

    /// Enters what became of a box; returns the lowest claim of what was closed.
    fn enter(
        &mut self,
        open: Open,
        result: Examined,
        cap: f64,
        boxes: &mut OpenBoxes,
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
            let bound = claim(trim.bound.min(cap), self.settings.gap);
            self.proof.leaf(leaf, bound, &trim.weights);
            lowest = lowest.min(bound);
            id = rest;
        }
        if matches!(result.end, End::Closed) {
            let bound = claim(result.bound.min(cap), self.settings.gap);
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
            End::Stuck => boxes.hold(Open {
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
                    boxes.push(Open {
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
