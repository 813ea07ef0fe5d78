//! Plots of a study.

use super::{
    Row, Trade,
    draw::{Anchor, Color, Drawing, LETTER},
    pareto_front,
    raster::Raster,
    report::file_name,
    svg::svg,
};

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

/// The plots that the rows give.
pub fn charts(rows: &[Row]) -> Vec<Chart> {
    let of = |trade: Trade| rows.iter().filter(move |row| row.trade == trade).collect::<Vec<_>>();
    let mut charts = Vec::new();
    let accuracy = of(Trade::Accuracy);
    for scene in names(&accuracy, |row| &row.scene) {
        let rows: Vec<&Row> = accuracy.iter().copied().filter(|row| row.scene == scene).collect();
        charts.push(error_against_time(&scene, &rows));
    }
    if !accuracy.is_empty() {
        charts.push(estimate_against_error(&accuracy));
    }
    let objects = of(Trade::Objects);
    if !objects.is_empty() {
        charts.push(cost_by_objects(&objects));
    }
    let depths = of(Trade::Depth);
    if !depths.is_empty() {
        charts.push(error_by_depth(&depths));
    }
    let builds = of(Trade::Build);
    if !builds.is_empty() {
        charts.push(time_by_build(&builds));
    }
    charts
}

const BLACK: Color = [32, 32, 32];
const GREY: Color = [225, 225, 225];
/// Colours that stay apart for the colour-blind, after Okabe and Ito.
const COLORS: [Color; 7] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [120, 120, 120],
];

/// What is drawn in one colour.
struct Series {
    name: String,
    points: Vec<(f64, f64)>,
    /// What stands beside each point, if anything.
    labels: Vec<String>,
    color: Color,
    line: bool,
    dots: bool,
}

/// The distinct values of a field, in the order of their first appearance.
fn names(rows: &[&Row], field: impl Fn(&Row) -> &String) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for row in rows {
        if !names.contains(field(row)) {
            names.push(field(row).clone());
        }
    }
    names
}

/// The part of a mode's name before its numbers.
fn family(mode: &str) -> &str {
    mode.split(':').next().unwrap_or(mode)
}

fn error_against_time(scene: &str, rows: &[&Row]) -> Chart {
    let points: Vec<(f64, f64)> = rows.iter().map(|row| (row.seconds, row.measured_rmse)).collect();
    let mut series = vec![Series {
        name: "Pareto front".to_owned(),
        points: pareto_front(&points),
        labels: Vec::new(),
        color: [190, 190, 190],
        line: true,
        dots: false,
    }];
    let families = ["none", "grid", "adaptive", "max-error"];
    for (family_name, color) in families.iter().zip([COLORS[6], COLORS[1], COLORS[0], COLORS[2]]) {
        let own: Vec<&&Row> = rows.iter().filter(|row| family(&row.mode) == *family_name).collect();
        if own.is_empty() {
            continue;
        }
        let label = |mode: &str| {
            let numbers = mode.split_once(':').map_or(mode, |(_, numbers)| numbers);
            numbers.strip_suffix(",64").unwrap_or(numbers).to_owned()
        };
        series.push(Series {
            name: (*family_name).to_owned(),
            points: own.iter().map(|row| (row.seconds, row.measured_rmse)).collect(),
            labels: own.iter().map(|row| label(&row.mode)).collect(),
            color,
            line: false,
            dots: true,
        });
    }
    let (width, height) = rows.first().map_or((0, 0), |row| (row.width, row.height));
    plot(
        &format!("error-{}", file_name(scene)),
        &format!("Error against time: {scene}, {width}x{height}"),
        ("seconds", true),
        ("error, levels of 255 (root mean square)", true),
        &series,
    )
}

