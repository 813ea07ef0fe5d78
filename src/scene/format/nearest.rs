//! What a mistyped name was probably meant to be.

/// The name of `known` that is nearest to `name`, if one is near enough to be meant.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name: Vec<char> = name.chars().flat_map(char::to_lowercase).take(64).collect();
    let close = known.into_iter().map(|k| (distance(&name, k), k)).min()?;
    (close.0 <= (name.len() / 3).max(1)).then_some(close.1)
}

/// How many letters must be changed, added, left out or swapped with their neighbour.
fn distance(a: &[char], b: &str) -> usize {
    let b: Vec<char> = b.chars().flat_map(char::to_lowercase).collect();
    let mut rows = vec![(0..=b.len()).collect::<Vec<usize>>()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let change = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = change.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            row.push(best);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_understood_and_other_words_are_not() {
        let known = ["radius", "center", "color"];
        for (slip, meant) in
            [("raduis", "radius"), ("colour", "color"), ("Radius", "radius"), ("centre", "center")]
        {
            assert_eq!(nearest(slip, known), Some(meant), "{slip}");
        }
        for word in ["height", "", "r", "texture"] {
            assert_eq!(nearest(word, known), None, "{word}");
        }
    }
}
