//! The plots of a study: what of the rows stands in which.

use super::{
    LEAST_ERROR, Row, Trade,
    draw::Color,
    files::file_names,
    pareto_front,
    plot::{Chart, Series, plot},
};

/// The plots that the rows give.
pub fn charts(rows: &[Row]) -> Vec<Chart> {
    let of = |trade: Trade| rows.iter().filter(move |row| row.trade == trade).collect::<Vec<_>>();
    let mut charts = Vec::new();
    let accuracy = of(Trade::Accuracy);
    let scenes = names(&accuracy, |row| &row.scene);
    for (scene, file) in scenes.iter().zip(file_names(&scenes)) {
        let rows: Vec<&Row> = accuracy.iter().copied().filter(|row| row.scene == *scene).collect();
        charts.push(error_against_time(scene, &file, &rows));
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

/// The axis of errors.
const ERROR_AXIS: &str = "error, levels of 255 (root mean square)";

/// The measured error as it is drawn: rounding as the least.
fn error(row: &Row) -> f64 {
    row.measured_rmse.max(LEAST_ERROR)
}

/// The name of an axis of errors, which says if some are less than is drawn.
fn error_axis(name: &str, errors: impl Iterator<Item = f64>) -> String {
    let is_cut = errors.into_iter().any(|error| error < LEAST_ERROR);
    if is_cut { format!("{name}; {LEAST_ERROR} or less at the least") } else { name.to_owned() }
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

fn error_against_time(scene: &str, file: &str, rows: &[&Row]) -> Chart {
    let points: Vec<(f64, f64)> = rows.iter().map(|row| (row.seconds, error(row))).collect();
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
            points: own.iter().map(|row| (row.seconds, error(row))).collect(),
            labels: own.iter().map(|row| label(&row.mode)).collect(),
            color,
            line: false,
            dots: true,
        });
    }
    let (width, height) = rows.first().map_or((0, 0), |row| (row.width, row.height));
    let y = error_axis(ERROR_AXIS, rows.iter().map(|row| row.measured_rmse));
    plot(
        &format!("error-{file}"),
        &format!("Error against time: {scene}, {width}x{height}"),
        ("seconds", true),
        (&y, true),
        &series,
    )
}

fn estimate_against_error(rows: &[&Row]) -> Chart {
    let estimate = |row: &Row| row.estimated_rmse.max(LEAST_ERROR);
    let all = rows.iter().flat_map(|row| [error(row), estimate(row)]);
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
            points: own.map(|row| (error(row), estimate(row))).collect(),
            name: scene,
            labels: Vec::new(),
            color: *color,
            line: false,
            dots: true,
        });
    }
    let measured = rows.iter().map(|row| row.measured_rmse);
    let estimated = rows.iter().map(|row| row.estimated_rmse);
    let x = error_axis("measured error, levels of 255", measured);
    let y = error_axis("estimated error, levels of 255", estimated);
    let title = "What renders say of their error, against the truth";
    plot("estimate", title, (&x, true), (&y, true), &series)
}

fn cost_by_objects(rows: &[&Row]) -> Chart {
    let series: Vec<Series> = names(rows, |row| &row.mode)
        .into_iter()
        .zip(COLORS.iter().cycle())
        .map(|(mode, color)| {
            let is_known = |row: &&&Row| row.mode == mode && row.relative_seconds.is_finite();
            let own: Vec<&&Row> = rows.iter().filter(is_known).collect();
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
        points: rows.iter().map(|row| (f64::from(row.depth), error(row))).collect(),
        labels: rows.iter().map(|row| format!("{:.0} ms", row.seconds * 1e3)).collect(),
        color: COLORS[0],
        line: true,
        dots: true,
    }];
    let y = error_axis(ERROR_AXIS, rows.iter().map(|row| row.measured_rmse));
    let x = ("deepest level of recursion", false);
    plot("depth", "What a lower limit of the recursion loses", x, (&y, true), &series)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of one colour is right to the last bits in every mode, which no plot is to blow up.
    #[test]
    fn errors_of_rounding_are_drawn_as_the_least() {
        let axis = |errors: &[f64]| error_axis("error", errors.iter().copied());
        assert_eq!(axis(&[0.002, 3.0]), "error");
        assert_eq!(axis(&[0.0, 3.0]), "error; 0.001 or less at the least");
        let rows = [0.0, 5e-5, 2e-5].map(|measured_rmse| Row {
            measured_rmse,
            estimated_rmse: 0.0,
            ..Row::example("adaptive:4,64")
        });
        let svgs: Vec<String> = charts(&rows).iter().map(Chart::svg).collect();
        assert_eq!(svgs.len(), 2);
        for svg in svgs {
            assert!(svg.contains(">0.001<") && svg.contains("0.001 or less"), "{svg}");
            assert!(!svg.contains("e-5<") && !svg.contains("NaN"), "{svg}");
        }
    }
}
