//! What a search evaluates: every solver sees the functions of a problem through a model that notes each evaluation.

use crate::jacobian::Jacobian;
use crate::model::Model;
use crate::parts::{Parts, functions};
use crate::watch::Watch;

/// A decrease of the utility beyond this · (1 + |utility|) refutes a solution. The optimality conditions themselves leave 1e-8 of
/// it open ([`crate::Settings::optimality_tolerance`]).
pub(crate) const REFUTING_DECREASE: f64 = 1e-7;
/// A point that violates a constraint by more than this is no solution, whatever its optimality.
pub(crate) const MAX_SOLVED_VIOLATION: f64 = 1e-6;

/// Notes evaluations, from any thread.
pub(crate) trait Record: Sync {
    /// All functions have these values at `x`.
    fn note(&self, x: &[f64], functions: &[f64]);
}

/// A model whose evaluations are noted.
pub(crate) struct Recorded<'a> {
    model: &'a dyn Model,
    functions: usize,
    record: &'a dyn Record,
}

impl<'a> Recorded<'a> {
    /// A model of so many functions.
    pub(crate) fn new(model: &'a dyn Model, functions: usize, record: &'a dyn Record) -> Self {
        Self {
            model,
            functions,
            record,
        }
    }
}

/// Passes on what an evaluation reports, and notes points that the derivatives needed.
struct Followed<'a> {
    watch: &'a mut dyn Watch,
    record: &'a dyn Record,
    stopped: bool,
}

impl Watch for Followed<'_> {
    fn stop(&mut self) -> bool {
        self.stopped |= self.watch.stop();
        self.stopped
    }

    fn seen(&mut self, x: &[f64], functions: &[f64]) {
        self.record.note(x, functions);
        self.watch.seen(x, functions);
    }
}

impl Model for Recorded<'_> {
    fn failure(&self, x: &[f64]) -> Option<String> {
        self.model.failure(x)
    }

    fn values(&self, x: &[f64], values: &mut [f64]) {
        Model::evaluate(self, x, values, None, &mut || false);
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        Model::evaluate(self, x, values, Some(jacobian), &mut || false);
    }

    fn evaluate(
        &self,
        x: &[f64],
        values: &mut [f64],
        jacobian: Option<&mut Jacobian>,
        watch: &mut dyn Watch,
    ) {
        let (record, stopped) = (self.record, false);
        let mut followed = Followed {
            watch,
            record,
            stopped,
        };
        self.model.evaluate(x, values, jacobian, &mut followed);
        if !followed.stopped {
            self.record.note(x, values);
        }
    }

    fn parts(&self) -> Option<&dyn Parts> {
        self.model.parts().map(|_| self as &dyn Parts)
    }
}

impl Parts for Recorded<'_> {
    fn count(&self) -> usize {
        self.model.parts().map_or(0, Parts::count)
    }

    fn evaluate(
        &self,
        x: &[f64],
        parts: &mut [f64],
        jacobian: Option<&mut Jacobian>,
        watch: &mut dyn Watch,
    ) {
        let Some(source) = self.model.parts() else {
            return;
        };
        let (record, stopped) = (self.record, false);
        let mut followed = Followed {
            watch,
            record,
            stopped,
        };
        source.evaluate(x, parts, jacobian, &mut followed);
        if !followed.stopped {
            let mut values = vec![f64::NAN; self.functions];
            functions(source, parts, &mut values);
            self.record.note(x, &values);
        }
    }

    fn combination(&self, function: usize, parts: &[f64]) -> Vec<(usize, f64)> {
        let source = self.model.parts();
        source.map_or_else(Vec::new, |source| source.combination(function, parts))
    }
}
