//! The trade as a picture: time per test against the first severity that fails.

use std::fmt::Write;

use super::forms::{Form, Primitive};
use super::score::{Reach, Row};
use super::timing::Times;

const COLORS: [&str; 4] = ["#d62728", "#ff7f0e", "#1f77b4", "#2ca02c"];
const WIDTH: f64 = 430.0;
const HEIGHT: f64 = 250.0;
/// Severities on the axis; what is beyond or never fails has a place of its own.
const LAST: i32 = 14;
const NEVER: i32 = 16;

struct Panel {
    left: f64,
    top: f64,
    most: f64,
}

impl Panel {
    fn x(&self, severity: f64) -> f64 {
        self.left + 50.0 + severity / f64::from(NEVER + 1) * (WIDTH - 80.0)
    }

    fn y(&self, nanoseconds: f64) -> f64 {
        self.top + HEIGHT - 50.0 - nanoseconds / self.most * (HEIGHT - 95.0)
    }
}

fn text(svg: &mut String, at: (f64, f64), anchor: &str, size: u32, words: &str) {
    let (x, y) = at;
    writeln!(
        svg,
        "<text x='{x:.1}' y='{y:.1}' text-anchor='{anchor}' font-size='{size}'>{words}</text>"
    )
    .expect("a string");
}

fn line(svg: &mut String, from: (f64, f64), to: (f64, f64), style: &str) {
    let ((x1, y1), (x2, y2)) = (from, to);
    writeln!(svg, "<line x1='{x1:.1}' y1='{y1:.1}' x2='{x2:.1}' y2='{y2:.1}' {style}/>")
        .expect("a string");
}

/// The families that count as severities in decades.
fn place(reach: Reach) -> i32 {
    match reach {
        Reach::To(k) => k.abs().min(LAST + 1),
        Reach::Limit(_) | Reach::All => NEVER,
    }
}

fn panel(svg: &mut String, times: &Times, rows: &[&Row], left: f64, top: f64) {
    let slowest = times.nanoseconds.iter().copied().fold(0.0, f64::max);
    let step =
        [2.0, 5.0, 10.0, 20.0, 50.0].into_iter().find(|s| slowest / s < 6.0).unwrap_or(100.0);
    let panel = Panel { left, top, most: slowest * 1.15 };
    text(svg, (left + WIDTH / 2.0, top + 18.0), "middle", 14, times.primitive.name());
    let grid = "stroke='#ddd'";
    for k in (2..=LAST).step_by(2) {
        let x = panel.x(f64::from(k));
        line(svg, (x, panel.y(0.0)), (x, panel.y(panel.most)), grid);
        text(svg, (x, panel.y(0.0) + 14.0), "middle", 10, &k.to_string());
    }
    let never = panel.x(f64::from(NEVER));
    line(
        svg,
        (never, panel.y(0.0)),
        (never, panel.y(panel.most)),
        "stroke='#9c9' stroke-dasharray='4 3'",
    );
    text(svg, (never, panel.y(0.0) + 14.0), "middle", 10, "never");
    let mut y = 0.0;
    while y <= panel.most {
        line(svg, (panel.x(0.0), panel.y(y)), (panel.x(f64::from(NEVER)), panel.y(y)), grid);
        text(svg, (panel.x(0.0) - 6.0, panel.y(y) + 3.0), "end", 10, &y.to_string());
        y += step;
    }
    let below = panel.y(0.0) + 30.0;
    let label = "first failing severity k of a family (one disc; its area counts families)";
    text(svg, (panel.x(f64::from(NEVER) / 2.0), below), "middle", 10, label);
    text(svg, (left + 8.0, top + 34.0), "start", 10, "ns per test");
    for form in Form::ALL {
        let (color, y) = (COLORS[form as usize], panel.y(times.nanoseconds[form as usize]));
        let style = format!("stroke='{color}' stroke-opacity='0.5' stroke-width='1.5'");
        line(svg, (panel.x(0.0), y), (never, y), &style);
        for severity in 0..=NEVER {
            let count = rows
                .iter()
                .filter(|row| place(row.scores[form as usize].wrong) == severity)
                .count();
            if count > 0 {
                let (x, radius) = (panel.x(f64::from(severity)), 3.5 * (count as f64).sqrt());
                writeln!(
                    svg,
                    "<circle cx='{x:.1}' cy='{y:.1}' r='{radius:.1}' fill='{color}' fill-opacity='0.75'/>"
                )
                .expect("a string");
            }
        }
    }
}

/// The plot: a panel for each primitive. The families of scale, whose severities are tens of decades, are left out.
pub(crate) fn plot(times: &[Times], rows: &[Row]) -> String {
    let (width, height) = (2.0 * WIDTH, 3.0 * HEIGHT);
    let mut svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {width} {height}' width='{width}' height='{height}' \
         font-family='sans-serif'>\n<rect width='100%' height='100%' fill='white'/>\n"
    );
    for (k, primitive) in Primitive::ALL.into_iter().enumerate() {
        let counts = |row: &&Row| row.primitive == primitive && !row.name.starts_with("scale");
        let rows: Vec<&Row> = rows.iter().filter(counts).collect();
        let (left, top) = ((k % 2) as f64 * WIDTH, (k / 2) as f64 * HEIGHT);
        panel(&mut svg, &times[k], &rows, left, top);
    }
    let (x, y) = (WIDTH + 80.0, 2.0 * HEIGHT + 60.0);
    for (k, form) in (0..).zip(Form::ALL) {
        let (y, color) = (y + 26.0 * f64::from(k), COLORS[form as usize]);
        writeln!(svg, "<circle cx='{x}' cy='{y}' r='7' fill='{color}'/>").expect("a string");
        text(&mut svg, (x + 16.0, y + 4.0), "start", 13, form.name());
    }
    let notes = [
        "\"never\" includes families whose single-precision",
        "inputs become too coarse for an answer first",
    ];
    for (k, note) in (0..).zip(notes) {
        text(&mut svg, (x, y + 115.0 + 14.0 * f64::from(k)), "start", 11, note);
    }
    svg + "</svg>\n"
}
