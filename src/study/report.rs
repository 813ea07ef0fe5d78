//! A study's tables, and the page that shows all of it.

use std::fmt::Write;

use super::{LEAST_ERROR, Row, Study, Trade, files::file_names, plot::Chart, svg::escaped};

/// What the numbers are.
const NUMBERS: &str = "Errors are root mean squares in levels of 255, against converged pictures. Times are medians of \
    renders that took turns with those that they are compared with.";

/// What stands in a table for what is not known.
const DASH: &str = "–";

/// The rows as comma-separated values, a line each, under a line of names; what is not known is empty.
pub fn csv(rows: &[Row]) -> String {
    let mut text =
        "trade,scene,primitives,width,height,depth,mode,build,build_seconds,seconds,rays,rays_per_pixel,measured_rmse,\
                    estimated_rmse,worst,relative_seconds,relative_rays\n"
            .to_owned();
    for row in rows {
        let Row { primitives, width, height, depth, build, build_seconds, .. } = row;
        let Row { seconds, rays, worst, .. } = row;
        // Writing to a string does not fail. Modes hold commas.
        let _ = writeln!(
            text,
            "{},\"{}\",{primitives},{width},{height},{depth},\"{}\",{build},{build_seconds:.6},{seconds:.6},{rays},{:.4},{:.5},{},{worst:.2},{},{}",
            trade(row.trade),
            row.scene.replace('"', "\"\""),
            row.mode,
            row.rays_per_pixel,
            row.measured_rmse,
            known(row.estimated_rmse, 5, ""),
            known(row.relative_seconds, 4, ""),
            known(row.relative_rays, 4, ""),
        );
    }
    text
}

/// A number with so many digits behind the point, or what stands for one that is not known.
fn known(number: f64, digits: usize, unknown: &str) -> String {
    if number.is_finite() { format!("{number:.digits$}") } else { unknown.to_owned() }
}

/// The rows as JSON, with the program's version and the threads used; what is not known is `null`.
///
/// # Errors
/// None.
pub fn json(study: &Study, threads: usize) -> serde_json::Result<String> {
    let object = serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"),
        "threads": threads,
        "rows": study.rows,
    });
    serde_json::to_string_pretty(&object).map(|text| text + "\n")
}

/// The rows as tables for reading.
pub fn markdown(rows: &[Row]) -> String {
    let mut text = format!("# What accuracy costs\n\n{NUMBERS}\n");
    for (kind, heading) in [
        (Trade::Accuracy, "Error against time"),
        (Trade::Objects, "Cost by objects"),
        (Trade::Depth, "Error by depth of recursion"),
        (Trade::Size, "Cost by size"),
        (Trade::Build, "Time by the build of the tree"),
    ] {
        let rows: Vec<&Row> = rows.iter().filter(|row| row.trade == kind).collect();
        if rows.is_empty() {
            continue;
        }
        let _ = write!(text, "\n## {heading}\n\n");
        match kind {
            Trade::Build => add_builds(&mut text, &rows),
            // The estimate is of what the rays of a pixel miss, the error that of the rays that were not cast.
            Trade::Depth => add_errors(&mut text, &rows, false),
            _ => add_errors(&mut text, &rows, true),
        }
    }
    text
}

/// Adds a table of errors and what they cost, and if they are of one kind, what estimates are to them.
fn add_errors(text: &mut String, rows: &[&Row], compares_estimates: bool) {
    let [name, line] = if compares_estimates { [" est./error |", " ---: |"] } else { [""; 2] };
    let _ = writeln!(
        text,
        "| scene | size | depth | mode | seconds | x none | rays x none | rays/pixel | error | estimate |{name} worst |\n\
         | --- | --- | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: |{line} ---: |"
    );
    for row in rows {
        let Row { scene, width, height, depth, mode, seconds, measured_rmse, worst, .. } = row;
        let ratio = row.estimated_rmse / measured_rmse;
        let ratio = if *measured_rmse < LEAST_ERROR { f64::NAN } else { ratio };
        let ratio = known(ratio, 2, DASH);
        let ratio = if compares_estimates { format!(" {ratio} |") } else { String::new() };
        let _ = writeln!(
            text,
            "| {scene} | {width}x{height} | {depth} | {mode} | {seconds:.4} | {} | {} | {:.2} | {measured_rmse:.3} | {} |{ratio} \
             {worst:.0} |",
            known(row.relative_seconds, 2, DASH),
            known(row.relative_rays, 2, DASH),
            row.rays_per_pixel,
            known(row.estimated_rmse, 3, DASH),
        );
    }
}

/// Adds a table of builds and of the pictures through what was built.
fn add_builds(text: &mut String, rows: &[&Row]) {
    *text += "| scene | size | mode | build | build seconds | picture seconds | picture x auto |\n\
              | --- | --- | --- | --- | ---: | ---: | ---: |\n";
    for row in rows {
        let Row { scene, width, height, mode, build, build_seconds, .. } = row;
        let (seconds, relative) = (row.seconds, known(row.relative_seconds, 2, DASH));
        let _ = writeln!(
            text,
            "| {scene} | {width}x{height} | {mode} | {build} | {build_seconds:.4} | {seconds:.4} | {relative} |",
        );
    }
}

