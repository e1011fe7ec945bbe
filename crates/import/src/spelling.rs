//! What the author may have meant.

/// The candidate that is nearest to `name`, if one is near enough to be a slip of the pen: at
/// most a third of its letters added, lost, changed or swapped with a neighbour.
pub(crate) fn nearest<'n>(
    name: &str,
    candidates: impl IntoIterator<Item = &'n str>,
) -> Option<&'n str> {
    // No candidate is that long, and the distance takes quadratic time.
    if name.len() > 64 {
        return None;
    }
    let allowed = name.chars().count().div_ceil(3);
    candidates
        .into_iter()
        .map(|candidate| (distance(name, candidate), candidate))
        .filter(|(distance, _)| *distance <= allowed)
        .min()
        .map(|(_, candidate)| candidate)
}

/// Number of letters to add, remove, change or swap (Damerau 1964, without editing a swap again).
fn distance(from: &str, to: &str) -> usize {
    let from: Vec<char> = from.chars().flat_map(char::to_lowercase).collect();
    let to: Vec<char> = to.chars().flat_map(char::to_lowercase).collect();
    let mut before = vec![0; to.len() + 1];
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for i in 1..=from.len() {
        let mut next = vec![i; to.len() + 1];
        for j in 1..=to.len() {
            let changed = usize::from(from[i - 1] != to[j - 1]);
            next[j] = (row[j - 1] + changed).min(row[j] + 1).min(next[j - 1] + 1);
            if i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1] {
                next[j] = next[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut row, next);
    }
    row[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_counted() {
        for (from, to, expected) in [
            ("", "", 0),
            ("", "abc", 3),
            ("cylinder", "cylindre", 1),
            ("shpere", "sphere", 1),
            ("kitten", "sitting", 3),
        ] {
            assert_eq!(distance(from, to), expected, "{from} {to}");
            assert_eq!(distance(to, from), expected, "{to} {from}");
        }
    }

    #[test]
    fn only_near_names_are_offered() {
        let known = ["sphere", "cube", "cylinder"];
        assert_eq!(nearest("Spehre", known), Some("sphere"));
        assert_eq!(nearest("qube", known), Some("cube"));
        assert_eq!(nearest("torus", known), None);
        assert_eq!(nearest(&"x".repeat(100), known), None);
    }
}
