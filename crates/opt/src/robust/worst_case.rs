//! Every objective in every world as a partial function of its own.

use super::Worlds;
use crate::error::Result;
use crate::jacobian::Jacobian;
use crate::model::Model;
use crate::problem::{Problem, ProblemParams};
use crate::tape::TapedFunctions;

struct WorstCase<'a>(Worlds<'a>);

impl Model for WorstCase<'_> {
    fn failure(&self, x: &[f64]) -> Option<String> {
        self.0.failure(x)
    }

    fn values(&self, x: &[f64], values: &mut [f64]) {
        let worlds = self.0.values(x);
        for (slot, (function, world)) in values.iter_mut().zip(order(&self.0)) {
            *slot = worlds[world][function];
        }
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        let worlds = self.0.derivatives(x);
        for (row, (function, world)) in order(&self.0).enumerate() {
            values[row] = worlds[world].0[function];
            jacobian
                .row_mut(row)
                .copy_from_slice(worlds[world].1.row(function));
        }
    }

    fn taped(&self, _variables: usize, _functions: usize) -> Option<TapedFunctions> {
        self.0.taped()
    }
}

/// (function, world) in joint order: all worlds of the first function, then of the second, …
fn order(worlds: &Worlds<'_>) -> impl Iterator<Item = (usize, usize)> {
    let count = worlds.count();
    (0..worlds.functions).flat_map(move |f| (0..count).map(move |w| (f, w)))
}

pub(super) fn problem<'a>(params: ProblemParams<'a>, worlds: Worlds<'a>) -> Result<Problem<'a>> {
    Problem::new(ProblemParams {
        objectives: worlds.names(&params.objectives),
        inequalities: worlds.names(&params.inequalities),
        equalities: worlds.names(&params.equalities),
        absolute: worlds.absolute * worlds.count(),
        worlds: worlds.count(),
        variables: params.variables,
        linear: params.linear,
        model: Box::new(WorstCase(worlds)),
    })
}
