//! Sequential quadratic programming for minimax: the main loop.
//!
//! Each iteration linearises every row at x, solves the subproblem in (d, γ) ([`qp`]) and searches along
//! d for a decrease of the merit function φ = max_i f_i + ρ Σ violations ([`search`]). Constraints that are
//! linear hold at every iterate; nonlinear ones may be violated on the way at the price ρ, which is raised
//! when a greater price buys feasibility ([`price`]). Where no price does, the objectives are set aside and
//! the violation alone is minimised (the elastic phase): its end is either a feasible point, from which
//! the solve goes on, or the least-infeasible point, which is the answer.
//!
//! Source: Han 1977, Powell 1978 (SQP); Fletcher 1987, section 14.4 (exact penalty, elastic subproblem);
//! Zhou & Tits 1993 (arc search for minimax).

mod bfgs;
mod factor;
mod pieces;
mod point;
mod price;
mod probe;
mod project;
mod qp;
mod relaxation;
mod report;
mod search;
mod subspace;

use crate::callback::Callback;
use crate::jacobian::Jacobian;
use crate::method::Method;
use crate::parts::add_gradients;
use crate::problem::Problem;
use crate::program::{Kind, Program};
use crate::record::MAX_SOLVED_VIOLATION;
use crate::settings::Settings;
use crate::solution::{Counts, Solution};
use crate::status::{Limit, Status};

pub(crate) use point::violation;
pub(crate) use relaxation::{LinearKind, LinearModel};
pub(crate) use report::greatest;

use bfgs::Curvature;
use pieces::{Blend, Piece};
use point::{Evaluator, Point};
use qp::{Qp, QpSolution, RowKind, Rows};

/// What the search is after.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// The least level γ.
    Optimality,
    /// The least violation, whatever the objectives.
    Elastic,
}

/// First price of a unit of violation, in units of the objectives.
const FIRST_PRICE: f64 = 10.0;
/// Beyond this price a violation is not for sale.
const MAX_PRICE: f64 = 1e12;
/// Optimality that passes for a solution when rounding allows no further step.
const NEARLY_OPTIMAL: f64 = 1e-4;
/// A start with smaller gradients may be an optimum: what counts as small is then seen some distance off.
const SMALL_GRADIENT: f64 = 1e-4;
/// A level below this is taken for a fall without limit.
const UNBOUNDED_LEVEL: f64 = -1e30;

struct Sqp<'e, 'p, 'w, 'f> {
    program: &'p Program<'p>,
    settings: &'e Settings,
    evaluator: &'e mut Evaluator<'p, 'w, 'f>,
    curvature: Curvature,
    phase: Phase,
    price: f64,
    multipliers: Vec<f64>,
    history: Vec<f64>,
    /// Steps in a row that promised no more than rounding.
    quiet: usize,
    /// Rows of functions of parts that the last subproblem used, and what they were together.
    pieces: Vec<Piece>,
    blends: Vec<Blend>,
    /// What stationarity is compared with where all gradients vanish.
    gradient_floor: f64,
    /// What complementarity is compared with where the level is 0.
    level_floor: f64,
}

/// A point with everything that the functions expand to there, to first order.
struct Expansion {
    point: Point,
    jacobian: Jacobian,
    /// Of the parts.
    slopes: Jacobian,
}

/// Minimises the level of a program from its start, beginning with these counts. Around a solution other points are evaluated too:
/// whether one of them refutes it is known to whoever records the evaluations.
pub(crate) fn solve(
    problem: &Problem<'_>,
    method: &Method,
    settings: &Settings,
    callback: &mut Callback<'_>,
    counts: Counts,
) -> Solution {
    let program = Program::new(problem, method);
    let mut evaluator = Evaluator::new(&program, callback, counts);
    let onto = project::onto_linear(&program, settings, &mut || evaluator.is_stopped());
    let ended = match &onto {
        Ok(nearest) if evaluator.stopped => Some((nearest, Status::Stopped)),
        Ok(_) => None,
        Err((nearest, violations)) => Some((nearest, Status::NoFeasiblePoint(violations.clone()))),
    };
    if let Some((nearest, status)) = ended {
        evaluator.stopped = false;
        let point = evaluator.values(nearest);
        return report::solution(
            &program,
            settings,
            evaluator.counts,
            point,
            None,
            &[],
            status,
        );
    }
    let (Ok(start) | Err((start, _))) = onto;
    let point = evaluator.values(&start);
    let (mut solution, end) = search(&mut evaluator, settings, point);
    if solution.status.is_solved() && settings.probes > 0 {
        evaluator.reach(&end, Some(solution.kkt.stationarity));
        probe::around(&mut evaluator, settings.probes, &end);
        solution.counts = evaluator.counts;
        if evaluator.stopped {
            solution.status = Status::Stopped;
        }
    }
    solution
}

