//! Proof of a front of two objectives: how much better any feasible point can be than the points that are listed.
//!
//! Every feasible point lies above one of a few corners (c_1, c_2): f_1 ≥ c_1 and f_2 ≥ c_2. The first corner holds the
//! least value of each objective alone, proved by branch and bound. A corner is cut at f_1 = a (or f_2 = a): the proved
//! least f_2 of the points with f_1 ≤ a is a corner of its own, and (a, c_2) is one for the others. What a corner leaves
//! open is the least of max_k (p_k − c_k)/range_k over the listed points p. Source: the cells are those of box algorithms for discrete fronts (Hamacher,
//! Pedersen & Ruzika 2007, Oper. Res. Lett. 35), with lower bounds of continuous problems in place of exact solutions.

use std::ops::ControlFlow;
use std::time::Instant;

use super::proof::{number, numbers, written};
use super::rows::Rows;
use super::{
    Certificate, CertifyError, CertifyProgress, CertifySettings, CertifyStatus, ProofSink,
    certify_with,
};
use crate::error::Error;
use crate::method::Method;
use crate::problem::Problem;

/// Of the required tolerance, what the proof of one cut may leave open.
const CUT_GAP_SHARE: f64 = 0.2;
/// The gap of the first two proofs where no candidate shows the range of the front.
const FIRST_GAP: f64 = 1e-3;
/// A range counts as at least this, times 1 + |f|.
const MIN_RANGE: f64 = 1e-4;
/// A cut lies at least this share of a cell away from its ends.
const CUT_MARGIN: f64 = 0.2;
/// Of the time that is left, what one proof may take.
const TIME_SHARE: f64 = 0.25;
/// No front of two objectives is proved with more cuts.
const MAX_CUTS: usize = 2000;

/// A point of a front with its two objectives, both minimised and rounded up.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ProvedPoint {
    /// The variables.
    pub x: Vec<f64>,
    /// Objective values; of a group of objectives the greatest.
    pub objectives: [f64; 2],
}

/// What is proved about a front of two objectives.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FrontCertificate {
    /// How the search ended: `Proved` where the tolerance is reached.
    pub status: CertifyStatus,
    /// For every feasible point there is a listed one that is worse by at most this in each objective.
    pub tolerance: [f64; 2],
    /// The same as a share of the ranges of the listed points.
    pub share: f64,
    /// The listed points, none better than another, by the first objective.
    pub points: Vec<ProvedPoint>,
    /// Every feasible point lies above one of these in both objectives; by the first objective.
    pub corners: Vec<[f64; 2]>,
    /// Proofs by branch and bound.
    pub proofs: usize,
    /// Boxes examined in all of them.
    pub boxes: u64,
    /// Time taken, s.
    pub seconds: f64,
}

/// Points that may be good where one objective is minimised by a method, for the proofs of a front.
pub type Suggest<'s> = dyn FnMut(&Method) -> Vec<Vec<f64>> + 's;

/// What [`certify_front`] calls and fills.
pub struct FrontWatch<'w> {
    /// Called after every batch of boxes; may stop the search.
    pub callback: &'w mut dyn FnMut(&CertifyProgress) -> ControlFlow<()>,
    /// Called before each proof for further candidates.
    pub suggest: &'w mut Suggest<'w>,
    /// Takes the proofs, one log after the other.
    pub proof: Option<&'w mut ProofSink<'w>>,
}

