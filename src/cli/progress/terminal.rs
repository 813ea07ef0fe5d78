//! Standard error as a terminal, whatever it is.

use std::io::{self, Write};

use indicatif::TermLike;

/// Standard error as indicatif draws on it, terminal or not, for whoever asks for the bar by name.
#[derive(Debug)]
pub(super) struct AnyStderr;

impl AnyStderr {
    fn send(text: &str) -> io::Result<()> {
        io::stderr().write_all(text.as_bytes())
    }

    fn step(letter: char, n: usize) -> io::Result<()> {
        if n == 0 { Ok(()) } else { Self::send(&format!("\x1b[{n}{letter}")) }
    }
}

impl TermLike for AnyStderr {
    fn width(&self) -> u16 {
        80
    }

    fn move_cursor_up(&self, n: usize) -> io::Result<()> {
        Self::step('A', n)
    }

    fn move_cursor_down(&self, n: usize) -> io::Result<()> {
        Self::step('B', n)
    }

    fn move_cursor_right(&self, n: usize) -> io::Result<()> {
        Self::step('C', n)
    }

    fn move_cursor_left(&self, n: usize) -> io::Result<()> {
        Self::step('D', n)
    }

    fn write_line(&self, text: &str) -> io::Result<()> {
        Self::send(&format!("{text}\n"))
    }

    fn write_str(&self, text: &str) -> io::Result<()> {
        Self::send(text)
    }

    fn clear_line(&self) -> io::Result<()> {
        Self::send("\r\x1b[2K")
    }

    fn flush(&self) -> io::Result<()> {
        io::stderr().flush()
    }
}