/// A point with its functions' values as a solution, without derivatives.
pub(crate) fn unexpanded(
    program: &Program<'_>,
    settings: &Settings,
    counts: Counts,
    (x, functions): (Vec<f64>, Vec<f64>),
    status: Status,
) -> Solution {
    let point = Point::new(program, x, functions, Vec::new());
    report::solution(program, settings, counts, point, None, &[], status)
}

/// One search from a point, with the point where it ended.
fn search(
    evaluator: &mut Evaluator<'_, '_, '_>,
    settings: &Settings,
    point: Point,
) -> (Solution, Point) {
    let program = evaluator.program;
    Sqp {
        program,
        settings,
        curvature: Curvature::new(program.dimension(), program.problem.curved(), 1.0),
        evaluator,
        phase: Phase::Optimality,
        price: FIRST_PRICE,
        multipliers: Vec::new(),
        history: Vec::new(),
        quiet: 0,
        pieces: Vec::new(),
        blends: Vec::new(),
        gradient_floor: 1.0,
        level_floor: 1.0,
    }
    .run(point)
}

impl Sqp<'_, '_, '_, '_> {
    fn run(mut self, start: Point) -> (Solution, Point) {
        let mut point = start;
        let (jacobian, slopes) = self.evaluator.derivatives(&mut point);
        let mut gradient = report::gradient_scale(self.program, &jacobian);
        let mut size = point.objective_size(self.program);
        if (f64::MIN_POSITIVE..SMALL_GRADIENT).contains(&gradient)
            && let Some((off, jacobian)) = probe::some_distance_off(self.evaluator, &point)
        {
            gradient = gradient.max(report::gradient_scale(self.program, &jacobian));
            size = size.max(off.objective_size(self.program));
        }
        if gradient > 0.0 {
            self.gradient_floor = gradient.min(1.0);
        }
        if size > 0.0 {
            self.level_floor = size.min(1.0);
        }
        let mut model = Expansion {
            point,
            jacobian,
            slopes,
        };
        let status = self.iterate(&mut model);
        let mut solution = report::solution(
            self.program,
            self.settings,
            self.evaluator.counts,
            model.point.clone(),
            Some(&model.jacobian),
            &self.multipliers,
            status,
        );
        // A start far outside the linear constraints may leave some of them violated.
        let allowed = self.settings.constraint_tolerance.max(MAX_SOLVED_VIOLATION);
        if solution.status.is_solved() && solution.kkt.violation > allowed {
            solution.status = Status::Stalled;
        }
        (solution, model.point)
    }

    fn iterate(&mut self, model: &mut Expansion) -> Status {
        let mut returns = 0;
        self.scale_curvature(model);
        loop {
            if self.evaluator.stopped {
                return Status::Stopped;
            }
            if let Some(status) = self.not_finite(model) {
                return status;
            }
            self.evaluator.reach(&model.point, None);
            let (mut rows, mut solution) = self.priced_step(model);
            self.blends = std::mem::take(&mut solution.blends);
            for blend in &self.blends {
                blend.place(&mut rows);
                blend.derive(&self.program.rows[blend.row], &mut model.jacobian);
            }
            self.multipliers.clone_from(&solution.multipliers);
            let stationarity = self.stationarity(&rows);
            let violation = model.point.worst_violation(self.program);
            self.evaluator.reach(&model.point, Some(stationarity));
            if self.evaluator.is_stopped() {
                return Status::Stopped;
            }
            let feasible = violation <= self.settings.constraint_tolerance;
            if self.phase == Phase::Elastic && feasible {
                // The way back: the price that did not suffice was too low.
                returns += 1;
                self.phase = Phase::Optimality;
                self.price = (self.price * 100.0).min(MAX_PRICE);
                self.restart(model);
                continue;
            }
            if self.is_stationary(model, &rows, &solution, stationarity) {
                match self.settle(model, feasible, returns, Status::Converged) {
                    Some(status) => return status,
                    None => continue,
                }
            }
            if self.evaluator.counts.iterations >= self.settings.max_iterations {
                return Status::Limit(Limit::Iterations);
            }
            if self.evaluator.counts.values >= self.settings.max_values {
                return Status::Limit(Limit::Values);
            }
            if model.point.level(self.program) < UNBOUNDED_LEVEL {
                return Status::Unbounded;
            }
            self.evaluator.counts.iterations += 1;
            let outcome = self.search(model, &rows, &solution);
            let ended = match outcome {
                search::Outcome::Step(next) => self.advance(model, next),
                search::Outcome::NoDecrease => Some(Status::SmallDirectionalDerivative),
                search::Outcome::NoStep => Some(Status::SmallStep),
            };
            if self.evaluator.stopped {
                return Status::Stopped;
            }
            if let Some(status) = ended {
                if self.evaluator.counts.values >= self.settings.max_values {
                    return Status::Limit(Limit::Values);
                }
                if !self.curvature.is_fresh() {
                    // What was learned may mislead: once more without it.
                    self.scale_curvature(model);
                    continue;
                }
                let nearly = self.nearly_stationary(model, &rows, &solution, stationarity);
                let status = if nearly { status } else { Status::Stalled };
                if let Some(status) = self.settle(model, feasible, returns, status) {
                    return status;
                }
            }
        }
    }

