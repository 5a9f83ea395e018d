//! Proof that no point is better: interval branch and bound over the whole box.
//!
//! The box is divided until each part is closed: by a lower bound of the level γ that is as good as the best point
//! known, or by the proof that the part holds no feasible point. Bounds come from enclosures of the functions with
//! outward rounding, so that rounding errors cannot make a proof wrong. The best point comes from the local solver.

mod bound;
mod cleared;
mod expansion;
mod front;
mod open;
mod process;
mod proof;
mod propagate;
mod reach;
mod rows;
mod search;
mod tangent;
mod trim;

use std::ops::ControlFlow;
use std::time::Instant;

use crate::error::Error;
use crate::method::Method;
use crate::problem::Problem;
use crate::settings::Settings;

pub use front::{FrontCertificate, FrontWatch, ProvedPoint, Suggest, certify_front};
pub use proof::ProofSink;

/// How exactly and how long to search for a proof.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CertifySettings {
    /// The gap to reach: upper − lower bound ≤ this · (1 + |upper|).
    pub gap: f64,
    /// The search ends after this many seconds, local solves and the end of a log within them; the result is then that of the
    /// boxes examined so far.
    pub time_limit_s: Option<f64>,
    /// The search ends after this many boxes.
    pub max_boxes: u64,
    /// The search ends where the open boxes would take more memory, in bytes. 1e9 by default, some millions of boxes.
    pub max_open_bytes: u64,
    /// The search ends where the proof with all that is still open would be longer, in bytes. 1e9 by default.
    pub max_proof_bytes: u64,
    /// The problem as its user wrote it, which begins a proof.
    pub written: Option<WrittenProblem>,
    /// Of the local solver, whose `constraint_tolerance` is also that of the best point.
    pub solve: Settings,
    /// How many starts of the local solver come before the search; 0 for no local solves at all.
    pub starts: usize,
    /// Points that may be the best: each counts where it meets all constraints.
    pub candidates: Vec<Vec<f64>>,
    /// Seed of the starts.
    pub seed: u64,
}

impl Default for CertifySettings {
    fn default() -> Self {
        Self {
            gap: 1e-6,
            time_limit_s: None,
            max_boxes: 10_000_000,
            max_open_bytes: 1_000_000_000,
            max_proof_bytes: 1_000_000_000,
            written: None,
            solve: Settings::default(),
            starts: 16,
            candidates: Vec::new(),
            seed: 1,
        }
    }
}

/// The text of a problem, with its hash: what a proof is bound to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenProblem {
    /// The text.
    pub text: String,
    /// Its SHA-256, in hexadecimal digits.
    pub sha256: String,
}

/// How the search for a proof ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CertifyStatus {
    /// The gap is reached.
    Proved,
    /// No point of the box meets all constraints, and that is proved.
    Infeasible,
    /// The time is over.
    TimeLimit,
    /// [`CertifySettings::max_boxes`] were examined.
    BoxLimit,
    /// [`CertifySettings::max_open_bytes`] are used.
    MemoryLimit,
    /// [`CertifySettings::max_proof_bytes`] are needed.
    ProofLimit,
    /// Some boxes are as small as numbers allow, and the gap is not reached.
    Precision,
    /// The caller stopped the search.
    Stopped,
}

impl CertifyStatus {
    /// The name used in files and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Proved => "proved",
            Self::Infeasible => "infeasible",
            Self::TimeLimit => "time_limit",
            Self::BoxLimit => "box_limit",
            Self::MemoryLimit => "memory_limit",
            Self::ProofLimit => "proof_limit",
            Self::Precision => "precision",
            Self::Stopped => "stopped",
        }
    }

    /// Is there a proof?
    #[must_use]
    pub fn is_proved(self) -> bool {
        matches!(self, Self::Proved | Self::Infeasible)
    }
}

/// The state of the search between two batches of boxes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CertifyProgress {
    /// No feasible point is better than this.
    pub lower: f64,
    /// γ of the best point; ∞ where none is known.
    pub upper: f64,
    /// Boxes examined.
    pub boxes: u64,
    /// Boxes still open.
    pub open: u64,
    /// Time since the beginning, s.
    pub seconds: f64,
}

