//! Fronts: the proof of how much better a design can be than those of a front.

use std::ops::ControlFlow;
use std::time::Instant;

use grouser_opt::{
    Callback, CertifyProgress, CertifySettings, CertifyStatus, FrontWatch, Measure, Method,
    Problem, ProofSink, certify_front, solve_with,
};

use crate::certificate::{end_of, goes_on};
use crate::design::{Design, Task};
use crate::error::{Error, Result};
use crate::solve::{Compromise, Trade};

/// What is proved about a front of two objectives, in the units and signs of the file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FrontProof {
    /// How the search ended.
    pub status: CertifyStatus,
    /// For every design that meets the constraints there is a listed one that is worse by at most this in each objective;
    /// ∞ where nothing is proved.
    pub tolerance: Vec<f64>,
    /// The same as a share of the ranges of the listed designs.
    pub share: f64,
    /// The listed designs, by the first objective.
    pub points: Vec<Compromise>,
    /// Every design that meets the constraints is no better than one of these in both objectives.
    pub corners: Vec<Vec<f64>>,
    /// Proofs by branch and bound.
    pub proofs: usize,
    /// Boxes examined.
    pub boxes: u64,
    /// Time taken, s.
    pub seconds: f64,
}

impl Design {
    /// Proves how much better a design can be than those of a front of two objectives: by at most `settings.gap` of the
    /// range of each objective, if that is found in time. `callback` is called after every batch of boxes and may stop the
    /// search; `proof` takes the proofs, one log after the other.
    ///
    /// # Errors
    /// As [`Design::certify`]; for a problem of another method and for more than two objectives.
    pub fn certify_front(
        &self,
        trade: &Trade,
        settings: &CertifySettings,
        callback: &mut dyn FnMut(&CertifyProgress) -> ControlFlow<()>,
        proof: Option<&mut ProofSink<'_>>,
    ) -> Result<FrontProof> {
        if self.task != Task::Pareto || self.objectives.len() != 2 {
            return Err(self.uncertified(format!(
                "only fronts of two objectives have a proof; this one has {}",
                self.objectives.len()
            )));
        }
        let began = Instant::now();
        self.check_bounds()?;
        let lifted = self.lifted()?;
        let has_joint = lifted.is_none() && self.worlds.len() > 1;
        let joint = if has_joint {
            Some(self.joint_problem()?)
        } else {
            None
        };
        let own = self.problem()?;
        let certified = lifted.as_ref().or(joint.as_ref()).unwrap_or(&own);
        let copies = certified.objectives().len() / 2;
        let order = self.solver_order();
        let groups: Vec<usize> = (0..certified.objectives().len())
            .map(|i| order[i / copies])
            .collect();
        let mut settings = settings.clone();
        let liftable = |x: &[f64]| match &lifted {
            Some(_) => self.with_entry_angles(x),
            None => Some(x.to_vec()),
        };
        let listed = trade.points.iter().filter_map(|point| liftable(&point.x));
        settings.candidates.extend(listed);
        if lifted.is_some() {
            // the kernel searches faster than the lifted problem can
            settings.starts = 0;
        }
        let searched = joint.as_ref().unwrap_or(&own);
        let before = began.elapsed().as_secs_f64();
        settings.time_limit_s = settings.time_limit_s.map(|limit| (limit - before).max(0.0));
        let until = end_of(began, &settings);
        let mut suggest = |method: &Method| {
            let goes_on = &mut goes_on(until);
            self.suggested((searched, method), trade, &liftable, goes_on)
        };
        let (mut forward, is_logged);
        let mut sink = proof;
        is_logged = sink.is_some();
        forward = |line: &str| match &mut sink {
            Some(sink) => sink(line),
            None => ControlFlow::Continue(()),
        };
        let mut watched = |progress: &CertifyProgress| callback(progress);
        let watch = FrontWatch {
            callback: &mut watched,
            suggest: &mut suggest,
            proof: if is_logged { Some(&mut forward) } else { None },
        };
        let found = certify_front(certified, &groups, &settings, watch)
            .map_err(|error| self.certify_error(error))?;
        let factors = [self.objectives[0].factor(), self.objectives[1].factor()];
        let mut points = Vec::new();
        // the kernel's values may differ from those of the rule of integration
        let mut excess = [0.0_f64; 2];
        for point in &found.points {
            let x = &point.x[..self.variables.len()];
            let objectives = self.objectives_at(&own, x);
            for k in [0, 1] {
                let value = self.minimised(k, objectives[k]);
                excess[k] = excess[k].max(value - point.objectives[k]);
            }
            points.push(Compromise {
                x: x.to_vec(),
                objectives,
                multipliers: None,
            });
        }
        let size = |k: usize| (found.tolerance[k] + excess[k]) / factors[k].abs();
        Ok(FrontProof {
            status: found.status,
            tolerance: vec![size(0), size(1)],
            share: found.share,
            points,
            corners: found
                .corners
                .iter()
                .map(|corner| {
                    let at = |k: usize| corner[k] / factors[k];
                    vec![at(0), at(1)]
                })
                .collect(),
            proofs: found.proofs,
            boxes: found.boxes,
            seconds: before + found.seconds,
        })
    }

    /// What the solver minimises of objective `k` of the file, given its value.
    fn minimised(&self, k: usize, value: f64) -> f64 {
        let scaled = value * self.objectives[k].factor();
        if self.objectives[k].absolute {
            scaled.abs()
        } else {
            scaled
        }
    }

    /// Solves by the method from the listed point that is best by it.
    fn suggested(
        &self,
        (problem, method): (&Problem<'_>, &Method),
        trade: &Trade,
        liftable: &dyn Fn(&[f64]) -> Option<Vec<f64>>,
        goes_on: &mut Callback<'_>,
    ) -> Vec<Vec<f64>> {
        let wanted = match method {
            Method::Attain { weights, .. } | Method::Chebyshev { weights, .. } => weights.len(),
            _ => 0,
        };
        let tolerance = self.settings.constraint_tolerance;
        let merit = |x: &[f64]| {
            let merit = grouser_opt::evaluate(problem, method, x).ok()?;
            (merit.violation <= tolerance).then_some(merit.utility)
        };
        if problem.objectives().len() != wanted {
            return Vec::new();
        }
        let start = trade
            .points
            .iter()
            .filter_map(|point| Some((merit(&point.x)?, &point.x)))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let found = start
            .and_then(|(_, x)| problem.from_start(x).ok())
            .and_then(|problem| solve_with(&problem, method, &self.settings, goes_on).ok());
        found
            .and_then(|solution| liftable(&solution.x[..self.variables.len()]))
            .into_iter()
            .collect()
    }

    /// Is the front that of the worst over several worlds?
    pub(crate) fn has_worst_front(&self) -> bool {
        self.task == Task::Pareto && self.worlds.len() > 1 && self.measure == Measure::WorstCase
    }

    /// An error of a certificate.
    pub(crate) fn uncertified(&self, reason: String) -> Error {
        Error::NoCertificate {
            file: self.file.clone(),
            reason,
        }
    }
}