fn estimate_against_error(rows: &[&Row]) -> Chart {
    let all = rows.iter().flat_map(|row| [row.measured_rmse, row.estimated_rmse]);
    let (low, high) =
        all.fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    let line = |name: &str, factor: f64, color| Series {
        name: name.to_owned(),
        points: vec![(low, low * factor), (high, high * factor)],
        labels: Vec::new(),
        color,
        line: true,
        dots: false,
    };
    let mut series = vec![
        line("right", 1.0, [120, 120, 120]),
        line("1.5 times", 1.5, [200, 200, 200]),
        line("1/1.5", 1.0 / 1.5, [200, 200, 200]),
    ];
    for (scene, color) in names(rows, |row| &row.scene).into_iter().zip(COLORS.iter().cycle()) {
        let own = rows.iter().filter(|row| row.scene == scene);
        series.push(Series {
            points: own.map(|row| (row.measured_rmse, row.estimated_rmse)).collect(),
            name: scene,
            labels: Vec::new(),
            color: *color,
            line: false,
            dots: true,
        });
    }
    let (x, y) =
        (("measured error, levels of 255", true), ("estimated error, levels of 255", true));
    plot("estimate", "What renders say of their error, against the truth", x, y, &series)
}

fn cost_by_objects(rows: &[&Row]) -> Chart {
    let series: Vec<Series> = names(rows, |row| &row.mode)
        .into_iter()
        .zip(COLORS.iter().cycle())
        .map(|(mode, color)| {
            let own: Vec<&&Row> = rows.iter().filter(|row| row.mode == mode).collect();
            Series {
                // Without the floor.
                points: own
                    .iter()
                    .map(|r| ((r.primitives - 1).max(1) as f64, r.relative_seconds))
                    .collect(),
                labels: own.iter().map(|row| format!("{:.1}", row.measured_rmse)).collect(),
                name: mode,
                color: *color,
                line: true,
                dots: true,
            }
        })
        .collect();
    let (x, y) = (("spheres", true), ("time as a multiple of one ray per pixel", true));
    plot(
        "objects",
        "Cost of anti-aliasing by objects; beside each point its error in levels",
        x,
        y,
        &series,
    )
}

fn error_by_depth(rows: &[&Row]) -> Chart {
    let series = [Series {
        name: rows.first().map_or_else(String::new, |row| format!("{}, {}", row.scene, row.mode)),
        points: rows.iter().map(|row| (f64::from(row.depth), row.measured_rmse)).collect(),
        labels: rows.iter().map(|row| format!("{:.0} ms", row.seconds * 1e3)).collect(),
        color: COLORS[0],
        line: true,
        dots: true,
    }];
    let (x, y) =
        (("deepest level of recursion", false), ("error, levels of 255 (root mean square)", true));
    plot("depth", "What a lower limit of the recursion loses", x, y, &series)
}

fn time_by_build(rows: &[&Row]) -> Chart {
    let series: Vec<Series> = names(rows, |row| &row.scene)
        .into_iter()
        .zip(COLORS.iter().cycle())
        .map(|(scene, color)| {
            let own = || rows.iter().filter(|row| row.scene == scene);
            Series {
                points: own().map(|row| (row.build_seconds, row.seconds)).collect(),
                labels: own().map(|row| row.build.clone()).collect(),
                name: scene.clone(),
                color: *color,
                line: true,
                dots: true,
            }
        })
        .collect();
    let (width, height) = rows.first().map_or((0, 0), |row| (row.width, row.height));
    let title =
        format!("What a longer build of the tree gives back: {width}x{height}, one ray per pixel");
    let (x, y) = (("build, seconds", true), ("picture, seconds", true));
    plot("build", &title, x, y, &series)
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
            let margin = ((high - low) * 0.08).max(1e-9);
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
type AxisName<'a> = (&'a str, bool);

fn plot(name: &str, title: &str, x_name: AxisName, y_name: AxisName, series: &[Series]) -> Chart {
    let (width, height) = (900.0, 560.0);
    let (left, right, top, bottom) = (80.0, width - 190.0, 40.0, height - 60.0);
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
        drawing.text((right + 26.0, y), &series.name, Anchor::Start, BLACK);
    }
    Chart { name: name.to_owned(), title: title.to_owned(), drawing }
}

#[cfg(test)]
mod tests {
    use super::*;

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
