//! From the solver's last point to the solution: residuals, prices and what binds.

use super::point::{Point, violation};
use super::qp::{RowKind, Rows};
use super::subspace::dot;
use crate::jacobian::Jacobian;
use crate::problem::Problem;
use crate::program::{Kind, Program};
use crate::settings::Settings;
use crate::solution::{Counts, Kkt, Multipliers, Solution};
use crate::status::{Status, Violation};

/// Σ u_j g_j over rows and bounds.
pub(super) fn lagrangian_gradient(n: usize, rows: &Rows, multipliers: &[f64]) -> Vec<f64> {
    let mut gradient = vec![0.0; n];
    for (row, &u) in rows.gradients.chunks_exact(n.max(1)).zip(multipliers) {
        if u != 0.0 {
            for (sum, g) in gradient.iter_mut().zip(row) {
                *sum += u * g;
            }
        }
    }
    let bounds = multipliers.get(rows.kinds.len()..).unwrap_or(&[]);
    for (sum, pair) in gradient.iter_mut().zip(bounds.chunks_exact(2)) {
        *sum += pair[1] - pair[0];
    }
    gradient
}

/// max ‖∇f_i‖∞ over the objective rows.
pub(super) fn gradient_scale(program: &Program<'_>, jacobian: &Jacobian) -> f64 {
    program
        .rows
        .iter()
        .filter(|row| row.kind.is_objective())
        .map(|row| jacobian.row_norm(row.function) * row.scale)
        .fold(0.0, f64::max)
}

/// Σ λ_i ‖∇f_i‖∞: as `gradient_scale`, but steep objectives that carry no weight do not count.
pub(super) fn weighted_gradient_scale(
    program: &Program<'_>,
    jacobian: &Jacobian,
    u: &[f64],
) -> f64 {
    program
        .rows
        .iter()
        .zip(u)
        .filter(|(row, _)| row.kind.is_objective())
        .map(|(row, u)| u * jacobian.row_norm(row.function) * row.scale)
        .sum()
}

/// The greatest multiplier × distance from binding; `level` is γ. A violated row binds at its cap: what its
/// multiplier lacks there counts times the violation.
pub(super) fn complementarity(
    rows: &Rows,
    level: f64,
    lower: &[f64],
    upper: &[f64],
    multipliers: &[f64],
) -> f64 {
    let mut worst = 0.0_f64;
    for ((&kind, &offset), &u) in rows.kinds.iter().zip(&rows.offsets).zip(multipliers) {
        let slack = match kind {
            RowKind::Objective => level - offset,
            RowKind::Inequality { cap } if offset > 0.0 && cap.is_finite() => {
                worst = worst.max((cap - u) * offset);
                0.0
            }
            RowKind::Inequality { .. } => (-offset).max(0.0),
            RowKind::Equality { cap } if cap.is_finite() => {
                worst = worst.max((cap - u.abs()) * offset.abs());
                0.0
            }
            RowKind::Equality { .. } | RowKind::Ignored => 0.0,
        };
        worst = worst.max((u * slack).abs());
    }
    let bounds = multipliers.get(rows.kinds.len()..).unwrap_or(&[]);
    for (pair, (low, high)) in bounds.chunks_exact(2).zip(lower.iter().zip(upper)) {
        for (u, slack) in [(pair[0], -low), (pair[1], *high)] {
            if u != 0.0 {
                worst = worst.max((u * slack).abs());
            }
        }
    }
    worst
}

/// Every nonlinear constraint violated by more than the tolerance.
pub(super) fn violations(program: &Program<'_>, point: &Point, tolerance: f64) -> Vec<Violation> {
    let mut list: Vec<Violation> = Vec::new();
    for (row, &value) in program.rows.iter().zip(&point.rows) {
        let amount = violation(row.kind, value);
        if !(amount <= tolerance) {
            let name = program.problem.function_name(row.function).to_owned();
            list.push(Violation { name, amount });
        }
    }
    list
}

