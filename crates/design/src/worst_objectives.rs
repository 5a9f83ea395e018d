//! Objectives over several worlds, each on its worst.

use grouser_opt::{Jacobian, Model, Problem};

/// Objectives that are the worst over several worlds; constraints hold in every one.
pub(crate) struct WorstObjectives {
    pub(crate) joint: Problem<'static>,
    pub(crate) objectives: usize,
    /// How many of them count by their magnitude; they come first.
    pub(crate) absolute: usize,
}

impl WorstObjectives {
    /// For each of its functions the place of that function among the joint ones.
    fn places(&self, values: &[f64]) -> Vec<usize> {
        let count = self.joint.objectives().len();
        let worlds = count / self.objectives;
        let size = |function: usize, place: usize| {
            if function < self.absolute {
                values[place].abs()
            } else {
                values[place]
            }
        };
        let worst = |function: usize| {
            let first = function * worlds;
            (first..first + worlds)
                .reduce(|a, b| {
                    let (old, new) = (size(function, a), size(function, b));
                    if new > old || new.is_nan() { b } else { a }
                })
                .unwrap_or(first)
        };
        let own = (0..self.objectives).map(worst);
        own.chain(count..values.len()).collect()
    }
}

impl Model for WorstObjectives {
    fn failure(&self, x: &[f64]) -> Option<String> {
        self.joint.model().failure(x)
    }

    fn values(&self, x: &[f64], values: &mut [f64]) {
        let inner = &self.joint;
        let mut all = vec![f64::NAN; inner.function_count()];
        inner.model().values(x, &mut all);
        for (value, place) in values.iter_mut().zip(self.places(&all)) {
            *value = all[place];
        }
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        let inner = &self.joint;
        let mut all = vec![f64::NAN; inner.function_count()];
        let mut rows = Jacobian::zeros(inner.function_count(), x.len());
        inner.model().derivatives(x, &mut all, &mut rows);
        for (row, place) in self.places(&all).into_iter().enumerate() {
            values[row] = all[place];
            jacobian.row_mut(row).copy_from_slice(rows.row(place));
        }
    }
}
