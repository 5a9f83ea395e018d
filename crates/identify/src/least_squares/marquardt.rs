//! Levenberg-Marquardt.

use grouser_opt::{Jacobian, Model};
use grouser_real::Real;

use super::fit::{Fit, Status};
use super::qr::solve_damped;
use super::{Bounded, Loss};
use crate::error::{Error, Result};

/// How a fit is searched for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// What a residual costs.
    pub loss: Loss,
    /// Most steps.
    pub steps: u32,
    /// The cosine between the residuals and every column of the Jacobian at which the fit has converged.
    pub cosine: f64,
    /// The relative change of the parameters below which there is no further step.
    pub change: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            loss: Loss::Squares,
            steps: 400,
            cosine: 1e-8,
            change: 1e-13,
        }
    }
}

/// Values, derivatives and cost at a point.
struct Point {
    x: Vec<f64>,
    residuals: Vec<f64>,
    cost: f64,
}

/// The parameters at which the losses of `model`'s `count` residuals add up to the least, near `start`.
///
/// Levenberg-Marquardt: each step solves min ‖J d + r‖² + λ ‖D d‖² with D the greatest column norms seen
/// (Moré, Lecture Notes in Mathematics 630 (1978)); λ by the ratio of the cost's fall to the one foretold
/// (Nielsen, Technical University of Denmark, IMM-REP-1999-05). A parameter on a bound towards which the
/// cost falls is held there; a step is cut at the bounds. With Huber's loss the rows carry the square root
/// of their weight.
///
/// # Errors
/// [`Error::Start`] for a start outside its bounds; [`Error::TooFew`] for fewer residuals than parameters.
///
/// ```
/// use grouser_identify::least_squares::{Bounded, Loss, Settings, Uncertainty, fit};
/// use grouser_opt::Differences;
///
/// // A straight line through four points: y = 1 + 2 x.
/// let line = Differences::new(|p: &[f64], r: &mut [f64]| {
///     for (x, residual) in [0.0, 1.0, 2.0, 3.0].into_iter().zip(r) {
///         *residual = p[0] + p[1] * x - (1.0 + 2.0 * x);
///     }
/// });
/// let start = [Bounded::free(0.0), Bounded::free(0.0)];
/// let found = fit(&line, 4, &start, &Settings::default())?;
/// assert!((found.x[0] - 1.0).abs() < 1e-6 && (found.x[1] - 2.0).abs() < 1e-6);
/// assert_eq!(Uncertainty::from_fit(&found, Loss::Squares).freedom, 2);
/// # Ok::<(), grouser_identify::Error>(())
/// ```
pub fn fit(
    model: &impl Model,
    count: usize,
    start: &[Bounded],
    settings: &Settings,
) -> Result<Fit> {
    for (index, bounded) in start.iter().enumerate() {
        bounded.check(index)?;
    }
    if count < start.len() {
        return Err(Error::TooFew {
            residuals: count,
            parameters: start.len(),
        });
    }
    let mut search = Search::new(model, count, start, *settings);
    let status = search.run();
    let Search {
        here,
        jacobian,
        evaluations,
        jacobians,
        ..
    } = search;
    Ok(Fit {
        status,
        jacobian: (0..count).map(|row| jacobian.row(row).to_vec()).collect(),
        x: here.x,
        residuals: here.residuals,
        cost: here.cost,
        evaluations,
        jacobians,
        bounds: start.to_vec(),
    })
}

struct Search<'a, M> {
    model: &'a M,
    bounds: &'a [Bounded],
    settings: Settings,
    here: Point,
    jacobian: Jacobian,
    /// D: the greatest norm that each column had.
    scale: Vec<f64>,
    lambda: f64,
    growth: f64,
    evaluations: u32,
    jacobians: u32,
}

impl<'a, M: Model> Search<'a, M> {
    fn new(model: &'a M, count: usize, bounds: &'a [Bounded], settings: Settings) -> Self {
        let n = bounds.len();
        Self {
            model,
            bounds,
            settings,
            here: Point {
                x: bounds.iter().map(|b| b.start).collect(),
                residuals: vec![f64::NAN; count],
                cost: f64::INFINITY,
            },
            jacobian: Jacobian::zeros(count, n),
            scale: vec![0.0; n],
            lambda: 1e-3,
            growth: 2.0,
            evaluations: 0,
            jacobians: 0,
        }
    }

    fn run(&mut self) -> Status {
        self.derive();
        self.here.cost = self.cost(&self.here.residuals);
        if !self.here.cost.is_finite() {
            return Status::NoValue;
        }
        for _ in 0..self.settings.steps {
            let (rows, right) = self.weighted();
            self.widen(&rows);
            let held = self.held(&rows, &right);
            if self.is_perpendicular(&rows, &right, &held) {
                return Status::Converged;
            }
            match self.step(&rows, &right, &held) {
                Some(true) => self.derive(),
                Some(false) => {}
                None => return Status::Stalled,
            }
        }
        Status::StepLimit
    }

