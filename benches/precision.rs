//! The trade between the speed and the accuracy of ray/primitive tests, measured.
//!
//! The same test in four forms (textbook and robust, in single and in double precision; robust in double precision is the
//! library's own): time per test, share of a frame's time, and the severity at which each begins to fail in each
//! family of hard rays. Then whole frames with the robust leaf tests against the same program with naive ones.
//!
//! ```text
//! cargo bench --bench precision --features leaf-study
//! ```
//!
//! writes `docs/precision.csv` and `docs/precision.svg` and prints the tables of `docs/accuracy.md`; `-- --quick` skips the
//! frames. The times are of code compiled for the best instructions that the machine has, through the same dispatch as
//! the program's; those of the baseline, where every fused multiply-add is a call, stand beside them.
#![allow(missing_docs, reason = "a bench")]
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "what it is for")]

#[path = "precision/families.rs"]
mod families;
#[path = "precision/forms.rs"]
mod forms;
#[path = "precision/frames.rs"]
mod frames;
#[path = "precision/naive.rs"]
mod naive;
#[path = "precision/numerics.rs"]
mod numerics;
#[path = "precision/plot.rs"]
mod plot;
#[path = "precision/robust.rs"]
mod robust;
#[path = "precision/score.rs"]
mod score;
#[path = "precision/timing.rs"]
mod timing;

use std::fmt::Write;

use forms::{Form, Primitive};
use frames::Frame;
use score::{Row, Score};
use timing::Times;
use whitted::accel::{Isa, study::COUNTED};

/// Where the table and the plot go.
const DOCS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs");

fn main() -> std::io::Result<()> {
    let quick = std::env::args().any(|arg| arg == "--quick");
    let fused = timing::times(Isa::detect());
    let calls = timing::times(Isa::Portable);
    print_times(&fused, &calls);

    let families: Vec<_> = Primitive::ALL.into_iter().flat_map(families::families).collect();
    let mut rows = score::score(&families);
    let after_spheres = rows.iter().filter(|row| row.primitive == Primitive::Sphere).count();
    rows.insert(after_spheres, score::leaving());
    print_rows(&rows);
    let leaks = score::leaks();
    println!(
        "Rays that get out of a closed mesh, in per cent: {:?}\n",
        leaks.map(|share| 100.0 * share)
    );

    let frames = if quick { vec![] } else { frames::frames() };
    print_frames(&frames, &fused);

    std::fs::write(format!("{DOCS}/precision.svg"), plot::plot(&fused, &rows))?;
    std::fs::write(format!("{DOCS}/precision.csv"), csv(&fused, &calls, &rows, leaks, &frames))
}

fn print_times(fused: &[Times], calls: &[Times]) {
    println!("Nanoseconds per test, {:?} | baseline\n", Isa::detect());
    println!("| test | f32 naive | f64 naive | f32 robust | f64 robust | hits |");
    println!("| --- | --- | --- | --- | --- | --- |");
    for (times, slow) in fused.iter().zip(calls) {
        print!("| {} |", times.primitive.name());
        for (t, s) in times.nanoseconds.iter().zip(&slow.nanoseconds) {
            print!(" {t:.1} / {s:.1} |");
        }
        println!(" {:.0} % |", 100.0 * times.hits);
    }
    println!();
}

fn print_rows(rows: &[Row]) {
    println!(
        "First severity with more than 0.1 % wrong of 1000 rays; (k) inputs too coarse from there; in brackets where the 99th"
    );
    println!("percentile of K is above 16; last the largest K of the library\n");
    println!("| test | family | f32 naive | f64 naive | f32 robust | f64 robust | K |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for row in rows {
        print!("| {} | {} |", row.primitive.name(), row.name);
        for score in &row.scores {
            let Score { wrong, imprecise, .. } = score;
            if imprecise == wrong {
                print!(" {wrong} |");
            } else {
                print!(" {wrong} [{imprecise}] |");
            }
        }
        let k = row.scores[Form::DoubleRobust as usize].k_max;
        println!(" {} |", if k.is_nan() { String::new() } else { format!("{k:.1}") });
    }
    println!();
}

fn print_frames(frames: &[Frame], times: &[Times]) {
    println!(
        "Tests per ray, their time in one form or another as a share of the frame, and frames with naive leaves\n"
    );
    for frame in frames {
        let rays = frame.rays as f64;
        let counts = COUNTED.iter().zip(&frame.counts).filter(|(_, n)| **n > 0);
        let counts: Vec<String> =
            counts.map(|(kind, n)| format!("{kind} {:.3}", *n as f64 / rays)).collect();
        let shares = shares(frame, times).map(|share| format!("{:.1} %", 100.0 * share));
        println!(
            "{}: {} rays, robust {:.1} ms, naive {:.1} ms, ratio {:.3} (middle half {:.3} to {:.3}), pictures {:.2} of 255 apart",
            frame.name,
            frame.rays,
            1e3 * frame.robust,
            1e3 * frame.naive,
            frame.robust / frame.naive,
            frame.ratios[0],
            frame.ratios[1],
            frame.difference
        );
        println!("  tests per ray: {}", counts.join(", "));
        println!("  f32 naive, f64 naive, f32 robust, f64 robust: {}", shares.join(", "));
    }
}

/// The time of the tests decided in double precision in each form, as a share of the frame's.
fn shares(frame: &Frame, times: &[Times]) -> [f64; 4] {
    Form::ALL.map(|form| {
        let time: f64 = times
            .iter()
            .map(|times| {
                frame.counts[times.primitive as usize] as f64 * times.nanoseconds[form as usize]
            })
            .sum();
        time * 1e-9 / frame.robust
    })
}

fn csv(
    fused: &[Times],
    calls: &[Times],
    rows: &[Row],
    leaks: [f64; 4],
    frames: &[Frame],
) -> String {
    let mut out =
        String::from("measure,subject,family,f32 naive,f64 naive,f32 robust,f64 robust\n");
    let mut row = |measure: &str, subject: &str, family: &str, values: [String; 4]| {
        writeln!(out, "{measure},{subject},\"{family}\",{}", values.join(",")).expect("a string");
    };
    for (measure, times) in [("ns", fused), ("ns of the baseline", calls)] {
        for t in times {
            row(measure, t.primitive.name(), "", t.nanoseconds.map(|t| format!("{t:.2}")));
        }
    }
    for r in rows {
        let name = r.primitive.name();
        row("first wrong", name, r.name, r.scores.map(|s| s.wrong.to_string()));
        row("first K above 16", name, r.name, r.scores.map(|s| s.imprecise.to_string()));
    }
    let family = "closed mesh, rays at edges and vertices";
    row("share of leaks", "triangle", family, leaks.map(|share| format!("{share:.5}")));
    for frame in frames {
        let shares = shares(frame, fused).map(|share| format!("{share:.4}"));
        row("share of the frame", &format!("\"{}\"", frame.name), "", shares);
        let empty = String::new;
        let values =
            [format!("{:.5}", frame.naive), empty(), empty(), format!("{:.5}", frame.robust)];
        row("seconds of the frame", &format!("\"{}\"", frame.name), "", values);
    }
    out
}