    /// Moves to an accepted point and learns its curvature. Says so if the step was none.
    fn advance(&mut self, model: &mut Expansion, mut next: Point) -> Option<Status> {
        let (jacobian, slopes) = self.evaluator.derivatives(&mut next);
        let s: Vec<f64> = next
            .x
            .iter()
            .zip(&model.point.x)
            .map(|(a, b)| a - b)
            .collect();
        let mut y = vec![0.0; s.len()];
        for (index, (row, &u)) in self.program.rows.iter().zip(&self.multipliers).enumerate() {
            if u == 0.0 {
                continue;
            }
            let slope = u * row.slope();
            if let Some(blend) = self.blends.iter().find(|blend| blend.row == index) {
                add_gradients(&blend.combination, slope, &slopes, &mut y);
                add_gradients(&blend.combination, -slope, &model.slopes, &mut y);
                continue;
            }
            let gradients = jacobian.row(row.function).iter();
            for (y, (new, old)) in y
                .iter_mut()
                .zip(gradients.zip(model.jacobian.row(row.function)))
            {
                *y += slope * (new - old);
            }
        }
        let length = s.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
        let size = model.point.x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        *model = Expansion {
            point: next,
            jacobian,
            slopes,
        };
        if length <= self.settings.step_tolerance * (1.0 + size) {
            return Some(Status::SmallStep);
        }
        self.curvature.update(&s, &y);
        None
    }

    /// What a stationary point means: the answer, or a change of phase (`None`).
    fn settle(
        &mut self,
        model: &Expansion,
        feasible: bool,
        returns: usize,
        status: Status,
    ) -> Option<Status> {
        if feasible {
            return Some(status);
        }
        if self.phase == Phase::Optimality && returns < 3 {
            self.phase = Phase::Elastic;
            self.restart(model);
            return None;
        }
        Some(Status::NoFeasiblePoint(report::violations(
            self.program,
            &model.point,
            self.settings.constraint_tolerance,
        )))
    }

    fn restart(&mut self, model: &Expansion) {
        self.multipliers.clear();
        self.history.clear();
        self.scale_curvature(model);
    }

    /// Starts the curvature over: the identity, or less where the gradients are so small that the first
    /// step would be shorter than x is large. (Tried on the whole set of tests/literature: any scale above
    /// 1 costs Jacobians, because too long a step is refused by values alone.)
    fn scale_curvature(&mut self, model: &Expansion) {
        let gradient = self
            .program
            .rows
            .iter()
            .filter(|row| row.kind.is_objective() == (self.phase == Phase::Optimality))
            .map(|row| model.jacobian.row_norm(row.function) * row.scale)
            .fold(0.0, f64::max);
        let size = model.point.x.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
        let scale = gradient / size;
        self.curvature.reset(if scale > 0.0 {
            scale.clamp(1e-8, 1.0)
        } else {
            1.0
        });
    }

    fn not_finite(&self, model: &Expansion) -> Option<Status> {
        let function = model.point.not_finite(self.program).or_else(|| {
            self.program
                .rows
                .iter()
                .map(|row| row.function)
                .find(|&f| model.jacobian.row(f).iter().any(|g| !g.is_finite()))
        })?;
        let problem = self.program.problem;
        Some(Status::NotFinite {
            function: problem.function_name(function).to_owned(),
            reason: problem
                .model()
                .failure(&model.point.x[..problem.variables().len()]),
        })
    }