/// What is proved about the global optimum.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Certificate {
    /// How the search ended.
    pub status: CertifyStatus,
    /// No point of the box that meets all constraints has a γ below this; ∞ where no such point exists.
    pub lower: f64,
    /// γ of the best point, rounded up; ∞ where none was found.
    pub upper: f64,
    /// The best point.
    pub x: Option<Vec<f64>>,
    /// By how much the best point violates a constraint at most, rounded up.
    pub violation: f64,
    /// Boxes examined.
    pub boxes: u64,
    /// Time taken, s.
    pub seconds: f64,
}

impl Certificate {
    /// upper − lower; ∞ where one of them is not known.
    #[must_use]
    pub fn gap(&self) -> f64 {
        let gap = (self.upper - self.lower).max(0.0);
        if gap.is_nan() { f64::INFINITY } else { gap }
    }
}

/// Why there can be no certificate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CertifyError {
    /// The problem or a setting is refused.
    #[error(transparent)]
    Problem(#[from] Error),
    /// The functions cannot be enclosed over a box.
    #[error(
        "the functions of this problem are not known as formulas, so that they have no bounds over a box: a certificate \
         needs functions that do not branch on the values of the variables"
    )]
    NoFormula,
    /// A formula holds a number that is infinite or none, such as 1/0 or 0/0.
    #[error("the formula of `{function}` holds {value}, which is no finite number")]
    NotFinite {
        /// The function.
        function: String,
        /// The number.
        value: f64,
    },
}

/// Proves how good the best point of a problem is.
///
/// The constraints hold exactly in the lower bound and to `settings.solve.constraint_tolerance` at the best point.
/// With a time limit the bounds depend on the machine; without one, not even on the number of threads.
///
/// ```
/// use grouser_opt::{CertifySettings, CertifyStatus, Exact, Functions, Method, Problem, ProblemParams, Variable, certify};
/// use grouser_real::Scalar;
///
/// /// Two valleys, of which the right one is deeper.
/// struct Valleys;
/// impl Functions for Valleys {
///     fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
///         f[0] = (x[0].square() - R::ONE).square() - R::from_f64(0.1) * x[0];
///     }
/// }
/// let params = ProblemParams::new(&[-1.0], 1, Exact(Valleys))
///     .variables([Variable::bounded("x", -1.0, -2.0, 2.0)]);
/// let problem = Problem::new(params)?;
/// let certificate = certify(&problem, &Method::Minimax, &CertifySettings::default())?;
/// assert_eq!(certificate.status, CertifyStatus::Proved);
/// assert!(certificate.gap() <= 1e-6 * 1.11 && (certificate.upper + 0.100_617).abs() < 2e-6);
/// # Ok::<(), grouser_opt::CertifyError>(())
/// ```
///
/// # Errors
/// [`CertifyError`]: an unbounded variable, a setting out of its range, functions that are no formulas, numbers in
/// them that are not finite.
pub fn certify(
    problem: &Problem<'_>,
    method: &Method,
    settings: &CertifySettings,
) -> Result<Certificate, CertifyError> {
    certify_with(
        problem,
        method,
        settings,
        &mut |_| ControlFlow::Continue(()),
        None,
    )
}

/// As [`certify`], calling `callback` after every batch of boxes, and writing the proof where a sink is given.
///
/// # Errors
/// As [`certify`].
pub fn certify_with(
    problem: &Problem<'_>,
    method: &Method,
    settings: &CertifySettings,
    callback: &mut dyn FnMut(&CertifyProgress) -> ControlFlow<()>,
    proof: Option<&mut ProofSink<'_>>,
) -> Result<Certificate, CertifyError> {
    settings.solve.check()?;
    Error::check_range("gap", settings.gap, f64::MIN_POSITIVE, 1.0)?;
    if let Some(limit) = settings.time_limit_s {
        Error::check_range("time_limit_s", limit, 0.0, f64::MAX)?;
    }
    for candidate in &settings.candidates {
        Error::check_length("a candidate", candidate.len(), problem.variables().len())?;
    }
    let began = Instant::now();
    let rows = rows::Rows::new(problem, method)?;
    let mut proof = proof::Proof::new(proof);
    let names: Vec<String> = problem.variables().iter().map(|v| v.name.clone()).collect();
    proof.begin(&rows, &names, settings);
    let cleared = rows.cleared();
    let search = search::Search {
        cleared: cleared.as_ref(),
        problem,
        method,
        settings,
        rows: &rows,
        proof,
    };
    Ok(search.run(began, callback))
}
