//! What a solve found, and what holds it there.

use crate::status::Status;

/// Lagrange multipliers of L = Σ λ_i f_i + Σ μ_j c_j + Σ ν_k c_eq,k + Σ π_l (a_l·x − b_l) + Σ (u − l)·x.
///
/// A multiplier is the price of its constraint: loosening the bound by δ lowers the optimum by
/// multiplier · δ, to first order.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Multipliers {
    /// One per objective, ≥ 0, together 1: the local trade-off. With goals and weights they belong to
    /// the scaled objectives (f_i − goal_i)/w_i; of absolute objectives to |f_i|.
    pub objectives: Vec<f64>,
    /// One per objective; above 0 only for hard goals (weight 0) that bind.
    pub hard_goals: Vec<f64>,
    /// One per inequality c(x) ≤ 0, ≥ 0.
    pub inequalities: Vec<f64>,
    /// One per equality, of either sign.
    pub equalities: Vec<f64>,
    /// One per linear constraint; ≥ 0 for ≤.
    pub linear: Vec<f64>,
    /// One per variable, ≥ 0: its lower bound's.
    pub lower: Vec<f64>,
    /// One per variable, ≥ 0: its upper bound's.
    pub upper: Vec<f64>,
}

/// How well the optimality conditions hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Kkt {
    /// ‖∇L‖∞.
    pub stationarity: f64,
    /// max ‖∇f_i‖∞ over the (scaled) objectives: what stationarity is to be compared with.
    pub gradient_scale: f64,
    /// The greatest multiplier × distance from binding.
    pub complementarity: f64,
    /// The greatest violation of any constraint or bound.
    pub violation: f64,
}

/// What the solve cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counts {
    /// Quadratic models solved and stepped along.
    pub iterations: usize,
    /// Points at which the functions were evaluated, with or without derivatives.
    pub values: usize,
    /// Points at which derivatives were evaluated.
    pub jacobians: usize,
    /// Points at which the functions were evaluated to confirm a solution.
    pub probes: usize,
}

impl core::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.iterations += other.iterations;
        self.values += other.values;
        self.jacobians += other.jacobians;
        self.probes += other.probes;
    }
}

/// The result of a solve.
///
/// ```
/// use grouser_opt::{Differences, LinearConstraint, Method, Problem, ProblemParams, Settings, solve};
///
/// // x² with x ≥ 1: the constraint holds the point, and its price is d(x²)/dx = 2.
/// let model = Differences::new(|x: &[f64], f: &mut [f64]| f[0] = x[0] * x[0]);
/// let params = ProblemParams::new(&[3.0], 1, model)
///     .linear([LinearConstraint::at_most("reach", vec![-1.0], -1.0)]);
/// let solution = solve(&Problem::new(params)?, &Method::Minimax, &Settings::default())?;
/// assert!(solution.status.is_solved());
/// assert!((solution.multipliers.linear[0] - 2.0).abs() < 1e-5);
/// assert!(solution.active.contains(&"reach".to_owned()));
/// # Ok::<(), grouser_opt::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Solution {
    /// How it ended.
    pub status: Status,
    /// The point.
    pub x: Vec<f64>,
    /// Every objective there, as the model gives it (signed, without scaling).
    pub objectives: Vec<f64>,
    /// The greatest objective (|f| where absolute).
    pub maximum: f64,
    /// What was minimised: max f_i, the attainment γ, the weighted sum or the Chebyshev distance.
    pub utility: f64,
    /// The inequalities c(x).
    pub inequalities: Vec<f64>,
    /// The equalities c_eq(x).
    pub equalities: Vec<f64>,
    /// The prices.
    pub multipliers: Multipliers,
    /// The names of the objectives, constraints and bounds that hold the point where it is.
    pub active: Vec<String>,
    /// How well the optimality conditions hold.
    pub kkt: Kkt,
    /// What it cost.
    pub counts: Counts,
}
