//! Gauss-Jacobi rules for the weight tⁿ on [0, 1].

use grouser_real::Real;

/// The most nodes of a rule.
pub(crate) const MAX_NODES: usize = 24;

/// Writes the Gauss rule for ∫₀¹ tⁿ g(t) dt with as many nodes as there is room for: exact for polynomials g up to twice as
/// many degrees less one. In any kind of number, so that every lane may have its own exponent.
///
/// It takes the singularity that the pressure-sinkage law puts at the entry of the contact, so that
/// what is left to approximate is analytic and converges geometrically. The nodes are the roots of Jacobi's polynomial
/// p_N, here with leading coefficient 1, by two steps of Halley's method from Gatteschi's estimate: the first leaves less
/// than 1e-5 of the distance between nodes, the second rounding. The derivatives beyond the first are those of the
/// differential equation t (1 − t) p″ + (n + 1 − (n + 2) t) p′ + N (N + n + 1) p = 0, and the weights are
/// 1/(t (1 − t) (K p′)²) with the usual leading coefficient K.
///
/// Source: Hale & Townsend, SIAM J. Sci. Comput. 35 (2013) A652-A674 (estimate); Davis & Rabinowitz, *Methods of Numerical
/// Integration*, 2nd ed. 1984 (recurrence, weights). Valid range: 0 ≤ n ≤ 3, up to [`MAX_NODES`] nodes.
#[inline(always)]
pub(crate) fn gauss_jacobi<R: Real>(n: R, nodes: &mut [R], weights: &mut [R]) {
    let c = R::from_f64;
    let count = nodes.len().min(MAX_NODES);
    let size = c(count as f64);
    let polynomial = Jacobi::new(n, count);
    let (one, two, half) = (R::ONE, c(2.0), c(0.5));
    let order = size * (size + n + one);
    let middle = size + half * (n + one);
    let per_middle = half / (middle * middle + (one - n * n) * c(1.0 / 12.0)).sqrt();
    for (k, (node, weight)) in nodes.iter_mut().zip(weights).enumerate() {
        let sine = (bessel_root(n, k) * per_middle).sin();
        let mut t = sine * sine;
        let share = t * (one - t);
        let (p, slope) = polynomial.at(t);
        let bend = (n + one) - (n + two) * t;
        t -= share * p / (slope + half * p * bend);

        let share = t * (one - t);
        let (p, slope) = polynomial.at(t);
        let bend = (n + one) - (n + two) * t;
        // the step over t (1 − t)
        let relative = -p / (slope + half * p * bend);
        // p″ and p‴ likewise over p′: t (1 − t) p′ of the node
        let bend = bend - order * relative * share;
        let third = (n + two - (n + c(4.0)) * t) * bend - share * (order - (n + two));
        let slope = slope * (one - relative * (bend - half * relative * third));
        *node = t + share * relative;
        let scaled = polynomial.leading * slope / share;
        *weight = one / (*node * (one - *node) * (scaled * scaled));
    }
}

/// McMahon's estimate of the k-th root of the Bessel function of order n, from 0.
#[inline(always)]
fn bessel_root<R: Real>(n: R, k: usize) -> R {
    let c = R::from_f64;
    let square = n * n;
    let beta = (c(k as f64 + 0.75) + c(0.5) * n) * R::PI;
    let per_beta = R::ONE / beta;
    let mu = c(4.0) * square - R::ONE;
    let third = (c(28.0) * square - c(31.0)) * per_beta * per_beta * c(1.0 / 384.0);
    beta - mu * per_beta * (c(0.125) + third)
}

/// Jacobi's polynomials on [0, 1] with leading coefficient 1 for the weight tⁿ: p_{k+1} = (t − a_k) p_k − b_k p_{k−1}.
struct Jacobi<R> {
    count: usize,
    a: [R; MAX_NODES],
    b: [R; MAX_NODES],
    /// t (1 − t) p_N′ = N (middle − t) p_N + before p_{N−1}
    middle: R,
    before: R,
    /// The usual leading coefficient.
    leading: R,
}

impl<R: Real> Jacobi<R> {
    #[inline(always)]
    fn new(n: R, count: usize) -> Self {
        let c = R::from_f64;
        let half = c(0.5);
        let (mut a, mut b) = ([R::ZERO; MAX_NODES], [R::ZERO; MAX_NODES]);
        a[0] = (n + R::ONE) / (n + c(2.0));
        let (mut above, mut below) = (R::ONE, R::ONE);
        let (mut middle, mut before) = (half, R::ZERO);
        let mut sum = n + c(2.0);
        let mut per_sum = R::ONE / sum;
        for k in 1..=count {
            let kf = c(k as f64);
            let product = kf * (kf + n);
            let share = product * per_sum;
            let less = sum - R::ONE;
            above *= sum * less;
            below *= product;
            let next = sum + c(2.0);
            let per_next = R::ONE / next;
            if k < count {
                a[k] = half + half * n * n * (per_sum * per_next);
                b[k] = share * share / (less * (sum + R::ONE));
            } else {
                middle = half - half * n * per_sum;
                before = share * share / less;
            }
            (sum, per_sum) = (next, per_next);
        }
        Self {
            count,
            a,
            b,
            middle,
            before,
            leading: above / below,
        }
    }

    /// p_N and t (1 − t) p_N′.
    #[inline(always)]
    fn at(&self, t: R) -> (R, R) {
        let (mut p, mut before) = (t - self.a[0], R::ONE);
        for (a, b) in self.a[1..self.count].iter().zip(&self.b[1..self.count]) {
            let next = (t - *a).mul_add(p, -(*b * before));
            (before, p) = (p, next);
        }
        let size = R::from_f64(self.count as f64);
        let slope = (size * (self.middle - t)).mul_add(p, self.before * before);
        (p, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Rule;

    fn check<const N: usize>(n: f64) {
        let rule = Rule::<N>::jacobi(n);
        assert!(rule.nodes.iter().all(|t| *t > 0.0 && *t < 1.0));
        assert!(rule.nodes.is_sorted());
        for degree in 0..2 * N {
            let power = i32::try_from(degree).unwrap();
            let sum: f64 = rule
                .nodes
                .iter()
                .zip(&rule.weights)
                .map(|(t, w)| w * t.powi(power))
                .sum();
            let exact = 1.0 / (n + degree as f64 + 1.0);
            assert!(
                (sum - exact).abs() < 20.0 * f64::EPSILON,
                "N {N} n {n} degree {degree}"
            );
        }
    }

    #[test]
    fn exact_to_its_degree_for_every_legal_exponent() {
        for i in 10..=300 {
            let n = 0.01 * f64::from(i);
            check::<2>(n);
            check::<4>(n);
            check::<5>(n);
            check::<6>(n);
            check::<8>(n);
            check::<12>(n);
            check::<16>(n);
            check::<24>(n);
        }
    }

    #[test]
    fn without_a_weight_it_is_gauss_legendre() {
        let jacobi = Rule::<12>::jacobi(0.0);
        let legendre = super::super::legendre::gauss_legendre::<12>();
        for i in 0..12 {
            assert!((jacobi.nodes[i] - legendre.nodes[i]).abs() < 1e-15);
            assert!((jacobi.weights[i] - legendre.weights[i]).abs() < 1e-15);
        }
    }
}
