//! The naive rival, fixed once: f64 and the standard library's functions, 32-point Gauss-Legendre on each
//! piece, one pass for three forces, Brent's method to 1e-10 on the entry angle, what does not depend on the node taken out of the
//! loop. Release profile, no lanes.

/// Soil and wheel as a textbook program has them.
#[derive(Clone, Copy)]
pub struct Naive {
    pub k_c: f64,
    pub k_phi: f64,
    pub n: f64,
    pub cohesion: f64,
    pub phi: f64,
    pub k_shear: f64,
    pub c_1: f64,
    pub c_2: f64,
    pub radius: f64,
    pub width: f64,
}

/// Nodes and weights on [−1, 1].
pub struct Table {
    nodes: [f64; 32],
    weights: [f64; 32],
}

impl Table {
    pub fn new() -> Self {
        let (mut nodes, mut weights) = ([0.0; 32], [0.0; 32]);
        for i in 0..32 {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / 32.5).cos();
            let mut slope = 1.0;
            for _ in 0..50 {
                let (mut p, mut before) = (1.0, 0.0);
                for k in 0..32 {
                    let k = k as f64;
                    (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
                }
                slope = 32.0 * (x * p - before) / (x * x - 1.0);
                x -= p / slope;
            }
            nodes[i] = x;
            weights[i] = 2.0 / ((1.0 - x * x) * slope * slope);
        }
        Self { nodes, weights }
    }
}

impl Naive {
    /// W, DP, T at an entry angle and a slip ≥ 0.
    pub fn forces(&self, table: &Table, theta_1: f64, slip: f64) -> [f64; 3] {
        let theta_m = (self.c_1 + self.c_2 * slip) * theta_1;
        let modulus = self.k_c / self.width + self.k_phi;
        let (tan_phi, sin_1, cos_1) = (self.phi.tan(), theta_1.sin(), theta_1.cos());
        let (mut w, mut pull, mut torque) = (0.0, 0.0, 0.0);
        for (from, to, front) in [(theta_m, theta_1, true), (0.0, theta_m, false)] {
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            for (x, weight) in table.nodes.iter().zip(&table.weights) {
                let theta = middle + half * x;
                let shifted = if front {
                    theta
                } else {
                    theta_1 - theta / theta_m * (theta_1 - theta_m)
                };
                let sigma = modulus * (self.radius * (shifted.cos() - cos_1)).powf(self.n);
                let j = self.radius * ((theta_1 - theta) - (1.0 - slip) * (sin_1 - theta.sin()));
                let tau = (self.cohesion + sigma * tan_phi) * (1.0 - (-j / self.k_shear).exp());
                w += half * weight * (sigma * theta.cos() + tau * theta.sin());
                pull += half * weight * (tau * theta.cos() - sigma * theta.sin());
                torque += half * weight * tau;
            }
        }
        let area = self.radius * self.width;
        [area * w, area * pull, self.radius * area * torque]
    }

    /// The entry angle under a load, by Brent's method to 1e-10.
    pub fn solve(&self, table: &Table, load: f64, slip: f64) -> f64 {
        let f = |theta_1: f64| self.forces(table, theta_1, slip)[0] - load;
        let (mut a, mut b) = (1e-3, 1.5);
        let (mut f_a, mut f_b) = (f(a), f(b));
        let (mut c, mut f_c) = (a, f_a);
        let (mut d, mut e) = (b - a, b - a);
        for _ in 0..100 {
            if f_b * f_c > 0.0 {
                (c, f_c) = (a, f_a);
                d = b - a;
                e = d;
            }
            if f_c.abs() < f_b.abs() {
                (a, b, c) = (b, c, b);
                (f_a, f_b, f_c) = (f_b, f_c, f_b);
            }
            let tolerance = 2.0 * f64::EPSILON * b.abs() + 0.5e-10;
            let m = 0.5 * (c - b);
            if m.abs() <= tolerance || f_b == 0.0 {
                break;
            }
            if e.abs() < tolerance || f_a.abs() <= f_b.abs() {
                d = m;
                e = m;
            } else {
                let s = f_b / f_a;
                let (mut p, mut q);
                if a == c {
                    p = 2.0 * m * s;
                    q = 1.0 - s;
                } else {
                    let (u, r) = (f_a / f_c, f_b / f_c);
                    p = s * (2.0 * m * u * (u - r) - (b - a) * (r - 1.0));
                    q = (u - 1.0) * (r - 1.0) * (s - 1.0);
                }
                if p > 0.0 {
                    q = -q;
                } else {
                    p = -p;
                }
                if 2.0 * p < (3.0 * m * q - (tolerance * q).abs()).min((e * q).abs()) {
                    e = d;
                    d = p / q;
                } else {
                    d = m;
                    e = m;
                }
            }
            (a, f_a) = (b, f_b);
            b += if d.abs() > tolerance {
                d
            } else {
                tolerance.copysign(m)
            };
            f_b = f(b);
        }
        b
    }
}
