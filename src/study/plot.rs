//! A plot: axes, lines and dots.

use super::{
    draw::{Anchor, Color, Drawing, LETTER},
    raster::Raster,
    svg::svg,
};

const BLACK: Color = [32, 32, 32];
const GREY: Color = [225, 225, 225];

/// A plot, ready to be written in either form.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Its name, for the file.
    pub name: String,
    /// What it shows, in a line.
    pub title: String,
    drawing: Drawing,
}

/// A plot in pixels: 8-bit sRGB, row by row.
pub struct Pixels {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Three bytes for each pixel.
    pub bytes: Vec<u8>,
}

impl Chart {
    /// The plot as SVG.
    pub fn svg(&self) -> String {
        svg(&self.drawing)
    }

    /// The plot as pixels.
    pub fn pixels(&self) -> Pixels {
        let Raster { width, height, bytes } = Raster::of(&self.drawing);
        Pixels { width: width as u32, height: height as u32, bytes }
    }
}

/// What is drawn in one colour.
pub(super) struct Series {
    pub(super) name: String,
    pub(super) points: Vec<(f64, f64)>,
    /// What stands beside each point, if anything.
    pub(super) labels: Vec<String>,
    pub(super) color: Color,
    pub(super) line: bool,
    pub(super) dots: bool,
}

/// An axis: what stands at it, and how numbers become places.
struct Axis {
    log: bool,
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn new(values: impl Iterator<Item = f64>, log: bool, from: f64, to: f64) -> Self {
        let known = values.filter(|x| x.is_finite() && (!log || *x > 0.0));
        let (low, high) =
            known.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        let (low, high) = if low <= high { (low, high) } else { (1.0, 10.0) };
        let (low, high) = if log {
            (low / 1.25, high * 1.25)
        } else {
            let margin = ((high - low) * 0.08).max(0.02 * high.abs()).max(1e-9);
            (low - margin, high + margin)
        };
        Self { log, low, high, from, to }
    }

