//! The word that was probably meant.

/// The candidate nearest to `given`, if one is near enough to be a slip of the finger: at most a third
/// of its letters changed, inserted, left out or swapped, or one of the two begins with the other
/// (a forgotten unit).
///
/// ```
/// use grouser_files::nearest;
///
/// assert_eq!(nearest("raduis_m", ["radius_m", "width_m"]), Some("radius_m"));
/// assert_eq!(nearest("colour", ["radius_m", "width_m"]), None);
/// ```
#[must_use]
pub fn nearest<'a>(given: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // Longer ones are no typing errors, and the distance is quadratic.
    if given.len() > 64 {
        return None;
    }
    candidates
        .into_iter()
        .filter_map(|candidate| {
            let distance = if !given.is_empty()
                && (candidate.starts_with(&format!("{given}_"))
                    || given.starts_with(&format!("{candidate}_")))
            {
                1
            } else {
                distance(given, candidate)
            };
            let limit = (candidate.chars().count() / 3).max(1);
            (distance <= limit).then_some((distance, candidate))
        })
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
}

/// Optimal string alignment distance.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let change = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = change.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(before[j - 2] + 1);
            }
            row.push(least);
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_the_finger_are_found_and_other_words_are_not() {
        let keys = ["radius_m", "width_m", "heading_deg", "gear"];
        assert_eq!(nearest("raduis_m", keys), Some("radius_m"));
        assert_eq!(nearest("radius", keys), Some("radius_m"));
        assert_eq!(nearest("gaer", keys), Some("gear"));
        assert_eq!(nearest("colour", keys), None);
        assert_eq!(nearest("", keys), None);
        assert_eq!(nearest(&"r".repeat(100_000), keys), None);
    }
}
