//! The curvature of the Lagrangian, learned from its gradients: damped BFGS in the curved variables.
//!
//! ```text
//! B ← B − (B s)(B s)ᵀ/(sᵀB s) + r rᵀ/(sᵀr),   r = θ y + (1 − θ) B s
//! ```
//! Source: Powell 1978 (damping: sᵀr ≥ 0.2 sᵀB s keeps B positive definite); Nocedal & Wright,
//! Numerical Optimization, 2006, section 18.3. Variables in which everything is linear keep a small fixed
//! curvature, which only limits the length of their steps.

use super::factor::Factor;
use super::subspace::dot;

/// Curvature given to variables in which the functions are linear, relative to the others' scale.
const LINEAR_CURVATURE: f64 = 1e-6;

#[derive(Clone, Debug)]
pub(super) struct Curvature {
    n: usize,
    curved: usize,
    matrix: Vec<f64>,
    fresh: bool,
    scale: f64,
}

impl Curvature {
    pub(super) fn new(n: usize, curved: usize, scale: f64) -> Self {
        let mut curvature = Self {
            n,
            curved,
            matrix: Vec::new(),
            fresh: true,
            scale,
        };
        curvature.reset(scale);
        curvature
    }

    /// Forgets everything: B = scale · I.
    pub(super) fn reset(&mut self, scale: f64) {
        self.scale = scale;
        self.matrix = vec![0.0; self.n * self.n];
        for i in 0..self.n {
            let own = if i < self.curved {
                scale
            } else {
                scale * LINEAR_CURVATURE
            };
            self.matrix[i * self.n + i] = own;
        }
        self.fresh = true;
    }

    /// The scale of the latest start, B = scale · I.
    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    pub(super) fn is_fresh(&self) -> bool {
        self.fresh
    }

    /// L with B = L Lᵀ; starts over if rounding has made B indefinite.
    pub(super) fn factor(&mut self) -> Factor {
        loop {
            if let Some(factor) = Factor::new(&self.matrix, self.n) {
                return factor;
            }
            let scale = if self.scale.is_finite() && self.scale > 0.0 && !self.fresh {
                self.scale
            } else {
                1.0
            };
            self.reset(scale);
        }
    }

    /// dᵀB d.
    pub(super) fn energy(&self, d: &[f64]) -> f64 {
        self.matrix
            .chunks_exact(self.n)
            .zip(d)
            .map(|(row, d_i)| d_i * dot(row, d))
            .sum()
    }

    /// Learns from a step `s` and the change `y` of the Lagrangian's gradient along it.
    pub(super) fn update(&mut self, s: &[f64], y: &[f64]) {
        let c = self.curved;
        let (s, y) = (&s[..c], &y[..c]);
        let (s_s, s_y, y_y) = (dot(s, s), dot(s, y), dot(y, y));
        if !(s_s > 0.0) || !y_y.is_finite() {
            return;
        }
        if self.fresh {
            // The first step sets the scale (Nocedal & Wright, equation for the initial H, inverted).
            if s_y > 1e-8 * (s_s * y_y).sqrt() {
                self.reset(y_y / s_y);
            }
            self.fresh = false;
        }
        let bs: Vec<f64> = (0..c)
            .map(|i| dot(&self.matrix[i * self.n..i * self.n + c], s))
            .collect();
        let s_bs = dot(s, &bs);
        if !(s_bs > 0.0) {
            return;
        }
        let theta = if s_y >= 0.2 * s_bs {
            1.0
        } else {
            0.8 * s_bs / (s_bs - s_y)
        };
        let r: Vec<f64> = y
            .iter()
            .zip(&bs)
            .map(|(y, bs)| theta * y + (1.0 - theta) * bs)
            .collect();
        let s_r = dot(s, &r);
        for i in 0..c {
            for j in 0..c {
                self.matrix[i * self.n + j] += r[i] * r[j] / s_r - bs[i] * bs[j] / s_bs;
            }
        }
    }
}
