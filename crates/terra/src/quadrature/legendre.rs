//! Gauss-Legendre rules on [0, 1], computed by the compiler.

use super::Rule;

/// The `N`-point Gauss-Legendre rule on [0, 1]: exact for polynomials of degree 2N − 1.
///
/// Each node is a root of P_N, found by Newton's method from Tricomi's estimate; the weight is
/// 2/((1 − x²) P_N′(x)²), halved for the interval. Nodes ascend.
///
/// Source: Davis & Rabinowitz, *Methods of Numerical Integration*, 2nd ed. 1984, section 2.7.
pub(crate) const fn gauss_legendre<const N: usize>() -> Rule<N> {
    let mut nodes = [0.0; N];
    let mut weights = [0.0; N];
    let mut i = 0;
    while i < N.div_ceil(2) {
        let mut x = tricomi(i, N);
        let mut step = 0;
        while step < 8 {
            let (p, dp) = legendre(N, x);
            x -= p / dp;
            step += 1;
        }
        let (_, dp) = legendre(N, x);
        let weight = 1.0 / ((1.0 - x) * (1.0 + x) * dp * dp);
        // x is the i-th root from the right.
        nodes[N - 1 - i] = 0.5 + 0.5 * x;
        nodes[i] = 0.5 - 0.5 * x;
        weights[N - 1 - i] = weight;
        weights[i] = weight;
        i += 1;
    }
    Rule { nodes, weights }
}

/// P_n(x) and its derivative by the three-term recurrence.
const fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut p, mut before) = (1.0, 0.0);
    let mut k = 0;
    while k < n {
        let kf = k as f64;
        let next = ((2.0 * kf + 1.0) * x * p - kf * before) / (kf + 1.0);
        before = p;
        p = next;
        k += 1;
    }
    (p, n as f64 * (x * p - before) / (x * x - 1.0))
}

/// Tricomi's estimate of the i-th root from the right: cos(π (4i + 3)/(4n + 2)) to leading order. The
/// cosine is a Taylor sum, because the compiler has no `cos`; Newton's method needs no more.
const fn tricomi(i: usize, n: usize) -> f64 {
    let angle = core::f64::consts::PI * (4 * i + 3) as f64 / (4 * n + 2) as f64;
    let (mut term, mut sum, mut k) = (1.0, 1.0, 1);
    while k < 12 {
        term *= -angle * angle / ((2 * k - 1) * (2 * k)) as f64;
        sum += term;
        k += 1;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const N: usize>() {
        let rule = gauss_legendre::<N>();
        assert!(rule.nodes.windows(2).all(|pair| pair[0] < pair[1]));
        for degree in 0..2 * N {
            let power = i32::try_from(degree).unwrap();
            let sum: f64 = rule
                .nodes
                .iter()
                .zip(&rule.weights)
                .map(|(x, w)| w * x.powi(power))
                .sum();
            let exact = 1.0 / (degree as f64 + 1.0);
            // rounding of N products and sums
            assert!(
                (sum - exact).abs() < 4.0 * f64::EPSILON,
                "N {N} degree {degree}: {sum}"
            );
        }
    }

    #[test]
    fn every_rule_is_exact_to_its_degree() {
        check::<12>();
        check::<16>();
        check::<32>();
    }
}
