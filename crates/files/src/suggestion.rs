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

/// Are both names of a family, as `size_x_m` and `size_y_m` or `k_c_kn_per_m_n1` and `k_phi_kn_per_m_n2`? Their parts agree
/// but for some before the unit that have no character in common, and for numbers.
pub(crate) fn are_siblings(a: &str, b: &str) -> bool {
    let count = a.matches('_').count();
    let number = |c: char| c.is_ascii_digit();
    let is_kin = |(place, (a, b)): (usize, (&str, &str))| {
        let differs = place < count && !a.contains(|c| b.contains(c));
        differs || a.trim_end_matches(number) == b.trim_end_matches(number)
    };
    let parts = a.split('_').zip(b.split('_')).enumerate();
    a != b && count == b.matches('_').count() && parts.into_iter().all(is_kin)
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

    #[test]
    fn names_of_a_family_are_no_slips() {
        for (a, b) in [
            ("k_c_kn_per_m_n1", "k_phi_kn_per_m_n2"),
            ("size_x_m", "size_y_m"),
            ("c_1", "c_2"),
        ] {
            assert!(are_siblings(a, b), "{a} {b}");
        }
        for (a, b) in [
            ("raduis_m", "radius_m"),
            ("radius", "radius_m"),
            ("load_kg", "load_n"),
            ("phi_dg", "phi_deg"),
            ("size_x_m", "size_x_m"),
        ] {
            assert!(!are_siblings(a, b), "{a} {b}");
        }
    }
}