/// Proves how far a front of two objectives may lie below the points that are listed: to `settings.gap` as a share of the
/// range of each objective.
///
/// `groups` says for each objective of the problem whether it counts to the first (0) or the second (1): the greatest of a
/// group is what is minimised. `settings.candidates` are points that may be listed.
///
/// ```
/// use grouser_opt::{CertifySettings, Exact, FrontWatch, Functions, Problem, ProblemParams, Variable, certify_front};
/// use grouser_real::Scalar;
/// use std::ops::ControlFlow;
///
/// /// √f_1 + √f_2 = 2 along the front.
/// struct Pair;
/// impl Functions for Pair {
///     fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
///         f[0] = x[0].square();
///         f[1] = (x[0] - R::from_f64(2.0)).square();
///     }
/// }
/// let params = ProblemParams::new(&[1.0], 2, Exact(Pair))
///     .variables([Variable::bounded("x", 1.0, -1.0, 3.0)]);
/// let mut settings = CertifySettings::default();
/// settings.gap = 0.1;
/// let watch = FrontWatch {
///     callback: &mut |_| ControlFlow::Continue(()),
///     suggest: &mut |_| Vec::new(),
///     proof: None,
/// };
/// let front = certify_front(&Problem::new(params)?, &[0, 1], &settings, watch)?;
/// assert!(front.status.is_proved() && front.share <= 0.1);
/// # Ok::<(), grouser_opt::CertifyError>(())
/// ```
///
/// # Errors
/// [`CertifyError`]: as [`certify`](crate::certify()); groups that are not one for each objective, or with a group that is empty.
pub fn certify_front(
    problem: &Problem<'_>,
    groups: &[usize],
    settings: &CertifySettings,
    watch: FrontWatch<'_>,
) -> Result<FrontCertificate, CertifyError> {
    Error::check_length("groups", groups.len(), problem.objectives().len())?;
    for &group in groups {
        Error::check_range("a group of objectives", group as f64, 0.0, 1.0)?;
    }
    settings.solve.check()?;
    Error::check_range("gap", settings.gap, 1e-6, 1.0)?;
    let mut search = FrontSearch {
        problem,
        groups,
        settings,
        rows: [
            Rows::new(problem, &least_of(groups, 0, None))?,
            Rows::new(problem, &least_of(groups, 1, None))?,
        ],
        points: Vec::new(),
        range: [1.0; 2],
        proofs: 0,
        boxes: 0,
        began: Instant::now(),
        logged: 0,
        watch,
    };
    for candidate in &settings.candidates {
        search.list(candidate);
    }
    search.log(&format!(
        "{{\"format\":\"grouser-front\",\"version\":1{}}}",
        written(settings.written.as_ref())
    ));
    search.run()
}

/// The method that minimises one group, where the other is at most a limit, if any.
fn least_of(groups: &[usize], group: usize, limit: Option<f64>) -> Method {
    let counts = |other: &usize| f64::from(u8::from(*other == group));
    let weights: Vec<f64> = groups.iter().map(counts).collect();
    match limit {
        None => Method::Chebyshev {
            ideal: vec![0.0; groups.len()],
            weights,
        },
        Some(limit) => Method::Attain {
            goals: weights.iter().map(|w| (1.0 - w) * limit).collect(),
            weights,
        },
    }
}

struct FrontSearch<'a, 'w> {
    problem: &'a Problem<'a>,
    groups: &'a [usize],
    settings: &'a CertifySettings,
    /// The rows of each objective alone.
    rows: [Rows; 2],
    points: Vec<ProvedPoint>,
    range: [f64; 2],
    proofs: usize,
    boxes: u64,
    began: Instant,
    /// Bytes of the log.
    logged: u64,
    watch: FrontWatch<'w>,
}

/// Is there nothing left for further proofs?
fn ends_a_front(status: CertifyStatus) -> bool {
    matches!(status, CertifyStatus::Stopped | CertifyStatus::ProofLimit)
}

/// A corner above which feasible points may lie, and whether its cut failed to move it.
struct Corner {
    at: [f64; 2],
    is_stuck: bool,
}

impl FrontSearch<'_, '_> {
    fn run(mut self) -> Result<FrontCertificate, CertifyError> {
        self.set_range();
        let mut ideal = [f64::NEG_INFINITY; 2];
        let mut corners = Vec::new();
        let mut status = None;
        for axis in [0, 1] {
            let known = self.points.len() > 1;
            let proof = self.prove(axis, None, known)?;
            ideal[axis] = proof.lower;
            if proof.status == CertifyStatus::Infeasible {
                status = Some(CertifyStatus::Infeasible);
                break;
            }
            if ends_a_front(proof.status) {
                status = Some(proof.status);
            }
        }
        if status != Some(CertifyStatus::Infeasible) {
            corners.push(Corner {
                at: ideal,
                is_stuck: false,
            });
        }
        self.set_range();
        let status = match status {
            Some(status) => status,
            None => self.cut_all(&mut corners)?,
        };
        let log_of = |front: &FrontCertificate, tolerance: f64| {
            let points: Vec<String> = front
                .points
                .iter()
                .map(|p| {
                    format!(
                        "[{},{}]",
                        numbers(p.x.iter().copied()),
                        numbers(p.objectives)
                    )
                })
                .collect();
            let corners: Vec<String> = front.corners.iter().map(|c| numbers(*c)).collect();
            format!(
                "{{\"front\":\"{}\",\"tolerance\":{},\"violation\":{},\"points\":[{}],\"corners\":[{}]}}",
                front.status.name(),
                numbers(front.tolerance),
                number(tolerance),
                points.join(","),
                corners.join(",")
            )
        };
        let front = self.certificate(status, &corners);
        let line = log_of(&front, self.settings.solve.constraint_tolerance);
        self.log(&line);
        Ok(front)
    }

