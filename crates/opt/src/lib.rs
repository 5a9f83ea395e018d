#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! The primary types are [`Problem`], [`Method`], [`Settings`] and [`Solution`], in the order in which
//! [`solve`] meets them. Solvers are local: [`multi_start`] looks from many starts, and [`certify()`] proves
//! how good the best point over a whole box is. The crate knows nothing of wheels.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod best;
mod callback;
mod certify;
mod derivative;
mod error;
mod jacobian;
mod merit;
mod method;
mod model;
mod multi_start;
mod pareto;
mod parts;
mod problem;
mod program;
mod random;
mod record;
mod robust;
mod settings;
mod sobol;
mod sobol_directions;
mod solution;
mod solve;
mod sqp;
mod status;
mod tape;
mod watch;
mod watched;
mod weighted;

pub use callback::{Callback, Progress, Stage};
pub use certify::{
    Certificate, CertifyError, CertifyProgress, CertifySettings, CertifyStatus, FrontCertificate,
    FrontWatch, ProofSink, ProvedPoint, Suggest, WrittenProblem, certify, certify_front,
    certify_with,
};
pub use derivative::{
    DerivativeCheck, Differences, Exact, Functions, WrongEntry, check_derivatives,
};
pub use error::{Error, Result};
pub use jacobian::Jacobian;
pub use merit::Merit;
pub use method::Method;
pub use model::Model;
pub use multi_start::{MultiStart, Optimum, multi_start, multi_start_with};
pub use pareto::{
    Algorithm, Crossover, Front, FrontPoint, MAX_POPULATION, Mutation, ParetoSettings, das_dennis,
    knee, pareto, pareto_with,
};
pub use problem::{LinearConstraint, Problem, ProblemParams, Relation, Variable};
pub use robust::{Measure, Uncertainty, World, robust, sample};
pub use settings::Settings;
pub use sobol::Sobol;
pub use solution::{Counts, Kkt, Multipliers, Solution};
pub use solve::{evaluate, solve, solve_with};
pub use status::{Limit, Status, Violation};
pub use tape::{Binary, Node, Tape, TapedFunctions, Unary};
pub use watch::Watch;
