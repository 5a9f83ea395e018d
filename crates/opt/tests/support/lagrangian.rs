//! The conditions of an optimum from a solution's point and prices alone.

use grouser_opt::{Jacobian, Problem, Solution};

/// ‖Σ λ_i ∇|f_i| + Σ μ_j ∇g_j + Σ ν_k ∇h_k + Σ π_l a_l + u − l‖∞, and the greatest slope of a function.
pub(crate) fn stationarity(problem: &Problem<'_>, solution: &Solution) -> (f64, f64) {
    let prices = &solution.multipliers;
    let (m, n) = (problem.function_count(), solution.x.len());
    let (mut values, mut jacobian) = (vec![0.0; m], Jacobian::zeros(m, n));
    problem
        .model()
        .derivatives(&solution.x, &mut values, &mut jacobian);
    let mut sum: Vec<f64> = (0..n).map(|k| prices.upper[k] - prices.lower[k]).collect();
    let of_functions = prices.objectives.iter().chain(&prices.inequalities);
    for (i, price) in of_functions.chain(&prices.equalities).enumerate() {
        let is_turned = i < problem.absolute() && values[i] < 0.0;
        let sign = if is_turned { -1.0 } else { 1.0 };
        for (sum, slope) in sum.iter_mut().zip(jacobian.row(i)) {
            *sum += sign * price * slope;
        }
    }
    for (row, price) in problem.linear().iter().zip(&prices.linear) {
        for (sum, a) in sum.iter_mut().zip(&row.coefficients) {
            *sum += price * a;
        }
    }
    let slope = (0..m).fold(0.0_f64, |most, row| most.max(jacobian.row_norm(row)));
    (sum.iter().fold(0.0, |most, off| off.abs().max(most)), slope)
}
