//! What is wrong with a scene's text, shown with the line it is in.

use std::{fmt, ops::Range};

/// The most faults of one text that are told.
const MOST_TOLD: usize = 50;

/// The longest part of a line that is shown.
const WIDTH: usize = 120;

/// Something wrong, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The line, from 1.
    pub line: usize,
    /// The column in letters, from 1.
    pub column: usize,
    /// What is wrong, and what would be right.
    pub message: String,
    /// The line's text.
    source: String,
    /// How many letters the fault is wide.
    width: usize,
}

/// All that is wrong with a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Faults {
    /// The file.
    pub file: String,
    /// The faults, in the order of the text.
    pub faults: Vec<Fault>,
}

impl std::error::Error for Faults {}

impl Fault {
    pub(super) fn new(text: &str, span: Range<usize>, message: String) -> Self {
        let mut start = span.start.min(text.len());
        while !text.is_char_boundary(start) {
            start -= 1;
        }
        let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let rest = text[line_start..].split('\n').next().unwrap_or_default();
        let source: String = rest.trim_end_matches('\r').to_owned();
        let column = text[line_start..start].chars().count() + 1;
        let end = span.end.clamp(start, line_start + source.len().max(start - line_start));
        let width = text.get(start..end).map_or(1, |part| part.chars().count()).max(1);
        let line = text[..start].matches('\n').count() + 1;
        Self { line, column, message, source, width }
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, fault) in self.faults.iter().take(MOST_TOLD).enumerate() {
            if k > 0 {
                writeln!(f)?;
            }
            let Fault { line, column, message, source, width } = fault;
            writeln!(f, "{}:{line}:{column}: {message}", self.file)?;
            let number = line.to_string();
            // Of a very long line only the part around the fault.
            let skip = if *column > WIDTH { column - WIDTH / 2 } else { 0 };
            let shown: String = source
                .chars()
                .skip(skip)
                .take(WIDTH)
                .map(|letter| if letter.is_control() { ' ' } else { letter })
                .collect();
            writeln!(f, "  {number} | {shown}")?;
            let carets = "^".repeat((*width).min(WIDTH));
            write!(f, "  {:1$} | {2:3$}{carets}", "", number.len(), "", column - 1 - skip)?;
        }
        match self.faults.len().checked_sub(MOST_TOLD) {
            Some(more @ 1..) => write!(f, "\nand {more} more"),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_caret_stands_under_the_fault() {
        let text = "a = 1\r\nö = \"é\" # x\n";
        let at = text.find('"').expect("a quote");
        let fault = Fault::new(text, at..at + 4, "no".to_owned());
        assert_eq!((fault.line, fault.column, fault.width), (2, 5, 3));
        let shown = Faults { file: "f".to_owned(), faults: vec![fault] }.to_string();
        assert_eq!(shown, "f:2:5: no\n  2 | ö = \"é\" # x\n    |     ^^^");
        for span in [0..0, 99..100, 8..9, 5..200] {
            let fault = Fault::new(text, span, String::new());
            assert!(fault.line >= 1 && fault.width >= 1);
        }
    }
}
