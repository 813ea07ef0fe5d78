//! Text over a picture.

use font8x8::legacy::BASIC_LEGACY;

/// Rows and columns of dots of a letter.
const LETTER: usize = 8;
/// Dots between two lines.
const GAP: usize = 3;
const INK: u32 = 0x00ff_ffff;

/// Pixels of a window, 0x00RRGGBB each, row by row.
pub(super) struct Pixels<'a> {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) values: &'a mut [u32],
}

impl Pixels<'_> {
    /// Writes lines at the lower edge, on a ground made darker; what does not fit is cut off.
    pub(super) fn write(&mut self, lines: &[String], dot: usize) {
        if lines.is_empty() {
            return;
        }
        let (line_height, margin) = ((LETTER + GAP) * dot, 2 * dot);
        let rows = (lines.len() * line_height + margin).min(self.height);
        let top = self.height - rows;
        for value in &mut self.values[top * self.width..self.height * self.width] {
            *value = (*value >> 2) & 0x003f_3f3f;
        }
        for (line, text) in lines.iter().enumerate() {
            for (place, letter) in text.chars().enumerate() {
                let glyph = BASIC_LEGACY.get(letter as usize).copied().unwrap_or([0x7e; LETTER]);
                let left = margin + place * LETTER * dot;
                self.stamp(glyph, left, top + margin + line * line_height, dot);
            }
        }
    }

    fn stamp(&mut self, glyph: [u8; LETTER], left: usize, top: usize, dot: usize) {
        for (y, x) in (0..LETTER * dot).flat_map(|y| (0..LETTER * dot).map(move |x| (y, x))) {
            let is_ink = glyph[y / dot] >> (x / dot) & 1 == 1;
            if is_ink && left + x < self.width && top + y < self.height {
                self.values[(top + y) * self.width + left + x] = INK;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the dots of the letters, counted.
    #[test]
    fn letters_have_all_their_dots_and_stay_inside() {
        let dots = |text: &str| -> u32 {
            text.bytes().flat_map(|b| BASIC_LEGACY[b as usize]).map(u8::count_ones).sum()
        };
        let mut values = vec![0x0080_8080; 200 * 60];
        let lines = ["Hello".to_owned(), "0.3 s".to_owned()];
        Pixels { width: 200, height: 60, values: &mut values }.write(&lines, 2);
        let ink = values.iter().filter(|value| **value == INK).count();
        assert_eq!(ink as u32, 4 * (dots("Hello") + dots("0.3 s")));
        assert_eq!(values[0], 0x0080_8080);
        assert_eq!(values[59 * 200], 0x0020_2020);
        for (width, height) in [(3, 2), (1, 100), (40, 12)] {
            let mut values = vec![0; width * height];
            Pixels { width, height, values: &mut values }.write(&lines, 3);
        }
    }
}
