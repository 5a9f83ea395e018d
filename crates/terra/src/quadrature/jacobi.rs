//! Gauss-Jacobi rules for the weight tⁿ on [0, 1].

use grouser_real::Real;

use super::Rule;

/// The `N`-point Gauss rule for ∫₀¹ tⁿ g(t) dt: exact for polynomials g of degree 2N − 1.
///
/// It takes the singularity that the pressure-sinkage law puts at the entry of the contact, so that
/// what is left to approximate is analytic and converges geometrically. The nodes are the eigenvalues
/// of the recurrence's tridiagonal matrix, the weights come from the eigenvectors' first components.
///
/// Source: Golub & Welsch, Math. Comp. 23 (1969) 221-230. Valid range: n > −1.
pub(crate) fn gauss_jacobi<const N: usize>(n: f64) -> Rule<N> {
    // Recurrence of the Jacobi polynomials with α = 0, β = n on [−1, 1], moved to [0, 1].
    let mut diagonal = [0.0; N];
    let mut beside = [0.0; N]; // beside[k] couples k and k + 1
    for k in 0..N {
        let kf = k as f64;
        let m = 2.0 * kf + n;
        let centre = if k == 0 {
            n / (n + 2.0)
        } else {
            n * n / (m * (m + 2.0))
        };
        diagonal[k] = 0.5 + 0.5 * centre;
        let j = kf + 1.0;
        let c = 2.0 * j + n;
        beside[k] = 0.5 * (2.0 * j * (j + n) / (c * Real::sqrt((c - 1.0) * (c + 1.0))));
    }
    let mut first = [0.0; N];
    first[0] = 1.0;
    eigenvalues(&mut diagonal, &mut beside, &mut first);
    let mut order: [usize; N] = core::array::from_fn(|i| i);
    order.sort_unstable_by(|&a, &b| diagonal[a].total_cmp(&diagonal[b]));
    let total = 1.0 / (n + 1.0); // ∫ tⁿ
    Rule {
        nodes: order.map(|i| diagonal[i]),
        weights: order.map(|i| total * first[i] * first[i]),
    }
}

/// Eigenvalues of a symmetric tridiagonal matrix by the implicit QL method with Wilkinson's shift;
/// `first` becomes the first component of each eigenvector.
///
/// Source: Wilkinson & Reinsch, *Linear Algebra*, contribution II/4 (1971).
fn eigenvalues<const N: usize>(d: &mut [f64; N], e: &mut [f64; N], first: &mut [f64; N]) {
    e[N - 1] = 0.0;
    for l in 0..N {
        // 30 sweeps is the routine's usual bound; 2 or 3 are what it takes.
        for _ in 0..30 {
            let mut m = l;
            while m + 1 < N && e[m].abs() > f64::EPSILON * (d[m].abs() + d[m + 1].abs()) {
                m += 1;
            }
            if m == l {
                break;
            }
            let mut g = (d[l + 1] - d[l]) / (2.0 * e[l]);
            let mut r = Real::hypot(g, 1.0);
            g = d[m] - d[l] + e[l] / (g + if g < 0.0 { -r } else { r });
            let (mut s, mut c, mut p) = (1.0, 1.0, 0.0);
            for i in (l..m).rev() {
                let f = s * e[i];
                let b = c * e[i];
                r = Real::hypot(f, g);
                e[i + 1] = r;
                if r == 0.0 {
                    break;
                }
                s = f / r;
                c = g / r;
                g = d[i + 1] - p;
                let t = (d[i] - g) * s + 2.0 * c * b;
                p = s * t;
                d[i + 1] = g + p;
                g = c * t - b;
                let z = first[i + 1];
                first[i + 1] = s * first[i] + c * z;
                first[i] = c * first[i] - s * z;
            }
            d[l] -= p;
            e[l] = g;
            e[m] = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const N: usize>(n: f64) {
        let rule = gauss_jacobi::<N>(n);
        assert!(rule.nodes.iter().all(|t| *t > 0.0 && *t < 1.0));
        for degree in 0..2 * N {
            let power = i32::try_from(degree).unwrap();
            let sum: f64 = rule
                .nodes
                .iter()
                .zip(&rule.weights)
                .map(|(t, w)| w * t.powi(power))
                .sum();
            let exact = 1.0 / (n + degree as f64 + 1.0);
            // the QL method's error: a few eps of the matrix's norm, 1
            assert!(
                (sum - exact).abs() < 20.0 * f64::EPSILON,
                "N {N} n {n} degree {degree}"
            );
        }
    }

    #[test]
    fn exact_to_its_degree_for_every_legal_exponent() {
        for n in [0.1, 0.5, 0.7, 1.0, 1.1, 1.6, 2.5, 3.0] {
            check::<8>(n);
            check::<12>(n);
            check::<24>(n);
        }
    }

    #[test]
    fn without_a_weight_it_is_gauss_legendre() {
        let jacobi = gauss_jacobi::<12>(0.0);
        let legendre = super::super::legendre::gauss_legendre::<12>();
        for i in 0..12 {
            assert!((jacobi.nodes[i] - legendre.nodes[i]).abs() < 1e-15);
            assert!((jacobi.weights[i] - legendre.weights[i]).abs() < 1e-15);
        }
    }
}
