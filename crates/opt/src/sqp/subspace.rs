//! The subproblem on a fixed working set, by orthogonal factorisation.
//!
//! With base row 0 (an objective) and â_i = a_i − w_i a_0, b̂_i = b_i − w_i b_0 (w_i = 1 for objectives,
//! else 0), h = a_0 + Σ_held u_j a_j, the working set's solution is
//! ```text
//! y = −(h + Âᵀu),   Â y + b̂ = 0,   γ = b_0 + a_0·y,   u_0 = 1 − Σ w_i u_i
//! ```
//! From Âᵀ = Q R: Qᵀy = t with Rᵀt = −b̂;  y = Q t − (I − Q Qᵀ) h;  R u = −(t + Qᵀh).

/// A row in the working set, or held at a bound of its multiplier.
#[derive(Clone, Debug)]
pub(super) struct Member {
    pub(super) row: usize,
    /// a = L⁻¹ g.
    pub(super) vector: Vec<f64>,
    /// b.
    pub(super) offset: f64,
    pub(super) objective: bool,
    /// The bounds of its multiplier.
    pub(super) range: (f64, f64),
}

/// The solution on the working set.
pub(super) enum Outcome {
    /// The best multipliers, one per member, and the y and γ that go with them.
    Best {
        y: Vec<f64>,
        gamma: f64,
        targets: Vec<f64>,
    },
    /// The members depend on each other: the multipliers may move along this direction (one entry per
    /// member) without changing y, and doing so does not lower the dual.
    Dependent { direction: Vec<f64> },
}

pub(super) struct Subspace<'a> {
    members: &'a [Member],
    base: Option<usize>,
    h: Vec<f64>,
    n: usize,
}

/// A vector whose part outside the span of the others is below this share of it lies in the span.
const DEPENDENT_PIVOT: f64 = 1e-11;

impl<'a> Subspace<'a> {
    pub(super) fn new(members: &'a [Member], held: &[Member], u: &[f64], n: usize) -> Self {
        let base = members
            .iter()
            .enumerate()
            .filter(|(_, m)| m.objective)
            .max_by(|(_, a), (_, b)| u[a.row].total_cmp(&u[b.row]))
            .map(|(index, _)| index);
        let mut h = base.map_or_else(|| vec![0.0; n], |base| members[base].vector.clone());
        for m in held {
            for (h, a) in h.iter_mut().zip(&m.vector) {
                *h += u[m.row] * a;
            }
        }
        Self {
            members,
            base,
            h,
            n,
        }
    }

    /// The solution; `None` where `is_stopped` of the products that come next is true.
    pub(super) fn solve(&self, mut is_stopped: impl FnMut(usize) -> bool) -> Option<Outcome> {
        let others: Vec<usize> = (0..self.members.len())
            .filter(|&i| Some(i) != self.base)
            .collect();
        let k = others.len();
        let mut q: Vec<f64> = Vec::new();
        let mut r = vec![0.0; k * k];
        let mut b_hat = Vec::with_capacity(k);
        for (column, &index) in others.iter().enumerate() {
            // twice a product with each column before, and their subtraction
            if is_stopped(2 * column * self.n) {
                return None;
            }
            let member = &self.members[index];
            let mut v = member.vector.clone();
            let mut size = norm(&v);
            let mut b = member.offset;
            if let (true, Some(base)) = (member.objective, self.base) {
                let base = &self.members[base];
                for (v, a) in v.iter_mut().zip(&base.vector) {
                    *v -= a;
                }
                size = size.max(norm(&base.vector));
                b -= base.offset;
            }
            b_hat.push(b);
            // Gram-Schmidt, twice: orthogonal to rounding.
            for _ in 0..2 {
                for (previous, q) in q.chunks_exact(self.n).enumerate() {
                    let c = dot(q, &v);
                    r[previous * k + column] += c;
                    for (v, q) in v.iter_mut().zip(q) {
                        *v -= c * q;
                    }
                }
            }
            let rest = norm(&v);
            if !(rest > DEPENDENT_PIVOT * size) {
                return Some(self.dependent(&others[..=column], &r, k, &b_hat));
            }
            r[column * k + column] = rest;
            q.extend(v.iter().map(|v| v / rest));
        }
        // Rᵀ t = −b̂.
        let mut t = vec![0.0; k];
        for i in 0..k {
            let mut sum = -b_hat[i];
            for j in 0..i {
                sum -= r[j * k + i] * t[j];
            }
            t[i] = sum / r[i * k + i];
        }
        let mut y: Vec<f64> = self.h.iter().map(|h| -h).collect();
        let mut rhs = Vec::with_capacity(k);
        for (q, &t) in q.chunks_exact(self.n).zip(&t) {
            // (dot with y keeps the projection accurate: y = −h minus what was already taken)
            let along = dot(q, &self.h);
            rhs.push(-(t + along));
            let c = t - dot(q, &y);
            for (y, q) in y.iter_mut().zip(q) {
                *y += c * q;
            }
        }
        back_substitute(&r, k, k, &mut rhs);
        let mut targets = vec![0.0; self.members.len()];
        let mut objectives = 0.0;
        for (&index, &u) in others.iter().zip(&rhs) {
            targets[index] = u;
            if self.members[index].objective {
                objectives += u;
            }
        }
        let mut gamma = 0.0;
        if let Some(base) = self.base {
            targets[base] = 1.0 - objectives;
            gamma = self.members[base].offset + dot(&self.members[base].vector, &y);
        }
        Some(Outcome::Best { y, gamma, targets })
    }

    /// Σ v_i â_i = 0 with v = 1 at the last of `columns`.
    fn dependent(&self, columns: &[usize], r: &[f64], k: usize, b_hat: &[f64]) -> Outcome {
        let last = columns.len() - 1;
        let mut z: Vec<f64> = (0..last).map(|i| r[i * k + last]).collect();
        back_substitute(r, k, last, &mut z);
        // a share that is rounding would bound the length of the step, and be scaled up by it
        let size = |i: usize| {
            let member = &self.members[columns[i]];
            let base = self.base.filter(|_| member.objective);
            let base = base.map_or(0.0, |base| norm(&self.members[base].vector));
            norm(&member.vector).max(base)
        };
        let parts: Vec<f64> = (0..last).map(|i| z[i].abs() * size(i)).collect();
        let largest = parts.iter().copied().fold(size(last), f64::max);
        for (z, part) in z.iter_mut().zip(&parts) {
            if *part < DEPENDENT_PIVOT * largest {
                *z = 0.0;
            }
        }
        let mut direction = vec![0.0; self.members.len()];
        let mut slope = b_hat[last];
        let mut objectives = 0.0;
        for (i, &index) in columns.iter().enumerate() {
            let v = if i == last { 1.0 } else { -z[i] };
            direction[index] = v;
            if i < last {
                slope += v * b_hat[i];
            }
            if self.members[index].objective {
                objectives += v;
            }
        }
        if let Some(base) = self.base {
            direction[base] = -objectives;
        }
        if slope < 0.0 {
            for v in &mut direction {
                *v = -*v;
            }
        }
        Outcome::Dependent { direction }
    }
}

/// Solves R x = rhs for the leading `size` rows and columns of a matrix with row length `k`.
fn back_substitute(r: &[f64], k: usize, size: usize, rhs: &mut [f64]) {
    for i in (0..size).rev() {
        let mut sum = rhs[i];
        for j in i + 1..size {
            sum -= r[i * k + j] * rhs[j];
        }
        rhs[i] = sum / r[i * k + i];
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
#[path = "subspace_tests.rs"]
mod tests;
