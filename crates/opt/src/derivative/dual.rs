//! Exact derivatives: the functions run on dual numbers, a few directions at a time.

use grouser_real::{Dual, Scalar};

use super::trace;
use crate::jacobian::Jacobian;
use crate::model::Model;
use crate::tape::TapedFunctions;

/// Functions written once over a generic number.
///
/// ```
/// use grouser_opt::{Exact, Functions, Jacobian, Model};
/// use grouser_real::Scalar;
///
/// struct Product;
/// impl Functions for Product {
///     fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
///         out[0] = x[0] * x[1];
///     }
/// }
///
/// let (mut values, mut jacobian) = ([0.0], Jacobian::zeros(1, 2));
/// Exact(Product).derivatives(&[2.0, 5.0], &mut values, &mut jacobian);
/// assert_eq!((values, jacobian.row(0)), ([10.0], [5.0, 2.0].as_slice()));
/// ```
pub trait Functions: Sync {
    /// Writes every function's value at `x`: objectives, inequalities, equalities.
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]);
}

/// Turns [`Functions`] into a [`Model`] with derivatives exact to rounding.
///
/// With n variables the functions run ⌈n/N⌉ times on numbers of N ∈ {2, 4, 8} directions.
#[derive(Clone, Copy, Debug)]
pub struct Exact<F>(pub F);

impl<F: Functions> Exact<F> {
    fn chunked<const N: usize>(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        let mut variables: Vec<Dual<N>> = x.iter().map(|&value| Dual::constant(value)).collect();
        let mut results = vec![Dual::<N>::constant(f64::NAN); values.len()];
        let mut first = 0;
        loop {
            let directions = first..x.len().min(first + N);
            for (direction, column) in directions.clone().enumerate() {
                variables[column] = Dual::variable(x[column], direction);
            }
            self.0.evaluate(&variables, &mut results);
            for (row, result) in results.iter().enumerate() {
                values[row] = result.value;
                for (slot, slope) in jacobian.row_mut(row)[directions.clone()]
                    .iter_mut()
                    .zip(&result.gradient)
                {
                    *slot = *slope;
                }
            }
            for column in directions {
                variables[column] = Dual::constant(x[column]);
            }
            first += N;
            if first >= x.len() {
                break;
            }
        }
    }
}

impl<F: Functions> Model for Exact<F> {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        self.0.evaluate(x, values);
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        match x.len() {
            0..=2 => self.chunked::<2>(x, values, jacobian),
            3 | 4 => self.chunked::<4>(x, values, jacobian),
            _ => self.chunked::<8>(x, values, jacobian),
        }
    }
    fn taped(&self, variables: usize, functions: usize) -> Option<TapedFunctions> {
        trace::trace(&self.0, variables, functions)
    }
}