    /// Residuals and Jacobian here.
    fn derive(&mut self) {
        let Point { x, residuals, .. } = &mut self.here;
        self.model.derivatives(x, residuals, &mut self.jacobian);
        self.evaluations += 1;
        self.jacobians += 1;
    }

    fn cost(&self, residuals: &[f64]) -> f64 {
        let sum: f64 = residuals.iter().map(|r| self.settings.loss.of(*r)).sum();
        if sum.is_finite() { sum } else { f64::INFINITY }
    }

    /// The rows of the Jacobian and the residuals, each times the root of its weight.
    fn weighted(&self) -> (Vec<Vec<f64>>, Vec<f64>) {
        let root = |r: f64| self.settings.loss.weight(r).sqrt();
        let residuals = &self.here.residuals;
        let rows = residuals
            .iter()
            .enumerate()
            .map(|(row, r)| {
                let w = root(*r);
                self.jacobian.row(row).iter().map(|g| w * g).collect()
            })
            .collect();
        (rows, residuals.iter().map(|r| root(*r) * r).collect())
    }

    fn widen(&mut self, rows: &[Vec<f64>]) {
        for (column, scale) in self.scale.iter_mut().enumerate() {
            *scale = scale.max(norm(rows.iter().map(|row| row[column])));
        }
    }

    /// Which parameters lie on a bound beyond which the cost falls, or do not matter here at all.
    fn held(&self, rows: &[Vec<f64>], right: &[f64]) -> Vec<bool> {
        let gradient =
            |column: usize| -> f64 { rows.iter().zip(right).map(|(row, r)| row[column] * r).sum() };
        (0..self.bounds.len())
            .map(|column| {
                let (x, bound) = (self.here.x[column], &self.bounds[column]);
                let slope = gradient(column);
                self.scale[column] == 0.0
                    || (x <= bound.lower && slope >= 0.0)
                    || (x >= bound.upper && slope <= 0.0)
            })
            .collect()
    }

    fn is_perpendicular(&self, rows: &[Vec<f64>], right: &[f64], held: &[bool]) -> bool {
        let length = norm(right.iter().copied());
        (0..held.len())
            .filter(|column| !held[*column])
            .all(|column| {
                let dot: f64 = rows.iter().zip(right).map(|(row, r)| row[column] * r).sum();
                let size = norm(rows.iter().map(|row| row[column]));
                dot.abs() <= self.settings.cosine * size * length
            })
    }

    /// One step: `Some(true)` taken, `Some(false)` refused, `None` where none is left.
    fn step(&mut self, rows: &[Vec<f64>], right: &[f64], held: &[bool]) -> Option<bool> {
        let free: Vec<usize> = (0..held.len()).filter(|c| !held[*c]).collect();
        let reduced: Vec<Vec<f64>> = rows
            .iter()
            .map(|row| free.iter().map(|c| row[*c]).collect())
            .collect();
        let damping: Vec<f64> = free
            .iter()
            .map(|c| self.lambda.sqrt() * self.scale[*c])
            .collect();
        let direction = solve_damped(&reduced, right, &damping)?;
        let mut x = self.here.x.clone();
        for (&column, d) in free.iter().zip(&direction) {
            let bound = &self.bounds[column];
            x[column] = (x[column] + d).clamp(bound.lower, bound.upper);
        }
        let taken: Vec<f64> = x.iter().zip(&self.here.x).map(|(a, b)| a - b).collect();
        let moved = norm(taken.iter().zip(&self.scale).map(|(d, s)| d * s));
        let size = norm(self.here.x.iter().zip(&self.scale).map(|(x, s)| x * s));
        if moved <= self.settings.change * size {
            return None;
        }
        let foretold = {
            let linear: f64 = rows
                .iter()
                .zip(right)
                .map(|(row, r)| {
                    let change: f64 = row.iter().zip(&taken).map(|(g, d)| g * d).sum();
                    0.5 * Real::powi(r + change, 2)
                })
                .sum();
            0.5 * right.iter().map(|r| r * r).sum::<f64>() - linear
        };
        let mut residuals = vec![f64::NAN; self.here.residuals.len()];
        self.model.values(&x, &mut residuals);
        self.evaluations += 1;
        let cost = self.cost(&residuals);
        let fall = self.here.cost - cost;
        if fall > 0.0 {
            let ratio = fall / foretold;
            let bend = 1.0 - Real::powi(2.0 * ratio - 1.0, 3);
            self.lambda = (self.lambda * bend.clamp(1.0 / 3.0, 2.0)).max(1e-15);
            self.growth = 2.0;
            self.here = Point { x, residuals, cost };
            return Some(true);
        }
        self.lambda *= self.growth;
        self.growth *= 2.0;
        (self.lambda < 1e30).then_some(false)
    }
}

fn norm(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|x| x * x).sum::<f64>().sqrt()
}