/// Builds the solution. Without a Jacobian (the search never began) residuals that need one are 0.
pub(super) fn solution(
    program: &Program<'_>,
    settings: &Settings,
    counts: Counts,
    point: Point,
    jacobian: Option<&Jacobian>,
    u: &[f64],
    status: Status,
) -> Solution {
    let problem = program.problem;
    let (objectives, inequalities) = (problem.objectives().len(), problem.inequalities().len());
    let level = point.level(program);
    let mut sums = Sums::new(program, u);
    sums.kkt.violation = point.worst_violation(program);
    sums.kkt.gradient_scale = jacobian.map_or(0.0, |jacobian| gradient_scale(program, jacobian));
    sums.add_rows(&point, level, jacobian);
    sums.add_linear(&point);
    sums.add_bounds(&point);
    let values = &point.functions;
    Solution {
        status,
        active: active(program, settings, &point, level, &sums.multipliers),
        objectives: values[..objectives].to_vec(),
        maximum: greatest(problem, values),
        utility: level,
        inequalities: values[objectives..objectives + inequalities].to_vec(),
        equalities: values[objectives + inequalities..].to_vec(),
        kkt: Kkt {
            stationarity: sums.gradient.iter().fold(0.0, |m, g| g.abs().max(m)),
            ..sums.kkt
        },
        multipliers: sums.multipliers,
        counts,
        x: point.x,
    }
}

/// The greatest objective, |f| where absolute; NaN if one has no value.
pub(crate) fn greatest(problem: &Problem<'_>, values: &[f64]) -> f64 {
    let sized = |(i, f): (usize, &f64)| if i < problem.absolute() { f.abs() } else { *f };
    values[..problem.objectives().len()]
        .iter()
        .enumerate()
        .map(sized)
        .fold(
            f64::NEG_INFINITY,
            |m, v| {
                if v > m || v.is_nan() { v } else { m }
            },
        )
}

/// Sorts the solver's multipliers by what they belong to, and adds up the optimality conditions.
struct Sums<'a> {
    program: &'a Program<'a>,
    u: &'a [f64],
    multipliers: Multipliers,
    kkt: Kkt,
    gradient: Vec<f64>,
}

impl<'a> Sums<'a> {
    fn new(program: &'a Program<'a>, u: &'a [f64]) -> Self {
        let problem = program.problem;
        let objectives = problem.objectives().len();
        let n = program.dimension();
        Self {
            program,
            u,
            multipliers: Multipliers {
                objectives: vec![0.0; objectives],
                hard_goals: vec![0.0; objectives],
                inequalities: vec![0.0; problem.inequalities().len()],
                equalities: vec![0.0; problem.equalities().len()],
                linear: vec![0.0; program.linear.len()],
                lower: vec![0.0; n],
                upper: vec![0.0; n],
            },
            kkt: Kkt::default(),
            gradient: vec![0.0; n],
        }
    }

    fn at(&self, index: usize) -> f64 {
        self.u.get(index).copied().unwrap_or(0.0)
    }

    fn add_slack(&mut self, price: f64, slack: f64) {
        if price != 0.0 {
            self.kkt.complementarity = self.kkt.complementarity.max((price * slack).abs());
        }
    }

    fn add_gradient(&mut self, weight: f64, gradient: &[f64]) {
        if weight != 0.0 {
            for (sum, g) in self.gradient.iter_mut().zip(gradient) {
                *sum += weight * g;
            }
        }
    }

    fn add_rows(&mut self, point: &Point, level: f64, jacobian: Option<&Jacobian>) {
        for (index, (row, &value)) in self.program.rows.iter().zip(&point.rows).enumerate() {
            let price = self.at(index);
            let parts = &mut self.multipliers;
            let slack = match row.kind {
                Kind::Objective(i) => {
                    parts.objectives[i] += price;
                    level - value
                }
                Kind::HardGoal(i) => {
                    parts.hard_goals[i] += price;
                    (-value).max(0.0)
                }
                Kind::Inequality(j) => {
                    parts.inequalities[j] = price;
                    (-value).max(0.0)
                }
                Kind::Equality(k) => {
                    parts.equalities[k] = price;
                    0.0
                }
            };
            self.add_slack(price, slack);
            if let Some(jacobian) = jacobian {
                self.add_gradient(price * row.slope(), jacobian.row(row.function));
            }
        }
    }

    fn add_linear(&mut self, point: &Point) {
        for (l, row) in self.program.linear.iter().enumerate() {
            let price = self.at(self.program.rows.len() + l);
            self.multipliers.linear[l] = price;
            let value = dot(&row.coefficients, &point.x) - row.bound;
            let (off, slack) = if row.equal {
                (value.abs(), 0.0)
            } else {
                (value.max(0.0), (-value).max(0.0))
            };
            self.kkt.violation = self.kkt.violation.max(off);
            self.add_slack(price, slack);
            self.add_gradient(price, &row.coefficients);
        }
    }

