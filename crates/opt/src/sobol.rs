//! Sobol's low-discrepancy sequence: points that fill a box more evenly than random ones.
//!
//! Source: direction numbers of Joe & Kuo 2008, "Constructing Sobol sequences with better
//! two-dimensional projections", SIAM J. Sci. Comput. 30 (their file new-joe-kuo-6); Gray-code order after
//! Antonov & Saleev 1979. A seed shifts every coordinate by random bits (a digital shift), which keeps
//! the evenness.

use grouser_real::Real;

use crate::error::{Error, Result};
use crate::random::Random;
use crate::sobol_directions::DIRECTIONS;

const BITS: usize = 32;

/// A seeded Sobol sequence in the unit cube.
///
/// ```
/// let mut sobol = grouser_opt::Sobol::new(2, None)?;
/// let first: Vec<Vec<f64>> = (0..4).map(|_| sobol.next_point()).collect();
/// assert_eq!(first, [[0.0, 0.0], [0.5, 0.5], [0.75, 0.25], [0.25, 0.75]]);
/// # Ok::<(), grouser_opt::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Sobol {
    directions: Vec<[u32; BITS]>,
    state: Vec<u32>,
    shift: Vec<u32>,
    index: u32,
}

impl Sobol {
    /// A sequence in `dimensions` dimensions; without a seed the plain sequence, which begins at 0.
    ///
    /// # Errors
    /// More dimensions than there are direction numbers for (64).
    pub fn new(dimensions: usize, seed: Option<u64>) -> Result<Self> {
        let limit = DIRECTIONS.len() + 1;
        if dimensions > limit {
            return Err(Error::TooLarge {
                what: "the number of dimensions",
                given: dimensions,
                limit,
            });
        }
        let mut random = seed.map(Random::new);
        let shift = (0..dimensions)
            .map(|_| {
                random
                    .as_mut()
                    .map_or(0, |random| u32::try_from(random.bits() >> 32).unwrap_or(0))
            })
            .collect();
        Ok(Self {
            directions: (0..dimensions).map(directions).collect(),
            state: vec![0; dimensions],
            shift,
            index: 0,
        })
    }

    /// The next point, every coordinate in [0, 1). After 2³² points the sequence repeats.
    pub fn next_point(&mut self) -> Vec<f64> {
        let point = self
            .state
            .iter()
            .zip(&self.shift)
            .map(|(state, shift)| f64::from(state ^ shift) / Real::powi(2.0_f64, 32))
            .collect();
        let bit = usize::try_from(self.index.trailing_ones()).unwrap_or(0);
        for (state, directions) in self.state.iter_mut().zip(&self.directions) {
            *state ^= directions.get(bit).copied().unwrap_or(*state);
        }
        self.index = self.index.wrapping_add(1);
        point
    }

    /// The next point, in the box from `lower` to `upper`.
    pub(crate) fn next_in(&mut self, lower: &[f64], upper: &[f64]) -> Vec<f64> {
        self.next_point()
            .iter()
            .zip(lower.iter().zip(upper))
            .map(|(u, (low, high))| low + u * (high - low))
            .collect()
    }
}

/// The 32 direction numbers of a dimension, from its primitive polynomial and first values.
fn directions(dimension: usize) -> [u32; BITS] {
    let Some((degree, coefficients, first)) = dimension.checked_sub(1).map(|d| DIRECTIONS[d])
    else {
        return core::array::from_fn(|bit| 1 << (31 - bit));
    };
    let mut v = [0_u32; BITS];
    for bit in 0..BITS {
        v[bit] = if bit < degree {
            first[bit] << (31 - bit)
        } else {
            let mut value = v[bit - degree] ^ (v[bit - degree] >> degree);
            for k in 1..degree {
                if (coefficients >> (degree - 1 - k)) & 1 == 1 {
                    value ^= v[bit - k];
                }
            }
            value
        };
    }
    v
}