    /// The rows of the subproblem at this point and price.
    fn linearise(&self, model: &Expansion, price: f64) -> Rows {
        let n = self.program.dimension();
        let mut rows = Rows {
            parts: model.point.parts.clone(),
            ..Rows::default()
        };
        for (row, &value) in self.program.rows.iter().zip(&model.point.rows) {
            rows.kinds.push(match (row.kind, self.phase) {
                (Kind::Objective(_), Phase::Optimality) => RowKind::Objective,
                (Kind::Objective(_), Phase::Elastic) => RowKind::Ignored,
                (Kind::HardGoal(_) | Kind::Inequality(_), _) => RowKind::Inequality { cap: price },
                (Kind::Equality(_), _) => RowKind::Equality { cap: price },
            });
            rows.offsets.push(value);
            let slope = row.slope();
            rows.gradients
                .extend(model.jacobian.row(row.function).iter().map(|g| slope * g));
        }
        for row in &self.program.linear {
            rows.kinds.push(if row.equal {
                RowKind::Equality { cap: f64::INFINITY }
            } else {
                RowKind::Inequality { cap: f64::INFINITY }
            });
            rows.offsets
                .push(subspace::dot(&row.coefficients, &model.point.x) - row.bound);
            rows.gradients.extend(&row.coefficients);
        }
        debug_assert_eq!(rows.gradients.len(), rows.kinds.len() * n);
        rows
    }

    fn plain_subproblem(&mut self, model: &Expansion, rows: &Rows, warm: &[f64]) -> QpSolution {
        let lower: Vec<f64> = Self::room(&self.program.lower, model);
        let upper: Vec<f64> = Self::room(&self.program.upper, model);
        let factor = self.curvature.factor();
        let guess;
        let warm = if warm.is_empty() {
            guess = guess_multipliers(rows, &lower, &upper, self.curvature.scale());
            &guess
        } else {
            warm
        };
        Qp {
            factor: &factor,
            rows,
            lower: &lower,
            upper: &upper,
        }
        .solve(warm, &mut || self.evaluator.is_stopped())
    }

    fn room(bounds: &[f64], model: &Expansion) -> Vec<f64> {
        bounds
            .iter()
            .zip(&model.point.x)
            .map(|(b, x)| b - x)
            .collect()
    }

    /// ‖∇L‖∞ with the subproblem's multipliers.
    fn stationarity(&self, rows: &Rows) -> f64 {
        let n = self.program.dimension();
        report::lagrangian_gradient(n, rows, &self.multipliers)
            .iter()
            .fold(0.0, |m, g| g.abs().max(m))
    }

    fn is_stationary(
        &self,
        model: &Expansion,
        rows: &Rows,
        solution: &QpSolution,
        stationarity: f64,
    ) -> bool {
        let tolerance = self.settings.optimality_tolerance;
        self.optimality(model, rows, solution, stationarity) <= tolerance
    }

    /// Do the optimality conditions hold well enough to call a point without a further step a solution?
    fn nearly_stationary(
        &self,
        model: &Expansion,
        rows: &Rows,
        solution: &QpSolution,
        stationarity: f64,
    ) -> bool {
        let tolerance = self.settings.optimality_tolerance.max(NEARLY_OPTIMAL);
        self.optimality(model, rows, solution, stationarity) <= tolerance
    }

    /// How far the optimality conditions are from holding, relative to their sizes.
    fn optimality(
        &self,
        model: &Expansion,
        rows: &Rows,
        solution: &QpSolution,
        stationarity: f64,
    ) -> f64 {
        let scale = self.gradient_floor.max(report::weighted_gradient_scale(
            self.program,
            &model.jacobian,
            &solution.multipliers,
        ));
        let level = model.point.level(self.program);
        let complementarity = report::complementarity(
            rows,
            if self.phase == Phase::Optimality {
                level
            } else {
                0.0
            },
            &Self::room(&self.program.lower, model),
            &Self::room(&self.program.upper, model),
            &solution.multipliers,
        );
        let allowed = match self.phase {
            Phase::Optimality => self.level_floor + level.abs(),
            Phase::Elastic => 1.0,
        };
        (stationarity / scale).max(complementarity / allowed)
    }
}

/// Where to begin without multipliers: the highest objective decides, and every bound that its step would
/// pass takes what pushes against it, which is right for B = scale · I and this objective alone. Spares the
/// subproblem finding the bounds one by one.
fn guess_multipliers(rows: &Rows, lower: &[f64], upper: &[f64], scale: f64) -> Vec<f64> {
    let (count, n) = (rows.kinds.len(), lower.len());
    let mut guess = vec![0.0; count + 2 * n];
    let highest = (0..count)
        .filter(|&row| rows.kinds[row] == RowKind::Objective)
        .max_by(|&a, &b| rows.offsets[a].total_cmp(&rows.offsets[b]));
    let Some(highest) = highest else {
        return guess;
    };
    guess[highest] = 1.0;
    let gradient = &rows.gradients[highest * n..(highest + 1) * n];
    for (i, g) in gradient.iter().enumerate() {
        guess[count + 2 * i] = (g + scale * lower[i]).max(0.0);
        guess[count + 2 * i + 1] = (-g - scale * upper[i]).max(0.0);
    }
    guess
}
