//! The knee of a front: where giving a little of one objective stops buying much of another.

/// The index of the knee: the point farthest below the plane through the ends of the front.
///
/// Objectives are scaled to [0, 1] over the front; the plane is Σ f = 1, through the points that are
/// best in one objective each; the knee has the least Σ f. `None` for fewer than three points or a
/// front without extent in some objective, where no point is a knee.
///
/// Source: Das 1999, "On characterizing the knee of the Pareto curve based on Normal-Boundary
/// Intersection", Struct. Optim. 18, for two objectives; the sum for more is the same distance.
///
/// ```
/// // The second point loses little of either objective.
/// let front = [vec![0.0, 1.0], vec![0.1, 0.1], vec![1.0, 0.0]];
/// assert_eq!(grouser_opt::knee(&front), Some(1));
/// ```
#[must_use]
pub fn knee(front: &[Vec<f64>]) -> Option<usize> {
    let first = front.first()?;
    if front.len() < 3 {
        return None;
    }
    let ends: Vec<(f64, f64)> = (0..first.len())
        .map(|m| {
            let values = || front.iter().filter_map(|p| p.get(m).copied());
            (
                values().fold(f64::INFINITY, f64::min),
                values().fold(f64::NEG_INFINITY, f64::max),
            )
        })
        .collect();
    if ends.iter().any(|(low, high)| !(high > low)) {
        return None;
    }
    // Σ f of the scaled objectives but for a constant
    let height = |p: &Vec<f64>| -> f64 {
        let each = p.iter().zip(&ends);
        each.map(|(f, (low, high))| f / (high - low)).sum()
    };
    (0..front.len()).min_by(|&a, &b| height(&front[a]).total_cmp(&height(&front[b])))
}
