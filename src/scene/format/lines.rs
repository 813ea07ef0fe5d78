//! Lines that are no TOML, which would hide what follows them.

use std::{borrow::Cow, ops::Range};

use toml::de::{DeTable, DeValue, Error};

/// A fault: where, and what.
pub(super) type Found = (Range<usize>, String);

/// The most lines that are left out.
const MOST: usize = 50;

/// The text as it can be read on: lines without `=`, and tables, that are no TOML and behind which nothing is read are
/// blanks. And all that the parser found, in those lines and elsewhere.
pub(super) fn readable(text: &str) -> (Cow<'_, str>, Vec<Found>) {
    let mut readable = Cow::Borrowed(text);
    let mut found = Vec::new();
    for _ in 0..MOST {
        let (root, errors) = DeTable::parse_recoverable(&readable);
        let keys = keys(root.get_ref());
        let without = errors.iter().find_map(|error| without_line(&readable, error, keys));
        let Some((text, hiding)) = without else {
            found.extend(errors.iter().map(fault));
            break;
        };
        found.push(hiding);
        readable = Cow::Owned(text);
    }
    (readable, found)
}

/// The text without the line of an error, or the table that it begins, and the error; if more than so many keys can be
/// read then, or those of the table would be taken for others.
fn without_line(text: &str, error: &Error, keys_before: usize) -> Option<(String, Found)> {
    let start = text.get(..error.span()?.start)?.rfind('\n').map_or(0, |at| at + 1);
    let line = text[start..].lines().next()?;
    // Lists have commas.
    let is_header = line.trim_start().starts_with('[') && !line.contains(',');
    if line.contains('=') && !is_header || DeTable::parse_recoverable(line).1.is_empty() {
        return None;
    }
    // With a header goes its table, which would be taken for a part of another.
    let rest = &text[start + line.len()..];
    let table = if is_header { rest.find("\n[").unwrap_or(rest.len()) } else { 0 };
    let blank = |c: char| if c == '\n' { "\n".to_owned() } else { " ".repeat(c.len_utf8()) };
    let (end, mut without) = (start + line.len() + table, text.to_owned());
    without.replace_range(start..end, &text[start..end].chars().map(blank).collect::<String>());
    let after = keys(DeTable::parse_recoverable(&without).0.get_ref());
    (is_header || after > keys_before).then(|| (without, fault(error)))
}

/// How many keys there are in a table, and in those within.
fn keys(table: &DeTable) -> usize {
    table.values().map(|value| 1 + keys_within(value.get_ref())).sum()
}

fn keys_within(value: &DeValue) -> usize {
    match value {
        DeValue::Table(table) => keys(table),
        DeValue::Array(array) => array.iter().map(|value| keys_within(value.get_ref())).sum(),
        _ => 0,
    }
}

fn fault(error: &Error) -> Found {
    (error.span().unwrap_or(0..0), error.message().replace('\n', "; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: lines counted by hand.
    #[test]
    fn what_stands_behind_a_faulty_line_is_read() {
        let text = "a 1\nb = 2\n[c\nd = 3\n[e]\nf = [1,\n2]\nend\n";
        let (readable, found) = readable(text);
        assert_eq!(readable, "   \nb = 2\n  \n     \n[e]\nf = [1,\n2]\nend\n");
        let lines: Vec<usize> =
            found.iter().map(|(span, _)| text[..span.start].matches('\n').count()).collect();
        assert_eq!(lines, [0, 2, 7], "{found:?}");
        let sound = "a = 1 # [\n\n[b]\nc = [\n  [1],\n  [2],\n]\n";
        assert_eq!(super::readable(sound), (Cow::Borrowed(sound), Vec::new()));
        // Within a value a line is not by itself; what the parser says is all there is.
        let (unclosed, found) = super::readable("a = [\n1,\n");
        assert!(matches!(unclosed, Cow::Borrowed(_)) && !found.is_empty());
    }
}
