//! The picture in a terminal.

use std::fmt::Write as _;
use std::io::{self, IsTerminal, Write};

use terminal_size::{Height, Width, terminal_size_of};
use whitted::checkpoint::Job;
use whitted::film::Film;
use whitted::film::encode::to_srgb8;

/// The upper half of a letter's box, which is drawn in the foreground's colour; the lower one has the background's.
const HALF: char = '▀';
/// Columns and rows of a terminal that does not say how many it has.
const USUAL: [u32; 2] = [80, 24];
/// Rows left free, for a line of progress and the prompt.
const FREE_ROWS: u32 = 2;

/// A picture in a terminal, drawn anew over itself.
pub(crate) struct Terminal {
    room: [u32; 2],
    /// Rows that were drawn, over which the next picture goes.
    drawn: u32,
}

impl Terminal {
    /// Standard error, if that is a terminal that can show a picture.
    pub(crate) fn on_stderr() -> Option<Self> {
        let can_draw = std::env::var_os("TERM").is_none_or(|name| name != "dumb");
        if !io::stderr().is_terminal() || !can_draw {
            return None;
        }
        let [columns, rows] = size().unwrap_or(USUAL);
        Some(Self { room: [columns, rows.saturating_sub(FREE_ROWS).max(1)], drawn: 0 })
    }

    /// What draws the film over the one before, with a line below it.
    fn frame(&mut self, film: &Film, line: &str) -> String {
        let (picture, rows) = half_blocks(film, self.room);
        let up = if self.drawn > 0 { format!("\x1b[{}A\r", self.drawn) } else { String::new() };
        self.drawn = rows + 1;
        format!("{up}{picture}\x1b[2K{line}\n")
    }

    /// Draws what there is of the picture, and how much that is; nobody is left to tell if that fails.
    pub(crate) fn draw(&mut self, job: &Job, percent: u64) {
        let frame = job.with_film(|film| self.frame(film, &format!("{percent} %")));
        let _ = io::stderr().lock().write_all(frame.as_bytes());
    }
}

/// Columns and rows of the terminal.
fn size() -> Option<[u32; 2]> {
    let (Width(columns), Height(rows)) = terminal_size_of(io::stderr())?;
    Some([u32::from(columns), u32::from(rows)])
}

/// The picture in letters, two pixels each, one above the other, as large as fits into so many columns and rows; and
/// its rows.
fn half_blocks(film: &Film, [columns, rows]: [u32; 2]) -> (String, u32) {
    let (width, height) = (film.width().max(1), film.height().max(1));
    let shrink =
        (f64::from(columns) / f64::from(width)).min(f64::from(2 * rows) / f64::from(height));
    let side = |pixels: u32, most: u32| {
        ((f64::from(pixels) * shrink.min(1.0)).round() as u32).clamp(1, most)
    };
    let (width, height) = (side(width, columns), side(height, 2 * rows).next_multiple_of(2));
    let bytes = to_srgb8(&film.resampled([width, height]));
    let mut text = String::new();
    let row_bytes = 3 * width as usize;
    for two_rows in bytes.chunks_exact(2 * row_bytes) {
        let (upper, lower) = two_rows.split_at(row_bytes);
        for (u, l) in upper.chunks_exact(3).zip(lower.chunks_exact(3)) {
            let _ = write!(
                text,
                "\x1b[38;2;{};{};{};48;2;{};{};{}m{HALF}",
                u[0], u[1], u[2], l[0], l[1], l[2]
            );
        }
        text.push_str("\x1b[0m\n");
    }
    (text, height / 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use whitted::Rgb;

    #[test]
    fn frames_go_over_each_other() {
        let film = Film::new(4, 4);
        let mut preview = Terminal { room: [80, 22], drawn: 0 };
        let first = preview.frame(&film, "0 %");
        assert!(!first.contains("A\r") && first.ends_with("m\n\x1b[2K0 %\n"), "{first:?}");
        let second = preview.frame(&film, "1 %");
        assert!(second.starts_with("\x1b[3A\r\x1b[38"), "{second:?}");
        assert_eq!(second.lines().count(), 3);
    }

    /// Oracle: the colours of a film of two halves, and the letters counted.
    #[test]
    fn letters_show_two_pixels_each_and_fit() {
        let pixels = [Rgb::ZERO, Rgb::ONE, Rgb::X, Rgb::Z].to_vec();
        let film = Film::from_parts(2, 2, pixels, vec![1; 4]);
        let expected =
            "\x1b[38;2;0;0;0;48;2;255;0;0m▀\x1b[38;2;255;255;255;48;2;0;0;255m▀\x1b[0m\n";
        assert_eq!(half_blocks(&film, [80, 24]), (expected.to_owned(), 1));
        for (size, room, letters) in [
            ([600, 600], [80, 22], [44, 22]),
            ([1600, 100], [80, 22], [80, 3]),
            ([1, 1000], [80, 22], [1, 22]),
            ([10, 6], [80, 22], [10, 3]),
            ([3000, 1], [1, 1], [1, 1]),
        ] {
            let (text, rows) = half_blocks(&Film::new(size[0], size[1]), room);
            let widths: Vec<usize> = text.lines().map(|line| line.matches(HALF).count()).collect();
            assert_eq!(widths, vec![letters[0]; letters[1]], "{size:?}");
            assert_eq!(rows as usize, letters[1]);
        }
    }
}
