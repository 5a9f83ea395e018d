//! Noise that is the same on every machine.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A pinned stream of random numbers. Only operations that IEEE 754 fixes are used, so that the same
/// seed gives the same bits everywhere.
#[derive(Clone, Debug)]
pub struct Noise(ChaCha8Rng);

impl Noise {
    /// The stream of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        Self(ChaCha8Rng::from_seed(key))
    }

    /// Uniform in [0, 1), a multiple of 2^−53.
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / 9_007_199_254_740_992.0
    }

    /// Nearly normal, mean 0, standard deviation 1, within ±6: the sum of twelve uniform numbers.
    pub fn normal(&mut self) -> f64 {
        let sum: f64 = (0..12).map(|_| self.uniform()).sum();
        sum - 6.0
    }
}

/// A noise that wanders: first-order, with a correlation time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wander {
    value: f64,
}

impl Wander {
    /// Its present value.
    #[must_use]
    pub const fn value(&self) -> f64 {
        self.value
    }

    /// The next value after `share` of the correlation time (small against 1), standard deviation
    /// about `sigma`.
    pub fn step(&mut self, noise: &mut Noise, share: f64, sigma: f64) -> f64 {
        self.value += -share * self.value + (2.0 * share).sqrt() * sigma * noise.normal();
        self.value
    }
}
