//! Lines that end in LF, CR LF or CR, with a `\` at the end to go on in the next.

use memchr::{memchr, memchr2};

/// The lines of a text, numbered from 1, continuations joined.
#[derive(Debug)]
pub struct Lines<'a> {
    rest: &'a [u8],
    number: u32,
    joined: Vec<u8>,
}

impl<'a> Lines<'a> {
    /// The lines of `text`.
    pub fn new(text: &'a [u8]) -> Self {
        Self::after(0, text)
    }

    /// The lines of `text`, before which the file has `number` lines.
    pub fn after(number: u32, text: &'a [u8]) -> Self {
        Self { rest: text, number, joined: Vec::new() }
    }

    /// How many lines of the file there were so far, each part of a joined one counted.
    pub fn count(&self) -> u32 {
        self.number
    }

    /// The next line and its number (that of its first part), without its end.
    ///
    /// Not an `Iterator`: a joined line lives until the next call.
    #[inline]
    pub fn next_line(&mut self) -> Option<(u32, &[u8])> {
        if self.rest.is_empty() {
            return None;
        }
        let line = self.cut();
        let number = self.number;
        if !goes_on(line) {
            return Some((number, line));
        }
        self.joined.clear();
        let mut part = line;
        while goes_on(part) {
            let end = part.trim_ascii_end();
            self.joined.extend_from_slice(&end[..end.len() - 1]);
            self.joined.push(b' ');
            if self.rest.is_empty() {
                part = &[];
                break;
            }
            part = self.cut();
        }
        self.joined.extend_from_slice(part);
        Some((number, &self.joined))
    }

    #[inline]
    fn cut(&mut self) -> &'a [u8] {
        self.number = self.number.saturating_add(1);
        let text = self.rest;
        let Some(end) = memchr2(b'\n', b'\r', text) else {
            self.rest = &[];
            return text;
        };
        let next = if text[end..].starts_with(b"\r\n") { end + 2 } else { end + 1 };
        self.rest = &text[next..];
        &text[..end]
    }
}

/// Cuts `text` after ends of lines, none of which goes on in the next, into parts of `least` bytes and a little more.
pub fn parts(text: &[u8], least: usize) -> Vec<&[u8]> {
    let (mut parts, mut rest) = (Vec::new(), text);
    while rest.len() > least {
        // Whether a line goes on is told by its own end alone, so any line may be the first to look at.
        let from = memchr::memrchr2(b'\n', b'\r', &rest[..least]).map_or(0, |end| end + 1);
        let is_between = from > 0 && rest[from - 1..].starts_with(b"\r\n");
        let mut lines = Lines::new(&rest[from + usize::from(is_between)..]);
        while lines.next_line().is_some() && lines.rest.len() + least > rest.len() {}
        let (part, others) = rest.split_at(rest.len() - lines.rest.len());
        parts.push(part);
        rest = others;
    }
    parts.push(rest);
    parts
}

/// How many lines end in `text`.
pub fn line_ends(text: &[u8]) -> u32 {
    let feeds = memchr::memchr_iter(b'\n', text).count();
    let returns = memchr::memchr_iter(b'\r', text).filter(|at| text.get(at + 1) != Some(&b'\n'));
    u32::try_from(feeds + returns.count()).unwrap_or(u32::MAX)
}

/// Whether the line ends in a backslash that is no part of a comment.
#[inline]
fn goes_on(line: &[u8]) -> bool {
    match line.last() {
        Some(b'\\') => {}
        Some(b' ' | b'\t') if line.trim_ascii_end().last() == Some(&b'\\') => {}
        _ => return false,
    }
    memchr(b'#', line).is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<(u32, String)> {
        let mut lines = Lines::new(text.as_bytes());
        let mut found = Vec::new();
        while let Some((number, line)) = lines.next_line() {
            found.push((number, String::from_utf8_lossy(line).into_owned()));
        }
        found
    }

    #[test]
    fn every_line_end_counts_once() {
        let expected: Vec<_> =
            [(1, "a"), (2, ""), (3, "b")].map(|(n, line)| (n, line.to_owned())).into();
        for text in ["a\n\nb", "a\r\n\r\nb\r\n", "a\r\rb\r", "a\n\rb\n"] {
            assert_eq!(lines(text), expected, "{text:?}");
        }
        assert!(lines("").is_empty());
    }

    /// Oracle: the lines of the whole text.
    #[test]
    fn parts_have_the_lines_of_the_whole() {
        for text in [
            "a\r\nb \\\r\n c\r\n\r\nd",
            "a\\\nb\\\n\\\nc\nd\n\n\ne",
            "a\r\rb\\\r\rc\n\rd\\",
            "long line",
            "",
        ] {
            for least in 1..text.len().max(2) {
                let (mut found, mut number) = (Vec::new(), 0);
                for part in parts(text.as_bytes(), least) {
                    let mut lines = Lines::after(number, part);
                    while let Some((number, line)) = lines.next_line() {
                        found.push((number, String::from_utf8_lossy(line).into_owned()));
                    }
                    number = lines.count();
                }
                assert_eq!(found, lines(text), "{text:?} in parts of {least}");
            }
        }
    }

    #[test]
    fn continued_lines_keep_the_first_number() {
        let text = "f 1 \\\n 2 \\ \r\n3\nv 0\n# C:\\dir\\\nlast\\";
        let expected =
            [(1, "f 1   2  3"), (4, "v 0"), (5, "# C:\\dir\\"), (6, "last ")].map(|(n, l)| (n, l));
        let found = lines(text);
        let found: Vec<_> = found.iter().map(|(n, l)| (*n, l.as_str())).collect();
        assert_eq!(found, expected);
    }
}
