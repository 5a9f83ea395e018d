//! The middle of some values.

/// The median of values, which it puts in order; of an even number the upper one in the middle. `None` without values.
///
/// ```
/// let mut readings = [3.0, 1.0, 2.0, 9.0];
/// assert_eq!(grouser_real::median(&mut readings), Some(3.0));
/// assert_eq!(readings, [1.0, 2.0, 3.0, 9.0]);
/// assert_eq!(grouser_real::median(&mut []), None);
/// ```
#[must_use]
pub fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
