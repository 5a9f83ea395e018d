//! Fixed-interval smoothing of a linear model with scalar measurements: the modified Bryson-Frazier form (Bierman,
//! "Fixed interval smoothing with discrete measurements", Int. J. Control 18, 1973), which inverts no covariance.
#![allow(
    clippy::needless_range_loop,
    reason = "the equations are those of matrices, by row and column"
)]

/// Number of states.
pub(super) const GRID_STATES: usize = 5;

type Vector = [f64; GRID_STATES];
type Matrix = [[f64; GRID_STATES]; GRID_STATES];

/// Mean and covariance.
pub(super) type State = (Vector, Matrix);

/// One scalar measurement.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measurement {
    pub(super) jacobian: [(usize, f64); 3],
    pub(super) value: f64,
    pub(super) variance: f64,
}

/// One interval as the forward pass met it: the transition to it, the state before its measurements, and these.
#[derive(Debug)]
struct Met {
    transition: Matrix,
    state: State,
    measurements: Vec<Measurement>,
}

/// Forward pass and what the backward pass needs of it.
#[derive(Debug)]
pub(super) struct LinearSmoother {
    met: Vec<Met>,
    transition: Matrix,
}

const fn identity() -> Matrix {
    let mut one = [[0.0; GRID_STATES]; GRID_STATES];
    let mut i = 0;
    while i < GRID_STATES {
        one[i][i] = 1.0;
        i += 1;
    }
    one
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut out = [[0.0; GRID_STATES]; GRID_STATES];
    for (row, a) in out.iter_mut().zip(a) {
        for (factor, b) in a.iter().zip(b).filter(|(factor, _)| **factor != 0.0) {
            for (slot, value) in row.iter_mut().zip(b) {
                *slot += factor * value;
            }
        }
    }
    out
}

fn transpose(a: &Matrix) -> Matrix {
    core::array::from_fn(|i| core::array::from_fn(|j| a[j][i]))
}

fn times(a: &Matrix, x: &Vector) -> Vector {
    core::array::from_fn(|i| a[i].iter().zip(x).map(|(a, x)| a * x).sum())
}

impl Measurement {
    fn row(&self) -> Vector {
        let mut row = [0.0; GRID_STATES];
        for (i, coefficient) in self.jacobian {
            row[i] += coefficient;
        }
        row
    }

    /// Gain, innovation and its variance.
    fn gain(&self, (mean, covariance): &State) -> (Vector, f64, f64) {
        let row = self.row();
        let spread = times(covariance, &row);
        let dot = |a: &Vector, b: &Vector| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let variance = dot(&row, &spread) + self.variance;
        let innovation = self.value - dot(&row, mean);
        (spread.map(|part| part / variance), innovation, variance)
    }

    fn update(&self, state: &mut State) {
        let (gain, innovation, variance) = self.gain(state);
        let (mean, covariance) = state;
        for i in 0..GRID_STATES {
            mean[i] += gain[i] * innovation;
            for j in 0..GRID_STATES {
                covariance[i][j] -= gain[i] * gain[j] * variance;
            }
        }
    }
}

impl LinearSmoother {
    pub(super) fn with_capacity(intervals: usize) -> Self {
        Self {
            met: Vec::with_capacity(intervals),
            transition: identity(),
        }
    }

    /// Predicts: x_i becomes 0 for each of `begins`, x_i += a x_j for each of `terms`, then `copy.0` becomes the old `copy.1`; adds
    /// `noise` to the covariance.
    pub(super) fn predict(
        &mut self,
        begins: &[usize],
        terms: &[(usize, usize, f64)],
        copy: (usize, usize),
        noise: &[(usize, usize, f64)],
        (mean, covariance): (&mut Vector, &mut Matrix),
    ) {
        let mut transition = identity();
        for &i in begins {
            transition[i][i] = 0.0;
        }
        for &(i, j, a) in terms {
            transition[i][j] += a;
        }
        transition[copy.0] = [0.0; GRID_STATES];
        transition[copy.0][copy.1] = 1.0;
        *mean = times(&transition, mean);
        *covariance = product(&product(&transition, covariance), &transpose(&transition));
        for &(i, j, variance) in noise {
            covariance[i][j] += variance;
            if i != j {
                covariance[j][i] += variance;
            }
        }
        self.transition = transition;
    }

    /// Updates by the measurements of the interval at hand.
    pub(super) fn update(
        &mut self,
        measurements: Vec<Measurement>,
        (mean, covariance): (&mut Vector, &mut Matrix),
    ) {
        let mut state = (*mean, *covariance);
        for measurement in &measurements {
            measurement.update(&mut state);
        }
        self.met.push(Met {
            transition: self.transition,
            state: (*mean, *covariance),
            measurements,
        });
        (*mean, *covariance) = state;
    }

    /// The states of all intervals by all measurements.
    pub(super) fn smoothed(self) -> Vec<State> {
        let mut adjoint = [0.0; GRID_STATES];
        let mut information = [[0.0; GRID_STATES]; GRID_STATES];
        let mut out = vec![([0.0; GRID_STATES], [[0.0; GRID_STATES]; GRID_STATES]); self.met.len()];
        for (met, out) in self.met.iter().zip(&mut out).rev() {
            let mut state = met.state;
            let mut before = Vec::with_capacity(met.measurements.len());
            for measurement in &met.measurements {
                before.push(state);
                measurement.update(&mut state);
            }
            for (measurement, state) in met.measurements.iter().zip(&before).rev() {
                let (gain, innovation, variance) = measurement.gain(state);
                let row = measurement.row();
                let mut keeps = identity();
                for i in 0..GRID_STATES {
                    for j in 0..GRID_STATES {
                        keeps[i][j] -= gain[i] * row[j];
                    }
                }
                let back = transpose(&keeps);
                adjoint = times(&back, &adjoint);
                information = product(&product(&back, &information), &keeps);
                for i in 0..GRID_STATES {
                    adjoint[i] -= row[i] * innovation / variance;
                    for j in 0..GRID_STATES {
                        information[i][j] += row[i] * row[j] / variance;
                    }
                }
            }
            let (mean, covariance) = met.state;
            let moved = times(&covariance, &adjoint);
            let reduced = product(&product(&covariance, &information), &covariance);
            for i in 0..GRID_STATES {
                out.0[i] = mean[i] - moved[i];
                for j in 0..GRID_STATES {
                    out.1[i][j] = covariance[i][j] - reduced[i][j];
                }
            }
            let back = transpose(&met.transition);
            adjoint = times(&back, &adjoint);
            information = product(&product(&back, &information), &met.transition);
        }
        out
    }
}