    fn place(&self, value: f64) -> f64 {
        let part = if self.log {
            (value.max(self.low) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        self.from + (self.to - self.from) * part
    }

    /// Numbers to mark: powers of ten, with 2 and 5 between if there are few; or round steps.
    fn ticks(&self) -> Vec<f64> {
        let mut ticks = Vec::new();
        if self.log {
            let decades = (self.high / self.low).log10();
            let steps: &[f64] = if decades > 3.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
            let first = self.low.log10().floor() as i32;
            for power in first..=self.high.log10().ceil() as i32 {
                ticks.extend(steps.iter().map(|step| step * 10_f64.powi(power)));
            }
        } else {
            let rough = (self.high - self.low) / 6.0;
            let power = 10_f64.powf(rough.log10().floor());
            let step = [1.0, 2.0, 5.0, 10.0].map(|k| k * power).into_iter().find(|s| *s >= rough);
            let step = step.unwrap_or(rough);
            let first = (self.low / step).ceil() as i64;
            ticks.extend((first..first + 12).map(|k| k as f64 * step));
        }
        ticks.retain(|x| (self.low..=self.high).contains(x));
        ticks
    }
}

fn number(x: f64) -> String {
    if x != 0.0 && !(1e-4..1e5).contains(&x.abs()) {
        format!("{x:.0e}")
    } else {
        format!("{}", (x * 1e6).round() / 1e6)
    }
}

/// The name and kind of an axis: whether it is logarithmic.
pub(super) type AxisName<'a> = (&'a str, bool);

/// Draws the series, their names beside them.
pub(super) fn plot(
    name: &str,
    title: &str,
    x_name: AxisName,
    y_name: AxisName,
    series: &[Series],
) -> Chart {
    let height = 560.0;
    let (left, right, top, bottom) = (80.0, 710.0, 40.0, height - 60.0);
    let name_at = right + 26.0;
    let end = |from: f64, text: &str| from + LETTER * (text.chars().count() + 1) as f64;
    let ends = series.iter().map(|series| end(name_at, &series.name));
    let width = ends.fold(end(left, title).max(900.0), f64::max).ceil();
    let mut drawing = Drawing { width, height, ..Drawing::default() };
    let all = || series.iter().flat_map(|s| s.points.iter().copied());
    let x_axis = Axis::new(all().map(|p| p.0), x_name.1, left, right);
    let y_axis = Axis::new(all().map(|p| p.1), y_name.1, bottom, top);
    for tick in x_axis.ticks() {
        let x = x_axis.place(tick);
        drawing.line(&[(x, top), (x, bottom)], GREY, 1.0);
        drawing.text((x, bottom + 20.0), &number(tick), Anchor::Middle, BLACK);
    }
    for tick in y_axis.ticks() {
        let y = y_axis.place(tick);
        drawing.line(&[(left, y), (right, y)], GREY, 1.0);
        drawing.text((left - 8.0, y + 4.0), &number(tick), Anchor::End, BLACK);
    }
    drawing.line(&[(left, top), (left, bottom), (right, bottom)], BLACK, 1.0);
    drawing.text((left, 22.0), title, Anchor::Start, BLACK);
    drawing.text((f64::midpoint(left, right), height - 14.0), x_name.0, Anchor::Middle, BLACK);
    drawing.upright_text((20.0, f64::midpoint(top, bottom)), y_name.0, BLACK);
    for (series, place) in series.iter().zip(0_u32..) {
        let points: Vec<(f64, f64)> =
            series.points.iter().map(|(x, y)| (x_axis.place(*x), y_axis.place(*y))).collect();
        if series.line {
            drawing.line(&points, series.color, 2.0);
        }
        for (k, point) in points.iter().enumerate() {
            if series.dots {
                drawing.disc(*point, 4.0, series.color);
            }
            if let Some(label) = series.labels.get(k) {
                // To the left where it would run into the names.
                let fits = point.0 + LETTER * (label.len() + 1) as f64 <= right;
                let (side, anchor) = if fits { (1.0, Anchor::Start) } else { (-1.0, Anchor::End) };
                let at = (point.0 + side * LETTER, point.1 - LETTER);
                drawing.text(at, label, anchor, series.color);
            }
        }
        let y = top + 10.0 + 20.0 * f64::from(place);
        drawing.disc((right + 16.0, y - 4.0), 4.0, series.color);
        drawing.text((name_at, y), &series.name, Anchor::Start, BLACK);
    }
    Chart { name: name.to_owned(), title: title.to_owned(), drawing }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the last letter, wherever it is, has as much room as each has.
    #[test]
    fn names_and_titles_have_room() {
        let chart = |title: &str, name: &str| {
            let series = Series {
                name: name.to_owned(),
                points: vec![(1.0, 1.0)],
                labels: Vec::new(),
                color: BLACK,
                line: false,
                dots: true,
            };
            plot("a", title, ("x", true), ("y", true), &[series]).drawing.width
        };
        assert_eq!(chart("short", "short"), 900.0);
        let name = "a scene with a long name, adaptive:1,64";
        assert!(chart("short", name) >= 736.0 + LETTER * 39.0);
        let title = "a".repeat(200);
        assert!(chart(&title, "short") >= 80.0 + LETTER * 200.0);
    }

    /// Oracle: worked by hand.
    #[test]
    fn axes_place_and_mark_numbers() {
        let axis = Axis { log: true, low: 1.0, high: 100.0, from: 0.0, to: 200.0 };
        assert!((axis.place(10.0) - 100.0).abs() < 1e-9);
        assert_eq!(axis.ticks(), [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]);
        let axis = Axis { log: false, low: 0.0, high: 6.0, from: 10.0, to: 70.0 };
        assert_eq!((axis.place(3.0), axis.ticks().len()), (40.0, 7));
        assert_eq!([1e6, 0.05, 20.0, 0.0].map(number), ["1e6", "0.05", "20", "0"]);
    }
}
