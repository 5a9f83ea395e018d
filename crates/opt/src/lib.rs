//! Several objectives at once: minimax, goal attainment, weighted and Chebyshev utility, under
//! bounds, linear and nonlinear constraints, with exact derivatives and the multipliers that say
//! what each constraint costs.
//!
//! ```
//! use grouser_opt::{Exact, Functions, Method, Problem, ProblemParams, Settings, solve};
//! use grouser_real::Scalar;
//!
//! /// CB2 (Charalambous & Conn 1978): the optimum is 1.9522245.
//! struct Cb2;
//! impl Functions for Cb2 {
//!     fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
//!         let two = R::from_f64(2.0);
//!         f[0] = x[0].square() + x[1].powi(4);
//!         f[1] = (two - x[0]).square() + (two - x[1]).square();
//!         f[2] = two * (x[1] - x[0]).exp();
//!     }
//! }
//!
//! let problem = Problem::new(ProblemParams::new(&[2.0, 2.0], 3, Exact(Cb2)))?;
//! let solution = solve(&problem, &Method::Minimax, &Settings::default())?;
//! assert!(solution.status.is_solved());
//! assert!((solution.maximum - 1.952_224_5).abs() < 1e-6);
//! # Ok::<(), grouser_opt::Error>(())
//! ```
//!
//! The primary types are [`Problem`], [`Method`], [`Settings`] and [`Solution`], in the order in which
//! [`solve`] meets them. Solvers are local: [`multi_start`] looks from many starts, and [`certify()`] proves
//! how good the best point over a whole box is. The crate knows nothing of wheels.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod callback;
mod certify;
mod derivative;
mod error;
mod jacobian;
mod method;
mod model;
mod multi_start;
mod pareto;
mod problem;
mod program;
mod random;
mod robust;
mod settings;
mod sobol;
mod sobol_directions;
mod solution;
mod solve;
mod sqp;
mod status;
mod tape;
mod watched;
mod weighted;

pub use callback::{Callback, Progress, Stage};
pub use certify::{
    Certificate, CertifyError, CertifyProgress, CertifySettings, CertifyStatus, FrontCertificate,
    FrontWatch, ProofSink, ProvedPoint, Suggest, certify, certify_front, certify_with,
};
pub use derivative::{
    DerivativeCheck, Differences, Exact, Functions, Scheme, WrongEntry, check_derivatives,
};
pub use error::{Error, Result};
pub use jacobian::Jacobian;
pub use method::Method;
pub use model::Model;
pub use multi_start::{MultiStart, Optimum, multi_start, multi_start_with};
pub use pareto::{
    Algorithm, Crossover, Front, FrontPoint, MAX_POPULATION, Mutation, ParetoSettings, das_dennis,
    knee, pareto, pareto_with,
};
pub use problem::{LinearConstraint, Problem, ProblemParams, Relation, Variable};
pub use robust::{Measure, Robust, Uncertainty, World, robust, sample};
pub use settings::Settings;
pub use sobol::Sobol;
pub use solution::{Counts, Kkt, Multipliers, Solution};
pub use solve::{Merit, evaluate, solve, solve_with};
pub use status::{Limit, Status, Violation};
pub use tape::{Binary, Node, Tape, TapedFunctions, Unary};
