//! Tokens of an NFF file: line breaks are blanks, and `#` starts a comment.

use glam::DVec3;

use crate::scene::text::{Lines, Tokens, float, name_of};

/// Reads tokens and knows their lines.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    lines: Lines<'a>,
    current: Vec<u8>,
    /// Where the next token begins in `current`.
    at: usize,
    line: u32,
    /// The line of the last token that was taken.
    taken: u32,
}

impl<'a> Reader<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { lines: Lines::new(text), current: Vec::new(), at: 0, line: 0, taken: 0 }
    }

    /// The line of the last token taken, or of the one that was found in the place of another.
    pub(super) fn line(&self) -> u32 {
        self.taken.max(1)
    }

    /// Where the next token is in the current line, going on to further lines as needed.
    fn seek(&mut self) -> Option<(usize, usize)> {
        loop {
            let rest = &self.current[self.at..];
            let mut tokens = Tokens::new(rest);
            if let Some(token) = tokens.next_number() {
                let end = self.current.len() - tokens.left();
                return Some((end - token.len(), end));
            }
            let (line, text) = self.lines.next_line()?;
            self.current.clear();
            self.current.extend_from_slice(text);
            (self.line, self.at) = (line, 0);
        }
    }

    fn next(&mut self) -> Option<&[u8]> {
        let (start, end) = self.seek()?;
        (self.at, self.taken) = (end, self.line);
        Some(&self.current[start..end])
    }

    /// The next token, whatever it is, as text.
    pub(super) fn keyword(&mut self) -> Option<String> {
        self.next().map(|token| name_of(&token[..token.len().min(40)]))
    }

    /// Whether the next token is a number.
    pub(super) fn number_follows(&mut self) -> bool {
        self.seek().is_some_and(|(start, end)| float(&self.current[start..end]).is_some())
    }

    /// The next token as a finite number, called `name` in messages.
    pub(super) fn number(&mut self, name: &str) -> Result<f64, String> {
        let Some(token) = self.next() else {
            return Err(format!("the file ends where `{name}` should be"));
        };
        match float(token) {
            Some(value) if value.is_finite() => Ok(value),
            Some(value) => Err(format!("`{name}` is {value}, but must be finite")),
            None => {
                let found = name_of(&token[..token.len().min(40)]);
                Err(format!("`{found}` found where a number for `{name}` should be"))
            }
        }
    }

    pub(super) fn vector(&mut self, name: &str) -> Result<DVec3, String> {
        Ok(DVec3::new(self.number(name)?, self.number(name)?, self.number(name)?))
    }

    /// The next token as a whole number from `least` to `most`.
    pub(super) fn count(&mut self, name: &str, least: u32, most: u32) -> Result<u32, String> {
        let value = self.number(name)?;
        let is_count = value >= f64::from(least) && value <= f64::from(most);
        if is_count && value.fract() == 0.0 {
            Ok(value as u32)
        } else {
            Err(format!("`{name}` is {value}, but must be a whole number from {least} to {most}"))
        }
    }

    /// The keyword `name` and then its value's tokens, as `v` has them.
    pub(super) fn expect(&mut self, name: &str) -> Result<(), String> {
        match self.keyword() {
            Some(found) if found == name => Ok(()),
            Some(found) => Err(format!("`{found}` found where `{name}` should be")),
            None => Err(format!("the file ends where `{name}` should be")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_breaks_and_comments_are_blanks() {
        let mut reader = Reader::new(b"c 1 2\n# two lines on one\n\t3#4\n\nb");
        assert_eq!(reader.keyword().as_deref(), Some("c"));
        assert_eq!(reader.vector("base"), Ok(DVec3::new(1.0, 2.0, 3.0)));
        assert!(!reader.number_follows());
        assert_eq!(reader.line(), 3);
        let error = "`b` found where a number for `radius` should be";
        assert_eq!((reader.number("radius"), reader.line()), (Err(error.to_owned()), 5));
        let error = "the file ends where `radius` should be";
        assert_eq!(reader.number("radius"), Err(error.to_owned()));
    }

    #[test]
    fn counts_are_checked_before_anything_is_made() {
        let mut reader = Reader::new(b"4000000000 2.5 3");
        assert!(reader.count("corners", 3, 10_000).is_err());
        assert!(reader.count("corners", 3, 10_000).is_err());
        assert_eq!(reader.count("corners", 3, 10_000), Ok(3));
    }
}
