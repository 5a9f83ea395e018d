//! Fewer points for the same picture.

use super::geometry::Point;

/// A line on the page without the points that cannot be seen: in each column of `width` points only the
/// first, the lowest, the highest and the last stay, in their order. Lines that run back and forth
/// are kept as they are where they turn into another column.
pub(super) fn thin(line: &[Point], width: f64) -> Vec<Point> {
    let column = |point: &Point| (point[0] / width).floor();
    let mut kept = Vec::new();
    for group in line.chunk_by(|a, b| column(a) == column(b)) {
        if group.len() <= 4 {
            kept.extend_from_slice(group);
            continue;
        }
        let by_height = |a: &usize, b: &usize| group[*a][1].total_cmp(&group[*b][1]);
        let low = (0..group.len()).min_by(by_height).unwrap_or(0);
        let high = (0..group.len()).max_by(by_height).unwrap_or(0);
        let mut stay = [0, low.min(high), low.max(high), group.len() - 1].to_vec();
        stay.dedup();
        kept.extend(stay.into_iter().map(|i| group[i]));
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_survive_and_the_rest_goes() {
        let mut line: Vec<Point> = (0..100_000).map(|i| [f64::from(i) / 1000.0, 0.0]).collect();
        line[51_234][1] = 7.0;
        line[51_240][1] = -3.0;
        let kept = thin(&line, 0.2);
        assert!(kept.len() <= 4 * 500, "{}", kept.len());
        assert!(kept.contains(&line[51_234]) && kept.contains(&line[51_240]));
        assert!(kept.is_sorted_by(|a, b| a[0] <= b[0]));
    }
}