/// A page of the plots, the scenes' pictures and maps, and the tables; files are beside it under the names given.
pub fn html(rows: &[Row], charts: &[Chart], scenes: &[String]) -> String {
    let mut text = "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>What accuracy costs</title>\n\
        <style>body { font: 16px/1.5 sans-serif; max-width: 70em; margin: 2em auto; padding: 0 1em; color: #202020 } \
        table { border-collapse: collapse; font-size: 13px } td, th { padding: 2px 8px; border-bottom: 1px solid #ddd; \
        text-align: right } figure { display: inline-block; margin: 8px } img { max-width: 100% } \
        .maps img { width: 20em; image-rendering: pixelated }</style>\n<h1>What accuracy costs</h1>\n"
        .to_owned();
    let _ = writeln!(text, "<p>{NUMBERS}</p>");
    for chart in charts {
        let (name, title) = (escaped(&chart.name), escaped(&chart.title));
        let _ = writeln!(
            text,
            "<figure><a href=\"{name}.png\"><img src=\"{name}.svg\" alt=\"{title}\"></a></figure>"
        );
    }
    for (scene, name) in scenes.iter().zip(file_names(scenes)) {
        let (title, file) = (escaped(scene), escaped(&name));
        let _ = writeln!(
            text,
            "<h2>{title}</h2>\n<div class=\"maps\">\n\
             <figure><img src=\"{file}.png\" alt=\"picture\"><figcaption>the picture, default mode</figcaption></figure>\n\
             <figure><img src=\"{file}-rays.png\" alt=\"rays per pixel\"><figcaption>rays per pixel, black 1, pale 64 or \
             more</figcaption></figure>\n\
             <figure><img src=\"{file}-error.png\" alt=\"error\"><figcaption>error, black half a level or less, pale \
             128</figcaption></figure>\n</div>"
        );
    }
    let _ = writeln!(text, "<h2>All rows</h2>\n<table>");
    for (line, number) in csv(rows).lines().zip(0_u64..) {
        let tag = if number == 0 { "th" } else { "td" };
        let _ = write!(text, "<tr>");
        for cell in cells(line) {
            let _ = write!(text, "<{tag}>{}</{tag}>", escaped(&cell));
        }
        let _ = writeln!(text, "</tr>");
    }
    text + "</table>\n</html>\n"
}

fn trade(trade: Trade) -> &'static str {
    match trade {
        Trade::Accuracy => "accuracy",
        Trade::Objects => "objects",
        Trade::Depth => "depth",
        Trade::Size => "size",
        Trade::Build => "build",
    }
}

/// The cells of a line of comma-separated values.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut quoted) = (vec![String::new()], false);
    for letter in line.chars() {
        match letter {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            other => {
                if let Some(cell) = cells.last_mut() {
                    cell.push(other);
                }
            }
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of which no `none` is known has nothing to be a multiple of, and errors of cut-off rays are not what is estimated.
    #[test]
    fn what_is_not_known_is_left_open() {
        let unknown = Row {
            trade: Trade::Depth,
            relative_seconds: f64::NAN,
            relative_rays: f64::NAN,
            ..Row::example("adaptive:1,64")
        };
        let exact = Row { measured_rmse: 5e-5, estimated_rmse: 0.0, ..Row::example("none") };
        let rows = [unknown, exact];
        let table = csv(&rows);
        let lines: Vec<Vec<String>> = table.lines().map(cells).collect();
        assert_eq!(lines[1][15..], ["", ""], "{table}");
        assert_eq!(lines[2][15..], ["1.5000", "2.0000"], "{table}");
        let study = Study { rows: rows.to_vec(), portraits: Vec::new() };
        let read: serde_json::Value =
            serde_json::from_str(&json(&study, 2).expect("JSON")).expect("JSON");
        assert!(
            read["rows"][0]["relative_seconds"].is_null()
                && read["rows"][0]["relative_rays"].is_null()
        );
        let text = markdown(&rows);
        assert!(text.contains("| 0.2500 | – | – | 4.50 | 2.500 | 3.000 | 77 |"), "{text}");
        assert!(
            text.contains("| 0.2500 | 1.50 | 2.00 | 4.50 | 0.000 | 0.000 | – | 77 |"),
            "{text}"
        );
        for table in text.split("\n## ").skip(1) {
            let counts: Vec<usize> = table
                .lines()
                .filter(|line| line.starts_with('|'))
                .map(|line| line.matches('|').count())
                .collect();
            assert!(counts.len() == 3 && counts.iter().all(|&count| count == counts[0]), "{table}");
        }
    }

    /// Oracle: as many cells in each line as names in the first.
    #[test]
    fn tables_have_a_cell_for_every_name() {
        let build = Row { trade: Trade::Build, build: "fast".to_owned(), ..Row::example("none") };
        let rows = [Row::example("none"), Row::example("adaptive:4,64"), build];
        let text = csv(&rows);
        let lines: Vec<Vec<String>> = text.lines().map(cells).collect();
        assert_eq!(lines.len(), 4);
        assert!(lines.iter().all(|line| line.len() == 17), "{text}");
        let columns = |name: &str| lines[0].iter().position(|column| column == name);
        let cell = |line: usize, name: &str| columns(name).map(|k| lines[line][k].as_str());
        assert_eq!((cell(3, "build"), cell(3, "build_seconds")), (Some("fast"), Some("0.125000")));
        assert_eq!((lines[2][6].as_str(), lines[2][1].as_str()), ("adaptive:4,64", "spheres:10"));
        let text = markdown(&rows);
        assert!(
            text.contains("| spheres:10 | 4x3 | 6 | adaptive:4,64 | 0.2500 | 1.50 |"),
            "{text}"
        );
        assert!(
            text.contains("| spheres:10 | 4x3 | none | fast | 0.1250 | 0.2500 | 1.50 |"),
            "{text}"
        );
        let study = Study { rows: rows.to_vec(), portraits: Vec::new() };
        let read: serde_json::Value =
            serde_json::from_str(&json(&study, 2).expect("JSON")).expect("JSON");
        assert_eq!(
            (&read["rows"][1]["mode"], &read["threads"]),
            (&"adaptive:4,64".into(), &2.into())
        );
    }
}
