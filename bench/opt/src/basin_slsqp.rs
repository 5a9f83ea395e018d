//! The same problems through basin's SLSQP, in the variables (x, γ).

use std::cell::Cell;
use std::convert::Infallible;
use std::rc::Rc;

use basin::{
    BoxBounds, ConstraintDescription, ConstraintJacobian, ConstraintSet, ConstraintSolveError,
    Constraints, CostFunction, DenseMatrix, Executor, Gradient, NoLinearConstraints,
    NonlinearBlock, NonlinearBlocks, NonlinearEqualityValues, NonlinearInequalityValues,
    SelectedFirstOrderState, Slsqp, State,
};
use grouser_opt::{Jacobian, Problem, Relation};

struct Epigraph<'a> {
    problem: &'a Problem<'a>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    inequalities: usize,
    equalities: usize,
    jacobians: Rc<Cell<usize>>,
}

pub struct Outcome {
    pub maximum: f64,
    pub jacobians: usize,
}

impl Epigraph<'_> {
    fn n(&self) -> usize {
        self.problem.variables().len()
    }

    fn functions(&self, x: &[f64]) -> Vec<f64> {
        let mut values = vec![f64::NAN; self.problem.function_count()];
        self.problem.model().values(x, &mut values);
        values
    }

    fn linear<'s>(&'s self, relation: Relation) -> impl Iterator<Item = (&'s [f64], f64)> + 's {
        self.problem
            .linear()
            .iter()
            .filter(move |row| row.relation == relation)
            .map(|row| (row.coefficients.as_slice(), row.bound))
    }
}

impl Constraints for Epigraph<'_> {
    type Set = ConstraintSet<
        BoxBounds<Vec<f64>>,
        NoLinearConstraints,
        NonlinearBlocks<NonlinearBlock, NonlinearBlock>,
    >;
    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new()
            .with_bounds(BoxBounds::new(Some(&self.lower), Some(&self.upper)))
            .with_nonlinear_equalities(self.equalities)
            .with_nonlinear_inequalities(self.inequalities)
    }
}

impl CostFunction for Epigraph<'_> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Infallible;
    fn cost(&self, x: &Vec<f64>) -> Result<f64, Infallible> {
        Ok(x[self.n()])
    }
}

impl Gradient for Epigraph<'_> {
    type Gradient = Vec<f64>;
    fn gradient(&self, x: &Vec<f64>) -> Result<Vec<f64>, Infallible> {
        let mut gradient = vec![0.0; x.len()];
        gradient[self.n()] = 1.0;
        Ok(gradient)
    }
}

impl NonlinearInequalityValues for Epigraph<'_> {
    type Param = Vec<f64>;
    type Values = Vec<f64>;
    type Error = Infallible;
    fn nonlinear_inequalities(
        &self,
        x: &Vec<f64>,
    ) -> Result<Vec<f64>, ConstraintSolveError<Infallible>> {
        let level = x[self.n()];
        let values = self.functions(&x[..self.n()]);
        let mut out = Vec::with_capacity(self.inequalities);
        for (i, f) in values.iter().enumerate() {
            out.push(f - level);
            if i < self.problem.absolute() {
                out.push(-f - level);
            }
        }
        for (a, b) in self.linear(Relation::AtMost) {
            out.push(a.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() - b);
        }
        Ok(out)
    }
}

impl NonlinearEqualityValues for Epigraph<'_> {
    type Param = Vec<f64>;
    type Values = Vec<f64>;
    type Error = Infallible;
    fn nonlinear_equalities(
        &self,
        x: &Vec<f64>,
    ) -> Result<Vec<f64>, ConstraintSolveError<Infallible>> {
        Ok(self
            .linear(Relation::Equal)
            .map(|(a, b)| a.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() - b)
            .collect())
    }
}

impl ConstraintJacobian for Epigraph<'_> {
    type Param = Vec<f64>;
    type Jacobian = DenseMatrix;
    type Error = Infallible;
    fn constraint_jacobian(
        &self,
        x: &Vec<f64>,
    ) -> Result<DenseMatrix, ConstraintSolveError<Infallible>> {
        let n = self.n();
        self.jacobians.set(self.jacobians.get() + 1);
        let mut values = vec![0.0; self.problem.function_count()];
        let mut jacobian = Jacobian::zeros(values.len(), n);
        self.problem
            .model()
            .derivatives(&x[..n], &mut values, &mut jacobian);
        let mut entries = Vec::with_capacity((self.equalities + self.inequalities) * (n + 1));
        let mut push = |row: &[f64], sign: f64, level: f64| {
            entries.extend(row.iter().map(|g| sign * g));
            entries.push(level);
        };
        for (a, _) in self.linear(Relation::Equal) {
            push(a, 1.0, 0.0);
        }
        for i in 0..values.len() {
            push(jacobian.row(i), 1.0, -1.0);
            if i < self.problem.absolute() {
                push(jacobian.row(i), -1.0, -1.0);
            }
        }
        for (a, _) in self.linear(Relation::AtMost) {
            push(a, 1.0, 0.0);
        }
        Ok(DenseMatrix::from_row_slice(
            self.equalities + self.inequalities,
            n + 1,
            &entries,
        ))
    }
}

pub fn solve(problem: &Problem<'_>) -> Outcome {
    let variables = problem.variables();
    let linear = |relation| {
        problem
            .linear()
            .iter()
            .filter(|row| row.relation == relation)
            .count()
    };
    let mut lower: Vec<f64> = variables.iter().map(|v| v.lower).collect();
    let mut upper: Vec<f64> = variables.iter().map(|v| v.upper).collect();
    lower.push(f64::NEG_INFINITY);
    upper.push(f64::INFINITY);
    let jacobians = Rc::new(Cell::new(0));
    let epigraph = Epigraph {
        problem,
        lower,
        upper,
        inequalities: problem.function_count() + problem.absolute() + linear(Relation::AtMost),
        equalities: linear(Relation::Equal),
        jacobians: jacobians.clone(),
    };
    let maximum = |x: &[f64]| {
        let mut values = vec![f64::NAN; problem.function_count()];
        problem.model().values(x, &mut values);
        values
            .iter()
            .enumerate()
            .map(|(i, f)| if i < problem.absolute() { f.abs() } else { *f })
            .fold(f64::NEG_INFINITY, f64::max)
    };
    let mut start: Vec<f64> = variables.iter().map(|v| v.start).collect();
    start.push(maximum(&start));
    let result = Executor::new(
        epigraph,
        Slsqp::new().with_absolute_accuracy_tolerance(1e-9),
        SelectedFirstOrderState::new(start),
    )
    .max_iter(1000)
    .run_with_solver();
    let maximum = result.map_or(f64::NAN, |r| maximum(&r.state.param()[..variables.len()]));
    Outcome {
        maximum,
        jacobians: jacobians.get(),
    }
}
