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
            self.reset(if self.fresh { 1.0 } else { self.scale });
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn times(curvature: &Curvature, v: &[f64]) -> Vec<f64> {
        let rows = curvature.matrix.chunks_exact(curvature.n);
        rows.map(|row| dot(row, v)).collect()
    }

    fn near(a: &[f64], b: &[f64], size: f64) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-10 * size)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]

        /// B s = y where s·y is not too small, else s·B s falls to a fifth; at right angles to s and y nothing changes;
        /// a linear variable keeps its small curvature.
        #[test]
        fn what_is_learned_holds_along_the_step(
            steps in prop::collection::vec((prop::array::uniform3(-1.0..1.0_f64), prop::array::uniform3(-2.0..2.0_f64)), 1..6),
            scale in 0.1..10.0_f64,
        ) {
            let mut curvature = Curvature::new(4, 3, scale);
            prop_assert!(curvature.is_fresh() && curvature.scale() == scale);
            for (round, (s, y)) in steps.iter().enumerate() {
                let (s, y) = ([s[0], s[1], s[2], 0.7], [y[0], y[1], y[2], 0.3]);
                let (s_s, s_y, y_y) = (dot(&s[..3], &s[..3]), dot(&s[..3], &y[..3]), dot(&y[..3], &y[..3]));
                prop_assume!(s_s > 1e-3 && s_y.abs() > 1e-3 && y_y > 1e-3);
                let own = [s[0], s[1], s[2], 0.0];
                // the first step sets the scale by its own curvature
                let first = if s_y > 0.0 { y_y / s_y } else { scale };
                let before = if round == 0 { own.map(|s| first * s).to_vec() } else { times(&curvature, &own) };
                let s_bs = dot(&own, &before);
                let cross = [s[1] * y[2] - s[2] * y[1], s[2] * y[0] - s[0] * y[2], s[0] * y[1] - s[1] * y[0], 0.0];
                let aside = if round == 0 { cross.map(|c| first * c).to_vec() } else { times(&curvature, &cross) };
                let normal = round == 0; // later B s need not lie in the plane of s and y
                curvature.update(&s, &y);
                prop_assert!(!curvature.is_fresh());
                let after = times(&curvature, &own);
                let size = 10.0 * (1.0 + s_bs + y_y) / s_y.abs().min(s_bs).min(1.0);
                if s_y >= 0.2 * s_bs {
                    prop_assert!(near(&after[..3], &y[..3], size), "{after:?} {y:?}");
                } else {
                    prop_assert!((dot(&own, &after) - 0.2 * s_bs).abs() < 1e-10 * size);
                }
                prop_assert!(!normal || near(&times(&curvature, &cross), &aside, size));
                prop_assert!((curvature.energy(&own) - dot(&own, &after)).abs() < 1e-10 * size);
                let linear = if s_y > 0.0 || round > 0 { curvature.scale() } else { scale };
                prop_assert!((curvature.energy(&[0.0, 0.0, 0.0, 2.0]) - 4e-6 * linear).abs() < 1e-12 * size);
            }
            curvature.reset(2.0);
            prop_assert!(curvature.is_fresh() && curvature.scale() == 2.0);
            prop_assert!(near(&times(&curvature, &[1.0, 2.0, 3.0, 1.0]), &[2.0, 4.0, 6.0, 2e-6], 1.0));
        }
    }

    #[test]
    fn nothing_is_learned_from_no_step_and_no_number() {
        let mut curvature = Curvature::new(2, 2, 3.0);
        curvature.update(&[0.0, 0.0], &[1.0, 1.0]);
        curvature.update(&[1.0, 0.0], &[f64::INFINITY, 1.0]);
        assert!(curvature.is_fresh() && times(&curvature, &[1.0, 2.0]) == [3.0, 6.0]);
        // of an indefinite matrix a new start is made, of the scale that there was
        curvature.fresh = false;
        curvature.matrix = vec![1.0, 2.0, 2.0, 1.0];
        let factor = curvature.factor();
        assert_eq!(factor.forward(&[3.0_f64.sqrt(), 0.0]), [1.0, 0.0]);
        assert!(curvature.is_fresh() && curvature.scale() == 3.0);
        for useless in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
            curvature.reset(useless);
            curvature.fresh = false;
            curvature.factor();
            assert_eq!(curvature.scale(), 1.0);
        }
        // the first step sets the scale unless it is at right angles to the change to a hundred-millionth
        for (along, scale) in [(3e-6, 1e6 / 3e-6), (3e-7, 1.0), (-1.0, 1.0)] {
            let mut curvature = Curvature::new(2, 2, 1.0);
            curvature.update(&[0.1, 0.0], &[10.0 * along, 1e3]);
            assert!((curvature.scale() / scale - 1.0).abs() < 1e-6, "{along}");
        }
    }
}
