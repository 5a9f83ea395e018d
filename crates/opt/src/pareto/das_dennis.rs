//! Evenly spread directions on the simplex Σ w = 1, w ≥ 0.

/// All points of the simplex in `objectives` dimensions whose coordinates are multiples of 1/`divisions`:
/// C(divisions + objectives − 1, objectives − 1) of them.
///
/// Source: Das & Dennis 1998, SIAM J. Optim. 8, section on the generation of weights.
///
/// ```
/// assert_eq!(grouser_opt::das_dennis(3, 12).len(), 91);
/// ```
#[must_use]
pub fn das_dennis(objectives: usize, divisions: usize) -> Vec<Vec<f64>> {
    if objectives == 0 || divisions == 0 {
        return Vec::new();
    }
    let mut all = Vec::new();
    let mut parts = vec![0; objectives];
    parts[objectives - 1] = divisions;
    loop {
        all.push(parts.iter().map(|&k| k as f64 / divisions as f64).collect());
        // The next composition: move one unit left, and everything to its right back to the end.
        let Some(from) = (1..objectives).rev().find(|&i| parts[i] > 0) else {
            return all;
        };
        let rest = parts[from] - 1;
        parts[from] = 0;
        parts[from - 1] += 1;
        parts[objectives - 1] = rest;
    }
}
