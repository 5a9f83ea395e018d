//! Derivatives by finite differences, for functions that run on `f64` alone.

use crate::jacobian::Jacobian;
use crate::model::Model;
use crate::watch::Watch;

/// ∛ε: the relative step at which a central difference has the least error.
const CBRT_EPSILON: f64 = 6.055_454_452_393_343e-6;

/// A closure as a [`Model`], differentiated numerically.
///
/// (f(x + h) − f(x − h))/2h with h = ε^(1/3)·max(1, |x|): 2 n + 1 values, error about 1e-10.
/// Inside [`Differences::within`] bounds no point outside is ever evaluated: next to a bound a central
/// difference turns into a one-sided one of second order.
#[derive(Clone, Debug)]
pub struct Differences<F> {
    function: F,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl<F: Fn(&[f64], &mut [f64]) + Sync> Differences<F> {
    /// Central differences of `function`, which writes every function's value.
    pub fn new(function: F) -> Self {
        Self {
            function,
            lower: Vec::new(),
            upper: Vec::new(),
        }
    }

    /// Never evaluates outside these bounds (infinite ones are none).
    #[must_use]
    pub fn within(mut self, lower: &[f64], upper: &[f64]) -> Self {
        self.lower = lower.to_vec();
        self.upper = upper.to_vec();
        self
    }

    /// Two steps from `value` that stay within `below` and `above` of it.
    fn steps(value: f64, below: f64, above: f64) -> Option<[f64; 2]> {
        let wish = CBRT_EPSILON * value.abs().max(1.0);
        let (room, sign) = if above >= wish || above >= below {
            (above, 1.0)
        } else {
            (below, -1.0)
        };
        if !(room > 0.0) {
            return None;
        }
        Some(if above >= wish && below >= wish {
            [wish, -wish]
        } else {
            let step = sign * wish.min(0.5 * room);
            [step, 2.0 * step]
        })
    }

    fn room(&self, x: &[f64], column: usize) -> (f64, f64) {
        let low = self.lower.get(column).copied().unwrap_or(f64::NEG_INFINITY);
        let high = self.upper.get(column).copied().unwrap_or(f64::INFINITY);
        (x[column] - low, high - x[column])
    }
}

impl<F: Fn(&[f64], &mut [f64]) + Sync> Model for Differences<F> {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        (self.function)(x, values);
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        self.evaluate(x, values, Some(jacobian), &mut || false);
    }

    fn evaluate(
        &self,
        x: &[f64],
        values: &mut [f64],
        jacobian: Option<&mut Jacobian>,
        watch: &mut dyn Watch,
    ) {
        self.values(x, values);
        let Some(jacobian) = jacobian else {
            return;
        };
        let mut point = x.to_vec();
        let (mut one, mut two) = (values.to_vec(), values.to_vec());
        for column in 0..x.len() {
            let (below, above) = self.room(x, column);
            let Some(steps) = Self::steps(x[column], below, above) else {
                // A variable that its bounds hold in place has no direction to differentiate in.
                (0..values.len()).for_each(|row| jacobian.set(row, column, 0.0));
                continue;
            };
            // The step that the number format represents at x, not the one wished for.
            let mut at = |offset: f64, out: &mut [f64]| {
                point[column] = x[column] + offset;
                self.values(&point, out);
                watch.seen(&point, out);
                let step = point[column] - x[column];
                point[column] = x[column];
                step
            };
            let h = at(steps[0], &mut one);
            let k = at(steps[1], &mut two);
            // (f(x + h) − f(x)) w_1 + (f(x + k) − f(x)) w_2: exact for a quadratic.
            let (w_1, w_2) = (k / (h * (k - h)), -h / (k * (k - h)));
            for row in 0..values.len() {
                let slope = (one[row] - values[row]) * w_1 + (two[row] - values[row]) * w_2;
                jacobian.set(row, column, slope);
            }
        }
    }
}
