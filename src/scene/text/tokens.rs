//! Tokens between white space, and what is left of a line.

/// The tokens of a line, up to a comment.
#[derive(Clone, Copy, Debug)]
pub struct Tokens<'a> {
    rest: &'a [u8],
}

#[inline(always)]
fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c)
}

impl<'a> Tokens<'a> {
    /// The tokens of `line`.
    #[inline]
    pub fn new(line: &'a [u8]) -> Self {
        Self { rest: line }
    }

    /// The next token without a number sign, which begins a comment wherever it stands.
    #[inline]
    pub fn next_number(&mut self) -> Option<&'a [u8]> {
        self.skip_blanks();
        let end = self
            .rest
            .iter()
            .position(|&byte| is_blank(byte) || byte == b'#')
            .unwrap_or(self.rest.len());
        let (token, rest) = self.rest.split_at(end);
        self.rest = rest;
        (end > 0).then_some(token)
    }

    /// The next token; a number sign begins a comment only where a token could begin.
    #[inline]
    pub fn next_word(&mut self) -> Option<&'a [u8]> {
        self.skip_blanks();
        if self.rest.first() == Some(&b'#') {
            return None;
        }
        let end = self.rest.iter().position(|&byte| is_blank(byte)).unwrap_or(self.rest.len());
        let (token, rest) = self.rest.split_at(end);
        self.rest = rest;
        (end > 0).then_some(token)
    }

    /// How many bytes of the line are left.
    #[inline]
    pub fn left(&self) -> usize {
        self.rest.len()
    }

    /// All that is left of the line, as a name that may have blanks inside: trimmed, without comment and quotes.
    pub fn rest_as_name(self) -> &'a [u8] {
        let mut end = self.rest.len();
        for (at, pair) in self.rest.windows(2).enumerate() {
            if is_blank(pair[0]) && pair[1] == b'#' {
                end = at;
                break;
            }
        }
        if self.rest.first() == Some(&b'#') {
            end = 0;
        }
        let name = self.rest[..end].trim_ascii();
        match name {
            [b'"', inner @ .., b'"'] | [b'\'', inner @ .., b'\''] => inner,
            _ => name,
        }
    }

    #[inline]
    fn skip_blanks(&mut self) {
        while let [byte, rest @ ..] = self.rest {
            if !is_blank(*byte) {
                break;
            }
            self.rest = rest;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_end_numbers_anywhere_and_words_where_they_begin() {
        let mut tokens = Tokens::new(b"\tv 1.5 2# 3");
        assert_eq!(tokens.next_word(), Some(&b"v"[..]));
        assert_eq!(tokens.next_number(), Some(&b"1.5"[..]));
        assert_eq!(tokens.next_number(), Some(&b"2"[..]));
        assert_eq!(tokens.next_number(), None);
        let mut tokens = Tokens::new(b"usemtl a#1 #2");
        tokens.next_word();
        assert_eq!(tokens.rest_as_name(), b"a#1");
        assert_eq!(tokens.next_word(), Some(&b"a#1"[..]));
        assert_eq!(tokens.next_word(), None);
    }

    #[test]
    fn names_keep_their_blanks() {
        let name = |line: &'static [u8]| Tokens::new(line).rest_as_name();
        assert_eq!(name(b"  red paint.mtl \t"), b"red paint.mtl");
        assert_eq!(name(b" \"red paint.mtl\" # the old one"), b"red paint.mtl");
        assert_eq!(name(b"# nothing"), b"");
    }
}