    /// Cuts corners until none leaves more open than the tolerance.
    fn cut_all(&mut self, corners: &mut Vec<Corner>) -> Result<CertifyStatus, CertifyError> {
        for _ in 0..MAX_CUTS {
            let worst = corners
                .iter()
                .enumerate()
                .filter(|(_, corner)| !corner.is_stuck)
                .map(|(place, corner)| (self.open_share(corner.at), place))
                .max_by(|a, b| a.0.total_cmp(&b.0));
            let is_open = worst.is_some_and(|(share, _)| share > self.settings.gap);
            let Some((_, place)) = worst.filter(|_| is_open) else {
                let all = corners
                    .iter()
                    .all(|c| self.open_share(c.at) <= self.settings.gap);
                return Ok(if all {
                    CertifyStatus::Proved
                } else {
                    CertifyStatus::TimeLimit
                });
            };
            if self.seconds_left().is_some_and(|left| left <= 0.0) {
                return Ok(CertifyStatus::TimeLimit);
            }
            let at = corners[place].at;
            let Some((axis, limit)) = self.cut_of(at) else {
                corners[place].is_stuck = true;
                continue;
            };
            let proof = self.prove(1 - axis, Some((at, limit)), true)?;
            let mut below = at;
            below[1 - axis] = below[1 - axis].max(proof.lower);
            corners[place].at[axis] = limit;
            if below[1 - axis] < f64::INFINITY {
                corners.push(Corner {
                    at: below,
                    is_stuck: false,
                });
            }
            if ends_a_front(proof.status) {
                return Ok(proof.status);
            }
        }
        Ok(CertifyStatus::BoxLimit)
    }

    /// Along which objective and where a corner is cut: across the side of its cell that is shorter in ranges, at a listed
    /// point where one lies in its middle.
    fn cut_of(&self, corner: [f64; 2]) -> Option<(usize, f64)> {
        // a cell ends at the first listed point that leaves less than the tolerance open on the other side
        let end = |k: usize| {
            let other = 1 - k;
            let reach = corner[other] + self.settings.gap * self.range[other];
            let close = self.points.iter().filter(|p| p.objectives[other] <= reach);
            close.map(|p| p.objectives[k]).fold(f64::INFINITY, f64::min)
        };
        let ends = [end(0), end(1)];
        let side = |k: usize| (ends[k] - corner[k]) / self.range[k];
        let axis = usize::from(side(1) < side(0));
        let length = ends[axis] - corner[axis];
        if !length.is_finite() {
            return None;
        }
        let middle = corner[axis] + 0.5 * length;
        let margin = (0.5 - CUT_MARGIN) * length;
        let distance = |p: &&ProvedPoint| (p.objectives[axis] - middle).abs();
        let listed = self.points.iter().filter(|p| distance(p) <= margin);
        let listed = listed.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let at = listed.map_or(middle, |p| p.objectives[axis]);
        (corner[axis] < at && at < ends[axis]).then_some((axis, at))
    }

    /// By how much a feasible point above the corner can be better than every listed one, as a share of the ranges.
    fn open_share(&self, corner: [f64; 2]) -> f64 {
        let share = |p: &ProvedPoint| {
            let worse = |k: usize| (p.objectives[k] - corner[k]) / self.range[k];
            worse(0).max(worse(1)).max(0.0)
        };
        self.points.iter().map(share).fold(f64::INFINITY, f64::min)
    }

    /// A line of the proof between the logs of the proofs that it joins.
    fn log(&mut self, line: &str) {
        if let Some(sink) = &mut self.watch.proof {
            // a sink that refuses a line refuses the next proof's first one too, which ends the search
            let _ = sink(line);
            self.logged += line.len() as u64 + 1;
        }
    }

    fn seconds_left(&self) -> Option<f64> {
        let limit = self.settings.time_limit_s?;
        Some(limit - self.began.elapsed().as_secs_f64())
    }

    /// Those of the proof of one objective's least value.
    fn settings_of(
        &mut self,
        method: &Method,
        axis: usize,
        is_range_known: bool,
    ) -> CertifySettings {
        let mut settings = self.settings.clone();
        settings.candidates = self.points.iter().map(|p| p.x.clone()).collect();
        settings.candidates.extend((self.watch.suggest)(method));
        settings.gap = if is_range_known {
            let largest = self.points.iter().map(|p| p.objectives[axis].abs());
            let size = 1.0 + largest.fold(0.0, f64::max);
            (CUT_GAP_SHARE * self.settings.gap * self.range[axis] / size).clamp(1e-12, 1.0)
        } else {
            FIRST_GAP
        };
        settings.max_proof_bytes = settings.max_proof_bytes.saturating_sub(self.logged);
        settings.written = None;
        settings.time_limit_s = self.seconds_left().map(|left| left.max(0.0) * TIME_SHARE);
        settings
    }

