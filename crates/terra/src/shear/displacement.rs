//! How far the rim has dragged the soil: the shear displacement.

use grouser_real::Real;

/// Shear displacement over the contact, per metre of radius:
/// j/r = (θ_1 − θ) − q (sin θ_1 − sin θ), with q = v/(r ω).
///
/// Source: Wong & Reece, J. Terramechanics 4 (1967) I \[WR67\]. Assumes: rigid wheel, soil at rest until
/// the rim meets it. Sign: positive where the rim has moved backwards against the soil (driving). For
/// s ≥ 0 it never changes sign, for s < 0 at 0, 1 or 2 angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Displacement<R> {
    pub(crate) theta_1: R,
    /// q = v/(r ω).
    pub(crate) q: R,
    /// 1 − q, given apart because the difference loses digits near q = 1.
    pub(crate) one_minus_q: R,
}

impl<R: Real> Displacement<R> {
    /// j/r at the arc `w` = θ_1 − θ behind the entry.
    ///
    /// Written so that nothing cancels at small w or small θ_1:
    /// sin θ_1 − sin θ = 2 cos(θ_1 − w/2) sin(w/2) and 1 − cos α = 2 sin²(α/2).
    #[inline(always)]
    pub(crate) fn at(&self, w: R) -> R {
        let half = R::from_f64(0.5);
        let two = R::from_f64(2.0);
        let x = half * w;
        let sine = x.sin();
        let tilt = (half * (self.theta_1 - x)).sin();
        two * (x_minus_sin(x, sine) + sine * (self.one_minus_q + two * self.q * tilt * tilt))
    }

    /// d(j/r)/dw = 1 − q cos θ.
    #[inline(always)]
    pub(crate) fn slope(&self, w: R) -> R {
        R::ONE - self.q * (self.theta_1 - w).cos()
    }
}

/// x − sin x without cancellation; the series is good to 1e-15 below one half.
#[inline(always)]
fn x_minus_sin<R: Real>(x: R, sine: R) -> R {
    let small = x.abs().lt(R::from_f64(0.5));
    let y = x * x;
    // x³/6 (1 − y/20 (1 − y/42 (1 − y/72 (1 − y/110 (1 − y/156)))))
    let mut series = R::ONE;
    for divisor in [156.0, 110.0, 72.0, 42.0, 20.0] {
        series = R::ONE - y * series * R::from_f64(1.0 / divisor);
    }
    R::select(small, x * y * series * R::from_f64(1.0 / 6.0), x - sine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_formula_as_printed() {
        for (theta_1, w, q) in [(1.2, 0.9, 0.7), (0.8, 1.1, 1.4), (0.4, 0.1, 1.0)] {
            let printed = w - q * (f64::sin(theta_1) - f64::sin(theta_1 - w));
            let ours = Displacement {
                theta_1,
                q,
                one_minus_q: 1.0 - q,
            }
            .at(w);
            assert!((ours - printed).abs() < 1e-15, "{ours} {printed}");
        }
    }

    #[test]
    fn keeps_its_digits_in_a_tiny_contact() {
        // At q = 1 and w = θ_1 = ε: j/r = ε − sin ε = ε³/6 (1 − ε²/20 …); the printed form has no digit left.
        let epsilon = 1e-6;
        let j = Displacement {
            theta_1: epsilon,
            q: 1.0,
            one_minus_q: 0.0,
        }
        .at(epsilon);
        assert!((j / (epsilon * epsilon * epsilon / 6.0) - 1.0).abs() < 1e-11);
    }
}
