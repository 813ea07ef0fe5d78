//! Drawings as pixels.

use font8x8::legacy::BASIC_LEGACY;

use super::draw::{Anchor, Color, Drawing, Item, LETTER};

/// Pixels for each unit of the drawing.
const SCALE: f64 = 2.0;
/// Pixels for each dot of a letter, of which there are eight either way.
const DOT: i64 = 2;

/// Pixels in sRGB, row by row.
pub(super) struct Raster {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) bytes: Vec<u8>,
}

impl Raster {
    pub(super) fn of(drawing: &Drawing) -> Self {
        let (width, height) = ((drawing.width * SCALE) as usize, (drawing.height * SCALE) as usize);
        let mut raster = Self { width, height, bytes: vec![255; 3 * width * height] };
        for item in &drawing.items {
            match item {
                Item::Line { points, color, width } => {
                    for pair in points.windows(2) {
                        raster.stroke(pair[0], pair[1], width / 2.0, *color);
                    }
                }
                Item::Disc { center, radius, color } => {
                    raster.stroke(*center, *center, *radius, *color);
                }
                Item::Text { at, text, anchor, color, upright } => {
                    raster.text(*at, text, *anchor, *color, *upright);
                }
            }
        }
        raster
    }

    /// All that is within `radius` of the way from `a` to `b`, the edge over one pixel.
    fn stroke(&mut self, a: (f64, f64), b: (f64, f64), radius: f64, color: Color) {
        let (a, b) = (glam::DVec2::new(a.0, a.1) * SCALE, glam::DVec2::new(b.0, b.1) * SCALE);
        let radius = radius * SCALE;
        let (low, high) = (a.min(b) - radius - 1.0, a.max(b) + radius + 1.0);
        let clip = |x: f64, end: usize| x.clamp(0.0, end as f64) as usize;
        for y in clip(low.y, self.height)..clip(high.y + 1.0, self.height) {
            for x in clip(low.x, self.width)..clip(high.x + 1.0, self.width) {
                let p = glam::DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                let (along, whole) = (b - a, (b - a).length_squared());
                let t =
                    if whole > 0.0 { ((p - a).dot(along) / whole).clamp(0.0, 1.0) } else { 0.0 };
                let coverage = (radius + 0.5 - p.distance(a + along * t)).clamp(0.0, 1.0);
                self.blend(x as i64, y as i64, color, coverage);
            }
        }
    }

    fn blend(&mut self, x: i64, y: i64, color: Color, coverage: f64) {
        if x < 0 || y < 0 || x >= self.width as i64 || y >= self.height as i64 {
            return;
        }
        let start = 3 * (y as usize * self.width + x as usize);
        for (byte, channel) in self.bytes[start..start + 3].iter_mut().zip(color) {
            let (old, new) = (f64::from(*byte), f64::from(channel));
            *byte = (old + (new - old) * coverage).round() as u8;
        }
    }

    fn text(&mut self, at: (f64, f64), text: &str, anchor: Anchor, color: Color, upright: bool) {
        let long = text.chars().count() as f64 * LETTER;
        let back = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => long / 2.0,
            Anchor::End => long,
        };
        let (x0, y0) = if upright { (at.0, at.1 + back) } else { (at.0 - back, at.1) };
        let (x0, y0) = ((x0 * SCALE) as i64, (y0 * SCALE) as i64);
        for (letter, place) in text.chars().zip(0_i64..) {
            let glyph = BASIC_LEGACY.get(letter as usize).copied().unwrap_or([0x7e; 8]);
            for (row, bits) in glyph.iter().zip(0_i64..) {
                for column in (0..8_i64).filter(|column| row >> column & 1 == 1) {
                    // Along the line of writing, and up from the base line; the lowest row is for descenders.
                    let (along, up) = ((8 * place + column) * DOT, (7 - bits) * DOT);
                    for (i, j) in (0..DOT).flat_map(|i| (0..DOT).map(move |j| (i, j))) {
                        let (x, y) = if upright {
                            (x0 - up - j, y0 - along - i)
                        } else {
                            (x0 + along + i, y0 - up - j)
                        };
                        self.blend(x, y, color, 1.0);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the area of a disc, and the darkness of the pixels together.
    #[test]
    fn a_disc_has_the_area_of_a_disc() {
        let mut drawing = Drawing { width: 40.0, height: 30.0, ..Drawing::default() };
        drawing.disc((20.3, 14.8), 7.0, [0; 3]);
        let raster = Raster::of(&drawing);
        let dark: f64 =
            raster.bytes.iter().map(|byte| 1.0 - f64::from(*byte) / 255.0).sum::<f64>() / 3.0;
        let area = std::f64::consts::PI * (7.0 * SCALE).powi(2);
        assert!((dark / area - 1.0).abs() < 0.01, "{dark}, {area}");
    }

    #[test]
    fn what_lies_outside_is_cut_off() {
        let mut drawing = Drawing { width: 10.0, height: 10.0, ..Drawing::default() };
        drawing.line(&[(-50.0, -50.0), (500.0, 5.0)], [0; 3], 3.0);
        drawing.text((-20.0, 3.0), "outside é", Anchor::End, [0; 3]);
        drawing.upright_text((3.0, -9.0), "up", [0; 3]);
        assert_eq!(Raster::of(&drawing).bytes.len(), 3 * 20 * 20);
    }
}
