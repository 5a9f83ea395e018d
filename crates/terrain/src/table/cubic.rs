//! Interpolation on even grids by the cubic through the four nearest nodes.

/// Nodes that a cubic needs. A closed table has fewer, and none of them is read.
pub(crate) const MIN_NODES: usize = 4;

/// Four neighbouring nodes and their weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stencil {
    first: usize,
    weights: [f64; 4],
}

impl Stencil {
    /// The place `share` of [0, 1] on `nodes` nodes, at least [`MIN_NODES`]; at the ends the outermost four nodes serve.
    pub(crate) fn new(share: f64, nodes: usize) -> Self {
        let place = share * (nodes - 1) as f64;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the grid; the cast saturates"
        )]
        let cell = (place.max(0.0) as usize).clamp(1, nodes - 3);
        let x = place - (cell - 1) as f64;
        // Lagrange's polynomials on the nodes 0, 1, 2, 3
        let (a, b, c, d) = (x, x - 1.0, x - 2.0, x - 3.0);
        Self {
            first: cell - 1,
            weights: [
                b * c * d * (-1.0 / 6.0),
                a * c * d * 0.5,
                a * b * d * -0.5,
                a * b * c * (1.0 / 6.0),
            ],
        }
    }

    /// The value of one row.
    #[inline]
    pub(crate) fn along(&self, row: &[f64]) -> f64 {
        let Some([a, b, c, d]) = row.get(self.first..).and_then(<[f64]>::first_chunk) else {
            return f64::NAN;
        };
        let [p, q, r, s] = self.weights;
        a * p + b * q + c * r + d * s
    }
}

/// The value of a grid of rows of `columns` nodes.
#[inline]
pub(crate) fn at(grid: &[f64], columns: usize, across: &Stencil, along: &Stencil) -> f64 {
    let start = across.first * columns + along.first;
    let mut sum = 0.0;
    for (row, weight) in across.weights.iter().enumerate() {
        let from = start + row * columns;
        let Some([a, b, c, d]) = grid.get(from..).and_then(<[f64]>::first_chunk) else {
            return f64::NAN;
        };
        let [p, q, r, s] = along.weights;
        sum += weight * (a * p + b * q + c * r + d * s);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_are_exact_up_to_both_ends() {
        let f = |x: f64| 1.0 - 2.0 * x + 3.0 * x * x - 0.5 * x * x * x;
        let nodes = 7;
        let row: Vec<f64> = (0..nodes).map(|i| f(f64::from(i) / 6.0)).collect();
        for i in 0..=60 {
            let x = f64::from(i) / 60.0;
            assert!((Stencil::new(x, 7).along(&row) - f(x)).abs() < 1e-13);
        }
    }

    #[test]
    fn grids_are_products_of_rows() {
        let grid: Vec<f64> = (0..35)
            .map(|i| f64::from(i / 5).powi(2) * (1.0 + f64::from(i % 5)))
            .collect();
        let value = at(&grid, 5, &Stencil::new(0.5, 7), &Stencil::new(0.3, 5));
        assert!((value - 9.0 * 2.2).abs() < 1e-12);
    }
}
