//! Functions that are combinations of many parts, the greatest of a set of them.

use crate::jacobian::Jacobian;
use crate::watch::Watch;

/// What stands behind the functions of a problem whose objectives have kinks that are known: every function is the greatest of
/// a set of linear combinations of parts, and of constraints there is one. A solver can then linearise the parts, and choose the
/// combination anew wherever it looks.
pub trait Parts: Sync {
    /// The number of parts.
    fn count(&self) -> usize;

    /// Writes the value of every part at `x` and, with a Jacobian, its gradient, followed by `watch`.
    fn evaluate(
        &self,
        x: &[f64],
        parts: &mut [f64],
        jacobian: Option<&mut Jacobian>,
        watch: &mut dyn Watch,
    );

    /// The combination that is the greatest for these values of the parts; one that has no value is part of it.
    fn combination(&self, function: usize, parts: &[f64]) -> Vec<(usize, f64)>;
}

/// Σ c v of a combination.
pub(crate) fn combined(combination: &[(usize, f64)], values: &[f64]) -> f64 {
    combination.iter().map(|(k, c)| c * values[*k]).sum()
}

/// Adds `factor` · Σ c ∇v to `gradient`.
pub(crate) fn add_gradients(
    combination: &[(usize, f64)],
    factor: f64,
    jacobian: &Jacobian,
    gradient: &mut [f64],
) {
    for (k, c) in combination {
        for (sum, g) in gradient.iter_mut().zip(jacobian.row(*k)) {
            *sum += factor * c * g;
        }
    }
}

/// All functions of a problem, from its parts.
pub(crate) fn functions(source: &dyn Parts, parts: &[f64], functions: &mut [f64]) {
    for (function, value) in functions.iter_mut().enumerate() {
        *value = combined(&source.combination(function, parts), parts);
    }
}

/// The gradients of all functions of a problem, from its parts.
pub(crate) fn gradients(
    source: &dyn Parts,
    (parts, slopes): (&[f64], &Jacobian),
    jacobian: &mut Jacobian,
) {
    for function in 0..jacobian.rows() {
        let row = jacobian.row_mut(function);
        row.fill(0.0);
        add_gradients(&source.combination(function, parts), 1.0, slopes, row);
    }
}
