//! Drawings of lines, discs and words, which become SVG or pixels.

/// A colour; sRGB.
pub(super) type Color = [u8; 3];

/// Where a word stands from its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A part of a drawing. Lengths are in units of the drawing, from its upper left corner.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Item {
    Line {
        points: Vec<(f64, f64)>,
        color: Color,
        width: f64,
    },
    Disc {
        center: (f64, f64),
        radius: f64,
        color: Color,
    },
    /// Words on a base line; upright ones read from below to above.
    Text {
        at: (f64, f64),
        text: String,
        anchor: Anchor,
        color: Color,
        upright: bool,
    },
}

/// A drawing on white.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Drawing {
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) items: Vec<Item>,
}

/// The width of a letter, which is the same for all; they are about as high above the base line.
pub(super) const LETTER: f64 = 8.0;

impl Drawing {
    pub(super) fn line(&mut self, points: &[(f64, f64)], color: Color, width: f64) {
        self.items.push(Item::Line { points: points.to_vec(), color, width });
    }

    pub(super) fn disc(&mut self, center: (f64, f64), radius: f64, color: Color) {
        self.items.push(Item::Disc { center, radius, color });
    }

    pub(super) fn text(&mut self, at: (f64, f64), text: &str, anchor: Anchor, color: Color) {
        self.items.push(Item::Text { at, text: text.to_owned(), anchor, color, upright: false });
    }

    pub(super) fn upright_text(&mut self, at: (f64, f64), text: &str, color: Color) {
        let anchor = Anchor::Middle;
        self.items.push(Item::Text { at, text: text.to_owned(), anchor, color, upright: true });
    }
}