    /// The least value of one objective; where a corner is cut, of the points whose other objective is at most a limit.
    fn prove(
        &mut self,
        axis: usize,
        cut: Option<([f64; 2], f64)>,
        is_range_known: bool,
    ) -> Result<Certificate, CertifyError> {
        let method = least_of(self.groups, axis, cut.map(|(_, limit)| limit));
        self.log(&match cut {
            None => format!("{{\"least\":{axis},\"corner\":null,\"at\":null}}"),
            Some((corner, limit)) => format!(
                "{{\"least\":{axis},\"corner\":{},\"at\":{}}}",
                numbers(corner),
                number(limit)
            ),
        });
        let settings = self.settings_of(&method, axis, is_range_known);
        let (boxes, began) = (self.boxes, self.began);
        let callback = &mut *self.watch.callback;
        let mut progress = |inner: &CertifyProgress| {
            callback(&CertifyProgress {
                boxes: boxes + inner.boxes,
                seconds: began.elapsed().as_secs_f64(),
                ..*inner
            })
        };
        let is_logged = self.watch.proof.is_some();
        let mut proof = self.watch.proof.as_deref_mut();
        let logged = &mut self.logged;
        let mut forward = |line: &str| match &mut proof {
            Some(sink) => {
                *logged += line.len() as u64 + 1;
                sink(line)
            }
            None => ControlFlow::Continue(()),
        };
        let sink: Option<&mut ProofSink<'_>> = if is_logged { Some(&mut forward) } else { None };
        let found = certify_with(self.problem, &method, &settings, &mut progress, sink)?;
        self.proofs += 1;
        self.boxes += found.boxes;
        for candidate in settings.candidates.iter().chain(&found.x) {
            self.list(candidate);
        }
        Ok(found)
    }

    /// Lists a point that meets the constraints, unless a listed one is as good; drops those that it beats.
    fn list(&mut self, x: &[f64]) {
        let tolerance = self.settings.solve.constraint_tolerance;
        let [first, second] = &self.rows;
        let level = |rows: &Rows| rows.level_at(x, tolerance).map(|(level, _)| level);
        let (Some(a), Some(b)) = (level(first), level(second)) else {
            return;
        };
        let new = [a, b];
        let is_beaten = |by: [f64; 2], p: [f64; 2]| by[0] <= p[0] && by[1] <= p[1];
        if self.points.iter().any(|p| is_beaten(p.objectives, new)) {
            return;
        }
        self.points.retain(|p| !is_beaten(new, p.objectives));
        self.points.push(ProvedPoint {
            x: x.to_vec(),
            objectives: new,
        });
        self.points
            .sort_by(|a, b| a.objectives[0].total_cmp(&b.objectives[0]));
    }

    fn set_range(&mut self) {
        for k in [0, 1] {
            let all = || self.points.iter().map(|p| p.objectives[k]);
            let (low, high) = (
                all().fold(f64::INFINITY, f64::min),
                all().fold(f64::NEG_INFINITY, f64::max),
            );
            let size = 1.0 + low.abs().max(high.abs());
            if low <= high {
                self.range[k] = (high - low).max(MIN_RANGE * size);
            }
        }
    }

    fn certificate(&self, status: CertifyStatus, corners: &[Corner]) -> FrontCertificate {
        let share = corners
            .iter()
            .map(|corner| self.open_share(corner.at))
            .fold(0.0, f64::max);
        let mut corners: Vec<[f64; 2]> = corners.iter().map(|c| c.at).collect();
        corners.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        // what lies above a corner lies above each one that is lower in both
        let mut lowest = f64::INFINITY;
        corners.retain(|corner| {
            let is_needed = corner[1] < lowest;
            lowest = lowest.min(corner[1]);
            is_needed
        });
        FrontCertificate {
            status,
            tolerance: self.range.map(|range| share * range),
            share,
            corners,
            proofs: self.proofs,
            boxes: self.boxes,
            seconds: self.began.elapsed().as_secs_f64(),
            points: self.points.clone(),
        }
    }
}

#[cfg(test)]
#[path = "front_tests.rs"]
mod tests;