    fn add_bounds(&mut self, point: &Point) {
        let first = self.program.rows.len() + self.program.linear.len();
        for (i, &x) in point.x.iter().enumerate() {
            let (low, high) = (self.at(first + 2 * i), self.at(first + 2 * i + 1));
            (self.multipliers.lower[i], self.multipliers.upper[i]) = (low, high);
            self.gradient[i] += high - low;
            self.add_slack(low, x - self.program.lower[i]);
            self.add_slack(high, self.program.upper[i] - x);
        }
    }
}

/// The names of everything that holds the point: rows at their limit or with a price, bounds as
/// `x >= lower` and `x <= upper`.
fn active(
    program: &Program<'_>,
    settings: &Settings,
    point: &Point,
    level: f64,
    multipliers: &Multipliers,
) -> Vec<String> {
    let problem = program.problem;
    let near = |slack: f64, size: f64| {
        slack.is_finite() && slack <= 10.0 * settings.constraint_tolerance * (1.0 + size)
    };
    let mut names: Vec<String> = Vec::new();
    for (row, &value) in program.rows.iter().zip(&point.rows) {
        let binds = match row.kind {
            Kind::Objective(i) => {
                multipliers.objectives[i] > 0.0 || near(level - value, level.abs())
            }
            Kind::HardGoal(_) | Kind::Inequality(_) => near(-value, 0.0),
            Kind::Equality(_) => true,
        };
        let name = problem.function_name(row.function);
        if binds && names.last().map(String::as_str) != Some(name) {
            names.push(name.to_owned());
        }
    }
    for (row, named) in program.linear.iter().zip(problem.linear()) {
        if row.equal
            || near(
                row.bound - dot(&row.coefficients, &point.x),
                row.bound.abs(),
            )
        {
            names.push(named.name.clone());
        }
    }
    for (i, variable) in problem.variables().iter().enumerate() {
        if near(point.x[i] - variable.lower, variable.lower.abs()) {
            names.push(format!("{} >= lower", variable.name));
        }
        if near(variable.upper - point.x[i], variable.upper.abs()) {
            names.push(format!("{} <= upper", variable.name));
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use grouser_real::Scalar;

    use super::*;
    use crate::derivative::{Exact, Functions};
    use crate::method::Method;
    use crate::problem::{LinearConstraint, ProblemParams, Variable};

    /// Multiplier times distance, by hand; what is violated lacks what its multiplier is below the cap.
    #[test]
    fn products_of_multipliers_and_distances() {
        let of = |kind: RowKind, offset: f64, u: f64| {
            let rows = Rows {
                kinds: vec![kind],
                gradients: vec![0.0],
                offsets: vec![offset],
                ..Rows::default()
            };
            complementarity(&rows, 3.0, &[-2.0], &[5.0], &[u, 0.0, 0.0])
        };
        let (cap, infinity) = (10.0, f64::INFINITY);
        assert_eq!(of(RowKind::Objective, 1.0, 0.25), 0.5);
        assert_eq!(of(RowKind::Inequality { cap }, 2.0, 4.0), 12.0);
        assert_eq!(of(RowKind::Inequality { cap }, 0.0, 4.0), 0.0);
        assert_eq!(of(RowKind::Inequality { cap }, -3.0, 0.25), 0.75);
        assert_eq!(of(RowKind::Inequality { cap: infinity }, 2.0, 4.0), 0.0);
        assert_eq!(of(RowKind::Equality { cap }, -2.0, -4.0), 12.0);
        assert_eq!(of(RowKind::Equality { cap }, 2.0, 4.0), 12.0);
        assert_eq!(of(RowKind::Equality { cap: infinity }, 2.0, 4.0), 0.0);
        assert_eq!(of(RowKind::Ignored, 2.0, 4.0), 0.0);
        let rows = Rows::default();
        let bounds = |u: [f64; 2], lower: f64| complementarity(&rows, 0.0, &[lower], &[5.0], &u);
        assert_eq!(bounds([0.5, 0.125], -2.0), 1.0);
        assert_eq!(bounds([0.25, 0.125], -2.0), 0.625);
        assert_eq!(bounds([0.0, 0.125], f64::NEG_INFINITY), 0.625);
    }

    /// Gradients of goals count by their weights, and the one as much as its multiplier says.
    #[test]
    fn sizes_of_gradients() {
        struct Nothing;
        impl Functions for Nothing {
            fn evaluate<R: Scalar>(&self, _: &[R], f: &mut [R]) {
                f.fill(R::ZERO);
            }
        }
        let problem = Problem::new(ProblemParams::new(&[0.0; 2], 3, Exact(Nothing))).unwrap();
        let method = Method::Attain {
            goals: vec![0.0; 3],
            weights: vec![0.5, 4.0, 0.0],
        };
        let program = Program::new(&problem, &method);
        let mut jacobian = Jacobian::zeros(3, 2);
        for (row, gradient) in [[1.0, -3.0], [16.0, 2.0], [99.0, 0.0]].iter().enumerate() {
            jacobian.row_mut(row).copy_from_slice(gradient);
        }
        // 3/0.5 and 16/4; the limit does not count
        assert_eq!(gradient_scale(&program, &jacobian), 6.0);
        let weighted = weighted_gradient_scale(&program, &jacobian, &[0.25, 0.75, 8.0]);
        assert_eq!(weighted, 4.5);
        let rows = Rows {
            kinds: vec![RowKind::Objective; 2],
            gradients: vec![1.0, 2.0, 3.0, 4.0],
            ..Rows::default()
        };
        // 0.5 (1, 2) + 2 (3, 4) + (3 − 1, 7 − 5)
        let sum = lagrangian_gradient(2, &rows, &[0.5, 2.0, 1.0, 3.0, 5.0, 7.0]);
        assert_eq!(sum, [8.5, 11.0]);
    }

    /// Prices by hand of a point with the goals' rows 2, 1 and −3, an inequality and a linear row with the slacks of the limit
    /// that is called near, and bounds of which one is as near.
    #[test]
    fn what_holds_a_point_and_how_far_it_is() {
        struct Nothing;
        impl Functions for Nothing {
            fn evaluate<R: Scalar>(&self, _: &[R], f: &mut [R]) {
                f.fill(R::ZERO);
            }
        }
        let settings = Settings {
            constraint_tolerance: 1.0 / 1024.0,
            ..Settings::default()
        };
        let near = 10.0 * settings.constraint_tolerance;
        let params = ProblemParams::new(&[0.0; 2], 3, Exact(Nothing))
            .inequalities(["g".to_owned()])
            .variables([
                Variable::bounded("x", 0.0, -1.0, 3.0),
                Variable::bounded("y", 0.0, -7.0, 9.0),
            ])
            .linear([LinearConstraint::at_most("row", vec![1.0, 2.0], 3.0)]);
        let problem = Problem::new(params).unwrap();
        let method = Method::Attain {
            goals: vec![0.0; 3],
            weights: vec![2.0, 0.5, 0.0],
        };
        let program = Program::new(&problem, &method);
        let point = Point {
            x: vec![3.0 - 4.0 * near, 0.0],
            functions: vec![4.0, 0.5, -3.0, -near],
            rows: vec![2.0, 1.0, -3.0, -near],
            parts: Vec::new(),
        };
        let of = |u: &[f64]| {
            let point = point.clone();
            let (counts, status) = (Counts::default(), Status::Converged);
            solution(&program, &settings, counts, point, None, u, status)
        };
        let found = of(&[0.25, 0.75]);
        assert_eq!(found.active, ["f1", "f2", "g", "row", "x <= upper"]);
        assert_eq!(found.kkt.complementarity, 0.75);
        // the limit of f3 is 3 off, that of the row as far as it may be and be near
        assert_eq!(of(&[1.0, 0.0, 0.5]).kkt.complementarity, 1.5);
        let found = of(&[1.0, 0.0, 0.0, 0.0, 8.0]);
        assert_eq!(found.kkt.complementarity, 8.0 * 4.0 * near);
        assert_eq!(found.active, ["f1", "g", "row", "x <= upper"]);
        // what is met exactly is not violated, of no tolerance either
        let met = Point {
            rows: vec![2.0, 1.0, 0.0, 1.0],
            ..point.clone()
        };
        let violated = violations(&program, &met, 0.0);
        assert_eq!(violated.len(), 1);
        assert_eq!((&violated[0].name[..], violated[0].amount), ("g", 1.0));
    }
}
