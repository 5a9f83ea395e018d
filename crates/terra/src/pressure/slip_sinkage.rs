//! Slip-sinkage: a slipping wheel digs, which Ding expresses by the sinkage exponent.

use grouser_real::Real;

/// The sinkage exponent as a function of slip by Ding: n = n_0 + n_1 s for s ≥ 0, n_0 − n_2 s for s < 0.
///
/// The moduli are held fixed in metres and pascals. n_1 = n_2 = 0 switches it off.
///
/// Source: Ding et al., J. Terramechanics 48 (2011) \[Ding11\].
/// Valid range: where n stays within the pressure law's own range. Sign: n_1, n_2 > 0 dig with
/// driving and braking slip.
///
/// ```
/// use grouser_terra::SinkageExponent;
/// let n = SinkageExponent { n_0: 0.92, n_1: 0.5, n_2: 0.0 }; // Mars simulation sand of Zhou et al. 2023
/// assert_eq!(n.at(0.2_f64), 0.92 + 0.5 * 0.2);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SinkageExponent<R = f64> {
    /// The exponent without slip.
    pub n_0: R,
    /// Its growth with driving slip.
    pub n_1: R,
    /// Its growth with braking slip.
    pub n_2: R,
}

impl<R: Real> SinkageExponent<R> {
    /// The exponent at `slip`.
    pub fn at(&self, slip: R) -> R {
        let driving = R::ZERO.le(slip);
        self.n_0 + R::select(driving, self.n_1, -self.n_2) * slip
    }
}
