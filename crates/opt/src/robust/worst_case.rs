//! Every objective in every world as a partial function of its own.

use super::{Values, Worlds};
use crate::error::Result;
use crate::jacobian::Jacobian;
use crate::model::Model;
use crate::problem::{Problem, ProblemParams};
use crate::tape::TapedFunctions;
use crate::watch::Watch;

struct WorstCase<'a>(Worlds<'a>);

impl Model for WorstCase<'_> {
    fn failure(&self, x: &[f64]) -> Option<String> {
        self.0.failure(x)
    }

    fn values(&self, x: &[f64], values: &mut [f64]) {
        self.evaluate(x, values, None, &mut || false);
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        self.evaluate(x, values, Some(jacobian), &mut || false);
    }

    fn evaluate(
        &self,
        x: &[f64],
        values: &mut [f64],
        mut jacobian: Option<&mut Jacobian>,
        watch: &mut dyn Watch,
    ) {
        let join = |worlds: &[Values]| {
            let all = order(&self.0).map(|(function, world)| worlds[world].0[function]);
            all.collect()
        };
        let worlds = self.0.evaluate(x, jacobian.is_some(), watch, &join);
        for (row, (function, world)) in order(&self.0).enumerate() {
            let (own, gradients) = &worlds[world];
            values[row] = own[function];
            if let Some(jacobian) = &mut jacobian {
                let gradient = gradients.row(function);
                jacobian.row_mut(row).copy_from_slice(gradient);
            }
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
