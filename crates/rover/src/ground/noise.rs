//! Random numbers that are the same on every machine.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A pinned stream of random numbers, made of operations that IEEE 754 fixes.
///
/// ```
/// use grouser_rover::ground::Noise;
///
/// let (mut one, mut again) = (Noise::new(7, 1), Noise::new(7, 1));
/// assert_eq!(one.uniform(), again.uniform());
/// assert_ne!(one.uniform(), Noise::new(7, 2).uniform()); // each stream is its own
/// assert!((0.0..1.0).contains(&one.uniform()));
/// ```
#[derive(Clone, Debug)]
pub struct Noise(ChaCha8Rng);

impl Noise {
    /// Stream `stream` of a seed: each sensor has its own, so that one more sensor changes no other.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8..16].copy_from_slice(&stream.to_le_bytes());
        Self(ChaCha8Rng::from_seed(key))
    }

    /// Uniform in [0, 1), a multiple of 2^−53.
    ///
    /// ```
    /// let mut noise = grouser_rover::ground::Noise::new(3, 0);
    /// assert!((0..1000).all(|_| (0.0..1.0).contains(&noise.uniform())));
    /// ```
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / 9_007_199_254_740_992.0
    }

    /// Nearly normal, mean 0, standard deviation 1, within ±3.5: the sum of four uniform numbers of 16 bits,
    /// scaled.
    ///
    /// ```
    /// let mut noise = grouser_rover::ground::Noise::new(1, 0);
    /// let mean = (0..10_000).map(|_| noise.normal()).sum::<f64>() / 1e4;
    /// assert!(mean.abs() < 0.04); // four sigmas of a mean of 10 000
    /// ```
    pub fn normal(&mut self) -> f64 {
        let bits = self.0.next_u64();
        let sum: u64 = (0..4).map(|i| (bits >> (16 * i)) & 0xFFFF).sum();
        // each has the variance (2^32 − 1)/12
        let sigma = ((4_294_967_295.0 / 12.0) * 4.0_f64).sqrt();
        (sum as f64 - 2.0 * 65_535.0) / sigma
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normal_has_its_moments_and_streams_differ() {
        let mut noise = Noise::new(7, 1);
        let count = 100_000;
        let (mut sum, mut square) = (0.0, 0.0);
        for _ in 0..count {
            let x = noise.normal();
            sum += x;
            square += x * x;
        }
        // three sigma of the mean, and of the variance (kurtosis 2.7: √1.7/√n)
        let n = f64::from(count);
        assert!((sum / n).abs() < 3.0 / n.sqrt());
        assert!((square / n - 1.0).abs() < 3.0 * 1.31 / n.sqrt());
        assert_ne!(Noise::new(7, 2).uniform(), Noise::new(7, 1).uniform());
    }
}
