//! Robust design: the same problem under many possible worlds at once.
//!
//! Each world (a soil sample, a load case) is a [`Model`] with the same functions. [`robust`] joins K of them
//! into one problem, whose objectives are what a [`Measure`] makes of the m·K partial functions.
//! Constraints must hold in every world.

mod cvar;
mod measure;
mod normal;
mod samples;
mod spread;
mod worst_case;

use crate::error::{Error, Result};
use crate::jacobian::Jacobian;
use crate::model::Model;
use crate::problem::{Problem, ProblemParams};
use crate::tape::{Tape, TapedFunctions};
use crate::watch::Watch;

pub use measure::Measure;
pub use samples::{Uncertainty, sample};

/// Worlds between two calls of the callback: some milliseconds of a wheel on as many soils.
const WORLDS_PER_CALL: usize = 64;

/// One possible world.
pub struct World<'a> {
    /// Its name in reports: `objective @ name`.
    pub name: String,
    /// The functions as they are in it.
    pub model: Box<dyn Model + 'a>,
}

impl<'a> World<'a> {
    /// A world and its name.
    pub fn new(name: impl Into<String>, model: impl Model + 'a) -> Self {
        Self {
            name: name.into(),
            model: Box::new(model),
        }
    }
}

/// Joins `worlds` into one problem. `params` describes it; its own model is one world more only if it is
/// among them, and is not used otherwise.
///
/// # Errors
/// No worlds, a measure's parameter outside its range, and what [`Problem::new`] refuses.
///
/// ```
/// use grouser_opt::{Differences, Measure, Method, ProblemParams, Settings, World, robust, solve};
///
/// // (x − a)² for a = 0, 1, 4: the best worst case lies half-way between the extremes.
/// let at = |a: f64| Differences::new(move |x: &[f64], f: &mut [f64]| f[0] = (x[0] - a).powi(2));
/// let params = ProblemParams::new(&[0.5], 1, at(0.0));
/// let worlds = [0.0, 1.0, 4.0].map(|a| World::new(a.to_string(), at(a)));
/// let joint = robust(params, worlds.into(), Measure::WorstCase)?;
/// let solution = solve(&joint, &Method::Minimax, &Settings::default())?;
/// assert!((solution.x[0] - 2.0).abs() < 1e-6);
/// assert!((solution.multipliers.objectives[0] - 0.5).abs() < 1e-6);
/// # Ok::<(), grouser_opt::Error>(())
/// ```
pub fn robust<'a>(
    params: ProblemParams<'a>,
    worlds: Vec<World<'a>>,
    measure: Measure,
) -> Result<Problem<'a>> {
    if worlds.is_empty() {
        return Err(Error::Empty { what: "worlds" });
    }
    measure.check()?;
    let worlds = Worlds {
        n: params.variables.len(),
        m: params.objectives.len(),
        functions: params.objectives.len() + params.inequalities.len() + params.equalities.len(),
        absolute: params.absolute,
        list: worlds,
    };
    match measure {
        Measure::WorstCase => worst_case::problem(params, worlds),
        Measure::MeanPlusDeviations { kappa } => spread::problem(params, worlds, kappa),
        Measure::ConditionalValueAtRisk { alpha } => cvar::problem(params, worlds, alpha),
    }
}

/// K models with the same functions over the same variables.
struct Worlds<'a> {
    n: usize,
    m: usize,
    functions: usize,
    absolute: usize,
    list: Vec<World<'a>>,
}

/// The values of all functions in a world, with their gradients where they are known.
type Values = (Vec<f64>, Jacobian);

/// Points that the derivatives of one world after the other needed, with the values in each.
#[derive(Default)]
struct Seen {
    points: Vec<(Vec<f64>, Vec<Values>)>,
    /// The place of the next point of this world.
    next: usize,
}

impl Watch for Seen {
    fn stop(&mut self) -> bool {
        false
    }

    fn seen(&mut self, x: &[f64], functions: &[f64]) {
        let values = (functions.to_vec(), Jacobian::zeros(0, x.len()));
        match self.points.get_mut(self.next) {
            Some((at, worlds)) if at == x => worlds.push(values),
            Some(_) => {}
            None => self.points.push((x.to_vec(), vec![values])),
        }
        self.next += 1;
    }
}

impl Worlds<'_> {
    fn count(&self) -> usize {
        self.list.len()
    }

    /// Why a function has no value at `x`, in the first world where it has none.
    fn failure(&self, x: &[f64]) -> Option<String> {
        self.list.iter().find_map(|world| {
            let reason = world.model.failure(&x[..self.n])?;
            Some(format!("in {}, {reason}", world.name))
        })
    }

    /// The function values of every world, with their gradients where they are wanted; NaN from where `watch` stops it. Points that
    /// the derivatives of all worlds needed are reported with what `join` makes of them.
    fn evaluate(
        &self,
        x: &[f64],
        has_gradients: bool,
        watch: &mut dyn Watch,
        join: &dyn Fn(&[Values]) -> Vec<f64>,
    ) -> Vec<Values> {
        let mut seen = Seen::default();
        let rows = if has_gradients { self.functions } else { 0 };
        let mut stopped = false;
        let worlds = self.list.iter().enumerate();
        let all = worlds
            .map(|(index, world)| {
                seen.next = 0;
                let mut values = vec![f64::NAN; self.functions];
                let mut jacobian = Jacobian::zeros(rows, self.n);
                stopped =
                    stopped || (index % WORLDS_PER_CALL == WORLDS_PER_CALL - 1 && watch.stop());
                if !stopped {
                    let jacobian = has_gradients.then_some(&mut jacobian);
                    world
                        .model
                        .evaluate(&x[..self.n], &mut values, jacobian, &mut seen);
                }
                (values, jacobian)
            })
            .collect();
        for (x, worlds) in &seen.points {
            if worlds.len() == self.count() {
                watch.seen(x, &join(worlds));
            }
        }
        all
    }

    /// The functions of every world on one tape: their nodes by function, then by world.
    fn taped(&self) -> Option<TapedFunctions> {
        let mut tape = Tape::new();
        let mut nodes = Vec::new();
        for world in &self.list {
            let own = world.model.taped(self.n, self.functions)?;
            let at = tape.append(&own.tape);
            nodes.push(
                own.functions
                    .iter()
                    .map(|f| at[*f as usize])
                    .collect::<Vec<_>>(),
            );
        }
        let functions = (0..self.functions)
            .flat_map(|f| nodes.iter().map(move |world| world[f]))
            .collect();
        Some(TapedFunctions { tape, functions })
    }

    /// `name @ world`, for every world, for every name: the order of all joint lists.
    fn names(&self, names: &[String]) -> Vec<String> {
        names
            .iter()
            .flat_map(|name| {
                let worlds = self.list.iter();
                worlds.map(move |world| format!("{name} @ {}", world.name))
            })
            .collect()
    }
}
