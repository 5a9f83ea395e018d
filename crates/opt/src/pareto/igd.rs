//! Inverted generational distance: how far a known front is from the points found.

use crate::error::{Error, Result};

/// The mean distance from each point of `reference` to the nearest point of `front`.
///
/// Source: Coello & Reyes Sierra 2004; the plain mean of Euclidean distances, without normalisation.
///
/// # Errors
/// Either set is empty, or lengths differ.
///
/// ```
/// use grouser_opt::inverted_generational_distance;
/// let known = [vec![0.0, 1.0], vec![1.0, 0.0]];
/// let found = [vec![0.0, 1.0], vec![1.0, 0.5]];
/// assert_eq!(inverted_generational_distance(&found, &known)?, 0.25);
/// # Ok::<(), grouser_opt::Error>(())
/// ```
pub fn inverted_generational_distance(front: &[Vec<f64>], reference: &[Vec<f64>]) -> Result<f64> {
    let (Some(first), false) = (reference.first(), front.is_empty()) else {
        return Err(Error::Empty { what: "front" });
    };
    for point in front.iter().chain(reference) {
        Error::check_length("a point of the front", point.len(), first.len())?;
    }
    let sum: f64 = reference
        .iter()
        .map(|known| {
            front
                .iter()
                .map(|found| {
                    found
                        .iter()
                        .zip(known)
                        .map(|(a, b)| (a - b) * (a - b))
                        .sum::<f64>()
                })
                .fold(f64::INFINITY, f64::min)
                .sqrt()
        })
        .sum();
    Ok(sum / reference.len() as f64)
}
